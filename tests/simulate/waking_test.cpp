// HARD_CASES 29: what wakes sleeping hair.
#include <gtest/gtest.h>

#include <glm/geometric.hpp>

#include "moving.h"

namespace pelage {
namespace {

using glm::vec3;

constexpr std::size_t kTuft = 16;  // strands: a block

/// Tufts of hanging hair, their roots a millimetre apart around the given places. Each has a vertex more than the one
/// before, so that each is a block.
Strands tufts(const std::vector<vec3>& places) {
  Strands hair;
  int vertices = 12;
  for (const vec3& place : places) {
    for (std::size_t s = 0; s < kTuft; ++s) {
      std::vector<vec3> points;
      for (int i = 0; i < vertices; ++i)
        points.push_back(place + vec3(0.001F * static_cast<float>(s % 4), -0.02F * static_cast<float>(i),
                                      0.001F * static_cast<float>(s / 4)));
      hair.append(points);
    }
    ++vertices;
  }
  return hair;
}

SimulationSettings sleepy(bool grid) {
  SimulationSettings s = bare(grid);
  s.chain.damping_per_s = 20;
  s.interaction.repulsion_m_s2 = 0.05F;
  if (!grid) s.interaction.repulsion_m_s2 = 0;
  s.life.sleep_m_s = 0.005F;
  s.life.sleep_after_s = 0.1F;
  return s;
}

RigidPose still(const Simulation& simulation) {
  return {simulation.pivot(), glm::dquat(1.0, 0.0, 0.0, 0.0)};
}

/// Time until fewer than `asleep` strands sleep, from when all did; -1: not within the time.
double time_awake(Simulation& simulation, std::size_t asleep, double from_s, double to_s) {
  for (double t = from_s; t < to_s; t += 1.0 / 60) {
    simulation.advance(1.0 / 60, still(simulation));
    if (simulation.facts().asleep < asleep) return t;
  }
  return -1;
}

TEST(Waking, ByAMovingCollider) {
  // A ball of 2 cm comes at .2 m/s from .5 m: it touches the tuft, with 2 mm of margin, after (.5 - .022) / .2 s.
  SimulationSettings s = sleepy(false);
  s.collision.capsules = {{.from = {-0.5F, -0.1F, 0.0015F},
                           .to = {-0.5F, -0.1F, 0.0015F},
                           .radius_m = 0.02F,
                           .velocity_m_s = {0.2F, 0, 0}}};
  Simulation simulation(tufts({{0, 0, 0}}), {}, s);
  for (int k = 0; k < 60; ++k) simulation.advance(1.0 / 60, still(simulation));
  ASSERT_EQ(simulation.facts().asleep, kTuft);
  const double woke = time_awake(simulation, kTuft, 1, 3);
  EXPECT_NEAR(woke, (0.5 - 0.022) / 0.2, 0.04);  // a frame; vertices are 2 cm apart on a ball of 2 cm
  for (int k = 0; k < 30; ++k) simulation.advance(1.0 / 60, still(simulation));
  Strands now = tufts({{0, 0, 0}});
  simulation.positions(now);
  EXPECT_GT(now.strand(0)[5].x, 0.02F);  // and it pushes
}

TEST(Waking, ByNeighbouringHairOnly) {
  // The ball meets the first tuft and drives it into the second.
  for (const bool grid : {true, false}) {
    SimulationSettings s = sleepy(grid);
    s.interaction.friction_per_s = grid ? 10 : 0;
    s.collision.capsules = {{.from = {-0.3F, -0.15F, 0.0015F},
                             .to = {-0.3F, -0.15F, 0.0015F},
                             .radius_m = 0.03F,
                             .velocity_m_s = {0.2F, 0, 0}}};
    Simulation simulation(tufts({{0, 0, 0}, {0.06F, 0, 0}}), {}, s);
    for (int k = 0; k < 60; ++k) simulation.advance(1.0 / 60, still(simulation));
    ASSERT_EQ(simulation.facts().asleep, 2 * kTuft);
    const double first = time_awake(simulation, 2 * kTuft, 1, 3);
    EXPECT_GT(first, 0);
    EXPECT_EQ(simulation.facts().asleep, kTuft);
    // The ball itself is at the second tuft when its centre is at .028 m, at 1.64 s.
    const double second = time_awake(simulation, kTuft, first, 1.58);
    if (grid) {
      EXPECT_GT(second, first);
    } else {
      EXPECT_EQ(second, -1);
    }
  }
}

TEST(Waking, ByItsRoot) {
  for (const glm::dvec3& shift : {glm::dvec3(1e-4, 0, 0), glm::dvec3(0, 0, -1e-4)}) {
    Simulation simulation(tufts({{0, 0, 0}}), {}, sleepy(false));
    for (int k = 0; k < 60; ++k) simulation.advance(1.0 / 60, still(simulation));
    ASSERT_EQ(simulation.facts().asleep, kTuft);
    simulation.advance(1.0 / 60, turned(simulation.pivot(), 0, shift));
    EXPECT_EQ(simulation.facts().asleep, 0U);
  }
  Simulation simulation(tufts({{0, 0, 0}}), {}, sleepy(false));
  for (int k = 0; k < 60; ++k) simulation.advance(1.0 / 60, still(simulation));
  simulation.advance(1.0 / 60, turned(simulation.pivot(), 1e-3));
  EXPECT_EQ(simulation.facts().asleep, 0U);
}

TEST(Waking, InWindNothingSleeps) {
  SimulationSettings s = sleepy(true);
  s.wind.velocity_m_s = {0.05F, 0, 0};
  Simulation simulation(tufts({{0, 0, 0}}), {}, s);
  for (int k = 0; k < 120; ++k) simulation.advance(1.0 / 60, still(simulation));
  EXPECT_EQ(simulation.facts().asleep, 0U);
  EXPECT_LT(simulation.facts().fastest_m_s, 0.05F);
}

TEST(Waking, ByTeleportAndReset) {
  Simulation simulation(tufts({{0, 0, 0}}), {}, sleepy(false));
  for (int k = 0; k < 60; ++k) simulation.advance(1.0 / 60, still(simulation));
  ASSERT_EQ(simulation.facts().asleep, kTuft);
  const RigidPose there = turned(simulation.pivot(), 1, {1, 0, 0});
  simulation.teleport(there);
  simulation.advance(1.0 / 60, there);
  EXPECT_EQ(simulation.facts().asleep, 0U);
  for (int k = 0; k < 60; ++k) simulation.advance(1.0 / 60, there);
  ASSERT_EQ(simulation.facts().asleep, kTuft);
  simulation.reset();
  simulation.advance(1.0 / 60, there);
  EXPECT_EQ(simulation.facts().asleep, 0U);
}

TEST(Waking, AfterTheTimeItWasToldTo) {
  SimulationSettings s = sleepy(false);
  s.life.sleep_after_s = 0.4F;
  Simulation simulation(tufts({{0, 0, 0}}), {}, s);
  int frames = 0;
  while (simulation.facts().asleep == 0 && frames < 200) {
    simulation.advance(1.0 / 60, still(simulation));
    ++frames;
  }
  EXPECT_NEAR(frames / 60.0, 0.4, 1.5 / 60);  // hanging hair is at rest from the first
}

TEST(Waking, SleepingHairKeepsWhatHoldsIt) {
  // Nudged by a ball that then leaves: awake again, it starts from where it slept without a jolt.
  Simulation simulation(tufts({{0, 0, 0}}), {}, sleepy(false));
  for (int k = 0; k < 60; ++k) simulation.advance(1.0 / 60, still(simulation));
  ASSERT_EQ(simulation.facts().asleep, kTuft);
  simulation.advance(1.0 / 60, turned(simulation.pivot(), 0, {1e-6, 0, 0}));
  EXPECT_EQ(simulation.facts().asleep, 0U);
  EXPECT_LT(simulation.facts().fastest_m_s, 2e-3F);
}

TEST(Waking, AsleepNothingMoves) {
  Simulation simulation(tufts({{0, 0, 0}}), {}, sleepy(true));
  for (int k = 0; k < 120; ++k) simulation.advance(1.0 / 60, still(simulation));
  ASSERT_EQ(simulation.facts().asleep, kTuft);
  for (const Lanes3& v : simulation.blocks().velocity)
    for (int l = 0; l < kLanes; ++l) ASSERT_EQ(v.x[l] * v.x[l] + v.y[l] * v.y[l] + v.z[l] * v.z[l], 0.0F);
}

TEST(Waking, TurningPointsOfASwingDoNotAddUp) {
  // A link that swings by 1 m/s is below .1 m/s for .06 s twice in a second: it never rests for .15 s.
  SimulationSettings s = sleepy(false);
  s.chain.damping_per_s = 0;
  s.life.sleep_m_s = 0.1F;
  s.life.sleep_after_s = 0.15F;
  Strands hair;
  hair.append(std::vector<vec3>{{0, 0, 0}, {0.2F, -0.22F, 0}});
  Simulation simulation(hair, {}, s);
  for (int k = 0; k < 300; ++k) {
    simulation.advance(1.0 / 60, still(simulation));
    ASSERT_EQ(simulation.facts().asleep, 0U) << "frame " << k;
  }
}

}  // namespace
}  // namespace pelage
