// Candidates for --budget-ms and --target-error as scripts/make-ladder.py writes them.
#pragma once

#include <string>
#include <string_view>
#include <vector>

#include "pelage/tradeoff/choice.h"

namespace pelage::app {

struct Ladder {
  std::vector<std::string> scenes;  // that the candidates were measured on
  std::vector<Candidate> candidates;
};

/// @throws InputError naming `where`
Ladder read_ladder(std::string_view text, const std::string& where);

}  // namespace pelage::app
