#include "pelage/app/advance_hair.h"

#include <algorithm>
#include <cmath>

#include "pelage/console/program.h"
#include "pelage/console/progress.h"
#include "pelage/simulate/head_motion.h"

namespace pelage::app {
namespace {

/// Between poses of the head, which moves evenly from one to the next.
constexpr double kLongestPiece_s = 1.0 / 60;

}  // namespace

void advance_hair(MovingHair& hair, const SimulationSettings& settings, double from_s, double to_s,
                  const std::function<void()>& told) {
  const LifeSettings& life = settings.life;
  const double longest_s = std::min(kLongestPiece_s, std::max(life.catch_up_s, life.step_s));
  const int pieces = std::max(1, static_cast<int>(std::ceil((to_s - from_s) / longest_s - 1e-6)));
  const double piece_s = (to_s - from_s) / pieces;
  for (int i = 1; i <= pieces; ++i) {
    console::throw_if_interrupted();
    const double time_s = i == pieces ? to_s : from_s + i * piece_s;
    hair.advance(piece_s, head_pose(settings.motion, hair.pivot(), time_s));
    if (told) told();
  }
}

MovedFrames simulate_frames(const Strands& lines, const Mesh& head, const SimulationSettings& settings, int frames,
                            double fps, const std::string& label) {
  MovingHair hair(lines, head, settings);
  hair.begin(head_pose(settings.motion, hair.pivot(), 0), settings.life.settle_s, console::throw_if_interrupted);
  console::Progress progress("simulating " + label, static_cast<std::uint64_t>(frames), "frames");
  MovedFrames moved{{}, hair.pivot()};
  for (int k = 0; k < frames; ++k) {
    if (k > 0) advance_hair(hair, settings, (k - 1) / fps, k / fps);
    moved.frames.push_back({hair.hair(), hair.pose().rotation, hair.head()});
    progress.update(static_cast<std::uint64_t>(k) + 1);
  }
  return moved;
}

}  // namespace pelage::app
