// Surfaces of the cluster layers as triangles, and the order in which they are drawn. No OpenGL here.
//
// A layer is drawn where a ray enters it: its outer surface where that faces the viewer, its inner surface where the
// viewer looks at the cluster's far side from within (records are parametrised the same way, db/record_source.h). A
// patch is one HSV's piece of a layer; each of its two quads is drawn or not by its own plane, so that both silhouettes
// close. Patches whose sectors hold no strand are left out.
#pragma once

#include <cstdint>
#include <glm/vec2.hpp>
#include <glm/vec3.hpp>
#include <span>
#include <vector>

#include "pelage/data_schema/scene.h"
#include "pelage/satf/model.h"

namespace pelage {

struct SurfaceVertex {
  glm::vec3 position;    // metres
  glm::vec3 tangent;     // along the strands, not normalised
  glm::vec3 normal;      // outward, unit
  glm::vec2 map_at;      // texel around (unwrapped), plate
  std::uint32_t map_id;  // instance * layers + layer, + kInnerSurface
  glm::vec2 azimuth;     // cos and sin of u
};

/// Marks map_id on inner surfaces.
inline constexpr std::uint32_t kInnerSurface = 0x80000000U;

struct Patch {
  std::uint32_t outer, inner;    // first vertex of the outer and the inner surface
  std::uint32_t next_plate;      // vertices from one plate to the next; the next column is the next vertex
  std::uint32_t instance_layer;  // instance * layers + layer
  glm::vec3 outer_centre, outer_normal, inner_centre, inner_normal;  // of the two quads, normals outward
};

struct HairSurfaces {
  std::vector<SurfaceVertex> vertices;
  std::vector<Patch> patches;
  std::vector<glm::vec3> instance_centres;
};

HairSurfaces make_surfaces(const SatfModel& model);

/// Triangle indices in drawing order for a viewer at `eye`. DrawOrder::exact needs no order and gets the cheapest.
std::vector<std::uint32_t> ordered_indices(const HairSurfaces& surfaces, const Division& division, DrawOrder order,
                                           glm::vec3 eye);

}  // namespace pelage
