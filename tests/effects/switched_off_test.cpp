// Off is nothing: no call, no memory, and the same bits as the effect with a zero parameter.
#include <gtest/gtest.h>

#include "../simulate/moving.h"
#include "counted_allocations.h"
#include "pelage/effects/plan.h"
#include "pelage/simulate/head_motion.h"
#include "pelage/simulate/moving_hair.h"

namespace pelage {
namespace {

SimulationSettings busy() {
  SimulationSettings s = simulation_preset("wavy");
  s.interaction.friction_per_s = 4;
  s.interaction.repulsion_m_s2 = 1;
  s.wind.velocity_m_s = {3, 0, 1};
  s.wind.shelter = 1;
  s.shape.hold_rad_s = 5;
  s.shape.cone_deg = 40;
  s.shape.curl.radius_m = 0.003F;
  s.wisps = 8;
  s.life.max_speed_m_s = 5;
  ColliderCapsule c;
  c.from = c.to = {0.15F, 1.6F, 0};
  c.with_head = true;
  s.collision.capsules = {c};
  return s;
}

struct End {
  std::uint64_t hash;
  std::vector<glm::vec3> hair;
  SimulationFacts facts;
};

End run(const SimulationSettings& settings) {
  MovingHair hair(ball_of_hair(120, 12), {}, settings);
  for (int k = 1; k <= 20; ++k) hair.advance(1.0 / 60, head_pose(settings.motion, hair.pivot(), k / 60.0));
  return {hair.simulation().state_hash(), hair.hair().vertices, hair.simulation().facts()};
}

/// The zero that a person would write into the scene file.
struct Zero {
  const char* effect;
  void (*set)(SimulationSettings&);
};
const Zero kZeros[] = {
    {"friction", [](SimulationSettings& s) { s.interaction.friction_per_s = 0; }},
    {"repulsion", [](SimulationSettings& s) { s.interaction.repulsion_m_s2 = 0; }},
    {"wind", [](SimulationSettings& s) { s.wind.drag_per_s = 0; }},  // off takes the velocity away instead
    {"shelter", [](SimulationSettings& s) { s.wind.shelter = 0; }},
    {"damping", [](SimulationSettings& s) { s.chain.damping_per_s = 0; }},
    {"hold-shape", [](SimulationSettings& s) { s.shape.hold_rad_s = 0; }},
    {"cone", [](SimulationSettings& s) { s.shape.cone_deg = 0; }},
    {"curls", [](SimulationSettings& s) { s.shape.curl.radius_m = 0; }},
    {"wisps", [](SimulationSettings& s) { s.wisps = 0; }},
    {"speed-cap", [](SimulationSettings& s) { s.life.max_speed_m_s = 1e9F; }},  // one that nothing reaches
    {"capsule-0", [](SimulationSettings& s) { s.collision.capsules.clear(); }},
    {"sleep", [](SimulationSettings& s) { s.life.sleep_m_s = 1e-30F; }},  // a speed that nothing is below
};

class SwitchedOff : public ::testing::TestWithParam<Zero> {};

TEST_P(SwitchedOff, IsBitForBitTheEffectWithAZeroParameter) {
  Scene scene;
  scene.simulation = busy();
  if (std::string(GetParam().effect) == "sleep") scene.simulation.wind.velocity_m_s = glm::vec3(0);
  const Strands hair = ball_of_hair(120, 12);
  const HairFacts facts{&hair, nullptr, nullptr, 0.6F};
  SimulationSettings zero = plan_effects(scene, facts, Task::motion).scene.simulation;
  scene.effects[GetParam().effect] = EffectState::off;
  const EffectPlan off = plan_effects(scene, facts, Task::motion);
  ASSERT_FALSE(off.runs(GetParam().effect));
  const End with = run(zero);
  GetParam().set(zero);
  const End a = run(off.scene.simulation), b = run(zero);
  EXPECT_EQ(a.hash, b.hash);
  EXPECT_EQ(a.hair, b.hair);
  if (std::string(GetParam().effect) == "sleep" || std::string(GetParam().effect) == "speed-cap") return;
  EXPECT_TRUE(a.hash != with.hash || a.hair != with.hair) << "it did nothing in the first place";
}

INSTANTIATE_TEST_SUITE_P(Motion, SwitchedOff, ::testing::ValuesIn(kZeros), [](const auto& tested) {
  std::string name = tested.param.effect;
  std::erase(name, '-');
  return name;
});

TEST(SwitchedOff, WithoutNeighboursThereIsNoGrid) {
  Scene scene;
  scene.simulation = busy();
  for (const char* const name : {"friction", "repulsion", "shelter"}) scene.effects[name] = EffectState::off;
  const Strands hair = ball_of_hair(120, 12);
  const EffectPlan p = plan_effects(scene, {&hair, nullptr, nullptr, 0.6F}, Task::motion);
  EXPECT_FALSE(p.runs("voxel-grid"));
  const End end = run(p.scene.simulation);
  EXPECT_EQ(end.facts.grid_builds, 0U);
  EXPECT_EQ(end.facts.grid_bytes, 0U);
  EXPECT_GT(end.facts.grid_applies, 0U);  // the wind alone
  scene.effects["wind"] = EffectState::off;
  const End calm = run(plan_effects(scene, {&hair, nullptr, nullptr, 0.6F}, Task::motion).scene.simulation);
  EXPECT_EQ(calm.facts.grid_applies, 0U);
  EXPECT_EQ(calm.facts.grid_ms, 0);
}

/// Settings for hair that never heard of the effect.
std::uint64_t allocations_of(const SimulationSettings& settings) {
  const Strands hair = ball_of_hair(120, 12);
  const std::uint64_t before = test::allocations();
  MovingHair m(hair, {}, settings);
  m.advance(1.0 / 60, {m.pivot(), glm::dquat(1, 0, 0, 0)});
  m.hair();
  return test::allocations() - before;
}

TEST(SwitchedOff, AllocatesNothing) {
  SimulationSettings plain = bare(false);
  plain.life.sleep_m_s = 0;
  allocations_of(plain);  // what a process does once: pools of threads
  const std::uint64_t none = allocations_of(plain);
  Scene scene;
  scene.simulation = busy();
  scene.simulation.name = plain.name;
  for (const std::string& name : effect_names(scene)) scene.effects[name] = EffectState::off;
  scene.effects["damping"] = scene.effects["detail"] = EffectState::on;  // plain has them
  const Strands hair = ball_of_hair(120, 12);
  const EffectPlan off = plan_effects(scene, {&hair, nullptr, nullptr, 0.6F}, Task::motion);
  EXPECT_EQ(allocations_of(off.scene.simulation), none);
  EXPECT_GT(allocations_of(scene.simulation), none);
}

}  // namespace
}  // namespace pelage
