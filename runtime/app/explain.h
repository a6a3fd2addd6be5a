// What a frame does, why, what it costs and what would be lost without it [DESIGN section 8]: the ledger of --explain.
#pragma once

#include <cstdint>
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
  std::optional<double> saves_ms;  // time of the frame with it, less the time without
  std::optional<double> rmse;      // between the pictures, linear RGB, all pixels
  std::optional<double> moves_mm;  // RMS between the places of the lines' vertices at the end; motion only
};

/// Draws the picture once as it is and once for each effect. @throws Interrupted
std::vector<LedgerLine> explain_picture(Drawing& drawing, const Scene& scene, const Camera& camera);

/// As a table on stdout, reasons at the end of the lines; or JSON, under "effects".
void print_ledger(const std::vector<LedgerLine>& ledger);

}  // namespace pelage::app
