// Settings of the simulation for the time there is or the error that is accepted: `simulate --budget-ms`,
// `--target-error`. Candidates are points of the fronts of reference scenes (runtime/tradeoff/motion_ladder.json),
// which say step, vertices, wisps and solver; what the scene is made of, its rates and forces, is never touched. A few
// of them are probed on the first second of this scene.
//
// Errors are those of converged_motion.h on at most kProbedStrands of the hair's strands; times of all of them.
#pragma once

#include <nlohmann/json.hpp>

#include "pelage/app/converged_motion.h"
#include "pelage/tradeoff/choice.h"

namespace pelage::app {

struct MotionBudget {
  Goal goal;
  Choice choice;
  std::vector<std::string> settings;  // chosen (data_schema/scene_values.h)
  std::string truth;                  // a sentence: what errors are measured against
};

/// @param length  of the sequence; the probes' is at most a second    @throws SimulationError, Interrupted, UsageError
MotionBudget choose_motion(const Scene& scene, const Subject& subject, const Goal& goal, ClipLength length);

/// Settings as options, then goals, predictions and what was measured. @param achieved_ms  a frame of the sequence
void print_budget(const MotionBudget& budget, double achieved_ms);
nlohmann::ordered_json json_of(const MotionBudget& budget, double achieved_ms);

}  // namespace pelage::app
