#include "pelage/app/motion_budget.h"

#include <algorithm>

#include "ladders.h"
#include "pelage/app/ladder.h"
#include "pelage/console/progress.h"
#include "pelage/data_schema/scene_values.h"
#include "pelage/simulate/simulation.h"

namespace pelage::app {
namespace {

constexpr std::size_t kProbedStrands = 500;  // errors of more are the same within a few per cent
constexpr int kFinest = 1920;                // internal steps per second of the converged run: half the ladder's finest
constexpr double kLongestProbe_s = 1;
/// Of the clips that time is taken of, which need not have settled: hair moves from the first frame on.
constexpr ClipLength kTimed{30, 0.4};
constexpr double kTimedSettle_s = 0.1;
constexpr int kTimedClips = 3, kMostProbes = 8;
/// Of settings with which the hair flies apart.
constexpr double kExploded_mm = 1e6;

/// Of a frame: the least of the clips' medians, which other processes disturb least.
double frame_ms(const Subject& subject, Scene scene, double fps) {
  scene.simulation.life.settle_s = std::min(scene.simulation.life.settle_s, kTimedSettle_s);
  double least = 0;
  for (int i = 0; i < kTimedClips; ++i) {
    const double ms = run_clip(subject, scene, {fps, std::max(kTimed.seconds, 4 / fps)}).median_ms();
    least = i == 0 ? ms : std::min(least, ms);
  }
  return least;
}

Probe probe(const ConvergedMotion& converged, const Subject& all, const Scene& scene, double fps) {
  try {
    return {converged.error_of(converged.run(scene)).rms_mm, converged.own_error_mm(), frame_ms(all, scene, fps)};
  } catch (const SimulationError&) {
    return {kExploded_mm, 0, kExploded_mm};
  }
}

}  // namespace

Budget choose_motion(const Scene& scene, const Subject& subject, const Goal& goal, ClipLength length) {
  const Ladder ladder = read_ladder(data::motion_ladder_json, "motion_ladder.json");
  console::Progress progress("choosing settings of the motion", kMostProbes + 1, "probes");
  const ConvergedMotion converged(scene, thinned(subject, kProbedStrands),
                                  {length.fps, std::min(length.seconds, kLongestProbe_s)}, kFinest);
  std::uint64_t done = 0;
  progress.update(++done);
  const auto measure = [&](std::size_t candidate) {
    const Probe result =
        probe(converged, subject, with_values(scene, ladder.candidates[candidate].settings), length.fps);
    progress.update(++done);
    return result;
  };
  Budget budget;
  budget.goal = goal;
  budget.choice = choose(ladder.candidates, goal, measure, kMostProbes);
  budget.settings = ladder.candidates[budget.choice.candidate].settings;
  budget.error_name = "RMS mm";
  budget.truth = converged.what();
  return budget;
}

}  // namespace pelage::app
