// Cone and collisions on the strands' way: HARD_CASES 24 and 27. What colliders are: colliders_test.cpp.
#include <gtest/gtest.h>

#include <cstdio>
#include <functional>
#include <glm/geometric.hpp>
#include <glm/gtc/quaternion.hpp>

#include "chains.h"
#include "moving.h"
#include "test_meshes.h"

namespace pelage {
namespace {

using glm::dvec3;
using glm::vec3;

constexpr double kStep_s = 1.0 / 480;
const RigidPose kStill{};

/// Cosine of the bend at vertex i - 1; at i = 1 against the rest direction.
double bend_cos(const StrandBlocks& blocks, std::size_t s, std::uint32_t i) {
  const std::uint32_t k = blocks.block_of[s];
  const Lanes3& rest = blocks.rest[blocks.first[k / kLanes] + 1];
  const dvec3 before = i == 1 ? dvec3(rest.x[k % kLanes], rest.y[k % kLanes], rest.z[k % kLanes])
                              : dvec3(at(blocks, s, i - 1)) - dvec3(at(blocks, s, i - 2));
  return glm::dot(glm::normalize(before), glm::normalize(dvec3(at(blocks, s, i)) - dvec3(at(blocks, s, i - 1))));
}

double degrees_of(double cosine) {
  return std::acos(std::min(cosine, 1.0)) * 180 / 3.14159265358979;
}

ShapeSettings cone(float degrees, float end) {
  ShapeSettings shape;
  shape.cone_deg = degrees;
  shape.cone_end = end;
  return shape;
}

TEST(Cone, BendsByNoMoreThanItsLimitWhichWeakensToTheTip) {
  // Fifteen links let go horizontally: 20 degrees at the root, growing by 70 over half the strand.
  for (const ChainSolver solver : {ChainSolver::dftl, ChainSolver::position_based, ChainSolver::tridiagonal}) {
    StrandBlocks chain = one_chain(straight_chain(15, 0.3F, {0.6F, 0.8F, 0}));
    const std::vector<Lanes> limits = cone_limits(chain, cone(20, 0.5F));
    ChainStep step;
    step.chain.solver = solver;
    step.cone_cos = limits;
    double touched = 0;
    for (int k = 0; k < 480; ++k) {
      step_all(chain, step);
      for (std::uint32_t i = 1; i <= 15; ++i) {
        const double limit = 2 * i < 15 ? 20 + 70 * (i / 15.0) / 0.5 : 180;
        const double bend = degrees_of(bend_cos(chain, 0, i));
        ASSERT_LE(bend, limit + 0.05) << "vertex " << i << ", step " << k;
        touched += bend > limit - 0.05 ? 1 : 0;
      }
    }
    EXPECT_GT(touched, 480);           // one vertex or more on most steps
    EXPECT_LT(at(chain, 0, 15).y, 0);  // it does hang
  }
}

TEST(Cone, GrowsEvenlyAndEndsAtItsEnd) {
  const StrandBlocks chain = one_chain(straight_chain(10, 0.3F));
  const std::vector<Lanes> limits = cone_limits(chain, cone(10, 0.8F));
  for (std::uint32_t i = 0; i <= 10; ++i) {
    const double expected = i < 8 ? 10 + 80 * i / 8.0 : 180;
    EXPECT_NEAR(degrees_of(static_cast<double>(limits[i].v[0])), expected, 0.1) << i;
  }
}

TEST(Cone, LeavesAGroomThatBendsByItself) {
  // A right angle in a cone of 5 degrees, without gravity and moved about, stays one.
  std::vector<vec3> bent{{0, 0, 0}, {0.03F, 0, 0}, {0.03F, 0.03F, 0}, {0.06F, 0.03F, 0}, {0.06F, 0, 0}};
  StrandBlocks chain = one_chain(bent);
  const std::vector<Lanes> limits = cone_limits(chain, cone(5, 1));
  ChainStep step;
  step.chain.gravity = vec3(0);
  step.cone_cos = limits;
  for (int k = 0; k < 480; ++k) step_all(chain, step);
  for (std::uint32_t i = 0; i < 5; ++i) EXPECT_LT(glm::distance(at(chain, 0, i), bent[i]), 1e-4F);
}

TEST(Cone, OpposedSegmentsTurnBackIntoIt) {
  for (const vec3 along : {vec3(1, 0, 0), vec3(0, 1, 0), vec3(0, 0, -1), glm::normalize(vec3(-1, 2, 3))}) {
    StrandBlocks chain = one_chain(straight_chain(6, 0.3F, along));
    const std::vector<Lanes> limits = cone_limits(chain, cone(30, 1));
    ChainStep step;
    step.chain.gravity = vec3(0);
    step.cone_cos = limits;
    for (std::uint32_t i = 1; i <= 6; ++i) {  // folded to and fro, starting back into the skin
      const vec3 p = i % 2 == 1 ? -0.05F * along : vec3(0);
      chain.position[i].x[0] = p.x, chain.position[i].y[0] = p.y, chain.position[i].z[0] = p.z;
    }
    for (int k = 0; k < 5; ++k) {
      step_all(chain, step);
      EXPECT_LE(worst_stretch(chain), 1e-5);
      for (std::uint32_t i = 1; i <= 6; ++i)
        EXPECT_GE(bend_cos(chain, 0, i), static_cast<double>(limits[i].v[0]) - 1e-5) << i;
    }
  }
}

TEST(Cone, AStrandAlongTheRootsNormalStands) {
  StrandBlocks chain = one_chain(straight_chain(8, 0.2F, {0, 1, 0}));
  const std::vector<Lanes> limits = cone_limits(chain, cone(20, 1));
  ChainStep step;
  step.cone_cos = limits;
  for (int k = 0; k < 200; ++k) step_all(chain, step);
  EXPECT_NEAR(at(chain, 0, 8).y, 0.2F, 1e-5F);
}

// Collisions
// ------------------------------------------------------------------------------------------------------------

constexpr float kMargin_m = 0.002F;

CollisionSettings among(std::vector<ColliderCapsule> capsules) {
  CollisionSettings s;
  s.capsules = std::move(capsules);
  return s;
}

ColliderCapsule ball(vec3 centre, float radius_m, vec3 velocity_m_s = vec3(0)) {
  return {.from = centre, .to = centre, .radius_m = radius_m, .velocity_m_s = velocity_m_s, .with_head = false};
}

/// Distance to a capsule where it is now, in double.
double distance_to(const ColliderCapsule& c, const dvec3& p, double time_s) {
  const dvec3 a = dvec3(c.from) + time_s * dvec3(c.velocity_m_s), ab = dvec3(c.to) - dvec3(c.from);
  const double t = glm::dot(ab, ab) > 0 ? std::min(std::max(glm::dot(p - a, ab) / glm::dot(ab, ab), 0.0), 1.0) : 0;
  return glm::distance(p, a + t * ab) - static_cast<double>(c.radius_m);
}

/// Hair against capsules, step by step; the pivot is the origin.
class Scene {
 public:
  Scene(const Strands& hair, std::vector<ColliderCapsule> capsules, float friction = 0.3F)
      : capsules_(std::move(capsules)),
        colliders_(among(capsules_), {}, dvec3(0)),
        blocks_(make_blocks(hair, dvec3(0))) {
    Lanes margin;
    std::fill_n(margin.v, kLanes, kMargin_m);
    clearance_.assign(blocks_.first.back(), margin);
    step_.colliders = &colliders_;
    step_.collision_margin_m = kMargin_m;
    step_.contact_friction = friction;
    step_.clearance = clearance_;
  }
  Scene(const Scene&) = delete;

