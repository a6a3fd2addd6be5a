// Gates of a picture's effects: called for where they can be seen, with the numbers in the sentence.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>

#include "../shadow/fixture.h"
#include "pelage/data_schema/procedural_strands.h"
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
  // Around a fibre light is up to pi^2 / 4 of its mean.
  EXPECT_THAT(p.at("primary-highlight").why, HasSubstr("adds up to 0.4 "));
  Lit mean;
  mean.scene.strands.azimuth = false;
  EXPECT_THAT(mean.plan().at("primary-highlight").why, HasSubstr("adds up to 0.16 "));
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

/// Irradiance of all lights: a point light of 4 at 2 m is a parallel one of 1.
TEST(PictureGates, LightIsIntensityOverTheSquareOfTheDistance) {
  Lit lit;
  const std::string as_of_one = lit.plan().at("primary-highlight").why;
  lit.scene.lights[0].intensity = 2;
  EXPECT_NE(lit.plan().at("primary-highlight").why, as_of_one);
  lit.scene.lights[0].intensity = 1e-4F;
  EXPECT_FALSE(lit.plan().runs("primary-highlight"));
  float highest = -1;
  for (const glm::vec3& p : lit.hair.vertices) highest = std::max(highest, p.y);
  lit.scene.lights.assign(1, test::light_at({lit.hair.vertices[0].x, highest + 2, lit.hair.vertices[0].z}));
  lit.scene.lights[0].intensity = 4;
  EXPECT_EQ(lit.plan().at("primary-highlight").why, as_of_one);
  lit.scene.lights[0].intensity = 2;
  lit.scene.lights.push_back(lit.scene.lights[0]);
  EXPECT_EQ(lit.plan().at("primary-highlight").why, as_of_one);
}

TEST(PictureGates, ALightOfNoColourIsNone) {
  Lit lit;
  lit.scene.lights[0].colour = glm::vec3(0);
  EXPECT_EQ(lit.plan().at("ambient").why, "the scene has no light");
  EXPECT_FALSE(lit.plan().runs("shadow-map"));
}

TEST(PictureGates, KajiyaKaysHairHasOneHighlight) {
  Lit lit;
  lit.scene.strands.lobes = StrandLobes::kajiya_kay;
  EXPECT_TRUE(lit.plan().at("secondary-highlight").idle);
  EXPECT_TRUE(lit.plan().runs("primary-highlight"));
}

TEST(PictureGates, StraightSegmentsAreNotSmoothed) {
  Lit lit;
  lit.scene.strands.smoothing = 1;
  EXPECT_TRUE(lit.plan().at("smoothing").idle);
}

/// Two locks, or what a test makes of them.
struct LitClusters {
  Scene scene;
  Hairstyle style;
  Mesh head;

  LitClusters() {
    scene.method = Method::satf;
    Cluster c;
    for (int i = 0; i < 5; ++i) c.centre_line.emplace_back(0, -0.05F * static_cast<float>(i), 0);
    c.cross_sections.assign(4, cross_section({0.01F, 0.008F, 0.3F}));
    append_procedural_strands(c, 20, StrandDistribution::uniform, 1);
    style.clusters = {c};
    scene.lights[0].direction = {0.1F, 0.2F, 1};  // from the side: a straight lock does not shade itself
  }
  EffectPlan plan() const { return plan_effects(scene, {nullptr, &style, &head, 0.6F}, Task::picture); }
};

/// A lobe that cannot be seen of strands may be seen of clusters, whose reflectance maps hold up to eight times as
/// much.
TEST(PictureGates, ReflectanceMapsMakeLobesBrighter) {
  LitClusters lit;
  lit.scene.material.secondary_colour = glm::vec3(1);
  lit.scene.material.secondary = kUnseen / 4;
  EXPECT_TRUE(lit.plan().runs("secondary-highlight"));
  lit.scene.material.secondary = kUnseen / 9;
  EXPECT_FALSE(lit.plan().runs("secondary-highlight"));
  EXPECT_FALSE(lit.plan().scene.satf.secondary_highlight);
  Lit strands;
  strands.scene.material = lit.scene.material;
  strands.scene.material.secondary = kUnseen / 4;
  EXPECT_FALSE(strands.plan().runs("secondary-highlight"));
}

TEST(PictureGates, ColoursOfClustersCount) {
  LitClusters lit;
  lit.scene.material.diffuse_colour = glm::vec3(0);
  lit.style.clusters[0].colour = glm::vec3(0);
  EXPECT_FALSE(lit.plan().runs("diffuse"));
  lit.style.clusters[0].colour = {0, 0, 0.5F};
  EXPECT_TRUE(lit.plan().runs("diffuse"));
}

