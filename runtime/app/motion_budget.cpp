#include "pelage/app/motion_budget.h"

#include <fmt/format.h>

#include <algorithm>
#include <cstdio>

#include "motion_ladder.h"
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

MotionBudget choose_motion(const Scene& scene, const Subject& subject, const Goal& goal, ClipLength length) {
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
  MotionBudget budget;
  budget.goal = goal;
  budget.choice = choose(ladder.candidates, goal, measure, kMostProbes);
  budget.settings = ladder.candidates[budget.choice.candidate].settings;
  budget.truth = converged.what();
  return budget;
}

void print_budget(const MotionBudget& budget, double achieved_ms) {
  const Choice& c = budget.choice;
  if (!c.met) std::printf("nothing meets it; what comes closest:\n");
  for (const std::string& setting : budget.settings) std::printf("  --set %s\n", setting.c_str());
  std::printf("%-22s %12s %12s\n", "", "ms per frame", "RMS mm");
  const auto row = [](const char* name, const std::string& ms, const std::string& mm) {
    std::printf("%-22s %12s %12s\n", name, ms.c_str(), mm.c_str());
  };
  const auto number = [](double x) { return fmt::format("{:.3g}", x); };
  row("asked for", budget.goal.budget_ms ? number(*budget.goal.budget_ms) : "",
      budget.goal.target_error ? number(*budget.goal.target_error) : "");
  row("predicted", number(c.predicted_ms), number(c.predicted_error));
  row("probed", number(c.probe.ms), fmt::format("{:.3g}+-{:.2g}", c.probe.error, c.probe.error_bar));
  row("achieved", number(achieved_ms), "");
}

nlohmann::ordered_json json_of(const MotionBudget& budget, double achieved_ms) {
  const Choice& c = budget.choice;
  nlohmann::ordered_json json;
  if (budget.goal.budget_ms) json["budget_ms"] = *budget.goal.budget_ms;
  if (budget.goal.target_error) json["target_error_mm"] = *budget.goal.target_error;
  json["met"] = c.met;
  json["settings"] = budget.settings;
  json["predicted_ms"] = c.predicted_ms;
  json["predicted_error_mm"] = c.predicted_error;
  json["probed_ms"] = c.probe.ms;
  json["probed_error_mm"] = c.probe.error;
  json["error_bar_mm"] = c.probe.error_bar;
  json["achieved_ms"] = achieved_ms;
  json["probes"] = c.tried.size();
  json["truth"] = budget.truth;
  return json;
}

}  // namespace pelage::app