  /// @return  least distance to a solid of any vertex but the roots after any of the steps [m]
  double run(int steps) {
    double least = INFINITY;
    for (int k = 0; k < steps; ++k) {
      time_s_ += kStep_s;
      colliders_.move(kStill, kStill, time_s_, kStep_s);
      step_all(blocks_, step_);
      least = std::min(least, nearest());
    }
    return least;
  }
  double nearest() const {
    double least = INFINITY;
    for (std::size_t s = 0; s < blocks_.strands; ++s)
      for (std::uint32_t i = 1; i < count(s); ++i)
        for (const ColliderCapsule& c : capsules_) least = std::min(least, distance_to(c, dvec3(point(s, i)), time_s_));
    return least;
  }
  std::uint32_t count(std::size_t s) const {
    const std::uint32_t k = blocks_.block_of[s];
    return static_cast<std::uint32_t>(blocks_.vertices[k / kLanes].v[k % kLanes]);
  }
  vec3 point(std::size_t s, std::uint32_t i) const {
    const std::uint32_t k = blocks_.block_of[s];
    const Lanes3& r = blocks_.root[k / kLanes];
    return vec3(r.x[k % kLanes], r.y[k % kLanes], r.z[k % kLanes]) + at(blocks_, s, i);
  }
  ChainStep& step() { return step_; }
  const StrandBlocks& blocks() const { return blocks_; }

