#include "pelage/bake/record_error.h"

#include <algorithm>
#include <chrono>
#include <cmath>
#include <functional>
#include <numbers>

#include "pelage/data_schema/errors.h"
#include "pelage/data_schema/numeric.h"
#include "pelage/db/database_source.h"
#include "pelage/db/features.h"
#include "pelage/db/optical_scale.h"

namespace pelage {
namespace {

constexpr float kTurn = 2 * std::numbers::pi_v<float>;

void append_track(const SectorSet& all, std::size_t track, SectorSample& sample) {
  const std::size_t length = static_cast<std::size_t>(all.plates) + 1;
  for (std::size_t i = track * length; i < (track + 1) * length; ++i) {
    const SectorCrossings strands = all.sector(i);
    sample.sectors.crossings.insert(sample.sectors.crossings.end(), strands.begin(), strands.end());
    sample.sectors.offsets.push_back(static_cast<std::uint32_t>(sample.sectors.crossings.size()));
    sample.sectors.drift.push_back(all.drift[i]);
  }
}

void append_jacobians(const Division& division, const SweptCluster& swept, int track_of_cluster, SectorSample& sample) {
  int layer = 0, sector = track_of_cluster;
  for (; sector >= sectors_in_layer(division, layer); ++layer) sector -= sectors_in_layer(division, layer);
  for (const CrossSection& s : swept.cross_sections)
    sample.jacobians.push_back(sector_jacobian(division, layer, sector, s));
}

void append_tracks(std::span<const Cluster> clusters, const Division& division, int sectors, SectorSample& sample) {
  const SectorSet all = sectors_of(clusters, division);
  const std::size_t wanted = static_cast<std::size_t>(sectors) / (static_cast<std::size_t>(all.plates) + 1) + 1;
  const std::size_t count = std::min(wanted, all.tracks());
  const auto per_cluster = static_cast<std::size_t>(tracks_per_cluster(division));
  sample.sectors.plates = all.plates;
  for (std::size_t i = 0; i < count; ++i) {
    const std::size_t track = i * all.tracks() / count;
    append_track(all, track, sample);
    const SweptCluster swept = sweep(clusters[track / per_cluster], division.plates);
    append_jacobians(division, swept, static_cast<int>(track % per_cluster), sample);
  }
}

/// c of DESIGN section 4 for a ray along sector direction u = (sin, cos): with d = J u / |J u|, |J^-1 d| = 1 / |J u|.
float optical_scale(const glm::mat2& j, float angle, double blocked_m, double sigma) {
  const glm::vec2 along = j * glm::vec2(std::sin(angle), std::cos(angle));
  const auto length = std::sqrt(static_cast<double>(along.x * along.x + along.y * along.y));
  const double area = std::abs(static_cast<double>(j[0].x * j[1].y - j[1].x * j[0].y));
  return static_cast<float>(gaussian_mass(blocked_m, sigma * area / length) * length / area);
}

/// Evenly spread over the two circles (a rank-1 lattice over pairs, turned by the golden ratio from sector to sector).
SatfAngles angle_pair(std::size_t sector, int pair, int pairs) {
  const double golden = 0.6180339887498949;
  const double turn = golden * static_cast<double>(sector);
  const auto view = static_cast<float>((pair + turn) / pairs - std::floor((pair + turn) / pairs));
  const double l = golden * pair + 0.7548776662466927 * static_cast<double>(sector);
  const auto light = static_cast<float>(l - std::floor(l));
  return {kTurn * view, kTurn * view, kTurn * light, kTurn * light};
}

/// Calls use(row, sector, angles) for each pair of each counted sector.
template <class Use>
void each_row(const SectorSample& sample, const Use& use) {
  std::size_t row = 0;
  for (std::size_t sector = 0; sector < sample.counted.size(); ++sector) {
    if (!sample.counted[sector]) continue;
    for (int pair = 0; pair < sample.angle_pairs; ++pair)
      use(row++, sector, angle_pair(sector, pair, sample.angle_pairs));
  }
}

std::size_t rows_of(const SectorSample& sample) {
  return static_cast<std::size_t>(std::count(sample.counted.begin(), sample.counted.end(), 1)) *
         static_cast<std::size_t>(sample.angle_pairs);
}

/// Rows of `from` values as rows of `to`, linear in s, which is periodic as the lookup's is.
void resample(std::vector<float>& values, std::size_t from, std::size_t to) {
  if (from == to) return;
  std::vector<float> result(values.size() / from * to);
  for (std::size_t i = 0; i < result.size(); ++i) {
    const float* const row = &values[i / to * from];
    const double at = (static_cast<double>(i % to) + 0.5) / static_cast<double>(to) * static_cast<double>(from) - 0.5;
    const double whole = std::floor(at);
    const std::size_t k = (static_cast<std::size_t>(whole + static_cast<double>(from))) % from;
    const auto beyond = static_cast<float>(at - whole);
    result[i] = (1 - beyond) * row[k] + beyond * row[(k + 1) % from];
  }
  values = std::move(result);
}

double evaluate(const RecordSource& source, const SectorSample& sample, SeenSectors& seen) {
  const auto n = static_cast<std::size_t>(source.samples());
  seen.alpha.resize(rows_of(sample) * n);
  seen.radiance.resize(seen.alpha.size());
  const auto start = std::chrono::steady_clock::now();
  each_row(sample, [&](std::size_t row, std::size_t sector, const SatfAngles& angles) {
    source.evaluate(sector, angles, {&seen.alpha[row * n], n}, {&seen.radiance[row * n], n});
  });
  return std::chrono::duration<double, std::milli>(std::chrono::steady_clock::now() - start).count();
}

double mean_square(const std::vector<float>& a, const std::vector<float>& b) {
  double sum = 0;
  for (std::size_t i = 0; i < a.size(); ++i) sum += std::pow(static_cast<double>(a[i]) - static_cast<double>(b[i]), 2);
  return sum / static_cast<double>(a.size());
}

double mean(const std::vector<float>& a) {
  double sum = 0;
  for (const float v : a) sum += static_cast<double>(v);
  return sum / static_cast<double>(a.size());
}

/// RMS over HSVs between non-empty sectors, hat-weighted along s.
double seam(const SeenSectors& seen, const SectorSample& sample) {
  const std::size_t length = static_cast<std::size_t>(sample.sectors.plates) + 1;
  const std::size_t n = seen.along_r.size() / sample.used.size();
  double sum = 0, weight = 0;
  for (std::size_t i = 0; i + 1 < sample.used.size(); ++i) {
    if ((i + 1) % length == 0 || !sample.used[i] || !sample.used[i + 1]) continue;
    for (std::size_t x = 0; x < n; ++x) {
      const double s = (static_cast<double>(x) + 0.5) / static_cast<double>(n);
      const double from =
          s * static_cast<double>(n) - 0.5 - static_cast<double>(sample.sectors.drift[i]) * static_cast<double>(n);
      if (!(from >= 0 && from < static_cast<double>(n) - 1)) continue;
      const auto k = static_cast<std::size_t>(from);
      const double f = from - static_cast<double>(k);
      const float* row = &seen.along_r[i * n];
      const double before = (1 - f) * static_cast<double>(row[k]) + f * static_cast<double>(row[k + 1]);
      const double hat = 1 - std::abs(2 * s - 1);
      sum += hat * std::pow(before - static_cast<double>(seen.along_r[(i + 1) * n + x]), 2);
      weight += hat;
    }
  }
  return weight > 0 ? std::sqrt(sum / weight) : 0;
}

/// Standard error of the root of a mean square over tracks: that of a ratio of sums (squares to values), by the delta
/// method.
double error_of_rmse(const SeenSectors& seen, const SeenSectors& truth, const SectorSample& sample, double square) {
  const auto n = static_cast<std::size_t>(seen.samples);
  std::vector<double> squares(sample.sectors.tracks()), values(sample.sectors.tracks());
  each_row(sample, [&](std::size_t row, std::size_t sector, const SatfAngles&) {
    const std::size_t track = sector / (static_cast<std::size_t>(sample.sectors.plates) + 1);
    for (std::size_t x = row * n; x < (row + 1) * n; ++x)
      squares[track] += std::pow(static_cast<double>(seen.radiance[x]) - static_cast<double>(truth.radiance[x]), 2);
    values[track] += static_cast<double>(n);
  });
  double sum = 0, all = 0, used = 0;
  for (std::size_t i = 0; i < squares.size(); ++i) {
    sum += std::pow(squares[i] - square * values[i], 2);
    all += values[i];
    used += values[i] > 0 ? 1 : 0;
  }
  if (used < 2 || !(square > 0)) return 0;
  return std::sqrt(sum * used / (used - 1)) / all / (2 * std::sqrt(square));
}

}  // namespace

SectorSample sample_sectors(const Hairstyle& style, const BakeSettings& baked, int sectors, int angle_pairs,
                            Counted counted) {
  SectorSample sample;
  sample.angle_pairs = angle_pairs;
  sample.sigma = baked.sigma;
  sample.blocked_m = static_cast<double>(style.opacity) * static_cast<double>(style.diameter_m);
  Division division = style.division;
  if (counted == Counted::between) division.plates *= 2;
  append_tracks(style.clusters, division, sectors, sample);
  if (sample.sectors.tracks() == 0) throw InputError(style.name, "it has no clusters: there is nothing to compare");
  const auto width = static_cast<std::size_t>(dimension(baked.features));
  const auto features = density_features(sample.sectors, baked.features, baked.grid, baked.sigma);
  const std::size_t length = static_cast<std::size_t>(sample.sectors.plates) + 1;
  for (std::size_t i = 0; i < sample.sectors.size(); ++i) {
    sample.used.push_back(features[i * width] >= kEmptyDensity);
    sample.counted.push_back(sample.used.back() && (counted == Counted::all || i % length % 2 == 1));
  }
  if (std::find(sample.counted.begin(), sample.counted.end(), 1) == sample.counted.end())
    throw InputError(style.name, "no strand crosses its sectors: there is nothing to compare");
  return sample;
}

SeenSectors look(const RecordSource& source, const SectorSample& sample, int samples) {
  const auto n = static_cast<std::size_t>(source.samples());
  SeenSectors seen;
  seen.evaluate_ms = evaluate(source, sample, seen);
  const auto to_alpha = [&](std::span<float> tau, std::size_t sector, float view) {
    const float gain =
        optical_scale(sample.jacobians[sector], view, sample.blocked_m, sample.sigma) / source.reference_scale();
    for (float& t : tau) t = 1 - exp_neg(t * gain);
  };
  each_row(sample, [&](std::size_t row, std::size_t sector, const SatfAngles& angles) {
    to_alpha({&seen.alpha[row * n], n}, sector, angles.view_first);
    for (std::size_t x = row * n; x < (row + 1) * n; ++x) seen.radiance[x] *= seen.alpha[x];
  });
  seen.along_r.resize(sample.used.size() * n);
  for (std::size_t sector = 0; sector < sample.used.size(); ++sector) {
    if (!sample.used[sector]) continue;
    const std::span<float> tau(&seen.along_r[sector * n], n);
    source.evaluate(sector, {0, 0, 0, 0}, tau, {});
    to_alpha(tau, sector, 0);
  }
  seen.samples = samples > 0 ? samples : static_cast<int>(n);
  for (std::vector<float>* const values : {&seen.alpha, &seen.radiance, &seen.along_r})
    resample(*values, n, static_cast<std::size_t>(seen.samples));
  return seen;
}

double evaluate_ms(const RecordSource& source, const SectorSample& sample) {
  SeenSectors seen;
  return evaluate(source, sample, seen);
}

RecordError record_error(const SeenSectors& seen, const SeenSectors& truth, const SectorSample& sample) {
  RecordError error;
  const double square = mean_square(seen.radiance, truth.radiance);
  error.radiance_rmse = std::sqrt(square);
  error.radiance_rmse_error = error_of_rmse(seen, truth, sample, square);
  error.radiance_bias = mean(seen.radiance) - mean(truth.radiance);
  error.alpha_rmse = std::sqrt(mean_square(seen.alpha, truth.alpha));
  error.seam = seam(seen, sample);
  return error;
}

}  // namespace pelage
