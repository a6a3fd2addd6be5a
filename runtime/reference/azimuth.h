// How light is spread around a fibre: the azimuthal term of DESIGN section 3, at the true normal of a round fibre.
//
// In the plane across the fibre: Phong as the baker has it (bake/planar_reference.h, PlanarShading; tests/reference
// compares the two), with the normal where the ray meets the fibre's surface, divided by its mean over light angles. A
// ray that passes the axis at h radii meets the normal (h, sqrt(1 - h^2)) in the frame (across, towards the viewer): it
// always faces the viewer, so nothing is mirrored. Mean 1 over light angles at every h, so over the fibre's width too.
// Where light or viewer look along the fibre, azimuth has no meaning, and the term fades to its mean (hard case 14).
#pragma once

#include <algorithm>
#include <cmath>
#include <glm/geometric.hpp>
#include <glm/vec3.hpp>

#include "pelage/data_schema/bake_settings.h"
#include "pelage/shading/azimuth_mean.h"

namespace pelage {

class AzimuthTerm {
 public:
  explicit AzimuthTerm(const PlanarPhong& phong) noexcept : phong_(phong), mean_(mean_over_lights(phong)) {}

  /// >= 0, finite. t: unit tangent; v, l: unit vectors towards viewer and light.
  /// @param offset  of the ray from the axis, across the ray, in radii
  double operator()(const glm::dvec3& t, const glm::dvec3& v, const glm::dvec3& l,
                    const glm::dvec3& offset) const noexcept {
    const glm::dvec3 side = glm::cross(t, v);  // length sin(t, v)
    const double sin_v = glm::length(side), along_l = glm::dot(l, t);
    const double sin_l = std::sqrt(std::max(0.0, 1 - along_l * along_l));
    const double known = sin_v * sin_l;
    if (known < 1e-6) return 1;
    const glm::dvec3 x = side / sin_v, y = glm::cross(x, t);
    const double h = std::clamp(glm::dot(offset, x), -1.0, 1.0), k = std::sqrt(1 - h * h);
    const double lx = glm::dot(l, x) / sin_l, ly = glm::dot(l, y) / sin_l;
    const double diffuse = std::max(0.0, h * lx + k * ly);
    const double mirrored = std::max(0.0, 2 * k * h * lx + (2 * k * k - 1) * ly);
    const double phong = phong_.diffuse * diffuse + phong_.specular * std::pow(mirrored, phong_.exponent);
    const double share = known * known / (known * known + kAlongFibre * kAlongFibre);
    return share * phong / mean_ + (1 - share);
  }

 private:
  PlanarPhong phong_;
  double mean_;
};

}  // namespace pelage
