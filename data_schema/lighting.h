// Lightings by name, and lights that have a size.
#pragma once

#include <glm/vec2.hpp>
#include <string>
#include <vector>

#include "pelage/data_schema/scene.h"

namespace pelage {

/// paper: the one small light of the papers on a plain backdrop, as a scene has it that says nothing.
/// portrait: a large warm key light, a fill light and a cool rim light for the framed camera, which looks from
/// (0.55, 0.18, 1), over a grey backdrop that fades to the corners.
enum class Lighting { paper, portrait };

/// Sets lights, background and backdrop; nothing else.
void set_lighting(Scene& scene, Lighting lighting);

/// Places that stand for the disc of a light of some size.
inline constexpr std::size_t kLightParts = 8;

/// Does light come from a disc? Only a directional one's does.
inline bool has_size(const Light& light) noexcept {
  return light.size_deg > 0 && !light.position;
}

/// What is seen of the light at one place of its disc: the same light from there, of no size.
/// @param place  in the unit disc; (0, 0) is the light's own direction
Light part_of(const Light& light, const glm::dvec2& place) noexcept;

/// kLightParts such lights, spread evenly over the disc; the light itself where it has no size.
std::vector<Light> parts_of(const Light& light);

}  // namespace pelage
