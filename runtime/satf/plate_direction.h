// A direction as one plate sees it, and what a ring of sectors stops of light along it.
//
// Disk coordinates: delta = S^-1 d for the in-plane unit direction d. At azimuth u the angle from outward is
// theta = phi - u, phi the azimuth of delta: linear in u. Sector coordinates stretch it: tan theta' = (height / width)
// tan theta, whatever S is, because J = S [width * around, height * outward].
#pragma once

#include <glm/vec2.hpp>
#include <glm/vec3.hpp>
#include <optional>
#include <span>

#include "pelage/satf/model.h"

namespace pelage {

struct PlateDirection {
  glm::vec2 disk{1, 0};   // unit, cos and sin of phi
  float phi = 0;          // azimuth [rad] in disk coordinates
  float plane_angle = 0;  // azimuth [rad] of d in the plate plane (physical)
  float stretch = 1;      // |S^-1 d| [1/m] for the unit in-plane d
  float planar = 0;       // length of the direction's in-plane part, [0, 1]: 0 looks along the cluster's axis
};

/// @param towards  unit vector towards viewer or light. Where it runs along the axis the azimuth is undefined: then
///                 phi = 0 and planar tells by how much to trust it.
PlateDirection plate_direction(const Frame& frame, const CrossSection& s, glm::vec3 towards) noexcept;

/// Unit vector from a plate at `from` towards a light: `to_light`, or the way to a point light's place.
glm::vec3 towards_light(const glm::vec3& to_light, const std::optional<glm::vec3>& place,
                        const glm::vec3& from) noexcept;

/// Layer as the maps see it: radii in disk coordinates and the size of a sector in them.
struct RingShape {
  float inner, outer;   // v
  float width, height;  // of a sector: arc at the middle radius, and outer - inner
  int sectors;
};
RingShape ring_shape(const Division& division, int layer) noexcept;

/// Sector-coordinate angle of the disk angle theta [rad], continuous: warp(theta + 2 pi) = warp(theta) + 2 pi.
float warp_angle(const RingShape& ring, float theta) noexcept;

/// Weight in [0,1] of the azimuth-dependent answer: 0 along the axis, 1 from `planar` = 0.2 on, smooth between, so that
/// maps are continuous around the axis (HARD_CASES 14).
float azimuth_weight(float planar) noexcept;

/// Chord of the curved ring over the slab's path at an angle theta from outward, in [0, 2]: near side from the outer
/// surface inwards, far side (cos_t < 0) from the inner surface outwards. Twin: shaders/hair_surface.frag.
float chord_ratio(const RingShape& ring, float cos_t, float max_path) noexcept;

/// Factor that turns a record's tau into optical depth per texel x: c(d) / c0 and, with `curvature`, the chord ratio.
/// @param mass_per_area  M / (det S c0) [1/m]
void depth_factors(const RingShape& ring, const RingTable& table, const PlateDirection& d, float mass_per_area,
                   float max_path, bool curvature, std::span<float> out) noexcept;

}  // namespace pelage
