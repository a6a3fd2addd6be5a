// Private to this box: where the nodes of the voxel grid lie. Cells are anchored at the origin of the grid frame, so
// what a vertex finds does not depend on what else exists. Nodes come in rows of kRow along x, which hold the first
// node of the next row too, so that both ends of a cell's edge along x lie in one row: a vertex has four rows. A dense
// directory over a box of rows tells which exist; the box has a margin of rows that never do, so neighbours need no
// check.
#pragma once

#include <cstddef>
#include <cstdint>
#include <cstring>
#include <glm/vec3.hpp>
#include <vector>

#include "pelage/simulate/lane_math.h"
#include "pelage/simulate/strand_blocks.h"

namespace pelage::grid {

inline constexpr int kRow = 8;                   // nodes of a row, a power of two
inline constexpr std::uint32_t kNodeFloats = 4;  // mass and momentum, later F and c (grid_nodes.h)
inline constexpr std::uint32_t kRowFloats = kNodeFloats * (kRow + 1);
using Float8 = float __attribute__((vector_size(32), aligned(4), may_alias));  // a row, or the two ends of an edge
using Float4 = float __attribute__((vector_size(16), aligned(4), may_alias));  // a node
static_assert(kRow == 8);
inline constexpr float kFarthest = 2e6F;  // cells from the origin; farther, a float has no digits left for the weights

/// A box of rows. Cells and nodes are counted from `low`: along x in rows of kRow.
struct Box {
  glm::ivec3 low{0};   // cell of the first row
  glm::ivec3 size{3};  // rows along x, y, z; the first and the last two along each axis hold no vertex
  std::uint32_t up_x() const noexcept { return static_cast<std::uint32_t>(size.y); }
  std::uint32_t up_z() const noexcept {
    return static_cast<std::uint32_t>(size.x) * static_cast<std::uint32_t>(size.y);
  }
  std::uint32_t count() const noexcept { return up_z() * static_cast<std::uint32_t>(size.z); }
  /// First node of a row.
  glm::ivec3 node(std::uint32_t key) const noexcept {
    const auto k = static_cast<int>(key);
    return low + glm::ivec3(k / size.y % size.x * kRow, k % size.y, k / (size.x * size.y));
  }
};

/// Rows of a box that exist: [box.count(), up to a multiple of kDirectoryStep] where a row's floats begin; 0: it does
/// not exist. Row 0 is nobody's: what counts nowhere goes there.
using Directory = std::vector<std::uint32_t>;
inline constexpr std::uint32_t kDirectoryStep = 16;
inline std::size_t directory_size(const Box& box) noexcept {
  return (std::size_t{box.count()} + kDirectoryStep - 1) / kDirectoryStep * kDirectoryStep;
}

/// Floats at which the four edges along x of a vertex's cell begin: y + 2 z. Two of them at once: neighbours in memory.
PELAGE_INLINE void edges_of(const std::uint32_t* directory, std::uint32_t key, std::uint32_t node, std::uint32_t up_z,
                            std::uint32_t* edges) noexcept {
  std::uint64_t low, high;
  std::memcpy(&low, directory + key, sizeof low);
  std::memcpy(&high, directory + key + up_z, sizeof high);
  const std::uint64_t both = node * 0x100000001ULL;
  low += both;
  high += both;
  std::memcpy(edges, &low, sizeof low);
  std::memcpy(edges + 2, &high, sizeof high);
}

/// Vertex i of the strands of a block.
struct alignas(64) Places {
  float fx[kLanes], fy[kLanes], fz[kLanes];  // within the cell, [0, 1]
  std::uint32_t key[kLanes];                 // of the row of the cell's low corner; 0, a row of the margin: outside
  std::uint32_t node[kLanes];                // float of that corner within the row
};

/// @param counts  of each lane: 0: it has no vertex here
/// Not finite: outside. Weights (1 - f, f) are >= 0 and add up to 1 to an ulp, on faces too: floor(u) + f = u.
PELAGE_INLINE void locate(const Lanes3& root, const Lanes3& position, const std::int32_t* counts, float cells_per_m,
                          const Box& box, Places& out) noexcept {
  const std::int32_t low_x = box.low.x, low_y = box.low.y, low_z = box.low.z;
  const std::int32_t size_x = box.size.x, size_y = box.size.y, size_z = box.size.z;
  for (int k = 0; k < kLanes; ++k) {
    float x = (root.x[k] + position.x[k]) * cells_per_m;
    float y = (root.y[k] + position.y[k]) * cells_per_m;
    float z = (root.z[k] + position.z[k]) * cells_per_m;
    const bool finite = (x - x) + (y - y) + (z - z) == 0;
    x = x > -kFarthest ? x : -kFarthest;  // conversions to int stay defined
    y = y > -kFarthest ? y : -kFarthest;
    z = z > -kFarthest ? z : -kFarthest;
    x = x < kFarthest ? x : kFarthest;
    y = y < kFarthest ? y : kFarthest;
    z = z < kFarthest ? z : kFarthest;
    std::int32_t cx = static_cast<std::int32_t>(x), cy = static_cast<std::int32_t>(y),
                 cz = static_cast<std::int32_t>(z);
    cx -= x < static_cast<float>(cx);
    cy -= y < static_cast<float>(cy);
    cz -= z < static_cast<float>(cz);
    out.fx[k] = x - static_cast<float>(cx);
    out.fy[k] = y - static_cast<float>(cy);
    out.fz[k] = z - static_cast<float>(cz);
    cx -= low_x;
    cy -= low_y;
    cz -= low_z;
    const bool inside = (cx >= kRow) & (cy >= 1) & (cz >= 1) & (cx < (size_x - 2) * kRow) & (cy < size_y - 2) &
                        (cz < size_z - 2) & finite & (counts[k] != 0);
    const auto ux = static_cast<std::uint32_t>(cx), uy = static_cast<std::uint32_t>(cy),
               uz = static_cast<std::uint32_t>(cz);
    const std::uint32_t key =
        (uz * static_cast<std::uint32_t>(size_x) + ux / kRow) * static_cast<std::uint32_t>(size_y) + uy;
    out.key[k] = inside ? key : 0;
    out.node[k] = inside ? (ux % kRow) * kNodeFloats : 0;
  }
}

PELAGE_INLINE const Float8& row_of(const float* values) noexcept {
  return *reinterpret_cast<const Float8*>(values);
}
PELAGE_INLINE Float8& row_of(float* values) noexcept {
  return *reinterpret_cast<Float8*>(values);
}

/// Eight nodes' four floats, to four rows.
PELAGE_INLINE void to_rows(const float* nodes, Float8& a, Float8& b, Float8& c, Float8& d) noexcept {
  const Float8 n01 = row_of(nodes), n23 = row_of(nodes + 8), n45 = row_of(nodes + 16), n67 = row_of(nodes + 24);
  const Float8 ab_low = __builtin_shufflevector(n01, n23, 0, 4, 8, 12, 1, 5, 9, 13);
  const Float8 ab_high = __builtin_shufflevector(n45, n67, 0, 4, 8, 12, 1, 5, 9, 13);
  const Float8 cd_low = __builtin_shufflevector(n01, n23, 2, 6, 10, 14, 3, 7, 11, 15);
  const Float8 cd_high = __builtin_shufflevector(n45, n67, 2, 6, 10, 14, 3, 7, 11, 15);
  a = __builtin_shufflevector(ab_low, ab_high, 0, 1, 2, 3, 8, 9, 10, 11);
  b = __builtin_shufflevector(ab_low, ab_high, 4, 5, 6, 7, 12, 13, 14, 15);
  c = __builtin_shufflevector(cd_low, cd_high, 0, 1, 2, 3, 8, 9, 10, 11);
  d = __builtin_shufflevector(cd_low, cd_high, 4, 5, 6, 7, 12, 13, 14, 15);
}

/// And back.
PELAGE_INLINE void to_nodes(const Float8& a, const Float8& b, const Float8& c, const Float8& d, float* nodes) noexcept {
  const Float8 ab_low = __builtin_shufflevector(a, b, 0, 8, 1, 9, 2, 10, 3, 11);
  const Float8 ab_high = __builtin_shufflevector(a, b, 4, 12, 5, 13, 6, 14, 7, 15);
  const Float8 cd_low = __builtin_shufflevector(c, d, 0, 8, 1, 9, 2, 10, 3, 11);
  const Float8 cd_high = __builtin_shufflevector(c, d, 4, 12, 5, 13, 6, 14, 7, 15);
  row_of(nodes) = __builtin_shufflevector(ab_low, cd_low, 0, 1, 8, 9, 2, 3, 10, 11);
  row_of(nodes + 8) = __builtin_shufflevector(ab_low, cd_low, 4, 5, 12, 13, 6, 7, 14, 15);
  row_of(nodes + 16) = __builtin_shufflevector(ab_high, cd_high, 0, 1, 8, 9, 2, 3, 10, 11);
  row_of(nodes + 24) = __builtin_shufflevector(ab_high, cd_high, 4, 5, 12, 13, 6, 7, 14, 15);
}

}  // namespace pelage::grid
