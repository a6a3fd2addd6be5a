// s-maps that follow the light [Xu2006 section 6.4; DESIGN section 5]: transmittance at every texel.
//
// On the lit side the light's ray from a texel crosses the outer layers at other azimuths than the texel's own: their
// optical depth as seen from the light is looked up there ("ring hit"), and half of the own layer counts. On the unlit
// side: mean density of the plate times the path to the envelope. Between the two the depths are blended over
// |cos theta| < 1/4. What lies outside the cluster comes from a density map at the point where the ray leaves the
// envelope. The paper's own setting (eq. 12) depends on the view's alpha and is part of maps.h.
#pragma once

#include <cstdint>
#include <glm/vec3.hpp>
#include <optional>
#include <span>
#include <vector>

#include "pelage/satf/model.h"
#include "pelage/shadow/density_map.h"

namespace pelage {

struct ShadowRequest {
  glm::vec3 to_light{0, 1, 0};             // unit
  bool self_shadow = true;                 // within the cluster, following the light
  bool curvature = true;                   // the chord of the curved ring, as the picture has it
  const DensityMap* others = nullptr;      // shadow of everything beyond the envelope; null: none
  std::optional<glm::vec3> light_place{};  // of a point light [m]: each plate has its own direction, not to_light
};

/// Fills `shadows` [model.texels()] with transmittance in 1/65535. Depends on light and geometry, not on the view.
void build_shadows(const SatfModel& model, const RecordSource& source, const ShadowRequest& request,
                   std::span<std::uint16_t> shadows);

/// The strands of all instances, a vertex per plate that they cross, for the density map.
Strands hair_strands(const Hairstyle& style, const SatfModel& model);

}  // namespace pelage
