// Where the head is. A point p of the groom, relative to the pivot, lies at  position + rotation p. In double: a head
// far from the origin moves as smoothly as one at it.
#pragma once

#include <glm/ext/quaternion_double.hpp>
#include <glm/vec3.hpp>

namespace pelage {

struct RigidPose {
  glm::dvec3 position{0};                   // of the pivot [m]
  glm::dquat rotation{1.0, 0.0, 0.0, 0.0};  // unit; w first
};

}  // namespace pelage
