#include "pelage/hair/cluster_projection.h"

#include <algorithm>
#include <glm/geometric.hpp>
#include <limits>

namespace pelage::hair {
namespace {

constexpr int kPlanes = 64;      // a slab of a 0.3 m centre line is 5 mm: shorter than a bend
constexpr int kNewtonSteps = 3;  // each shrinks the error by radius x curvature, from about 1e-2 of a slab

bool increases(const PlanePoint& a, const PlanePoint& b) {
  return static_cast<float>(a.t) < static_cast<float>(b.t);
}

}  // namespace

double Projector::Plane::behind(const glm::dvec3& p) const noexcept {
  return glm::dot(p - position, tangent);
}

Projector::Projector(const CentreLine& line) : line_(line) {
  planes_.reserve(kPlanes + 1);
  for (int i = 0; i <= kPlanes; ++i) {
    const Frame f = line.frame(i / static_cast<double>(kPlanes));
    planes_.push_back({glm::dvec3(f.position), glm::dvec3(f.tangent)});
  }
}

/// Of all slabs that hold p (a bent line has several) the one nearest to it.
std::size_t Projector::first_slab(const glm::dvec3& p) const noexcept {
  std::size_t best = 0;
  double best_distance = std::numeric_limits<double>::infinity();
  for (std::size_t slab = 0; slab <= planes_.size(); ++slab) {
    const bool after = slab == 0 || planes_[slab - 1].behind(p) >= 0;
    const bool before = slab == planes_.size() || planes_[slab].behind(p) < 0;
    if (!after || !before) continue;
    const glm::dvec3 d = p - planes_[std::min(slab, planes_.size() - 1)].position;
    if (glm::dot(d, d) < best_distance) best = slab, best_distance = glm::dot(d, d);
  }
  return best;
}

std::size_t Projector::walk(std::size_t slab, const glm::dvec3& p) const noexcept {
  if (slab < planes_.size() && planes_[slab].behind(p) >= 0) {
    while (slab < planes_.size() && planes_[slab].behind(p) >= 0) ++slab;
    return slab;
  }
  while (slab > 0 && planes_[slab - 1].behind(p) < 0) --slab;
  return slab;
}

PlanePoint Projector::locate(std::size_t slab, const glm::dvec3& p) const noexcept {
  const auto in_plane = [&](const Frame& f) {
    const glm::dvec3 d = p - glm::dvec3(f.position);
    return glm::dvec2(glm::dot(d, glm::dvec3(f.normal)), glm::dot(d, glm::dvec3(f.binormal)));
  };
  const double length = line_.length_m();
  if (slab == 0) return {planes_.front().behind(p) / length, in_plane(line_.frame(0)), 0};
  if (slab == planes_.size()) return {1 + planes_.back().behind(p) / length, in_plane(line_.frame(1)), 0};
  const double t0 = static_cast<double>(slab - 1) / kPlanes, t1 = static_cast<double>(slab) / kPlanes;
  const double g0 = planes_[slab - 1].behind(p), g1 = planes_[slab].behind(p);
  double t = g0 > g1 ? t0 + (t1 - t0) * std::clamp(g0 / (g0 - g1), 0.0, 1.0) : 0.5 * (t0 + t1);
  Frame f = line_.frame(t);
  for (int i = 0; i < kNewtonSteps; ++i) {
    const double e = glm::dot(p - glm::dvec3(f.position), glm::dvec3(f.tangent));
    t = std::clamp(t + e / length, t0, t1);
    f = line_.frame(t);
  }
  return {t, in_plane(f), 0};
}

std::vector<PlanePoint> Projector::project(std::span<const glm::vec3> strand) const {
  std::vector<PlanePoint> points;
  points.reserve(strand.size());
  std::size_t slab = 0;
  for (std::size_t i = 0; i < strand.size(); ++i) {
    const glm::dvec3 p(strand[i]);
    slab = i == 0 ? first_slab(p) : walk(slab, p);
    points.push_back(locate(slab, p));
    points.back().vertex = static_cast<std::uint32_t>(i);
  }
  return points;
}

std::vector<PlanePoint> increasing_part(std::span<const PlanePoint> points, std::span<const glm::vec3> strand) {
  if (points.empty()) return {};
  std::size_t begin = 0, best_begin = 0, best_end = 1;
  double length = 0, best_length = -1;
  for (std::size_t i = 0; i < points.size(); ++i) {  // runs [begin, i]
    if (i > 0 && increases(points[i - 1], points[i])) {
      length += static_cast<double>(glm::distance(strand[points[i - 1].vertex], strand[points[i].vertex]));
    } else {
      begin = i, length = 0;
    }
    if (length > best_length) best_begin = begin, best_end = i + 1, best_length = length;
  }
  std::vector<PlanePoint> kept;
  for (std::size_t i = best_begin; i-- > 0;) {
    if (increases(points[i], kept.empty() ? points[best_begin] : kept.back())) kept.push_back(points[i]);
  }
  std::reverse(kept.begin(), kept.end());
  kept.insert(kept.end(), points.begin() + static_cast<std::ptrdiff_t>(best_begin),
              points.begin() + static_cast<std::ptrdiff_t>(best_end));
  for (std::size_t i = best_end; i < points.size(); ++i) {
    if (increases(kept.back(), points[i])) kept.push_back(points[i]);
  }
  return kept;
}

}  // namespace pelage::hair
