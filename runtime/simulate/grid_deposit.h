// Private to this box: hair onto nodes [Almeida2014 eqs. 3.2, 3.3]. A vertex gives its mass (the length of hair it
// stands for [m]) and its mass times velocity to the eight nodes of its cell by trilinear weights.
//
// A run of blocks (Deposit) has rows of its own, so that runs fill at the same time without locks; nodes are then added
// up over the runs in their order (grid_nodes.h). What a run is depends on the strands alone, hence the same bits for
// any number of threads. Strands are sorted by their place on the head, so runs share few rows.
#pragma once

#include <cstdint>
#include <glm/vec3.hpp>
#include <vector>

#include "pelage/simulate/grid_frame.h"
#include "pelage/simulate/strand_blocks.h"

namespace pelage::grid {

struct Deposit {
  std::uint32_t first_block = 0, end_block = 0;
  glm::vec3 low{0}, high{0};             // of its vertices that are finite [cells]; low > high: none
  Directory directory;                   // over the box that fill() was given
  std::vector<std::uint32_t> keys;       // [rows] that exist; the first is nobody's
  std::vector<float> nodes;              // [1 + rows][kRow + 1][4] mass [m], mass x velocity
  std::size_t vertices = 0, strays = 0;  // strays: outside the box, or not finite
  bool grew = false;                     // rows were made by the last fill()

  std::size_t bytes() const noexcept { return 4 * (directory.capacity() + keys.capacity() + nodes.capacity()); }
};

/// Fills low and high.
void measure(const StrandBlocks& blocks, float cells_per_m, Deposit& deposit) noexcept;

/// Fills the rest. Hair moves little in a step: rows that exist stay, without hair if there is none.
/// @param fresh  the box is another, or rows that hold no hair any more are to go
void fill(const StrandBlocks& blocks, float cells_per_m, const Box& box, bool fresh, Deposit& deposit);

}  // namespace pelage::grid
