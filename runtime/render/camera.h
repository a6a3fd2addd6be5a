// Camera matrices, and the camera that frames a hairstyle when the scene names none.
#pragma once

#include <glm/mat4x4.hpp>
#include <glm/vec3.hpp>
#include <span>
#include <vector>

#include "pelage/data_schema/mesh.h"
#include "pelage/data_schema/scene.h"
#include "pelage/data_schema/strands.h"

namespace pelage {

struct Bounds {
  glm::vec3 low{1e30F}, high{-1e30F};
  bool empty() const noexcept { return low.x > high.x; }
  void add(glm::vec3 p) noexcept {
    low = glm::min(low, p);
    high = glm::max(high, p);
  }
};

/// Returns what a picture of this hair is framed on [metres]: the vertices of all strands but stray ones, and those of
/// the head that lie near them, so that shoulders, a body, or a head of another scale do not make the hair small. A
/// strand is stray where it reaches more than twice as far from the middle of the roots as nineteen of twenty strands
/// do.
std::vector<glm::vec3> framed_points(const Strands& hair, const Mesh& head);

/// Returns the nearest camera that sees all points from the front (+Z), a little from the side and above, with a margin
/// of 4 % of the picture on the sides that they touch. No points: a cube of 0.2 m about the origin.
/// @param aspect  width over height of the picture, > 0
Camera framed_camera(std::span<const glm::vec3> points, float aspect);

/// World to clip. Near and far planes enclose the bounds as the camera sees them. @throws UsageError for eye = target
glm::mat4 world_to_clip(const Camera& camera, const Bounds& bounds, float aspect);

}  // namespace pelage
