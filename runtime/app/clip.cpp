#include "pelage/app/clip.h"

#include <algorithm>
#include <cmath>

#include "pelage/console/program.h"
#include "pelage/effects/plan.h"
#include "pelage/simulate/head_motion.h"

namespace pelage::app {
namespace {

/// Longest that a motion without an end of its own is shown [s].
constexpr double kStillSeconds = 2;
/// Between poses of the head, which moves evenly from one to the next.
constexpr double kLongestPiece_s = 1.0 / 60;

}  // namespace

SimulationSettings planned_motion(const Scene& scene, const Strands& lines, const Mesh& head, float opacity) {
  return plan_effects(scene, {&lines, nullptr, &head, opacity}, Task::motion).scene.simulation;
}

Clip::Clip(const Strands& lines, const Mesh& head, const SimulationSettings& settings, double fps, double seconds)
    : settings_(settings), hair_(lines, head, settings), fps_(fps) {
  const double own = seconds > 0 ? seconds : motion_length_s(settings.motion);
  frames_ = std::max(1, static_cast<int>(std::lround((own > 0 ? own : kStillSeconds) * fps)));
}

RigidPose Clip::pose(double time_s) const {
  return head_pose(settings_.motion, hair_.pivot(), time_s);
}

void Clip::begin() {
  hair_.begin(pose(0), settings_.life.settle_s, console::throw_if_interrupted);
}

/// In pieces short enough for the head's path to be that of any frame rate, and for no time to be dropped.
void Clip::advance(int frame) {
  fastest_m_s_ = fastest_root_m_s_ = 0;
  if (frame == 0) return;
  const double from_s = (frame - 1) / fps_, to_s = frame / fps_;
  const LifeSettings& life = settings_.life;
  const double longest_s = std::min(kLongestPiece_s, std::max(life.catch_up_s, life.step_s));
  const int pieces = std::max(1, static_cast<int>(std::ceil((to_s - from_s) / longest_s - 1e-6)));
  const double piece_s = (to_s - from_s) / pieces;
  for (int i = 1; i <= pieces; ++i) {
    console::throw_if_interrupted();
    hair_.advance(piece_s, pose(i == pieces ? to_s : from_s + i * piece_s));
    fastest_m_s_ = std::max(fastest_m_s_, hair_.simulation().facts().fastest_m_s);
    fastest_root_m_s_ = std::max(fastest_root_m_s_, hair_.simulation().facts().fastest_root_m_s);
  }
}

}  // namespace pelage::app
