#include "pelage/db/features.h"

#include <tbb/parallel_for.h>

#include <array>
#include <cmath>
#include <numbers>
#include <numeric>

#include "pelage/data_schema/errors.h"

namespace pelage {
namespace {

constexpr int kCosines = 5;
/// Strands' worth of a uniform sector that are mixed into the moments: they stay defined as the density goes to zero.
constexpr double kPriorStrands = 1e-3;

struct Moments {
  double mean, spread;
};

Moments moments(std::span<const double> projection) {
  const auto n = static_cast<double>(projection.size());
  double mass = kPriorStrands, first = kPriorStrands / 2, second = kPriorStrands / 3;
  for (std::size_t i = 0; i < projection.size(); ++i) {
    const double x = (static_cast<double>(i) + 0.5) / n;
    mass += projection[i] / n;
    first += x * projection[i] / n;
    second += x * x * projection[i] / n;
  }
  const double mean = first / mass;
  // Rounding can take the variance of a narrow distribution below 0 by a few ulp.
  return {mean, std::sqrt(std::max(0.0, second / mass - mean * mean))};
}

/// cos(pi k (i + 1/2) / n) / n for k = 1..5: [k][i].
class CosineTable {
 public:
  explicit CosineTable(std::size_t n) : n_(n), values_(kCosines * n) {
    for (std::size_t k = 0; k < kCosines; ++k)
      for (std::size_t i = 0; i < n; ++i) {
        const double x = (static_cast<double>(i) + 0.5) / static_cast<double>(n);
        values_[k * n + i] = std::cos(std::numbers::pi * static_cast<double>(k + 1) * x) / static_cast<double>(n);
      }
  }
  std::size_t size() const { return n_; }
  void coefficients(std::span<const double> projection, std::span<float> out) const {
    for (std::size_t k = 0; k < kCosines; ++k)
      out[k] = static_cast<float>(
          std::inner_product(projection.begin(), projection.end(), values_.begin() + static_cast<long>(k * n_), 0.0));
  }

 private:
  std::size_t n_;
  std::vector<double> values_;
};

/// One table per thread, for the grid size used last.
const CosineTable& cosine_table(std::size_t n) {
  thread_local CosineTable table(n);
  if (table.size() != n) table = CosineTable(n);
  return table;
}

}  // namespace

int dimension(FeatureSet set) noexcept {
  switch (set) {
    case FeatureSet::paper3:
      return 3;
    case FeatureSet::moments5:
      return 5;
    case FeatureSet::profile11:
      return 1 + 2 * kCosines;
  }
  return 0;
}

void density_features(const Projections& p, FeatureSet set, std::span<float> out) {
  PELAGE_ASSERT(out.size() == static_cast<std::size_t>(dimension(set)));
  const double total = std::accumulate(p.along_s.begin(), p.along_s.end(), 0.0);
  out[0] = static_cast<float>(total / static_cast<double>(p.along_s.size()));
  if (set == FeatureSet::profile11) {
    const CosineTable& cosines = cosine_table(p.along_s.size());
    cosines.coefficients(p.along_s, out.subspan(1, kCosines));
    cosines.coefficients(p.along_r, out.subspan(1 + kCosines, kCosines));
    return;
  }
  const Moments s = moments(p.along_s);
  const Moments r = moments(p.along_r);
  out[1] = static_cast<float>(s.mean);
  out[2] = static_cast<float>(r.mean);
  if (set == FeatureSet::paper3) return;
  out[3] = static_cast<float>(s.spread);
  out[4] = static_cast<float>(r.spread);
}

std::vector<float> density_features(const SectorSet& sectors, FeatureSet set, int grid, double sigma) {
  const auto width = static_cast<std::size_t>(dimension(set));
  std::vector<float> features(sectors.size() * width);
  tbb::parallel_for(std::size_t{0}, sectors.size(), [&](std::size_t i) {
    density_features(projections(sectors.sector(i), grid, sigma), set, std::span(features).subspan(i * width, width));
  });
  return features;
}

void FeatureScale::apply(std::span<float> features) const noexcept {
  for (std::size_t i = 0; i < features.size(); ++i) {
    const std::size_t d = i % mean.size();
    features[i] = static_cast<float>((static_cast<double>(features[i]) - mean[d]) * inv_sigma[d]);
  }
}

FeatureScale fit_scale(std::span<const float> features, int dimension) {
  const auto width = static_cast<std::size_t>(dimension);
  PELAGE_ASSERT(width > 0 && !features.empty() && features.size() % width == 0);
  const auto count = static_cast<double>(features.size() / width);
  FeatureScale scale{std::vector<double>(width), std::vector<double>(width)};
  for (std::size_t i = 0; i < features.size(); ++i) scale.mean[i % width] += static_cast<double>(features[i]) / count;
  std::vector<double> variance(width);
  for (std::size_t i = 0; i < features.size(); ++i) {
    const double x = static_cast<double>(features[i]) - scale.mean[i % width];
    variance[i % width] += x * x / count;
  }
  for (std::size_t d = 0; d < width; ++d) {
    // Features are floats: a spread below their rounding is no spread.
    const double sigma = std::sqrt(variance[d]);
    scale.inv_sigma[d] = sigma > 1e-6 * (1e-6 + std::abs(scale.mean[d])) ? 1 / sigma : 0;
  }
  return scale;
}

}  // namespace pelage
