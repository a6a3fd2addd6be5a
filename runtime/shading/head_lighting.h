// How the head under the hair reflects: like a shop-window mannequin, matte and of a light warm grey, so that nothing
// of it draws the eye from the hair. CPU twin of shaders/common_head.glsl.
#pragma once

#include <algorithm>
#include <glm/geometric.hpp>
#include <glm/vec3.hpp>

namespace pelage {

inline constexpr glm::vec3 kHeadColour{0.39F, 0.365F, 0.34F};  // linear RGB
inline constexpr float kHeadAmbient = 0.15F;  // share of the irradiance that no shadow reaches, where it faces sideways
inline constexpr float kHeadSky = 0.35F;      // by what share of that more comes from above, and less from below
inline constexpr float kHeadWrap = 0.5F;      // light reaches this far around

/// Of a light of unit irradiance, per unit of colour: 1 where the surface faces it, then falling smoothly to 0 at a
/// cosine of -kHeadWrap, where a Lambertian surface has an edge. n, l: unit. In [0, 1].
inline float head_direct(const glm::vec3& n, const glm::vec3& l) noexcept {
  const float wrapped = std::max((glm::dot(n, l) + kHeadWrap) / (1 + kHeadWrap), 0.0F);
  return std::min(wrapped * wrapped, 1.0F);
}

/// The same for what no shadow reaches.
inline float head_ambient(const glm::vec3& n) noexcept {
  return kHeadAmbient * (1 + kHeadSky * n.y);
}

}  // namespace pelage
