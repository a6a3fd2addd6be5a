// A clip of a scene's motion, simulated as finely as is worth it, and how far other settings are from it: what the
// diagram of the motion and the choice of its settings measure against.
//
// The converged run has the scene's own physics and voxels (the side of a voxel is how far hair feels hair, so it does
// not converge), every strand, the vertices of kFinestVertices or more and the finest internal step. Its own error is
// estimated from runs at twice and four times that step: distances d between them fall as step^p, so what the finest
// leaves is d / (2^p - 1).
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "pelage/app/prepare.h"
#include "pelage/data_schema/scene.h"

namespace pelage::app {

struct ClipLength {
  double fps = 30, seconds = 1;
};

/// A clip of some settings.
struct ClipRun {
  std::vector<Strands> frames;   // drawn places; frame 0 is hair at rest, settled
  std::vector<double> frame_ms;  // chains, grid and strands of each frame but the first, in which nothing moves
  double prepare_ms = 0;         // set up and settled
  std::uint64_t bytes = 0;       // of state, grid and drawn vertices
  Mesh head;                     // in the last frame

  double median_ms() const;
};

struct ClipError {
  double rms_mm = 0, p99_mm = 0, max_mm = 0;
  double end_rms_mm = 0;  // in the last frame
};

class ConvergedMotion {
 public:
  /// Runs the clip finely. @param finest  internal steps per second    @throws SimulationError, Interrupted
  ConvergedMotion(const Scene& scene, Subject subject, ClipLength length, int finest);

  /// The clip with other settings of the simulation. @throws SimulationError, Interrupted
  ClipRun run(const Scene& scene) const;
  ClipError error_of(const ClipRun& run) const;
  /// Of the converged run itself, RMS [mm].
  double own_error_mm() const noexcept { return own_error_mm_; }
  double order() const noexcept { return order_; }
  /// A sentence.
  const std::string& what() const noexcept { return what_; }
  const std::vector<Strands>& frames() const noexcept { return finest_; }
  const Subject& subject() const noexcept { return subject_; }

 private:
  Subject subject_;
  ClipLength length_;
  std::vector<Strands> finest_;  // [frame]
  double own_error_mm_ = 0, order_ = 0;
  std::string what_;
};

/// At most so many of the hair's strands, evenly spread, as much thicker as they are fewer.
Subject thinned(Subject subject, std::size_t most);
/// The clip of some settings. @throws SimulationError, Interrupted
ClipRun run_clip(const Subject& subject, const Scene& scene, ClipLength length);
/// The scene with a motion: where it has none, the built-in shake.
Scene with_motion(Scene scene);

}  // namespace pelage::app
