// HAIR: a 128-byte header, then up to five arrays back to back, each present if its bit is set.
// Dialects that give the reserved bits a meaning are recognised by the size that they imply, and refused by name.
#include <algorithm>
#include <cstdint>
#include <numeric>

#include "pelage/data_schema/errors.h"
#include "pelage/hair/hair_reader.h"

namespace pelage::hair {
namespace {

constexpr std::size_t kHeaderBytes = 128;
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

Header read_header(std::span<const std::byte> bytes, const std::string& where) {
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
std::vector<std::uint32_t> read_offsets(const Header& h, std::span<const std::byte> bytes, const std::string& where) {
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

bool is_initial_value(glm::vec3 c) {
  return c == glm::vec3(0.0F) || c == glm::vec3(1.0F);
}

/// One colour per strand: its points' mean.
std::vector<glm::vec3> mean_per_strand(const std::vector<glm::vec3>& per_point,
                                       const std::vector<std::uint32_t>& offsets) {
  std::vector<glm::vec3> colours;
  for (std::size_t i = 0; i + 1 < offsets.size(); ++i) {
    glm::dvec3 sum(0.0);
    for (std::size_t k = offsets[i]; k < offsets[i + 1]; ++k) sum += glm::dvec3(per_point[k]);
    colours.emplace_back(sum / static_cast<double>(offsets[i + 1] - offsets[i]));
  }
  return colours;
}

float mean_opacity(const std::vector<float>& transparency) {
  const double sum = std::accumulate(transparency.begin(), transparency.end(), 0.0);
  return static_cast<float>(1.0 - sum / static_cast<double>(transparency.size()));
}

}  // namespace

RawHair decode_hair(std::span<const std::byte> bytes, const std::string& where) {
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
    raw.opacity = mean_opacity(load_array<float>(bytes, at, h.points));
    at += 4 * h.points;
  }
  if ((h.bits & kColour) != 0) {
    raw.colours = mean_per_strand(load_array<glm::vec3>(bytes, at, h.points), raw.offsets);
    at += 12 * h.points;
  } else if (!is_initial_value(h.colour)) {
    raw.colours.assign(h.strands, h.colour);
  }
  if (at < bytes.size()) raw.notes.push_back(std::to_string(bytes.size() - at) + " bytes after the last array ignored");
  return raw;
}

}  // namespace pelage::hair
