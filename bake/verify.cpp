#include "pelage/bake/verify.h"

#include <algorithm>
#include <chrono>
#include <cmath>
#include <functional>

#include "pelage/bake/direct_source.h"
#include "pelage/bake/record_error.h"
#include "pelage/db/database_source.h"

namespace pelage {
namespace {

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

LadderRung rung_of(std::string name, const SeenSectors& seen, const SeenSectors& truth, const SectorSample& sample) {
  const RecordError error = record_error(seen, truth, sample);
  LadderRung rung{std::move(name)};
  rung.radiance_rmse = error.radiance_rmse;
  rung.radiance_bias = error.radiance_bias;
  rung.alpha_rmse = error.alpha_rmse;
  rung.seam = error.seam;
  rung.evaluate_ns = seen.evaluate_ms * 1e6 / static_cast<double>(seen.alpha.size());
  return rung;
}

float mean(const std::vector<float>& values) {
  double sum = 0;
  for (const float v : values) sum += static_cast<double>(v);
  return static_cast<float>(sum / static_cast<double>(values.size()));
}

LadderRung mean_rung(const SeenSectors& truth, const SectorSample& sample) {
  SeenSectors seen = truth;
  std::fill(seen.radiance.begin(), seen.radiance.end(), mean(truth.radiance));
  std::fill(seen.alpha.begin(), seen.alpha.end(), mean(truth.alpha));
  std::fill(seen.along_r.begin(), seen.along_r.end(), 0.0F);
  seen.evaluate_ms = 0;
  return rung_of("predict the mean", seen, truth, sample);
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
  const SectorSample sample = sample_sectors(style, baked, settings.sectors, settings.angle_pairs);
  DirectSource direct(baked);
  const double direct_attach_ms = milliseconds([&] { direct.attach(sample.sectors); });
  const SeenSectors truth = look(direct, sample);

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
      const SeenSectors seen = look(source, sample);
      ladder.push_back(rung_of(std::string(name_of(set)) + ", " + variant.name, seen, truth, sample));
      ladder.back().attach_ms = ms;
    }
  }
  ladder.push_back(rung_of("direct", truth, truth, sample));
  ladder.back().attach_ms = direct_attach_ms;
  return ladder;
}

}  // namespace pelage
