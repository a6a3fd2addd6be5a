// From what a scene asks for to what is run: backwards from the result, only what is needed.
//
//   asked off                     does not run; nor does what cannot do without it
//   asked on                      runs, unless its settings leave nothing to run or nothing uses what it provides
//   auto                          the same, if the scene, without the effects before it that do not run, calls for it
//   pass                          runs if something that runs needs or uses what it provides
#pragma once

#include <string>
#include <vector>

#include "pelage/effects/effect.h"

namespace pelage {

struct PlannedEffect {
  Effect effect;
  EffectState asked = EffectState::automatic;
  bool runs = true;
  bool called_for = true;  // by the scene, whatever was asked
  bool idle = false;       // its settings leave nothing to run
  std::string why;
};

struct EffectPlan {
  Scene scene;  // with the settings of all that does not run left out
  std::vector<PlannedEffect> effects;

  /// @throws std::out_of_range
  const PlannedEffect& at(const std::string& name) const;
  bool runs(const std::string& name) const { return at(name).runs; }
};

/// @throws what the gates throw for hair that is not finite and the like
EffectPlan plan_effects(const Scene& scene, const HairFacts& facts, Task task);

/// The same over given effects, in an order in which each comes after what it needs or uses.
EffectPlan plan_effects(std::vector<Effect> effects, const Scene& scene, const HairFacts& facts);

}  // namespace pelage
