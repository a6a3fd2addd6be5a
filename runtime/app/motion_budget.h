// Settings of the simulation for the time there is or the error that is accepted: `simulate --budget-ms`,
// `--target-error`. Candidates are points of the fronts of reference scenes (runtime/tradeoff/motion_ladder.json),
// which say step, vertices, wisps and solver; what the scene is made of, its rates and forces, is never touched. A few
// of them are probed on the first second of this scene.
//
// Errors are those of converged_motion.h on at most kProbedStrands of the hair's strands; times of all of them.
#pragma once

#include "pelage/app/budget.h"
#include "pelage/app/converged_motion.h"

namespace pelage::app {

/// @param length  of the sequence; the probes' is at most a second    @throws SimulationError, Interrupted, UsageError
Budget choose_motion(const Scene& scene, const Subject& subject, const Goal& goal, ClipLength length);

}  // namespace pelage::app
