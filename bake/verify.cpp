#include "pelage/bake/verify.h"

#include <algorithm>
#include <chrono>
#include <cmath>
#include <functional>
#include <numbers>

#include "pelage/bake/direct_source.h"
#include "pelage/data_schema/errors.h"
#include "pelage/data_schema/numeric.h"
#include "pelage/db/database_source.h"
#include "pelage/db/optical_scale.h"
#include "pelage/db/sectors.h"

namespace pelage {
namespace {

constexpr float kTurn = 2 * std::numbers::pi_v<float>;

double milliseconds(const std::function<void()>& work) {
  const auto start = std::chrono::steady_clock::now();
  work();
  return std::chrono::duration<double, std::milli>(std::chrono::steady_clock::now() - start).count();
}

/// Quantising and dequantising in float adds up to 255 x 2^-23 of a step to what rounding to the nearest step allows.
constexpr double kFloatSlack = 1.0 + 1e-4;

/// Largest |stored - traced| over what rounding may do to the stored value.
double worst_difference(const QuantisedView& stored, const std::vector<float>& traced, Storage storage) {
  const std::vector<float> values = dequantise(stored, storage);
  double worst = 0;
  for (std::size_t i = 0; i < values.size(); ++i) {
    const double allowed = storage == Storage::u8 ? static_cast<double>(stored.scale) / 510 * kFloatSlack + 1e-30
                                                  : static_cast<double>(traced[i]) * 0x1p-11 + 0x1p-25;
    worst = std::max(worst, std::abs(static_cast<double>(values[i]) - static_cast<double>(traced[i])) / allowed);
  }
  return worst;
}

/// Sectors to measure on, with what turns optical depth into opacity.
struct Sample {
  SectorSet sectors;
  std::vector<glm::mat2> jacobians;  // [sector] plate plane [m] per (s, r)
  std::vector<char> used;            // [sector] holds strands
};

void append_track(const SectorSet& all, std::size_t track, Sample& sample) {
  const std::size_t length = static_cast<std::size_t>(all.plates) + 1;
  for (std::size_t i = track * length; i < (track + 1) * length; ++i) {
    const SectorCrossings strands = all.sector(i);
    sample.sectors.crossings.insert(sample.sectors.crossings.end(), strands.begin(), strands.end());
    sample.sectors.offsets.push_back(static_cast<std::uint32_t>(sample.sectors.crossings.size()));
    sample.sectors.drift.push_back(all.drift[i]);
  }
}

void append_jacobians(const Hairstyle& style, const SweptCluster& swept, int track_of_cluster, Sample& sample) {
  int layer = 0, sector = track_of_cluster;
  for (; sector >= sectors_in_layer(style.division, layer); ++layer) sector -= sectors_in_layer(style.division, layer);
  for (const CrossSection& s : swept.cross_sections) {
    sample.jacobians.push_back(sector_jacobian(style.division, layer, sector, s));
  }
}

Sample choose_tracks(const Hairstyle& style, const BakeSettings& baked, int sectors) {
  const SectorSet all = sectors_of(style.clusters, style.division);
  if (all.tracks() == 0) throw InputError(style.name, "it has no clusters: there is nothing to compare");
  const std::size_t wanted = static_cast<std::size_t>(sectors) / (static_cast<std::size_t>(all.plates) + 1) + 1;
  const std::size_t count = std::min(wanted, all.tracks());
  const auto per_cluster = static_cast<std::size_t>(tracks_per_cluster(style.division));
  Sample sample;
  sample.sectors.plates = all.plates;
  for (std::size_t i = 0; i < count; ++i) {
    const std::size_t track = i * all.tracks() / count;
    append_track(all, track, sample);
    const SweptCluster swept = sweep(style.clusters[track / per_cluster], style.division.plates);
    append_jacobians(style, swept, static_cast<int>(track % per_cluster), sample);
  }
  const auto width = static_cast<std::size_t>(dimension(baked.features));
  const auto features = density_features(sample.sectors, baked.features, baked.grid, baked.sigma);
  for (std::size_t i = 0; i < sample.sectors.size(); ++i) sample.used.push_back(features[i * width] >= kEmptyDensity);
  if (std::find(sample.used.begin(), sample.used.end(), 1) == sample.used.end()) {
    throw InputError(style.name, "no strand crosses its sectors: there is nothing to compare");
  }
  return sample;
}

/// c of DESIGN section 4 for a ray along sector direction u = (sin, cos): with d = J u / |J u|, |J^-1 d| = 1 / |J u|.
float optical_scale(const glm::mat2& j, float angle, const Hairstyle& style, double sigma) {
  const glm::vec2 along = j * glm::vec2(std::sin(angle), std::cos(angle));
  const auto length = std::sqrt(static_cast<double>(along.x * along.x + along.y * along.y));
  const double area = std::abs(static_cast<double>(j[0].x * j[1].y - j[1].x * j[0].y));
  const double blocked = static_cast<double>(style.opacity) * static_cast<double>(style.diameter_m);
  return static_cast<float>(gaussian_mass(blocked, sigma * area / length) * length / area);
}

/// alpha and premultiplied radiance of all used sectors at all angle pairs, and alpha seen along r.
struct Seen {
  std::vector<float> alpha, radiance;  // [used sector][pair][sample]
  std::vector<float> along_r;          // [sector][sample]
  double evaluate_ns = 0;
};

/// Evenly spread over the two circles (a rank-1 lattice over pairs, turned by the golden ratio from sector to sector).
SatfAngles angle_pair(std::size_t sector, int pair, int pairs) {
  const double golden = 0.6180339887498949;
  const double turn = golden * static_cast<double>(sector);
  const auto view = static_cast<float>((pair + turn) / pairs - std::floor((pair + turn) / pairs));
  const double l = golden * pair + 0.7548776662466927 * static_cast<double>(sector);
  const auto light = static_cast<float>(l - std::floor(l));
  return {kTurn * view, kTurn * view, kTurn * light, kTurn * light};
}

Seen look(const RecordSource& source, const Sample& sample, const Hairstyle& style, double sigma, int pairs) {
  const auto n = static_cast<std::size_t>(source.samples());
  std::vector<std::size_t> used;
  for (std::size_t i = 0; i < sample.used.size(); ++i)
    if (sample.used[i]) used.push_back(i);
  Seen seen;
  const auto rows = used.size() * static_cast<std::size_t>(pairs);
  seen.alpha.resize(rows * n);
  seen.radiance.resize(rows * n);
  seen.along_r.resize(sample.used.size() * n);
  const auto to_alpha = [&](std::span<float> tau, std::size_t sector, float view) {
    const float gain = optical_scale(sample.jacobians[sector], view, style, sigma) / source.reference_scale();
    for (float& t : tau) t = 1 - exp_neg(t * gain);
  };
  const auto each_row = [&](const std::function<void(std::size_t, std::size_t, const SatfAngles&)>& use) {
    for (std::size_t row = 0; row < rows; ++row) {
      const std::size_t sector = used[row / static_cast<std::size_t>(pairs)];
      use(row, sector, angle_pair(sector, static_cast<int>(row % static_cast<std::size_t>(pairs)), pairs));
    }
  };
  const double ms = milliseconds([&] {
    each_row([&](std::size_t row, std::size_t sector, const SatfAngles& angles) {
      source.evaluate(sector, angles, {&seen.alpha[row * n], n}, {&seen.radiance[row * n], n});
    });
  });
  seen.evaluate_ns = ms * 1e6 / static_cast<double>(rows * n);
  each_row([&](std::size_t row, std::size_t sector, const SatfAngles& angles) {
    to_alpha({&seen.alpha[row * n], n}, sector, angles.view_first);
    for (std::size_t x = row * n; x < (row + 1) * n; ++x) seen.radiance[x] *= seen.alpha[x];
  });
  for (const std::size_t sector : used) {
    const std::span<float> tau(&seen.along_r[sector * n], n);
    source.evaluate(sector, {0, 0, 0, 0}, tau, {});
    to_alpha(tau, sector, 0);
  }
  return seen;
}

double rmse(const std::vector<float>& a, const std::vector<float>& b) {
  double sum = 0;
  for (std::size_t i = 0; i < a.size(); ++i) sum += std::pow(static_cast<double>(a[i]) - static_cast<double>(b[i]), 2);
  return std::sqrt(sum / static_cast<double>(a.size()));
}

double mean(const std::vector<float>& a) {
  double sum = 0;
  for (const float v : a) sum += static_cast<double>(v);
  return sum / static_cast<double>(a.size());
}

/// RMS over HSVs between non-empty sectors, hat-weighted along s.
double seam(const Seen& seen, const Sample& sample) {
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

LadderRung compare(std::string name, const Seen& seen, const Seen& truth, const Sample& sample) {
  LadderRung rung{std::move(name)};
  rung.radiance_rmse = rmse(seen.radiance, truth.radiance);
  rung.radiance_bias = mean(seen.radiance) - mean(truth.radiance);
  rung.alpha_rmse = rmse(seen.alpha, truth.alpha);
  rung.seam = seam(seen, sample);
  rung.evaluate_ns = seen.evaluate_ns;
  return rung;
}

LadderRung mean_rung(const Seen& truth, const Sample& sample) {
  Seen seen = truth;
  std::fill(seen.radiance.begin(), seen.radiance.end(), static_cast<float>(mean(truth.radiance)));
  std::fill(seen.alpha.begin(), seen.alpha.end(), static_cast<float>(mean(truth.alpha)));
  std::fill(seen.along_r.begin(), seen.along_r.end(), 0.0F);
  seen.evaluate_ns = 0;
  return compare("predict the mean", seen, truth, sample);
}

const char* name_of(FeatureSet set) {
  return set == FeatureSet::paper3 ? "paper3" : set == FeatureSet::moments5 ? "moments5" : "profile11";
}

}  // namespace

RetraceResult retrace(const DatabaseReader& reader, std::uint64_t count) {
  const BakeSettings& settings = reader.metadata().settings;
  const PlanarTracer tracer(settings);
  const RowRange rows = reader.rows();
  const std::uint64_t wanted = std::min(count, rows.size());
  RetraceResult result;
  reader.for_each([&](std::uint64_t id, const SectorView& s) {
    if (result.records == wanted || id != rows.first + result.records * rows.size() / wanted) return;
    const HrirRecord traced = tracer.trace_record(density_grid(s.crossings, settings.grid, settings.sigma));
    result.worst_tau = std::max(result.worst_tau, worst_difference(s.tau, traced.tau, settings.storage));
    result.worst_re = std::max(result.worst_re, worst_difference(s.re, traced.re, settings.storage));
    ++result.records;
  });
  return result;
}

std::vector<LadderRung> accuracy_ladder(const std::shared_ptr<const RecordBank>& bank, const Hairstyle& style,
                                        const LadderSettings& settings) {
  const BakeSettings& baked = bank->metadata().settings;
  const Sample sample = choose_tracks(style, baked, settings.sectors);
  DirectSource direct(baked);
  const double direct_attach_ms = milliseconds([&] { direct.attach(sample.sectors); });
  const Seen truth = look(direct, sample, style, baked.sigma, settings.angle_pairs);

  std::vector<LadderRung> ladder{mean_rung(truth, sample)};
  struct Variant {
    const char* name;
    LookupSettings lookup;
  };
  const Variant variants[] = {{"1 neighbour", {1, false, false}}, {"4 neighbours", {4, false, false}},
                              {"coherent", {1, true, false}},     {"coherent, 4 neighbours", {4, true, false}},
                              {"own alpha", {1, false, true}},    {"own alpha, coherent", {1, true, true}}};
  for (const FeatureSet set : {FeatureSet::paper3, FeatureSet::moments5, FeatureSet::profile11}) {
    for (const Variant& variant : variants) {
      DatabaseSource source(bank, variant.lookup, set);
      const double ms = milliseconds([&] { source.attach(sample.sectors); });
      const Seen seen = look(source, sample, style, baked.sigma, settings.angle_pairs);
      ladder.push_back(compare(std::string(name_of(set)) + ", " + variant.name, seen, truth, sample));
      ladder.back().attach_ms = ms;
    }
  }
  ladder.push_back(compare("direct", truth, truth, sample));
  ladder.back().attach_ms = direct_attach_ms;
  return ladder;
}

}  // namespace pelage
