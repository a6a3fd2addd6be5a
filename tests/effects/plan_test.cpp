// From what is asked to what runs: on made-up effects, so that every rule is seen alone.
#include "pelage/effects/plan.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <fstream>
#include <nlohmann/json.hpp>

namespace pelage {
namespace {

using ::testing::HasSubstr;

/// Leaving one out writes its name, so that a test sees which were.
Effect effect(const std::string& name, std::vector<std::string> needs, std::vector<std::string> uses,
              std::vector<std::string> provides, bool called_for = true) {
  Effect e;
  e.name = name;
  e.needs = std::move(needs);
  e.uses = std::move(uses);
  e.provides = std::move(provides);
  e.called_for = [called_for](const Scene&, const HairFacts&) { return Verdict{called_for, "the scene"}; };
  e.leave_out = [name](Scene& s) { s.hair += name + ";"; };
  return e;
}

Effect pass(const std::string& name, std::vector<std::string> uses, std::vector<std::string> provides) {
  Effect e = effect(name, {}, std::move(uses), std::move(provides));
  e.pass = true;
  e.called_for = nullptr;
  e.leave_out = nullptr;
  return e;
}

/// grid <- friction -> result;  map <- shadow -> light <- lobe -> result
std::vector<Effect> small_world(bool shadow_called_for = true) {
  return {pass("grid", {}, {"grid"}), effect("friction", {"grid"}, {}, {kResult}), pass("map", {}, {"map"}),
          effect("shadow", {"map"}, {}, {"light"}, shadow_called_for), effect("lobe", {}, {"light"}, {kResult})};
}

EffectPlan plan(std::vector<Effect> effects, const EffectStates& asked) {
  Scene scene;
  scene.effects = asked;
  return plan_effects(std::move(effects), scene, {});
}

TEST(Plan, EverythingThatIsCalledForRuns) {
  const EffectPlan p = plan(small_world(), {});
  for (const PlannedEffect& e : p.effects) EXPECT_TRUE(e.runs) << e.effect.name;
  EXPECT_EQ(p.scene.hair, "");
  EXPECT_EQ(p.at("grid").why, "needed by friction");
}

TEST(Plan, WhatIsOffIsLeftOutAndWhatOnlyItNeededDoesNotRun) {
  const EffectPlan p = plan(small_world(), {{"friction", EffectState::off}});
  EXPECT_FALSE(p.runs("friction"));
  EXPECT_FALSE(p.runs("grid"));
  EXPECT_TRUE(p.runs("map"));
  EXPECT_EQ(p.scene.hair, "friction;");
  EXPECT_EQ(p.at("grid").why, "nothing that runs needs it");
}

TEST(Plan, WhatNothingTakesDoesNotRun) {
  const EffectPlan p = plan(small_world(), {{"lobe", EffectState::off}});
  EXPECT_FALSE(p.runs("shadow"));
  EXPECT_FALSE(p.runs("map"));
  EXPECT_TRUE(p.at("shadow").called_for);
  EXPECT_THAT(p.at("shadow").why, HasSubstr("takes its light"));
  EXPECT_EQ(p.scene.hair, "shadow;lobe;");
}

TEST(Plan, OnRunsWhatTheSceneDoesNotCallForAndAutoDoesNot) {
  EXPECT_FALSE(plan(small_world(false), {}).runs("shadow"));
  EXPECT_FALSE(plan(small_world(false), {{"shadow", EffectState::automatic}}).runs("map"));
  const EffectPlan on = plan(small_world(false), {{"shadow", EffectState::on}});
  EXPECT_TRUE(on.runs("shadow"));
  EXPECT_TRUE(on.runs("map"));
  EXPECT_FALSE(on.at("shadow").called_for);
}

TEST(Plan, WhatLacksSomethingDoesNotRunEvenIfOn) {
  std::vector<Effect> world{effect("tangents", {}, {}, {"tangents"}), effect("highlight", {"tangents"}, {}, {kResult})};
  const EffectPlan p = plan(world, {{"tangents", EffectState::off}, {"highlight", EffectState::on}});
  EXPECT_FALSE(p.runs("highlight"));
  EXPECT_EQ(p.at("highlight").why, "there is no tangents");
}

TEST(Plan, SettingsThatLeaveNothingToRunSayWhyWhateverIsAsked) {
  std::vector<Effect> world = small_world();
  world[1].idle = [](const Scene&, const HairFacts&) { return "friction_per_s is zero"; };
  for (const EffectState asked : {EffectState::on, EffectState::off, EffectState::automatic}) {
    const EffectPlan p = plan(world, {{"friction", asked}});
    EXPECT_FALSE(p.runs("friction"));
    EXPECT_TRUE(p.at("friction").idle);
    EXPECT_EQ(p.at("friction").why, "friction_per_s is zero");
    EXPECT_FALSE(p.runs("grid"));
  }
}

/// Wind that is off keeps nothing awake, whoever left it out.
TEST(Plan, EffectsAreJudgedWithoutThoseBeforeThemThatDoNotRun) {
  Scene scene;
  scene.simulation.life.sleep_m_s = 0.002F;
  scene.simulation.wind.velocity_m_s = {4, 0, 1};
  EXPECT_FALSE(plan_effects(scene, {}, Task::motion).runs("sleep"));
  scene.effects["wind"] = EffectState::off;
  EXPECT_TRUE(plan_effects(scene, {}, Task::motion).runs("sleep"));
}

TEST(Plan, PassesCannotBeSwitched) {
  EXPECT_TRUE(plan(small_world(), {{"grid", EffectState::off}}).runs("grid"));
}

/// Not even one that the result is for, which nothing else needs.
TEST(Plan, TheDrawingItselfCannotBeSwitched) {
  std::vector<Effect> world = small_world();
  world.push_back(pass("draw", {"light"}, {kResult}));
  for (const EffectState asked : {EffectState::off, EffectState::on}) {
    const EffectPlan p = plan(world, {{"draw", asked}});
    EXPECT_TRUE(p.runs("draw"));
    EXPECT_EQ(p.at("draw").asked, EffectState::automatic);
  }
}

TEST(Plan, APassWithNothingToRunIsNotRunAndOffersNothing) {
  std::vector<Effect> world = small_world();
  world[2].idle = [](const Scene&, const HairFacts&) { return "there is nothing to map"; };
  const EffectPlan p = plan(world, {});
  EXPECT_FALSE(p.runs("shadow"));
  EXPECT_EQ(p.at("shadow").why, "there is no map");
  EXPECT_FALSE(p.runs("map"));
  EXPECT_EQ(p.at("map").why, "there is nothing to map");
  // Something else that runs takes it where it is: it is not.
  world[4].uses = {"light", "map"};
  EXPECT_FALSE(plan(world, {}).runs("map"));
}

TEST(Plan, RealEffectsComeAfterWhatTheyNeedAndAllOfItIsProvided) {
  Scene scene;
  scene.simulation.collision.capsules.resize(2);
  for (const Method method : {Method::satf, Method::density_map, Method::deep_opacity, Method::truth}) {
    scene.method = method;
    for (const auto& all : {picture_effects(scene), motion_effects(scene)}) {
      std::vector<std::string> there;
      for (const Effect& e : all) {
        for (const std::string& need : e.needs) EXPECT_THAT(there, ::testing::Contains(need)) << e.name;
        there.insert(there.end(), e.provides.begin(), e.provides.end());
        EXPECT_EQ(e.pass, !e.leave_out) << e.name;
      }
    }
  }
}

TEST(Plan, TheSchemaNamesTheEffectsThatThereAre) {
  std::ifstream in(PELAGE_SOURCE_DIR "/data_schema/schemas/scene.schema.json");
  const auto schema = nlohmann::json::parse(in);
  std::vector<std::string> documented;
  for (const auto& [name, node] : schema["properties"]["effects"]["properties"].items()) documented.push_back(name);
  EXPECT_THAT(effect_names(Scene{}), ::testing::UnorderedElementsAreArray(documented));
}

}  // namespace
}  // namespace pelage
