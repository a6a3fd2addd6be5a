// --budget-ms and --target-error: what was asked for, chosen and reached, as options, text and JSON.
#pragma once

#include <nlohmann/json_fwd.hpp>
#include <optional>
#include <string>
#include <vector>

#include "pelage/tradeoff/choice.h"

namespace CLI {
class App;
}

namespace pelage::app {

struct BudgetOptions {
  double budget_ms = 0, target_error = 0;  // 0: not given

  std::optional<Goal> goal() const;
};

/// @param time, error  what is meant, for --help: "a frame", "RMS distance from a converged run [mm]"
void add_budget_options(CLI::App& verb, BudgetOptions& options, const std::string& time, const std::string& error);

struct Budget {
  Goal goal;
  Choice choice;
  std::vector<std::string> settings;  // chosen (data_schema/scene_values.h)
  std::string error_name;             // "RMSE", "RMS mm"
  std::string truth;                  // a sentence: what errors are measured against
  double achieved_ms = 0;             // median of frames with the chosen settings
  std::optional<Probe> achieved;      // the error of what was made, where it was measured apart from the probes
};

/// Settings as options, then goals, predictions and what was measured.
void print_budget(const Budget& budget);
nlohmann::ordered_json json_of(const Budget& budget);

}  // namespace pelage::app
