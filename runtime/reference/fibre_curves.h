// Private to this box: the segments of a FibreScene, as its Embree scene holds them, and the definition of a hit
// (fibre_scene.h) in double.
#pragma once

#include <algorithm>
#include <bit>
#include <cmath>
#include <cstdint>
#include <glm/geometric.hpp>
#include <glm/vec3.hpp>
#include <glm/vec4.hpp>
#include <limits>
#include <utility>
#include <vector>

#include "pelage/data_schema/strands.h"
#include "pelage/reference/fibre_scene.h"

namespace pelage {

/// Where a ray passes a segment: nearest to its axis, seen along the ray.
struct Pass {
  bool hit = false;
  double depth_m = 0, along = 0;
  double radius_m = 0, axis2 = 0, seen2 = 0;  // squared length of the axis, in space and as the ray sees it
  glm::dvec3 offset_m{0};

  /// Half chord, r / sin(theta), of a ray through the axis.
  double reach_m() const noexcept { return radius_m * std::sqrt(axis2 / seen2); }
};

struct Segment {
  glm::dvec3 a, b;
  double radius_a = 0, radius_b = 0;
  bool joint_a = false, joint_b = false;  // a neighbour goes on there
};

inline Pass pass_by(const FibreRay& ray, const Segment& s) noexcept {
  const glm::dvec3 to_a = s.a - ray.origin, axis = s.b - s.a;
  const double a_depth = glm::dot(to_a, ray.direction), axis_depth = glm::dot(axis, ray.direction);
  const glm::dvec3 a_seen = to_a - a_depth * ray.direction, axis_seen = axis - axis_depth * ray.direction;
  const double seen2 = glm::dot(axis_seen, axis_seen);
  const double unbounded = seen2 > 0 ? -glm::dot(a_seen, axis_seen) / seen2 : 0;
  Pass pass;
  if ((unbounded < 0 && !s.joint_a) || (unbounded > 1 && !s.joint_b)) return pass;
  pass.along = std::clamp(unbounded, 0.0, 1.0);
  pass.depth_m = a_depth + pass.along * axis_depth;
  pass.radius_m = s.radius_a + (s.radius_b - s.radius_a) * pass.along;
  pass.offset_m = -(a_seen + pass.along * axis_seen);
  pass.axis2 = glm::dot(axis, axis), pass.seen2 = seen2;
  pass.hit = glm::dot(pass.offset_m, pass.offset_m) < pass.radius_m * pass.radius_m && pass.depth_m > 0 &&
             pass.depth_m < ray.length_m;
  return pass;
}

/// Are these hits of neighbours one crossing?
inline bool together(const Pass& a, const Pass& b) noexcept {
  return std::abs(a.depth_m - b.depth_m) <= a.reach_m() + b.reach_m();
}

struct FibreBox {
  glm::dvec3 low{std::numeric_limits<double>::infinity()}, high{-std::numeric_limits<double>::infinity()};
  void add(const glm::dvec3& p, double radius) noexcept {
    low = glm::min(low, p - radius);
    high = glm::max(high, p + radius);
  }
};

/// Segments first, last of an owner and its neighbours; none: first > last.
struct OwnSegments {
  std::uint32_t first = 1, last = 0;
  bool has(std::uint32_t segment) const noexcept { return segment >= first && segment <= last; }
};

struct FibreCurves {
  std::vector<glm::vec4> points;          // [kept vertices + 1] position, widened radius; one more for Embree's loads
  std::vector<std::uint32_t> first;       // [segment] its first point: Embree's index buffer, for nobody else
  std::vector<std::uint32_t> vertex_of;   // [segment] its first vertex in Strands
  std::vector<std::uint32_t> segment_of;  // [vertex of Strands] or kNoSegment
  double least_widening = 0, greatest_radius = 0;
  FibreBox box;

  static constexpr std::uint32_t kNoSegment = 0xffffffffU;
  /// Widening of Embree's candidates: of their radius, and, for its rounding, of the hair's size and distance from the
  /// world's origin: 16 eps.
  static constexpr double kWiden = 1.01, kRounding = 1e-6;

  /// @throws InputError
  explicit FibreCurves(const Strands& strands);

  std::uint32_t size() const noexcept { return static_cast<std::uint32_t>(first.size()); }
  /// Does the segment before belong to the same strand?
  bool follows(std::uint32_t segment) const noexcept {
    return (starts_[segment / 64].here >> (segment % 64) & 1U) == 0;
  }
  bool goes_on(std::uint32_t segment) const noexcept { return segment + 1 < size() && follows(segment + 1); }
  Segment segment(std::uint32_t i) const noexcept {
    const std::uint32_t point = first_point(i);
    const glm::vec4 a = points[point], b = points[point + 1];
    return {glm::dvec3(a), glm::dvec3(b), radius(a.w), radius(b.w), follows(i), goes_on(i)};
  }
  OwnSegments owned_by(std::uint32_t vertex) const noexcept {
    const std::uint32_t own = vertex < segment_of.size() ? segment_of[vertex] : kNoSegment;
    if (own == kNoSegment) return {};
    return {follows(own) ? own - 1 : own, goes_on(own) ? own + 1 : own};
  }
  double radius(float widened) const noexcept { return (static_cast<double>(widened) - least_widening) * (1 / kWiden); }
  double greatest_widened() const noexcept { return kWiden * greatest_radius + least_widening; }

 private:
  /// Which of 64 segments begin a strand, and how many strands begin before them.
  struct Starts {
    std::uint64_t here = 0;
    std::uint32_t before = 0;
  };
  /// first[i], from a twentieth of the memory: each strand has one point more than segments. Hits are all over the
  /// hair, and reading `first` was half the time of counting them.
  std::uint32_t first_point(std::uint32_t i) const noexcept {
    const Starts& s = starts_[i / 64];
    const std::uint64_t up_to_i = ~std::uint64_t{0} >> (63 - i % 64);
    return i + s.before + static_cast<std::uint32_t>(std::popcount(s.here & up_to_i)) - 1;
  }

  std::vector<Starts> starts_;

  void take(const Strands& strands);
  void note_starts();
  void widen();
};

}  // namespace pelage
