#include "pelage/simulate/grid_deposit.h"

#include <algorithm>
#include <bit>
#include <cmath>
#include <numeric>

namespace pelage::grid {
namespace {

constexpr std::uint32_t kTile = 16;  // vertices of a block at a time: they stay in the nearest cache

/// Vertices of a block on their way to the nodes; element i * kLanes + lane.
struct alignas(64) Tile {
  std::uint32_t key[kTile * kLanes], node[kTile * kLanes];  // as in Places
  std::uint32_t edges[kTile * kLanes][4];                   // floats at which the cell's edges along x begin: y + 2 z
  float share[4][kTile * kLanes];                           // weights of these edges
  float far[kTile * kLanes];                                // weight of their far ends
  float deposit[kTile * kLanes][4];                         // mass, mass x velocity
};

/// Fills the tile. @return bit i: a vertex of row i of the tile needs rows of nodes that do not exist yet
PELAGE_CLONES std::uint32_t prepare(const StrandBlocks& blocks, std::uint32_t block, std::uint32_t from,
                                    std::uint32_t rows, float cells_per_m, const Box& box,
                                    const std::uint32_t* directory, Tile& tile, std::uint32_t* outside) noexcept {
  const float* vertices = blocks.vertices[block].v;
  const float* segment = blocks.segment_m[block].v;
  const std::uint32_t up_z = box.up_z();
  std::uint32_t missing = 0;
  for (std::uint32_t r = 0; r < rows; ++r) {
    const auto i = static_cast<float>(from + r);
    const std::size_t v = blocks.first[block] + from + r;
    const std::uint32_t first = r * kLanes;
    alignas(64) std::int32_t counts[kLanes];
    for (int k = 0; k < kLanes; ++k) counts[k] = i < vertices[k];
    Places p;
    locate(blocks.root[block], blocks.position[v], counts, cells_per_m, box, p);
    for (std::uint32_t k = 0; k < kLanes; ++k) edges_of(directory, p.key[k], p.node[k], up_z, tile.edges[first + k]);
    std::uint32_t absent = 0;
    const std::uint32_t* edges = tile.edges[first];
    for (int k = 0; k < 4 * kLanes; ++k) absent |= static_cast<std::uint32_t>(edges[k] < kRowFloats);
    missing |= absent << r;
    const Lanes3& velocity = blocks.velocity[v];
    alignas(64) float mass[kLanes], x[kLanes], y[kLanes], z[kLanes];
    // Loops apart: what is written may not be what another reads, or the compiler gives up.
    for (int k = 0; k < kLanes; ++k) outside[k] += static_cast<std::uint32_t>(counts[k] & (p.key[k] == 0));
    for (int k = 0; k < kLanes; ++k) {
      const float ends = (i > 0 ? 0.5F : 0.0F) + (i < vertices[k] - 1 ? 0.5F : 0.0F);
      mass[k] = segment[k] * ends;
      x[k] = mass[k] * velocity.x[k];
      y[k] = mass[k] * velocity.y[k];
      z[k] = mass[k] * velocity.z[k];
    }
    for (std::uint32_t k = 0; k < kLanes; ++k) {
      const float fy = p.fy[k], fz = p.fz[k];
      tile.share[0][first + k] = (1 - fy) * (1 - fz);
      tile.share[1][first + k] = fy * (1 - fz);
      tile.share[2][first + k] = (1 - fy) * fz;
      tile.share[3][first + k] = fy * fz;
    }
    std::memcpy(tile.far + first, p.fx, sizeof p.fx);
    std::memcpy(tile.key + first, p.key, sizeof p.key);
    std::memcpy(tile.node + first, p.node, sizeof p.node);
    for (int h = 0; h < kLanes; h += 8)
      to_nodes(row_of(mass + h), row_of(x + h), row_of(y + h), row_of(z + h), tile.deposit[first] + 4 * h);
  }
  return missing;
}

void make_row(std::uint32_t key, Deposit& d) {
  d.keys.push_back(key);
  const std::size_t begin = d.keys.size() * kRowFloats, end = begin + kRowFloats;
  if (d.nodes.size() < end) d.nodes.resize(end + end / 2);
  std::fill_n(d.nodes.begin() + static_cast<std::ptrdiff_t>(begin), kRowFloats, 0.0F);
  d.directory[key] = static_cast<std::uint32_t>(begin);
}

/// Rows of nodes that a row of the tile lacks.
void make_rows(std::uint32_t first, const Box& box, Deposit& d, Tile& tile) {
  const std::uint32_t up_z = box.up_z();
  for (std::uint32_t i = first; i < first + kLanes; ++i) {
    const std::uint32_t key = tile.key[i];
    for (const std::uint32_t row : {key, key + 1, key + up_z, key + up_z + 1})
      if (d.directory[row] == 0) make_row(row, d);
    d.grew = true;
    edges_of(d.directory.data(), key, tile.node[i], up_z, tile.edges[i]);
  }
}

/// Strand after strand: neighbours along a strand lie in different cells, so a sum rarely waits for the one before it.
PELAGE_CLONES void add(const Tile& tile, std::uint32_t rows, float* nodes) noexcept {
  const Float8 near = {1, 1, 1, 1, 0, 0, 0, 0}, to_far = {-1, -1, -1, -1, 1, 1, 1, 1};
  for (std::uint32_t k = 0; k < kLanes; ++k) {
    for (std::uint32_t r = 0; r < rows; ++r) {
      const std::uint32_t i = r * kLanes + k;
      const Float4 vertex = *reinterpret_cast<const Float4*>(tile.deposit[i]);
      const Float8 given =
          __builtin_shufflevector(vertex, vertex, 0, 1, 2, 3, 0, 1, 2, 3) * (near + to_far * tile.far[i]);
      for (int e = 0; e < 4; ++e) *reinterpret_cast<Float8*>(nodes + tile.edges[i][e]) += given * tile.share[e][i];
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

/// No hair at its rows; no rows when it begins afresh.
void clear(const Box& box, bool fresh, Deposit& d) {
  if (fresh) {
    for (const std::uint32_t key : d.keys) d.directory[key] = 0;
    d.keys.clear();
    d.directory.resize(directory_size(box));
    make_row(0, d);
  }
  std::fill_n(d.nodes.begin(), (1 + d.keys.size()) * kRowFloats, 0.0F);
  d.vertices = d.strays = 0;
  d.grew = fresh;
}

/// What is outside goes to nobody's row while the deposit fills, so that "0: does not exist" has no exception.
void set_nobodys(std::uint32_t begin, const Box& box, Deposit& d) {
  for (const std::uint32_t key : {0U, 1U, box.up_z(), box.up_z() + 1}) d.directory[key] = begin;
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

void fill(const StrandBlocks& blocks, float cells_per_m, const Box& box, bool fresh, Deposit& d) {
  clear(box, fresh, d);
  set_nobodys(kRowFloats, box, d);
  Tile tile;
  std::uint32_t outside[kLanes] = {};
  for (std::uint32_t b = d.first_block; b < d.end_block; ++b) {
    for (const float n : blocks.vertices[b].v) d.vertices += static_cast<std::size_t>(n);
    for (std::uint32_t from = 0; from < blocks.length(b); from += kTile) {
      const std::uint32_t rows = std::min(kTile, blocks.length(b) - from);
      std::uint32_t missing = prepare(blocks, b, from, rows, cells_per_m, box, d.directory.data(), tile, outside);
      for (; missing != 0; missing &= missing - 1)
        make_rows(static_cast<std::uint32_t>(std::countr_zero(missing)) * kLanes, box, d, tile);
      add(tile, rows, d.nodes.data());
    }
  }
  set_nobodys(0, box, d);
  d.strays = std::accumulate(outside, outside + kLanes, std::size_t{0});
}

}  // namespace pelage::grid
