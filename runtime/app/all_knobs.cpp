#include "pelage/app/all_knobs.h"

#include <algorithm>

#include "pelage/bake/knobs.h"
#include "pelage/data_schema/errors.h"
#include "pelage/data_schema/validate.h"
#include "pelage/render/knobs.h"
#include "pelage/satf/knobs.h"
#include "pelage/shadow/knobs.h"
#include "pelage/simulate/knobs.h"

namespace pelage::app {

std::vector<Knob> all_knobs() {
  std::vector<Knob> knobs;
  for (const std::span<const Knob> module :
       {shadow_knobs(), bake_knobs(), satf_knobs(), picture_knobs(), simulation_knobs()})
    knobs.insert(knobs.end(), module.begin(), module.end());
  return knobs;
}

std::vector<Knob> chosen_knobs(const std::vector<std::string>& names) {
  std::vector<Knob> all = all_knobs();
  if (names.empty()) return all;
  const auto fits = [](const Knob& knob, const std::string& name) {
    return knob.name == name || knob.name.starts_with(name + ".");
  };
  std::vector<std::string> known;
  for (const Knob& knob : all) known.push_back(knob.name);
  for (const std::string& name : names)
    if (std::none_of(all.begin(), all.end(), [&](const Knob& knob) { return fits(knob, name); }))
      throw UsageError("--only: there is no knob '" + name + "'; the nearest is '" + nearest_word(name, known) + "'");
  std::erase_if(all, [&](const Knob& knob) {
    return std::none_of(names.begin(), names.end(), [&](const std::string& name) { return fits(knob, name); });
  });
  return all;
}

}  // namespace pelage::app
