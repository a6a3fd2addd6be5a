// Effects and passes of the simulation; their stages are those of Simulation and MovingHair.
#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <glm/geometric.hpp>

#include "pelage/effects/effect.h"
#include "pelage/effects/measures.h"

namespace pelage {
namespace {

using Idle = std::function<std::string(const Scene&, const HairFacts&)>;
using Judge = std::function<Verdict(const Scene&, const HairFacts&)>;

/// Of one number in the settings of the simulation.
struct Amount {
  const char* key;
  float& (*of)(SimulationSettings&);
};

Idle is_zero(Amount amount) {
  return [amount](const Scene& scene, const HairFacts&) -> std::string {
    SimulationSettings s = scene.simulation;
    return amount.of(s) == 0 ? fmt::format("simulation.{} is zero", amount.key) : "";
  };
}

std::function<void(Scene&)> to_zero(Amount amount) {
  return [amount](Scene& scene) { amount.of(scene.simulation) = 0; };
}

Judge always(const char* why) {
  return [why](const Scene&, const HairFacts&) { return Verdict{true, why}; };
}

Effect of_amount(const char* name, Amount amount, Judge called_for) {
  Effect e;
  e.name = name;
  e.provides = {kResult};
  e.idle = is_zero(amount);
  e.called_for = std::move(called_for);
  e.leave_out = to_zero(amount);
  return e;
}

/// Hair's drawn width [m], or 0.
float width_m(const HairFacts& hair) {
  if (hair.strands == nullptr) return 0;
  const Strands& s = *hair.strands;
  return s.diameters_m.empty() ? s.diameter_m : *std::min_element(s.diameters_m.begin(), s.diameters_m.end());
}

/// Of what moves hair by at most `off_m`.
Verdict judge_place(const HairFacts& hair, float off_m, const char* what) {
  const float most_m = kUnseenWidth * width_m(hair);
  return {!(off_m <= most_m), fmt::format("{} at most {:.2g} mm; a tenth of a fibre's width is {:.2g} mm", what,
                                          1e3F * off_m, 1e3F * most_m)};
}

/// What strands do to each other over the voxel grid, which spreads over a cell to each side. A strand rubs against
/// itself as well: that moves it by less than 0.1 mm (tests/effects) and does not count.
Verdict judge_friction(const Scene& scene, const HairFacts& hair) {
  if (hair.strands == nullptr) return {};
  const float near_m = 4 * scene.simulation.interaction.cell_m;
  if (strands_can_meet(*hair.strands, near_m)) return {true, "strands can come into each other's cells"};
  return {false, fmt::format("no two strands can come within {:.2g} m of each other", near_m)};
}

Effect voxel_grid() {
  Effect e;
  e.name = "voxel-grid";
  e.pass = true;
  e.provides = {"voxel grid"};
  e.stages = {"grid"};
  return e;
}

Effect always_run(const char* name, std::vector<std::string> stages, const char* why) {
  Effect e;
  e.name = name;
  e.pass = true;
  e.provides = {kResult};
  e.stages = std::move(stages);
  e.called_for = always(why);
  return e;
}

Effect on_the_grid(Effect e) {
  e.needs = {"voxel grid"};
  return e;
}

/// Of a hanging strand, statically a length times acceleration over gravity; ten times that leaves room for gusts that
/// come at the strand's own frequency (damping of 6 /s: less than three times).
Verdict judge_wind(const Scene& scene, const HairFacts& hair) {
  if (hair.strands == nullptr) return {};
  const WindSettings& wind = scene.simulation.wind;
  const float fastest = glm::length(wind.velocity_m_s) * (1 + wind.gust);
  const float gravity = glm::length(scene.simulation.chain.gravity);
  const float off_m = 10 * longest_strand_m(*hair.strands) * wind.drag_per_s * fastest / gravity;
  return judge_place(hair, off_m, "the wind moves hair by");
}

Effect wind() {
  Effect e;
  e.name = "wind";
  e.uses = {"shelter"};
  e.provides = {kResult};
  e.idle = [](const Scene& s, const HairFacts&) -> std::string {
    if (s.simulation.wind.velocity_m_s == glm::vec3(0)) return "simulation.wind.velocity_m_s is zero";
    return s.simulation.wind.drag_per_s == 0 ? "simulation.wind.drag_per_s is zero" : "";
  };
  e.called_for = judge_wind;
  e.leave_out = [](Scene& s) { s.simulation.wind.velocity_m_s = glm::vec3(0); };
  return e;
}

Effect shelter() {
  Effect e =
      on_the_grid(of_amount("shelter", {"wind.shelter", [](SimulationSettings& s) -> float& { return s.wind.shelter; }},
                            always("hair shelters hair from the wind")));
  e.provides = {"shelter"};
  return e;
}

/// A pull that is weak against gravity bends a hanging strand by its share of it.
Verdict judge_hold(const Scene& scene, const HairFacts& hair) {
  const SimulationSettings& s = scene.simulation;
  if (s.shape.sag_free) return {true, "the groom bears gravity by its shape"};
  if (hair.strands == nullptr) return {};
  const float length_m = longest_strand_m(*hair.strands), gravity = glm::length(s.chain.gravity);
  const float off_m = s.shape.hold_rad_s * s.shape.hold_rad_s * length_m * length_m / gravity;
  return judge_place(hair, off_m, "the groom's shape moves hair by");
}

Verdict judge_curls(const Scene& scene, const HairFacts& hair) {
  if (hair.strands == nullptr) return {};
  return judge_place(hair, scene.simulation.shape.curl.radius_m + curve_deviation_m(*hair.strands),
                     "curls move hair by");
}

Effect wisps() {
  Effect e;
  e.name = "wisps";
  e.provides = {kResult};
  e.idle = [](const Scene& s, const HairFacts&) {
    return s.simulation.wisps == 0 ? "simulation.wisps is zero: every strand is simulated" : "";
  };
  e.called_for = [](const Scene& s, const HairFacts& hair) -> Verdict {
    if (hair.strands == nullptr) return {};
    const std::size_t guides = 3 * static_cast<std::size_t>(s.simulation.wisps), strands = hair.strands->count();
    if (guides < strands) return {true, fmt::format("{} guides carry {} strands", guides, strands)};
    return {false, fmt::format("{} guides are no fewer than {} strands: these are simulated", guides, strands)};
  };
  e.leave_out = [](Scene& s) { s.simulation.wisps = 0; };
  return e;
}

Effect detail() {
  Effect e;
  e.name = "detail";
  e.provides = {kResult};
  e.idle = [](const Scene& s, const HairFacts&) { return s.simulation.detail ? "" : "simulation.detail is off"; };
  e.called_for = always("strands are more than the lines that are simulated");
  e.leave_out = [](Scene& s) { s.simulation.detail = false; };
  return e;
}

Effect head_collision() {
  Effect e;
  e.name = "head-collision";
  e.provides = {kResult};
  e.idle = [](const Scene& s, const HairFacts& hair) -> std::string {
    if (!s.simulation.collision.head) return "simulation.collision.head is off";
    return hair.head == nullptr || hair.head->triangles.empty() ? "there is no head" : "";
  };
  e.called_for = [](const Scene& s, const HairFacts& hair) -> Verdict {
    if (hair.strands == nullptr) return {};
    const float gap_m = out_of_reach_m(*hair.strands, extent_of(hair.head->vertices), s.simulation.collision.margin_m);
    if (!(gap_m > 0)) return {true, "hair reaches the head"};
    return {false, fmt::format("the head is {:.2g} m out of the hair's reach", gap_m)};
  };
  e.leave_out = [](Scene& s) { s.simulation.collision.head = false; };
  return e;
}

/// Does it keep its place among the roots?
bool stays(const ColliderCapsule& capsule, const MotionSettings& motion) {
  return capsule.with_head || (capsule.velocity_m_s == glm::vec3(0) && motion.kind == MotionKind::none);
}

Effect capsule_collision(std::size_t index) {
  Effect e;
  e.name = fmt::format("capsule-{}", index);
  e.provides = {kResult};
  e.called_for = [index](const Scene& s, const HairFacts& hair) -> Verdict {
    const ColliderCapsule& capsule = s.simulation.collision.capsules[index];
    if (hair.strands == nullptr) return {};
    if (!stays(capsule, s.simulation.motion)) return {true, "it and the head move past each other"};
    const float gap_m = out_of_reach_m(*hair.strands, capsule, s.simulation.collision.margin_m);
    if (!(gap_m > 0)) return {true, "hair reaches it"};
    return {false, fmt::format("it is {:.2g} m out of the hair's reach", gap_m)};
  };
  // A mark: plan_effects() takes it out when all have been judged.
  e.leave_out = [index](Scene& s) { s.simulation.collision.capsules[index].radius_m = -1; };
  return e;
}

Effect sleep() {
  Effect e =
      of_amount("sleep", {"life.sleep_m_s", [](SimulationSettings& s) -> float& { return s.life.sleep_m_s; }}, nullptr);
  e.called_for = [](const Scene& s, const HairFacts&) -> Verdict {
    if (s.simulation.wind.velocity_m_s != glm::vec3(0)) return {false, "with wind nothing sleeps"};
    return {true, fmt::format("strands slower than {} mm/s for {} s rest, within 5 mm of where they would be",
                              1e3F * s.simulation.life.sleep_m_s, s.simulation.life.sleep_after_s)};
  };
  return e;
}

#define PELAGE_AMOUNT(member)                                          \
  Amount {                                                             \
#member, [](SimulationSettings & s) -> float& { return s.member; } \
  }

std::vector<Effect> between_strands() {
  return {voxel_grid(), on_the_grid(of_amount("friction", PELAGE_AMOUNT(interaction.friction_per_s), judge_friction)),
          on_the_grid(of_amount("repulsion", PELAGE_AMOUNT(interaction.repulsion_m_s2),
                                always("dense hair is pushed apart, also from itself"))),
          shelter(), wind()};
}

}  // namespace

std::vector<Effect> motion_effects(const Scene& scene) {
  std::vector<Effect> all = between_strands();
  all.push_back(always_run("chains", {"chains"}, "strands that are awake follow their roots"));
  all.push_back(of_amount("damping", PELAGE_AMOUNT(chain.damping_per_s), always("small steps damp too little")));
  all.push_back(of_amount("hold-shape", PELAGE_AMOUNT(shape.hold_rad_s), judge_hold));
  all.push_back(of_amount("cone", PELAGE_AMOUNT(shape.cone_deg), always("roots would fold flat")));
  all.push_back(head_collision());
  for (std::size_t i = 0; i < scene.simulation.collision.capsules.size(); ++i) all.push_back(capsule_collision(i));
  all.push_back(of_amount("curls", PELAGE_AMOUNT(shape.curl.radius_m), judge_curls));
  all.push_back(wisps());
  all.push_back(detail());
  all.push_back(of_amount("speed-cap", PELAGE_AMOUNT(life.max_speed_m_s), always("faster vertices are held back")));
  all.push_back(sleep());
  all.push_back(always_run("strands", {"strands"}, "what is drawn, from what is simulated"));
  return all;
}

}  // namespace pelage
