// The ledger of a simulated sequence: what each effect of the motion does, costs and changes (explain.h).
#pragma once

#include <vector>

#include "pelage/app/explain.h"
#include "pelage/app/prepare.h"

namespace pelage::app {

/// Simulates the sequence four times for each effect.
/// @param drawing  of the same hair: draws the last frame of each, for `rmse`; null: no pictures are compared
/// @throws SimulationError, Interrupted
std::vector<LedgerLine> explain_motion(const Subject& subject, const Scene& scene, double fps, double seconds,
                                       Drawing* drawing, const Camera& camera);

}  // namespace pelage::app
