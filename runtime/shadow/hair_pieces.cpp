#include "pelage/shadow/hair_pieces.h"

#include <algorithm>
#include <cmath>
#include <cstring>
#include <glm/geometric.hpp>

#define PELAGE_CLONES __attribute__((target_clones("avx512f", "avx2", "default")))

namespace pelage {
namespace {

constexpr std::size_t kChunk = CellBlock::kSize - 1;  // segments at a time; their vertices fill a block
/// Bounds the work for a segment that is many cells long; such hair is sparse.
constexpr float kMostPieces = 4096;
/// Depth of a piece next to a point light is without bound; this much lets nothing through.
constexpr float kOpaque = 60;

struct Segments {
  CellBlock ends{};                                           // vertices of the chunk, in cells
  alignas(64) std::array<float, CellBlock::kSize> width_m{};  // a D, 0: no segment begins here
  alignas(64) std::array<float, CellBlock::kSize> depth{}, share{};
  alignas(64) std::array<std::int32_t, CellBlock::kSize> pieces{};
};

/// Widths of segments that begin at `first`...; 0 at the last vertex of each strand.
void segment_widths(const Strands& s, const Cutting& cutting, std::size_t first, std::size_t n,
                    Segments& out) noexcept {
  const float gain = cutting.opacity * cutting.factor;
  if (s.diameters_m.empty()) {
    std::fill_n(out.width_m.begin(), n, gain * s.diameter_m);
  } else {
    for (std::size_t i = 0; i < n; ++i) {
      const std::size_t next = std::min(first + i + 1, s.vertices.size() - 1);
      out.width_m[i] = 0.5F * gain * (s.diameters_m[first + i] + s.diameters_m[next]);
    }
  }
  // offsets[k] is the vertex behind strand k - 1.
  auto end = std::upper_bound(s.offsets.begin(), s.offsets.end(), first);
  for (; end != s.offsets.end() && *end <= first + n; ++end) out.width_m[*end - 1 - first] = 0;
}

/// Depth and number of the pieces of each segment. Parallel light: 1 / cell size is `per_m`.
PELAGE_CLONES void divide_segments(Segments& s, std::size_t n, float per_m, float per_cell) noexcept {
  for (std::size_t i = 0; i < n; ++i) {
    const float dx = s.ends.x[i + 1] - s.ends.x[i], dy = s.ends.y[i + 1] - s.ends.y[i],
                dz = s.ends.z[i + 1] - s.ends.z[i];
    const float ax = std::abs(dx), ay = std::abs(dy), az = std::abs(dz);
    const float across = ay > az ? ay : az;
    float pieces = per_cell * (ax > across ? ax : across);
    pieces = pieces < kMostPieces - 1 ? pieces : kMostPieces - 1;
    const auto count = static_cast<std::int32_t>(pieces) + 1;
    const float share = 1.0F / static_cast<float>(count);
    s.share[i] = share;
    s.depth[i] = s.width_m[i] * per_m * std::sqrt(dy * dy + dz * dz) * share;
    s.pieces[i] = s.depth[i] > 0 ? count : 0;
  }
}

using Four = float __attribute__((vector_size(16)));

void put(float* at, Four v) noexcept {
  std::memcpy(at, &v, sizeof v);
}

class Emitter {
 public:
  explicit Emitter(const std::function<void(PieceBlock&)>& sink) : sink_(sink) {}

  /// Pieces of segment i, four at a time: what is written behind the last is written over or has no depth.
  void segment(const Segments& s, std::size_t i) {
    const float share = s.share[i];
    const float dx = share * (s.ends.x[i + 1] - s.ends.x[i]), dy = share * (s.ends.y[i + 1] - s.ends.y[i]),
                dz = share * (s.ends.z[i + 1] - s.ends.z[i]);
    Four k{0.5F, 1.5F, 2.5F, 3.5F};
    for (std::int32_t left = s.pieces[i]; left > 0; left -= 4, k += 4.0F) {
      if (block_.count + 4 > CellBlock::kSize) flush();
      put(&block_.x[block_.count], s.ends.x[i] + k * dx);
      put(&block_.y[block_.count], s.ends.y[i] + k * dy);
      put(&block_.z[block_.count], s.ends.z[i] + k * dz);
      const float depth = s.depth[i];
      put(&block_.depth[block_.count], Four{depth, depth, depth, depth});
      block_.count += static_cast<std::size_t>(std::min(left, 4));
    }
  }
  void piece(glm::vec3 at, float depth) {
    if (block_.count == CellBlock::kSize) flush();
    block_.x[block_.count] = at.x, block_.y[block_.count] = at.y, block_.z[block_.count] = at.z;
    block_.depth[block_.count++] = depth;
  }
  void flush() {
    if (block_.count > 0) sink_(block_);
    block_.count = 0;
  }

