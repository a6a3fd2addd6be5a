// Gates of a picture's effects: called for where they can be seen, with the numbers in the sentence.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>

#include "../shadow/fixture.h"
#include "pelage/effects/plan.h"
#include "pelage/shadow/hair_shadow.h"

namespace pelage {
namespace {

using ::testing::HasSubstr;

struct Lit {
  Scene scene;
  Strands hair = test::clumped_hair(40);
  Mesh head;
  float opacity = 0.6F;

  Lit() { scene.method = Method::density_map; }
  EffectPlan plan() const { return plan_effects(scene, {&hair, nullptr, &head, opacity}, Task::picture); }
};

TEST(PictureGates, OrdinaryHairCallsForEverything) {
  const Lit lit;
  const EffectPlan p = lit.plan();
  for (const char* const name :
       {"diffuse", "primary-highlight", "secondary-highlight", "ambient", "self-shadow", "shadow-filter"})
    EXPECT_TRUE(p.runs(name)) << name << ": " << p.at(name).why;
  EXPECT_EQ(p.scene.method, Method::density_map);
  EXPECT_THAT(p.at("primary-highlight").why, HasSubstr("adds up to 0.16"));
}

TEST(PictureGates, LobesThatCannotBeSeenAreLeftOut) {
  Lit lit;
  lit.scene.material.secondary = 1e-4F;
  EXPECT_FALSE(lit.plan().runs("secondary-highlight"));
  EXPECT_FALSE(lit.plan().scene.strands.secondary_highlight);
  EXPECT_THAT(lit.plan().at("secondary-highlight").why, HasSubstr("cannot be seen"));
  lit.scene.image.exposure = 100;  // now it can
  EXPECT_TRUE(lit.plan().runs("secondary-highlight"));
  lit.scene.image.exposure = 1;
  lit.scene.lights[0].colour = {0, 0, 100};
  EXPECT_TRUE(lit.plan().runs("secondary-highlight"));
  lit.scene.lights.assign(1, test::light_at({0, 0.1F, 0}));  // a point light in the hair is as bright as can be
  EXPECT_TRUE(lit.plan().runs("secondary-highlight"));
  lit.scene.lights.assign(1, test::light_at({0, 50, 0}));
  EXPECT_FALSE(lit.plan().runs("secondary-highlight"));
  lit.scene.effects["secondary-highlight"] = EffectState::on;
  EXPECT_TRUE(lit.plan().runs("secondary-highlight"));
}

TEST(PictureGates, ColoursOfTheFileCount) {
  Lit lit;
  lit.scene.material.diffuse_colour = glm::vec3(0);
  EXPECT_FALSE(lit.plan().runs("diffuse"));
  lit.hair.colours.assign(lit.hair.count(), glm::vec3(0));
  lit.hair.colours.back() = {0, 0.5F, 0};
  EXPECT_TRUE(lit.plan().runs("diffuse"));
}

TEST(PictureGates, WithoutLightNothingIsShadedNorShadowed) {
  Lit lit;
  lit.scene.lights.clear();
  const EffectPlan p = lit.plan();
  for (const char* const name : {"diffuse", "ambient", "self-shadow", "shadow-map"}) EXPECT_FALSE(p.runs(name)) << name;
  EXPECT_EQ(p.at("diffuse").why, "the scene has no light");
  EXPECT_EQ(p.scene.method, Method::unshadowed);
}

TEST(PictureGates, ShadowsThatNothingTakesAreNotMade) {
  Lit lit;
  for (const char* const name : {"diffuse", "primary-highlight", "secondary-highlight"})
    lit.scene.effects[name] = EffectState::off;
  EXPECT_FALSE(lit.plan().runs("shadow-map"));
  EXPECT_TRUE(lit.plan().runs("ambient"));
  lit.head.vertices = {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}};
  lit.head.triangles = {{0, 1, 2}};
  EXPECT_TRUE(lit.plan().runs("shadow-map"));  // the head takes them
}

/// Wherever a gate says that nobody sees the shadow, none of the light that the map would stop is more than the bound.
TEST(PictureGates, SelfShadowIsSkippedOnlyWithinItsBound) {
  int skipped = 0, run = 0;
  for (int trial = 0; trial < 60; ++trial) {
    Lit lit;
    lit.scene.method = std::array{Method::density_map, Method::deep_opacity, Method::opacity_shadow}[trial % 3];
    lit.scene.shadow.density_map.resolution = 16 << (trial % 4);
    lit.scene.shadow.opacity_map.resolution = 32 << (trial % 3);
    lit.hair = test::clumped_hair(static_cast<std::size_t>(1 + trial), static_cast<unsigned>(trial + 1));
    lit.opacity = std::pow(10.0F, -0.12F * static_cast<float>(trial % 40));
    lit.scene.lights[0].direction = {std::sin(static_cast<float>(trial)), 0.3F, std::cos(static_cast<float>(trial))};
    if (lit.plan().runs("self-shadow")) {
      ++run;
      continue;
    }
    ++skipped;
    const auto shadow =
        make_shadow(lit.scene.method, lit.scene.shadow, lit.hair, lit.opacity, lit.scene.lights.front());
    std::vector<float> through(lit.hair.vertices.size());
    shadow->transmittance(lit.hair.vertices, through);
    for (const float t : through) EXPECT_GE(t, 1 - kUnseenShare) << "trial " << trial;
  }
  EXPECT_GT(skipped, 5);
  EXPECT_GT(run, 5);
}

TEST(PictureGates, CountedVerticesAndPointLightsHaveNoBoundSoTheyRun) {
  Lit lit;
  lit.opacity = 1e-6F;
  EXPECT_FALSE(lit.plan().runs("self-shadow"));
  lit.scene.shadow.density_map = DensityMapSettings::printed();
  EXPECT_TRUE(lit.plan().runs("self-shadow"));
  lit.scene.shadow.density_map = {};
  lit.scene.lights[0] = test::light_at({0, 2, 0});
  EXPECT_TRUE(lit.plan().runs("self-shadow"));
}

TEST(PictureGates, SmoothingIsSkippedWhereTheCameraCannotTell) {
  Lit lit;
  lit.scene.strands.smoothing = 4;
  EXPECT_TRUE(lit.plan().runs("smoothing"));  // no camera: nothing is known
  lit.scene.camera = Camera{{0, 0, 1}, {0, 0, 0}};
  EXPECT_TRUE(lit.plan().runs("smoothing"));
  lit.scene.camera = Camera{{0, 0, 500}, {0, 0, 0}};
  EXPECT_FALSE(lit.plan().runs("smoothing"));
  EXPECT_EQ(lit.plan().scene.strands.smoothing, 1);
  lit.scene.image.height = 16384;
  lit.scene.image.supersampling = 8;
  EXPECT_TRUE(lit.plan().runs("smoothing"));
}

TEST(PictureGates, TheTruthLeavesNothingOut) {
  Lit lit;
  lit.scene.method = Method::truth;
  lit.scene.material.secondary = 1e-7F;
  EXPECT_TRUE(lit.plan().runs("secondary-highlight"));
  lit.scene.effects["secondary-highlight"] = EffectState::off;
  EXPECT_FALSE(lit.plan().scene.strands.secondary_highlight);
}

}  // namespace
}  // namespace pelage
