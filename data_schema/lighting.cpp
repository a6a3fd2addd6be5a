#include "pelage/data_schema/lighting.h"

#include <cmath>
#include <glm/geometric.hpp>
#include <numbers>

namespace pelage {
namespace {

Light directional(glm::vec3 direction, glm::vec3 colour, float intensity, float size_deg) {
  Light light;
  light.direction = direction;
  light.colour = colour;
  light.intensity = intensity;
  light.size_deg = size_deg;
  return light;
}

/// For a face towards +Z that is seen from its left: the key light comes from the side that it is turned to.
std::vector<Light> portrait_lights() {
  return {directional({-0.28F, 0.60F, 0.75F}, {1.0F, 0.95F, 0.88F}, 1.05F, 16),  // key
          directional({0.95F, 0.25F, 0.35F}, {0.90F, 0.95F, 1.0F}, 0.25F, 30),   // fill
          directional({0.72F, 0.55F, -0.45F}, {0.88F, 0.94F, 1.0F}, 1.0F, 12)};  // rim
}

constexpr glm::vec3 kPortraitBackground{0.30F, 0.31F, 0.33F};

}  // namespace

void set_lighting(Scene& scene, Lighting lighting) {
  const bool portrait = lighting == Lighting::portrait;
  scene.lights = portrait ? portrait_lights() : std::vector<Light>{Light{}};
  scene.image.background = portrait ? kPortraitBackground : ImageSettings{}.background;
  scene.image.backdrop = portrait ? Backdrop::gradient : Backdrop::plain;
}

Light part_of(const Light& light, const glm::dvec2& place) noexcept {
  const glm::dvec3 z = glm::normalize(glm::dvec3(light.direction));
  const glm::dvec3 axis = std::abs(z.x) < 0.6 ? glm::dvec3(1, 0, 0) : glm::dvec3(0, 1, 0);
  const glm::dvec3 x = glm::normalize(glm::cross(axis, z)), y = glm::cross(z, x);
  const double radius = std::tan(0.5 * static_cast<double>(light.size_deg) * std::numbers::pi / 180);
  Light part = light;
  part.direction = glm::vec3(glm::normalize(z + radius * (place.x * x + place.y * y)));
  part.size_deg = 0;
  return part;
}

std::vector<Light> parts_of(const Light& light) {
  if (!has_size(light)) return {light};
  // A sunflower's seeds: each stands for the same area.
  constexpr double kGoldenAngle = 2.399963229728653;
  std::vector<Light> parts;
  for (std::size_t i = 0; i < kLightParts; ++i) {
    const double radius = std::sqrt((static_cast<double>(i) + 0.5) / static_cast<double>(kLightParts));
    const double angle = kGoldenAngle * static_cast<double>(i);
    parts.push_back(part_of(light, radius * glm::dvec2(std::cos(angle), std::sin(angle))));
  }
  return parts;
}

}  // namespace pelage
