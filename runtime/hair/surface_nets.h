// Surface nets [Gibson1998, Constrained Elastic Surface Nets, without the relaxation]: one vertex per grid cell that
// the surface crosses, at the mean of the crossings of its edges; one quad per crossed grid edge. Closed where the
// field is positive on the grid's border; sheets closer than a cell may share an edge.
#pragma once

#include <functional>
#include <glm/vec3.hpp>

#include "pelage/data_schema/mesh.h"

namespace pelage::hair {

struct Grid {
  glm::vec3 origin_m;
  float cell_m;
  glm::ivec3 size;  // points per axis

  glm::vec3 point(glm::ivec3 i) const noexcept { return origin_m + cell_m * glm::vec3(i); }
};

/// Mesh of the zero level of `field` (negative inside) without normals; triangles counter-clockwise seen from outside.
Mesh surface_nets(const Grid& grid, const std::function<float(glm::vec3)>& field);

}  // namespace pelage::hair
