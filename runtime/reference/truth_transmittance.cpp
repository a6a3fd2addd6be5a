#include "pelage/reference/truth_transmittance.h"

#include <tbb/blocked_range.h>
#include <tbb/parallel_for.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <glm/geometric.hpp>
#include <optional>

#include "pelage/reference/light_ray.h"
#include "pelage/reference/parallel_rays.h"
#include "pelage/reference/progress_counter.h"
#include "pelage/reference/sampling.h"

namespace pelage {
namespace {

/// Mean and standard error of the mean of batches of `rays[b]` rays whose transmittances sum up to `sums[b]`.
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
        rays_(static_cast<std::uint32_t>(std::max(settings.rays, 1))),
        radius_m_(static_cast<double>(settings.footprint_m)),
        seed_(seed),
        enough_(scene.enough(settings.stop_below)),
        head_(head == HeadShadow::casts && scene.has_head()) {
    check_light(light);
    if (!light.position) parallel_.emplace(scene.curves(), LightFrame(ray_to_light(light, glm::dvec3(0)).direction));
  }

  TruthEstimate trace(const TruthPoint& point, std::uint32_t index) const {
    const glm::dvec3 at(point.position);
    if (light_.position && glm::dvec3(*light_.position) == at) return {1, 0};
    std::array<double, kTruthBatches> sums{};
    std::array<std::uint32_t, kTruthBatches> rays{};
    const std::uint32_t batches = std::min<std::uint32_t>(rays_, kTruthBatches);
    std::vector<ParallelRays::Band> bands;
    if (parallel_) parallel_->find(at, radius_m_, point.owner, bands);
    for (std::uint32_t b = 0; b < batches; ++b) {
      const auto digits = random_bits(seed_, index, b);
      const SquareSequence square(digits[0], digits[1]);
      rays[b] = rays_ / batches + (b < rays_ % batches ? 1U : 0U);
      sums[b] = parallel_ ? together(at, bands, square, rays[b]) : one_by_one(point, square, rays[b]);
    }
    return estimate({sums.data(), batches}, {rays.data(), batches});
  }

 private:
  /// Sum of the transmittances of elements 0 .. rays-1 of a sequence.
  double one_by_one(const TruthPoint& point, const SquareSequence& square, std::uint32_t rays) const {
    const glm::dvec3 at(point.position);
    const LightFrame frame(ray_to_light(light_, at).direction);
    double sum = 0;
    for (std::uint32_t i = 0; i < rays; ++i) {
      const glm::dvec2 p = radius_m_ * in_disk(square.point(i));
      const FibreRay ray = ray_to_light(light_, at + p.x * frame.x + p.y * frame.y);
      if (!head_blocks(ray)) sum += scene_.transmittance(scene_.count(ray, point.owner, enough_));
    }
    return sum;
  }

  double together(const glm::dvec3& at, std::span<const ParallelRays::Band> bands, const SquareSequence& square,
                  std::uint32_t rays) const {
    RayBundle bundle;
    double sum = 0;
    for (std::uint32_t first = 0; first < rays; first += static_cast<std::uint32_t>(bundle.size)) {
      bundle.size = std::min<std::size_t>(rays - first, RayBundle::kMost);
      for (std::uint32_t i = 0; i < bundle.size; ++i) {
        const glm::dvec2 p = radius_m_ * in_disk(square.point(first + i));
        bundle.x[i] = static_cast<float>(p.x);
        bundle.y[i] = static_cast<float>(p.y);
      }
      ParallelRays::count(bands, bundle);
      for (std::size_t i = 0; i < bundle.size; ++i) {
        if (!head_blocks(parallel_->ray(at, bundle.x[i], bundle.y[i]))) sum += scene_.transmittance(bundle.count[i]);
      }
    }
    return sum;
  }

  bool head_blocks(const FibreRay& ray) const { return head_ && scene_.head(ray); }

  const FibreScene& scene_;
  const Light& light_;
  std::uint32_t rays_;
  double radius_m_;
  std::uint64_t seed_;
  int enough_;
  bool head_;
  std::optional<ParallelRays> parallel_;  // directional lights
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
