// Voxel grid of hair: density and velocity of the strands around a place, and what they do to a vertex: friction,
// repulsion, shelter from the wind. [Almeida2014 section 3.2, eqs. 3.2-3.5; Petrovic2005; Mueller2012]
// Formulas: grid_nodes.h. Sparse: only rows of 8 nodes that hair is at exist (grid_frame.h). The same bits for any
// number of threads and on any CPU (grid_deposit.h).
//
// A vertex farther from all other hair than the directory of kMostRows reaches (3.2 m at cells of 1 cm, a third of a
// metre at 1 mm, centred on the median root) is a stray: it has no neighbours; only the wind blows on it.
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "pelage/data_schema/simulation_settings.h"
#include "pelage/simulate/grid_deposit.h"
#include "pelage/simulate/grid_nodes.h"
#include "pelage/simulate/strand_blocks.h"
#include "pelage/simulate/wind.h"

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
  static constexpr std::uint32_t kMostRows = 1U << 22;  // of a directory: 16 MiB, once and per run of strands

  /// @throws UsageError for a cell that is not finite and above 0
  VoxelGrid(const InteractionSettings& interaction, const WindSettings& wind);

  /// Density that counts as ordinary: the median of what vertices find at rest [m of hair per m^3]. Else the first
  /// build() does it.
  void set_rest_density(const StrandBlocks& blocks);
  float rest_density() const noexcept { return rest_density_; }

  /// Neither friction, repulsion nor wind: build() and apply() return at once.
  bool idle() const noexcept { return !interacts() && wind_.still(); }

  /// Wind that nothing shelters from needs none.
  bool needs_grid() const noexcept { return interacts() || (!wind_.still() && shelter_ > 0); }

  /// Eqs. 3.2, 3.3 of all blocks; every vertex carries the length of its segments.
  /// @throws InputError when more than 1 % of the vertices (and 16) are strays or not finite
  void build(const StrandBlocks& blocks, const GridStep& step);

  /// Friction, repulsion and wind on the kinematic velocities of vertices 1.. of the blocks that are awake, which are
  /// where they were when build() saw them. Without needs_grid(), build() does nothing.
  void apply(StrandBlocks& blocks, const GridStep& step) const;

  /// After build(): sets stirred[block] = 1 for the blocks asleep (step.awake) that have a vertex at a row of nodes
  /// where hair moves, on the mean of a node, faster than this.
  void wake(const StrandBlocks& blocks, const GridStep& step, std::span<std::uint8_t> stirred, float wake_m_s) const;

  /// Of the last build, at a point of the grid frame [m].
  float density(const glm::vec3& p) const noexcept;
  glm::vec3 velocity(const glm::vec3& p) const noexcept;
  std::size_t rows() const noexcept { return nodes_.rows(); }
  std::size_t used_nodes() const noexcept { return nodes_.used_nodes(); }
  std::size_t strays() const noexcept;
  std::size_t bytes() const noexcept;

 private:
  bool interacts() const noexcept { return interaction_.friction_per_s > 0 || interaction_.repulsion_m_s2 > 0; }
  void deposit(const StrandBlocks& blocks);
  bool place_box(const StrandBlocks& blocks);
  void check_strays() const;
  bool moves_near(std::uint32_t key, float least_m_s) const noexcept;
  float interpolate(int quantity, const glm::vec3& p) const noexcept;

  InteractionSettings interaction_;
  float drag_per_s_, shelter_;
  float cells_per_m_;
  float rest_density_ = 0;  // 0: not known yet
  Wind wind_;
  grid::Box box_;
  int age_ = 0;                       // steps since the box was chosen
  std::vector<std::uint32_t> first_;  // of the blocks that the deposits were made for
  std::vector<grid::Deposit> deposits_;
  grid::Nodes nodes_;
};

}  // namespace pelage
