// What arrives from a light at a point without anything in between. CPU twin of shaders/common_lights.glsl.
#pragma once

#include <algorithm>
#include <glm/geometric.hpp>
#include <glm/vec3.hpp>
#include <limits>

#include "pelage/data_schema/scene.h"

namespace pelage {

/// Nearer to a point light its irradiance does not grow any more: 1 / distance^2 has no bound.
inline constexpr float kNearestLight_m = 1e-3F;

struct Arriving {
  glm::vec3 to_light;    // unit
  glm::vec3 irradiance;  // linear RGB on a surface that faces the light
  float distance_m;      // infinite for a directional light
};

/// At a point light's own position the direction is +Y: any is as good.
inline Arriving arriving(const Light& light, const glm::vec3& at) noexcept {
  const glm::vec3 irradiance = light.intensity * light.colour;
  if (!light.position) {
    return {glm::normalize(light.direction), irradiance, std::numeric_limits<float>::infinity()};
  }
  const glm::vec3 towards = *light.position - at;
  const float distance = glm::length(towards), bounded = std::max(distance, kNearestLight_m);
  return {distance > 0 ? towards / distance : glm::vec3(0, 1, 0), irradiance / (bounded * bounded), distance};
}

}  // namespace pelage
