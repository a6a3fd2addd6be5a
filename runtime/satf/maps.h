// re- and alpha-maps of every layer from any RecordSource [Xu2006 sections 6.2, eqs. 4, 6, 7 as DESIGN section 5 reads
// them].
//
// A row of a map is a plate. Within a plate the view angle is linear in u, so maps show no facets; neighbouring sectors
// overlap by half and are blended by optical depth, so they show no seams. Between plates the shader interpolates rows,
// moved by the HSV's mean drift. Alpha in the map is that of a flat slab: the chord of the curved ring, which stands
// still while strands drift, comes in where the map is read (otherwise its kinks would be smeared once per HSV: beads).
#pragma once

#include <cstdint>
#include <glm/vec3.hpp>
#include <optional>
#include <span>
#include <vector>

#include "pelage/data_schema/scene.h"
#include "pelage/satf/model.h"
#include "pelage/satf/plate_direction.h"

namespace pelage {

/// Texel as it goes to the GPU: alpha 10 bits [0,1] | re 12 bits [0,8) | transmittance (s-map) 10 bits [0,1].
using Texel = std::uint32_t;

struct TexelValues {
  float alpha, re, transmittance;
};
Texel pack_texel(const TexelValues& v) noexcept;
TexelValues unpack_texel(Texel t) noexcept;

/// What maps depend on besides the model.
struct MapRequest {
  glm::vec3 eye{0, 0, 1};       // metres
  glm::vec3 to_light{0, 1, 0};  // unit
  SatfSettings settings;
  std::optional<glm::vec3> light_place{};  // of a point light [m]: each plate has its own direction, not to_light
};

/// Optical depth of one ring of one instance as seen along `d`: [width], and straight reflectance for light `l` if `re`
/// is not empty: [width].
struct RingScratch {
  std::vector<float> tau, reflectance;  // one record
  std::vector<float> depth, weighted;   // ring with one record of padding
  std::vector<float> factors;
};
void ring_depth(const SatfModel& model, const RecordSource& source, std::size_t instance, int layer, int plate,
                const PlateDirection& d, const PlateDirection& l, bool curvature, RingScratch& scratch,
                std::span<float> depth, std::span<float> re) noexcept;

/// Fills `texels` [model.texels()]; transmittance comes from `shadows` (self_shadow.h, [texels], or empty: 1), or, with
/// SelfShadow::paper, from eq. 12 over the alpha-maps just built. Parallel; the same bytes for any number of threads.
void build_maps(const SatfModel& model, const RecordSource& source, const MapRequest& request,
                std::span<const std::uint16_t> shadows, std::span<Texel> texels);

/// The view as each plate sees it: cos and sin of phi, and azimuth_weight. [instance][plate]
std::vector<glm::vec3> plate_views(const SatfModel& model, glm::vec3 eye);

/// Alpha of the curved ring from that of the slab.
float curved_alpha(float slab_alpha, const RingShape& ring, float cos_t, float trust, float max_path) noexcept;

/// What the shader sees of one layer at texel coordinate x and plate coordinate `at` (both fractional): rows moved by
/// the HSV's mean drift, then interpolated [eq. 7], then curved if `views` is not empty. CPU twin of
/// shaders/hair_surface.frag, without its footprint and fades.
TexelValues sample_map(const SatfModel& model, std::span<const Texel> texels, std::size_t instance, int layer, float x,
                       float at, bool use_drift, std::span<const glm::vec3> views = {}) noexcept;

}  // namespace pelage
