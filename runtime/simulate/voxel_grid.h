// Voxel grid of hair: density and velocity of the strands around a place, and what they do to a vertex: friction,
// repulsion, shelter from the wind. [Almeida2014 section 3.2, eqs. 3.2-3.5; Petrovic2005; Mueller2012]
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>

#include "pelage/data_schema/simulation_settings.h"
#include "pelage/simulate/strand_blocks.h"

namespace pelage {

/// What a step of the grid depends on besides the strands.
struct GridStep {
  double step_s = 1.0 / 480;
  double time_s = 0;                    // of the wind's gusts
  glm::dvec3 pivot{0};                  // origin of the grid frame in the world: gusts stand in the world
  std::span<const std::uint8_t> awake;  // [blocks] 0: asleep: counts, but is not changed; empty: all awake
};

class VoxelGrid {
 public:
  VoxelGrid(const InteractionSettings& interaction, const WindSettings& wind);

  /// Density that counts as ordinary: the median of what vertices find at rest [m of hair per m^3].
  void set_rest_density(const StrandBlocks& blocks);

  /// Eqs. 3.2, 3.3 of all blocks; every vertex carries the length of its segments.
  void build(const StrandBlocks& blocks, const GridStep& step);

  /// Friction, repulsion and wind on the kinematic velocities of vertices 1.. of the blocks that are awake.
  void apply(StrandBlocks& blocks, const GridStep& step) const;
};

}  // namespace pelage
