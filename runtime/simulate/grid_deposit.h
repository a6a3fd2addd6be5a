// Private to this box: hair onto nodes [Almeida2014 eqs. 3.2, 3.3]. A vertex gives its mass (the length of hair it
// stands for [m]) and its mass times velocity to the eight nodes of its cell by trilinear weights.
//
// A run of blocks (Deposit) has bricks of its own, so that runs fill at the same time without locks; nodes are then
// added up over the runs in their order (grid_nodes.h). What a run is depends on the strands alone, hence the same bits
// for any number of threads. Strands are sorted by their place on the head, so runs share few bricks.
#pragma once

#include <cstdint>
#include <glm/vec3.hpp>
#include <vector>

#include "pelage/simulate/grid_frame.h"
#include "pelage/simulate/strand_blocks.h"

namespace pelage::grid {

/// 4 floats of a node: mass [m], mass x velocity [m m/s]; later the velocity that a vertex gets and its share.
inline constexpr std::size_t kNodeFloats = 4;
inline constexpr std::size_t kBrickFloats = kNodeFloats * kNodes;

struct Deposit {
  std::uint32_t first_block = 0, end_block = 0;
  glm::vec3 low{0}, high{0};             // of its vertices that are finite [cells]; low > high: none
  Box box;                               // that its directory covers
  std::vector<std::uint32_t> directory;  // [box.count() + 1] 1-based number of a brick; 0: none; the last stays 0
  std::vector<std::uint32_t> keys;       // [bricks] of the bricks that exist, in the order of their first vertex
  std::vector<float> nodes;              // [1 + bricks][kNodes][4]; brick 0 takes what counts nowhere
  std::uint64_t strays = 0;              // vertices outside the box, or not finite

  const float* brick(std::size_t number) const noexcept { return nodes.data() + number * kBrickFloats; }
  std::size_t bytes() const noexcept { return 4 * (directory.capacity() + keys.capacity() + nodes.capacity()); }
};

/// Fills low and high.
void measure(const StrandBlocks& blocks, float cells_per_m, Deposit& deposit) noexcept;

/// Fills the rest. @param within  its vertices outside of this are strays
void fill(const StrandBlocks& blocks, float cells_per_m, const Box& within, Deposit& deposit);

}  // namespace pelage::grid
