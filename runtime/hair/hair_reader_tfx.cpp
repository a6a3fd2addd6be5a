// TFX 4 (AMD TressFX), binary: a 160-byte header with byte offsets, the same number of vertices in every strand. The
// fourth component of a position flags pinned vertices and is of no interest here; texture coordinates are not used.
#include <algorithm>
#include <cstdint>
#include <glm/vec4.hpp>

#include "pelage/data_schema/errors.h"
#include "pelage/hair/hair_reader.h"

namespace pelage::hair {
namespace {

constexpr std::size_t kHeaderBytes = 160;
constexpr std::uint64_t kMaxVertices = 0xFFFF'FFFFU;  // Strands counts in 32 bits

struct Header {
  float version;
  std::uint64_t strands, vertices_per_strand;
  std::uint64_t positions, thickness, colours;  // byte offsets, 0: absent
};

Header read_header(std::span<const std::byte> bytes, const std::string& where) {
  if (bytes.size() < kHeaderBytes) {
    throw InputError(where, "TFX header needs 160 bytes, the file has " + std::to_string(bytes.size()) +
                                ": truncated; fetch or export it again");
  }
  const auto word = [&](std::size_t offset) -> std::uint64_t { return load<std::uint32_t>(bytes, offset); };
  return {load<float>(bytes, 0), word(4), word(8), word(12), word(24), word(28)};
}

/// `count` elements of `size` bytes at `offset` lie behind the header and inside the file. count < 2^32.
void check_array(const std::string& name, std::uint64_t offset, std::uint64_t count, std::uint64_t size,
                 std::uint64_t file_bytes, const std::string& where) {
  if (offset >= kHeaderBytes && offset + count * size <= file_bytes) return;
  throw InputError(where, "TFX " + name + ": " + std::to_string(count) + " elements at byte " + std::to_string(offset) +
                              " do not fit into the file of " + std::to_string(file_bytes) +
                              " bytes: truncated or damaged; fetch or export it again");
}

void check(const Header& h, std::uint64_t file_bytes, const std::string& where) {
  if (!(h.version >= 4.0F && h.version < 5.0F)) {
    throw InputError(where,
                     "TFX version " + std::to_string(h.version) + ", this build reads 4: export it as version 4");
  }
  if (h.strands * h.vertices_per_strand > kMaxVertices) {
    throw InputError(where, "TFX header says " + std::to_string(h.strands) + " strands of " +
                                std::to_string(h.vertices_per_strand) + " vertices, the file has " +
                                std::to_string(file_bytes) + " bytes: damaged; fetch or export it again");
  }
  if (h.vertices_per_strand == 0) throw InputError(where, "TFX header says 0 vertices per strand: export it again");
  const std::uint64_t vertices = h.strands * h.vertices_per_strand;
  check_array("positions", h.positions, vertices, 16, file_bytes, where);
  if (h.thickness != 0) check_array("thickness", h.thickness, h.strands, 4, file_bytes, where);
  if (h.colours != 0) check_array("vertex colours", h.colours, vertices, 16, file_bytes, where);
}

glm::vec3 mean_rgb(std::span<const glm::vec4> colours) {
  glm::dvec3 sum(0.0);
  for (const glm::vec4& c : colours) sum += glm::dvec3(c.x, c.y, c.z);
  return glm::vec3(sum / static_cast<double>(colours.size()));
}

}  // namespace

RawHair decode_tfx(std::span<const std::byte> bytes, const std::string& where) {
  const Header h = read_header(bytes, where);
  check(h, bytes.size(), where);
  const std::size_t n = h.vertices_per_strand;
  RawHair raw;
  raw.format = "TFX 4";
  for (const glm::vec4& p : load_array<glm::vec4>(bytes, h.positions, h.strands * n))
    raw.points.emplace_back(p.x, p.y, p.z);
  for (std::size_t i = 1; i <= h.strands; ++i) raw.offsets.push_back(static_cast<std::uint32_t>(i * n));
  if (h.thickness != 0) {
    for (const float t : load_array<float>(bytes, h.thickness, h.strands))
      raw.thickness.insert(raw.thickness.end(), n, t);
  }
  if (h.colours != 0) {
    const std::vector<glm::vec4> colours = load_array<glm::vec4>(bytes, h.colours, h.strands * n);
    for (std::size_t i = 0; i < h.strands; ++i) raw.colours.push_back(mean_rgb({colours.data() + i * n, n}));
  }
  return raw;
}

}  // namespace pelage::hair
