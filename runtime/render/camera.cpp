#include "pelage/render/camera.h"

#include <algorithm>
#include <cmath>
#include <glm/ext/matrix_clip_space.hpp>
#include <glm/ext/matrix_transform.hpp>
#include <glm/geometric.hpp>
#include <glm/trigonometric.hpp>

#include "pelage/data_schema/errors.h"

namespace pelage {
namespace {

/// Room around the framed hair: its box fills 1 / kFrameMargin of the picture's height or width.
constexpr float kFrameMargin = 1.04F;

}  // namespace

Camera framed_camera(const Bounds& bounds, float aspect) {
  Camera camera;
  const Bounds b = bounds.empty() ? Bounds{glm::vec3(-0.1F), glm::vec3(0.1F)} : bounds;
  camera.target = 0.5F * (b.low + b.high);
  const glm::vec3 from = glm::normalize(glm::vec3(0.55F, 0.18F, 1.0F));
  const glm::vec3 side = glm::normalize(glm::cross(camera.up, from)), above = glm::cross(from, side);
  const float tangent = std::tan(glm::radians(0.5F * camera.fov_deg)) / kFrameMargin;
  float distance = 1e-3F;
  for (int i = 0; i < 8; ++i) {
    const glm::vec3 corner{i & 1 ? b.high.x : b.low.x, i & 2 ? b.high.y : b.low.y, i & 4 ? b.high.z : b.low.z};
    const glm::vec3 p = corner - camera.target;
    const float across = std::max(std::abs(glm::dot(p, side)) / aspect, std::abs(glm::dot(p, above)));
    distance = std::max(distance, glm::dot(p, from) + across / tangent);
  }
  camera.eye = camera.target + from * distance;
  return camera;
}

glm::mat4 world_to_clip(const Camera& camera, const Bounds& bounds, float aspect) {
  const glm::vec3 forward = camera.target - camera.eye;
  const float length = glm::length(forward);
  if (!(length > 0.0F) || !std::isfinite(length)) {
    throw UsageError("camera: eye and target are the same point; give two different ones");
  }
  const bool parallel = glm::length(glm::cross(forward / length, camera.up)) < 1e-4F * glm::length(camera.up);
  const glm::vec3 up = parallel ? glm::vec3(0, 0, forward.y > 0 ? -1 : 1) : camera.up;
  float nearest = 1e30F, farthest = 0.0F;
  for (int i = 0; i < 8; ++i) {
    const glm::vec3 corner{i & 1 ? bounds.high.x : bounds.low.x, i & 2 ? bounds.high.y : bounds.low.y,
                           i & 4 ? bounds.high.z : bounds.low.z};
    const float depth = glm::dot(corner - camera.eye, forward / length);
    nearest = std::min(nearest, depth);
    farthest = std::max(farthest, depth);
  }
  if (bounds.empty()) nearest = 0.5F * length, farthest = 2.0F * length;
  // Inside or behind the hair: the near plane stays in front of the eye and 1/10,000 of the far plane keeps depth
  // precise.
  farthest = std::max(farthest * 1.01F, 1e-3F * length);
  nearest = std::max(nearest * 0.99F, farthest * 1e-4F);
  return glm::perspective(glm::radians(camera.fov_deg), aspect, nearest, farthest) *
         glm::lookAt(camera.eye, camera.target, up);
}

}  // namespace pelage
