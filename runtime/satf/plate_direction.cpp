#include "pelage/satf/plate_direction.h"

#include <algorithm>
#include <cmath>
#include <glm/geometric.hpp>
#include <numbers>

namespace pelage {
namespace {

constexpr float kPi = std::numbers::pi_v<float>;
/// In-plane part below which the azimuth of a float direction is rounding noise.
constexpr float kNoAzimuth = 1e-6F;

float square(float x) noexcept {
  return x * x;
}

}  // namespace

PlateDirection plate_direction(const Frame& frame, const CrossSection& s, glm::vec3 towards) noexcept {
  PlateDirection d;
  const glm::vec2 plane{glm::dot(towards, frame.normal), glm::dot(towards, frame.binormal)};
  d.planar = std::min(glm::length(plane), 1.0F);
  const glm::vec2 unit = d.planar > kNoAzimuth ? plane / d.planar : glm::vec2(1, 0);
  const glm::vec2 delta = s.solve(unit);
  d.stretch = glm::length(delta);
  d.disk = delta / d.stretch;
  d.phi = std::atan2(d.disk.y, d.disk.x);
  d.plane_angle = std::atan2(unit.y, unit.x);
  return d;
}

RingShape ring_shape(const Division& division, int layer) noexcept {
  RingShape ring{};
  ring.sectors = sectors_in_layer(division, layer);
  ring.inner = layer_radius(division, layer);
  ring.outer = layer_radius(division, layer + 1);
  ring.height = ring.outer - ring.inner;
  ring.width = 0.5F * (ring.inner + ring.outer) * 4.0F * kPi / static_cast<float>(ring.sectors);
  return ring;
}

float warp_angle(const RingShape& ring, float theta) noexcept {
  const float turns = std::round(theta / (2.0F * kPi));
  const float t = theta - 2.0F * kPi * turns;
  return std::atan2(std::sin(t) * ring.height, std::cos(t) * ring.width) + 2.0F * kPi * turns;
}

float azimuth_weight(float planar) noexcept {
  const float x = std::clamp(planar / 0.2F, 0.0F, 1.0F);
  return x * x * (3.0F - 2.0F * x);
}

void depth_factors(const RingShape& ring, const RingTable& table, const PlateDirection& d, float mass_per_area,
                   float max_path, bool curvature, std::span<float> out) noexcept {
  const float base = mass_per_area / (d.stretch * ring.width * ring.height);
  const float inv_width = 1.0F / ring.width, inv_height = 1.0F / ring.height;
  const float inner2 = square(ring.inner), outer2 = square(ring.outer);
  for (std::size_t x = 0; x < out.size(); ++x) {
    const float cos_t = d.disk.x * table.cos_u[x] + d.disk.y * table.sin_u[x];
    const float sin2 = std::max(0.0F, 1.0F - cos_t * cos_t);
    const float metric = std::sqrt(sin2 * square(inv_width) + square(cos_t * inv_height));  // |J^-1 d| in the disk
    const float c = base / metric;
    // Chord of the ring: from the outer surface inwards (front), from the inner surface outwards (back).
    const float abs_cos = std::abs(cos_t);
    const float to_inner = inner2 - outer2 * sin2;
    const float front =
        to_inner > 0.0F ? ring.outer * abs_cos - std::sqrt(std::max(to_inner, 0.0F)) : 2.0F * ring.outer * abs_cos;
    const float back = std::sqrt(std::max(outer2 - inner2 * sin2, 0.0F)) - ring.inner * abs_cos;
    const float chord = cos_t >= 0.0F ? front : back;
    const float slab = std::min(ring.height / std::max(abs_cos, 1e-6F), max_path / metric);
    out[x] = c * (curvature ? chord / slab : 1.0F);
  }
}

}  // namespace pelage
