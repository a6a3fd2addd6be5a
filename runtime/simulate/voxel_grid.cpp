#include "pelage/simulate/voxel_grid.h"

#include <tbb/blocked_range.h>
#include <tbb/parallel_for.h>

#include <algorithm>
#include <cmath>
#include <glm/common.hpp>
#include <glm/geometric.hpp>
#include <string>

#include "pelage/data_schema/errors.h"

namespace pelage {
namespace {

using grid::Box;
using grid::Float8;
using grid::Places;
using Int8 = std::int32_t __attribute__((vector_size(32), aligned(4), may_alias));
using grid::Float4;

constexpr std::size_t kRunVertices = 32768;  // lanes times vertices; smaller runs share more rows with others
constexpr std::size_t kMostRuns = 16;
constexpr int kSlackCells = 2;        // around the hair, so that its box need not change with every step
constexpr int kKeptSteps = 64;        // then rows that hair has left go
constexpr double kMostStrays = 0.01;  // of the vertices

/// 1 - exp(-rate h)
float share_of(float rate_per_s, double step_s) {
  return static_cast<float>(-std::expm1(-static_cast<double>(rate_per_s) * step_s));
}

/// Runs of blocks of like size: of the strands alone, whatever the number of threads.
std::vector<grid::Deposit> runs_of(const StrandBlocks& blocks) {
  const std::size_t vertices = std::size_t{blocks.first.back()} * kLanes;
  // Even, so that two threads have as much to do.
  const std::size_t runs =
      vertices < kRunVertices / 2 ? 1 : std::clamp<std::size_t>(vertices / (2 * kRunVertices), 1, kMostRuns / 2) * 2;
  std::vector<grid::Deposit> deposits(runs);
  std::uint32_t block = 0;
  for (std::size_t r = 0; r < runs; ++r) {
    deposits[r].first_block = block;
    while (block < blocks.count() && std::size_t{blocks.first[block]} * runs < (r + 1) * blocks.first.back()) ++block;
    deposits[r].end_block = r + 1 == runs ? static_cast<std::uint32_t>(blocks.count()) : block;
  }
  return deposits;
}

/// Cell of the median root.
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
    middle[a] = static_cast<int>(std::floor(*half));
  }
  return middle;
}

/// Rows for cells from low to high and the margin that grid_frame.h asks for.
Box box_around(const glm::ivec3& low, const glm::ivec3& high) noexcept {
  constexpr int kRow = grid::kRow;
  Box box;
  box.low = glm::ivec3((low.x >= 0 ? low.x / kRow : -((kRow - 1 - low.x) / kRow)) * kRow - kRow, low.y - 1, low.z - 1);
  box.size = glm::ivec3((high.x - box.low.x) / kRow + 3, high.y - box.low.y + 3, high.z - box.low.z + 3);
  return box;
}

bool holds(const Box& box, const Box& other) noexcept {
  for (int a = 0; a < 3; ++a) {
    const int per = a == 0 ? grid::kRow : 1;
    if (other.low[a] < box.low[a] || other.low[a] + other.size[a] * per > box.low[a] + box.size[a] * per) return false;
  }
  return true;
}

/// Rows for all deposits, at most `most`: a cube around the median root if there would be more.
Box box_of(const StrandBlocks& blocks, std::span<const grid::Deposit> deposits, float cells_per_m, std::uint32_t most,
           int slack) {
  glm::vec3 low(INFINITY), high(-INFINITY);
  for (const grid::Deposit& d : deposits) {
    low = glm::min(low, d.low);
    high = glm::max(high, d.high);
  }
  if (!(low.x <= high.x)) return {};
  const glm::ivec3 from = glm::ivec3(glm::floor(low)) - slack, to = glm::ivec3(glm::floor(high)) + slack;
  const Box box = box_around(from, to);
  const glm::dvec3 size(box.size);
  if (size.x * size.y * size.z <= most) return box;
  const int half = static_cast<int>(std::cbrt(static_cast<double>(most) * grid::kRow)) / 2 - 2 * grid::kRow;
  const glm::ivec3 middle = middle_of(blocks, cells_per_m);
  return box_around(glm::max(from, middle - half),
                    glm::max(glm::min(to, middle + half), glm::max(from, middle - half)));
}

/// What apply() needs of the grid.
struct View {
  float cells_per_m;
  Box box;
  const std::uint32_t* directory;
  const float* fields;
};

