#include "pelage/db/coverage.h"

#include <tbb/parallel_for.h>

#include <algorithm>
#include <cmath>

#include "pelage/db/database_source.h"
#include "pelage/db/nearest_sectors.h"

namespace pelage {
namespace {

NearestSectors index_of(const RecordBank& bank) {
  std::vector<float> points(bank.features().begin(), bank.features().end());
  bank.feature_scale().apply(points);
  return {std::move(points), dimension(bank.metadata().settings.features)};
}

float rms(float distance_sq, int dimensions) {
  return std::sqrt(distance_sq / static_cast<float>(dimensions));
}

}  // namespace

std::vector<float> record_spacing(const RecordBank& bank) {
  const NearestSectors index = index_of(bank);
  std::vector<float> distances(bank.size(), 0.0F);
  if (bank.size() < 2) return distances;
  tbb::parallel_for(std::size_t{0}, bank.size(), [&](std::size_t i) {
    const auto found = index.nearest(index.point(i), 2);
    const Neighbour& other = found[0].record == i ? found[1] : found[0];  // a twin may come before the record itself
    distances[i] = rms(other.distance_sq, index.dimensions());
  });
  return distances;
}

std::vector<float> used_sector_features(const RecordBank& bank, const SectorSet& sectors) {
  const BakeSettings& baked = bank.metadata().settings;
  const auto width = static_cast<std::size_t>(dimension(baked.features));
  const std::vector<float> all = density_features(sectors, baked.features, baked.grid, baked.sigma);
  std::vector<float> used;
  for (std::size_t i = 0; i < sectors.size(); ++i) {
    const float* row = &all[i * width];
    if (row[0] >= kEmptyDensity) used.insert(used.end(), row, row + width);
  }
  return used;
}

std::vector<float> distances_to_records(const RecordBank& bank, std::vector<float> features) {
  const auto width = static_cast<std::size_t>(dimension(bank.metadata().settings.features));
  bank.feature_scale().apply(features);
  const NearestSectors index = index_of(bank);
  std::vector<float> distances(features.size() / width);
  tbb::parallel_for(std::size_t{0}, distances.size(), [&](std::size_t i) {
    distances[i] = rms(index.nearest({&features[i * width], width}, 1)[0].distance_sq, index.dimensions());
  });
  return distances;
}

double uncovered_share(const std::vector<float>& spacing, const std::vector<float>& distances) {
  const float far = quantile(spacing, 0.95);
  const auto beyond = std::count_if(distances.begin(), distances.end(), [&](float d) { return d > far; });
  return distances.empty() ? 0.0 : static_cast<double>(beyond) / static_cast<double>(distances.size());
}

float quantile(std::vector<float> values, double p) {
  if (values.empty()) return 0;
  const auto at = static_cast<std::ptrdiff_t>(std::lround(p * static_cast<double>(values.size() - 1)));
  std::nth_element(values.begin(), values.begin() + at, values.end());
  return values[static_cast<std::size_t>(at)];
}

}  // namespace pelage