 private:
  PieceBlock block_;
  const std::function<void(PieceBlock&)>& sink_;
};

bool inside(glm::vec3 p, glm::ivec3 cells) noexcept {
  return p.x >= 0 && p.y >= 0.5F && p.z >= 0.5F && p.x <= static_cast<float>(cells.x) &&
         p.y <= static_cast<float>(cells.y) - 0.5F && p.z <= static_cast<float>(cells.z) - 0.5F;
}

/// Cuts the segment a b down to where `inside` (linear along it) is not negative. @return whether anything is left
bool clip(glm::vec3& a, glm::vec3& b, float inside_a, float inside_b) noexcept {
  if (inside_a < 0 && inside_b < 0) return false;
  const float at = inside_a / (inside_a - inside_b);  // where it is 0; used only where the signs differ
  if (inside_a < 0)
    a = a + at * (b - a);
  else if (inside_b < 0)
    b = a + at * (b - a);
  return true;
}

/// To the frustum of a grid, where slopes are bounded and so is the number of pieces.
bool clip_to_frustum(glm::vec3& a, glm::vec3& b, const LightMapping& m, glm::ivec3 cells) noexcept {
  constexpr float kNear_m = 1e-5F;
  if (!clip(a, b, a.x - kNear_m, b.x - kNear_m)) return false;
  for (int axis = 1; axis < 3; ++axis) {
    const float low = (0.5F - m.offset[axis]) / m.cells_per_unit[axis];
    const float high = (static_cast<float>(cells[axis]) - 0.5F - m.offset[axis]) / m.cells_per_unit[axis];
    if (!clip(a, b, a[axis] - low * a.x, b[axis] - low * b.x)) return false;
    if (!clip(a, b, high * a.x - a[axis], high * b.x - b[axis])) return false;
  }
  return true;
}

/// A segment in the frustum of a point light; a, b in metres along its axes. The area that a piece blocks lies across
/// the ray r, where a cell of slopes du dv at distance x along the axis has the area x^3 du dv / |r|.
void radial_segment(glm::vec3 a, glm::vec3 b, float width_m, const LightMapping& m, const Cutting& cutting,
                    Emitter& emit) {
  if (!clip_to_frustum(a, b, m, cutting.cells)) return;
  if (a.x < b.x) std::swap(a, b);  // a is the farther one
  const glm::vec3 d = b - a;
  const float slope =
      std::max(std::max(std::abs(b.y), std::abs(b.z)) / b.x, std::max(std::abs(a.y), std::abs(a.z)) / a.x);
  const float turn = (std::max(std::abs(d.y), std::abs(d.z)) + slope * std::abs(d.x)) / b.x;
  const float cells = std::max(std::abs(d.x) * m.cells_per_unit.x, turn * m.cells_per_unit.y);
  const int n = cutting.split ? 1 + static_cast<int>(std::min(2.0F * cells, kMostPieces - 1)) : 1;
  const float per_cell = width_m * m.cells_per_unit.y * m.cells_per_unit.z / static_cast<float>(n);
  for (int k = 0; k < n; ++k) {
    const glm::vec3 p = a + (static_cast<float>(k) + 0.5F) / static_cast<float>(n) * d;
    const glm::vec3 at = m.cells_of_local(p);
    if (!inside(at, cutting.cells)) continue;
    const float across = glm::length(glm::cross(d, p));  // len sin |r|
    emit.piece(at, std::min(per_cell * across / (p.x * p.x * p.x), kOpaque));
  }
}

/// Every vertex once [Bertails2005 section 3.1].
void count_vertices(std::span<const glm::vec3> vertices, const LightMapping& mapping, const Cutting& cutting,
                    const std::function<void(PieceBlock&)>& sink) {
  PieceBlock block{};
  block.depth.fill(cutting.vertex_depth);
  for (std::size_t i = 0; i < vertices.size(); i += CellBlock::kSize) {
    block.count = std::min(CellBlock::kSize, vertices.size() - i);
    mapping.cells(vertices.subspan(i, block.count), block);
    for (std::size_t k = 0; cutting.cells.x > 0 && k < block.count; ++k) {
      block.depth[k] = inside({block.x[k], block.y[k], block.z[k]}, cutting.cells) ? cutting.vertex_depth : 0;
    }
    sink(block);
  }
}

}  // namespace

void cut_hair(const Strands& strands, const LightMapping& mapping, const Cutting& cutting, std::size_t first,
              std::size_t last, const std::function<void(PieceBlock&)>& sink) {
  Segments chunk;
  Emitter emit(sink);
  const std::span<const glm::vec3> vertices = strands.vertices;
  if (!cutting.area) return count_vertices(vertices.subspan(first, last - first), mapping, cutting, sink);
  for (; first < last; first += kChunk) {
    const std::size_t n = std::min(kChunk, last - first), read = std::min(n + 1, vertices.size() - first);
    segment_widths(strands, cutting, first, n, chunk);
    if (mapping.point_light) {
      for (std::size_t i = 0; i < n; ++i) {
        if (!(chunk.width_m[i] > 0)) continue;
        radial_segment(mapping.local(vertices[first + i]), mapping.local(vertices[first + i + 1]), chunk.width_m[i],
                       mapping, cutting, emit);
      }
      continue;
    }
    mapping.cells(vertices.subspan(first, read), chunk.ends);
    divide_segments(chunk, n, mapping.cells_per_unit.y, cutting.split ? 2.0F : 0.0F);
    for (std::size_t i = 0; i < n; ++i) emit.segment(chunk, i);
  }
  emit.flush();
}

}  // namespace pelage
