// Hair cut into pieces that a grid can take: each a place in cells and the optical depth of one cell that it blocks.
//
// Corrected [DESIGN section 6]: a piece blocks a D len sin(segment, ray); segments are cut so that no coordinate
// advances by more than half a cell per piece. As printed [Bertails2005 section 3.1]: every vertex counts once,
// whatever its segment.
#pragma once

#include <cstddef>
#include <functional>

#include "pelage/data_schema/strands.h"
#include "pelage/shadow/depth_grid.h"
#include "pelage/shadow/light_mapping.h"

namespace pelage {

struct Cutting {
  bool area = true;        // off: one piece per vertex, of `vertex_depth`
  bool split = true;       // off: one piece per segment
  float opacity = 1;       // a
  float vertex_depth = 0;  // optical depth of a counted vertex
  float factor = 1;        // gain on all depths
  glm::ivec3 cells{0};     // of the grid: pieces beside it are left out (faces of a point light)
};

/// The pieces of vertices [first, last) and of the segments that begin there, in blocks of at most CellBlock::kSize.
void cut_hair(const Strands& strands, const LightMapping& mapping, const Cutting& cutting, std::size_t first,
              std::size_t last, const std::function<void(PieceBlock&)>& sink);

/// Width of the fibre at a vertex [m].
inline float diameter_at(const Strands& strands, std::size_t vertex) noexcept {
  return strands.diameters_m.empty() ? strands.diameter_m : strands.diameters_m[vertex];
}

}  // namespace pelage
