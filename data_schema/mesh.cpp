#include "pelage/data_schema/mesh.h"

#include <glm/geometric.hpp>

namespace pelage {

// The cross product's length is twice the triangle's area, so that summing it as it is weights by area. A vertex
// without any area around it looks up.
void compute_normals(Mesh& mesh) {
  std::vector<glm::dvec3> sums(mesh.vertices.size(), glm::dvec3(0.0));
  for (const glm::uvec3& triangle : mesh.triangles) {
    const glm::dvec3 a(mesh.vertices[triangle.x]), b(mesh.vertices[triangle.y]), c(mesh.vertices[triangle.z]);
    const glm::dvec3 twice_area = glm::cross(b - a, c - a);
    for (int i = 0; i < 3; ++i) sums[triangle[i]] += twice_area;
  }
  mesh.normals.assign(mesh.vertices.size(), glm::vec3(0, 1, 0));
  for (std::size_t i = 0; i < sums.size(); ++i)
    if (const double length = glm::length(sums[i]); length > 0) mesh.normals[i] = glm::vec3(sums[i] / length);
}

}  // namespace pelage
