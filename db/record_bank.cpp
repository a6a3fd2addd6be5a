#include "pelage/db/record_bank.h"

#include <sys/mman.h>

#include <algorithm>
#include <bit>
#include <cmath>
#include <cstring>
#include <new>
#include <numbers>

#include "pelage/data_schema/errors.h"

namespace pelage {
namespace {

constexpr int kMaxSamples = 256;
constexpr int kNodes = kMaxSamples + 16;  // samples + 1, padded so that vector loops may run over

/// An angle along the nodes j = 0, 1, ..: (first + step j) cells of a periodic grid.
struct AngleRamp {
  float first, step;  // in cells
  int count;          // cells on the circle
  float inv_count;
};

AngleRamp ramp(float first_rad, float last_rad, int count, int samples, float offset) {
  const double cells = count / (2 * std::numbers::pi);
  const double step = (static_cast<double>(last_rad) - static_cast<double>(first_rad)) * cells / samples;
  double first = static_cast<double>(first_rad) * cells + step * (0.5 - static_cast<double>(offset));
  first -= count * std::floor(first / count);  // near 0, where float is finest
  return {static_cast<float>(first), static_cast<float>(step), count, 1.0F / static_cast<float>(count)};
}

/// Cell below a position on the circle, and how far beyond it: bilinear weights. Branch-free.
struct Cell {
  int index;
  float beyond;
};
inline Cell cell_at(const AngleRamp& r, int node) {
  const float position = r.first + r.step * static_cast<float>(node);
  const float turns = position * r.inv_count;
  int turn = static_cast<int>(turns);
  turn -= static_cast<float>(turn) > turns ? 1 : 0;
  const float inside = position - static_cast<float>(turn * r.count);
  int index = static_cast<int>(inside);
  const float beyond = inside - static_cast<float>(index);
  index = index >= r.count ? index - r.count : index;  // rounding may reach the full turn
  return {index, beyond};
}

struct Query {
  const std::uint8_t* tau;
  const std::uint8_t* re;
  AngleRamp view, light;
  int samples, lights;
  int base;        // record's sample at node 0
  float fraction;  // of the way from node x to node x + 1 where output x lies
  float tau_scale, re_scale;
};

template <class T>
inline std::int32_t load(const std::uint8_t* cells, std::int32_t index, std::size_t cell_bytes) {
  T word;
  std::memcpy(&word, cells + static_cast<std::size_t>(index) * cell_bytes, sizeof word);
  return static_cast<std::int32_t>(word);
}

/// Three passes, so that the compiler vectorises all but the loads: where, load, interpolate.
template <class CellType, bool with_re>
__attribute__((always_inline)) inline void run(const Query& q, float* tau_out, float* re_out) {
  alignas(64) std::int32_t t0[kNodes], t1[kNodes], r0[kNodes], r1[kNodes], s0[kNodes], s1[kNodes];
  alignas(64) float view_weight[kNodes], light_weight[kNodes], tau[kNodes], re[kNodes];
  const int nodes = q.samples + 1;
  const int view_stride = (q.lights + 1) * q.samples;
  for (int j = 0; j < nodes; ++j) {
    const int shifted = q.base + j;
    const int sample = shifted >= q.samples ? shifted - q.samples : shifted;
    const Cell view = cell_at(q.view, j);
    const int next = view.index + 1 >= q.view.count ? 0 : view.index + 1;
    view_weight[j] = view.beyond;
    t0[j] = view.index * q.samples + sample;
    t1[j] = next * q.samples + sample;
    if constexpr (with_re) {
      const Cell light = cell_at(q.light, j);
      light_weight[j] = light.beyond;
      const int at = light.index * q.samples + sample;
      r0[j] = view.index * view_stride + at;
      r1[j] = next * view_stride + at;
    }
  }
  for (int j = 0; j < nodes; ++j) {
    t0[j] = load<CellType>(q.tau, t0[j], sizeof(CellType));
    t1[j] = load<CellType>(q.tau, t1[j], sizeof(CellType));
    if constexpr (with_re) {
      s0[j] = load<CellType>(q.re, r0[j] + q.samples, sizeof(CellType));
      s1[j] = load<CellType>(q.re, r1[j] + q.samples, sizeof(CellType));
      r0[j] = load<CellType>(q.re, r0[j], sizeof(CellType));
      r1[j] = load<CellType>(q.re, r1[j], sizeof(CellType));
    }
  }
  for (int j = 0; j < nodes; ++j) {
    tau[j] = static_cast<float>(t0[j]) + view_weight[j] * static_cast<float>(t1[j] - t0[j]);
    if constexpr (with_re) {
      const float first = static_cast<float>(r0[j]) + light_weight[j] * static_cast<float>(s0[j] - r0[j]);
      const float second = static_cast<float>(r1[j]) + light_weight[j] * static_cast<float>(s1[j] - r1[j]);
      re[j] = first + view_weight[j] * (second - first);
    }
  }
  for (int x = 0; x < q.samples; ++x) tau_out[x] = q.tau_scale * (tau[x] + q.fraction * (tau[x + 1] - tau[x]));
  if constexpr (with_re) {
    for (int x = 0; x < q.samples; ++x) re_out[x] = q.re_scale * (re[x] + q.fraction * (re[x + 1] - re[x]));
  }
}

#define PELAGE_CLONES __attribute__((target_clones("avx512f", "avx2", "default")))
PELAGE_CLONES void run_8(const Query& q, float* tau, float* re) {
  run<std::uint8_t, true>(q, tau, re);
}
PELAGE_CLONES void run_8_tau(const Query& q, float* tau) {
  run<std::uint8_t, false>(q, tau, nullptr);
}
PELAGE_CLONES void run_16(const Query& q, float* tau, float* re) {
  run<std::uint16_t, true>(q, tau, re);
}
PELAGE_CLONES void run_16_tau(const Query& q, float* tau) {
  run<std::uint16_t, false>(q, tau, nullptr);
}

/// Halves, not negative and finite, become 16-bit cells of their largest, in place; returns the value of one step.
PELAGE_CLONES float cells_from_halves(std::uint16_t* __restrict cells, std::size_t count) {
  std::uint16_t most = 0;  // the bits of halves that are not negative order as they do
  for (std::size_t i = 0; i < count; ++i) most = cells[i] > most ? cells[i] : most;
  const float largest = float_from_half(most);
  const float gain = largest > 0 ? 65535.0F / largest : 0.0F;
  for (std::size_t i = 0; i < count; ++i) {
    const float value = std::bit_cast<float>(static_cast<std::uint32_t>(cells[i]) << 13) * 0x1p112F;  // subnormals too
    const float cell = value * gain + 0.5F;
    cells[i] = static_cast<std::uint16_t>(static_cast<std::int32_t>(cell < 65535.0F ? cell : 65535.0F));
  }
  return largest / 65535.0F;
}
#undef PELAGE_CLONES

}  // namespace

void RecordBank::Cells::allocate(std::size_t count) {
  constexpr std::size_t kHugePage = std::size_t{1} << 21;
  const std::size_t whole = (count + kHugePage - 1) / kHugePage * kHugePage;
  bytes.reset(static_cast<std::uint8_t*>(std::aligned_alloc(kHugePage, whole)));
  if (!bytes) throw std::bad_alloc();
  if (count >= kHugePage) madvise(bytes.get(), whole, MADV_HUGEPAGE);  // a wish: without it all works as well
  size = count;
}

RecordBank::RecordBank(const DatabaseReader& reader)
    : metadata_(reader.metadata()), feature_scale_(reader.feature_scale()), shape_(reader.shape()) {
  allocate(reader.metadata().sectors);
  std::vector<std::vector<glm::vec2>> crossings(size());
  reader.for_each_concurrently([&](std::uint64_t id, const SectorView& sector) {
    set(id, sector);
    crossings[id].assign(sector.crossings.begin(), sector.crossings.end());
  });
  set_crossings(crossings);
}

RecordBank::RecordBank(DatabaseMetadata metadata, FeatureScale scale, std::span<const StoredSector> sectors)
    : metadata_(std::move(metadata)), feature_scale_(std::move(scale)), shape_(record_shape(metadata_.settings)) {
  allocate(sectors.size());
  std::vector<std::vector<glm::vec2>> crossings;
  for (std::size_t i = 0; i < sectors.size(); ++i) {
    set(i, sectors[i]);
    crossings.push_back(sectors[i].crossings);
  }
  set_crossings(crossings);
}

void RecordBank::allocate(std::size_t records) {
  cell_bytes_ = bytes_per_value(metadata_.settings.storage);
  scales_.resize(records);
  features_.resize(records * static_cast<std::size_t>(dimension(metadata_.settings.features)));
  const auto row = static_cast<std::size_t>(shape_.lights) + 1;
  tau_.allocate(records * shape_.tau_size() * cell_bytes_);
  re_.allocate(records * shape_.tau_size() * row * cell_bytes_);
}

void RecordBank::set_crossings(std::span<const std::vector<glm::vec2>> of_record) {
  for (const std::vector<glm::vec2>& crossings : of_record) {
    crossings_.insert(crossings_.end(), crossings.begin(), crossings.end());
    offsets_.push_back(static_cast<std::uint32_t>(crossings_.size()));
  }
}

void RecordBank::set(std::size_t record, const SectorView& sector) {
  const auto views = static_cast<std::size_t>(shape_.views), lights = static_cast<std::size_t>(shape_.lights),
             samples = static_cast<std::size_t>(shape_.samples);
  std::copy(sector.features.begin(), sector.features.end(), &features_[record * sector.features.size()]);
  std::uint8_t* const tau = tau_.data() + record * shape_.tau_size() * cell_bytes_;
  std::uint8_t* const re = re_.data() + record * shape_.tau_size() * (lights + 1) * cell_bytes_;
  const std::size_t line = samples * cell_bytes_, view_in = lights * line, view_out = view_in + line;
  const auto spread = [&](const std::uint8_t* cells) {  // the first light again behind the last
    for (std::size_t v = 0; v < views; ++v) {
      std::memcpy(re + v * view_out, cells + v * view_in, view_in);
      std::memcpy(re + v * view_out + view_in, cells + v * view_in, line);
    }
  };
  if (metadata_.settings.storage == Storage::u8) {
    std::memcpy(tau, sector.tau.bytes.data(), sector.tau.bytes.size());
    spread(sector.re.bytes.data());
    scales_[record] = {sector.tau.scale / 255.0F, sector.re.scale / 255.0F};
    return;
  }
  thread_local std::vector<std::uint16_t> cells;
  const auto load_cells = [&](const QuantisedView& array) {
    cells.resize(array.bytes.size() / 2);
    std::memcpy(cells.data(), array.bytes.data(), cells.size() * 2);
    return array.scale * cells_from_halves(cells.data(), cells.size());
  };
  scales_[record].tau = load_cells(sector.tau);
  std::memcpy(tau, cells.data(), cells.size() * 2);
  scales_[record].re = load_cells(sector.re);
  spread(reinterpret_cast<const std::uint8_t*>(cells.data()));
}

float RecordBank::tau(std::size_t record, int view, int sample) const noexcept {
  const std::size_t cell = record * shape_.tau_size() +
                           static_cast<std::size_t>(view) * static_cast<std::size_t>(shape_.samples) +
                           static_cast<std::size_t>(sample);
  std::uint16_t value = 0;
  std::memcpy(&value, tau_.data() + cell * cell_bytes_, cell_bytes_);
  return scales_[record].tau * static_cast<float>(value);
}

void RecordBank::lookup(std::size_t record, float shift, const SatfAngles& angles, std::span<float> tau,
                        std::span<float> re) const noexcept {
  const int n = shape_.samples;
  PELAGE_ASSERT(static_cast<int>(tau.size()) >= n && (re.empty() || static_cast<int>(re.size()) >= n));
  // Output x shows the record at sample x - shift n = x + base + fraction; node j, sample j + base, lies at x = j -
  // fraction.
  const float moved = -(shift - std::floor(shift)) * static_cast<float>(n);
  const float whole = std::floor(moved);
  const float fraction = moved - whole;
  const int base = (static_cast<int>(whole) + n) % n;
  const auto row = static_cast<std::size_t>(shape_.lights) + 1;
  const Query q{tau_.data() + record * shape_.tau_size() * cell_bytes_,
                re_.data() + record * shape_.tau_size() * row * cell_bytes_,
                ramp(angles.view_first, angles.view_last, shape_.views, n, fraction),
                ramp(angles.light_first, angles.light_last, shape_.lights, n, fraction),
                n,
                shape_.lights,
                base,
                fraction,
                scales_[record].tau,
                scales_[record].re};
  if (cell_bytes_ == 1) {
    re.empty() ? run_8_tau(q, tau.data()) : run_8(q, tau.data(), re.data());
  } else {
    re.empty() ? run_16_tau(q, tau.data()) : run_16(q, tau.data(), re.data());
  }
}

}  // namespace pelage
