// Private to this box: rays from a point to a light.
#pragma once

#include <cmath>
#include <glm/geometric.hpp>

#include "pelage/data_schema/errors.h"
#include "pelage/data_schema/scene.h"
#include "pelage/reference/fibre_scene.h"

namespace pelage {

/// @throws UsageError
inline void check_light(const Light& light) {
  const glm::dvec3 given(light.position ? *light.position : light.direction);
  const double length = glm::length(given);
  if (!std::isfinite(length) || (!light.position && length == 0)) {
    throw UsageError("light: no direction or position; give finite numbers, and a direction a length");
  }
}

/// At a point light's own position the ray has no length.
inline FibreRay ray_to_light(const Light& light, const glm::dvec3& from) noexcept {
  if (!light.position) return {from, glm::normalize(glm::dvec3(light.direction))};
  const glm::dvec3 way = glm::dvec3(*light.position) - from;
  const double length = glm::length(way);
  return {from, length > 0 ? way / length : glm::dvec3(0, 1, 0), length};
}

/// Unit vectors: two across a direction, and itself.
struct LightFrame {
  glm::dvec3 x, y, z;
  explicit LightFrame(const glm::dvec3& direction) noexcept : z(direction) {
    const glm::dvec3 axis = std::abs(z.x) < 0.6 ? glm::dvec3(1, 0, 0) : glm::dvec3(0, 1, 0);
    x = glm::normalize(glm::cross(axis, z));
    y = glm::cross(z, x);
  }
};

}  // namespace pelage
