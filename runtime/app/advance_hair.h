// Hair along the motion of its head, at any frame rate.
#pragma once

#include <functional>

#include "pelage/data_schema/simulation_settings.h"
#include "pelage/simulate/moving_hair.h"

namespace pelage::app {

/// In pieces short enough for the head's path to be that of any frame rate, and for no time to be dropped.
/// @param told  after each piece    @throws Interrupted, SimulationError
void advance_hair(MovingHair& hair, const SimulationSettings& settings, double from_s, double to_s,
                  const std::function<void()>& told = {});

/// What moves, as it is in one frame.
struct MovedFrame {
  Strands lines;
  glm::dquat turn;  // of the head since rest
  Mesh head;
};

struct MovedFrames {
  std::vector<MovedFrame> frames;
  glm::dvec3 pivot;  // of the head's motion
};

/// Simulated from the scene's start, frame 0 at time 0, settled. @throws Interrupted, SimulationError
MovedFrames simulate_frames(const Strands& lines, const Mesh& head, const SimulationSettings& settings, int frames,
                            double fps, const std::string& label);

}  // namespace pelage::app
