// The period of a hanging chain against mechanics (hanging_chain.h): what the solver's step and correction do to motion
// that is known exactly. The chain has the scene's vertices, solver and internal step; no damping, nothing to touch.
//
// Sixteen chains in one block of the solver swing in as many directions, so that each has its own rounding: the error
// is their mean's, the error bar their standard error.
#include <fmt/format.h>

#include <array>
#include <cmath>
#include <glm/geometric.hpp>
#include <numbers>

#include "pelage/app/measure.h"
#include "pelage/app/stopwatch.h"
#include "pelage/data_schema/errors.h"
#include "pelage/simulate/chain_step.h"
#include "pelage/simulate/hanging_chain.h"

namespace pelage::app {
namespace {

constexpr double kLength_m = 0.3, kAmplitude_m = 0.002, kGravity_m_s2 = 9.81;  // NUMBERS, "DFTL"
constexpr double kSeconds = 6;
/// What float does to the period of all chains alike: 3e-4 at 1/960 s, the more the shorter the step (found against
/// NUMBERS' figures, which are of double).
constexpr double kRounding_s = 3e-4 / 960;

glm::dvec3 direction(int chain) {
  const double turn = 2 * std::numbers::pi * 0.6180339887498949 * chain;  // no two alike, none along an axis but one
  return {std::cos(turn), 0, std::sin(turn)};
}

double length_m(int chain) {
  return kLength_m * (1 + 0.04 * (chain / (kLanes - 1.0) - 0.5));
}

StrandBlocks chains_in_first_mode(int links) {
  Strands strands;
  for (int c = 0; c < kLanes; ++c)
    strands.append(chain_in_mode(links, length_m(c), first_laguerre_zero(links), kAmplitude_m, direction(c)));
  return make_blocks(strands, glm::dvec3(0));
}

double exact_period_s(int links, int chain) {
  return 2 * std::numbers::pi / std::sqrt(kGravity_m_s2 * links / length_m(chain) * first_laguerre_zero(links));
}

ChainStep step_of(const SimulationSettings& settings) {
  ChainStep step;
  step.step_s = static_cast<float>(settings.life.step_s);
  step.chain = settings.chain;
  step.chain.gravity = {0, static_cast<float>(-kGravity_m_s2), 0};
  step.chain.damping_per_s = 0;
  return step;
}

/// Place of a chain's tip along its direction [m].
double aside(const StrandBlocks& blocks, int chain) {
  const std::uint32_t lane = blocks.block_of[static_cast<std::size_t>(chain)] % kLanes;
  const Lanes3& tip = blocks.position.back();
  return glm::dot(glm::dvec3(tip.x[lane], tip.y[lane], tip.z[lane]), direction(chain));
}

/// Of the periods, relative.
struct PeriodError {
  double mean = 0, standard_error = 0;
};

PeriodError error_of(const std::array<SwingClock, kLanes>& clocks, int links) {
  std::array<double, kLanes> errors{};
  double sum = 0, squares = 0;
  for (std::size_t c = 0; c < clocks.size(); ++c) {
    if (clocks[c].crossings() < 2) throw InputError("hanging chain", "it does not swing with these settings");
    errors[c] = clocks[c].period_s() / exact_period_s(links, static_cast<int>(c)) - 1;
    sum += errors[c];
  }
  const double mean = sum / kLanes;
  for (const double error : errors) squares += (error - mean) * (error - mean);
  return {mean, std::sqrt(squares / (kLanes * (kLanes - 1.0)))};
}

class PeriodMeasure final : public Measure {
 public:
  explicit PeriodMeasure(bool quick) : repeats_(quick ? 3 : 7) {
    facts_ = {
        "period",
        "Motion: period of a hanging chain",
        "error of the period",
        "%",
        "a second of 16 chains",
        fmt::format("A chain of equal masses, {} m long, one link less than the scene's vertices, swinging in its "
                    "first mode with {:g} mm at its tip: omega^2 = g/l x, x the least zero of the Laguerre "
                    "polynomial of as many links of length l; exact to the swing's size, 6e-4 %. Error bars: "
                    "standard error of 16 chains and what float does to all of them, 3e-4 at 1/960 s.",
                    kLength_m, 1e3 * kAmplitude_m)};
  }
  const MeasureFacts& facts() const override { return facts_; }
  std::pair<std::string, std::string> command() const override { return {"simulate", "--stats"}; }

  Measured measure(const Scene& scene) override {
    const int links = scene.simulation.vertices - 1;
    Measured m;
    PeriodError error;
    for (int i = 0; i < repeats_; ++i) m.ms.push_back(swing(scene.simulation, links, error));
    if (!std::isfinite(error.mean)) throw InputError("hanging chain", "it does not stay finite with these settings");
    m.error = 100 * std::abs(error.mean);
    m.error_bar = 100 * std::hypot(error.standard_error, kRounding_s / scene.simulation.life.step_s);
    m.others = {{"signed", 100 * error.mean}};
    m.bytes = static_cast<std::uint64_t>(links + 1) * 4 * sizeof(Lanes3);  // rest, place and two velocities
    return m;
  }

 private:
  /// @return time of a second's steps [ms]
  static double swing(const SimulationSettings& settings, int links, PeriodError& error) {
    StrandBlocks chains = chains_in_first_mode(links);
    const ChainStep step = step_of(settings);
    std::array<SwingClock, kLanes> clocks;
    std::array<float, 1> fastest{};
    double ms = 0;
    const int steps = static_cast<int>(kSeconds / settings.life.step_s);
    for (int k = 1; k <= steps; ++k) {
      const auto begin = std::chrono::steady_clock::now();
      step_chains(chains, 0, chains.count(), step, fastest);
      ms += ms_since(begin);
      for (int c = 0; c < kLanes; ++c)
        clocks[static_cast<std::size_t>(c)].sample(k * settings.life.step_s, aside(chains, c));
    }
    error = error_of(clocks, links);
    return ms / kSeconds;
  }

  MeasureFacts facts_;
  int repeats_;
};

}  // namespace

std::unique_ptr<Measure> measure_period(const MeasureRequest& request) {
  return std::make_unique<PeriodMeasure>(request.quick);
}

}  // namespace pelage::app
