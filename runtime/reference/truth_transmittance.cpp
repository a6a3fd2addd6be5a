#include "pelage/reference/truth_transmittance.h"

#include <tbb/blocked_range.h>
#include <tbb/parallel_for.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <glm/geometric.hpp>

#include "pelage/reference/light_ray.h"
#include "pelage/reference/progress_counter.h"
#include "pelage/reference/sampling.h"

namespace pelage {
namespace {

/// Two unit vectors across a unit vector.
struct Across {
  glm::dvec3 x, y;
};
Across across(const glm::dvec3& d) noexcept {
  const glm::dvec3 axis = std::abs(d.x) < 0.6 ? glm::dvec3(1, 0, 0) : glm::dvec3(0, 1, 0);
  const glm::dvec3 x = glm::normalize(glm::cross(axis, d));
  return {x, glm::cross(d, x)};
}

/// Mean and standard error of the mean of batches of `rays[b]` rays that sum up to `sums[b]`.
TruthEstimate estimate(std::span<const double> sums, std::span<const std::uint32_t> rays) noexcept {
  double sum = 0, all = 0;
  for (std::size_t b = 0; b < sums.size(); ++b) sum += sums[b], all += rays[b];
  const double mean = sum / all, n = static_cast<double>(sums.size());
  if (sums.size() < 2) return {mean, 0.5};
  double squares = 0;
  for (std::size_t b = 0; b < sums.size(); ++b) {
    const double off = (sums[b] - mean * rays[b]) / all;
    squares += off * off;
  }
  return {mean, std::sqrt(squares * n / (n - 1))};
}

class PointTracer {
 public:
  PointTracer(const FibreScene& scene, const Light& light, const TruthSettings& settings, std::uint64_t seed,
              HeadShadow head)
      : scene_(scene),
        light_(light),
        settings_(settings),
        seed_(seed),
        enough_(scene.enough(settings.stop_below)),
        head_(head == HeadShadow::casts && scene.has_head()) {
    check_light(light);
  }

  TruthEstimate trace(const TruthPoint& point, std::uint32_t index) const {
    const glm::dvec3 at(point.position);
    const FibreRay middle = ray_to_light(light_, at);
    if (middle.length_m == 0) return {1, 0};
    const Across disc = across(middle.direction);
    const auto total = static_cast<std::uint32_t>(std::max(settings_.rays, 1));
    const std::uint32_t batches = std::min<std::uint32_t>(total, kTruthBatches);
    std::array<double, kTruthBatches> sums{};
    std::array<std::uint32_t, kTruthBatches> rays{};
    for (std::uint32_t b = 0; b < batches; ++b) {
      const auto digits = random_bits(seed_, index, b);
      const SquareSequence square(digits[0], digits[1]);
      rays[b] = total / batches + (b < total % batches ? 1U : 0U);
      for (std::uint32_t i = 0; i < rays[b]; ++i) {
        const glm::dvec2 p = static_cast<double>(settings_.footprint_m) * in_disk(square.point(i));
        sums[b] += transmittance(at + p.x * disc.x + p.y * disc.y, point.owner);
      }
    }
    return estimate({sums.data(), batches}, {rays.data(), batches});
  }

 private:
  double transmittance(const glm::dvec3& from, std::uint32_t owner) const {
    const FibreRay ray = ray_to_light(light_, from);
    if (head_ && scene_.head(ray)) return 0;
    return scene_.transmittance(scene_.count(ray, owner, enough_));
  }

  const FibreScene& scene_;
  const Light& light_;
  const TruthSettings& settings_;
  std::uint64_t seed_;
  int enough_;
  bool head_;
};

}  // namespace

std::vector<TruthEstimate> truth_transmittance(
    const FibreScene& scene, std::span<const TruthPoint> points, const Light& light, const TruthSettings& settings,
    std::uint64_t seed, const std::function<void(std::uint64_t done, std::uint64_t total)>& progress, HeadShadow head) {
  const PointTracer tracer(scene, light, settings, seed, head);
  std::vector<TruthEstimate> estimates(points.size());
  ProgressCounter counter(progress, points.size());
  tbb::parallel_for(tbb::blocked_range<std::size_t>(0, points.size(), 1), [&](const auto& range) {
    for (std::size_t i = range.begin(); i != range.end(); ++i) {
      estimates[i] = tracer.trace(points[i], static_cast<std::uint32_t>(i));
      counter.add(1);
    }
  });
  return estimates;
}

}  // namespace pelage
