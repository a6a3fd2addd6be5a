// The table of formats, and how one is chosen: by content where it has a magic, else by the extension.
#include "pelage/hair/hair_formats.h"

#include <algorithm>
#include <cctype>
#include <cmath>
#include <glm/glm.hpp>
#include <string_view>

#include "pelage/data_schema/errors.h"
#include "pelage/hair/text_words.h"

namespace pelage::hair {
namespace {

bool is_hair(Bytes bytes) {
  return as_text(bytes).starts_with("HAIR") || as_text(bytes).starts_with("hair");
}
bool is_tfx(Bytes bytes) {
  return bytes.size() >= 4 && load<float>(bytes, 0) == 4.0F;
}
bool is_tfx_text(Bytes bytes) {
  return text_of(bytes).starts_with("version");
}
bool is_ply(Bytes bytes) {
  return as_text(bytes).starts_with("ply");
}
bool is_usda(Bytes bytes) {
  return text_of(bytes).starts_with("#usda");
}

constexpr unsigned kAll = kColours | kDiameters | kOpacity;
constexpr Format kFormats[] = {
    {"HAIR", ".hair", is_hair, decode_hair, encode_hair, kAll},
    {"TFX 2", ".tfx", is_tfx_text, decode_tfx_text, nullptr},
    {"TFX 4", ".tfx", is_tfx, decode_tfx, encode_tfx, kColours | kDiameters},
    {"USC .data", ".data", nullptr, decode_data, encode_data},
    {"CT2Hair .bin", ".bin", nullptr, decode_ct2hair, nullptr},
    {"strand PLY", ".ply", is_ply, decode_ply, encode_ply, kColours | kDiameters},
    {"OBJ polylines", ".obj", nullptr, decode_obj, encode_obj, kColours},
    {"USD text", ".usda", is_usda, decode_usda, encode_usda, kAll},
};

/// Formats that people have and this build does not read, by their first bytes, with the way out.
struct KnownFormat {
  std::string_view magic, name, remedy;
};
constexpr std::string_view kPlain = "convert it to one of the formats that are read";
constexpr KnownFormat kRefused[] = {
    {"Ogawa", "Alembic", "export the curves as .usda or .obj"},
    {"\x89HDF", "Alembic (HDF5)", "export the curves as .usda or .obj"},
    {"PXR-USDC", "binary USD", "save it as text: usdcat -o FILE.usda"},
    {"PK\x03\x04", "zipped USD (.usdz)", "unpack it and save the stage as text: usdcat -o FILE.usda"},
    {"BINARY_HAIR", "Mitsuba's binary hair", kPlain},
    {"\x80\xBF\x80"
     "FIBER",
     "Tungsten's fiber", kPlain}};

std::string extension_of(const std::string& where) {
  std::string extension = std::filesystem::path(where).extension().string();
  for (char& c : extension) c = static_cast<char>(std::tolower(static_cast<unsigned char>(c)));
  return extension;
}

std::string list_formats(bool to_write) {
  std::string list;
  for (const Format& format : kFormats) {
    if (to_write && format.encode == nullptr) continue;
    list += (list.empty() ? "" : ", ") + std::string(format.name) + " (" + format.extension + ")";
  }
  return list;
}

/// Of several formats with one extension, the one whose content has no other sign: the last in the table.
const Format* by_extension(const std::string& extension, bool to_write) {
  const Format* found = nullptr;
  for (const Format& format : kFormats) {
    if (extension == format.extension && !(to_write && format.encode == nullptr)) found = &format;
  }
  return found;
}

}  // namespace

const Format& format_of(Bytes bytes, const std::string& where) {
  if (bytes.empty()) throw InputError(where, "the file is empty: fetch or export it again");
  if (as_text(bytes).starts_with("SQLite format 3"))
    throw InputError(where, "is an HRIR database (SQLite), no hair: give a hair file; databases belong to --database");
  for (const Format& format : kFormats) {
    if (format.recognise != nullptr && format.recognise(bytes)) return format;
  }
  for (const KnownFormat& known : kRefused) {
    if (as_text(bytes).starts_with(known.magic)) {
      throw InputError(where, std::string(known.name) + " is not read by this build: " + std::string(known.remedy));
    }
  }
  const std::string extension = extension_of(where);
  if (extension == ".tfxbone") {
    throw InputError(
        where, "holds the bone weights of a .tfx file (pelage info shows them), no hair: give the .tfx file beside it");
  }
  if (extension == ".tfxmesh") {
    throw InputError(where, "holds the collision mesh of a .tfx file, no hair: give the .tfx file beside it");
  }
  const Format* const named = by_extension(extension, false);
  if (named != nullptr) return *named;
  throw InputError(where, "none of the hair formats that are read, which are " + list_formats(false) +
                              ": convert it to one of them");
}

const Format& format_to_write(const std::filesystem::path& file) {
  const Format* const format = by_extension(extension_of(file.string()), true);
  if (format != nullptr) return *format;
  throw UsageError("output \"" + file.string() + "\": the extension says the format, one of " + list_formats(true));
}

void end_strand(RawHair& raw, const std::string& where) {
  if (raw.points.size() > 0xFFFF'FFFFU) {
    throw InputError(where, "more than 4,294,967,295 points: split the file");
  }
  raw.offsets.push_back(static_cast<std::uint32_t>(raw.points.size()));
}

void append_colour(RawHair& raw, std::span<const glm::vec3> of_its_points) {
  glm::dvec3 sum(0.0);
  bool varies = false;
  for (const glm::vec3& c : of_its_points) {
    sum += glm::dvec3(c);
    varies = varies || c != of_its_points.front();
  }
  raw.colours.emplace_back(sum / static_cast<double>(of_its_points.size()));
  const glm::vec3 mean = raw.colours.back();
  if (varies && std::isfinite(mean.x + mean.y + mean.z)) ++raw.varying_colours;
}

void append_colours(RawHair& raw, const std::vector<glm::vec3>& per_point) {
  for (std::size_t i = 0; i + 1 < raw.offsets.size(); ++i)
    append_colour(raw, std::span(per_point).subspan(raw.offsets[i], raw.offsets[i + 1] - raw.offsets[i]));
}

std::string counted(std::size_t n, const std::string& singular, const std::string& plural) {
  return std::to_string(n) + " " + (n == 1 ? singular : plural.empty() ? singular + "s" : plural);
}

std::string texture_note(std::size_t strands) {
  return "texture coordinates not read: of " + counted(strands, "strand");
}

}  // namespace pelage::hair
