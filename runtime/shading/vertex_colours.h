// Colours of vertices on the CPU, as [Bertails2005 section 3.3] sends them to the GPU: ambient + T (diffuse +
// specular), Kajiya-Kay with the material's primary highlight, unshifted. For engines that shade per vertex, and for
// the measure of the whole of paper A; the strand renderer shades per fragment. Vertices do not
// know their strand: the material's variation is not seen here.
#pragma once

#include <cstdint>
#include <glm/vec3.hpp>
#include <span>

#include "pelage/data_schema/scene.h"

namespace pelage {

struct ColourRequest {
  Light light;
  glm::vec3 eye{0, 0, 1};  // metres
  HairMaterial material;
};

/// 8-bit linear RGB, red in the lowest byte, alpha 255. Within one step of lobes.h rounded to 8 bits.
/// @param tangents  unit    @param transmittance  [0, 1]; all spans as long as `points`
void vertex_colours(const ColourRequest& request, std::span<const glm::vec3> points,
                    std::span<const glm::vec3> tangents, std::span<const float> transmittance,
                    std::span<std::uint32_t> colours);

}  // namespace pelage
