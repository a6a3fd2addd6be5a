// Options of how hair moves, which `simulate` and `view` share.
#pragma once

#include <memory>
#include <string>

#include "pelage/data_schema/scene.h"

namespace CLI {
class App;
}

namespace pelage::app {

struct SimulationOptions {
  std::string preset, motion, solver, wind;
  double settle_s = 1, steps_per_s = 240, amplitude = 1, speed = 1;
  int vertices = 24, wisps = 0;
};

/// Adds the options; the returned object is filled when the command line is parsed and must outlive the callback.
std::shared_ptr<SimulationOptions> add_simulation_options(CLI::App& verb);

/// The scene's settings, then what the command line changes of them. @throws UsageError
SimulationSettings resolve_simulation(const CLI::App& verb, const SimulationOptions& options, const Scene& scene);

/// For hair that is drawn as it moves. @throws UsageError for curls by SATF
void check_curls(const Scene& scene);

}  // namespace pelage::app
