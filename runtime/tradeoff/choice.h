// Finds the cheapest settings that meet a target, or the most accurate within a budget: a ladder of candidates measured
// on reference scenes, scaled to this scene by a few probes.
#pragma once

#include <functional>
#include <optional>
#include <string>
#include <vector>

namespace pelage {

/// A point of the fronts of reference scenes: its error and time on each, in one order of scenes.
struct Candidate {
  std::vector<std::string> settings;  // data_schema/scene_values.h
  std::vector<double> error, ms;      // [reference scene]
};

struct Goal {
  std::optional<double> budget_ms;     // time at most
  std::optional<double> target_error;  // error at most
};

/// Of one candidate on this scene.
struct Probe {
  double error = 0, error_bar = 0, ms = 0;
};

struct ProbedCandidate {
  std::size_t candidate = 0;
  double predicted_error = 0, predicted_ms = 0;  // before it was probed
  Probe probe;
};

struct Choice {
  std::size_t candidate = 0;                     // the chosen one
  bool met = false;                              // else: what comes closest
  double predicted_error = 0, predicted_ms = 0;  // from the fronts and the probes of other candidates
  Probe probe;                                   // of the chosen one
  std::vector<ProbedCandidate> tried;            // in order
};

/// Candidates that are on no reference scene's front are not worth a probe: leave them out of `ladder`.
/// @param probe  measures one on this scene     @param most  probes, >= 2
/// @throws std::invalid_argument for an empty ladder or goal
Choice choose(const std::vector<Candidate>& ladder, const Goal& goal,
              const std::function<Probe(std::size_t candidate)>& probe, int most);

}  // namespace pelage
