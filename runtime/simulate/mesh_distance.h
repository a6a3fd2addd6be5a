// Signed distance to a triangle mesh, sampled on a grid. Nodes within two cells of the surface have the exact distance
// to their nearest triangle and its side [Baerentzen2005]; from there both are carried outwards, each node taking the
// best of its neighbours' triangles until none improves.
//
// Open meshes: behind the surface is inside. Where the sides meet without a surface between them (a neck's cut, a hole)
// the field closes it by a cap halfway, so that the distance stays continuous; the cap is good to half a cell. Nothing
// farther than two cells outside the mesh's own box is inside: a sheet is a slab of that thickness or more.
// Between nodes the distance is trilinear, its error about curvature * cell^2 / 4; edges are rounded to half a cell.
// Beyond the box (mesh and 2 cm or 3 cells around it) it is that of the box's nearest point plus the way there.
#pragma once

#include <cstddef>
#include <cstdint>
#include <glm/vec3.hpp>
#include <vector>

#include "pelage/data_schema/mesh.h"
#include "pelage/simulate/strand_blocks.h"

namespace pelage {

struct SurfaceSample {
  float distance_m;  // negative inside
  glm::vec3 normal;  // outward, unit
};

class MeshDistance {
 public:
  /// @param cell_m  > 0; larger cells are taken where the mesh would need more than kMostNodes of them
  /// @throws InputError for a mesh that is not finite
  MeshDistance(const Mesh& mesh, float cell_m);

  static constexpr std::size_t kMostNodes = std::size_t{1} << 21;  // 8 MiB; 2.5 mm around a head; built in about 2 s

  bool empty() const noexcept { return values_.empty(); }  // no triangle with an area
  float cell_m() const noexcept { return cell_m_; }
  glm::vec3 origin_m() const noexcept { return origin_m_; }  // of node 0
  float radius_m() const noexcept { return radius_m_; }      // of a sphere around the origin that holds the grid
  std::size_t nodes() const noexcept { return values_.size(); }

  SurfaceSample sample(const glm::vec3& p) const noexcept;
  /// Of 16 points at once. False: all are farther than reach_m, and nothing is written.
  bool sample(const Lanes3& points, float reach_m, Lanes& distance, Lanes3& normal) const noexcept;

 private:
  void find_blocks();

  glm::vec3 origin_m_{0};
  float cell_m_ = 1, radius_m_ = 0;
  glm::ivec3 size_{0};          // nodes
  glm::ivec3 block_size_{0};    // blocks of 4 x 4 x 4 cells
  std::vector<float> values_;   // [z][y][x] metres
  std::vector<float> nearest_;  // [block z][y][x] least value of the nodes around its cells
};

}  // namespace pelage
