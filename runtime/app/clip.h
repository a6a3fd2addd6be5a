// Hair simulated frame after frame at a rate of pictures, as `simulate`, `compare` and --explain want it.
#pragma once

#include "pelage/data_schema/mesh.h"
#include "pelage/data_schema/scene.h"
#include "pelage/data_schema/strands.h"
#include "pelage/simulate/moving_hair.h"

namespace pelage::app {

/// The scene's simulation with the effects that the hair calls for. @param opacity  of a fibre
SimulationSettings planned_motion(const Scene& scene, const Strands& lines, const Mesh& head, float opacity);

class Clip {
 public:
  /// @param seconds  0: the motion's own length, or two where it has none    @throws what MovingHair throws
  Clip(const Strands& lines, const Mesh& head, const SimulationSettings& settings, double fps, double seconds);

  /// At rest in the pose of frame 0, settled. @throws Interrupted
  void begin();
  /// From the frame before to this one, which are called in order; the first does not move anything, so that gusts and
  /// moving colliders come to time 0 with it. @throws SimulationError, Interrupted
  void advance(int frame);

  int frames() const noexcept { return frames_; }
  MovingHair& hair() noexcept { return hair_; }
  const MovingHair& hair() const noexcept { return hair_; }
  /// Of the last frame [m/s].
  float fastest_m_s() const noexcept { return fastest_m_s_; }
  float fastest_root_m_s() const noexcept { return fastest_root_m_s_; }

 private:
  RigidPose pose(double time_s) const;

  SimulationSettings settings_;
  MovingHair hair_;
  double fps_;
  int frames_;
  float fastest_m_s_ = 0, fastest_root_m_s_ = 0;
};

}  // namespace pelage::app
