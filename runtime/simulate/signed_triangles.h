// Triangles that know their nearest point to a place, and on which side of them it lies: the sign of the angle-weighted
// pseudonormal of the nearest corner, edge or face [Baerentzen2005]. That is right for every closed mesh; at the rim of
// an open one the side is that of the plane at the rim. All in double.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <glm/vec3.hpp>
#include <vector>

#include "pelage/data_schema/mesh.h"

namespace pelage {

class SignedTriangles {
 public:
  /// Corners at the same place become one; triangles without area are left out; a solid that is inside out is turned.
  /// @throws InputError for a vertex that is not finite or an index beyond the vertices
  explicit SignedTriangles(const Mesh& mesh);

  std::size_t size() const noexcept { return corners_.size(); }
  glm::dvec3 corner(std::size_t triangle, std::size_t k) const noexcept { return vertices_[corners_[triangle][k]]; }

  double distance(std::size_t triangle, const glm::dvec3& p) const noexcept;
  /// Whether p lies behind the triangle, where that is the nearest of all.
  bool inside(std::size_t triangle, const glm::dvec3& p) const noexcept;

 private:
  void weld(const Mesh& mesh);
  void turn_outwards();
  void find_normals();

  std::vector<glm::dvec3> vertices_;
  std::vector<std::array<std::uint32_t, 3>> corners_;    // [triangle]
  std::vector<glm::dvec3> face_normals_;                 // [triangle] unit
  std::vector<std::array<glm::dvec3, 3>> edge_normals_;  // [triangle] of the edges from corner k to k + 1, any length
  std::vector<glm::dvec3> vertex_normals_;               // [vertex] any length
};

}  // namespace pelage
