#include "pelage/simulate/grid_deposit.h"

#include <algorithm>
#include <cmath>
#include <cstring>
#include <glm/common.hpp>

#define PELAGE_CLONES __attribute__((target_clones("avx512f", "avx2", "default")))

namespace pelage::grid {
namespace {

using Float8 = float __attribute__((vector_size(32), aligned(4), may_alias));
constexpr int kRows = 16;  // vertices of a block at a time: the tile stays in the nearest cache

/// Vertices of a block on their way to the nodes; element i * kLanes + lane.
struct alignas(64) Tile {
  Places places[kRows];
  float share[4][kRows * kLanes];      // weights of the cell's edges along x: y + 2 z
  float deposit[kRows * kLanes][8];    // what the two ends of such an edge get at weight 1
  std::uint32_t node[kRows * kLanes];  // in the deposit
};

/// Mass and momentum split along x, weights along y and z.
PELAGE_CLONES void prepare(const StrandBlocks& blocks, std::uint32_t block, std::uint32_t from, std::uint32_t rows,
                           float cells_per_m, const Box& box, Tile& tile) noexcept {
  const float* vertices = blocks.vertices[block].v;
  const float* segment = blocks.segment_m[block].v;
  for (std::uint32_t r = 0; r < rows; ++r) {
    const auto i = static_cast<float>(from + r);
    const std::size_t v = blocks.first[block] + from + r;
    alignas(64) std::int32_t counts[kLanes];
    for (int k = 0; k < kLanes; ++k) counts[k] = i < vertices[k];
    Places& p = tile.places[r];
    locate(blocks.root[block], blocks.position[v], counts, cells_per_m, box, p);
    const Lanes3& velocity = blocks.velocity[v];
    float* deposit = tile.deposit[r * kLanes];
    for (int k = 0; k < kLanes; ++k) {
      const float ends = (i > 0 ? 0.5F : 0.0F) + (i < vertices[k] - 1 ? 0.5F : 0.0F);
      const float mass = segment[k] * ends;
      const float far_mass = mass * p.fx[k], near_mass = mass * (1 - p.fx[k]);
      deposit[8 * k + 0] = near_mass;
      deposit[8 * k + 1] = near_mass * velocity.x[k];
      deposit[8 * k + 2] = near_mass * velocity.y[k];
      deposit[8 * k + 3] = near_mass * velocity.z[k];
      deposit[8 * k + 4] = far_mass;
      deposit[8 * k + 5] = far_mass * velocity.x[k];
      deposit[8 * k + 6] = far_mass * velocity.y[k];
      deposit[8 * k + 7] = far_mass * velocity.z[k];
    }
    for (int k = 0; k < kLanes; ++k) {
      const float fy = p.fy[k], fz = p.fz[k];
      tile.share[0][r * kLanes + static_cast<std::uint32_t>(k)] = (1 - fy) * (1 - fz);
      tile.share[1][r * kLanes + static_cast<std::uint32_t>(k)] = fy * (1 - fz);
      tile.share[2][r * kLanes + static_cast<std::uint32_t>(k)] = (1 - fy) * fz;
      tile.share[3][r * kLanes + static_cast<std::uint32_t>(k)] = fy * fz;
    }
  }
}

/// Bricks of a tile's vertices, new ones made.
void find_bricks(std::uint32_t rows, const float* vertices, std::uint32_t from, Deposit& d, Tile& tile) {
  const std::uint32_t none = d.box.count();
  for (std::uint32_t r = 0; r < rows; ++r) {
    const Places& p = tile.places[r];
    for (std::uint32_t k = 0; k < kLanes; ++k) {
      std::uint32_t brick = d.directory[p.key[k]];
      if (brick == 0) [[unlikely]] {
        if (p.key[k] != none) {
          d.keys.push_back(p.key[k]);
          brick = static_cast<std::uint32_t>(d.keys.size());
          d.directory[p.key[k]] = brick;
          d.nodes.resize(d.nodes.size() + kBrickFloats);
        } else if (static_cast<float>(from + r) < vertices[k]) {
          ++d.strays;
        }
      }
      tile.node[r * kLanes + k] = brick * kNodes + p.node[k];
    }
  }
}

/// Strand after strand: neighbours along a strand lie in different cells, so a sum rarely waits for the one before it.
PELAGE_CLONES void add(const Tile& tile, std::uint32_t rows, float* nodes) noexcept {
  constexpr std::size_t kY = kNodeFloats * kSide, kZ = kY * kSide;
  for (std::uint32_t k = 0; k < kLanes; ++k) {
    for (std::uint32_t r = 0; r < rows; ++r) {
      const std::uint32_t e = r * kLanes + k;
      const Float8 given = *reinterpret_cast<const Float8*>(tile.deposit[e]);
      float* corner = nodes + kNodeFloats * tile.node[e];
      auto& a = *reinterpret_cast<Float8*>(corner);
      a += given * tile.share[0][e];
      auto& b = *reinterpret_cast<Float8*>(corner + kY);
      b += given * tile.share[1][e];
      auto& c = *reinterpret_cast<Float8*>(corner + kZ);
      c += given * tile.share[2][e];
      auto& e4 = *reinterpret_cast<Float8*>(corner + kZ + kY);
      e4 += given * tile.share[3][e];
    }
  }
}

PELAGE_CLONES void widen(const StrandBlocks& blocks, std::uint32_t block, float cells_per_m, Lanes3& low,
                         Lanes3& high) noexcept {
  const Lanes3& root = blocks.root[block];
  const float* vertices = blocks.vertices[block].v;
  for (std::uint32_t v = blocks.first[block]; v < blocks.first[block + 1]; ++v) {
    const Lanes3& p = blocks.position[v];
    for (int k = 0; k < kLanes; ++k) {
      const float x = (root.x[k] + p.x[k]) * cells_per_m, y = (root.y[k] + p.y[k]) * cells_per_m,
                  z = (root.z[k] + p.z[k]) * cells_per_m;
      const bool counts = (vertices[k] > 0) & (x * x < kFarthest * kFarthest) & (y * y < kFarthest * kFarthest) &
                          (z * z < kFarthest * kFarthest);
      low.x[k] = counts & (x < low.x[k]) ? x : low.x[k];
      low.y[k] = counts & (y < low.y[k]) ? y : low.y[k];
      low.z[k] = counts & (z < low.z[k]) ? z : low.z[k];
      high.x[k] = counts & (x > high.x[k]) ? x : high.x[k];
      high.y[k] = counts & (y > high.y[k]) ? y : high.y[k];
      high.z[k] = counts & (z > high.z[k]) ? z : high.z[k];
    }
  }
}

/// Its directory covers what its vertices take up of the grid's box. What it had is forgotten.
void set_box(const Box& within, Deposit& d) {
  for (const std::uint32_t key : d.keys) d.directory[key] = 0;
  d.keys.clear();
  d.strays = 0;
  d.box = {};
  if (d.low.x <= d.high.x) {
    const glm::ivec3 low = glm::max(glm::ivec3(glm::floor(d.low / static_cast<float>(kEdge))), within.low);
    const glm::ivec3 high =
        glm::min(glm::ivec3(glm::floor(d.high / static_cast<float>(kEdge))), within.low + within.size - 1);
    d.box = {low, glm::max(high - low + 1, glm::ivec3(0))};
  }
  d.directory.resize(d.box.count() + 1);
  d.nodes.resize(kBrickFloats);
}

}  // namespace

void measure(const StrandBlocks& blocks, float cells_per_m, Deposit& d) noexcept {
  Lanes3 low, high;
  std::fill_n(low.x, 3 * kLanes, INFINITY);
  std::fill_n(high.x, 3 * kLanes, -INFINITY);
  for (std::uint32_t b = d.first_block; b < d.end_block; ++b) widen(blocks, b, cells_per_m, low, high);
  d.low = {*std::min_element(low.x, low.x + kLanes), *std::min_element(low.y, low.y + kLanes),
           *std::min_element(low.z, low.z + kLanes)};
  d.high = {*std::max_element(high.x, high.x + kLanes), *std::max_element(high.y, high.y + kLanes),
            *std::max_element(high.z, high.z + kLanes)};
}

void fill(const StrandBlocks& blocks, float cells_per_m, const Box& within, Deposit& d) {
  set_box(within, d);
  Tile tile;
  for (std::uint32_t b = d.first_block; b < d.end_block; ++b) {
    for (std::uint32_t from = 0; from < blocks.length(b); from += kRows) {
      const std::uint32_t rows = std::min<std::uint32_t>(kRows, blocks.length(b) - from);
      prepare(blocks, b, from, rows, cells_per_m, d.box, tile);
      find_bricks(rows, blocks.vertices[b].v, from, d, tile);
      add(tile, rows, d.nodes.data());
    }
  }
}

}  // namespace pelage::grid
