// Private to this box: where cells and bricks of the voxel grid lie. Cells are anchored at the origin of the grid
// frame, so what a vertex finds does not depend on which bricks exist. A brick is kEdge^3 cells and holds their nodes,
// the far faces' too (the apron), so that the eight nodes of any cell lie in one brick at fixed offsets. A dense
// directory over a box of bricks tells which exist.
#pragma once

#include <cstddef>
#include <cstdint>
#include <glm/vec3.hpp>

#include "pelage/simulate/strand_blocks.h"

namespace pelage::grid {

inline constexpr int kEdge = 4;          // cells along a brick's edge, a power of two
inline constexpr int kSide = kEdge + 1;  // nodes along a brick's edge with the apron
inline constexpr int kOwn = kEdge * kEdge * kEdge;
inline constexpr int kNodes = kSide * kSide * kSide;
inline constexpr float kFarthest = 2e6F;  // cells from the origin; farther, a float has no digits left for the weights

/// A box of bricks.
struct Box {
  glm::ivec3 low{0};   // brick
  glm::ivec3 size{0};  // bricks
  std::uint32_t count() const noexcept {
    return static_cast<std::uint32_t>(size.x) * static_cast<std::uint32_t>(size.y) * static_cast<std::uint32_t>(size.z);
  }
  bool holds(const glm::ivec3& b) const noexcept {
    const glm::ivec3 d = b - low;
    return d.x >= 0 && d.y >= 0 && d.z >= 0 && d.x < size.x && d.y < size.y && d.z < size.z;
  }
  std::uint32_t key(const glm::ivec3& b) const noexcept {
    const glm::ivec3 d = b - low;
    return static_cast<std::uint32_t>((d.z * size.y + d.y) * size.x + d.x);
  }
  glm::ivec3 brick(std::uint32_t key) const noexcept {
    const auto k = static_cast<int>(key);
    return low + glm::ivec3(k % size.x, k / size.x % size.y, k / (size.x * size.y));
  }
};

/// Vertex i of the strands of a block.
struct alignas(64) Places {
  float fx[kLanes], fy[kLanes], fz[kLanes];  // within the cell, [0, 1]
  std::uint32_t key[kLanes];                 // of the brick; box.count(): none
  std::uint32_t node[kLanes];                // of the cell's low corner, within the brick
};

/// @param counts  of each lane: 0: it has no vertex here
/// Not finite: outside. Weights (1 - f, f) are >= 0 and add up to 1 to an ulp, on faces too: floor(u) + f = u.
[[gnu::always_inline]] inline void locate(const Lanes3& root, const Lanes3& position, const std::int32_t* counts,
                                          float cells_per_m, const Box& box, Places& out) noexcept {
  const std::int32_t low_x = box.low.x * kEdge, low_y = box.low.y * kEdge, low_z = box.low.z * kEdge;
  const std::int32_t size_x = box.size.x, size_y = box.size.y, size_z = box.size.z;
  const std::uint32_t none = box.count();
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
    const std::int32_t bx = cx / kEdge, by = cy / kEdge, bz = cz / kEdge;
    const bool inside =
        (cx >= 0) & (cy >= 0) & (cz >= 0) & (bx < size_x) & (by < size_y) & (bz < size_z) & finite & (counts[k] != 0);
    const std::uint32_t key =
        (static_cast<std::uint32_t>(bz) * static_cast<std::uint32_t>(size_y) + static_cast<std::uint32_t>(by)) *
            static_cast<std::uint32_t>(size_x) +
        static_cast<std::uint32_t>(bx);
    const std::int32_t node = ((cz & (kEdge - 1)) * kSide + (cy & (kEdge - 1))) * kSide + (cx & (kEdge - 1));
    out.key[k] = inside ? key : none;
    out.node[k] = static_cast<std::uint32_t>(inside ? node : 0);
  }
}

}  // namespace pelage::grid
