#include "pelage/simulate/voxel_grid.h"

#include <tbb/blocked_range.h>
#include <tbb/parallel_for.h>

#include <algorithm>
#include <cmath>
#include <glm/common.hpp>
#include <glm/geometric.hpp>
#include <string>

#include "pelage/data_schema/errors.h"

#define PELAGE_CLONES __attribute__((target_clones("avx512f", "avx2", "default")))

namespace pelage {
namespace {

using grid::Box;
using grid::Places;
using Float8 = float __attribute__((vector_size(32), aligned(4), may_alias));

constexpr std::size_t kRunVertices = 16384;  // lanes times vertices; a smaller run shares more bricks with others
constexpr std::size_t kMostRuns = 32;

/// 1 - exp(-rate h)
float share_of(float rate_per_s, double step_s) {
  return static_cast<float>(-std::expm1(-static_cast<double>(rate_per_s) * step_s));
}

/// Runs of blocks of like size: of the strands alone, whatever the number of threads.
std::vector<grid::Deposit> runs_of(const StrandBlocks& blocks) {
  const std::size_t vertices = std::size_t{blocks.first.back()} * kLanes;
  const std::size_t runs = std::clamp<std::size_t>(vertices / kRunVertices, 1, kMostRuns);
  std::vector<grid::Deposit> deposits(runs);
  std::uint32_t block = 0;
  for (std::size_t r = 0; r < runs; ++r) {
    deposits[r].first_block = block;
    while (block < blocks.count() && std::size_t{blocks.first[block]} * runs < (r + 1) * blocks.first.back()) ++block;
    deposits[r].end_block = r + 1 == runs ? static_cast<std::uint32_t>(blocks.count()) : block;
  }
  return deposits;
}

/// Brick of the median root.
glm::ivec3 middle_of(const StrandBlocks& blocks, float cells_per_m) {
  std::vector<float> at[3];
  for (std::size_t b = 0; b < blocks.count(); ++b) {
    for (std::size_t k = 0; k < kLanes; ++k) {
      const glm::vec3 p = glm::vec3(blocks.root[b].x[k], blocks.root[b].y[k], blocks.root[b].z[k]) * cells_per_m;
      if (!(blocks.vertices[b].v[k] > 0) || !(glm::dot(p, p) < grid::kFarthest * grid::kFarthest)) continue;
      for (int a = 0; a < 3; ++a) at[a].push_back(p[a]);
    }
  }
  glm::ivec3 middle(0);
  for (int a = 0; a < 3 && !at[a].empty(); ++a) {
    const auto half = at[a].begin() + static_cast<std::ptrdiff_t>(at[a].size() / 2);
    std::nth_element(at[a].begin(), half, at[a].end());
    middle[a] = static_cast<int>(std::floor(*half / static_cast<float>(grid::kEdge)));
  }
  return middle;
}

/// Bricks of all deposits, at most `most`, cut to a cube around the median root if there would be more.
Box box_of(const StrandBlocks& blocks, std::span<const grid::Deposit> deposits, float cells_per_m, std::uint32_t most) {
  glm::vec3 low(INFINITY), high(-INFINITY);
  for (const grid::Deposit& d : deposits) {
    low = glm::min(low, d.low);
    high = glm::max(high, d.high);
  }
  if (!(low.x <= high.x)) return {};
  Box box;
  box.low = glm::ivec3(glm::floor(low / static_cast<float>(grid::kEdge)));
  box.size = glm::ivec3(glm::floor(high / static_cast<float>(grid::kEdge))) - box.low + 1;
  const glm::dvec3 all(box.size + 1);
  if (all.x * all.y * all.z <= most) return box;
  const int side = static_cast<int>(std::cbrt(static_cast<double>(most))) - 1;
  const glm::ivec3 cube_low = middle_of(blocks, cells_per_m) - side / 2;
  const glm::ivec3 end = glm::min(box.low + box.size, cube_low + side);
  box.low = glm::max(box.low, cube_low);
  box.size = glm::max(end - box.low, glm::ivec3(0));
  return box;
}

/// What apply() needs of the grid.
struct View {
  float cells_per_m;
  Box box;
  const std::uint32_t* directory;
  const float* fields;
};

/// Vertices 1.. of a block take  v' = (1 - c) v + F. A vertex without a brick finds brick 0, where both are 0.
/// @return whether there was one
PELAGE_CLONES bool take(StrandBlocks& blocks, std::size_t block, const View& view) noexcept {
  constexpr std::size_t kY = grid::kNodeFloats * grid::kSide, kZ = kY * grid::kSide;
  const float* vertices = blocks.vertices[block].v;
  std::int32_t lost = 0;
  for (std::uint32_t i = 1; i < blocks.length(block); ++i) {
    const std::size_t v = blocks.first[block] + i;
    Places p;
    alignas(64) std::int32_t counts[kLanes];
    alignas(64) float share[4][kLanes], found[kLanes][8];
    alignas(64) std::uint32_t node[kLanes];
    for (int k = 0; k < kLanes; ++k) counts[k] = static_cast<float>(i) < vertices[k];
    grid::locate(blocks.root[block], blocks.position[v], counts, view.cells_per_m, view.box, p);
    for (int k = 0; k < kLanes; ++k) {
      share[0][k] = (1 - p.fy[k]) * (1 - p.fz[k]);
      share[1][k] = p.fy[k] * (1 - p.fz[k]);
      share[2][k] = (1 - p.fy[k]) * p.fz[k];
      share[3][k] = p.fy[k] * p.fz[k];
    }
    for (int k = 0; k < kLanes; ++k) node[k] = view.directory[p.key[k]];
    for (int k = 0; k < kLanes; ++k) lost |= (node[k] == 0) & counts[k];
    for (int k = 0; k < kLanes; ++k) node[k] = node[k] * grid::kNodes + p.node[k];
    for (int k = 0; k < kLanes; ++k) {
      const float* corner = view.fields + grid::kNodeFloats * node[k];
      const Float8& a = *reinterpret_cast<const Float8*>(corner);
      const Float8& b = *reinterpret_cast<const Float8*>(corner + kY);
      const Float8& c = *reinterpret_cast<const Float8*>(corner + kZ);
      const Float8& d = *reinterpret_cast<const Float8*>(corner + kZ + kY);
      *reinterpret_cast<Float8*>(found[k]) = (a * share[0][k] + b * share[1][k]) + (c * share[2][k] + d * share[3][k]);
    }
    Lanes3& velocity = blocks.velocity[v];
    for (int k = 0; k < kLanes; ++k) {
      const float far = p.fx[k], near = 1 - far;
      const float x = near * found[k][0] + far * found[k][4];
      const float y = near * found[k][1] + far * found[k][5];
      const float z = near * found[k][2] + far * found[k][6];
      const float keep = 1 - (near * found[k][3] + far * found[k][7]);
      velocity.x[k] = counts[k] ? keep * velocity.x[k] + x : velocity.x[k];
      velocity.y[k] = counts[k] ? keep * velocity.y[k] + y : velocity.y[k];
      velocity.z[k] = counts[k] ? keep * velocity.z[k] + z : velocity.z[k];
    }
  }
  return lost != 0;
}

/// Wind on vertices 1.. of a block that nothing shelters: all of them, or those without a brick.
void blow(StrandBlocks& blocks, std::size_t block, const Wind& wind, float share, const View* only_outside) noexcept {
  const float* vertices = blocks.vertices[block].v;
  const Lanes3& root = blocks.root[block];
  for (std::uint32_t i = 1; i < blocks.length(block); ++i) {
    const std::size_t v = blocks.first[block] + i;
    const Lanes3& position = blocks.position[v];
    alignas(64) std::int32_t counts[kLanes];
    for (int k = 0; k < kLanes; ++k) counts[k] = static_cast<float>(i) < vertices[k];
    if (only_outside != nullptr) {
      Places p;
      grid::locate(root, position, counts, only_outside->cells_per_m, only_outside->box, p);
      for (int k = 0; k < kLanes; ++k) counts[k] &= only_outside->directory[p.key[k]] == 0;
    }
    alignas(64) float gusts[kLanes];
    Lanes3 at;
    for (int k = 0; k < kLanes; ++k) {
      at.x[k] = root.x[k] + position.x[k];
      at.y[k] = root.y[k] + position.y[k];
      at.z[k] = root.z[k] + position.z[k];
      const bool far = !(at.x[k] * at.x[k] + at.y[k] * at.y[k] + at.z[k] * at.z[k] < 1e8F);
      if (far) at.x[k] = at.y[k] = at.z[k] = 0;  // a phase with no digits left, or not finite: any will do
    }
    wind.gusts(at.x, at.y, at.z, gusts, kLanes);
    Lanes3& velocity = blocks.velocity[v];
    const glm::vec3 mean = wind.mean_m_s();
    for (int k = 0; k < kLanes; ++k) {
      const float w = counts[k] ? share : 0, blown = w * (1 + wind.gust() * gusts[k]);
      velocity.x[k] = (1 - w) * velocity.x[k] + blown * mean.x;
      velocity.y[k] = (1 - w) * velocity.y[k] + blown * mean.y;
      velocity.z[k] = (1 - w) * velocity.z[k] + blown * mean.z;
    }
  }
}

bool asleep(const GridStep& step, std::size_t block) noexcept {
  return !step.awake.empty() && step.awake[block] == 0;
}

}  // namespace

VoxelGrid::VoxelGrid(const InteractionSettings& interaction, const WindSettings& wind)
    : interaction_(interaction),
      drag_per_s_(wind.drag_per_s),
      shelter_(wind.shelter),
      cells_per_m_(1 / interaction.cell_m),
      wind_(wind) {
  if (!(interaction.cell_m > 0) || !std::isfinite(interaction.cell_m) || !std::isfinite(cells_per_m_))
    throw UsageError("interaction.cell_m is " + std::to_string(interaction.cell_m) +
                     ": give a length above 0 in metres");
}

void VoxelGrid::deposit(const StrandBlocks& blocks) {
  if (deposits_.empty() || deposits_.back().end_block != blocks.count()) deposits_ = runs_of(blocks);
  tbb::parallel_for(std::size_t{0}, deposits_.size(),
                    [&](std::size_t d) { grid::measure(blocks, cells_per_m_, deposits_[d]); });
  const Box box = box_of(blocks, deposits_, cells_per_m_, kMostBricks);
  tbb::parallel_for(std::size_t{0}, deposits_.size(),
                    [&](std::size_t d) { grid::fill(blocks, cells_per_m_, box, deposits_[d]); });
  nodes_.merge(deposits_, {box.low, box.count() > 0 ? box.size + 1 : box.size}, interaction_.cell_m);
}

void VoxelGrid::set_rest_density(const StrandBlocks& blocks) {
  deposit(blocks);
  std::vector<float> found;
  for (std::size_t b = 0; b < blocks.count(); ++b) {
    for (std::uint32_t v = blocks.first[b]; v < blocks.first[b + 1]; ++v) {
      for (std::size_t k = 0; k < kLanes; ++k) {
        if (!(static_cast<float>(v - blocks.first[b]) < blocks.vertices[b].v[k])) continue;
        const Lanes3 &root = blocks.root[b], &p = blocks.position[v];
        found.push_back(density({root.x[k] + p.x[k], root.y[k] + p.y[k], root.z[k] + p.z[k]}));
      }
    }
  }
  const auto half = found.begin() + static_cast<std::ptrdiff_t>(found.size() / 2);
  if (!found.empty()) std::nth_element(found.begin(), half, found.end());
  // No hair at all: any density will do, but for 0.
  rest_density_ = !found.empty() && *half > 0 ? *half : 1;
}

void VoxelGrid::build(const StrandBlocks& blocks, const GridStep& step) {
  if (!needs_grid()) return;
  if (!(rest_density_ > 0)) set_rest_density(blocks);
  deposit(blocks);
  Wind wind = wind_;
  wind.set(step.time_s, step.pivot);
  grid::Terms terms;
  terms.cell_m = interaction_.cell_m;
  terms.friction = share_of(interaction_.friction_per_s, step.step_s);
  terms.wind = wind.still() ? 0 : share_of(drag_per_s_, step.step_s);
  terms.shelter_m2 = shelter_ / rest_density_;
  terms.repulsion_m_s = interaction_.repulsion_m_s2 * static_cast<float>(step.step_s);
  terms.overfull = interaction_.repulsion == RepulsionKind::overfull;
  terms.rest_density = rest_density_;
  terms.full_density = interaction_.overfull * rest_density_;
  terms.gusts = &wind;
  nodes_.act(terms);
}

void VoxelGrid::apply(StrandBlocks& blocks, const GridStep& step) const {
  if (idle()) return;
  Wind wind = wind_;
  wind.set(step.time_s, step.pivot);
  const float free_share = wind.still() ? 0 : share_of(drag_per_s_, step.step_s);
  const View view{cells_per_m_, nodes_.box(), nodes_.directory().data(), nodes_.fields()};
  const bool grid = needs_grid();
  tbb::parallel_for(tbb::blocked_range<std::size_t>(0, blocks.count(), 8), [&](const auto& range) {
    for (std::size_t b = range.begin(); b < range.end(); ++b) {
      if (asleep(step, b)) continue;
      const bool outside = grid && take(blocks, b, view);
      if (free_share > 0 && (!grid || outside)) blow(blocks, b, wind, free_share, grid ? &view : nullptr);
    }
  });
}

void VoxelGrid::wake(const StrandBlocks& blocks, const GridStep& step, std::span<std::uint8_t> stirred,
                     float wake_m_s) const {
  if (!needs_grid()) return;
  const Box& box = nodes_.box();
  tbb::parallel_for(tbb::blocked_range<std::size_t>(0, blocks.count(), 8), [&](const auto& range) {
    for (std::size_t b = range.begin(); b < range.end(); ++b) {
      if (!asleep(step, b)) continue;
      for (std::uint32_t v = blocks.first[b]; v < blocks.first[b + 1] && stirred[b] == 0; ++v) {
        alignas(64) std::int32_t counts[kLanes];
        const auto i = static_cast<float>(v - blocks.first[b]);
        for (int k = 0; k < kLanes; ++k) counts[k] = i < blocks.vertices[b].v[k];
        Places p;
        grid::locate(blocks.root[b], blocks.position[v], counts, cells_per_m_, box, p);
        for (const std::uint32_t key : p.key) {
          const std::uint32_t brick = nodes_.directory()[key];
          if (brick != 0 && nodes_.fastest_sq(brick) > wake_m_s * wake_m_s) stirred[b] = 1;
        }
      }
    }
  });
}

float VoxelGrid::interpolate(int quantity, const glm::vec3& p) const noexcept {
  const glm::vec3 u = p * cells_per_m_;
  if (!(glm::dot(u, u) < grid::kFarthest * grid::kFarthest)) return 0;
  const glm::vec3 low = glm::floor(u), f = u - low;
  float sum = 0;
  for (int c = 0; c < 8; ++c) {
    const glm::ivec3 d(c & 1, c >> 1 & 1, c >> 2);
    const float weight = (d.x ? f.x : 1 - f.x) * (d.y ? f.y : 1 - f.y) * (d.z ? f.z : 1 - f.z);
    sum += weight * nodes_.value(quantity, glm::ivec3(low) + d);
  }
  return sum;
}

float VoxelGrid::density(const glm::vec3& p) const noexcept {
  return interpolate(0, p);
}

glm::vec3 VoxelGrid::velocity(const glm::vec3& p) const noexcept {
  return {interpolate(1, p), interpolate(2, p), interpolate(3, p)};
}

std::size_t VoxelGrid::strays() const noexcept {
  std::size_t sum = 0;
  for (const grid::Deposit& d : deposits_) sum += d.strays;
  return sum;
}

std::size_t VoxelGrid::bytes() const noexcept {
  std::size_t sum = nodes_.bytes();
  for (const grid::Deposit& d : deposits_) sum += d.bytes();
  return sum;
}

}  // namespace pelage
