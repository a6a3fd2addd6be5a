// Opening a database (read, verify all checksums, lay out for the lookup) as a ratio to copying its bytes, warm.
// `copy_kept` is what any program pays that keeps a copy: fresh huge pages and one memcpy. `copy_fresh` the same in
// plain pages, `copy` into pages that were touched before, which is memory bandwidth alone. 2000 records of 32 x 32
// angles and 32 samples.
#include <benchmark/benchmark.h>
#include <sys/mman.h>
#include <tbb/global_control.h>

#include <cstdlib>
#include <cstring>
#include <filesystem>
#include <random>

#include "pelage/db/record_bank.h"

namespace pelage {
namespace {

/// A database of noise, written once; opening does not depend on what the records hold.
const std::filesystem::path& noise_database(Storage storage) {
  static const auto write = [](Storage kind) {
    BakeSettings settings;
    settings.sectors = 2000;
    settings.views = settings.lights = settings.samples = 32;
    settings.storage = kind;
    const RecordShape shape = record_shape(settings);
    std::mt19937 random(1);
    StoredSector row;
    row.features.assign(11, 0.5F);
    row.crossings.assign(20, {0.5F, 0.5F});
    row.tau.bytes.resize(shape.tau_size() * bytes_per_value(kind));
    row.re.bytes.resize(shape.re_size() * bytes_per_value(kind));
    for (auto* bytes : {&row.tau.bytes, &row.re.bytes}) {
      for (auto& b : *bytes) b = static_cast<std::uint8_t>(random() % 60);  // below 0x7C: a half stays finite
    }
    const auto file = std::filesystem::temp_directory_path() / (kind == Storage::u8 ? "bench_u8.hrir" : "bench_h.hrir");
    DatabaseWriter writer(file, {settings, "random", "", "", "bench", static_cast<std::uint64_t>(settings.sectors)});
    while (writer.next_row() < static_cast<std::uint64_t>(settings.sectors)) writer.append(row);
    writer.finish();
    std::atexit([] {
      for (const char* name : {"bench_u8.hrir", "bench_h.hrir"}) {
        std::error_code none;
        std::filesystem::remove(std::filesystem::temp_directory_path() / name, none);
      }
    });
    return file;
  };
  static const std::filesystem::path u8 = write(Storage::u8), half = write(Storage::half);
  return storage == Storage::u8 ? u8 : half;
}

void open(benchmark::State& state, Storage storage) {
  const auto& file = noise_database(storage);
  const tbb::global_control limit(tbb::global_control::max_allowed_parallelism,
                                  static_cast<std::size_t>(state.range(0)));
  for (auto _ : state) benchmark::DoNotOptimize(RecordBank(file));
  state.SetBytesProcessed(state.iterations() * static_cast<std::int64_t>(std::filesystem::file_size(file)));
}

void read_rows(benchmark::State& state) {
  const DatabaseReader reader(noise_database(Storage::u8));
  for (auto _ : state) reader.for_each([](std::uint64_t, const SectorView& s) { benchmark::DoNotOptimize(s.re); });
}

void copy(benchmark::State& state) {
  const std::size_t size = std::filesystem::file_size(noise_database(Storage::u8));
  std::vector<char> from(size, 1), to(size, 2);
  for (auto _ : state) {
    std::memcpy(to.data(), from.data(), size);
    benchmark::ClobberMemory();
  }
  state.SetBytesProcessed(state.iterations() * static_cast<std::int64_t>(size));
}

void copy_kept(benchmark::State& state) {
  constexpr std::size_t kHugePage = std::size_t{1} << 21;
  const std::size_t size = std::filesystem::file_size(noise_database(Storage::u8));
  const std::size_t whole = (size + kHugePage - 1) / kHugePage * kHugePage;
  const std::vector<char> from(size, 1);
  for (auto _ : state) {
    void* const to = std::aligned_alloc(kHugePage, whole);
    madvise(to, whole, MADV_HUGEPAGE);
    std::memcpy(to, from.data(), size);
    benchmark::DoNotOptimize(to);
    benchmark::ClobberMemory();
    std::free(to);
  }
  state.SetBytesProcessed(state.iterations() * static_cast<std::int64_t>(size));
}

void copy_fresh(benchmark::State& state) {
  const std::size_t size = std::filesystem::file_size(noise_database(Storage::u8));
  const std::vector<char> from(size, 1);
  for (auto _ : state) {
    std::vector<char> to(from);
    benchmark::DoNotOptimize(to.data());
  }
  state.SetBytesProcessed(state.iterations() * static_cast<std::int64_t>(size));
}

void checksum(benchmark::State& state) {
  const std::vector<char> record(34'000, 1);
  for (auto _ : state) {
    Checksum sum;
    sum.add(record.data(), record.size());
    benchmark::DoNotOptimize(sum.value());
  }
  state.SetBytesProcessed(state.iterations() * static_cast<std::int64_t>(record.size()));
}

BENCHMARK(copy)->Unit(benchmark::kMillisecond)->UseRealTime();
BENCHMARK(copy_kept)->Unit(benchmark::kMillisecond)->UseRealTime();
BENCHMARK(copy_fresh)->Unit(benchmark::kMillisecond)->UseRealTime();
BENCHMARK_CAPTURE(open, u8, Storage::u8)->Arg(1)->Arg(2)->Unit(benchmark::kMillisecond)->UseRealTime();
BENCHMARK_CAPTURE(open, half, Storage::half)->Arg(1)->Arg(2)->Unit(benchmark::kMillisecond)->UseRealTime();
BENCHMARK(read_rows)->Unit(benchmark::kMillisecond);
BENCHMARK(checksum);

}  // namespace
}  // namespace pelage
