// Triangle mesh: a head or a body under the hair. Metres, Y up.
#pragma once

#include <cstdint>
#include <glm/vec3.hpp>
#include <vector>

namespace pelage {

struct Mesh {
  std::vector<glm::vec3> vertices;    // metres
  std::vector<glm::vec3> normals;     // [vertices] unit, outward
  std::vector<glm::uvec3> triangles;  // counter-clockwise seen from outside
};

/// Area-weighted vertex normals of a mesh without any.
void compute_normals(Mesh& mesh);

}  // namespace pelage
