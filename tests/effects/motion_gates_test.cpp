// Gates of the motion's effects, against simulating with and without: the bounds hold where they are hardest to hold.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <glm/geometric.hpp>

#include "../simulate/moving.h"
#include "pelage/effects/plan.h"
#include "pelage/simulate/head_motion.h"
#include "pelage/simulate/moving_hair.h"

namespace pelage {
namespace {

using ::testing::HasSubstr;

Strands hanging(std::size_t strands, float apart_m, float length_m = 0.3F) {
  Strands s;
  s.diameter_m = 1e-4F;
  for (std::size_t k = 0; k < strands; ++k) {
    std::vector<glm::vec3> line;
    for (int i = 0; i < 16; ++i)
      line.emplace_back(apart_m * static_cast<float>(k), 1.6F - length_m * static_cast<float>(i) / 15, 0);
    s.append(line);
  }
  return s;
}

/// 0.3 m of one strand in turns 1 cm wide, 3 mm apart.
Strands helix() {
  Strands s;
  s.diameter_m = 1e-4F;
  std::vector<glm::vec3> line;
  for (int i = 0; i < 96; ++i) {
    const float turn = static_cast<float>(i) / 10 * 6.2831853F;
    line.emplace_back(0.005F * std::cos(turn), 1.6F - 0.0003F * static_cast<float>(i), 0.005F * std::sin(turn));
  }
  s.append(line);
  return s;
}

Scene scene_of(const SimulationSettings& settings) {
  Scene scene;
  scene.simulation = settings;
  return scene;
}

EffectPlan plan_of(const Scene& scene, const Strands& hair, const Mesh& head = {}) {
  return plan_effects(scene, {&hair, nullptr, &head, 0.6F}, Task::motion);
}

/// Hair after `seconds` of a motion at 60 frames per second.
Strands moved(const Strands& hair, const SimulationSettings& settings, MotionKind kind, double seconds) {
  MotionSettings motion;
  motion.kind = kind;
  MovingHair m(hair, {}, settings);
  for (int k = 1; k <= static_cast<int>(60 * seconds); ++k) m.advance(1.0 / 60, head_pose(motion, m.pivot(), k / 60.0));
  return m.hair();
}

/// Pushed to and fro by 3 cm, twice a second: a head that turns about a lone strand's root would not move it.
Strands pushed(const Strands& hair, const SimulationSettings& settings, double seconds) {
  MovingHair m(hair, {}, settings);
  for (int k = 1; k <= static_cast<int>(60 * seconds); ++k)
    m.advance(1.0 / 60, {m.pivot() + glm::dvec3(0.03 * std::sin(12.6 * k / 60), 0, 0), glm::dquat(1, 0, 0, 0)});
  return m.hair();
}

float farthest(const Strands& a, const Strands& b) {
  float most = 0;
  for (std::size_t v = 0; v < a.vertices.size(); ++v)
    most = std::max(most, glm::distance(a.vertices[v], b.vertices[v]));
  return most;
}

TEST(MotionGates, AGroomCallsForItsNeighboursAndASingleStrandHasNone) {
  const Scene scene = scene_of(simulation_preset("loose"));
  const EffectPlan groom = plan_of(scene, ball_of_hair(200, 16));
  EXPECT_TRUE(groom.runs("friction"));
  EXPECT_TRUE(groom.runs("repulsion"));
  EXPECT_TRUE(groom.runs("voxel-grid"));
  const EffectPlan lone = plan_of(scene, hanging(1, 0));
  EXPECT_FALSE(lone.runs("friction"));
  EXPECT_EQ(lone.scene.simulation.interaction.friction_per_s, 0);
  EXPECT_TRUE(lone.runs("repulsion"));  // of a strand from itself
  SimulationSettings rubs = simulation_preset("loose");
  rubs.interaction.repulsion_m_s2 = 0;
  EXPECT_FALSE(plan_of(scene_of(rubs), hanging(1, 0)).runs("voxel-grid"));
  EXPECT_FALSE(plan_of(scene, hanging(5, 0.65F)).runs("friction"));  // 2 x 0.3 m and four cells of 1 cm
  EXPECT_TRUE(plan_of(scene, hanging(5, 0.63F)).runs("friction"));
}

/// What is skipped is what strands do to each other, and that is nothing: a strand far from all others moves as it does
/// alone. Density is measured against the hair's own, so repulsion and friction see the same.
TEST(MotionGates, StrandsOutOfReachDoNothingToEachOther) {
  SimulationSettings s = bare();
  s.interaction.repulsion_m_s2 = 1;
  const Strands two = hanging(2, 0.7F), one = hanging(1, 0);
  ASSERT_FALSE(plan_of(scene_of(s), two).runs("friction"));
  MovingHair with(two, {}, s), alone(one, {}, s);
  for (int k = 1; k <= 60; ++k) {
    const glm::dvec3 shift(0.03 * std::sin(k / 5.0), 0, 0);
    with.advance(1.0 / 60, {with.pivot() + shift, glm::dquat(1, 0, 0, 0)});
    alone.advance(1.0 / 60, {alone.pivot() + shift, glm::dquat(1, 0, 0, 0)});
  }
  const Strands& a = with.hair();
  const Strands& b = alone.hair();
  // The pivots lie 0.35 m apart, 35 cells, so that the cells are the same: what is left is rounding.
  for (std::size_t v = 0; v < 16; ++v) EXPECT_LT(glm::distance(a.vertices[v], b.vertices[v]), 1e-4F) << v;
}

/// Self-friction of a lone strand is what `auto` saves; it is small beside the motion, also where the strand is a helix
/// that passes through each cell several times.
TEST(MotionGates, WhatALoneStrandLosesIsSmall) {
  SimulationSettings with = bare(), without = with;
  without.interaction.friction_per_s = without.interaction.repulsion_m_s2 = 0;
  with.interaction.repulsion_m_s2 = 0;
  with.vertices = without.vertices = 96;
  for (const Strands& lone : {hanging(1, 0), helix()}) {
    const float off = farthest(pushed(lone, with, 1), pushed(lone, without, 1));
    std::printf("friction of a lone strand with itself: %.3g mm after a second of pushing\n",
                1e3 * static_cast<double>(off));
    EXPECT_LT(off, 1e-4F);
    EXPECT_GT(farthest(pushed(lone, with, 1), lone), 0.02F);
  }
}

/// A strand that lies close to itself is pushed apart by repulsion, by many times its width.
TEST(MotionGates, ALoneStrandMayRepelItself) {
  SimulationSettings s = bare();
  s.interaction.repulsion_m_s2 = 4;
  s.vertices = 96;
  const EffectPlan p = plan_of(scene_of(s), helix());
  EXPECT_TRUE(p.runs("repulsion"));
  SimulationSettings without = s;
  without.interaction.repulsion_m_s2 = 0;
  EXPECT_GT(farthest(pushed(helix(), s, 1), pushed(helix(), without, 1)), helix().diameter_m);
}

TEST(MotionGates, CapsulesOutOfReachChangeNotABit) {
  SimulationSettings s = bare();
  s.motion.kind = MotionKind::none;
  ColliderCapsule near_by, far_off;
  near_by.from = near_by.to = {0.05F, 1.3F, 0};
  far_off.from = {3, 1, 0}, far_off.to = {3, 2, 0};
  far_off.with_head = true;
  s.collision.capsules = {far_off, near_by};
  const Strands hair = ball_of_hair(100, 12);
  const EffectPlan p = plan_of(scene_of(s), hair);
  EXPECT_FALSE(p.runs("capsule-0"));
  EXPECT_TRUE(p.runs("capsule-1"));
  EXPECT_THAT(p.at("capsule-0").why, HasSubstr("out of the hair's reach"));
  ASSERT_EQ(p.scene.simulation.collision.capsules.size(), 1U);
  EXPECT_EQ(p.scene.simulation.collision.capsules[0], near_by);
  const Strands with = moved(hair, s, MotionKind::shake, 1),
                without = moved(hair, p.scene.simulation, MotionKind::shake, 1);
  EXPECT_EQ(with.vertices, without.vertices);
}

TEST(MotionGates, CapsulesThatMoveAreKept) {
  SimulationSettings s = bare();
  s.motion.kind = MotionKind::none;
  ColliderCapsule c;
  c.from = c.to = {9, 1, 0};
  c.velocity_m_s = {-1, 0, 0};
  s.collision.capsules = {c};
  EXPECT_TRUE(plan_of(scene_of(s), ball_of_hair(50, 12)).runs("capsule-0"));
  s.collision.capsules[0].velocity_m_s = glm::vec3(0);
  EXPECT_FALSE(plan_of(scene_of(s), ball_of_hair(50, 12)).runs("capsule-0"));
  s.motion.kind = MotionKind::jump;
  EXPECT_TRUE(plan_of(scene_of(s), ball_of_hair(50, 12)).runs("capsule-0"));
}

TEST(MotionGates, CapsulesOnAMovingHeadStayWithTheHair) {
  SimulationSettings s = bare();
  s.motion.kind = MotionKind::shake;
  ColliderCapsule c;
  c.from = c.to = {9, 1, 0};
  c.with_head = true;
  s.collision.capsules = {c, c, c};
  s.collision.capsules[1].from = s.collision.capsules[1].to = {0, 1.4F, 0};
  s.collision.capsules[1].radius_m = 0;  // a wire
  const EffectPlan p = plan_of(scene_of(s), ball_of_hair(50, 12));
  EXPECT_FALSE(p.runs("capsule-0"));
  EXPECT_TRUE(p.runs("capsule-1"));
  EXPECT_FALSE(p.runs("capsule-2"));
  ASSERT_EQ(p.scene.simulation.collision.capsules.size(), 1U);
  EXPECT_EQ(p.scene.simulation.collision.capsules[0], s.collision.capsules[1]);
  s.collision.capsules[0].with_head = false;  // the head shakes to and fro past it
  EXPECT_TRUE(plan_of(scene_of(s), ball_of_hair(50, 12)).runs("capsule-0"));
}

/// Wind just below the gate, gusting at the strand's own frequency: the worst that the bound has to cover.
TEST(MotionGates, WindIsSkippedOnlyWithinItsBound) {
  const Strands hair = hanging(1, 0);
  for (const float gust_s : {0.3F, 0.6F, 0.9F, 1.5F}) {
    SimulationSettings s = bare(false);
    s.life.sleep_m_s = 0;
    s.wind.shelter = 0;
    s.wind.gust = 2;
    s.wind.gust_s = gust_s;
    const auto called_for = [&](float speed) {
      s.wind.velocity_m_s = {speed, 0, 0};
      return plan_of(scene_of(s), hair).runs("wind");
    };
    float speed = 1;
    while (called_for(speed)) speed *= 0.9F;
    EXPECT_TRUE(called_for(speed / 0.9F));
    s.wind.velocity_m_s = {speed, 0, 0};
    SimulationSettings calm = s;
    calm.wind.velocity_m_s = glm::vec3(0);
    const float off = farthest(moved(hair, s, MotionKind::none, 8), moved(hair, calm, MotionKind::none, 8));
    EXPECT_LE(off, kUnseenWidth * hair.diameter_m) << speed << " m/s, gusts of " << gust_s << " s";
    EXPECT_GT(speed, 0);
  }
}

/// What moves a strand by just less than shows, and what makes it show.
TEST(MotionGates, GustsAndThinPlacesMakeTheWindSeen) {
  Strands hair = hanging(1, 0);
  SimulationSettings s = bare(false);
  s.wind.gust = 0;
  s.wind.velocity_m_s = {1, 0, 0};
  const auto runs = [&] { return plan_of(scene_of(s), hair).runs("wind"); };
  while (runs()) s.wind.velocity_m_s *= 0.9F;
  s.wind.gust = 0.5F;
  EXPECT_TRUE(runs());
  s.wind.gust = 0;
  hair.diameters_m.assign(hair.vertices.size(), hair.diameter_m);
  EXPECT_FALSE(runs());
  hair.diameters_m[7] *= 0.5F;
  EXPECT_TRUE(runs());
  hair.diameters_m[7] *= 2;
  s.wind.drag_per_s = 0;
  EXPECT_EQ(plan_of(scene_of(s), hair).at("wind").why, "simulation.wind.drag_per_s is zero");
}

/// Ten times length, drag and greatest speed over gravity; length, and the pull's rate squared, over gravity.
TEST(MotionGates, SayTheBoundsThatTheyHold) {
  SimulationSettings s = bare(false);
  s.chain.gravity = {0, -10, 0};
  s.wind.velocity_m_s = {0, 0, 2};
  s.wind.drag_per_s = 0.5F;
  s.wind.gust = 1;
  s.shape.hold_rad_s = 2;
  s.shape.sag_free = false;
  const EffectPlan p = plan_of(scene_of(s), hanging(3, 0.01F));
  EXPECT_THAT(p.at("wind").why, HasSubstr("by at most 6e+02 mm"));
  EXPECT_THAT(p.at("hold-shape").why, HasSubstr("by at most 36 mm; a tenth of a fibre's width is 0.01 mm"));
}

TEST(MotionGates, ShelterIsForTheWind) {
  SimulationSettings s = bare(false);
  s.wind.shelter = 1;
  s.wind.velocity_m_s = {3, 0, 0};
  Scene scene = scene_of(s);
  const Strands hair = ball_of_hair(20, 8);
  EXPECT_TRUE(plan_of(scene, hair).runs("shelter"));
  EXPECT_TRUE(plan_of(scene, hair).runs("voxel-grid"));
  scene.effects["wind"] = EffectState::off;
  EXPECT_FALSE(plan_of(scene, hair).runs("shelter"));
  EXPECT_FALSE(plan_of(scene, hair).runs("voxel-grid"));
}

TEST(MotionGates, InWindNothingSleepsSoNothingWatchesForIt) {
  SimulationSettings s = bare(false);
  s.wind.velocity_m_s = glm::vec3(0);
  const Strands hair = ball_of_hair(20, 8);
  EXPECT_TRUE(plan_of(scene_of(s), hair).runs("sleep"));
  s.wind.velocity_m_s = {0, 0, 3};
  EXPECT_FALSE(plan_of(scene_of(s), hair).runs("sleep"));
  EXPECT_EQ(plan_of(scene_of(s), hair).scene.simulation.life.sleep_m_s, 0);
}

TEST(MotionGates, AWeakHoldIsSkippedOnlyWithinItsBound) {
  Strands hair = ball_of_hair(1, 16);
  hair.diameter_m = 1e-4F;
  SimulationSettings s = bare(false);
  s.life.sleep_m_s = 0;
  s.shape.hold_rad_s = 10;
  while (plan_of(scene_of(s), hair).runs("hold-shape")) s.shape.hold_rad_s *= 0.9F;
  SimulationSettings loose = s;
  loose.shape.hold_rad_s = 0;
  const float off = farthest(moved(hair, s, MotionKind::none, 10), moved(hair, loose, MotionKind::none, 10));
  EXPECT_LE(off, kUnseenWidth * hair.diameter_m) << s.shape.hold_rad_s << " rad/s";
  s.shape.sag_free = true;
  EXPECT_TRUE(plan_of(scene_of(s), hair).runs("hold-shape"));
}

TEST(MotionGates, CurlsAreSkippedOnlyWhereNeitherRadiusNorCurveShows) {
  SimulationSettings s = bare(false);
  s.shape.curl.radius_m = 1e-6F;
  EXPECT_FALSE(plan_of(scene_of(s), hanging(3, 0.01F)).runs("curls"));
  Strands bent = ball_of_hair(3, 8);  // its curve leaves the segments by millimetres
  bent.diameter_m = 1e-4F;
  EXPECT_TRUE(plan_of(scene_of(s), bent).runs("curls"));
  s.shape.curl.radius_m = 1e-3F;
  EXPECT_TRUE(plan_of(scene_of(s), hanging(3, 0.01F)).runs("curls"));
}

TEST(MotionGates, AsManyGuidesAsStrandsAreNoWisps) {
  SimulationSettings s = bare();
  s.wisps = 20;
  EXPECT_TRUE(plan_of(scene_of(s), ball_of_hair(61, 8)).runs("wisps"));
  EXPECT_FALSE(plan_of(scene_of(s), ball_of_hair(60, 8)).runs("wisps"));
  EXPECT_EQ(plan_of(scene_of(s), ball_of_hair(60, 8)).scene.simulation.wisps, 0);
}

TEST(MotionGates, NoHeadNoCollision) {
  const Scene scene = scene_of(simulation_preset("hold-shape"));
  Mesh head;
  EXPECT_FALSE(plan_of(scene, ball_of_hair(10, 8), head).runs("head-collision"));
  head.vertices = {{0, 1.6F, 0}, {0.1F, 1.6F, 0}, {0, 1.6F, 0.1F}};
  head.triangles = {{0, 1, 2}};
  EXPECT_TRUE(plan_of(scene, ball_of_hair(10, 8), head).runs("head-collision"));
  for (glm::vec3& p : head.vertices) p.x += 10;
  EXPECT_FALSE(plan_of(scene, ball_of_hair(10, 8), head).runs("head-collision"));
  for (glm::vec3& p : head.vertices) p.x -= 9.65F;  // 0.35 m from the root of a strand of 0.3 m
  Scene thick = scene;
  thick.simulation.collision.margin_m = 0.04F;
  EXPECT_FALSE(plan_of(thick, hanging(1, 0), head).runs("head-collision"));
  thick.simulation.collision.margin_m = 0.06F;
  EXPECT_TRUE(plan_of(thick, hanging(1, 0), head).runs("head-collision"));
}

/// A minute at rest, asleep, then the head moves: the same as hair that was kept awake.
TEST(MotionGates, AStrandThatStartsToMoveAfterAMinuteAtRest) {
  const Strands hair = ball_of_hair(64, 12);
  SimulationSettings sleeping = bare(), waking = sleeping;
  sleeping.life.sleep_m_s = 0.01F;
  waking.life.sleep_m_s = 0;
  Simulation asleep(hair, {}, sleeping), awake(hair, {}, waking);
  const RigidPose still{asleep.pivot(), glm::dquat(1, 0, 0, 0)};
  for (int k = 0; k < 60 * 60; ++k) {
    asleep.advance(1.0 / 60, still);
    awake.advance(1.0 / 60, still);
  }
  ASSERT_EQ(asleep.facts().asleep, 64U);
  const SimulationFacts before = asleep.facts();
  asleep.advance(1.0 / 60, still);
  EXPECT_EQ(asleep.facts().chain_steps, before.chain_steps);  // asleep: no call
  EXPECT_EQ(asleep.facts().grid_builds, before.grid_builds);
  EXPECT_FALSE(asleep.facts().moved);
  awake.advance(1.0 / 60, still);
  EXPECT_TRUE(awake.facts().moved);
  Strands a = hair, b = hair;
  float worst = 0;
  for (int k = 1; k <= 60; ++k) {
    MotionSettings shake;
    const RigidPose pose = head_pose(shake, still.position, k / 60.0);
    asleep.advance(1.0 / 60, pose);
    awake.advance(1.0 / 60, pose);
    asleep.positions(a);
    awake.positions(b);
    worst = std::max(worst, farthest(a, b));
  }
  EXPECT_EQ(asleep.facts().asleep, 0U);
  std::printf("a minute asleep, then shaken, against awake: at most %.3f mm\n", 1e3 * static_cast<double>(worst));
  EXPECT_LT(worst, 0.005F);  // the bound that the ledger states
}

}  // namespace
}  // namespace pelage