 private:
  std::vector<ColliderCapsule> capsules_;
  Colliders colliders_;
  StrandBlocks blocks_;
  std::vector<Lanes> clearance_;
  ChainStep step_;
  double time_s_ = 0;
};

/// A fringe of horizontal strands above the origin, let go to fall onto what lies there.
Strands fringe(int strands = 20, int links = 15, float length_m = 0.3F) {
  Strands hair;
  for (int s = 0; s < strands; ++s)
    hair.append(straight_chain(links, length_m, {1, 0, 0},
                               {-0.15F, 0.12F, 0.01F * (static_cast<float>(s) - 0.5F * static_cast<float>(strands))}));
  return hair;
}

TEST(Contact, HairThrownAtASolidStaysOutsideByItsClearance) {
  const ColliderCapsule capsule{.from = {-0.02F, 0, -0.2F}, .to = {0.02F, 0.01F, 0.2F}, .radius_m = 0.05F};
  for (const ChainSolver solver : {ChainSolver::dftl, ChainSolver::position_based, ChainSolver::tridiagonal}) {
    for (const ColliderCapsule& solid : {ball({0, 0, 0}, 0.08F), capsule, ball({0, 0, 0}, 0.0F)}) {
      Scene scene(fringe(), {solid});
      scene.step().chain.solver = solver;
      const double least = scene.run(600);
      // 4 rounds end at a sphere's surface to float's digits: 4 ulp of .3 m.
      EXPECT_GE(least, static_cast<double>(kMargin_m) - 2e-6) << "radius " << solid.radius_m;
      if (solid.radius_m > 0) {
        EXPECT_LE(least, static_cast<double>(kMargin_m) + 1e-5);  // it did land
      }
      if (solver == ChainSolver::dftl) {
        EXPECT_LE(worst_stretch(scene.blocks()), 1e-5);
      }
    }
  }
}

TEST(Contact, CreaseOfTwoOverlappingSolids) {
  Scene scene(fringe(), {ball({-0.05F, 0, 0}, 0.07F), ball({0.05F, 0, 0}, 0.07F)});
  const double least = scene.run(600);
  std::printf("crease of two spheres: nearest %.2e m, clearance %.0e m\n", least, static_cast<double>(kMargin_m));
  // Pushed out of one into the other and back: what four rounds leave.
  EXPECT_GE(least, static_cast<double>(kMargin_m) - 1e-5);
  EXPECT_LE(worst_stretch(scene.blocks()), 1e-5);
}

TEST(Contact, HairThatFallsIntoACreaseLiesInIt) {
  // Along the circle where two spheres meet: pushed from one into the other and back, round by round.
  Strands hair;
  for (int s = 0; s < 9; ++s)
    hair.append(straight_chain(15, 0.3F, {0, 0, 1}, {0.003F * static_cast<float>(s - 4), 0.1F, -0.15F}));
  Scene scene(hair, {ball({-0.05F, 0, 0}, 0.07F), ball({0.05F, 0, 0}, 0.07F)});
  const double least = scene.run(600);
  std::printf("along the crease: nearest %.2e m\n", least);
  EXPECT_GE(least, static_cast<double>(kMargin_m) - 5e-4);
}

TEST(Contact, HairThatLiesInASolidAtRestMayStay) {
  // A groom at rest whose strands dip 8 mm into the head: it is not blown up by its collider.
  SimulationSettings s = bare(false);
  s.shape.hold_rad_s = 30;
  s.shape.hold_tip = 1;
  s.shape.sag_free = true;
  s.collision.capsules = {{.from = {0, 0, 0}, .to = {0, 0, 0}, .radius_m = 0.05F, .with_head = true}};
  Strands hair;
  hair.append(straight_chain(10, 0.2F, {1, 0, 0}, {-0.06F, 0.042F, 0}));
  Simulation simulation(hair, {}, s);
  for (int k = 0; k < 60; ++k) simulation.advance(1.0 / 60, {simulation.pivot(), glm::dquat(1.0, 0.0, 0.0, 0.0)});
  Strands now = hair;
  simulation.positions(now);
  for (std::size_t v = 0; v < hair.vertices.size(); ++v)
    EXPECT_LT(glm::distance(now.vertices[v], hair.vertices[v]), 1e-4F) << v;
}

TEST(Contact, ASolidFasterThanItsOwnSizeSweepsHairAway) {
  // 5 cm of radius at 96 m/s: 20 cm in a step, from beyond the fringe to beyond it; hair hangs between two steps'
  // places.
  Strands hair;
  for (int s = 0; s < 5; ++s)
    hair.append(straight_chain(12, 0.3F, {0, -1, 0}, {0.02F, 0.2F, 0.01F + 0.015F * (static_cast<float>(s) - 2)}));
  Scene scene(hair, {ball({-0.48F, 0, 0}, 0.05F, {96, 0, 0})});
  const double least = scene.run(6);
  EXPECT_GE(least, static_cast<double>(kMargin_m) - 2e-6);
  for (std::size_t s = 0; s < 5; ++s) {
    float aside = 0;
    for (std::uint32_t i = 1; i < scene.count(s); ++i)
      aside = std::max(
          aside, glm::distance(scene.point(s, i), scene.point(s, 0) - vec3(0, 0.025F * static_cast<float>(i), 0)));
    EXPECT_GT(aside, 0.01F) << "strand " << s << " was not hit";
  }
  EXPECT_LE(worst_stretch(scene.blocks()), 1e-5);
}

TEST(Contact, ASlowSolidPushesWhatItMeets) {
  Strands hair;
  hair.append(straight_chain(12, 0.3F, {0, -1, 0}, {0, 0.15F, 0}));
  Scene scene(hair, {ball({-0.2F, 0, 0}, 0.05F, {0.5F, 0, 0})});
  EXPECT_GE(scene.run(240), static_cast<double>(kMargin_m) - 2e-6);
  EXPECT_GT(scene.point(0, 6).x, 0.08F);  // the sphere's front is at .1 m
}

TEST(Contact, FromARootInsideHairGoesStraightOut) {
  // The root is 3 cm deep: the shortest way out is up, and what is longer is outside.
  Strands hair;
  hair.append(straight_chain(10, 0.2F, {1, 0, 0}, {0, 0.07F, 0}));
  hair.append(straight_chain(10, 0.2F, {0, -1, 0}, {0.01F, 0.07F, 0.02F}));
  Scene scene(hair, {ball({0, 0, 0}, 0.1F)});
  scene.run(480);
  for (std::size_t s = 0; s < 2; ++s)
    for (std::uint32_t i = 2; i <= 10; ++i)  // 4 cm and more of hair
      EXPECT_GE(glm::length(dvec3(scene.point(s, i))) - 0.1, static_cast<double>(kMargin_m) - 2e-6) << i;
  EXPECT_LE(worst_stretch(scene.blocks()), 1e-5);
}

TEST(Contact, AtASolidsCentreNothingIsUndefined) {
  Strands hair;
  hair.append(straight_chain(6, 0.2F, {1, 0, 0}));
  hair.append(std::vector<vec3>(4, vec3(0)));
  Scene scene(hair, {ball({0, 0, 0}, 0.05F)});
  scene.run(100);
  EXPECT_LE(worst_stretch(scene.blocks()), 1e-5);
  EXPECT_GE(glm::length(scene.point(0, 6)), 0.05F);
}

/// How far a strand's tip slides in a second that lies level on a slope of 20 degrees [m].
double slides(float friction) {
  const double slope = 20 * 3.14159265358979 / 180;
  const dvec3 normal(0, std::cos(slope), std::sin(slope));
  const vec3 centre(-10.0 * normal);
  // A pipe of 10 m radius under the strand and along it is a plane.
  const vec3 root = centre + vec3(normal) * (10.0F + kMargin_m);
  Strands hair;
  hair.append(straight_chain(10, 0.2F, {1, 0, 0}, root));
  Scene scene(hair, {{.from = centre - vec3(1, 0, 0), .to = centre + vec3(1, 0, 0), .radius_m = 10}}, friction);
  const vec3 before = scene.point(0, 10);
  scene.run(480);
  return static_cast<double>(glm::distance(scene.point(0, 10), before));
}

TEST(Contact, FrictionHoldsHairOnASlopeThatIsNotTooSteep) {
  // tan 20 degrees = .364.
  const double above = slides(0.40F), below = slides(0.33F), none = slides(0);
  std::printf("slope of 20 degrees: slides %.2e m at mu = .40, %.3f m at .33, %.3f m at 0\n", above, below, none);
  EXPECT_LT(above, 1e-3);
  EXPECT_GT(below, 0.01);
  EXPECT_GT(none, 1.5 * below);
}

TEST(Contact, FrictionIsWithTheMovingSurface) {
  // The top of a bar that slides along itself, under a strand that lies across, takes the strand along.
  for (const float friction : {0.0F, 2.0F}) {
    Strands hair;
    hair.append(straight_chain(10, 0.2F, {1, 0, 0}, {0, 0.052F, 0}));
    Scene scene(hair, {{.from = {0.15F, 0, -2}, .to = {0.15F, 0, 2}, .radius_m = 0.05F, .velocity_m_s = {0, 0, 0.2F}}},
                friction);
    scene.run(120);
    if (friction > 0) {
      EXPECT_GT(scene.point(0, 7).z, 0.01F);
    } else {
      EXPECT_NEAR(scene.point(0, 7).z, 0, 1e-4F);
    }
  }
}

TEST(Contact, WhatRidesOnTheHeadIsNotDraggedByIt) {
  // Bar, root and strand go together: friction holds the strand on the bar as it does at rest.
  const auto middle_after = [](const dvec3& velocity_m_s) {
    SimulationSettings s = bare(false);
    s.chain.damping_per_s = 0;
    s.collision.friction = 2;
    s.collision.capsules = {{.from = {0.15F, 0, -0.3F}, .to = {0.15F, 0, 0.3F}, .radius_m = 0.05F, .with_head = true}};
    Strands hair;
    hair.append(straight_chain(10, 0.2F, {1, 0, 0}, {0, 0.052F, 0}));
    Simulation simulation(hair, {}, s);
    for (int k = 1; k <= 60; ++k)
      simulation.advance(1.0 / 60, {simulation.pivot() + (k / 60.0) * velocity_m_s, glm::dquat(1.0, 0.0, 0.0, 0.0)});
    return at(simulation.blocks(), 0, 7);
  };
  EXPECT_LT(glm::distance(middle_after({0, 0, 0.03}), middle_after({0, 0, 0})), 5e-3F);
}

TEST(Contact, HairStaysOutOfAMeshHead) {
  // Roots 1 mm above a mesh of 10 cm that goes with the head while it shakes.
  const vec3 middle(0, 1.6F, 0);
  Mesh head = sphere_mesh(4, 0.099F);
  for (vec3& v : head.vertices) v += middle;
  SimulationSettings s = bare(false);
  s.collision.head = true;
  Simulation simulation(ball_of_hair(120, 16), head, s);
  const Colliders colliders(s.collision, head, simulation.pivot());
  double deepest = 0;
  for (int k = 1; k <= 90; ++k) {
    const RigidPose pose = turned(simulation.pivot(), 0.8 * std::sin(0.15 * k), {0.05 * std::sin(0.1 * k), 0, 0});
    simulation.advance(1.0 / 60, pose);
    Strands now = ball_of_hair(120, 16);
    simulation.positions(now);
    for (std::size_t strand = 0; strand < now.count(); ++strand) {
      for (std::size_t i = 1; i < now.strand(strand).size(); ++i) {
        const dvec3 p = glm::conjugate(pose.rotation) * (dvec3(now.strand(strand)[i]) - pose.position);
        deepest = std::min(deepest, glm::distance(p + simulation.pivot(), dvec3(middle)) - 0.099);
      }
    }
  }
  std::printf("mesh head: deepest %.2e m inside its sphere\n", deepest);
  EXPECT_GE(deepest, -5e-4);  // facets lie .2 mm inside; the frame's end is up to a step later than the hair's
  EXPECT_LE(worst_stretch_of(simulation), 1e-5);
}

}  // namespace
}  // namespace pelage
