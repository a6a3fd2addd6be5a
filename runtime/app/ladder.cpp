#include "pelage/app/ladder.h"

#include <nlohmann/json.hpp>

#include "pelage/data_schema/errors.h"

namespace pelage::app {

Ladder read_ladder(std::string_view text, const std::string& where) {
  Ladder ladder;
  try {
    const auto document = nlohmann::json::parse(text);
    document.at("scenes").get_to(ladder.scenes);
    for (const auto& candidate : document.at("candidates"))
      ladder.candidates.push_back({candidate.at("settings").get<std::vector<std::string>>(),
                                   candidate.at("error").get<std::vector<double>>(),
                                   candidate.at("ms").get<std::vector<double>>()});
  } catch (const nlohmann::json::exception& error) {
    throw InputError(where, error.what());
  }
  for (const Candidate& candidate : ladder.candidates)
    if (candidate.error.size() != ladder.scenes.size() || candidate.ms.size() != ladder.scenes.size())
      throw InputError(where, "a candidate has figures of other scenes than the ladder's");
  if (ladder.candidates.empty())
    throw InputError(where, "it has no candidates: write it anew by scripts/make-ladder.py");
  return ladder;
}

}  // namespace pelage::app
