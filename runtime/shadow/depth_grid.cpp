#include "pelage/shadow/depth_grid.h"

#include <tbb/blocked_range.h>
#include <tbb/parallel_for.h>

#include <algorithm>
#include <atomic>
#include <bit>
#include <cstring>
#include <limits>
#include <numeric>
#include <string>

#include "pelage/data_schema/errors.h"
#include "pelage/data_schema/numeric.h"

// Plain loops; the same arithmetic on every CPU (no contraction), so the same bits.
#define PELAGE_CLONES __attribute__((target_clones("avx512f", "avx2", "default")))

namespace pelage {
namespace {

using Shape = DepthGrid::Shape;
using Pair = std::uint32_t __attribute__((vector_size(8)));  // two neighbours along z

constexpr std::int32_t kFull = std::numeric_limits<std::int32_t>::max();
/// Cells are counted in 32 bits.
constexpr std::size_t kMostCells = std::numeric_limits<std::int32_t>::max();
/// Most quanta of one piece: a depth of 64. Float holds it exactly.
constexpr float kMostOfPiece = 1 << 30;

float held(float v, float last) noexcept {
  v = v > 0.0F ? v : 0.0F;  // NaN too
  return v < last ? v : last;
}

Pair load(const std::int32_t* at) noexcept {
  Pair p;
  std::memcpy(&p, at, sizeof p);
  return p;
}

/// Saturating, so that the sum does not depend on the order: both are in [0, kFull], and so is the result.
constexpr std::int32_t saturated(std::int32_t a, std::int32_t b) noexcept {
  const std::uint32_t sum = static_cast<std::uint32_t>(a) + static_cast<std::uint32_t>(b);
  return static_cast<std::int32_t>(std::min(sum, static_cast<std::uint32_t>(kFull)));
}

void add(std::int32_t* at, Pair amount) noexcept {
  constexpr Pair kBound{static_cast<std::uint32_t>(kFull), static_cast<std::uint32_t>(kFull)};
  const Pair sum = load(at) + amount, held = sum < kBound ? sum : kBound;
  std::memcpy(at, &held, sizeof held);
}

/// Index of each piece's first corner and its depth in quanta, spread over corners [x][y] of two along z each.
struct Corners {
  alignas(64) std::array<std::int32_t, CellBlock::kSize> first;
  alignas(64) std::array<std::array<std::int32_t, 2 * CellBlock::kSize>, 4> weights;
};

PELAGE_CLONES void spread(const PieceBlock& b, Shape s, Corners& out) noexcept {
  const auto last_x = static_cast<float>(s.x - 2), last_y = static_cast<float>(s.y - 2),
             last_z = static_cast<float>(s.z - 2);
  for (std::size_t i = 0; i < CellBlock::kSize; ++i) {
    const float x = held(b.x[i] - 0.5F, last_x), y = held(b.y[i] - 0.5F, last_y), z = held(b.z[i] - 0.5F, last_z);
    const auto ix = static_cast<std::int32_t>(x), iy = static_cast<std::int32_t>(y), iz = static_cast<std::int32_t>(z);
    const float fx = x - static_cast<float>(ix), fy = y - static_cast<float>(iy), fz = z - static_cast<float>(iz);
    const float depth = std::min(b.depth[i] * (1.0F / DepthGrid::kQuantum), kMostOfPiece);
    const auto whole = static_cast<std::int32_t>(depth + 0.5F);
    const float x1 = depth * fx, x0 = depth - x1;
    const float x1y1 = x1 * fy, x1y0 = x1 - x1y1, x0y1 = x0 * fy, x0y0 = x0 - x0y1;
    const auto w001 = static_cast<std::int32_t>(x0y0 * fz), w011 = static_cast<std::int32_t>(x0y1 * fz),
               w101 = static_cast<std::int32_t>(x1y0 * fz), w111 = static_cast<std::int32_t>(x1y1 * fz);
    const auto w010 = static_cast<std::int32_t>(x0y1 - x0y1 * fz), w100 = static_cast<std::int32_t>(x1y0 - x1y0 * fz),
               w110 = static_cast<std::int32_t>(x1y1 - x1y1 * fz);
    // The rest, so that nothing is lost to rounding; at least 0, since the others were rounded down.
    const std::int32_t rest = whole - (w001 + w011 + w101 + w111) - (w010 + w100 + w110);
    out.first[i] = (ix * s.y + iy) * s.z + iz;
    out.weights[0][2 * i] = std::max(rest, 0);
    out.weights[0][2 * i + 1] = w001;
    out.weights[1][2 * i] = w010;
    out.weights[1][2 * i + 1] = w011;
    out.weights[2][2 * i] = w100;
    out.weights[2][2 * i + 1] = w101;
    out.weights[3][2 * i] = w110;
    out.weights[3][2 * i + 1] = w111;
  }
}

PELAGE_CLONES void cells_of(const CellBlock& b, Shape s, std::size_t n, std::int32_t* __restrict first) noexcept {
  const auto last_x = static_cast<float>(s.x - 1), last_y = static_cast<float>(s.y - 1),
             last_z = static_cast<float>(s.z - 1);
  for (std::size_t i = 0; i < n; ++i) {
    const auto ix = static_cast<std::int32_t>(held(b.x[i], last_x)),
               iy = static_cast<std::int32_t>(held(b.y[i], last_y)),
               iz = static_cast<std::int32_t>(held(b.z[i], last_z));
    first[i] = (ix * s.y + iy) * s.z + iz;
  }
}

/// The four rows of two cells at a corner, long before they are needed: cells lie in L2 and L3, and a core looks ahead
/// three pieces by itself.
constexpr std::size_t kAhead = 8;
inline void fetch(const std::int32_t* p, std::int32_t row, std::int32_t slice) noexcept {
  __builtin_prefetch(p);
  __builtin_prefetch(p + row);
  __builtin_prefetch(p + slice);
  __builtin_prefetch(p + slice + row);
}

/// Every kStride-th piece, round and round: neighbours along a strand share cells, and a load that overlaps a store
/// still under way waits for it.
constexpr std::size_t kStride = 101;

PELAGE_CLONES void deposit(const Corners& corners, std::size_t count, Shape s, std::int32_t* __restrict grid) noexcept {
  const std::int32_t row = s.z, slice = s.slice();
  std::size_t i = 0;
  for (std::size_t k = 0; k < CellBlock::kSize; ++k, i = (i + kStride) % CellBlock::kSize) {
    fetch(grid + corners.first[(i + kAhead * kStride) % CellBlock::kSize], row, slice);
    if (i >= count) continue;
    std::int32_t* const p = grid + corners.first[i];
    add(p, load(&corners.weights[0][2 * i]));
    add(p + row, load(&corners.weights[1][2 * i]));
    add(p + slice, load(&corners.weights[2][2 * i]));
    add(p + slice + row, load(&corners.weights[3][2 * i]));
  }
}

PELAGE_CLONES void deposit(const PieceBlock& block, const std::int32_t* __restrict first,
                           std::int32_t* __restrict grid) noexcept {
  for (std::size_t i = 0; i < block.count; ++i) {
    __builtin_prefetch(grid + first[std::min(i + 2 * kAhead, block.count - 1)], 1);
    const float depth = std::min(block.depth[i] * (1.0F / DepthGrid::kQuantum), kMostOfPiece);
    grid[first[i]] = saturated(grid[first[i]], static_cast<std::int32_t>(depth + 0.5F));
  }
}

/// One cell: depth from the light, in place of the quanta in it.
/// @param halves  1: a cell counts half of itself, 0: all
inline float accumulated(std::int32_t own, std::int32_t& total, std::int32_t halves) noexcept {
  total = saturated(total, own);
  return DepthGrid::kQuantum * static_cast<float>(total - (own >> 1) * halves);
}

PELAGE_CLONES void accumulate_slice(std::int32_t* __restrict row, std::int32_t* __restrict total, std::size_t n,
                                    std::int32_t halves) noexcept {
  for (std::size_t i = 0; i < n; ++i) row[i] = std::bit_cast<std::int32_t>(accumulated(row[i], total[i], halves));
}

constexpr std::size_t kRun = 16;  // cells that are looked at together

/// The same with transmittance in place of depth. Most runs of a slice hold no hair: there it is what it was one slice
/// before, and the exponential is spared.
/// @param before   the slice nearer to the light, or null for the first
/// @param settled  [run] 1: `before` is exp(-total) there
PELAGE_CLONES void transmit_slice(std::int32_t* __restrict row, const std::int32_t* __restrict before,
                                  std::int32_t* __restrict total, std::size_t n, std::int32_t halves,
                                  std::uint8_t* __restrict settled) noexcept {
  const std::size_t whole = n - n % kRun;
  for (std::size_t i = 0; i < whole; i += kRun) {
    std::int32_t any = 0;
    for (std::size_t k = i; k < i + kRun; ++k) any |= row[k];
    if (any == 0 && settled[i / kRun] != 0) {
      std::memcpy(row + i, before + i, kRun * sizeof *row);
      continue;
    }
    for (std::size_t k = i; k < i + kRun; ++k)
      row[k] = std::bit_cast<std::int32_t>(exp_neg(accumulated(row[k], total[k], halves)));
    settled[i / kRun] = any == 0 || halves == 0;
  }
  for (std::size_t k = whole; k < n; ++k)
    row[k] = std::bit_cast<std::int32_t>(exp_neg(accumulated(row[k], total[k], halves)));
}

PELAGE_CLONES void merge_slice(std::int32_t* __restrict row, const std::int32_t* __restrict more,
                               std::size_t n) noexcept {
  for (std::size_t i = 0; i < n; ++i) row[i] = saturated(row[i], more[i]);
}

/// First corner and weights of points.
struct Samples {
  alignas(64) std::array<std::int32_t, CellBlock::kSize> first;
  alignas(64) std::array<float, CellBlock::kSize> fx, fy, fz;
};

PELAGE_CLONES void sample_places(const CellBlock& b, Shape s, std::size_t n, float shift_x, float shift,
                                 Samples& out) noexcept {
  const auto last_x = static_cast<float>(s.x - 1), last_y = static_cast<float>(s.y - 1),
             last_z = static_cast<float>(s.z - 1);
  for (std::size_t i = 0; i < n; ++i) {
    const float x = held(b.x[i] - shift_x, last_x), y = held(b.y[i] - shift, last_y), z = held(b.z[i] - shift, last_z);
    const std::int32_t ix = std::min(static_cast<std::int32_t>(x), s.x - 2),
                       iy = std::min(static_cast<std::int32_t>(y), s.y - 2),
                       iz = std::min(static_cast<std::int32_t>(z), s.z - 2);
    out.first[i] = (ix * s.y + iy) * s.z + iz;
    out.fx[i] = x - static_cast<float>(ix);
    out.fy[i] = y - static_cast<float>(iy);
    out.fz[i] = z - static_cast<float>(iz);
  }
}

using Four = float __attribute__((vector_size(16)));
using Halves = std::int64_t __attribute__((vector_size(16)));

/// Two neighbours along z from each of two rows.
Four load_two(const std::int32_t* a, const std::int32_t* b) noexcept {
  std::int64_t low, high;
  std::memcpy(&low, a, sizeof low);
  std::memcpy(&high, b, sizeof high);
  return std::bit_cast<Four>(Halves{low, high});
}

PELAGE_CLONES void trilinear(const std::int32_t* __restrict grid, Shape s, const Samples& at, std::size_t n,
                             float* __restrict out) noexcept {
  const std::int32_t slice = s.slice();
  for (std::size_t i = 0; i < n; ++i) {
    fetch(grid + at.first[std::min(i + 2 * kAhead, n - 1)], s.z, slice);
    const std::int32_t* const p = grid + at.first[i];
    const Four near = load_two(p, p + s.z), far = load_two(p + slice, p + slice + s.z);
    const Four v = near + at.fx[i] * (far - near);  // (y0 z0, y0 z1, y1 z0, y1 z1)
    const float z0 = v[0] + at.fy[i] * (v[2] - v[0]), z1 = v[1] + at.fy[i] * (v[3] - v[1]);
    out[i] = z0 + at.fz[i] * (z1 - z0);
  }
}

/// What lies behind the last piece blocks nothing.
void pad(PieceBlock& block) noexcept {
  std::fill(block.depth.begin() + static_cast<std::ptrdiff_t>(block.count), block.depth.end(), 0.0F);
}

}  // namespace

void DepthGrid::reset(glm::ivec3 cells, std::size_t copies) {
  const Shape shape{std::max(cells.x, 2), std::max(cells.y, 2), std::max(cells.z, 2)};
  if (shape.size() > kMostCells) {
    throw InputError("shadow", "the map has " + std::to_string(shape.x) + " x " + std::to_string(shape.y) + " x " +
                                   std::to_string(shape.z) +
                                   " cells, at most 2^31 - 1 are held: choose a lower "
                                   "resolution or fewer slices");
  }
  shape_ = shape;
  copies_.resize(std::max(copies, copies_.size()));
  tbb::parallel_for(std::size_t{0}, std::max<std::size_t>(copies, 1),
                    [&](std::size_t i) { copies_[i].assign(size(), 0); });
  for (std::size_t i = copies; i < copies_.size(); ++i) copies_[i].clear();
}

void DepthGrid::add_nearest(PieceBlock& block, std::size_t copy) noexcept {
  alignas(64) std::array<std::int32_t, CellBlock::kSize> first;
  cells_of(block, shape_, block.count, first.data());
  deposit(block, first.data(), copies_[copy].data());
}

void DepthGrid::add_trilinear(PieceBlock& block, std::size_t copy) noexcept {
  Corners corners;
  pad(block);
  spread(block, shape_, corners);
  deposit(corners, block.count, shape_, copies_[copy].data());
}

void DepthGrid::accumulate(Values values, bool transmittance) noexcept {
  values_ = values;
  const auto slice = static_cast<std::size_t>(shape_.slice());
  const std::int32_t halves = values == Values::centre ? 1 : 0;
  std::atomic<std::int64_t> all{0};  // a sum of integers: its order does not matter
  // Columns are independent: each thread takes a range of them through all slices.
  const std::size_t grain = std::max<std::size_t>(4096, slice / 8);
  tbb::parallel_for(tbb::blocked_range<std::size_t>(0, slice, grain), [&](const auto& columns) {
    std::vector<std::int32_t> total(columns.size(), 0);
    std::vector<std::uint8_t> settled(columns.size() / kRun + 1, 0);
    for (std::size_t x = 0; x < static_cast<std::size_t>(shape_.x); ++x) {
      std::int32_t* const row = copies_[0].data() + x * slice + columns.begin();
      for (std::size_t c = 1; c < copies_.size() && !copies_[c].empty(); ++c) {
        merge_slice(row, copies_[c].data() + x * slice + columns.begin(), columns.size());
      }
      if (transmittance)
        transmit_slice(row, x > 0 ? row - slice : nullptr, total.data(), columns.size(), halves, settled.data());
      else
        accumulate_slice(row, total.data(), columns.size(), halves);
    }
    all += std::accumulate(total.begin(), total.end(), std::int64_t{0});
  });
  total_ = static_cast<double>(all) * static_cast<double>(kQuantum);
}

namespace {

Samples samples_at(const CellBlock& at, std::size_t count, Shape shape, DepthGrid::Values values) noexcept {
  Samples samples;
  sample_places(at, shape, count, values == DepthGrid::Values::centre ? 0.5F : 1.0F,
                values == DepthGrid::Values::far_corner ? 1.0F : 0.5F, samples);
  return samples;
}

}  // namespace

void DepthGrid::interpolate(const CellBlock& at, std::size_t count, std::span<float> out) const noexcept {
  trilinear(copies_[0].data(), shape_, samples_at(at, count, shape_, values_), count, out.data());
}

void DepthGrid::nearest(const CellBlock& at, std::size_t count, std::span<float> out) const noexcept {
  alignas(64) std::array<std::int32_t, CellBlock::kSize> first;
  cells_of(at, shape_, count, first.data());
  for (std::size_t i = 0; i < count; ++i) {
    out[i] = std::bit_cast<float>(copies_[0][static_cast<std::size_t>(first[i])]);
  }
}

std::size_t DepthGrid::bytes() const noexcept {
  return copies_.empty() ? 0 : size() * sizeof(std::int32_t);
}

float DepthGrid::value(int x, int y, int z) const noexcept {
  return std::bit_cast<float>(copies_[0][static_cast<std::size_t>((x * shape_.y + y) * shape_.z + z)]);
}

}  // namespace pelage