/// Where clusters placed by a matrix are is not known: a point light may be in them.
TEST(PictureGates, PlacedClustersMayBeAtThePointLight) {
  LitClusters lit;
  lit.scene.material.secondary = 1e-4F;
  lit.scene.lights.assign(1, test::light_at({0, 90, 0}));
  EXPECT_FALSE(lit.plan().runs("secondary-highlight"));
  lit.style.clusters.push_back(lit.style.clusters[0]);
  EXPECT_FALSE(lit.plan().runs("secondary-highlight"));
  lit.style.clusters[1].transforms.resize(1);
  EXPECT_TRUE(lit.plan().runs("secondary-highlight"));
}

TEST(PictureGates, OnlyOneClusterByItselfIsWithoutGlobalShadow) {
  LitClusters lit;
  EXPECT_FALSE(lit.plan().runs("global-shadow")) << lit.plan().at("global-shadow").why;
  EXPECT_FALSE(lit.plan().runs("global-shadow-map"));
  EXPECT_FALSE(lit.plan().scene.satf.global_shadow);
  LitClusters two = lit;
  two.style.clusters.push_back(two.style.clusters[0]);
  EXPECT_TRUE(two.plan().runs("global-shadow"));
  LitClusters placed = lit;
  placed.style.clusters[0].transforms.resize(1);
  EXPECT_TRUE(placed.plan().runs("global-shadow"));
  placed.style.clusters[0].transforms.resize(2);
  EXPECT_THAT(placed.plan().at("global-shadow").why, HasSubstr("2 clusters"));
  LitClusters headed = lit;
  headed.head.vertices = {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}};
  headed.head.triangles = {{0, 1, 2}};
  EXPECT_TRUE(headed.plan().runs("global-shadow"));
  LitClusters at_a_point = lit;
  at_a_point.scene.lights.push_back(test::light_at({0, 1, 0}));
  EXPECT_TRUE(at_a_point.plan().runs("global-shadow"));
}

/// The paper's takes depths along the view, which alpha has already; following the light needs the light's own maps.
TEST(PictureGates, OnlyShadowThatFollowsTheLightNeedsItsMaps) {
  LitClusters lit;
  lit.scene.satf.global_shadow = false;
  lit.scene.satf.self_shadow = SelfShadow::light;
  lit.scene.satf.self_shadow_strength = 0;  // the paper's, not the light's
  EXPECT_TRUE(lit.plan().runs("self-shadow"));
  EXPECT_TRUE(lit.plan().runs("s-maps"));
  lit.scene.satf.self_shadow = SelfShadow::paper;
  EXPECT_EQ(lit.plan().at("self-shadow").why, "satf.self_shadow_strength is zero");
  lit.scene.satf.self_shadow_strength = 1;
  EXPECT_TRUE(lit.plan().runs("self-shadow"));
  EXPECT_FALSE(lit.plan().runs("s-maps"));
}

/// Just unseen at a coarse map, hair is seen at a fine one, which does not spread its strands over wide cells.
TEST(PictureGates, SelfShadowIsJudgedByTheResolutionOfItsOwnMap) {
  for (const Method method : {Method::density_map, Method::deep_opacity}) {
    Lit lit;
    lit.scene.method = method;
    const auto runs_at = [&](int density, int opacity) {
      lit.scene.shadow.density_map.resolution = density;
      lit.scene.shadow.opacity_map.resolution = opacity;
      return lit.plan().runs("self-shadow");
    };
    const bool density = method == Method::density_map;
    while (runs_at(8, 8)) lit.opacity *= 0.8F;
    EXPECT_EQ(runs_at(256, 8), density);
    EXPECT_EQ(runs_at(8, 256), !density);
  }
}

TEST(PictureGates, AMapsFactorMakesShadowsDarker) {
  Lit lit;
  while (lit.plan().runs("self-shadow")) lit.opacity *= 0.8F;
  lit.scene.shadow.density_map.factor = 2;
  EXPECT_TRUE(lit.plan().runs("self-shadow"));
  lit.opacity = 0.6F;
  lit.scene.shadow.density_map.factor = 1e-6F;
  EXPECT_FALSE(lit.plan().runs("self-shadow"));
  lit.scene.shadow.density_map.factor = 0;
  EXPECT_THAT(lit.plan().at("self-shadow").why, HasSubstr("factor is zero"));
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

TEST(PictureGates, CountedVerticesPointLightsAndSmoothedStrandsHaveNoBoundSoTheyRun) {
  Lit lit;
  lit.opacity = 1e-6F;
  EXPECT_FALSE(lit.plan().runs("self-shadow"));
  lit.scene.shadow.density_map = DensityMapSettings::printed();
  EXPECT_TRUE(lit.plan().runs("self-shadow"));
  lit.scene.shadow.density_map = {};
  lit.scene.lights[0] = test::light_at({0, 2, 0});
  EXPECT_TRUE(lit.plan().runs("self-shadow"));
  lit.scene.lights[0] = Lit().scene.lights[0];
  lit.scene.strands.smoothing = 4;
  EXPECT_TRUE(lit.plan().runs("self-shadow"));
  lit.scene.effects["smoothing"] = EffectState::off;
  EXPECT_FALSE(lit.plan().runs("self-shadow"));
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
