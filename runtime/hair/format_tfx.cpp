// TFX 4 (AMD TressFX), binary: a 160-byte header with byte offsets, the same number of vertices in every strand. The
// fourth component of a position flags pinned vertices (0); that others than the root are, and texture coordinates, are
// not kept, which is told. Written: the root pinned, positions, then thickness and colours where known; diameters are
// one per strand.
#include <algorithm>
#include <cstdint>
#include <glm/vec4.hpp>

#include "pelage/data_schema/errors.h"
#include "pelage/hair/hair_formats.h"

namespace pelage::hair {
namespace {

constexpr std::size_t kHeaderBytes = 160;
constexpr std::uint64_t kMaxVertices = 0xFFFF'FFFFU;  // Strands counts in 32 bits

struct Header {
  float version;
  std::uint64_t strands, vertices_per_strand;
  std::uint64_t positions, thickness, colours;  // byte offsets, 0: absent
  bool textured = false;
};

Header read_header(Bytes bytes, const std::string& where) {
  if (bytes.size() < kHeaderBytes) {
    throw InputError(where, "TFX header needs 160 bytes, the file has " + std::to_string(bytes.size()) +
                                ": truncated; fetch or export it again");
  }
  const auto word = [&](std::size_t offset) -> std::uint64_t { return load<std::uint32_t>(bytes, offset); };
  return {load<float>(bytes, 0), word(4), word(8), word(12), word(24), word(28), word(16) != 0 || word(20) != 0};
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

/// A writer pins the root of each strand again, and no other vertex.
void note_pinned(std::span<const glm::vec4> positions, std::size_t vertices_per_strand, RawHair& raw) {
  std::size_t pinned = 0;
  for (std::size_t k = 0; k < positions.size(); ++k) pinned += k % vertices_per_strand != 0 && positions[k].w == 0.0F;
  if (pinned > 0)
    raw.notes.push_back(counted(pinned, "pinned vertex", "pinned vertices") + " behind the root not kept as such");
}

/// Vertices per strand. @throws OutputError naming the first strand that differs
std::size_t equal_vertices(const Strands& strands, const std::string& where) {
  const std::size_t n = strands.count() == 0 ? 0 : strands.strand(0).size();
  for (std::size_t i = 0; i < strands.count(); ++i) {
    if (strands.strand(i).size() == n && n > 0) continue;
    throw OutputError(where, "TFX 4 wants the same number of vertices in every strand, strand 0 has " +
                                 std::to_string(n) + ", strand " + std::to_string(i) + " has " +
                                 std::to_string(strands.strand(i).size()) +
                                 ": resample (pelage convert --resample 16), or use another format");
  }
  return n;
}

/// One diameter per strand: its vertices' mean where they differ.
std::vector<float> diameter_per_strand(const Strands& strands, Output& output) {
  std::vector<float> diameters;
  std::size_t tapered = 0;
  for (std::size_t i = 0; i < strands.count(); ++i) {
    const std::size_t first = strands.offsets[i], last = strands.offsets[i + 1];
    double sum = 0;
    bool equal = true;
    for (std::size_t k = first; k < last; ++k) {
      sum += static_cast<double>(diameter_at_m(strands, k));
      equal = equal && diameter_at_m(strands, k) == diameter_at_m(strands, first);
    }
    diameters.push_back(equal ? diameter_at_m(strands, first)
                              : static_cast<float>(sum / static_cast<double>(last - first)));
    tapered += !equal;
  }
  if (tapered > 0)
    output.report.lost.push_back("diameter along " + std::to_string(tapered) +
                                 " strands: TFX 4 has one per strand, their means are written");
  return diameters;
}

void append_positions(std::string& out, const Strands& strands) {
  for (std::size_t i = 0; i < strands.count(); ++i) {
    const std::span<const glm::vec3> strand = strands.strand(i);
    for (std::size_t k = 0; k < strand.size(); ++k) append_bytes(out, glm::vec4(strand[k], k == 0 ? 0.0F : 1.0F));
  }
}

void append_colours(std::string& out, const Strands& strands, std::size_t vertices_per_strand) {
  for (const glm::vec3& colour : strands.colours) {
    for (std::size_t k = 0; k < vertices_per_strand; ++k) append_bytes(out, glm::vec4(colour, 1.0F));
  }
}

std::string make_header(const Header& h) {
  std::string header(kHeaderBytes, '\0');
  const auto put = [&](std::size_t offset, std::uint64_t value) {
    const auto word = static_cast<std::uint32_t>(value);
    std::memcpy(header.data() + offset, &word, sizeof word);
  };
  std::memcpy(header.data(), &h.version, sizeof h.version);
  put(4, h.strands);
  put(8, h.vertices_per_strand);
  put(12, h.positions);
  put(24, h.thickness);
  put(28, h.colours);
  return header;
}

}  // namespace

RawHair decode_tfx(Bytes bytes, const std::string& where) {
  const Header h = read_header(bytes, where);
  check(h, bytes.size(), where);
  const std::size_t n = h.vertices_per_strand;
  RawHair raw;
  raw.format = "TFX 4";
  const std::vector<glm::vec4> positions = load_array<glm::vec4>(bytes, h.positions, h.strands * n);
  raw.points.assign(positions.begin(), positions.end());
  note_pinned(positions, n, raw);
  for (std::size_t i = 1; i <= h.strands; ++i) raw.offsets.push_back(static_cast<std::uint32_t>(i * n));
  if (h.thickness != 0) {
    for (const float t : load_array<float>(bytes, h.thickness, h.strands))
      raw.thickness.insert(raw.thickness.end(), n, t);
  }
  if (h.colours != 0) {
    const std::vector<glm::vec4> colours = load_array<glm::vec4>(bytes, h.colours, h.strands * n);
    append_colours(raw, {colours.begin(), colours.end()});
  }
  if (h.textured) raw.notes.push_back(texture_note(h.strands));
  return raw;
}

std::string encode_tfx(const Strands& strands, Output& output) {
  Header h{4.0F, strands.count(), equal_vertices(strands, output.where), kHeaderBytes, 0, 0, false};
  const std::uint64_t vertices = strands.vertices.size();
  std::uint64_t end = h.positions + 16 * vertices;
  if (has_diameters(strands)) {
    h.thickness = end;
    end += 4 * h.strands;
  }
  if (!strands.colours.empty()) h.colours = end;
  if (std::max(h.thickness, h.colours) > 0xFFFF'FFFFU) {
    throw OutputError(output.where, "beyond the 4 GiB that the offsets of TFX 4 reach: write another format");
  }
  const std::size_t n = h.vertices_per_strand;
  if (n != 4 && n != 8 && n != 16 && n != 32 && n != 64) {
    output.report.notes.push_back("AMD's runtime takes 4, 8, 16, 32 or 64 vertices per strand, not " +
                                  std::to_string(n) + " (pelage convert --resample 16)");
  }
  std::string bytes = make_header(h);
  append_positions(bytes, strands);
  if (h.thickness != 0) append_array(bytes, diameter_per_strand(strands, output));
  if (h.colours != 0) append_colours(bytes, strands, n);
  return bytes;
}

}  // namespace pelage::hair
