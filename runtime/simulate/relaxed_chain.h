// Private to this box: frame of the comparison solvers. All vertices are predicted, the solver moves them until
// segments have their lengths (more or less), cone and collisions turn what is left, and velocity is what happened.
#pragma once

#include <vector>

#include "pelage/simulate/chain_kernels.h"

namespace pelage {

/// Positions of a block's vertices while they are being solved for, and its segments' lengths.
struct RelaxedChain {
  ChainBlock block;
  std::vector<Lanes3> at;       // [length] relative to the roots
  std::vector<Lanes> segments;  // [length] that end at each vertex [m]; 0 beyond a strand's own vertices
  std::vector<Lanes> weights;   // [length] inverse masses: 0 for what is pinned, else 1
};

RelaxedChain begin_relaxed(StrandBlocks& s, std::size_t block, const ChainStep& step);
/// @return greatest squared speed
float finish_relaxed(StrandBlocks& s, std::size_t block, const ChainStep& step, RelaxedChain& chain);

}  // namespace pelage
