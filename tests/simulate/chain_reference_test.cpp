// step_chains against the same formulas written down once more, strand by strand in double and in world coordinates;
// its roads against each other; strands against their company.
#include <gtest/gtest.h>

#include <array>
#include <cstdio>
#include <glm/geometric.hpp>
#include <glm/gtc/quaternion.hpp>
#include <optional>

#include "chains.h"
#include "pelage/simulate/rigid_pose.h"

namespace pelage {
namespace {

using glm::dvec3;

/// Strands of 1 to 14 vertices and 5 to 40 cm, bent, around the pivot.
Strands mixed_hair(std::size_t count, const dvec3& pivot) {
  Strands hair;
  std::uint32_t random = 12345;
  const auto uniform = [&random](float low, float high) {
    random = random * 1664525U + 1013904223U;
    return low + (high - low) * static_cast<float>(random >> 8) / 16777216.0F;
  };
  for (std::size_t s = 0; s < count; ++s) {
    const int vertices = 1 + static_cast<int>((s * 5) % 14);
    const float segment = uniform(0.05F, 0.4F) / 14;
    glm::vec3 p = glm::vec3(pivot) + glm::vec3(uniform(-0.1F, 0.1F), uniform(-0.1F, 0.1F), uniform(-0.1F, 0.1F));
    glm::vec3 d(uniform(-1, 1), uniform(-1, 1), uniform(-1, 1));
    std::vector<glm::vec3> points{p};
    for (int i = 1; i < vertices; ++i) {
      d = glm::normalize(d + 0.4F * glm::vec3(uniform(-1, 1), uniform(-1, 1), uniform(-1, 1)));
      p += segment * d;
      points.push_back(p);
    }
    hair.append(points);
  }
  return hair;
}

/// Turns and moves at once; in frame 40 a jump, if asked for.
RigidPose pose_at(double t, double jump_m) {
  return {
      dvec3(0.05 * std::sin(9 * t), 0.03 * std::sin(7 * t), 0.2 * t) + (t > 0.0835 ? dvec3(jump_m, 0, 0) : dvec3(0)),
      glm::angleAxis(0.7 * std::sin(6 * t), glm::normalize(dvec3(1, 2, 0.5)))};
}

struct Extras {
  double hold_rad_s = 0, hold_tip = 1;
  bool sag_free = false;
  double cone_deg = 0, cone_end = 0.4;
};

/// One strand of eq. 3.1.
struct Reference {
  std::vector<dvec3> rest, x, v, impulse;  // rest relative to the pivot; the others in the world
  double segment = 0;
  std::vector<double> cone_cos;

  explicit Reference(std::span<const glm::vec3> line, const Extras& extras) {
    double length = 0;
    for (std::size_t i = 0; i < line.size(); ++i) {
      rest.emplace_back(line[i]);
      if (i > 0) length += glm::distance(rest[i], rest[i - 1]);
    }
    if (line.size() > 1) segment = length / static_cast<double>(line.size() - 1);
    x = rest;
    v = impulse = std::vector<dvec3>(rest.size());
    for (std::size_t i = 0; i < rest.size(); ++i) {
      const double share =
          static_cast<double>(i) / std::max(static_cast<double>(rest.size()) - 1, 1.0) / extras.cone_end;
      const double degrees = extras.cone_deg + (90 - extras.cone_deg) * share;
      double bend = 1;
      if (i >= 2) bend = glm::dot(glm::normalize(rest[i] - rest[i - 1]), glm::normalize(rest[i - 1] - rest[i - 2]));
      cone_cos.push_back(std::min(share < 1 ? std::cos(degrees * 3.14159265358979 / 180) : -1.0, bend));
    }
  }

