// Map construction against the time to copy the bytes that it reads and writes once.
//
// Bytes: every byte of a record that the frame's angles touch (two views of tau, two views x two lights of re) counts
// once per sector that shows it, plus the texels. The straightforward version is the same maps with every sector
// traced.
#include <benchmark/benchmark.h>
#include <tbb/global_control.h>

#include <cmath>
#include <cstdio>
#include <cstring>
#include <filesystem>
#include <glm/geometric.hpp>
#include <map>
#include <string>

#include "pelage/bake/bake_pipeline.h"
#include "pelage/bake/direct_source.h"
#include "pelage/db/database_source.h"
#include "pelage/satf/maps.h"
#include "pelage/satf/self_shadow.h"

namespace {

using namespace pelage;

Hairstyle style_of(int clusters) {
  Hairstyle style;
  style.name = "bench";
  style.diameter_m = 2.2e-4F;
  for (int c = 0; c < clusters; ++c) {
    Cluster cluster;
    const float x = 0.01F * static_cast<float>(c);
    for (int i = 0; i < 5; ++i) {
      const float y = static_cast<float>(i) / 4;
      cluster.centre_line.push_back({x + 0.02F * y * y, -0.2F * y, 0.01F * std::sin(3.0F * y + x)});
    }
    cluster.cross_sections.assign(4, {.011F, .001F, .007F});
    for (int s = 0; s < 80; ++s) {
      const float v = std::sqrt((static_cast<float>(s) + 0.5F) / 80), u = 2.39996F * static_cast<float>(s) + x;
      for (int i = 0; i <= 8; ++i) {
        const float t = static_cast<float>(i) / 8;
        cluster.strand_points.push_back({t, v * std::cos(u + 0.8F * t), v * std::sin(u + 0.8F * t)});
      }
      cluster.strand_offsets.push_back(static_cast<std::uint32_t>(cluster.strand_points.size()));
    }
    style.clusters.push_back(std::move(cluster));
  }
  return style;
}

BakeSettings even_settings() {
  BakeSettings settings;
  settings.views = settings.lights = settings.samples = 32;
  return settings;
}

struct Fixture {
  BakeSettings bake = even_settings();
  Hairstyle style = style_of(40);
  std::filesystem::path file = std::filesystem::temp_directory_path() / "pelage-bench-maps.hrir";
  std::unique_ptr<DatabaseSource> database;
  DirectSource direct{bake};
  SatfModel model;
  std::vector<Texel> texels;
  std::size_t shown = 0;  // sectors with strands
  MapRequest request;

  Fixture() {
    bake.sectors = 1000;
    bake_database(bake, &style, file, [](std::uint64_t, std::uint64_t) {});
    database = std::make_unique<DatabaseSource>(file);
    std::filesystem::remove(file);
    model = make_model(style, bake, bake.samples);
    database->attach(model.sectors);
    direct.attach(model.sectors);
    texels.resize(model.texels());
    for (std::size_t i = 0; i < model.sectors.size(); ++i) shown += model.sectors.sector(i).empty() ? 0 : 1;
    request.eye = {0.4F, 0.1F, 0.6F};
    request.to_light = glm::normalize(glm::vec3(0.4F, 0.7F, 0.6F));
  }
  std::size_t bytes() const {
    return shown * static_cast<std::size_t>(model.samples) * 6 + texels.size() * sizeof(Texel);
  }
};

Fixture& fixture() {
  static Fixture f;
  return f;
}

void maps_from_database(benchmark::State& state) {
  Fixture& f = fixture();
  for (auto _ : state) build_maps(f.model, *f.database, f.request, {}, f.texels);
  state.SetBytesProcessed(static_cast<std::int64_t>(state.iterations()) * static_cast<std::int64_t>(f.bytes()));
}

void maps_traced_directly(benchmark::State& state) {
  Fixture& f = fixture();
  for (auto _ : state) build_maps(f.model, f.direct, f.request, {}, f.texels);
}

void shadow_maps(benchmark::State& state) {
  Fixture& f = fixture();
  std::vector<std::uint16_t> shadows(f.model.texels());
  for (auto _ : state) build_shadows(f.model, *f.database, {f.request.to_light, true, true, nullptr}, shadows);
}

void copy_of_the_same_bytes(benchmark::State& state) {
  // Half of them read, half written, from a working set of the same size.
  Fixture& f = fixture();
  std::vector<char> from(f.bytes() / 2, 1), to(f.bytes() / 2);
  for (auto _ : state) {
    std::memcpy(to.data(), from.data(), from.size());
    benchmark::DoNotOptimize(to.data());
    benchmark::ClobberMemory();
  }
  state.SetBytesProcessed(static_cast<std::int64_t>(state.iterations()) * static_cast<std::int64_t>(f.bytes()));
}

BENCHMARK(copy_of_the_same_bytes)->Unit(benchmark::kMillisecond);
BENCHMARK(maps_from_database)->Unit(benchmark::kMillisecond);
BENCHMARK(shadow_maps)->Unit(benchmark::kMillisecond);
BENCHMARK(maps_traced_directly)->Unit(benchmark::kMillisecond);

/// Keeps the times, to print ratios at the end.
class Ratios : public benchmark::ConsoleReporter {
 public:
  void ReportRuns(const std::vector<Run>& runs) override {
    for (const Run& run : runs) times_[run.benchmark_name()] = run.GetAdjustedCPUTime();
    ConsoleReporter::ReportRuns(runs);
  }
  void Finalize() override {
    const double copy = times_["copy_of_the_same_bytes"], maps = times_["maps_from_database"];
    std::printf("\nmaps / copy of the bytes: %.1f (asked: <= 4)\ntraced directly / maps: %.1f\n", maps / copy,
                times_["maps_traced_directly"] / maps);
  }

 private:
  std::map<std::string, double> times_;
};

}  // namespace

int main(int argc, char** argv) {
  const tbb::global_control one_thread(tbb::global_control::max_allowed_parallelism, 1);
  benchmark::Initialize(&argc, argv);
  Ratios reporter;
  benchmark::RunSpecifiedBenchmarks(&reporter);
  reporter.Finalize();
  return 0;
}
