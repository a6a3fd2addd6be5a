// A mannequin for the procedural grooms: head, ears, neck and shoulders, as a bust in a shop's window. A signed
// distance field made of smoothly joined ellipsoids and round cones, and its surface as a mesh. A face is suggested,
// nobody's; measures are those of an adult. Frame: metres, Y up, face towards +Z, left ear at +X; the middle of the
// head (chin to crown) near the origin. Limits: the field is a distance to first order near the surface and a lower
// estimate farther out.
#pragma once

#include <glm/vec3.hpp>
#include <vector>

#include "pelage/data_schema/mesh.h"

namespace pelage::hair {

struct HeadParameters {
  float height_m = 0.24F;  // crown to the middle of the neck, (0, 100]; everything scales with it
};

/// Signed distance [m], negative inside.
float head_distance_m(const HeadParameters& head, glm::vec3 p) noexcept;

/// Unit outward normal of the field at p (central differences).
glm::vec3 head_normal(const HeadParameters& head, glm::vec3 p) noexcept;

/// Closed, consistently oriented mesh of the surface. @throws UsageError for a height out of range
Mesh parametric_head(const HeadParameters& head);

/// The field sampled on a grid, for growing hair: one lookup gives distance and gradient (trilinear; within 2 mm at
/// the creases of ears and at the bust's edge, where it smooths them, and far closer on the skull). Beyond the grid the
/// distance is that of the nearest grid point plus the way there.
class HeadField {
 public:
  explicit HeadField(const HeadParameters& head);

  struct Sample {
    float distance_m;
    glm::vec3 gradient;  // outward, about unit length
  };
  Sample sample(glm::vec3 p) const noexcept;

 private:
  float at(int x, int y, int z) const noexcept;

  glm::vec3 origin_m_;
  float cell_m_;
  glm::ivec3 size_;
  std::vector<float> distances_m_;  // [z][y][x]
};

}  // namespace pelage::hair
