#include "pelage/simulate/grid_nodes.h"

#include <tbb/blocked_range.h>
#include <tbb/parallel_for.h>

#include <algorithm>
#include <cmath>
#include <cstring>

#include "pelage/data_schema/numeric.h"

#define PELAGE_CLONES __attribute__((target_clones("avx512f", "avx2", "default")))

namespace pelage::grid {
namespace {

constexpr int kRing = kEdge + 2;  // nodes along a brick's edge with those before and after
constexpr int kRingNodes = kRing * kRing * kRing;
constexpr std::size_t kGrain = 16;  // bricks at a time
/// Less hair than this at a node [m] counts as none: what a vertex next to it takes is weighted with a share as small.
constexpr float kLeastMass_m = 1e-12F;

constexpr int own(int x, int y, int z) noexcept {
  return (z * kEdge + y) * kEdge + x;
}
constexpr std::size_t node(int x, int y, int z) noexcept {
  return static_cast<std::size_t>((z * kSide + y) * kSide + x);
}

/// Adds a deposit's brick that lies d bricks (0 or 1 per axis) before, as far as it holds this brick's own nodes.
void add_region(const float* brick, const glm::ivec3& d, float* sums) noexcept {
  const int to_z = d.z ? 1 : kEdge, to_y = d.y ? 1 : kEdge;
  const std::size_t floats = kNodeFloats * static_cast<std::size_t>(d.x ? 1 : kEdge);
  for (int z = 0; z < to_z; ++z) {
    for (int y = 0; y < to_y; ++y) {
      const float* from = brick + kNodeFloats * node(d.x * kEdge, y + d.y * kEdge, z + d.z * kEdge);
      float* to = sums + kNodeFloats * static_cast<std::size_t>(own(0, y, z));
      if (floats == kNodeFloats * kEdge)
        for (std::size_t i = 0; i < kNodeFloats * kEdge; ++i) to[i] += from[i];
      else
        for (std::size_t i = 0; i < kNodeFloats; ++i) to[i] += from[i];
    }
  }
}

/// Mass and momentum to density and velocity. @return the greatest speed squared
PELAGE_CLONES float to_values(const float* sums, float per_m3, float* values) noexcept {
  float* velocity[3] = {values + kOwn, values + 2 * kOwn, values + 3 * kOwn};
  alignas(64) float speed_sq[kOwn];
  for (int i = 0; i < kOwn; ++i) {
    const float mass = sums[4 * i];
    const bool some = mass > kLeastMass_m;
    const float by = 1 / (some ? mass : 1.0F);
    const float x = some ? sums[4 * i + 1] * by : 0, y = some ? sums[4 * i + 2] * by : 0,
                z = some ? sums[4 * i + 3] * by : 0;
    values[i] = some ? mass * per_m3 : 0;
    velocity[0][i] = x;
    velocity[1][i] = y;
    velocity[2][i] = z;
    speed_sq[i] = x * x + y * y + z * z;
  }
  float fastest = 0;
  for (int i = 0; i < kOwn; ++i) fastest = speed_sq[i] > fastest ? speed_sq[i] : fastest;
  return fastest;
}

struct alignas(64) Push {
  float x[kOwn], y[kOwn], z[kOwn];
};

PELAGE_CLONES void down_gradient(const Terms& t, const float* ring, Push& push) noexcept {
  for (int z = 0; z < kEdge; ++z) {
    for (int y = 0; y < kEdge; ++y) {
      const float* at = ring + ((z + 1) * kRing + y + 1) * kRing + 1;
      for (int x = 0; x < kEdge; ++x) {
        push.x[own(x, y, z)] = at[x - 1] - at[x + 1];
        push.y[own(x, y, z)] = at[x - kRing] - at[x + kRing];
        push.z[own(x, y, z)] = at[x - kRing * kRing] - at[x + kRing * kRing];
      }
    }
  }
  const float flat = 2 * t.rest_density;  // both sides times 2 cells
  for (int i = 0; i < kOwn; ++i) {
    const float by =
        t.repulsion_m_s / (std::sqrt(push.x[i] * push.x[i] + push.y[i] * push.y[i] + push.z[i] * push.z[i]) + flat);
    push.x[i] *= by;
    push.y[i] *= by;
    push.z[i] *= by;
  }
}

PELAGE_CLONES void out_of_overfull(const Terms& t, const float* ring, Push& push) noexcept {
  float excess[kSide * kSide * kSide];
  const float per_density = 1 / t.rest_density;
  for (int z = 0; z < kSide; ++z) {
    for (int y = 0; y < kSide; ++y) {
      const float* at = ring + (z * kRing + y) * kRing;
      for (int x = 0; x < kSide; ++x) {
        const float* a = at + x;
        const float* b = a + kRing * kRing;
        const float mean =
            0.125F * (((a[0] + a[1]) + (a[kRing] + a[kRing + 1])) + ((b[0] + b[1]) + (b[kRing] + b[kRing + 1])));
        const float e = (mean - t.full_density) * per_density;
        excess[(z * kSide + y) * kSide + x] = e > 0 ? e : 0;
      }
    }
  }
  for (int z = 0; z < kEdge; ++z) {
    for (int y = 0; y < kEdge; ++y) {
      for (int x = 0; x < kEdge; ++x) {
        const float* a = excess + (z * kSide + y) * kSide + x;
        const float* b = a + kSide * kSide;
        const int i = own(x, y, z);
        push.x[i] = ((a[0] - a[1]) + (a[kSide] - a[kSide + 1])) + ((b[0] - b[1]) + (b[kSide] - b[kSide + 1]));
        push.y[i] = ((a[0] - a[kSide]) + (a[1] - a[kSide + 1])) + ((b[0] - b[kSide]) + (b[1] - b[kSide + 1]));
        push.z[i] = ((a[0] - b[0]) + (a[1] - b[1])) + ((a[kSide] - b[kSide]) + (a[kSide + 1] - b[kSide + 1]));
      }
    }
  }
  for (int i = 0; i < kOwn; ++i) {
    const float length = std::sqrt(push.x[i] * push.x[i] + push.y[i] * push.y[i] + push.z[i] * push.z[i]);
    const float by = t.repulsion_m_s / (length + 1);
    push.x[i] *= by;
    push.y[i] *= by;
    push.z[i] *= by;
  }
}

/// F, c of a brick's own nodes. @param gusts  g of the wind there
PELAGE_CLONES void to_field(const Terms& t, const float* values, const Push& push, const float* gusts, glm::vec3 wind,
                            float gust, float* field) noexcept {
  const float* velocity[3] = {values + kOwn, values + 2 * kOwn, values + 3 * kOwn};
  for (int i = 0; i < kOwn; ++i) {
    const float f = values[i] > 0 ? t.friction : 0;
    const float w = t.wind * exp_neg(t.shelter_m2 * values[i]);
    const float own_share = (1 - w) * f, wind_share = w * (1 + gust * gusts[i]);
    field[4 * i] = own_share * velocity[0][i] + (wind_share * wind.x + push.x[i]);
    field[4 * i + 1] = own_share * velocity[1][i] + (wind_share * wind.y + push.y[i]);
    field[4 * i + 2] = own_share * velocity[2][i] + (wind_share * wind.z + push.z[i]);
    field[4 * i + 3] = f + w - f * w;
  }
}

void gusts_at(const Terms& t, const glm::ivec3& brick, float* gusts) noexcept {
  float x[kOwn], y[kOwn], z[kOwn];
  for (int i = 0; i < kOwn; ++i) {
    x[i] = t.cell_m * static_cast<float>(brick.x * kEdge + i % kEdge);
    y[i] = t.cell_m * static_cast<float>(brick.y * kEdge + i / kEdge % kEdge);
    z[i] = t.cell_m * static_cast<float>(brick.z * kEdge + i / (kEdge * kEdge));
  }
  t.gusts->gusts(x, y, z, gusts, kOwn);
}

}  // namespace

std::uint32_t Nodes::add_brick(std::uint32_t key) {
  keys_.push_back(key);
  return directory_[key] = static_cast<std::uint32_t>(keys_.size());
}

/// Bricks that hold vertices in the order in which the deposits found them, then those that only hold far nodes.
void Nodes::number_bricks(std::span<const Deposit> deposits, const Box& box) {
  for (const std::uint32_t key : keys_) directory_[key] = 0;
  keys_.clear();
  box_ = box;
  directory_.resize(box_.count() + 1);
  first_copy_.assign(1, 0);
  for (const Deposit& d : deposits) {
    for (const std::uint32_t key : d.keys) {
      const std::uint32_t at = box_.key(d.box.brick(key));
      std::uint32_t number = directory_[at];
      if (number == 0) {
        number = add_brick(at);
        first_copy_.push_back(0);
      }
      ++first_copy_[number];
    }
  }
  vertex_bricks_ = keys_.size();
  for (std::size_t n = 1; n < first_copy_.size(); ++n) first_copy_[n] += first_copy_[n - 1];
  copies_.resize(first_copy_.back());
  for (std::size_t d = deposits.size(); d-- > 0;) {  // backwards: filled from the ends, which become the beginnings
    for (std::size_t k = deposits[d].keys.size(); k-- > 0;) {
      const std::uint32_t number = directory_[box_.key(deposits[d].box.brick(deposits[d].keys[k]))];
      copies_[--first_copy_[number]] = {static_cast<std::uint32_t>(d), static_cast<std::uint32_t>(k + 1)};
    }
  }
  // Entry n is now where brick n begins; brick numbers start at 1.
  first_copy_.erase(first_copy_.begin());
  first_copy_.push_back(static_cast<std::uint32_t>(copies_.size()));
  for (std::size_t n = 0; n < vertex_bricks_; ++n) {
    const glm::ivec3 brick = box_.brick(keys_[n]);
    for (int d = 1; d < 8; ++d) {
      const std::uint32_t key = box_.key(brick + glm::ivec3(d & 1, d >> 1 & 1, d >> 2));
      if (directory_[key] == 0) add_brick(key);
    }
  }
}

void Nodes::sum(std::span<const Deposit> deposits, std::uint32_t number, float cell_m) noexcept {
  alignas(64) float sums[kNodeFloats * kOwn] = {};
  const glm::ivec3 brick = box_.brick(keys_[number - 1]);
  for (int d = 7; d >= 0; --d) {
    const glm::ivec3 before(d & 1, d >> 1 & 1, d >> 2);
    const std::uint32_t from = number_of(brick - before);
    if (from == 0 || from > vertex_bricks_) continue;
    for (std::uint32_t c = first_copy_[from - 1]; c < first_copy_[from]; ++c)
      add_region(deposits[copies_[c].deposit].brick(copies_[c].number), before, sums);
  }
  fastest_sq_[number - 1] =
      to_values(sums, 1 / (cell_m * cell_m * cell_m), values_.data() + std::size_t{4 * kOwn} * (number - 1));
}

void Nodes::merge(std::span<const Deposit> deposits, const Box& box, float cell_m) {
  number_bricks(deposits, box);
  values_.resize(keys_.size() * 4 * kOwn);
  fastest_sq_.resize(keys_.size());
  tbb::parallel_for(tbb::blocked_range<std::size_t>(0, keys_.size(), kGrain), [&](const auto& range) {
    for (std::size_t n = range.begin(); n < range.end(); ++n) sum(deposits, static_cast<std::uint32_t>(n + 1), cell_m);
  });
}

/// Densities of a brick's own nodes and those around it; what no brick holds is 0.
void Nodes::collect_ring(const glm::ivec3& brick, bool corners, float* ring) const noexcept {
  std::fill_n(ring, kRingNodes, 0.0F);
  for (int z = -1; z <= 1; ++z) {
    for (int y = -1; y <= 1; ++y) {
      for (int x = -1; x <= 1; ++x) {
        if (!corners && x * x + y * y + z * z > 1) continue;
        const std::uint32_t number = number_of(brick + glm::ivec3(x, y, z));
        if (number == 0) continue;
        const float* from = values_.data() + std::size_t{4 * kOwn} * (number - 1);
        const auto first = [](int d) { return d < 0 ? kEdge - 1 : 0; };
        const auto end = [](int d) { return d > 0 ? 1 : kEdge; };
        for (int k = first(z); k < end(z); ++k)
          for (int j = first(y); j < end(y); ++j)
            for (int i = first(x); i < end(x); ++i)
              ring[((k + 1 + z * kEdge) * kRing + j + 1 + y * kEdge) * kRing + i + 1 + x * kEdge] = from[own(i, j, k)];
      }
    }
  }
}

/// A brick's own nodes go to itself and to the aprons of the seven bricks before it.
void Nodes::hand_out(const glm::ivec3& brick, const float* field) noexcept {
  for (int d = 0; d < 8; ++d) {
    const glm::ivec3 before(d & 1, d >> 1 & 1, d >> 2);
    const std::uint32_t to = number_of(brick - before);
    if (to == 0 || to > vertex_bricks_) continue;
    float* out = fields_.data() + to * kBrickFloats;
    const int end_z = before.z ? 1 : kEdge, end_y = before.y ? 1 : kEdge;
    const std::size_t floats = kNodeFloats * static_cast<std::size_t>(before.x ? 1 : kEdge);
    for (int z = 0; z < end_z; ++z)
      for (int y = 0; y < end_y; ++y)
        std::memcpy(out + kNodeFloats * node(before.x * kEdge, y + before.y * kEdge, z + before.z * kEdge),
                    field + kNodeFloats * static_cast<std::size_t>(own(0, y, z)), floats * sizeof(float));
  }
}

void Nodes::act_on(const Terms& t, std::uint32_t number) noexcept {
  const glm::ivec3 brick = box_.brick(keys_[number - 1]);
  alignas(64) float gusts[kOwn] = {}, field[kNodeFloats * kOwn];
  Push push{};
  if (t.repulsion_m_s > 0) {
    float ring[kRingNodes];
    collect_ring(brick, t.overfull, ring);
    if (t.overfull)
      out_of_overfull(t, ring, push);
    else
      down_gradient(t, ring, push);
  }
  const bool blown = t.gusts != nullptr && t.wind > 0;
  if (blown && t.gusts->gust() > 0) gusts_at(t, brick, gusts);
  to_field(t, values_.data() + std::size_t{4 * kOwn} * (number - 1), push, gusts,
           blown ? t.gusts->mean_m_s() : glm::vec3(0), blown ? t.gusts->gust() : 0, field);
  hand_out(brick, field);
}

void Nodes::act(const Terms& terms) {
  fields_.resize((1 + vertex_bricks_) * kBrickFloats);
  std::fill_n(fields_.begin(), kBrickFloats, 0.0F);
  tbb::parallel_for(tbb::blocked_range<std::size_t>(0, keys_.size(), kGrain), [&](const auto& range) {
    for (std::size_t n = range.begin(); n < range.end(); ++n) act_on(terms, static_cast<std::uint32_t>(n + 1));
  });
}

std::size_t Nodes::used_nodes() const noexcept {
  std::size_t used = 0;
  for (std::size_t n = 0; n < keys_.size(); ++n)
    used += static_cast<std::size_t>(std::count_if(values_.begin() + static_cast<std::ptrdiff_t>(n * 4 * kOwn),
                                                   values_.begin() + static_cast<std::ptrdiff_t>(n * 4 * kOwn + kOwn),
                                                   [](float density) { return density > 0; }));
  return used;
}

float Nodes::value(int quantity, const glm::ivec3& at) const noexcept {
  const glm::ivec3 brick(at.x >= 0 ? at.x / kEdge : -((kEdge - 1 - at.x) / kEdge),
                         at.y >= 0 ? at.y / kEdge : -((kEdge - 1 - at.y) / kEdge),
                         at.z >= 0 ? at.z / kEdge : -((kEdge - 1 - at.z) / kEdge));
  const std::uint32_t number = number_of(brick);
  if (number == 0) return 0;
  const glm::ivec3 l = at - brick * kEdge;
  return values_[(std::size_t{4} * (number - 1) + static_cast<std::size_t>(quantity)) * kOwn +
                 static_cast<std::size_t>(own(l.x, l.y, l.z))];
}

std::size_t Nodes::bytes() const noexcept {
  return 4 * (directory_.capacity() + keys_.capacity() + first_copy_.capacity() + 2 * copies_.capacity() +
              values_.capacity() + fastest_sq_.capacity() + fields_.capacity());
}

}  // namespace pelage::grid
