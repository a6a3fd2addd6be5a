// Speed of baking. The ratio that counts is the shared march against one march per (view, light, ray), both measured
// here in CPU time of one thread, interleaved, so that a loaded machine slows both. Wanted: 60.
#include <benchmark/benchmark.h>

#include <algorithm>
#include <cstdio>
#include <ctime>
#include <numbers>
#include <random>
#include <vector>

#include "pelage/bake/direct_source.h"
#include "pelage/bake/planar_reference.h"
#include "pelage/bake/planar_tracer.h"
#include "pelage/bake/sector_sampling.h"

namespace {

using namespace pelage;

BakeSettings dense_settings() {
  BakeSettings settings;
  settings.views = settings.lights = settings.samples = 32;
  settings.max_strands = 40;
  return settings;
}

DensityGrid sector_grid(const BakeSettings& settings, std::uint64_t index) {
  return density_grid(random_sector(settings, index), settings.grid, settings.sigma);
}

void trace_record(benchmark::State& state) {
  const BakeSettings settings = dense_settings();
  const PlanarTracer tracer(settings);
  const DensityGrid grid = sector_grid(settings, static_cast<std::uint64_t>(state.range(0)));
  for (auto _ : state) benchmark::DoNotOptimize(tracer.trace_record(grid));
  state.counters["rays/s"] =
      benchmark::Counter(static_cast<double>(settings.views) * settings.lights * settings.samples,
                         benchmark::Counter::kIsIterationInvariantRate);
}
BENCHMARK(trace_record)->Arg(0)->Arg(1)->Arg(2)->Unit(benchmark::kMillisecond);

void reference_ray(benchmark::State& state) {
  const BakeSettings settings = dense_settings();
  const PlanarShading shading(settings);
  const DensityGrid grid = sector_grid(settings, 0);
  double angle = 0;
  for (auto _ : state) {
    angle += 0.7;
    benchmark::DoNotOptimize(trace_ray_reference(grid, settings, shading, angle, 1 + 2 * angle, 0.3));
  }
}
BENCHMARK(reference_ray)->Unit(benchmark::kMicrosecond);

void trace_rays(benchmark::State& state) {
  const BakeSettings settings = dense_settings();
  const PlanarTracer tracer(settings);
  const PlanarField field(sector_grid(settings, 0));
  std::vector<float> tau(32), re(state.range(0) == 1 ? 32U : 0U);
  for (auto _ : state) {
    tracer.trace_rays(field, {0.3F, 0.5F, 1.0F, 1.4F}, tau, re);
    benchmark::DoNotOptimize(tau.data());
  }
}
BENCHMARK(trace_rays)->ArgName("re")->Arg(1)->Arg(0)->Unit(benchmark::kMicrosecond);

void direct_sector(benchmark::State& state) {
  const BakeSettings settings = dense_settings();
  SectorSet set;
  set.plates = 1;
  for (std::uint64_t i = 0; i < 64; ++i) {
    for (const glm::vec2& p : random_sector(settings, i)) set.crossings.push_back(p);
    set.offsets.push_back(static_cast<std::uint32_t>(set.crossings.size()));
  }
  DirectSource source(settings);
  source.attach(set);
  std::vector<float> tau(32), re(32);
  std::size_t i = 0;
  for (auto _ : state) source.evaluate(i++ % 64, {0.3F, 0.5F, 1.0F, 1.4F}, tau, re);
}
BENCHMARK(direct_sector)->Unit(benchmark::kMicrosecond);

void features_of_a_sector(benchmark::State& state) {
  const BakeSettings settings = dense_settings();
  const auto sector = random_sector(settings, 0);
  for (auto _ : state) benchmark::DoNotOptimize(projections(sector, settings.grid, settings.sigma));
  state.counters["strands"] = static_cast<double>(sector.size());
}
BENCHMARK(features_of_a_sector)->Unit(benchmark::kMicrosecond);

void choose_representatives(benchmark::State& state) {
  std::mt19937 random(1);
  std::normal_distribution<float> normal;
  std::vector<float> rows(250000 * 11);
  for (float& x : rows) x = normal(random);
  for (auto _ : state) benchmark::DoNotOptimize(representatives(rows, 11, 1500, 1));
}
BENCHMARK(choose_representatives)->Unit(benchmark::kMillisecond)->Iterations(1)->UseRealTime();

double thread_seconds() {
  timespec t{};
  clock_gettime(CLOCK_THREAD_CPUTIME_ID, &t);
  return static_cast<double>(t.tv_sec) + 1e-9 * static_cast<double>(t.tv_nsec);
}

/// Reference against shared march per (view, light, ray): medians over sectors. The reference is timed on every 16th
/// pair of angles.
void print_ratio() {
  const BakeSettings settings = dense_settings();
  const PlanarTracer tracer(settings);
  const PlanarShading shading(settings);
  std::vector<double> ratios, record_ms;
  for (std::uint64_t index = 0; index < 9; ++index) {
    const DensityGrid grid = sector_grid(settings, index);
    const double start = thread_seconds();
    int rays = 0;
    for (int v = 0; v < settings.views; ++v)
      for (int l = v % 16; l < settings.lights; l += 16)
        for (int x = 0; x < settings.samples; ++x, ++rays)
          benchmark::DoNotOptimize(
              trace_ray_reference(grid, settings, shading, 2 * std::numbers::pi * v / settings.views,
                                  2 * std::numbers::pi * l / settings.lights, (x + 0.5) / settings.samples));
    const double middle = thread_seconds();
    constexpr int kRepeats = 10;
    for (int i = 0; i < kRepeats; ++i) benchmark::DoNotOptimize(tracer.trace_record(grid));
    const double record_s = (thread_seconds() - middle) / kRepeats;
    const double all = static_cast<double>(settings.views) * settings.lights * settings.samples;
    record_ms.push_back(1e3 * record_s);
    ratios.push_back((middle - start) / rays / (record_s / all));
  }
  std::sort(ratios.begin(), ratios.end());
  std::sort(record_ms.begin(), record_ms.end());
  std::printf("bake: shared march %.0fx (%.0f-%.0f) the march per (view, light, ray); %.2f ms per sector\n",
              ratios[ratios.size() / 2], ratios.front(), ratios.back(), record_ms[record_ms.size() / 2]);
}

}  // namespace

int main(int argc, char** argv) {
  benchmark::Initialize(&argc, argv);
  if (benchmark::ReportUnrecognizedArguments(argc, argv)) return 2;
  print_ratio();
  benchmark::RunSpecifiedBenchmarks();
  return 0;
}