/// Vertices 1.. of a block take  v' = (1 - c) v + F. A vertex outside finds row 0, where both are 0.
/// @return whether there was one
PELAGE_CLONES bool take(StrandBlocks& blocks, std::size_t block, const View& view) noexcept {
  const std::uint32_t up_z = view.box.up_z();
  const float* vertices = blocks.vertices[block].v;
  std::int32_t lost = 0;
  for (std::uint32_t i = 1; i < blocks.length(block); ++i) {
    const std::size_t v = blocks.first[block] + i;
    Places p;
    alignas(64) std::int32_t counts[kLanes];
    alignas(64) float share[4][kLanes], found[kLanes][4];
    for (int k = 0; k < kLanes; ++k) counts[k] = static_cast<float>(i) < vertices[k];
    grid::locate(blocks.root[block], blocks.position[v], counts, view.cells_per_m, view.box, p);
    for (int k = 0; k < kLanes; ++k) {
      share[0][k] = (1 - p.fy[k]) * (1 - p.fz[k]);
      share[1][k] = p.fy[k] * (1 - p.fz[k]);
      share[2][k] = (1 - p.fy[k]) * p.fz[k];
      share[3][k] = p.fy[k] * p.fz[k];
    }
    for (int k = 0; k < kLanes; ++k) lost |= (p.key[k] == 0) & counts[k];
    for (int k = 0; k < kLanes; ++k) {
      std::uint32_t edges[4];
      grid::edges_of(view.directory, p.key[k], p.node[k], up_z, edges);
      const Float8& a = *reinterpret_cast<const Float8*>(view.fields + edges[0]);
      const Float8& b = *reinterpret_cast<const Float8*>(view.fields + edges[1]);
      const Float8& c = *reinterpret_cast<const Float8*>(view.fields + edges[2]);
      const Float8& d = *reinterpret_cast<const Float8*>(view.fields + edges[3]);
      const Float8 ends = (a * share[0][k] + b * share[1][k]) + (c * share[2][k] + d * share[3][k]);
      const Float4 near = __builtin_shufflevector(ends, ends, 0, 1, 2, 3);
      const Float4 far = __builtin_shufflevector(ends, ends, 4, 5, 6, 7);
      *reinterpret_cast<Float4*>(found[k]) = near * (1 - p.fx[k]) + far * p.fx[k];
    }
    Lanes3& velocity = blocks.velocity[v];
    for (int h = 0; h < kLanes; h += 8) {
      Float8 x, y, z, taken;
      grid::to_rows(found[h], x, y, z, taken);
      const auto here = *reinterpret_cast<const Int8*>(counts + h) != 0;
      Float8& vx = grid::row_of(velocity.x + h);
      Float8& vy = grid::row_of(velocity.y + h);
      Float8& vz = grid::row_of(velocity.z + h);
      const Float8 keep = 1 - taken;
      vx = here ? keep * vx + x : vx;
      vy = here ? keep * vy + y : vy;
      vz = here ? keep * vz + z : vz;
    }
  }
  return lost != 0;
}

/// Wind on vertices 1.. of a block that nothing shelters: all of them, or those outside.
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
      for (int k = 0; k < kLanes; ++k) counts[k] &= p.key[k] == 0;
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
  if (deposits_.empty() || blocks.first != first_) {
    deposits_ = runs_of(blocks);
    first_ = blocks.first;
  }
  tbb::parallel_for(std::size_t{0}, deposits_.size(),
                    [&](std::size_t d) { grid::measure(blocks, cells_per_m_, deposits_[d]); });
  const bool fresh = place_box(blocks);
  tbb::parallel_for(std::size_t{0}, deposits_.size(),
                    [&](std::size_t d) { grid::fill(blocks, cells_per_m_, box_, fresh, deposits_[d]); });
  check_strays();
  nodes_.merge(deposits_, box_, interaction_.cell_m);
}

/// Keeps the box while the hair is inside and does not leave most of it, for kKeptSteps at most.
/// @return whether it is another
bool VoxelGrid::place_box(const StrandBlocks& blocks) {
  const Box tight = box_of(blocks, deposits_, cells_per_m_, kMostRows, 0);
  const bool inside = holds(box_, tight);
  if (inside && box_.count() <= 4 * tight.count() && !deposits_[0].keys.empty() && ++age_ < kKeptSteps) return false;
  age_ = 0;
  box_ = box_of(blocks, deposits_, cells_per_m_, kMostRows, kSlackCells);
  return true;
}

void VoxelGrid::check_strays() const {
  std::size_t vertices = 0;
  for (const grid::Deposit& d : deposits_) vertices += d.vertices;
  const std::size_t outside = strays();
  if (outside <= 16 || static_cast<double>(outside) <= kMostStrays * static_cast<double>(vertices)) return;
  throw InputError(
      "interaction.cell_m " + std::to_string(interaction_.cell_m),
      std::to_string(outside) + " of " + std::to_string(vertices) +
          " vertices lie outside of what a grid of such cells can cover, or are not finite: choose a larger "
          "cell, or leave out the strands that are far from the others");
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

bool VoxelGrid::moves_near(std::uint32_t key, float least_m_s) const noexcept {
  const std::uint32_t up_z = nodes_.box().up_z();
  for (const std::uint32_t row : {key, key + 1, key + up_z, key + up_z + 1}) {
    const std::uint32_t begin = nodes_.directory()[row];
    if (begin != 0 && nodes_.fastest_sq(begin) > least_m_s * least_m_s) return true;
  }
  return false;
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
        for (const std::uint32_t key : p.key) stirred[b] |= moves_near(key, wake_m_s);
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
