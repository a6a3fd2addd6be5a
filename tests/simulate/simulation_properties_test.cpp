// What holds for all hair, settings, motions and frame times. RapidCheck makes the cases from the seed below (RC_PARAMS
// of the environment goes before it) and prints the numbers of the smallest one that fails.
#include <gtest/gtest.h>
#include <rapidcheck.h>
#include <tbb/global_control.h>
#include <tbb/task_arena.h>

#include <cstdlib>
#include <glm/geometric.hpp>
#include <glm/gtc/quaternion.hpp>

#include "moving.h"
#include "pelage/simulate/head_motion.h"

namespace pelage {
namespace {

using glm::dvec3;
using glm::vec3;

/// Before RapidCheck reads it.
const int kSeeded = setenv("RC_PARAMS", "seed=20120501 max_success=120", 0);

/// Numbers that follow from a seed.
class Dice {
 public:
  explicit Dice(std::uint32_t seed) : state_(seed * 2654435761U + 1) {}
  float operator()(float low, float high) {
    state_ = state_ * 1664525U + 1013904223U;
    return low + (high - low) * static_cast<float>(state_ >> 8) / 16777216.0F;
  }
  /// Evenly over orders of magnitude.
  float scale(float low, float high) { return low * std::pow(high / low, (*this)(0, 1)); }
  bool coin(float share = 0.5F) { return (*this)(0, 1) < share; }
  vec3 direction() {
    const vec3 v((*this)(-1, 1), (*this)(-1, 1), (*this)(-1, 1));
    return glm::normalize(v + vec3(0, 1e-3F, 0));
  }

