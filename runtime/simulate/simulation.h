// Simulation of strands on a moving head: fixed internal steps of chain_step.h and voxel_grid.h, accumulated over
// frames of any length, so that motion does not depend on the frame rate.
//
// Within a frame the head moves evenly from its last pose to the one given. What does not fill a step is kept for the
// next frame; what exceeds catch_up_s is dropped, and counted. Positions are those of hair that is up to a step old, on
// roots where they are now.
//
// Blocks of kLanes strands that have been slower than sleep_m_s for sleep_after_s sleep: they cost nothing and are
// obstacles and company for the others. They wake when the head moves, when a moving collider comes near, or when hair
// around them moves. With wind nothing sleeps.
//
// The same bits for any number of threads.
#pragma once

#include <cstdint>
#include <memory>
#include <stdexcept>
#include <string>
#include <vector>

#include "pelage/data_schema/mesh.h"
#include "pelage/data_schema/simulation_settings.h"
#include "pelage/data_schema/strands.h"
#include "pelage/simulate/rigid_pose.h"
#include "pelage/simulate/strand_blocks.h"

namespace pelage {

/// A vertex left all bounds: faster than explosion_m_s, or not finite.
class SimulationError : public std::runtime_error {
 public:
  SimulationError(std::size_t strand, std::size_t vertex, std::uint64_t frame, const std::string& what);
  std::size_t strand, vertex;
  std::uint64_t frame;  // calls of advance() so far, those before a sequence's first picture too
};

/// What happened so far.
struct SimulationFacts {
  std::uint64_t frames = 0, steps = 0;
  std::uint64_t chain_steps = 0, grid_builds = 0, grid_applies = 0;  // that were not asleep or idle
  bool moved = true;                                                 // whether the last frame changed a position
  double dropped_s = 0;                                              // time of frames longer than catch_up_s
  float fastest_m_s = 0;                                             // vertex of the last frame, kinematic, before caps
  float fastest_root_m_s = 0;                                        // of the last frame
  std::size_t asleep = 0;                                            // strands
  std::size_t bytes = 0;                                             // of state and grid
  std::size_t grid_bytes = 0;                                        // of these, the grid's; 0 where nothing needs one
  double chain_ms = 0, grid_ms = 0;                                  // of all steps so far
};

class Simulation {
 public:
  /// @param lines  centre lines of equal segments, at rest    @param head  at rest, to collide with; may be empty
  /// @throws InputError for strands, UsageError for settings out of range
  Simulation(const Strands& lines, const Mesh& head, const SimulationSettings& settings);
  ~Simulation();
  Simulation(Simulation&&) noexcept;
  Simulation& operator=(Simulation&&) noexcept;

  /// Middle of the roots at rest: what head poses turn about, and where they put it.
  const glm::dvec3& pivot() const noexcept;

  /// @param frame_s  >= 0, finite     @param head  at the end of the frame
  /// @throws SimulationError naming strand, vertex and frame; UsageError for a time or pose that is not finite
  void advance(double frame_s, const RigidPose& head);
  /// Puts head and hair there: the hair keeps its shape and its motion relative to the head.
  void teleport(const RigidPose& head);
  /// The groom's own shape, at rest, where the head is.
  void reset();
  /// Of gusts and of colliders with a velocity; 0 at first. Negative: before their positions of time 0.
  void set_time(double time_s) noexcept;

  /// World positions; `out` is laid out as the lines.
  void positions(Strands& out) const;
  /// Of all that the next step depends on; equal hashes, equal future.
  std::uint64_t state_hash() const;
  const SimulationFacts& facts() const noexcept;
  const StrandBlocks& blocks() const noexcept;

 private:
  struct State;
  std::unique_ptr<State> state_;
};

}  // namespace pelage
