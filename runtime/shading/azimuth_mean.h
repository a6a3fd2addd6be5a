// How light is spread around a fibre, seen as a whole: the mean over the fibre's width of the azimuthal term of DESIGN
// section 3 (runtime/reference/azimuth.h has it at every point of the width). CPU twin of azimuth_mean() in
// shaders/common_lobes.glsl.
//
// With phi the angle between light and viewer around the fibre and psi that of a normal from the viewer, seen with
// cos(psi) dpsi / 2:
//   diffuse    1/2 int cos(psi) max(0, cos(psi - phi)) dpsi = ((pi - phi) cos(phi) + sin(phi)) / 4, exact
//   specular   1/2 int cos(psi) max(0, cos(2 psi - phi))^p dpsi = C_p cos(phi / 2) / 4,
//              C_p = int cos(u / 2) cos(u)^p du over [-pi/2, pi/2]; exact up to phi = pi/2, beyond it the part of the
//              lobe that wraps around is left out (below .03 of the mean at p = 8, .045 at 80)
// divided by the mean over phi, so that the mean of this over light angles is 1 too. Where light or viewer look along
// the fibre, azimuth has no meaning, and the term fades to 1 (hard case 14).
#pragma once

#include <algorithm>
#include <cmath>
#include <glm/geometric.hpp>
#include <glm/vec2.hpp>
#include <glm/vec3.hpp>
#include <numbers>

#include "pelage/data_schema/bake_settings.h"

namespace pelage {

/// sin(fibre, light) sin(fibre, viewer) at which the term is half itself, half its mean.
inline constexpr double kAlongFibre = 0.02;

/// kd / pi + ks Gamma((p+1)/2) / (2 sqrt(pi) Gamma(p/2+1)): of the Phong term over all light angles.
inline double mean_over_lights(const PlanarPhong& phong) noexcept {
  const double p = phong.exponent;
  const double lobe = std::exp(std::lgamma((p + 1) / 2) - std::lgamma(p / 2 + 1)) / (2 * std::sqrt(std::numbers::pi));
  return phong.diffuse / std::numbers::pi + phong.specular * lobe;
}

/// Of the diffuse and the specular part: what azimuth_mean() takes.
inline glm::vec2 azimuth_coefficients(const PlanarPhong& phong) noexcept {
  constexpr int kSteps = 4096;
  double lobe = 0;
  for (int i = 0; i < kSteps; ++i) {
    const double u = std::numbers::pi * ((i + 0.5) / kSteps - 0.5);
    lobe += std::cos(0.5 * u) * std::pow(std::cos(u), phong.exponent) * std::numbers::pi / kSteps;
  }
  return glm::dvec2(phong.diffuse, phong.specular * lobe) / (4 * mean_over_lights(phong));
}

/// >= 0, finite. t: unit tangent; v, l: unit vectors towards viewer and light.
inline float azimuth_mean(glm::vec2 coefficients, const glm::vec3& t, const glm::vec3& v, const glm::vec3& l) noexcept {
  const glm::vec3 across_v = v - glm::dot(v, t) * t, across_l = l - glm::dot(l, t) * t;
  const float known = glm::length(across_v) * glm::length(across_l);
  if (known < 1e-6F) return 1;
  const float x = std::clamp(glm::dot(across_v, across_l) / known, -1.0F, 1.0F);
  const float diffuse = (std::numbers::pi_v<float> - std::acos(x)) * x + std::sqrt(1 - x * x);
  const float specular = std::sqrt(0.5F * (1 + x));
  const float share = known * known / (known * known + static_cast<float>(kAlongFibre * kAlongFibre));
  return share * (coefficients.x * diffuse + coefficients.y * specular) + (1 - share);
}

}  // namespace pelage
