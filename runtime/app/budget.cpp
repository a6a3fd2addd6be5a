#include "pelage/app/budget.h"

#include <fmt/format.h>
#include <CLI/CLI.hpp>
#include <nlohmann/json.hpp>

#include <cstdio>

#include "pelage/app/command_line.h"
#include "pelage/console/options.h"

namespace pelage::app {
namespace {

constexpr double kMost = 1e9;

std::string number(double value) {
  return fmt::format("{:.3g}", value);
}

std::string with_bar(const Probe& probe) {
  return fmt::format("{:.3g}+-{:.2g}", probe.error, probe.error_bar);
}

}  // namespace

std::optional<Goal> BudgetOptions::goal() const {
  Goal goal;
  if (budget_ms > 0) goal.budget_ms = budget_ms;
  if (target_error > 0) goal.target_error = target_error;
  return goal.budget_ms || goal.target_error ? std::optional(goal) : std::nullopt;
}

void add_budget_options(CLI::App& verb, BudgetOptions& options, const std::string& time, const std::string& error) {
  verb.add_option("--budget-ms", options.budget_ms,
                  "Choose the most accurate settings that keep to so many milliseconds of " + time)
      ->check(console::finite(1e-6, kMost));
  verb.add_option(
          "--target-error", options.target_error,
          "Choose the fastest settings whose error is no greater: " + error + "; exit code 3 where nothing meets it")
      ->check(console::finite(1e-9, kMost));
}

void print_budget(const Budget& b) {
  const Choice& c = b.choice;
  std::printf(c.met ? "chosen:\n" : "nothing meets it; what comes closest:\n");
  for (const std::string& setting : b.settings) std::printf("  --set %s\n", shell_word(setting).c_str());
  const auto row = [](const char* name, const std::string& ms, const std::string& error) {
    std::printf("%-12s %12s %18s\n", name, ms.c_str(), error.c_str());
  };
  row("", "ms a frame", b.error_name);
  row("asked for", b.goal.budget_ms ? number(*b.goal.budget_ms) : "",
      b.goal.target_error ? number(*b.goal.target_error) : "");
  row("predicted", number(c.predicted_ms), number(c.predicted_error));
  row("probed", number(c.probe.ms), with_bar(c.probe));
  row("achieved", number(b.achieved_ms), b.achieved ? with_bar(*b.achieved) : "");
}

nlohmann::ordered_json json_of(const Budget& b) {
  const Choice& c = b.choice;
  nlohmann::ordered_json json;
  if (b.goal.budget_ms) json["budget_ms"] = *b.goal.budget_ms;
  if (b.goal.target_error) json["target_error"] = *b.goal.target_error;
  json["met"] = c.met;
  json["settings"] = b.settings;
  json["error_name"] = b.error_name;
  json["predicted"] = {{"ms", c.predicted_ms}, {"error", c.predicted_error}};
  json["probed"] = {{"ms", c.probe.ms}, {"error", c.probe.error}, {"error_bar", c.probe.error_bar}};
  json["achieved"]["ms"] = b.achieved_ms;
  if (b.achieved) {
    json["achieved"]["error"] = b.achieved->error;
    json["achieved"]["error_bar"] = b.achieved->error_bar;
  }
  json["probes"] = c.tried.size();
  json["truth"] = b.truth;
  return json;
}

}  // namespace pelage::app
