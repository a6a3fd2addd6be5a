#include "pelage/app/shadow_error.h"

#include <algorithm>
#include <chrono>
#include <cmath>
#include <random>
#include <stdexcept>

#include "pelage/console/program.h"

namespace pelage::app {
namespace {

/// The value below which a share of the values lies; reorders them.
double quantile_of(std::vector<double>& values, double share) {
  if (values.empty()) return 0;
  const auto at = static_cast<std::ptrdiff_t>(share * static_cast<double>(values.size() - 1) + 0.5);
  std::nth_element(values.begin(), values.begin() + at, values.end());
  return values[static_cast<std::size_t>(at)];
}

}  // namespace

ShadowTruth shadow_truth(const Strands& strands, float opacity, const Light& light, const TruthSettings& settings,
                         std::size_t points, std::uint64_t seed,
                         const std::function<void(std::uint64_t, std::uint64_t)>& progress) {
  ShadowTruth truth;
  std::vector<TruthPoint> at;
  std::mt19937_64 random(seed);
  for (std::size_t i = 0; i < points && !strands.vertices.empty(); ++i) {
    // mt19937_64 is specified to the bit, distributions are not.
    const auto vertex = static_cast<std::uint32_t>(random() % strands.vertices.size());
    at.push_back({strands.vertices[vertex], vertex});
    truth.points.push_back(strands.vertices[vertex]);
  }
  const FibreScene scene(strands, opacity);
  truth.estimates = truth_transmittance(scene, at, light, settings, seed, progress);
  double square = 0, variance = 0;
  for (const TruthEstimate& e : truth.estimates) {
    truth.mean += e.mean;
    square += e.mean * e.mean;
    variance += e.standard_error * e.standard_error;
  }
  const auto n = static_cast<double>(std::max<std::size_t>(truth.points.size(), 1));
  truth.mean /= n;
  truth.deviation = std::sqrt(std::max(0.0, square / n - truth.mean * truth.mean));
  truth.standard_error = std::sqrt(variance / n);
  return truth;
}

ShadowError shadow_error(const std::vector<float>& transmittance, const std::vector<TruthEstimate>& truth) {
  if (transmittance.size() != truth.size()) throw std::invalid_argument("shadow_error: sizes differ");
  ShadowError error;
  std::vector<double> absolute;
  double fourth = 0, of_truth = 0;
  for (std::size_t i = 0; i < truth.size(); ++i) {
    const double difference = static_cast<double>(transmittance[i]) - truth[i].mean;
    error.bias += difference;
    error.rmse += difference * difference;
    fourth += std::pow(difference, 4);
    of_truth += truth[i].standard_error * truth[i].standard_error;
    absolute.push_back(std::abs(difference));
  }
  const auto n = static_cast<double>(std::max<std::size_t>(truth.size(), 1));
  error.bias /= n;
  error.rmse /= n;
  const double variance = std::max(fourth / n - error.rmse * error.rmse, 0.0) / n;
  error.rmse = std::sqrt(error.rmse);
  if (error.rmse > 0) error.rmse_error = std::hypot(std::sqrt(variance), of_truth / n) / (2 * error.rmse);
  error.p99 = quantile_of(absolute, 0.99);
  error.max = quantile_of(absolute, 1.0);
  return error;
}

std::vector<ShadowRow> shadow_rows(const ShadowSettings& base, std::vector<int> resolutions) {
  std::sort(resolutions.begin(), resolutions.end());
  std::vector<ShadowRow> rows{{"unshadowed", "", Method::unshadowed, base}};
  const auto map = [&](std::string name, int resolution, DensityMapSettings settings) {
    settings.resolution = resolution;
    settings.factor = base.density_map.factor;
    ShadowSettings all = base;
    all.density_map = settings;
    rows.push_back({std::move(name), std::to_string(resolution) + "^3", Method::density_map, all});
  };
  for (const int r : resolutions) map("paper A as printed", r, DensityMapSettings::printed());
  // Each correction on top of those before it.
  const int step_at = resolutions[resolutions.size() > 1 ? resolutions.size() - 2 : 0];
  DensityMapSettings step = DensityMapSettings::printed();
  step.fitted = true;
  map("  + fitted to the hair", step_at, step);
  step.area = true;
  map("  + area a D len sin", step_at, step);
  step.centred_lookup = true;
  map("  + values at cell centres", step_at, step);
  step.split = true;
  map("  + segments cut to half cells", step_at, step);
  for (const int r : resolutions) map("density map", r, base.density_map);
  DensityMapSettings trilinear = base.density_map;
  trilinear.trilinear_deposit = true;
  map("density map, trilinear deposit", step_at, trilinear);
  DensityMapSettings adaptive = base.density_map;
  adaptive.adaptive_slices = true;
  map("density map, adaptive slices", step_at, adaptive);
  const auto opacity_map = [&](Method how, const char* name, int count, const char* unit) {
    ShadowSettings settings = base;
    (how == Method::deep_opacity ? settings.opacity_map.layers : settings.opacity_map.slices) = count;
    rows.push_back({name, std::to_string(settings.opacity_map.resolution) + "^2 x " + std::to_string(count) + unit, how,
                    settings});
  };
  for (const int slices : {16, 64, 256}) opacity_map(Method::opacity_shadow, "opacity shadow map", slices, " slices");
  for (const int layers : {3, 7, 15}) opacity_map(Method::deep_opacity, "deep opacity map", layers, " layers");
  return rows;
}

ShadowResult measure_shadow(const ShadowRow& row, const Strands& strands, float opacity, const Light& light,
                            const ShadowTruth& truth, const Repeats& repeats) {
  ShadowResult result;
  const auto begun = std::chrono::steady_clock::now();
  auto shadow = make_shadow(row.how, row.settings, strands, opacity, light);
  std::vector<float> all(strands.vertices.size());
  std::vector<double> build, fill, transmit, filter;
  for (int i = 0; i < repeats.least || (i < repeats.most && milliseconds_since(begun) < repeats.within_ms); ++i) {
    console::throw_if_interrupted();
    auto start = std::chrono::steady_clock::now();
    shadow->build(strands, opacity, light);
    build.push_back(milliseconds_since(start));
    fill.push_back(shadow->times().fill_ms);
    transmit.push_back(shadow->times().transmittance_ms);
    start = std::chrono::steady_clock::now();
    shadow->transmittance(strands.vertices, all);
    filter.push_back(milliseconds_since(start));
    result.sum_ms.push_back(build.back() + filter.back());
  }
  std::vector<double> sum = result.sum_ms;
  result.build_ms = quantile_of(build, 0.5);
  result.fill_ms = quantile_of(fill, 0.5);
  result.transmittance_ms = quantile_of(transmit, 0.5);
  result.filter_ms = quantile_of(filter, 0.5);
  result.spread_ms = 0.5 * (quantile_of(sum, 0.75) - quantile_of(sum, 0.25));
  result.bytes = shadow->bytes();
  std::vector<float> at(truth.points.size());
  shadow->transmittance(truth.points, at);
  result.error = shadow_error(at, truth.estimates);
  return result;
}

}  // namespace pelage::app