 private:
  std::uint32_t state_;
};

/// One strand: mostly bent at random, sometimes degenerate.
std::vector<vec3> any_strand(Dice& dice, int vertices, vec3 root) {
  const float length = dice.scale(0.001F, 1), segment = length / static_cast<float>(std::max(vertices - 1, 1));
  const int kind = static_cast<int>(dice(0, 12));
  std::vector<vec3> points{root};
  vec3 d = dice.direction();
  for (int i = 1; i < vertices; ++i) {
    if (kind == 0) d = vec3(0);        // no length
    if (kind == 1) d = -d;             // folded to and fro
    if (kind == 2) d = vec3(0, 1, 0);  // straight up
    if (kind > 3) d = glm::normalize(d + 0.5F * dice.direction());
    points.push_back(points.back() + segment * d);
    if (kind == 3 && i == vertices - 1) points.back() = root;  // a closed loop
  }
  return points;
}

Strands any_hair(std::uint32_t seed, int strands, int most_vertices) {
  Dice dice(seed);
  Strands hair;
  const float spread = dice.scale(0.001F, 0.3F);
  const vec3 place = dice.scale(0.01F, 10) * dice.direction();
  for (int s = 0; s < strands; ++s) {
    const int vertices = 1 + static_cast<int>(dice(0, static_cast<float>(most_vertices)));
    hair.append(any_strand(dice, std::min(vertices, most_vertices), place + spread * dice.direction()));
  }
  return hair;
}

/// Anything within the documented ranges; 0, which switches an effect off, often.
SimulationSettings any_settings(std::uint32_t seed) {
  Dice dice(seed ^ 0x9E3779B9U);
  SimulationSettings s;
  s.chain.ftl_correction = dice.coin() ? 1.0F : dice(0.6F, 1);
  s.chain.damping_per_s = dice.coin(0.2F) ? 0.0F : dice.scale(0.1F, 1000);
  s.interaction.cell_m = dice.scale(0.01F, 0.1F);  // smaller ones do not reach across 2 m
  s.interaction.friction_per_s = dice.coin(0.4F) ? 0.0F : dice.scale(0.1F, 1000);
  s.interaction.repulsion_m_s2 = dice.coin(0.4F) ? 0.0F : dice.scale(0.1F, 100);
  s.interaction.repulsion = dice.coin() ? RepulsionKind::gradient : RepulsionKind::overfull;
  s.interaction.overfull = dice(0, 10);
  if (dice.coin(0.4F)) s.wind.velocity_m_s = dice.scale(0.1F, 30) * dice.direction();
  s.wind.gust = dice(0, 4);
  s.wind.drag_per_s = dice.scale(0.01F, 1000);
  s.wind.shelter = dice(0, 2);
  s.shape.hold_rad_s = dice.coin() ? 0.0F : dice.scale(1, 1000);
  s.shape.hold_tip = dice(0, 1);
  s.shape.sag_free = dice.coin();
  s.shape.cone_deg = dice.coin() ? 0.0F : dice.scale(1, 90);
  s.shape.cone_end = dice(0.05F, 1);
  s.collision.margin_m = dice.coin(0.2F) ? 0.0F : dice.scale(0.0001F, 0.05F);
  s.collision.friction = dice.coin(0.2F) ? 0.0F : dice.scale(0.01F, 10);
  s.life.step_s = static_cast<double>(dice.scale(1.0F / 1900, 1.0F / 60));
  s.life.catch_up_s = static_cast<double>(dice.scale(0.01F, 0.1F));
  s.life.explosion_m_s = 1e6F;
  if (dice.coin(0.3F)) s.life.max_speed_m_s = dice.scale(0.1F, 100);
  s.life.sleep_m_s = dice.coin() ? 0.0F : dice.scale(0.001F, 1);
  s.life.sleep_after_s = dice.scale(0.01F, 1);
  return s;
}

MotionSettings any_motion(std::uint32_t seed) {
  Dice dice(seed ^ 0x51ED270BU);
  MotionSettings m;
  m.kind = static_cast<MotionKind>(static_cast<int>(dice(0, 5.99F)));
  m.amplitude = dice(0, 3);
  m.speed = dice.scale(0.1F, 3);
  return m;
}

/// Frame times from 0.5 ms to 10 s.
double any_frame(Dice& dice) {
  return static_cast<double>(dice.coin() ? 1.0F / 60 : dice.scale(0.0005F, 10));
}

struct Numbers {
  std::uint32_t seed;
  int strands, vertices, frames;
};
Numbers any_numbers() {
  return {*rc::gen::inRange<std::uint32_t>(0, 1000000).as("seed"), *rc::gen::inRange(1, 61).as("strands"),
          *rc::gen::inRange(1, 25).as("vertices"), *rc::gen::inRange(1, 13).as("frames")};
}

void play(Simulation& simulation, const Numbers& n) {
  Dice dice(n.seed);
  const MotionSettings motion = any_motion(n.seed);
  double time = 0;
  for (int k = 0; k < n.frames; ++k) {
    const double frame = any_frame(dice);
    time += frame;
    simulation.advance(frame, head_pose(motion, simulation.pivot(), time));
  }
}

/// A ball at the groom's place that goes with the head, deep enough to hold some roots and to leave others outside.
ColliderCapsule ball_within(const Strands& hair, std::uint32_t seed) {
  Dice dice(seed ^ 0x7F4A7C15U);
  const vec3 centre = hair.vertices[0] + dice.scale(0.001F, 0.2F) * dice.direction();
  return {.from = centre, .to = centre, .radius_m = dice.scale(0.001F, 0.2F), .with_head = true};
}

bool all_finite(const Strands& hair) {
  for (const vec3& p : hair.vertices)
    if (!std::isfinite(p.x + p.y + p.z)) return false;
  return true;
}

TEST(SimulationProperties, HairIsFiniteAndDoesNotStretch) {
  EXPECT_TRUE(rc::check([] {
    const Numbers n = any_numbers();
    const Strands hair = any_hair(n.seed, n.strands, n.vertices);
    SimulationSettings s = any_settings(n.seed);
    if (n.seed % 3 != 0) s.collision.capsules = {ball_within(hair, n.seed)};
    Simulation simulation(hair, {}, s);
    play(simulation, n);
    Strands now = hair;
    simulation.positions(now);
    RC_ASSERT(all_finite(now));
    if (simulation.facts().steps == 0) return;  // still the groom, whose segments are what they are
    const double worst = worst_stretch_of(simulation);
    if (worst > 1e-5) RC_LOG() << "stretch " << worst;
    RC_ASSERT(worst <= 1e-5);
  }));
}

TEST(SimulationProperties, HairStaysOutsideWhereItWas) {
  EXPECT_TRUE(rc::check([] {
    const Numbers n = any_numbers();
    const Strands hair = any_hair(n.seed, n.strands, n.vertices);
    SimulationSettings s = any_settings(n.seed);
    const ColliderCapsule ball = ball_within(hair, n.seed);
    s.collision.capsules = {ball};
    Simulation simulation(hair, {}, s);
    play(simulation, n);
    // After whole steps the head is where the hair was stepped to.
    const StrandBlocks& b = simulation.blocks();
    simulation.teleport({simulation.pivot(), glm::dquat(1.0, 0.0, 0.0, 0.0)});
    const dvec3 centre = dvec3(ball.from) - simulation.pivot();
    const auto depth = [&](const Lanes3& relative, const Lanes3& root, std::size_t l) {
      const dvec3 p(static_cast<double>(relative.x[l]) + static_cast<double>(root.x[l]),
                    static_cast<double>(relative.y[l]) + static_cast<double>(root.y[l]),
                    static_cast<double>(relative.z[l]) + static_cast<double>(root.z[l]));
      return glm::distance(p, centre) - static_cast<double>(ball.radius_m);
    };
    for (std::size_t strand = 0; strand < b.strands; ++strand) {
      const std::size_t block = b.block_of[strand] / kLanes, l = b.block_of[strand] % kLanes;
      // A vertex gets as far out as the one before it was, at least: straight out.
      double promised = static_cast<double>(s.collision.margin_m);
      for (std::uint32_t i = 0; static_cast<float>(i) < b.vertices[block].v[l]; ++i) {
        const std::size_t v = b.first[block] + i;
        promised = std::min(promised, depth(b.rest[v], b.root_rest[block], l));
        const double now = depth(b.position[v], b.root_rest[block], l);
        if (now < promised - 1e-5)
          RC_LOG() << "strand " << strand << ", vertex " << i << ": " << now << " m, was " << promised;
        RC_ASSERT(now >= promised - 1e-5);
      }
    }
  }));
}

TEST(SimulationProperties, SameBitsForOneAndThreeThreads) {
  EXPECT_TRUE(rc::check([] {
    const Numbers n = any_numbers();
    const auto hash = [&](int threads) {
      const tbb::global_control limit(tbb::global_control::max_allowed_parallelism, 4);
      std::uint64_t result = 0;
      tbb::task_arena(threads).execute([&] {
        // Enough blocks for several tasks.
        Strands hair;
        for (std::uint32_t k = 0; k < 8; ++k) {
          const Strands some = any_hair(n.seed + (k << 20), n.strands, n.vertices);
          for (std::size_t i = 0; i < some.count(); ++i) {
            std::vector<vec3> line(some.strand(i).begin(), some.strand(i).end());
            for (vec3& p : line) p = 0.2F * (p - line[0]) + 0.01F * some.strand(i)[0];
            hair.append(line);
          }
        }
        SimulationSettings s = any_settings(n.seed);
        s.interaction.friction_per_s = 5;

        s.life.catch_up_s = 0.02;
        Simulation simulation(hair, {}, s);
        play(simulation, n);
        result = simulation.state_hash();
      });
      return result;
    };
    RC_ASSERT(hash(1) == hash(3));
  }));
}

TEST(SimulationProperties, TeleportKeepsTheShape) {
  EXPECT_TRUE(rc::check([] {
    const Numbers n = any_numbers();
    const Strands hair = any_hair(n.seed, n.strands, n.vertices);
    Simulation simulation(hair, {}, any_settings(n.seed));
    play(simulation, n);
    Dice dice(n.seed + 7);
    const auto pose = [&] {
      return RigidPose{dvec3(dice(-5, 5), dice(-5, 5), dice(-5, 5)),
                       glm::angleAxis(static_cast<double>(dice(-3, 3)), dvec3(dice.direction()))};
    };
    const RigidPose here = pose(), there = pose();
    Strands before = hair, after = hair;
    simulation.teleport(here);
    simulation.positions(before);
    simulation.teleport(there);
    simulation.positions(after);
    for (std::size_t v = 0; v < before.vertices.size(); ++v) {
      const dvec3 local = glm::conjugate(here.rotation) * (dvec3(before.vertices[v]) - here.position);
      RC_ASSERT(glm::distance(dvec3(after.vertices[v]), there.position + there.rotation * local) < 5e-6);
    }
  }));
}

TEST(SimulationProperties, TheWorldHasNoPreferredAzimuth) {
  // Groom, motion, wind and collider turned about the vertical: so is what comes out. Without the grid, whose cells lie
  // along the axes. Gentle and damped, so that rounding does not grow into another fall of the strands.
  EXPECT_TRUE(rc::check([] {
    Numbers n = any_numbers();
    Dice dice(n.seed + 3);
    const glm::dquat turn = glm::angleAxis(static_cast<double>(dice(-3, 3)), dvec3(0, 1, 0));
    const auto turned_by = [&](const vec3& p) { return vec3(turn * dvec3(p)); };
    Strands hair;
    for (int k = 0; k < n.strands; ++k) {
      const vec3 out = dice.direction();
      std::vector<vec3> points{0.1F * out};
      for (int i = 1; i < n.vertices; ++i)
        points.push_back(points.back() + 0.01F * glm::normalize(out + 0.3F * dice.direction()));
      hair.append(points);
    }
    // Corners that keep the pivot in the middle: the frame's motion is even along the pivot's chord, not another's.
    for (const vec3& corner : {vec3(0.5F), vec3(-0.5F), vec3(0.5F, 0.5F, -0.5F), vec3(-0.5F, -0.5F, 0.5F)})
      hair.append(std::vector<vec3>{corner});
    Strands turned_hair = hair;
    for (vec3& p : turned_hair.vertices) p = turned_by(p);
    SimulationSettings s = bare(false);
    s.chain.damping_per_s = 20;
    s.shape.hold_rad_s = 40;  // upright hair does not buckle, which would let rounding grow
    s.shape.hold_tip = 1;
    s.life.sleep_m_s = 0;
    s.wind.velocity_m_s = {2, 0.3F, -1};
    s.wind.shelter = 0;
    s.collision.capsules = {{.from = {0, 0, 0}, .to = {0, 0, 0.02F}, .radius_m = 0.07F, .with_head = true}};
    SimulationSettings turned_s = s;
    turned_s.wind.velocity_m_s = turned_by(s.wind.velocity_m_s);
    turned_s.collision.capsules[0].to = turned_by(s.collision.capsules[0].to);
    Simulation one(hair, {}, s), other(turned_hair, {}, turned_s);
    for (int k = 1; k <= 15; ++k) {
      const RigidPose p{one.pivot() + dvec3(0.002 * k, 0.001 * k, 0),
                        glm::angleAxis(0.02 * k, glm::normalize(dvec3(1, 2, 0)))};
      const glm::dquat r = turn * p.rotation * glm::conjugate(turn);
      one.advance(1.0 / 60, p);
      other.advance(1.0 / 60, {turn * p.position + r * (other.pivot() - turn * one.pivot()), r});
    }
    Strands a = hair, b = hair;
    one.positions(a);
    other.positions(b);
    double worst = 0;
    for (std::size_t v = 0; v < a.vertices.size(); ++v)
      worst = std::max(worst, static_cast<double>(glm::distance(turned_by(a.vertices[v]), b.vertices[v])));
    if (worst > 1e-4) RC_LOG() << "worst " << worst << " m";
    RC_ASSERT(worst <= 1e-4);
  }));
}

}  // namespace
}  // namespace pelage
