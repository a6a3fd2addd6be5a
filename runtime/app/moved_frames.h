// Every frame of a sequence at once, for those who draw the same motion more than once.
#pragma once

#include <string>
#include <vector>

#include "pelage/app/clip.h"

namespace pelage::app {

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
