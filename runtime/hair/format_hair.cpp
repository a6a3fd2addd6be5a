// HAIR: a 128-byte header, then up to five arrays back to back, each present if its bit is set. Written: the arrays
// that the strands call for and no others. Dialects that give the reserved bits a meaning are recognised by the size
// that they imply, and refused by name.
#include <algorithm>
#include <array>
#include <cstdint>
#include <cstring>
#include <functional>
#include <numeric>

#include "pelage/data_schema/errors.h"
#include "pelage/hair/hair_formats.h"
#include "pelage/hair/text_words.h"

namespace pelage::hair {
namespace {

constexpr std::size_t kHeaderBytes = 128;
constexpr std::size_t kMaxSegments = 65'535;  // u16
enum Bit : std::uint32_t {
  kSegments = 1,
  kPoints = 2,
  kThickness = 4,
  kTransparency = 8,
  kColour = 16,
  kReserved = ~31U
};

struct Header {
  std::uint64_t strands, points;
  std::uint32_t bits, default_segments;
  float thickness, transparency;
  glm::vec3 colour;
};

Header read_header(Bytes bytes, const std::string& where) {
  if (bytes.size() < kHeaderBytes) {
    throw InputError(where, "HAIR header needs 128 bytes, the file has " + std::to_string(bytes.size()) +
                                ": truncated; fetch or export it again");
  }
  return {load<std::uint32_t>(bytes, 4),  load<std::uint32_t>(bytes, 8), load<std::uint32_t>(bytes, 12),
          load<std::uint32_t>(bytes, 16), load<float>(bytes, 20),        load<float>(bytes, 24),
          load<glm::vec3>(bytes, 28)};
}

/// Bytes of the file that its header describes. All counts are 32 bits wide: no overflow in 64.
std::uint64_t described_bytes(const Header& h) {
  const auto has = [&](Bit bit, std::uint64_t n) { return (h.bits & bit) != 0 ? n : 0; };
  return kHeaderBytes + has(kSegments, 2 * h.strands) + has(kPoints, 12 * h.points) + has(kThickness, 4 * h.points) +
         has(kTransparency, 4 * h.points) + has(kColour, 12 * h.points);
}

/// The reserved bits are set: which dialect is it? Each adds arrays, so the size tells them apart.
void refuse_dialect(const Header& h, std::uint64_t file_bytes, const std::string& where) {
  const std::uint64_t plain = described_bytes(h);
  const std::uint32_t reserved = h.bits & kReserved;
  const std::uint64_t line_indices = h.points >= h.strands ? 8 * (h.points - h.strands) : 0;
  const std::uint64_t vkhr =
      plain + ((reserved & 0x20) != 0 ? 12 * h.points : 0) + ((reserved & 0x40) != 0 ? line_indices : 0);
  std::string dialect = "reserved array bits are set, which no known dialect explains";
  if (reserved == 0x20 && file_bytes == plain + 8 * h.points) {
    dialect = "the LuxCore dialect of HAIR (bit 5: UV per point)";
  } else if ((reserved & ~0xE0U) == 0 && file_bytes == vkhr) {
    dialect = "the vkhr dialect of HAIR (bits 5-7: tangents, line indices, bounding box)";
  }
  throw InputError(where, dialect + ", bits " + std::to_string(h.bits) + ": export plain HAIR (bits 0 to 4 only)");
}

void check(const Header& h, std::uint64_t file_bytes, const std::string& where) {
  if ((h.bits & kReserved) != 0) refuse_dialect(h, file_bytes, where);
  if ((h.bits & kPoints) == 0) throw InputError(where, "the HAIR file has no points (bit 1 is clear): export it again");
  const std::uint64_t needed = described_bytes(h);
  if (needed > file_bytes) {
    throw InputError(where, "the HAIR header (" + std::to_string(h.strands) + " strands, " + std::to_string(h.points) +
                                " points) describes " + std::to_string(needed) + " bytes, the file has " +
                                std::to_string(file_bytes) + ": truncated or damaged; fetch or export it again");
  }
}

/// First point of each strand. Checked against the point count before anything is allocated by strand.
std::vector<std::uint32_t> read_offsets(const Header& h, Bytes bytes, const std::string& where) {
  const bool each = (h.bits & kSegments) != 0;
  const auto segments = [&](std::uint64_t i) -> std::uint64_t {
    return each ? load<std::uint16_t>(bytes, kHeaderBytes + 2 * i) : h.default_segments;
  };
  std::uint64_t points = h.strands * (std::uint64_t{h.default_segments} + 1);  // < 2^64
  if (each) {
    points = h.strands;
    for (std::uint64_t i = 0; i < h.strands; ++i) points += segments(i);
  }
  if (points != h.points) {
    throw InputError(where, "the segments of " + std::to_string(h.strands) + " strands need " + std::to_string(points) +
                                " points, the header says " + std::to_string(h.points) + ": damaged; export it again");
  }
  std::vector<std::uint32_t> offsets(h.strands + 1, 0);  // strands <= points, which the file holds
  for (std::uint64_t i = 0; i < h.strands; ++i)
    offsets[i + 1] = static_cast<std::uint32_t>(offsets[i] + segments(i) + 1);
  return offsets;
}

template <class T>
bool all_equal(const std::vector<T>& values) {
  return std::adjacent_find(values.begin(), values.end(), std::not_equal_to<>()) == values.end();
}

bool is_initial_value(glm::vec3 c) {
  return c == glm::vec3(0.0F) || c == glm::vec3(1.0F);
}

float mean_opacity(const std::vector<float>& transparency) {
  const double sum = std::accumulate(transparency.begin(), transparency.end(), 0.0);
  return static_cast<float>(1.0 - sum / static_cast<double>(transparency.size()));
}

template <class T>
void put(std::array<char, kHeaderBytes>& header, std::size_t offset, T value) {
  std::memcpy(header.data() + offset, &value, sizeof value);
}

std::vector<std::uint16_t> segments_per_strand(const Strands& strands, const std::string& where) {
  std::vector<std::uint16_t> segments;
  for (std::size_t i = 0; i < strands.count(); ++i) {
    const std::size_t vertices = strands.strand(i).size();
    if (vertices == 0 || vertices - 1 > kMaxSegments) {
      throw OutputError(where, "strand " + std::to_string(i) + " has " + std::to_string(vertices) +
                                   " vertices, a HAIR file takes 1 to 65536: resample it (pelage convert --resample)");
    }
    segments.push_back(static_cast<std::uint16_t>(vertices - 1));
  }
  return segments;
}

std::array<char, kHeaderBytes> make_header(const Strands& strands, std::uint32_t bits, std::uint32_t default_segments,
                                           std::optional<float> opacity) {
  std::array<char, kHeaderBytes> header{};
  std::memcpy(header.data(), "HAIR", 4);
  put(header, 4, static_cast<std::uint32_t>(strands.count()));
  put(header, 8, static_cast<std::uint32_t>(strands.vertices.size()));
  put(header, 12, bits);
  put(header, 16, default_segments);
  put(header, 20, strands.diameter_m);
  if (opacity) put(header, 24, 1.0F - *opacity);
  put(header, 28, glm::vec3(1.0F));
  std::strcpy(header.data() + 40, "Pelage: metres, Y up");
  return header;
}

std::vector<glm::vec3> colours_per_point(const Strands& strands) {
  std::vector<glm::vec3> colours;
  for (std::size_t i = 0; i < strands.colours.size(); ++i) {
    colours.insert(colours.end(), strands.strand(i).size(), strands.colours[i]);
  }
  return colours;
}

/// Only where they differ, or are 1, which in the header means that nothing is known.
std::vector<float> diameters_per_point(const Strands& strands) {
  if (strands.diameters_m.empty() && strands.diameter_m == 1.0F)
    return std::vector<float>(strands.vertices.size(), 1.0F);
  return strands.diameters_m;
}

}  // namespace

RawHair decode_hair(Bytes bytes, const std::string& where) {
  const std::string_view text = as_text(bytes);
  if (!text.starts_with("HAIR") && !text.starts_with("hair"))
    throw InputError(where, "does not start with \"HAIR\": no HAIR file, whatever its name says; export it again");
  const Header h = read_header(bytes, where);
  check(h, bytes.size(), where);
  RawHair raw;
  raw.format = bytes[0] == std::byte{'h'} ? "HAIR, lowercase magic" : "HAIR";
  raw.offsets = read_offsets(h, bytes, where);

  std::size_t at = kHeaderBytes + ((h.bits & kSegments) != 0 ? 2 * h.strands : 0);
  raw.points = load_array<glm::vec3>(bytes, at, h.points);
  at += 12 * h.points;
  raw.default_thickness = h.thickness;
  if ((h.bits & kThickness) != 0) {
    raw.thickness = load_array<float>(bytes, at, h.points);
    at += 4 * h.points;
  }
  if (h.transparency != 0) raw.opacity = 1.0F - h.transparency;  // 0 is also what a writer leaves that has none
  if ((h.bits & kTransparency) != 0 && h.points > 0) {
    const std::vector<float> transparency = load_array<float>(bytes, at, h.points);
    raw.opacity = mean_opacity(transparency);
    if (!all_equal(transparency))
      raw.notes.push_back("transparency of " + counted(h.points, "point") + " averaged to one for the file");
    at += 4 * h.points;
  }
  if ((h.bits & kColour) != 0) {
    append_colours(raw, load_array<glm::vec3>(bytes, at, h.points));
    at += 12 * h.points;
  } else if (!is_initial_value(h.colour)) {
    raw.colours.assign(h.strands, h.colour);
  }
  if (at < bytes.size()) raw.notes.push_back(std::to_string(bytes.size() - at) + " bytes after the last array ignored");
  return raw;
}

std::string encode_hair(const Strands& strands, Output& output) {
  const std::vector<std::uint16_t> segments = segments_per_strand(strands, output.where);
  const bool even = all_equal(segments);
  const std::vector<float> diameters_m = diameters_per_point(strands);
  const std::uint32_t bits = (even ? 0U : kSegments) | kPoints | (diameters_m.empty() ? 0U : kThickness) |
                             (strands.colours.empty() ? 0U : kColour);
  if (output.opacity && 1.0F - (1.0F - *output.opacity) != *output.opacity)
    output.report.lost.push_back("opacity: rounded, HAIR stores 1 - opacity");
  if (output.opacity == 1.0F) output.report.lost.push_back("opacity: 1 is what HAIR files have that say nothing");
  const std::array<char, kHeaderBytes> header =
      make_header(strands, bits, even && !segments.empty() ? segments[0] : 0U, output.opacity);
  std::string bytes(header.data(), header.size());
  if (!even) append_array(bytes, segments);
  append_array(bytes, strands.vertices);
  append_array(bytes, diameters_m);
  append_array(bytes, colours_per_point(strands));
  return bytes;
}

}  // namespace pelage::hair
