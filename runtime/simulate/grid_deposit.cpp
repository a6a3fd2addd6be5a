#include "pelage/simulate/grid_deposit.h"

#include <algorithm>
#include <cmath>

namespace pelage::grid {
namespace {

constexpr std::uint32_t kTile = 16;  // vertices of a block at a time: they stay in the nearest cache

/// Vertices of a block on their way to the nodes; element i * kLanes + lane.
struct alignas(64) Tile {
  Places places[kTile];
  float share[4][kTile * kLanes];         // weights of the cell's edges along x: y + 2 z
  float deposit[kTile * kLanes][8];       // what the two ends of such an edge get at weight 1
  std::uint32_t node[kTile * kLanes][4];  // where the edges begin
};

/// Mass and momentum split along x, weights along y and z. Adds up vertices and those outside of the box.
PELAGE_CLONES void prepare(const StrandBlocks& blocks, std::uint32_t block, std::uint32_t from, std::uint32_t rows,
                           float cells_per_m, const Box& box, Tile& tile, std::uint32_t& all,
                           std::uint32_t& outside) noexcept {
  const float* vertices = blocks.vertices[block].v;
  const float* segment = blocks.segment_m[block].v;
  for (std::uint32_t r = 0; r < rows; ++r) {
    const auto i = static_cast<float>(from + r);
    const std::size_t v = blocks.first[block] + from + r;
    alignas(64) std::int32_t counts[kLanes];
    for (int k = 0; k < kLanes; ++k) counts[k] = i < vertices[k];
    Places& p = tile.places[r];
    locate(blocks.root[block], blocks.position[v], counts, cells_per_m, box, p);
    for (int k = 0; k < kLanes; ++k) all += static_cast<std::uint32_t>(counts[k]);
    for (int k = 0; k < kLanes; ++k) outside += static_cast<std::uint32_t>(counts[k] & (p.key[k] == 0));
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

void make_row(std::uint32_t key, Deposit& d) {
  d.keys.push_back(key);
  const std::size_t begin = d.keys.size() * kRowFloats, end = begin + kRowFloats;
  if (d.nodes.size() < end) d.nodes.resize(end + end / 2);
  std::fill_n(d.nodes.begin() + static_cast<std::ptrdiff_t>(begin), kRowFloats, 0.0F);
  d.directory[key] = static_cast<std::uint32_t>(begin);
}

/// Rows of a tile's vertices, new ones made.
void find_rows(std::uint32_t rows, const Box& box, Deposit& d, Tile& tile) {
  const std::uint32_t* directory = d.directory.data();
  const std::uint32_t up_z = box.up_z();
  for (std::uint32_t r = 0; r < rows; ++r) {
    const Places& p = tile.places[r];
    for (std::uint32_t k = 0; k < kLanes; ++k) {
      const std::uint32_t key = p.key[k];
      const std::uint32_t* at = directory + key;
      if (((at[0] == 0) | (at[1] == 0) | (at[up_z] == 0) | (at[up_z + 1] == 0)) & (key != 0)) [[unlikely]] {
        for (const std::uint32_t row : {key, key + 1, key + up_z, key + up_z + 1})
          if (directory[row] == 0) make_row(row, d);
      }
      edges_of(directory, key, p.node[k], up_z, tile.node[r * kLanes + k]);
    }
  }
}

/// Strand after strand: neighbours along a strand lie in different cells, so a sum rarely waits for the one before it.
PELAGE_CLONES void add(const Tile& tile, std::uint32_t rows, float* nodes) noexcept {
  for (std::uint32_t k = 0; k < kLanes; ++k) {
    for (std::uint32_t r = 0; r < rows; ++r) {
      const std::uint32_t i = r * kLanes + k;
      const Float8 given = *reinterpret_cast<const Float8*>(tile.deposit[i]);
      for (int e = 0; e < 4; ++e) *reinterpret_cast<Float8*>(nodes + tile.node[i][e]) += given * tile.share[e][i];
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

void clear(const Box& box, Deposit& d) {
  for (const std::uint32_t key : d.keys) d.directory[key] = 0;
  d.keys.clear();
  d.directory.resize(directory_size(box));
  if (d.nodes.empty()) d.nodes.resize(kRowFloats);
  d.vertices = d.strays = 0;
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

void fill(const StrandBlocks& blocks, float cells_per_m, const Box& box, Deposit& d) {
  clear(box, d);
  Tile tile;
  for (std::uint32_t b = d.first_block; b < d.end_block; ++b) {
    for (std::uint32_t from = 0; from < blocks.length(b); from += kTile) {
      const std::uint32_t rows = std::min(kTile, blocks.length(b) - from);
      std::uint32_t vertices = 0, strays = 0;
      prepare(blocks, b, from, rows, cells_per_m, box, tile, vertices, strays);
      d.vertices += vertices;
      d.strays += strays;
      find_rows(rows, box, d, tile);
      add(tile, rows, d.nodes.data());
    }
  }
}

}  // namespace pelage::grid
