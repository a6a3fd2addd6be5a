// Hair lighting at a point of a strand: diffuse, primary and secondary highlight. CPU twin of
// shaders/common_lobes.glsl.
//
// [KajiyaKay1989] as [Xu2006 eqs. 8-11] and [Scheuermann2004] use it. t: unit tangent towards the tip; n: unit normal
// of the cluster surface, outward; l, v: unit vectors towards light and viewer. Deviations from the papers:
// - Sines are |t x l|: sqrt(1 - (t.l)^2) in float is NaN for about a quarter of the directions when t and l are
// parallel.
// - Eq. 10 as printed, (t.l)(t.v) + sin sin, peaks where t is perpendicular to l - v: it is 1 everywhere when the light
//   sits at the eye. A fibre reflects into the cone t.v = -t.l [Marschner2003], so the product has a minus sign here
//   and the peak is where t is perpendicular to l + v, as in Scheuermann's half-vector form.
// - The base is clamped to [0, 1] before pow: negative bases have no real power; rounding may exceed 1.
#pragma once

#include <algorithm>
#include <cmath>
#include <glm/geometric.hpp>
#include <glm/vec3.hpp>

#include "pelage/data_schema/scene.h"

namespace pelage {

/// sin of the angle between unit vectors, in [0, 1]; exact 0 for parallel ones.
template <class T>
T sine_between(const glm::vec<3, T>& a, const glm::vec<3, T>& b) noexcept {
  return std::min(glm::length(glm::cross(a, b)), T(1));
}

/// Tangent tilted by `tangent_shift` along the normal and renormalised [Xu2006 eqs. 10, 11]: a positive shift moves the
/// highlight towards the tip. Finite unless t = -shift n, which unit t and |shift| < 1 exclude.
template <class T>
glm::vec<3, T> shifted_tangent(const glm::vec<3, T>& t, const glm::vec<3, T>& n, T tangent_shift) noexcept {
  return glm::normalize(t + tangent_shift * n);
}

/// The normal of a lone strand, along which its highlights shift: the side of a camera-facing ribbon [Scheuermann2004].
/// Unit, across t, towards the viewer; where the viewer looks along the strand, any across it.
template <class T>
glm::vec<3, T> facing_normal(const glm::vec<3, T>& t, const glm::vec<3, T>& v) noexcept {
  const glm::vec<3, T> across = v - glm::dot(v, t) * t;
  const T length = glm::length(across);
  if (length > T(1e-4)) return across / length;
  const glm::vec<3, T> axis = std::abs(t.x) < T(0.6) ? glm::vec<3, T>(1, 0, 0) : glm::vec<3, T>(0, 1, 0);
  return glm::normalize(axis - glm::dot(axis, t) * t);
}

/// [Xu2006 eq. 9] without coefficient and colour: sin(t, l). In [0, 1].
template <class T>
T diffuse_lobe(const glm::vec<3, T>& t, const glm::vec<3, T>& l) noexcept {
  return sine_between(t, l);
}

/// [Xu2006 eq. 10] without coefficient and colour, sign corrected (see above). In [0, 1].
template <class T>
T specular_lobe(const glm::vec<3, T>& t, const glm::vec<3, T>& l, const glm::vec<3, T>& v, T exponent) noexcept {
  const T base = sine_between(t, l) * sine_between(t, v) - glm::dot(t, l) * glm::dot(t, v);
  return std::pow(std::clamp(base, T(0), T(1)), exponent);
}

/// Which terms of eq. 8 are summed.
struct LobeSwitches {
  bool diffuse = true, primary = true, secondary = true;
};

/// Lighting term Psi^lighting of eq. 8 for one light of unit irradiance: linear RGB, >= 0. Without ambient.
glm::vec3 hair_lighting(const HairMaterial& material, const LobeSwitches& on, const glm::vec3& t, const glm::vec3& n,
                        const glm::vec3& l, const glm::vec3& v) noexcept;

}  // namespace pelage
