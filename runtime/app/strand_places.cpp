#include "pelage/app/strand_places.h"

#include <algorithm>
#include <cmath>
#include <glm/common.hpp>
#include <glm/geometric.hpp>
#include <glm/vec3.hpp>

namespace pelage::app {
namespace {

/// The place at a share of a strand's length.
glm::dvec3 place_at(std::span<const glm::vec3> strand, double share) {
  const auto segment = [&](std::size_t v) { return glm::distance(glm::dvec3(strand[v - 1]), glm::dvec3(strand[v])); };
  double length_m = 0;
  for (std::size_t v = 1; v < strand.size(); ++v) length_m += segment(v);
  double left_m = share * length_m;
  for (std::size_t v = 1; v < strand.size(); ++v) {
    const double segment_m = segment(v);
    if (left_m < segment_m) return glm::mix(glm::dvec3(strand[v - 1]), glm::dvec3(strand[v]), left_m / segment_m);
    left_m -= segment_m;
  }
  return strand.back();
}

}  // namespace

void add_distances(const Strands& a, const Strands& b, std::vector<float>& distances_m) {
  constexpr int kShares = 16;
  const auto add = [&](const glm::dvec3& d) { distances_m.push_back(static_cast<float>(glm::length(d))); };
  for (std::size_t s = 0; s < a.count(); ++s) {
    const auto p = a.strand(s), q = b.strand(s);
    if (p.size() == q.size())
      for (std::size_t v = 0; v < p.size(); ++v) add(glm::dvec3(p[v]) - glm::dvec3(q[v]));
    else if (!p.empty() && !q.empty())
      for (int i = 0; i <= kShares; ++i) add(place_at(p, 1.0 * i / kShares) - place_at(q, 1.0 * i / kShares));
  }
}

double rms_mm(std::span<const float> distances_m) {
  double sum = 0;
  for (const float d : distances_m) sum += static_cast<double>(d) * static_cast<double>(d);
  return 1e3 * std::sqrt(sum / static_cast<double>(std::max<std::size_t>(distances_m.size(), 1)));
}

double p99_mm(std::span<const float> distances_m) {
  if (distances_m.empty()) return 0;
  std::vector<float> sorted(distances_m.begin(), distances_m.end());
  const auto at = sorted.begin() + static_cast<std::ptrdiff_t>((sorted.size() - 1) * 99 / 100);
  std::nth_element(sorted.begin(), at, sorted.end());
  return 1e3 * static_cast<double>(*at);
}

double max_mm(std::span<const float> distances_m) {
  return distances_m.empty() ? 0 : 1e3 * static_cast<double>(*std::max_element(distances_m.begin(), distances_m.end()));
}

double rms_mm(const Strands& a, const Strands& b) {
  std::vector<float> distances_m;
  add_distances(a, b, distances_m);
  return rms_mm(distances_m);
}

}  // namespace pelage::app
