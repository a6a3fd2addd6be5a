// From a groom to moved hair: what MovingHair puts together.
#include "pelage/simulate/moving_hair.h"

#include <gtest/gtest.h>

#include <glm/geometric.hpp>

#include "moving.h"

namespace pelage {
namespace {

/// Nothing pulls: hair that is left alone stays.
SimulationSettings weightless() {
  SimulationSettings s = bare(false);
  s.chain.gravity = glm::vec3(0);
  s.vertices = 8;
  return s;
}

/// A ball of hair with waves that eight vertices cannot hold.
Strands wavy() {
  Strands hair = ball_of_hair(60, 40);
  for (std::size_t v = 0; v < hair.vertices.size(); ++v)
    hair.vertices[v].x += v % 40 == 0 ? 0.0F : 0.004F * std::sin(1.3F * static_cast<float>(v % 40));
  hair.diameters_m.assign(hair.vertices.size(), 80e-6F);
  hair.colours.assign(hair.count(), glm::vec3(0.1F, 0.2F, 0.3F));
  return hair;
}

double furthest(const Strands& a, const Strands& b) {
  double worst = 0;
  for (std::size_t v = 0; v < a.vertices.size(); ++v)
    worst = std::max(worst, static_cast<double>(glm::distance(a.vertices[v], b.vertices[v])));
  return worst;
}

TEST(MovingHair, LeftAloneIsTheGroom) {
  for (const int wisps : {0, 5}) {
    SimulationSettings s = weightless();
    s.wisps = wisps;
    const Strands groom = wavy();
    MovingHair hair(groom, {}, s);
    for (int k = 0; k < 10; ++k) hair.advance(1.0 / 60, hair.pose());
    const Strands& now = hair.hair();
    ASSERT_EQ(now.offsets, groom.offsets);
    EXPECT_LT(furthest(now, groom), wisps > 0 ? 5e-5 : 1e-5) << wisps;  // of 0.3 m
    EXPECT_EQ(now.diameters_m, groom.diameters_m);
    EXPECT_EQ(now.colours, groom.colours);
  }
}

TEST(MovingHair, TeleportCarriesHairAndHeadAlong) {
  Mesh head;
  head.vertices = {{0, 1.5F, 0}, {0.1F, 1.5F, 0}, {0, 1.6F, 0}};
  head.normals = {{0, 0, 1}, {0, 0, 1}, {0, 0, 1}};
  head.triangles = {{0, 1, 2}};
  const Strands groom = wavy();
  MovingHair hair(groom, head, weightless());
  const RigidPose there = turned(hair.pivot(), 1.2, {3, 1, -2});
  hair.teleport(there);
  const auto carried = [&](const glm::vec3& p) {
    return glm::vec3(there.position + there.rotation * (glm::dvec3(p) - hair.pivot()));
  };
  const Strands& now = hair.hair();
  for (std::size_t v = 0; v < now.vertices.size(); ++v)
    EXPECT_LT(glm::distance(now.vertices[v], carried(groom.vertices[v])), 2e-5F) << v;
  for (std::size_t v = 0; v < 3; ++v)
    EXPECT_LT(glm::distance(hair.head().vertices[v], carried(head.vertices[v])), 1e-6F);
  EXPECT_NEAR(glm::length(hair.head().normals[0]), 1, 1e-6);
  EXPECT_NEAR(hair.head().normals[0].x, std::sin(1.2), 1e-5);
}

TEST(MovingHair, RootsStayOnTheHeadHoweverItMoves) {
  // Between two internal steps too: frames of 1/50 s are no whole number of them.
  const Strands groom = wavy();
  SimulationSettings s = bare(false);
  MovingHair hair(groom, {}, s);
  for (int k = 1; k <= 25; ++k) {
    const RigidPose pose = turned(hair.pivot(), 0.3 * k, {0.02 * k, 0, 0});
    hair.advance(1.0 / 50, pose);
    const Strands& now = hair.hair();
    for (std::size_t i = 0; i < now.count(); ++i) {
      const glm::vec3 root(pose.position + pose.rotation * (glm::dvec3(groom.strand(i)[0]) - hair.pivot()));
      ASSERT_LT(glm::distance(now.strand(i)[0], root), 1e-6F) << "frame " << k << ", strand " << i;
    }
  }
}

/// Weightless, so that it sleeps; with curls, the last that hair() makes.
SimulationSettings dozing(bool curls) {
  SimulationSettings s = weightless();
  s.life.sleep_m_s = 0.01F;
  s.life.sleep_after_s = 0.02F;
  if (curls) s.shape.curl.radius_m = 0.004F;
  return s;
}

TEST(MovingHair, AsleepIsNotMadeAgain) {
  for (const bool curls : {false, true}) {
    MovingHair hair(wavy(), {}, dozing(curls));
    for (int k = 0; k < 10; ++k) hair.advance(1.0 / 60, hair.pose());
    ASSERT_EQ(hair.simulation().facts().asleep, 60U);
    EXPECT_TRUE(hair.moved());  // since nobody has asked for it yet
    const std::vector<glm::vec3> first = hair.hair().vertices;
    EXPECT_GT(hair.hair_ms(), 0);
    EXPECT_FALSE(hair.moved());
    const std::uint64_t steps = hair.simulation().facts().chain_steps;
    for (int k = 0; k < 5; ++k) {
      hair.advance(1.0 / 60, hair.pose());
      EXPECT_FALSE(hair.moved()) << k;
      EXPECT_EQ(hair.hair().vertices, first);
      EXPECT_EQ(hair.hair_ms(), 0);
    }
    EXPECT_EQ(hair.simulation().facts().chain_steps, steps);
    EXPECT_GT(steps, 0U);
  }
}

TEST(MovingHair, WhatMovesItIsSeenAtTheNextLook) {
  const RigidPose rest = MovingHair(wavy(), {}, dozing(false)).pose();
  const auto expect_moved = [&](const char* what, auto action) {
    MovingHair hair(wavy(), {}, dozing(true));
    for (int k = 0; k < 10; ++k) hair.advance(1.0 / 60, rest);
    const std::vector<glm::vec3> before = hair.hair().vertices;
    ASSERT_FALSE(hair.moved());
    action(hair);
    EXPECT_TRUE(hair.moved()) << what;
    hair.advance(1e-6, hair.pose());
    EXPECT_TRUE(hair.moved()) << what << ": nobody has looked in between";
    EXPECT_NE(hair.hair().vertices, before) << what;
    EXPECT_FALSE(hair.moved()) << what;
  };
  const RigidPose there{rest.position + glm::dvec3(0.1, 0, 0), rest.rotation}, turn = turned(rest.position, 0.3);
  expect_moved("a step", [&](MovingHair& h) { h.advance(1.0 / 60, there); });
  // A frame shorter than a step shows the head where it is then.
  expect_moved("a shift between steps", [&](MovingHair& h) { h.advance(1e-6, there); });
  expect_moved("a turn between steps", [&](MovingHair& h) { h.advance(1e-6, turn); });
  expect_moved("a teleport", [&](MovingHair& h) { h.teleport(there); });
  MovingHair hair(wavy(), {}, dozing(false));
  hair.advance(1.0 / 60, there);
  hair.hair();
  hair.reset();
  EXPECT_TRUE(hair.moved());
}

TEST(MovingHair, BeginsTheSameWhateverCameBefore) {
  SimulationSettings s = bare();
  s.wind.velocity_m_s = {2, 0, 1};
  MovingHair fresh(wavy(), {}, s), used(wavy(), {}, s);
  const RigidPose start = turned(fresh.pivot(), 0.4, {0.1, 0, 0});
  for (int k = 1; k < 20; ++k) used.advance(1.0 / 50, turned(used.pivot(), 0.1 * k));
  fresh.begin(start, 0.3);
  used.begin(start, 0.3);
  EXPECT_EQ(fresh.simulation().state_hash(), used.simulation().state_hash());
  EXPECT_LT(fresh.pose().position.x - start.position.x, 1e-12);
}

TEST(MovingHair, WithoutDetailIsItsCentreLines) {
  SimulationSettings s = weightless();
  s.detail = false;
  MovingHair hair(wavy(), {}, s);
  const Strands& now = hair.hair();
  EXPECT_EQ(now.vertices, hair.lines().vertices);
  EXPECT_LE(now.strand(0).size(), 8U);
  EXPECT_EQ(now.colours.size(), 60U);
}

TEST(MovingHair, CurlsAreDrawnFinerThanTheHair) {
  SimulationSettings s = weightless();
  s.shape.curl.radius_m = 0.005F;
  s.shape.curl.subdivision = 3;
  const Strands groom = wavy();
  MovingHair hair(groom, {}, s);
  const Strands& now = hair.hair();
  ASSERT_EQ(now.count(), groom.count());
  EXPECT_EQ(now.strand(0).size(), 39U * 3 + 1);
  for (std::size_t i = 0; i < now.count(); ++i) EXPECT_LT(glm::distance(now.strand(i)[0], groom.strand(i)[0]), 1e-6F);
}

TEST(MovingHair, GuidesFollowWhatAllStrandsDo) {
  // Under gravity and a turn of the head: guides' hair ends near that of all strands (measured: printed).
  const Strands groom = ball_of_hair(400, 12);
  SimulationSettings all = bare(false), guided = all;
  guided.wisps = 40;
  MovingHair a(groom, {}, all), b(groom, {}, guided);
  EXPECT_LE(b.simulation().blocks().strands, 120U);
  for (int k = 1; k <= 30; ++k) {
    const RigidPose pose = turned(a.pivot(), 0.02 * k);
    a.advance(1.0 / 60, pose);
    b.advance(1.0 / 60, pose);
  }
  const Strands &x = a.hair(), &y = b.hair();
  double error = 0, way = 0;
  for (std::size_t v = 0; v < x.vertices.size(); ++v) {
    const glm::vec3 e = x.vertices[v] - y.vertices[v], w = x.vertices[v] - groom.vertices[v];
    error += static_cast<double>(glm::dot(e, e));
    way += static_cast<double>(glm::dot(w, w));
  }
  std::printf("guides: %.1f %% of the way that hair went\n", 100 * std::sqrt(error / way));
  EXPECT_LT(std::sqrt(error / way), 0.15);
}

}  // namespace
}  // namespace pelage
