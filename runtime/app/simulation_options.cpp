#include "pelage/app/simulation_options.h"

#include <CLI/CLI.hpp>
#include <cmath>
#include <cstdio>

#include "pelage/app/choose.h"
#include "pelage/console/options.h"
#include "pelage/data_schema/errors.h"

namespace pelage::app {
namespace {

constexpr float kFastestWind = 100;  // m/s

glm::vec3 parse_wind(const std::string& text) {
  glm::vec3 wind(0);
  int used = 0;
  const bool three = std::sscanf(text.c_str(), "%f,%f,%f%n", &wind.x, &wind.y, &wind.z, &used) == 3;
  const bool sane =
      std::abs(wind.x) <= kFastestWind && std::abs(wind.y) <= kFastestWind && std::abs(wind.z) <= kFastestWind;
  if (!three || static_cast<std::size_t>(used) != text.size() || !sane)
    throw UsageError("--wind: '" + text + "' is not a velocity in m/s, three numbers from -100 to 100 like 3,0,1");
  return wind;
}

const std::map<std::string, MotionKind> kMotions{
    {"none", MotionKind::none},          {"shake", MotionKind::shake}, {"nod", MotionKind::nod},
    {"turn", MotionKind::turn},          {"jump", MotionKind::jump},   {"dance", MotionKind::dance},
    {"keyframes", MotionKind::keyframes}};
const std::map<std::string, ChainSolver> kSolvers{{"dftl", ChainSolver::dftl},
                                                  {"position-based", ChainSolver::position_based},
                                                  {"tridiagonal", ChainSolver::tridiagonal}};

}  // namespace

SimulationSettings resolve_simulation(const CLI::App& verb, const SimulationOptions& o, const Scene& scene) {
  SimulationSettings s = scene.simulation;
  const auto given = [&](const char* name) { return verb.count(name) > 0; };
  if (given("--preset")) {
    const MotionSettings motion = s.motion;
    s = simulation_preset(o.preset);
    s.motion = motion;
  }
  if (given("--motion")) s.motion.kind = choose<MotionKind>(kMotions, o.motion, "--motion");
  if (given("--amplitude")) s.motion.amplitude = static_cast<float>(o.amplitude);
  if (given("--speed")) s.motion.speed = static_cast<float>(o.speed);
  if (given("--solver")) s.chain.solver = choose<ChainSolver>(kSolvers, o.solver, "--solver");
  if (given("--wind")) s.wind.velocity_m_s = parse_wind(o.wind);
  if (given("--vertices")) s.vertices = o.vertices;
  if (given("--wisps")) s.wisps = o.wisps;
  if (given("--settle")) s.life.settle_s = o.settle_s;
  if (given("--steps-per-second")) s.life.step_s = 1.0 / o.steps_per_s;
  return s;
}

void check_curls(const Scene& scene) {
  const auto curls = scene.effects.find("curls");
  if (curls != scene.effects.end() && curls->second == EffectState::off) return;
  if (scene.method == Method::satf && scene.simulation.shape.curl.radius_m > 0)
    throw UsageError(
        "preset " + scene.simulation.name +
        " curls strands, and method satf has none: give --method density-map, --off curls, or another preset, " +
        "e.g. hold-shape");
}

std::shared_ptr<SimulationOptions> add_simulation_options(CLI::App& app) {
  CLI::App* const verb = &app;
  auto o = std::make_shared<SimulationOptions>();
  verb->add_option("--preset", o->preset,
                   "How hair moves: loose, straight, wavy, curly, hold-shape, wet [the scene's, or hold-shape]");
  verb->add_option("--motion", o->motion,
                   "Motion of the head: none, shake, nod, turn, jump, dance, or the scene's keyframes [shake]");
  verb->add_option("--amplitude", o->amplitude, "Times the motion's own size")
      ->capture_default_str()
      ->check(console::finite(0, 10));
  verb->add_option("--speed", o->speed, "Times the motion's own speed")
      ->capture_default_str()
      ->check(console::finite(0.01, 100));
  verb->add_option("--wind", o->wind, "Mean wind in m/s: x,y,z [none]");
  verb->add_option("--settle", o->settle_s, "Seconds simulated before the first frame, so that hair hangs as it will")
      ->capture_default_str()
      ->check(console::finite(0, 100));
  verb->add_option("--vertices", o->vertices, "Simulated vertices of the longest strand")
      ->capture_default_str()
      ->check(CLI::Range(2, 256));
  verb->add_option("--wisps", o->wisps, "Simulate three guides for each of so many wisps; 0: every strand")
      ->capture_default_str()
      ->check(CLI::Range(0, 100000));
  verb->add_option("--solver", o->solver, "dftl; to compare: position-based, tridiagonal [dftl]");
  verb->add_option("--steps-per-second", o->steps_per_s, "Internal steps")
      ->capture_default_str()
      ->check(console::finite(60, 2000));
  return o;
}

}  // namespace pelage::app
