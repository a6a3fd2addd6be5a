// Camera matrices, and the camera that frames a hairstyle when the scene names none.
#pragma once

#include <glm/mat4x4.hpp>
#include <glm/vec3.hpp>

#include "pelage/data_schema/scene.h"

namespace pelage {

struct Bounds {
  glm::vec3 low{1e30F}, high{-1e30F};
  bool empty() const noexcept { return low.x > high.x; }
  void add(glm::vec3 p) noexcept {
    low = glm::min(low, p);
    high = glm::max(high, p);
  }
};

/// Looks at the middle of the bounds from the front (+Z), a little from the side and above, far enough to see them
/// whole.
Camera framed_camera(const Bounds& bounds, float aspect);

/// World to clip. Near and far planes enclose the bounds as the camera sees them. @throws UsageError for eye = target
glm::mat4 world_to_clip(const Camera& camera, const Bounds& bounds, float aspect);

}  // namespace pelage
