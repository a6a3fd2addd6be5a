// Private to this box: the formats. A decoder returns what the file says, in the file's unit and axes (hair_clean.cpp
// turns that into clean Strands); an encoder writes Strands, metres and Y up. The table of formats is in
// hair_formats.cpp. A new format is one file format_<name>.cpp and one line there.
#pragma once

#include <cstddef>
#include <cstdint>
#include <cstring>
#include <glm/vec3.hpp>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "pelage/hair/hair_file.h"

namespace pelage::hair {

struct RawHair {
  std::string format;
  std::vector<std::uint32_t> offsets{0};  // [strands + 1]
  std::vector<glm::vec3> points;          // [points]
  std::vector<float> thickness;           // [points], or empty: default_thickness for all, 0 where unknown
  std::vector<glm::vec3> colours;         // [strands] or empty
  std::size_t varying_colours = 0;        // strands whose points had different ones
  float default_thickness = 0.0F;
  std::optional<float> opacity{};  // as the file has it: may be NaN or out of range
  std::vector<std::string> notes{};
  std::vector<StrandIssue> repairs{};       // by the decoder, in order of strand
  std::optional<double> metres_per_unit{};  // where the file says it: the options have no say then
  std::optional<UpAxis> up{};
  bool says_curve = false;  // the file says what its vertices are, and `points` lie on the curve
};

using Bytes = std::span<const std::byte>;

/// What a file can hold besides vertices.
enum Holds : unsigned { kNothing = 0, kColours = 1, kDiameters = 2, kOpacity = 4 };

/// What an encoder knows besides the strands.
struct Output {
  const std::string& where;
  std::optional<float> opacity;
  WriteReport& report;
};

struct Format {
  const char* name;
  const char* extension;
  bool (*recognise)(Bytes);  // by content; null: by extension alone
  RawHair (*decode)(Bytes, const std::string& where);
  std::string (*encode)(const Strands&, Output&);  // null: read only
  unsigned holds = kNothing;
};

/// By content, else by the extension of `where`. @throws InputError naming what it is instead, where that is known
const Format& format_of(Bytes bytes, const std::string& where);

/// @throws UsageError listing what can be written
const Format& format_to_write(const std::filesystem::path& file);

RawHair decode_hair(Bytes, const std::string&);      // HAIR: shared/FORMATS.md section 1
RawHair decode_tfx(Bytes, const std::string&);       // TFX 4, binary: section 2
RawHair decode_tfx_text(Bytes, const std::string&);  // TFX 2, text: section 2
RawHair decode_data(Bytes, const std::string&);      // USC-HairSalon .data: section 3
RawHair decode_ct2hair(Bytes, const std::string&);   // CT2Hair .bin: section 4
RawHair decode_ply(Bytes, const std::string&);       // strand PLY: section 5
RawHair decode_obj(Bytes, const std::string&);       // OBJ polylines
RawHair decode_usda(Bytes, const std::string&);      // USD text, BasisCurves

std::string encode_hair(const Strands&, Output&);
std::string encode_tfx(const Strands&, Output&);
std::string encode_data(const Strands&, Output&);
std::string encode_ply(const Strands&, Output&);
std::string encode_obj(const Strands&, Output&);
std::string encode_usda(const Strands&, Output&);

/// Ends the strand whose points were appended last. @throws InputError beyond 2^32 points, which Strands cannot count
void end_strand(RawHair& raw, const std::string& where);

/// Gives the next strand one colour, the mean of its points'; NaN where one of them has none, to be repaired later.
void append_colour(RawHair& raw, std::span<const glm::vec3> of_its_points);

/// The same for all strands, from a colour for each of raw.points.
void append_colours(RawHair& raw, const std::vector<glm::vec3>& per_point);

/// "1 strand", "2 strands"
std::string counted(std::size_t n, const std::string& singular, const std::string& plural = {});

/// "texture coordinates not read: of 2 strands"
std::string texture_note(std::size_t strands);

/// Diameter at a vertex [m], 0 where unknown.
inline float diameter_at_m(const Strands& strands, std::size_t vertex) {
  return strands.diameters_m.empty() ? strands.diameter_m : strands.diameters_m[vertex];
}

/// Does any vertex have a diameter?
inline bool has_diameters(const Strands& strands) {
  return !strands.diameters_m.empty() || strands.diameter_m != 0.0F;
}

/// Unaligned little-endian loads; the caller has checked the bounds. (All supported machines are little-endian.)
template <class T>
T load(Bytes bytes, std::size_t offset) {
  T value;
  std::memcpy(&value, bytes.data() + offset, sizeof value);
  return value;
}

template <class T>
std::vector<T> load_array(Bytes bytes, std::size_t offset, std::size_t count) {
  std::vector<T> values(count);
  if (count > 0) std::memcpy(values.data(), bytes.data() + offset, count * sizeof(T));
  return values;
}

template <class T>
void append_bytes(std::string& out, const T& value) {
  out.append(reinterpret_cast<const char*>(&value), sizeof value);
}

template <class T>
void append_array(std::string& out, const std::vector<T>& values) {
  out.append(reinterpret_cast<const char*>(values.data()), values.size() * sizeof(T));
}

}  // namespace pelage::hair
