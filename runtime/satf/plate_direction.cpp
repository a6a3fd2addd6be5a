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

/// Half-width, in squared disk radii, over which the near side's chord changes from "up to the inner surface" to
/// "through the whole ring": the inner surface is drawn as a polygon, a step exactly at its circle would show as a
/// bright line.
constexpr float kTangentBlend = 0.03F;

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
  const float length = glm::length(delta);
  d.disk = delta / length;
  // Along the axis no direction in the plane is meant: the ellipse's mean stretch.
  const float mean = 1.0F / std::sqrt(std::max(s.determinant(), 1e-12F));
  d.stretch = mean + azimuth_weight(d.planar) * (length - mean);
  d.phi = std::atan2(d.disk.y, d.disk.x);
  d.plane_angle = std::atan2(unit.y, unit.x);
  return d;
}

glm::vec3 towards_light(const glm::vec3& to_light, const std::optional<glm::vec3>& place,
                        const glm::vec3& from) noexcept {
  if (!place) return to_light;
  const glm::vec3 way = *place - from;
  const float length = glm::length(way);
  return length > 0.0F ? way / length : glm::vec3(0, 1, 0);
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
  // theta plus what tan theta' = (height / width) tan theta adds to it: below pi/2 and smooth, so no branch of atan2 is
  // near and whole turns are kept.
  const float s = std::sin(theta), c = std::cos(theta);
  return theta + std::atan2((ring.height - ring.width) * s * c, ring.width * c * c + ring.height * s * s);
}

float azimuth_weight(float planar) noexcept {
  const float x = std::clamp(planar / 0.2F, 0.0F, 1.0F);
  return x * x * (3.0F - 2.0F * x);
}

float chord_ratio(const RingShape& ring, float cos_t, float max_path) noexcept {
  const float inner2 = square(ring.inner), outer2 = square(ring.outer);
  const float abs_cos = std::abs(cos_t), sin2 = std::max(0.0F, 1.0F - cos_t * cos_t);
  const float metric = std::sqrt(sin2 / square(ring.width) + square(abs_cos / ring.height));  // |J^-1 d| in the disk
  const float to_inner = inner2 - outer2 * sin2;
  const float hits_inner = std::clamp(0.5F + 0.5F * to_inner / kTangentBlend, 0.0F, 1.0F);
  const float front = (2.0F - hits_inner) * ring.outer * abs_cos - std::sqrt(std::max(to_inner, 0.0F));
  const float back = std::sqrt(std::max(outer2 - inner2 * sin2, 0.0F)) - ring.inner * abs_cos;
  const float slab = std::min(ring.height / std::max(abs_cos, 1e-6F), max_path / metric);
  return (cos_t >= 0.0F ? front : back) / slab;
}

void depth_factors(const RingShape& ring, const RingTable& table, const PlateDirection& d, float mass_per_area,
                   float max_path, bool curvature, std::span<float> out) noexcept {
  const float base = mass_per_area / (d.stretch * ring.width * ring.height);
  const float inv_width2 = 1.0F / square(ring.width), inv_height2 = 1.0F / square(ring.height);
  for (std::size_t x = 0; x < out.size(); ++x) {
    const float cos2 = square(d.disk.x * table.cos_u[x] + d.disk.y * table.sin_u[x]);
    out[x] = base / std::sqrt(std::max(0.0F, 1.0F - cos2) * inv_width2 + cos2 * inv_height2);
  }
  if (!curvature) return;
  for (std::size_t x = 0; x < out.size(); ++x) {
    out[x] *= chord_ratio(ring, d.disk.x * table.cos_u[x] + d.disk.y * table.sin_u[x], max_path);
  }
}

}  // namespace pelage