  void step(const ChainStep& s, const RigidPose& pose, const Extras& extras) {
    const double h = static_cast<double>(s.step_s), damping = std::exp(-static_cast<double>(s.chain.damping_per_s) * h);
    const dvec3 g(s.chain.gravity);
    const auto in_world = [&](const dvec3& p) { return pose.position + pose.rotation * p; };
    const dvec3 root = in_world(rest[0]);
    std::vector<dvec3> p = x;
    p[0] = root;
    dvec3 axis = rest.size() > 1 ? pose.rotation * glm::normalize(rest[1] - rest[0]) : dvec3(0, -1, 0);
    for (std::size_t i = 1; i < x.size(); ++i) {
      dvec3 wish = x[i] + h * (v[i] + impulse[i]) + h * h * g;
      if (extras.hold_rad_s > 0) {
        const double along = static_cast<double>(i) / static_cast<double>(x.size() - 1);
        const double omega = extras.hold_rad_s * (1 + (extras.hold_tip - 1) * along), square = omega * h * omega * h;
        // An implicit spring: (wish + square target) / (1 + square); sag-free, gravity as it is in the head's axes
        // leaves the prediction.
        if (extras.sag_free) wish -= h * h * (pose.rotation * g);
        wish = (wish + square * (root + pose.rotation * (rest[i] - rest[0]))) / (1 + square);
      }
      const dvec3 way = wish - p[i - 1];
      const double missing = (segment - glm::length(way)) / (1.5 * segment);
      dvec3 along = glm::normalize(way);
      const double within = std::min(std::max(missing, -1.0), 1.0);
      const dvec3 moved = 1.5 * segment * (within - within * within * within / 3) * along;
      impulse[i - 1] = -static_cast<double>(s.chain.ftl_correction) / h * moved;
      if (extras.cone_deg > 0 && glm::dot(axis, along) < cone_cos[i]) {
        const double c = cone_cos[i];
        along = c * axis + std::sqrt(1 - c * c) * glm::normalize(along - glm::dot(axis, along) * axis);
      }
      p[i] = p[i - 1] + segment * along;
      axis = along;
    }
    for (std::size_t i = 0; i < x.size(); ++i) v[i] = (i == 0 ? 1 : damping) / h * (p[i] - x[i]);
    x = p;
  }
};

/// What Simulation::move_head hands on.
void set_pose(ChainStep& step, const RigidPose& before, const RigidPose& after) {
  const glm::dmat3 a = glm::mat3_cast(before.rotation), b = glm::mat3_cast(after.rotation);
  step.turn = glm::mat3(b);
  step.turn_change = glm::mat3(b - a);
  step.shift = glm::vec3(after.position - before.position);
}

struct Difference {
  double position_m = 0, velocity_m_s = 0;
};

/// Greatest differences over all strands and steps between step_chains and the reference.
Difference differ(ChainStep step, const Extras& extras, double seconds, double jump_m = 0) {
  const Strands hair = mixed_hair(37, dvec3(0));
  StrandBlocks blocks = make_blocks(hair, dvec3(0));
  std::vector<Reference> reference;
  for (std::size_t s = 0; s < hair.count(); ++s) reference.emplace_back(hair.strand(s), extras);
  step.hold_rad_s = static_cast<float>(extras.hold_rad_s), step.hold_tip = static_cast<float>(extras.hold_tip);
  step.sag_free = extras.sag_free;
  ShapeSettings shape;
  shape.cone_deg = static_cast<float>(extras.cone_deg), shape.cone_end = static_cast<float>(extras.cone_end);
  const std::vector<Lanes> cones = cone_limits(blocks, shape);
  if (extras.cone_deg > 0) step.cone_cos = cones;
  const double h = static_cast<double>(step.step_s);
  Difference most;
  RigidPose before = pose_at(0, 0);
  for (int k = 1; k * h <= seconds; ++k) {
    const RigidPose now = pose_at(k * h, jump_m);
    set_pose(step, before, now);
    before = now;
    step_all(blocks, step);
    for (std::size_t s = 0; s < hair.count(); ++s) {
      reference[s].step(step, now, extras);
      const std::size_t block = blocks.block_of[s] / kLanes, lane = blocks.block_of[s] % kLanes;
      const Lanes3& r = blocks.root[block];
      const dvec3 root = now.position + dvec3(r.x[lane], r.y[lane], r.z[lane]);
      for (std::uint32_t i = 0; i < reference[s].x.size(); ++i) {
        const Lanes3& v = blocks.velocity[blocks.first[block] + i];
        most.position_m = std::fmax(most.position_m, glm::distance(root + dvec3(at(blocks, s, i)), reference[s].x[i]));
        most.velocity_m_s =
            std::fmax(most.velocity_m_s, glm::distance(dvec3(v.x[lane], v.y[lane], v.z[lane]), reference[s].v[i]));
      }
    }
  }
  return most;
}

ChainStep default_step() {
  ChainStep step;
  step.chain.gravity = {0.5F, -9.81F, -1};
  return step;
}

TEST(ChainReference, TheFreeRoadIsEquation31) {
  // Float's rounding (ulp of 0.4 m is 3e-8) acts as noise of 3e-8 / h^2 = 7e-3 m/s^2 per vertex, which a chain of 13
  // links passes on; velocities are 480 times positions.
  const Difference d = differ(default_step(), {}, 0.5);
  std::printf("free road: %.1e m, %.1e m/s from double\n", d.position_m, d.velocity_m_s);
  EXPECT_LT(d.position_m, 1e-4);
  EXPECT_LT(d.velocity_m_s, 1e-2);
}

TEST(ChainReference, TheFreeRoadIsEquation31WhateverTheSettings) {
  for (const float s : {1.0F, 0.8F}) {
    for (const float damping : {0.0F, 30.0F}) {
      for (const float h : {1.0F / 120, 1.0F / 1000}) {
        ChainStep step = default_step();
        step.step_s = h;
        step.chain.ftl_correction = s;
        step.chain.damping_per_s = damping;
        const Difference d = differ(step, {}, 0.2);
        EXPECT_LT(d.position_m, 2e-4) << s << ' ' << damping << ' ' << h;
      }
    }
  }
}

TEST(ChainReference, TheCorrectionSaturatesInAJump) {
  // All within a few steps of a jump by 0.3 m, many segments long, before strands that turn over part for good.
  const Difference d = differ(default_step(), {}, 0.0835 + 5.0 / 480, 0.3);
  std::printf("jump: %.1e m, %.1e m/s from double\n", d.position_m, d.velocity_m_s);
  EXPECT_LT(d.position_m, 1e-3);
}

TEST(ChainReference, HoldShapeAndConeAreAsWrittenDown) {
  const std::array<Extras, 5> all{{{.hold_rad_s = 15},
                                   {.hold_rad_s = 30, .hold_tip = 0.3},
                                   {.hold_rad_s = 20, .hold_tip = 0.5, .sag_free = true},
                                   {.cone_deg = 15, .cone_end = 0.6},
                                   {.hold_rad_s = 10, .cone_deg = 30, .cone_end = 1}}};
  for (const Extras& extras : all) {
    const Difference d = differ(default_step(), extras, 0.12);
    std::printf("hold %.0f, cone %.0f: %.1e m, %.1e m/s from double\n", extras.hold_rad_s, extras.cone_deg,
                d.position_m, d.velocity_m_s);
    EXPECT_LT(d.position_m, 1e-3) << extras.hold_rad_s << ' ' << extras.cone_deg;
  }
}

void expect_same_bits(const std::vector<Lanes3>& a, const std::vector<Lanes3>& b, const StrandBlocks& blocks) {
  for (std::size_t s = 0; s < blocks.strands; ++s) {
    const std::size_t block = blocks.block_of[s] / kLanes, l = blocks.block_of[s] % kLanes;
    for (std::uint32_t i = 0; static_cast<float>(i) < blocks.vertices[block].v[l]; ++i) {
      const std::size_t v = blocks.first[block] + i;
      ASSERT_EQ(a[v].x[l], b[v].x[l]) << "strand " << s << " vertex " << i;
      ASSERT_EQ(a[v].y[l], b[v].y[l]);
      ASSERT_EQ(a[v].z[l], b[v].z[l]);
    }
  }
}

TEST(ChainReference, TheConstrainedRoadWithoutConstraintsIsTheFreeOne) {
  const Strands hair = mixed_hair(53, dvec3(0));
  StrandBlocks free = make_blocks(hair, dvec3(0)), constrained = free;
  Lanes none;
  std::fill_n(none.v, kLanes, -1.0F);
  const std::vector<Lanes> cones(free.first.back(), none);
  RigidPose before = pose_at(0, 0);
  for (int k = 1; k <= 240; ++k) {
    ChainStep step = default_step();
    const RigidPose now = pose_at(k / 480.0, 0);
    set_pose(step, before, now);
    before = now;
    step_all(free, step);
    step.cone_cos = cones;
    step_all(constrained, step);
  }
  // The same formulas in the same order.
  expect_same_bits(free.position, constrained.position, free);
  expect_same_bits(free.velocity, constrained.velocity, free);
  expect_same_bits(free.impulse, constrained.impulse, free);
}

TEST(ChainReference, StrandsMoveInCompanyAsTheyDoAlone) {
  const Strands hair = mixed_hair(53, dvec3(0));
  for (const ChainSolver solver : {ChainSolver::dftl, ChainSolver::position_based, ChainSolver::tridiagonal}) {
    for (const bool constrained : {false, true}) {
      const auto move = [&](const Strands& strands) {
        StrandBlocks blocks = make_blocks(strands, dvec3(0));
        ShapeSettings shape;
        shape.cone_deg = 20;
        const std::vector<Lanes> cones = cone_limits(blocks, shape);
        RigidPose before = pose_at(0, 0);
        for (int k = 1; k <= 60; ++k) {
          ChainStep step = default_step();
          step.chain.solver = solver;
          step.hold_rad_s = constrained ? 10 : 0;
          if (constrained) step.cone_cos = cones;
          const RigidPose now = pose_at(k / 480.0, 0);
          set_pose(step, before, now);
          before = now;
          step_all(blocks, step);
        }
        return blocks;
      };
      const StrandBlocks together = move(hair);
      for (std::size_t s = 0; s < hair.count(); s += 3) {
        Strands one;
        one.append(hair.strand(s));
        const StrandBlocks alone = move(one);
        for (std::uint32_t i = 0; i < hair.strand(s).size(); ++i) EXPECT_EQ(at(alone, 0, i), at(together, s, i)) << s;
      }
    }
  }
}

TEST(ChainReference, FastestIsTheGreatestSpeed) {
  const Strands hair = mixed_hair(37, dvec3(0));
  for (const bool constrained : {false, true}) {
    StrandBlocks blocks = make_blocks(hair, dvec3(0));
    ChainStep step = default_step();
    step.chain.damping_per_s = 0;
    if (constrained) step.hold_rad_s = 5;
    std::vector<float> fastest(blocks.count());
    step.shift = {0.001F, 0, 0};
    for (int k = 0; k < 20; ++k) step_chains(blocks, 0, blocks.count(), step, fastest);
    for (std::size_t b = 0; b < blocks.count(); ++b) {
      float most = 0;
      for (std::uint32_t v = blocks.first[b]; v < blocks.first[b + 1]; ++v)
        for (int l = 0; l < kLanes; ++l) {
          if (static_cast<float>(v - blocks.first[b]) >= blocks.vertices[b].v[l]) continue;
          const Lanes3& u = blocks.velocity[v];
          most = std::max(most, u.x[l] * u.x[l] + u.y[l] * u.y[l] + u.z[l] * u.z[l]);
        }
      EXPECT_NEAR(fastest[b] / most, 1, 1e-5);
    }
  }
}

}  // namespace
}  // namespace pelage
