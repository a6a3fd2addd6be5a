// Pictures with effects switched: what is off is not run and cannot be told from a zero parameter; what auto leaves out
// nobody can see.
#include <gtest/gtest.h>

#include "../render/strands.h"
#include "counted_allocations.h"
#include "pelage/effects/plan.h"
#include "pelage/image/tone.h"

namespace pelage {
namespace {

class Drawn : public test::WithOpenGl {
 protected:
  Drawn() {
    scene_.method = Method::density_map;
    scene_.shadow.density_map.resolution = 32;
    scene_.camera = Camera{{0, 0, 0.6F}, {0, 0, 0}};
    scene_.image.width = scene_.image.height = 64;
    scene_.image.supersampling = 1;
  }

  EffectPlan plan(const Scene& scene) const {
    return plan_effects(scene, {&hair_, nullptr, nullptr, opacity_}, Task::picture);
  }
  static StrandFrameSettings settings_of(const Scene& s) {
    return {*s.camera, s.lights, s.material, s.method, s.strands, s.shadow};
  }
  Image picture(const Scene& planned) {
    if (!frame_) frame_.emplace(hair_, opacity_, Mesh{});
    Image image = test::checked(frame_->render(settings_of(planned), 64, 64, 1));
    compose_over(image, glm::vec3(0.85F));
    return image;
  }
  Scene without(const char* effect) const {
    Scene scene = scene_;
    scene.effects[effect] = EffectState::off;
    return plan(scene).scene;
  }

