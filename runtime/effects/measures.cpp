#include "pelage/effects/measures.h"

#include <algorithm>
#include <cmath>
#include <glm/common.hpp>
#include <glm/geometric.hpp>
#include <limits>
#include <numeric>
#include <vector>

namespace pelage {
namespace {

constexpr float kFarAlong = 4;                // radii: parts of a cluster that are not neighbours
constexpr float kSharpBend_cos = 0.8660254F;  // 30 degrees

float length_m(std::span<const glm::vec3> strand) noexcept {
  float sum = 0;
  for (std::size_t v = 1; v < strand.size(); ++v) sum += glm::distance(strand[v - 1], strand[v]);
  return sum;
}

/// A root and how far its strand reaches.
struct Reach {
  glm::vec3 root;
  float length_m;
};

bool close(const Reach& a, const Reach& b, float near_m) noexcept {
  const float most = a.length_m + b.length_m + near_m;
  const glm::vec3 d = b.root - a.root;
  return glm::dot(d, d) <= most * most;
}

float distance_to_segment(glm::vec3 p, glm::vec3 a, glm::vec3 b) noexcept {
  const glm::vec3 ab = b - a;
  const float size = glm::dot(ab, ab);
  const float t = size > 0 ? std::clamp(glm::dot(p - a, ab) / size, 0.0F, 1.0F) : 0.0F;
  return glm::distance(p, a + t * ab);
}

/// Tangent of the curve at b, in the parameter of the segment from b to c; a is the vertex before.
glm::vec3 tangent(glm::vec3 a, glm::vec3 b, glm::vec3 c) noexcept {
  const float before = std::sqrt(glm::distance(a, b)), after = std::sqrt(glm::distance(b, c));
  if (!(before > 0)) return c - b;
  return after * ((b - a) / before - (c - a) / (before + after) + (c - b) / after);
}

float deviation(std::span<const glm::vec3> p) noexcept {
  float most = 0;
  for (std::size_t i = 0; i + 1 < p.size(); ++i) {
    const glm::vec3 chord = p[i + 1] - p[i];
    if (!(glm::dot(chord, chord) > 0)) continue;
    const glm::vec3 begin = i > 0 ? tangent(p[i - 1], p[i], p[i + 1]) : chord;
    const glm::vec3 end = i + 2 < p.size() ? -tangent(p[i + 2], p[i + 1], p[i]) : chord;
    // Only what is across the chord leaves it: along it a centripetal curve neither overshoots nor turns back.
    const auto across = [&](glm::vec3 v) {
      return glm::length(v - glm::dot(v, chord) / glm::dot(chord, chord) * chord);
    };
    most = std::max(most, 4.0F / 27.0F * (across(begin) + across(end)));
  }
  return most;
}

/// Greatest stretch of a cross-section, from above [m].
float radius_m(const CrossSection& s) noexcept {
  return std::sqrt(s.xx * s.xx + 2 * s.xy * s.xy + s.yy * s.yy);
}

/// Distance between two segments, from below: of their middles less half their lengths.
float apart(glm::vec3 a, glm::vec3 b, glm::vec3 c, glm::vec3 d) noexcept {
  return glm::distance(0.5F * (a + b), 0.5F * (c + d)) - 0.5F * (glm::distance(a, b) + glm::distance(c, d));
}

}  // namespace

float Extent::distance_m(glm::vec3 p) const noexcept {
  return glm::length(glm::max(glm::max(low - p, p - high), glm::vec3(0)));
}

Extent extent_of(std::span<const glm::vec3> points) noexcept {
  Extent box;
  for (const glm::vec3& p : points) {
    box.low = glm::min(box.low, p);
    box.high = glm::max(box.high, p);
  }
  return box;
}

Extent extent_of(const Cluster& cluster) noexcept {
  float most = 0;
  for (const CrossSection& s : cluster.cross_sections) most = std::max(most, radius_m(s));
  Extent box = extent_of(std::span<const glm::vec3>(cluster.centre_line));
  box.low -= most, box.high += most;
  return box;
}

bool strands_can_meet(const Strands& strands, float near_m) {
  std::vector<Reach> all;
  for (std::size_t s = 0; s < strands.count(); ++s) {
    if (strands.strand(s).empty()) continue;
    const Reach reach{strands.strand(s)[0], length_m(strands.strand(s))};
    // Neighbours in a file are neighbours on a head: in a groom the first two tell.
    if (!all.empty() && close(all.back(), reach, near_m)) return true;
    all.push_back(reach);
  }
  const auto left = [](const Reach& r) { return r.root.x - r.length_m; };
  std::sort(all.begin(), all.end(), [&](const Reach& a, const Reach& b) { return left(a) < left(b); });
  std::vector<Reach> open;  // reach as far right as the one in question
  for (const Reach& r : all) {
    std::erase_if(open, [&](const Reach& o) { return o.root.x + o.length_m + near_m < left(r); });
    if (std::any_of(open.begin(), open.end(), [&](const Reach& o) { return close(o, r, near_m); })) return true;
    open.push_back(r);
  }
  return false;
}

float longest_strand_m(const Strands& strands) noexcept {
  float most = 0;
  for (std::size_t s = 0; s < strands.count(); ++s) most = std::max(most, length_m(strands.strand(s)));
  return most;
}

float curve_deviation_m(const Strands& strands) noexcept {
  float most = 0;
  for (std::size_t s = 0; s < strands.count(); ++s) most = std::max(most, deviation(strands.strand(s)));
  return most;
}

float out_of_reach_m(const Strands& strands, const ColliderCapsule& capsule, float margin_m) noexcept {
  float least = std::numeric_limits<float>::infinity();
  for (std::size_t s = 0; s < strands.count(); ++s) {
    const std::span<const glm::vec3> strand = strands.strand(s);
    if (strand.empty()) continue;
    const float gap = distance_to_segment(strand[0], capsule.from, capsule.to) - capsule.radius_m - margin_m;
    least = std::min(least, gap - length_m(strand));
  }
  return least;
}

float out_of_reach_m(const Strands& strands, const Extent& box, float margin_m) noexcept {
  float least = std::numeric_limits<float>::infinity();
  for (std::size_t s = 0; s < strands.count() && !box.empty(); ++s) {
    const std::span<const glm::vec3> strand = strands.strand(s);
    if (strand.empty()) continue;
    least = std::min(least, box.distance_m(strand[0]) - margin_m - length_m(strand));
  }
  return least;
}

bool may_shade_itself(const SweptCluster& cluster, glm::vec3 to_light) noexcept {
  const glm::vec3 light = glm::normalize(to_light);
  const auto plates = static_cast<std::size_t>(cluster.plates());
  float most = 0;
  for (const CrossSection& s : cluster.cross_sections) most = std::max(most, radius_m(s));
  const float step_m = cluster.length_m / static_cast<float>(plates), far_m = kFarAlong * most;
  const auto across = [&](std::size_t i) {
    const glm::vec3 p = cluster.frames[i].position;
    return p - glm::dot(p, light) * light;
  };
  for (std::size_t i = 0; i < plates; ++i) {
    for (std::size_t j = i + 1; j <= plates; ++j) {
      const bool far = static_cast<float>(j - i - 1) * step_m > far_m;
      if (!far && glm::dot(cluster.frames[i].tangent, cluster.frames[j].tangent) < kSharpBend_cos) return true;
      if (far && j < plates && apart(across(i), across(i + 1), across(j), across(j + 1)) < 2 * most) return true;
    }
  }
  return false;
}

}  // namespace pelage
