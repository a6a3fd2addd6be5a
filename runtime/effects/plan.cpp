#include "pelage/effects/plan.h"

#include <algorithm>
#include <stdexcept>

namespace pelage {
namespace {

bool has(const std::vector<std::string>& names, const std::string& name) {
  return std::find(names.begin(), names.end(), name) != names.end();
}

EffectState asked_of(const Scene& scene, const Effect& effect) {
  const auto asked = scene.effects.find(effect.name);
  return effect.pass || asked == scene.effects.end() ? EffectState::automatic : asked->second;
}

/// By itself, in a scene without what is known not to run.
PlannedEffect judge(Effect effect, const Scene& scene, const HairFacts& facts) {
  PlannedEffect p;
  p.asked = asked_of(scene, effect);
  if (effect.idle) p.why = effect.idle(scene, facts);
  p.idle = !p.why.empty();
  if (p.idle) {
    p.called_for = false;
  } else if (effect.called_for) {
    const Verdict verdict = effect.called_for(scene, facts);
    p.called_for = verdict.called_for;
    p.why = verdict.why;
  }
  p.runs = !p.idle && p.asked != EffectState::off && (p.asked == EffectState::on || p.called_for);
  p.effect = std::move(effect);
  return p;
}

/// An effect that lacks something cannot run; the provider may be one that could be pulled in, a pass.
bool is_offered(const std::string& resource, const std::vector<PlannedEffect>& all, std::size_t before) {
  return std::any_of(all.begin(), all.begin() + static_cast<std::ptrdiff_t>(before), [&](const PlannedEffect& p) {
    return has(p.effect.provides, resource) && (p.runs || (p.effect.pass && !p.idle));
  });
}

void stop_what_lacks(std::vector<PlannedEffect>& all) {
  for (std::size_t i = 0; i < all.size(); ++i) {
    PlannedEffect& p = all[i];
    for (const std::string& need : p.effect.needs) {
      if (!p.runs || is_offered(need, all, i)) continue;
      p.runs = false;
      p.why = "there is no " + need;
    }
  }
}

/// Names of the running effects that take what `provider` gives; the result's own counts as taken.
std::string takers(const PlannedEffect& provider, std::size_t index, const std::vector<PlannedEffect>& all) {
  std::string names;
  for (std::size_t k = index + 1; k < all.size(); ++k) {
    const Effect& other = all[k].effect;
    const auto takes = [&](const std::string& given) { return has(other.needs, given) || has(other.uses, given); };
    if (!all[k].runs || !std::any_of(provider.effect.provides.begin(), provider.effect.provides.end(), takes)) continue;
    names += (names.empty() ? "" : ", ") + other.name;
  }
  return names;
}

/// From the last to the first: whether anything that runs takes it is known then.
void stop_what_nothing_takes(std::vector<PlannedEffect>& all) {
  for (std::size_t i = all.size(); i-- > 0;) {
    PlannedEffect& p = all[i];
    if (has(p.effect.provides, kResult)) continue;
    const std::string names = takers(p, i, all);
    if (p.effect.pass) {
      p.runs = !p.idle && !names.empty();
      if (!p.idle) p.why = names.empty() ? "nothing that runs needs it" : "needed by " + names;
    } else if (p.runs && names.empty()) {
      p.runs = false;
      p.why = "nothing that runs takes its " + p.effect.provides.front();
    }
  }
}

}  // namespace

const PlannedEffect& EffectPlan::at(const std::string& name) const {
  for (const PlannedEffect& p : effects)
    if (p.effect.name == name) return p;
  throw std::out_of_range("no effect " + name);
}

EffectPlan plan_effects(std::vector<Effect> effects, const Scene& scene, const HairFacts& facts) {
  EffectPlan plan{scene, {}};
  Scene judged = scene;
  for (Effect& effect : effects) {
    const PlannedEffect& p = plan.effects.emplace_back(judge(std::move(effect), judged, facts));
    if (!p.runs && p.effect.leave_out) p.effect.leave_out(judged);
  }
  stop_what_lacks(plan.effects);
  stop_what_nothing_takes(plan.effects);
  for (const PlannedEffect& p : plan.effects)
    if (!p.runs && p.effect.leave_out) p.effect.leave_out(plan.scene);
  // Capsules that are left out are marked, so that the others keep their numbers until here.
  std::erase_if(plan.scene.simulation.collision.capsules, [](const ColliderCapsule& c) { return c.radius_m < 0; });
  return plan;
}

std::vector<std::string> effect_names(const Scene& scene) {
  std::vector<std::string> names;
  const auto add = [&](const std::vector<Effect>& effects) {
    for (const Effect& e : effects)
      if (!e.pass && !has(names, e.name)) names.push_back(e.name);
  };
  Scene other = scene;
  for (const Method method : {Method::satf, Method::density_map}) {
    other.method = method;
    add(picture_effects(other));
  }
  add(motion_effects(scene));
  return names;
}

EffectPlan plan_effects(const Scene& scene, const HairFacts& facts, Task task) {
  return plan_effects(task == Task::picture ? picture_effects(scene) : motion_effects(scene), scene, facts);
}

}  // namespace pelage
