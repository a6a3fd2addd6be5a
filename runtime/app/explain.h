// What a frame does, why, what it costs and what would be lost without it [DESIGN section 8]: the ledger of --explain.
#pragma once

#include <array>
#include <cstdint>
#include <nlohmann/json_fwd.hpp>
#include <optional>
#include <string>
#include <vector>

#include "pelage/app/drawing.h"
#include "pelage/data_schema/scene.h"
#include "pelage/effects/plan.h"
#include "pelage/render/camera.h"

namespace pelage::app {

struct LedgerLine {
  std::string name;
  bool pass = false;
  EffectState asked = EffectState::automatic;
  bool runs = true, called_for = true;
  std::string why;
  // Of stages that are its alone, in a frame in which hair has moved; an effect that is a few lines of a larger loop
  // has none: what it costs is `saves_ms`.
  double ms = 0;
  std::uint64_t bytes = 0, calls = 0;
  // Against the same with this one switched over: left out where it runs, run where it does not. None for passes, and
  // where there is nothing to run.
  std::optional<double> saves_ms;  // time of the frame with it, less the time without: least of two each
  double spread_ms = 0;            // between the two: what a saving below it says nothing about
  std::optional<double> rmse;      // between the pictures, linear RGB, all pixels
  std::optional<double> moves_mm;  // RMS between the places of the drawn strands at the end; motion only
};

/// Root mean square of the difference of linear RGB of two pictures of one size.
double rms_difference(const Image& a, const Image& b) noexcept;
/// What the plan says of an effect, without costs.
LedgerLine line_of(const PlannedEffect& planned);
/// Adds what stages took that are the effect's alone.
void charge(LedgerLine& line, const Effect& effect, const std::vector<Stage>& stages);
/// The scene with an effect left out that runs, or run that does not.
Scene switched_over(const Scene& scene, const PlannedEffect& planned);

/// Does the same run in both plans of one scene?
bool same_work(const EffectPlan& a, const EffectPlan& b);
void set_savings(LedgerLine& line, const std::array<double, 2>& as_is_ms, const std::array<double, 2>& other_ms);

/// What ran for the last picture, why and what it took; nothing is compared.
std::vector<LedgerLine> ledger_of(const Drawing& drawing);
/// Draws the picture four times for each effect. @throws Interrupted
std::vector<LedgerLine> explain_picture(Drawing& drawing, const Scene& scene, const Camera& camera);

nlohmann::ordered_json json_of(const std::vector<LedgerLine>& ledger);
/// As a table on stdout, reasons at the end of the lines.
void print_ledger(const std::vector<LedgerLine>& ledger);

}  // namespace pelage::app
