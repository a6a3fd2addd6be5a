// SATF lookup: ns per sample of RecordBank::lookup, as a ratio to copying the bytes that it reads and writes once, and
// the cost of attach(). Tracks of 25 plates that hold a record, as the coherent choice leaves them; unheld: random
// records.
#include <benchmark/benchmark.h>

#include <cstring>
#include <numbers>
#include <random>

#include "pelage/db/database_source.h"

namespace pelage {
namespace {

constexpr int kSectors = 20000;
constexpr std::size_t kPlates = 25;

BakeSettings settings_of(Storage storage) {
  BakeSettings s;
  s.views = s.lights = s.samples = 32;
  s.storage = storage;
  return s;
}

/// Records of noise: the lookup's time does not depend on what it reads.
RecordBank noise_bank(int records, Storage storage) {
  const BakeSettings settings = settings_of(storage);
  const RecordShape shape = record_shape(settings);
  std::mt19937 random(1);
  std::vector<StoredSector> rows(static_cast<std::size_t>(records));
  for (StoredSector& row : rows) {
    row.features.assign(11, static_cast<float>(random() % 1000));
    row.tau.bytes.resize(shape.tau_size() * bytes_per_value(storage));
    row.re.bytes.resize(shape.re_size() * bytes_per_value(storage));
    for (auto* bytes : {&row.tau.bytes, &row.re.bytes}) {
      for (auto& b : *bytes) b = static_cast<std::uint8_t>(random() % 60);  // below 0x7C: a half stays finite
    }
  }
  const FeatureScale scale{std::vector<double>(11, 0.0), std::vector<double>(11, 1.0)};
  return RecordBank({settings, "random", "", "", "bench", rows.size()}, scale, rows);
}

struct Query {
  std::size_t record;
  float shift;
  SatfAngles angles;
};

/// Angles of a ring sector of 24: 30 degrees wide, drifting along the track.
std::vector<Query> queries(std::size_t records, bool held) {
  std::mt19937 random(2);
  std::uniform_real_distribution<float> turn(0.0F, 2 * std::numbers::pi_v<float>);
  std::vector<Query> all;
  Query q{};
  for (int i = 0; i < kSectors; ++i) {
    if (!held || static_cast<std::size_t>(i) % kPlates == 0) {
      const float view = turn(random), light = turn(random);
      q = {random() % records, turn(random), {view, view + 0.5F, light, light + 0.5F}};
    }
    q.shift += 0.01F;
    q.angles.view_first += 0.02F;
    q.angles.view_last += 0.02F;
    all.push_back(q);
  }
  return all;
}

void lookup(benchmark::State& state, Storage storage, bool held) {
  const RecordBank bank = noise_bank(static_cast<int>(state.range(0)), storage);
  const auto all = queries(bank.size(), held);
  const auto n = static_cast<std::size_t>(bank.shape().samples);
  std::vector<float> tau(n), re(n);
  for (auto _ : state) {
    for (const Query& q : all) {
      bank.lookup(q.record, q.shift, q.angles, tau, re);
      benchmark::DoNotOptimize(tau.data());
      benchmark::DoNotOptimize(re.data());
      benchmark::ClobberMemory();
    }
  }
  state.SetItemsProcessed(state.iterations() * kSectors * static_cast<std::int64_t>(n));
}

/// Per sample: 4 + 2 bytes of cells and 8 of results, the yardstick.
void copy(benchmark::State& state) {
  const std::size_t bytes = 14 * 32;
  std::vector<char> from(kSectors * bytes, 1), to(kSectors * bytes);
  for (auto _ : state) {
    for (std::size_t i = 0; i < kSectors; ++i) std::memcpy(&to[i * bytes], &from[i * bytes], bytes);
    benchmark::DoNotOptimize(to.data());
    benchmark::ClobberMemory();
  }
  state.SetItemsProcessed(state.iterations() * kSectors * 32);
}

BENCHMARK(copy)->Unit(benchmark::kMillisecond);
BENCHMARK_CAPTURE(lookup, u8_held, Storage::u8, true)->Arg(1000)->Arg(4000)->Unit(benchmark::kMillisecond);
BENCHMARK_CAPTURE(lookup, u8_unheld, Storage::u8, false)->Arg(1000)->Unit(benchmark::kMillisecond);
BENCHMARK_CAPTURE(lookup, half_held, Storage::half, true)->Arg(1000)->Unit(benchmark::kMillisecond);

}  // namespace
}  // namespace pelage
