#include "pelage/simulate/grid_nodes.h"

#include <tbb/blocked_range.h>
#include <tbb/parallel_for.h>

#include <algorithm>
#include <cmath>
#include <cstring>

#include "pelage/data_schema/numeric.h"

namespace pelage::grid {
namespace {

constexpr std::size_t kGrain = 128;  // rows at a time
constexpr std::uint32_t kValues = 4 * kRow;
/// Less hair than this at a node [m] counts as none: what a vertex next to it takes is weighted with a share as small.
constexpr float kLeastMass_m = 1e-12F;

/// What the rows are made of and where they are.
struct View {
  Box box;
  const std::uint32_t* directory;
  const std::uint32_t* keys;
  float* values;
  float* fastest_sq;
  float* fields;

  const float* values_at(std::uint32_t key) const noexcept {
    return values + std::size_t{directory[key] / kRowFloats} * kValues;
  }
};

/// Mass and momentum of rows [from, to) over all deposits, then density and velocity. The first node is also the last
/// of the row before.
PELAGE_CLONES void sum_rows(std::span<const Deposit> deposits, const View& view, float per_m3, std::size_t from,
                            std::size_t to) noexcept {
  const std::uint32_t up_x = view.box.up_x();
  for (std::size_t n = from; n < to; ++n) {
    const std::uint32_t key = view.keys[n];
    Float8 nodes[4] = {};
    for (const Deposit& d : deposits) {
      // Row 0 holds what counts nowhere.
      if (const std::uint32_t before = d.directory[key - up_x]; before != 0) {
        const float* last = d.nodes.data() + before + kNodeFloats * kRow;
        nodes[0] += Float8{last[0], last[1], last[2], last[3], 0, 0, 0, 0};
      }
      if (const std::uint32_t begin = d.directory[key]; begin != 0) {
        const float* here = d.nodes.data() + begin;
        for (int i = 0; i < 4; ++i) nodes[i] += row_of(here + 8 * i);
      }
    }
    Float8 mass, x, y, z;
    to_rows(reinterpret_cast<const float*>(nodes), mass, x, y, z);
    const auto some = mass > kLeastMass_m;
    const Float8 none = {};
    const Float8 by = some ? 1 / mass : none;
    mass = some ? mass : none;
    x *= by;
    y *= by;
    z *= by;
    float* values = view.values + (n + 1) * kValues;
    row_of(values) = mass * per_m3;
    row_of(values + kRow) = x;
    row_of(values + 2 * kRow) = y;
    row_of(values + 3 * kRow) = z;
    const Float8 speed_sq = x * x + y * y + z * z;
    float fastest = 0;
    for (int i = 0; i < kRow; ++i) fastest = speed_sq[i] > fastest ? speed_sq[i] : fastest;
    view.fastest_sq[n + 1] = fastest;
  }
}

struct Push {
  Float8 x, y, z;
};

/// sqrt(x^2 + y^2 + z^2)
PELAGE_INLINE void length_of(const Push& p, Float8& length) noexcept {
  float of[kRow];
  row_of(of) = p.x * p.x + p.y * p.y + p.z * p.z;
  for (int i = 0; i < kRow; ++i) of[i] = std::sqrt(of[i]);
  length = row_of(of);
}

/// A row's densities with one more at each end.
PELAGE_INLINE void with_ends(const View& view, std::uint32_t key, float* row) noexcept {
  const float* here = view.values_at(key);
  row[0] = view.values_at(key - view.box.up_x())[kRow - 1];
  for (int i = 0; i < kRow; ++i) row[1 + i] = here[i];
  row[1 + kRow] = view.values_at(key + view.box.up_x())[0];
}

PELAGE_INLINE void down_gradient(const Terms& t, const View& view, std::uint32_t key, Push& push) noexcept {
  const Float8 here = row_of(view.values_at(key));
  const Float8 before =
      __builtin_shufflevector(row_of(view.values_at(key - view.box.up_x())), here, 7, 8, 9, 10, 11, 12, 13, 14);
  const Float8 after =
      __builtin_shufflevector(here, row_of(view.values_at(key + view.box.up_x())), 1, 2, 3, 4, 5, 6, 7, 8);
  push.x = before - after;
  push.y = row_of(view.values_at(key - 1)) - row_of(view.values_at(key + 1));
  push.z = row_of(view.values_at(key - view.box.up_z())) - row_of(view.values_at(key + view.box.up_z()));
  Float8 length;
  length_of(push, length);
  const Float8 by = t.repulsion_m_s / (length + 2 * t.rest_density);  // both sides of the fraction times two cells
  push.x *= by;
  push.y *= by;
  push.z *= by;
}

/// Excess of the kRow + 1 cells around a row's nodes, between it and a row before or after along y, z or both.
PELAGE_INLINE void excess_of(const Terms& t, const float* a, const float* b, const float* c, const float* d,
                             float* excess) noexcept {
  const float per_density = 1 / t.rest_density;
  for (int i = 0; i <= kRow; ++i) {
    const float mean = 0.125F * (((a[i] + a[i + 1]) + (b[i] + b[i + 1])) + ((c[i] + c[i + 1]) + (d[i] + d[i + 1])));
    const float e = (mean - t.full_density) * per_density;
    excess[i] = e > 0 ? e : 0;
  }
}

PELAGE_INLINE void out_of_overfull(const Terms& t, const View& view, std::uint32_t key, Push& push) noexcept {
  float rows[3][3][kRow + 2], excess[2][2][kRow + 1];  // [z][y]
  for (std::uint32_t z = 0; z < 3; ++z)
    for (std::uint32_t y = 0; y < 3; ++y)
      with_ends(view, key + z * view.box.up_z() + y - view.box.up_z() - 1, rows[z][y]);
  for (int z = 0; z < 2; ++z)
    for (int y = 0; y < 2; ++y)
      excess_of(t, rows[z][y], rows[z][y + 1], rows[z + 1][y], rows[z + 1][y + 1], excess[z][y]);
  const auto &ll = excess[0][0], &lh = excess[0][1], &hl = excess[1][0], &hh = excess[1][1];
  for (int i = 0; i < kRow; ++i) {
    push.x[i] = ((ll[i] - ll[i + 1]) + (lh[i] - lh[i + 1])) + ((hl[i] - hl[i + 1]) + (hh[i] - hh[i + 1]));
    push.y[i] = ((ll[i] - lh[i]) + (ll[i + 1] - lh[i + 1])) + ((hl[i] - hh[i]) + (hl[i + 1] - hh[i + 1]));
    push.z[i] = ((ll[i] - hl[i]) + (ll[i + 1] - hl[i + 1])) + ((lh[i] - hh[i]) + (lh[i + 1] - hh[i + 1]));
  }
  Float8 length;
  length_of(push, length);
  const Float8 by = t.repulsion_m_s / (length + 1);
  push.x *= by;
  push.y *= by;
  push.z *= by;
}

/// Shares of the wind at a row's nodes: of its velocity, and of the mean wind with gusts.
PELAGE_INLINE void shares_of_wind(const Terms& t, const View& view, std::uint32_t key, const float* density,
                                  float* share, float* blown) noexcept {
  float x[kRow], y[kRow], z[kRow], gusts[kRow];
  const glm::ivec3 first = view.box.node(key);
  for (int i = 0; i < kRow; ++i) {
    x[i] = t.cell_m * static_cast<float>(first.x + i);
    y[i] = t.cell_m * static_cast<float>(first.y);
    z[i] = t.cell_m * static_cast<float>(first.z);
  }
  t.gusts->gusts(x, y, z, gusts, kRow);
  for (int i = 0; i < kRow; ++i) {
    share[i] = t.wind * exp_neg(t.shelter_m2 * density[i]);
    blown[i] = share[i] * (1 + t.gusts->gust() * gusts[i]);
  }
}

/// F, c of rows [from, to). A row's first node goes to the end of the row before too.
PELAGE_CLONES void act_on_rows(const Terms& t, const View& view, std::size_t from, std::size_t to) noexcept {
  const bool windy = t.wind > 0;
  const std::uint32_t up_x = view.box.up_x();
  const glm::vec3 wind = windy ? t.gusts->mean_m_s() : glm::vec3(0);
  for (std::size_t n = from; n < to; ++n) {
    const std::uint32_t key = view.keys[n];
    const float* values = view.values + (n + 1) * kValues;
    float* field = view.fields + (n + 1) * kRowFloats;
    alignas(32) float share[kRow] = {}, blown[kRow] = {};
    Push push{};
    if (t.repulsion_m_s > 0) {
      if (t.overfull)
        out_of_overfull(t, view, key, push);
      else
        down_gradient(t, view, key, push);
    }
    if (windy) shares_of_wind(t, view, key, values, share, blown);
    const Float8 none = {}, w = row_of(share), b = row_of(blown);
    const Float8 f = row_of(values) > 0 ? none + t.friction : none;
    const Float8 own = (1 - w) * f;
    to_nodes(own * row_of(values + kRow) + (b * wind.x + push.x),
             own * row_of(values + 2 * kRow) + (b * wind.y + push.y),
             own * row_of(values + 3 * kRow) + (b * wind.z + push.z), f + w - f * w, field);
    if (const std::uint32_t before = view.directory[key - up_x]; before != 0)
      std::memcpy(view.fields + before + kNodeFloats * kRow, field, kNodeFloats * sizeof(float));
    if (view.directory[key + up_x] == 0) std::memset(field + kNodeFloats * kRow, 0, kNodeFloats * sizeof(float));
  }
}

}  // namespace

/// A row that no deposit holds, but its first node got hair, as the last of the row before.
bool Nodes::goes_on(std::span<const Deposit> deposits, std::uint32_t key) const noexcept {
  return std::any_of(deposits.begin(), deposits.end(), [&](const Deposit& d) {
    return d.directory[key] != 0 && d.nodes[d.directory[key] + kNodeFloats * kRow] > 0;
  });
}

/// Rows in the order of their keys, so that neighbours lie near each other: those of the deposits, and those into which
/// one of them goes on.
void Nodes::collect_keys(std::span<const Deposit> deposits, const Box& box) {
  for (const std::uint32_t key : keys_) directory_[key] = 0;
  keys_.clear();
  ends_.clear();
  box_ = box;
  directory_.resize(directory_size(box_));
  for (std::uint32_t from = 0; from < directory_.size(); from += kDirectoryStep) {
    std::uint32_t any[kDirectoryStep] = {}, some = 0;
    for (const Deposit& d : deposits)
      for (std::uint32_t i = 0; i < kDirectoryStep; ++i) any[i] |= d.directory[from + i];
    for (std::uint32_t i = 0; i < kDirectoryStep; ++i) some |= any[i];
    if (some == 0) continue;
    for (std::uint32_t i = 0; i < kDirectoryStep; ++i)
      if (any[i] != 0) keys_.push_back(from + i);
  }
  const std::size_t found = keys_.size();
  for (std::size_t n = 0; n < found; ++n) {
    const std::uint32_t next = keys_[n] + box_.up_x();
    if (std::any_of(deposits.begin(), deposits.end(), [&](const Deposit& d) { return d.directory[next] != 0; }))
      continue;
    if (goes_on(deposits, keys_[n]))
      keys_.push_back(next);
    else
      ends_.push_back(keys_[n]);
  }
  std::inplace_merge(keys_.begin(), keys_.begin() + static_cast<std::ptrdiff_t>(found), keys_.end());
  for (std::size_t n = 0; n < keys_.size(); ++n) directory_[keys_[n]] = static_cast<std::uint32_t>(n + 1) * kRowFloats;
}

void Nodes::merge(std::span<const Deposit> deposits, const Box& box, float cell_m) {
  if (std::any_of(deposits.begin(), deposits.end(), [](const Deposit& d) { return d.grew; }) ||
      std::any_of(ends_.begin(), ends_.end(), [&](std::uint32_t key) { return goes_on(deposits, key); }))
    collect_keys(deposits, box);
  values_.resize((1 + keys_.size()) * kValues);
  fastest_sq_.resize(1 + keys_.size());
  std::fill_n(values_.begin(), kValues, 0.0F);
  const View view{box_, directory_.data(), keys_.data(), values_.data(), fastest_sq_.data(), nullptr};
  const float per_m3 = 1 / (cell_m * cell_m * cell_m);
  tbb::parallel_for(tbb::blocked_range<std::size_t>(0, keys_.size(), kGrain),
                    [&](const auto& range) { sum_rows(deposits, view, per_m3, range.begin(), range.end()); });
}

void Nodes::act(const Terms& terms) {
  fields_.resize((1 + keys_.size()) * kRowFloats);
  std::fill_n(fields_.begin(), kRowFloats, 0.0F);
  const View view{box_, directory_.data(), keys_.data(), values_.data(), fastest_sq_.data(), fields_.data()};
  tbb::parallel_for(tbb::blocked_range<std::size_t>(0, keys_.size(), kGrain),
                    [&](const auto& range) { act_on_rows(terms, view, range.begin(), range.end()); });
}

std::size_t Nodes::used_nodes() const noexcept {
  std::size_t used = 0;
  for (std::size_t n = 1; n <= keys_.size(); ++n)
    for (std::size_t i = 0; i < kRow; ++i) used += values_[n * kValues + i] > 0;
  return used;
}

float Nodes::value(int quantity, const glm::ivec3& node) const noexcept {
  const glm::ivec3 at = node - box_.low;
  if (directory_.empty() || at.x < 0 || at.y < 0 || at.z < 0 || at.x >= box_.size.x * kRow || at.y >= box_.size.y ||
      at.z >= box_.size.z)
    return 0;
  const std::uint32_t begin =
      directory_[static_cast<std::size_t>((at.z * box_.size.x + at.x / kRow) * box_.size.y + at.y)];
  return begin == 0 ? 0
                    : values_[begin / kRowFloats * kValues + static_cast<std::uint32_t>(quantity * kRow + at.x % kRow)];
}

std::size_t Nodes::bytes() const noexcept {
  return 4 * (directory_.capacity() + keys_.capacity() + ends_.capacity() + values_.capacity() +
              fastest_sq_.capacity() + fields_.capacity());
}

}  // namespace pelage::grid