  Strands hair_ = test::strand_lock(200);
  float opacity_ = 0.6F;
  std::optional<StrandFrame> frame_;
  Scene scene_;
};

TEST_F(Drawn, OffIsBitForBitAZeroParameter) {
  const Image with = picture(plan(scene_).scene);
  const auto expect_same = [&](const char* effect, const Scene& zero) {
    const Image a = picture(without(effect)), b = picture(zero);
    EXPECT_EQ(a.rgba, b.rgba) << effect;
    EXPECT_NE(a.rgba, with.rgba) << effect << " did nothing in the first place";
  };
  Scene zero = scene_;
  zero.shadow.density_map.factor = 0;  // a map is built, and is empty
  expect_same("self-shadow", zero);
  zero = scene_, zero.material.diffuse = 0;
  expect_same("diffuse", zero);
  zero = scene_, zero.material.primary = 0;
  expect_same("primary-highlight", zero);
  zero = scene_, zero.material.secondary = 0;
  expect_same("secondary-highlight", zero);
  zero = scene_, zero.material.ambient = 0;
  expect_same("ambient", zero);
  zero = scene_, zero.shadow.density_map.filter = false;
  expect_same("shadow-filter", zero);
}

/// What a picture of hair that was never shadowed allocates, and keeps.
TEST_F(Drawn, WithoutSelfShadowNothingIsAllocatedForIt) {
  const auto cost = [&](const Scene& first, const Scene& second) {
    frame_.emplace(hair_, opacity_, test::wall());
    picture(first);
    const std::uint64_t before = test::allocations();
    picture(second);
    return std::pair(test::allocations() - before, test::allocated_bytes());
  };
  Scene never = scene_;
  never.method = Method::unshadowed;
  const Scene with = plan(scene_).scene;
  never = plan(never).scene;
  picture(with), picture(never);  // what drivers and threads make once is made
  const std::int64_t kept = cost(never, never).second;
  EXPECT_EQ(cost(never, without("self-shadow")).first, cost(never, never).first);
  EXPECT_GT(cost(never, with).first, cost(never, never).first);
  // A map of 32 x 32 x 32 cells takes 128 KiB and more: it is given back.
  EXPECT_LT(cost(with, without("self-shadow")).second, kept + 100'000);
  EXPECT_GT(cost(never, with).second, kept + 100'000);
}

/// A head drawn in the shadow of hair is not when the shadow goes.
TEST_F(Drawn, ShadowsThatAreSwitchedOffLeaveTheHeadToo) {
  frame_.emplace(hair_, opacity_, test::wall());
  const Image never = picture(without("self-shadow"));
  const Image with = picture(plan(scene_).scene);
  EXPECT_NE(with.rgba, never.rgba);
  EXPECT_EQ(picture(without("self-shadow")).rgba, never.rgba);
  EXPECT_EQ(picture(plan(scene_).scene).rgba, with.rgba);
}

TEST_F(Drawn, WhatIsOffIsNotRun) {
  scene_.strands.smoothing = 4;
  Scene scene = scene_;
  scene.effects["self-shadow"] = scene.effects["smoothing"] = EffectState::off;
  frame_.emplace(hair_, opacity_, Mesh{});
  picture(plan(scene).scene);
  for (const char* const stage : {"smooth", "fill", "transmittance", "filter"}) {
    EXPECT_EQ(frame_->ledger().calls(stage), 0U) << stage;
    for (const Stage& s : frame_->ledger().stages()) EXPECT_NE(s.name, stage);
  }
  scene_.effects["smoothing"] = EffectState::on;  // from here its curves cannot be told from segments
  picture(plan(scene_).scene);
  EXPECT_EQ(frame_->ledger().calls("fill"), 1U);
  EXPECT_EQ(frame_->ledger().calls("smooth"), 1U);
}

/// Greatest change of an 8-bit value.
int steps(const Image& a, const Image& b) {
  const auto x = to_srgb8(a), y = to_srgb8(b);
  int most = 0;
  for (std::size_t i = 0; i < x.size(); ++i) most = std::max(most, std::abs(int{x[i]} - int{y[i]}));
  return most;
}

TEST_F(Drawn, WhatAutoLeavesOutChangesNoEightBitValueByMoreThanOne) {
  // Each lobe as strong as its gate lets pass, on black hair over black, where steps are finest.
  const auto just_unseen = [&](float HairMaterial::*strength, const char* effect, const HairMaterial& dark) {
    Scene scene = scene_;
    scene.material = dark;
    scene.lights[0].direction = {0, 0.1F, 1};
    scene.image.background = glm::vec3(0);
    scene.material.*strength = 1;
    while (plan(scene).runs(effect)) scene.material.*strength *= 0.95F;
    Scene on = scene;
    on.effects[effect] = EffectState::on;
    ASSERT_TRUE(plan(on).runs(effect));
    EXPECT_LE(steps(picture(plan(scene).scene), picture(plan(on).scene)), 1) << effect;
    scene.material.*strength *= 1e4F;
    on.material.*strength *= 1e4F;
    on.effects[effect] = EffectState::off;
    EXPECT_GT(steps(picture(plan(scene).scene), picture(plan(on).scene)), 1) << effect << ": seen where it is strong";
  };
  HairMaterial dark;
  dark.diffuse_colour = glm::vec3(0.02F);
  dark.diffuse = dark.primary = dark.secondary = dark.ambient = 0;
  just_unseen(&HairMaterial::diffuse, "diffuse", dark);
  just_unseen(&HairMaterial::primary, "primary-highlight", dark);
  just_unseen(&HairMaterial::secondary, "secondary-highlight", dark);
  just_unseen(&HairMaterial::ambient, "ambient", dark);
}

TEST_F(Drawn, ShadowsThatAutoLeavesOutCannotBeSeen) {
  opacity_ = 0.6F;
  while (plan(scene_).runs("self-shadow")) opacity_ *= 0.9F;
  scene_.material = material_preset("grey");
  Scene on = scene_;
  on.effects["self-shadow"] = EffectState::on;
  ASSERT_TRUE(plan(on).runs("self-shadow"));
  EXPECT_LE(steps(picture(plan(scene_).scene), picture(plan(on).scene)), 1);
}

class DrawnClusters : public test::WithOpenGl {
 protected:
  static Scene scene() {
    Scene s;
    s.method = Method::satf;
    s.satf.shadow_resolution = 24;
    s.camera = Camera{{0, 0, 0.6F}, {0, 0, 0}};
    return s;
  }
  static EffectPlan plan(const Scene& s, const Hairstyle& style) {
    return plan_effects(s, {nullptr, &style, nullptr, style.opacity}, Task::picture);
  }
  static Image picture(SatfFrame& frame, const Scene& s) {
    return test::checked(frame.render({*s.camera, s.lights, s.material, s.satf}, 64, 64, 1));
  }
};

TEST_F(DrawnClusters, WithoutShadowsNoMapOfThemIsMade) {
  const Hairstyle style = test::three_locks();
  const auto frame = test::frame_of(style);
  Scene s = scene();
  s.effects["self-shadow"] = s.effects["global-shadow"] = EffectState::off;
  const EffectPlan p = plan(s, style);
  EXPECT_FALSE(p.runs("s-maps"));
  EXPECT_FALSE(p.runs("global-shadow-map"));
  const Image off = picture(*frame, p.scene);
  EXPECT_EQ(frame->ledger().calls("s-maps"), 0U);
  EXPECT_EQ(frame->ledger().calls("shadow map"), 0U);
  const Image on = picture(*frame, plan(scene(), style).scene);
  EXPECT_EQ(frame->ledger().calls("s-maps"), 1U);
  EXPECT_NE(off.rgba, on.rgba);
  Scene zero = s;
  zero.effects.clear();
  zero.effects["global-shadow"] = EffectState::off;
  zero.satf.self_shadow = SelfShadow::paper;
  zero.satf.self_shadow_strength = 0;
  EXPECT_EQ(picture(*frame, plan(zero, style).scene).rgba, off.rgba);
  zero.satf.self_shadow_strength = 1;  // the paper's takes its depths from alpha
  EXPECT_NE(picture(*frame, plan(zero, style).scene).rgba, off.rgba);
  EXPECT_EQ(frame->ledger().calls("s-maps"), 1U);
}

TEST_F(DrawnClusters, LobesThatAreOffAreBitForBitOfStrengthZero) {
  const Hairstyle style = test::three_locks();
  const auto frame = test::frame_of(style);
  const Image with = picture(*frame, plan(scene(), style).scene);
  const std::pair<const char*, float HairMaterial::*> lobes[] = {{"diffuse", &HairMaterial::diffuse},
                                                                 {"primary-highlight", &HairMaterial::primary},
                                                                 {"secondary-highlight", &HairMaterial::secondary},
                                                                 {"ambient", &HairMaterial::ambient}};
  for (const auto& [effect, strength] : lobes) {
    Scene off = scene(), zero = scene();
    off.effects[effect] = EffectState::off;
    zero.material.*strength = 0;
    const Image a = picture(*frame, plan(off, style).scene);
    EXPECT_EQ(a.rgba, picture(*frame, zero).rgba) << effect;
    EXPECT_NE(a.rgba, with.rgba) << effect;
  }
}

TEST_F(DrawnClusters, OneStraightClusterCallsForNoGlobalShadowAndOneWithAFoldDoes) {
  Scene s = scene();
  s.lights[0].direction = {0.1F, 0.2F, 1};
  Hairstyle style = test::straight_lock();
  EXPECT_FALSE(plan(s, style).runs("global-shadow")) << plan(s, style).at("global-shadow").why;
  style.division.plates = 24;
  Cluster& c = style.clusters[0];
  c.centre_line.clear();
  for (int i = 0; i <= 8; ++i) {
    const float a = 3.1415927F * static_cast<float>(i) / 8;
    c.centre_line.emplace_back(0, 0.05F * std::sin(a), 0.05F * std::cos(a));
  }
  EXPECT_TRUE(plan(s, style).runs("global-shadow"));
  const auto frame = test::frame_of(style);
  Scene off = s;
  off.effects["global-shadow"] = EffectState::off;
  const auto a = picture(*frame, plan(s, style).scene), b = picture(*frame, plan(off, style).scene);
  EXPECT_GT(test::difference(a, b).most, 0.01);  // leaving it out because there is one cluster would be seen
  EXPECT_TRUE(plan(s, test::three_locks()).runs("global-shadow"));
}

}  // namespace
}  // namespace pelage
