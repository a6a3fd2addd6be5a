// Life of the whole simulation: HARD_CASES 8, 9, 22, 23, 24, 28, 29, and the failure that paper C reports.
#include "pelage/simulate/simulation.h"

#include <gtest/gtest.h>
#include <tbb/global_control.h>
#include <tbb/task_arena.h>

#include <glm/geometric.hpp>

#include "moving.h"
#include "pelage/data_schema/errors.h"
#include "pelage/simulate/head_motion.h"

namespace pelage {
namespace {

constexpr double kPi = 3.14159265358979;

/// Runs a motion; the greatest speeds of vertices and roots over all frames.
struct Speeds {
  float vertex = 0, root = 0;
};
Speeds run(Simulation& simulation, const MotionSettings& motion, double seconds, double fps) {
  Speeds speeds;
  for (int k = 1; k <= static_cast<int>(seconds * fps + 0.5); ++k) {
    simulation.advance(1 / fps, head_pose(motion, simulation.pivot(), k / fps));
    speeds.vertex = std::max(speeds.vertex, simulation.facts().fastest_m_s);
    speeds.root = std::max(speeds.root, simulation.facts().fastest_root_m_s);
  }
  return speeds;
}

void settle(Simulation& simulation, double seconds = 2) {
  for (int k = 0; k < static_cast<int>(60 * seconds); ++k)
    simulation.advance(1.0 / 60, {simulation.pivot(), glm::dquat(1.0, 0.0, 0.0, 0.0)});
}

struct Abrupt {
  const char* name;
  MotionKind kind;
  bool grid;
};

class TipsDoNotFly : public ::testing::TestWithParam<Abrupt> {};

/// [Almeida2014 section 4]: "When the head makes an abrupt movement, the end points of the strand increase its velocity
/// and moves quickly in random directions"; "without the voxel grid the same behavior occurs in about 10 of 4000
/// strands". Speed caps are off.
TEST_P(TipsDoNotFly, AfterAbruptMovesOfTheHead) {
  SimulationSettings s = bare(GetParam().grid);
  ASSERT_EQ(s.life.max_speed_m_s, 0);
  Simulation simulation(ball_of_hair(4000, 16), {}, s);
  settle(simulation, 1);
  MotionSettings motion;
  motion.kind = GetParam().kind;
  const Speeds speeds = run(simulation, motion, 1.2, 60);
  std::printf("%s: fastest vertex %.2f m/s, fastest root %.2f m/s, ratio %.2f\n", GetParam().name,
              static_cast<double>(speeds.vertex), static_cast<double>(speeds.root),
              static_cast<double>(speeds.vertex / speeds.root));
  EXPECT_LE(speeds.vertex, 3 * speeds.root);
  EXPECT_LE(worst_stretch_of(simulation), 1e-5);
}

INSTANTIATE_TEST_SUITE_P(Simulation, TipsDoNotFly,
                         ::testing::Values(Abrupt{"shake_with_grid", MotionKind::shake, true},
                                           Abrupt{"shake_without_grid", MotionKind::shake, false},
                                           Abrupt{"jump_with_grid", MotionKind::jump, true},
                                           Abrupt{"jump_without_grid", MotionKind::jump, false},
                                           Abrupt{"turn_with_grid", MotionKind::turn, true},
                                           Abrupt{"turn_without_grid", MotionKind::turn, false}),
                         [](const auto& move) { return std::string(move.param.name); });

TEST(Simulation, HalfTurnInOneFrameComesToRest) {
  for (const bool grid : {true, false}) {
    Simulation simulation(ball_of_hair(200, 16), {}, bare(grid));
    settle(simulation);
    float fastest = 0, root = 0;
    for (int k = 0; k < 300; ++k) {
      simulation.advance(1.0 / 60, turned(simulation.pivot(), kPi));
      fastest = std::max(fastest, simulation.facts().fastest_m_s);
      root = std::max(root, simulation.facts().fastest_root_m_s);
    }
    EXPECT_LE(fastest, 3 * root);                      // 18.7 m/s
    EXPECT_LT(simulation.facts().fastest_m_s, 0.05F);  // after 5 s
    EXPECT_LE(worst_stretch_of(simulation), 1e-5);
  }
}

TEST(Simulation, FrameRatesAgree) {
  // HARD_CASES 22: the same motion within 10 % at 24 to 240 Hz: of the tips' way, RMS over tips and a tenth of seconds.
  const auto tips_at = [](double fps) {
    Simulation simulation(ball_of_hair(60, 12), {}, bare());
    MotionSettings motion;
    motion.kind = MotionKind::shake;
    std::vector<glm::vec3> tips;
    Strands out = ball_of_hair(60, 12);
    const int frames = static_cast<int>(1.5 * fps + 0.5);
    for (int k = 1; k <= frames; ++k) {
      simulation.advance(1 / fps, head_pose(motion, simulation.pivot(), k / fps));
      if (k % static_cast<int>(fps / 8 + 0.5) != 0) continue;
      simulation.positions(out);
      for (std::size_t s = 0; s < out.count(); ++s) tips.push_back(out.strand(s).back());
    }
    return tips;
  };
  const std::vector<glm::vec3> reference = tips_at(240);
  const Strands rest = ball_of_hair(60, 12);
  for (const double fps : {24.0, 48.0, 96.0, 120.0}) {
    const std::vector<glm::vec3> tips = tips_at(fps);
    ASSERT_EQ(tips.size(), reference.size());
    double error = 0, way = 0;
    for (std::size_t k = 0; k < tips.size(); ++k) {
      const glm::vec3 e = tips[k] - reference[k], w = reference[k] - rest.strand(k % 60).back();
      error += static_cast<double>(glm::dot(e, e));
      way += static_cast<double>(glm::dot(w, w));
    }
    EXPECT_LT(std::sqrt(error / way), 0.10) << fps;
    std::printf("%.0f Hz: %.2f %% of the way from 240 Hz\n", fps, 100 * std::sqrt(error / way));
  }
}

TEST(Simulation, InternalStepsAgree) {
  // HARD_CASES 22: friction, repulsion, damping and hold-shape at once, at 1/240 to 1/960 s: the tips' way within 10 %.
  const auto tips_at = [](int per_s) {
    SimulationSettings s = bare();
    s.life.step_s = 1.0 / per_s;
    s.shape.hold_rad_s = 12;
    Simulation simulation(ball_of_hair(60, 12), {}, s);
    MotionSettings motion;
    motion.kind = MotionKind::shake;
    std::vector<glm::vec3> tips;
    Strands out = ball_of_hair(60, 12);
    for (int k = 1; k <= 90; ++k) {
      simulation.advance(1.0 / 60, head_pose(motion, simulation.pivot(), k / 60.0));
      simulation.positions(out);
      for (std::size_t strand = 0; strand < out.count(); ++strand) tips.push_back(out.strand(strand).back());
    }
    return tips;
  };
  const std::vector<glm::vec3> fine = tips_at(960);
  const Strands rest = ball_of_hair(60, 12);
  for (const int per_s : {240, 480}) {
    const std::vector<glm::vec3> tips = tips_at(per_s);
    double error = 0, way = 0;
    for (std::size_t k = 0; k < tips.size(); ++k) {
      const glm::vec3 e = tips[k] - fine[k], w = fine[k] - rest.strand(k % 60).back();
      error += static_cast<double>(glm::dot(e, e));
      way += static_cast<double>(glm::dot(w, w));
    }
    std::printf("1/%d s: %.1f %% of the way from 1/960 s\n", per_s, 100 * std::sqrt(error / way));
    EXPECT_LT(std::sqrt(error / way), 0.10) << per_s;
  }
}

TEST(Simulation, TipsDoNotFlyAtAnyFrameTime) {
  // HARD_CASES 23: frames of .5 ms to 10 s and a random mix; no speed caps.
  for (const double frame_s : {0.0005, 0.002, 0.05, 0.25, 1.0, 10.0, 0.0}) {  // 0: the mix
    Simulation simulation(ball_of_hair(50, 16), {}, bare());
    ASSERT_EQ(bare().life.max_speed_m_s, 0);
    settle(simulation, 1);
    MotionSettings motion;
    motion.kind = MotionKind::dance;
    float fastest = 0, root = 0;
    double time = 0;
    std::uint32_t random = 7;
    for (int k = 0; k < (frame_s > 0 && frame_s < 0.01 ? 1000 : 40); ++k) {
      random = random * 1664525U + 1013904223U;
      const double frame =
          frame_s > 0 ? frame_s : 0.0005 * std::pow(20000.0, static_cast<double>(random >> 8) / 16777216.0);
      time += frame;
      simulation.advance(frame, head_pose(motion, simulation.pivot(), time));
      fastest = std::max(fastest, simulation.facts().fastest_m_s);
      root = std::max(root, simulation.facts().fastest_root_m_s);
    }
    std::printf("frames of %g s: fastest vertex %.2f m/s, root %.2f m/s\n", frame_s, static_cast<double>(fastest),
                static_cast<double>(root));
    EXPECT_GT(root, 0.1F);
    EXPECT_LE(fastest, 3 * std::max(root, 0.5F)) << frame_s;
    EXPECT_LE(worst_stretch_of(simulation), 1e-5);
  }
}

TEST(Simulation, AnyFrameTimesStayFinite) {
  Simulation simulation(ball_of_hair(100, 16), {}, bare());
  MotionSettings motion;
  motion.kind = MotionKind::dance;
  double time = 0;
  std::uint32_t random = 1;
  for (int k = 0; k < 200; ++k) {
    random = random * 1664525U + 1013904223U;
    const double share = static_cast<double>(random >> 8) / 16777216.0;
    const double frame = 0.0005 * std::pow(20000.0, share);  // 0.5 ms to 10 s
    time += frame;
    simulation.advance(frame, head_pose(motion, simulation.pivot(), time));
    ASSERT_LE(worst_stretch_of(simulation), 1e-5) << "frame " << k << " of " << frame << " s";
  }
  EXPECT_GT(simulation.facts().dropped_s, 0);
}

TEST(Simulation, ShortFramesAddUp) {
  Simulation fine(ball_of_hair(10, 8), {}, bare()), coarse(ball_of_hair(10, 8), {}, bare());
  const RigidPose still{fine.pivot(), glm::dquat(1.0, 0.0, 0.0, 0.0)};
  for (int k = 0; k < 400; ++k) fine.advance(0.0005, still);
  for (int k = 0; k < 4; ++k) coarse.advance(0.05, still);
  EXPECT_EQ(fine.facts().steps, coarse.facts().steps);
}

TEST(Simulation, RefusesWhatItCannotDo) {
  SimulationSettings s = bare();
  s.life.step_s = 1.0 / 4000;
  EXPECT_THROW(Simulation(ball_of_hair(2, 4), {}, s), UsageError);
  s = bare();
  s.chain.ftl_correction = 0.5F;
  EXPECT_THROW(Simulation(ball_of_hair(2, 4), {}, s), UsageError);
  Simulation simulation(ball_of_hair(2, 4), {}, bare());
  const RigidPose still{simulation.pivot(), glm::dquat(1.0, 0.0, 0.0, 0.0)};
  EXPECT_THROW(simulation.advance(NAN, still), UsageError);
  EXPECT_THROW(simulation.advance(-1, still), UsageError);
  EXPECT_THROW(simulation.advance(0.01, {glm::dvec3(NAN), still.rotation}), UsageError);
  EXPECT_THROW(simulation.advance(0.01, {still.position, glm::dquat(0.0, 0.0, 0.0, 0.0)}), UsageError);
}

TEST(Simulation, SameBitsForAnyNumberOfThreads) {
  const auto hash = [](int threads) {
    const tbb::global_control limit(tbb::global_control::max_allowed_parallelism, 8);
    std::uint64_t result = 0;
    tbb::task_arena(threads).execute([&] {
      Simulation simulation(ball_of_hair(700, 16), {}, bare());
      MotionSettings motion;
      motion.kind = MotionKind::shake;
      run(simulation, motion, 0.3, 60);
      result = simulation.state_hash();
    });
    return result;
  };
  const std::uint64_t one = hash(1);
  for (const int threads : {2, 3, 8}) EXPECT_EQ(hash(threads), one) << threads;
}

TEST(Simulation, HashTellsStatesApart) {
  Simulation a(ball_of_hair(20, 8), {}, bare()), b(ball_of_hair(20, 8), {}, bare());
  EXPECT_EQ(a.state_hash(), b.state_hash());
  settle(a, 0.1);
  EXPECT_NE(a.state_hash(), b.state_hash());
  settle(b, 0.1);
  EXPECT_EQ(a.state_hash(), b.state_hash());
}

TEST(Simulation, TeleportKeepsTheShape) {
  Simulation simulation(ball_of_hair(50, 16), {}, bare());
  settle(simulation, 1);
  Strands before = ball_of_hair(50, 16), after = before;
  simulation.positions(before);
  const glm::dvec3 shift(5, -2, 30);
  const RigidPose there = turned(simulation.pivot(), 1.0, shift);
  simulation.teleport(there);
  simulation.positions(after);
  for (std::size_t v = 0; v < before.vertices.size(); ++v) {
    const glm::dvec3 expected = there.position + there.rotation * (glm::dvec3(before.vertices[v]) - simulation.pivot());
    EXPECT_LT(glm::distance(glm::dvec3(after.vertices[v]), expected), 5e-6);
  }
  simulation.advance(1.0 / 60, there);
  EXPECT_LT(simulation.facts().fastest_m_s, 0.2F);  // nothing was whipped
}

TEST(Simulation, ResetIsTheGroomAtRest) {
  Simulation simulation(ball_of_hair(50, 16), {}, bare());
  const Strands rest = ball_of_hair(50, 16);
  settle(simulation, 0.5);
  simulation.reset();
  Strands now = rest;
  simulation.positions(now);
  for (std::size_t v = 0; v < rest.vertices.size(); ++v)
    EXPECT_LT(glm::distance(now.vertices[v], rest.vertices[v]), 1e-6F);
}

TEST(Simulation, TeleportKeepsTheMotion) {
  // In the middle of a fall one of two is put elsewhere, turned about the vertical: both fall on alike.
  const Strands rest = ball_of_hair(50, 12);
  Simulation here(rest, {}, bare(false)), there(rest, {}, bare(false));
  settle(here, 0.1);
  settle(there, 0.1);
  const RigidPose still{here.pivot(), glm::dquat(1.0, 0.0, 0.0, 0.0)}, away = turned(here.pivot(), 2.0, {3, 1, -2});
  there.teleport(away);
  for (int k = 0; k < 6; ++k) {
    here.advance(1.0 / 60, still);
    there.advance(1.0 / 60, away);
  }
  Strands a = rest, b = rest;
  here.positions(a);
  there.positions(b);
  for (std::size_t v = 0; v < a.vertices.size(); ++v) {
    const glm::dvec3 expected = away.position + away.rotation * (glm::dvec3(a.vertices[v]) - here.pivot());
    ASSERT_LT(glm::distance(glm::dvec3(b.vertices[v]), expected), 1e-4) << v;
  }
}

TEST(Simulation, AfterResetItGoesAsAtFirst) {
  const Strands rest = ball_of_hair(50, 12);
  Simulation used(rest, {}, bare()), fresh(rest, {}, bare());
  settle(used, 0.3);
  used.reset();
  settle(used, 0.2);
  settle(fresh, 0.2);
  Strands a = rest, b = rest;
  used.positions(a);
  fresh.positions(b);
  for (std::size_t v = 0; v < a.vertices.size(); ++v)
    ASSERT_LT(glm::distance(a.vertices[v], b.vertices[v]), 1e-4F) << v;
}

TEST(Simulation, FarFromTheOriginIsAsGoodAsAtIt) {
  // HARD_CASES 9: 1000 km away the same motion, to the last bits of the roots' way.
  const auto shape_after = [](const glm::dvec3& place) {
    Simulation simulation(ball_of_hair(30, 16), {}, bare(false));
    MotionSettings motion;
    motion.kind = MotionKind::shake;
    const glm::dvec3 shift = place - simulation.pivot();
    RigidPose pose = head_pose(motion, simulation.pivot(), 0);
    pose.position += shift;
    simulation.teleport(pose);
    for (int k = 1; k <= 60; ++k) {
      pose = head_pose(motion, simulation.pivot(), k / 60.0);
      pose.position += shift;
      simulation.advance(1.0 / 60, pose);
    }
    return simulation.blocks().position;
  };
  const std::vector<Lanes3> here = shape_after(glm::dvec3(0)), there = shape_after(glm::dvec3(1e6, 0, -1e6));
  for (std::size_t v = 0; v < here.size(); ++v)
    for (int l = 0; l < kLanes; ++l) EXPECT_NEAR(here[v].x[l], there[v].x[l], 1e-4F);
}

TEST(Simulation, HairAtRestFallsAsleepAndWakes) {
  SimulationSettings s = bare();
  s.life.sleep_m_s = 0.01F;
  Simulation simulation(ball_of_hair(64, 12), {}, s);
  settle(simulation, 6);
  EXPECT_EQ(simulation.facts().asleep, 64U);
  const std::uint64_t steps = simulation.facts().steps;
  const double chain_ms = simulation.facts().chain_ms;
  settle(simulation, 1);
  EXPECT_EQ(simulation.facts().steps, steps + 480);
  EXPECT_EQ(simulation.facts().chain_ms, chain_ms);  // nothing ran
  simulation.advance(1.0 / 60, turned(simulation.pivot(), 0.02));
  EXPECT_EQ(simulation.facts().asleep, 0U);
}

TEST(Simulation, SleepingHairEndsWhereWakingHairDoes) {
  SimulationSettings never = bare(), sometimes = bare();
  never.life.sleep_m_s = 0;
  Simulation awake(ball_of_hair(64, 12), {}, never), asleep(ball_of_hair(64, 12), {}, sometimes);
  settle(awake, 12);
  settle(asleep, 12);
  EXPECT_GT(asleep.facts().asleep, 0U);
  Strands a = ball_of_hair(64, 12), b = a;
  awake.positions(a);
  asleep.positions(b);
  double sum = 0, worst = 0;
  for (std::size_t v = 0; v < a.vertices.size(); ++v) {
    const double d = static_cast<double>(glm::distance(a.vertices[v], b.vertices[v]));
    sum += d * d;
    worst = std::max(worst, d);
  }
  std::printf("asleep against awake: RMS %.3f mm, most %.3f mm\n",
              1e3 * std::sqrt(sum / static_cast<double>(a.vertices.size())), 1e3 * worst);
  EXPECT_LT(worst, 0.005);
}

TEST(Simulation, ExplosionsAreNamed) {
  SimulationSettings s = bare(false);
  s.life.explosion_m_s = 0.5F;
  Simulation simulation(ball_of_hair(40, 16), {}, s);
  try {
    for (int k = 1; k < 60; ++k) simulation.advance(1.0 / 60, turned(simulation.pivot(), 0, {0.05 * k, 0, 0}));
    FAIL() << "3 m/s went unnoticed";
  } catch (const SimulationError& error) {
    EXPECT_LT(error.strand, 40U);
    EXPECT_LT(error.vertex, 16U);
    EXPECT_GE(error.frame, 1U);
    EXPECT_NE(std::string(error.what()).find("m/s"), std::string::npos);
  }
}

TEST(Simulation, SpeedCapsHold) {
  SimulationSettings s = bare(false);
  s.life.max_speed_m_s = 1;
  Simulation simulation(ball_of_hair(40, 16), {}, s);
  MotionSettings motion;
  motion.kind = MotionKind::jump;
  for (int k = 1; k <= 60; ++k) {  // the jump is in frame 30
    simulation.advance(1.0 / 60, head_pose(motion, simulation.pivot(), k / 60.0));
    for (const Lanes3& v : simulation.blocks().velocity)
      for (int l = 0; l < kLanes; ++l) ASSERT_LE(v.x[l] * v.x[l] + v.y[l] * v.y[l] + v.z[l] * v.z[l], 1.0001F) << k;
  }
}

TEST(Simulation, DegenerateHairIsHarmless) {
  // HARD_CASES 24: one vertex, no length, coincident vertices, folded back, a closed loop, straight up.
  Strands hair;
  hair.append(std::vector<glm::vec3>{{0, 0, 0}});
  hair.append(std::vector<glm::vec3>{{0.1F, 0, 0}, {0.1F, 0, 0}, {0.1F, 0, 0}});
  hair.append(std::vector<glm::vec3>{{0.2F, 0, 0}, {0.2F, 0.1F, 0}, {0.2F, 0, 0}, {0.2F, 0.1F, 0}});
  hair.append(std::vector<glm::vec3>{{0, 0, 0}, {0.1F, 0, 0}, {0.1F, 0.1F, 0}, {0, 0.1F, 0}, {0, 0, 0}});
  hair.append(std::vector<glm::vec3>{{0.3F, 0, 0}, {0.3F, 0.1F, 0}, {0.3F, 0.2F, 0}});
  for (const ChainSolver solver : {ChainSolver::dftl, ChainSolver::position_based, ChainSolver::tridiagonal}) {
    SimulationSettings s = bare();
    s.chain.solver = solver;
    s.shape.cone_deg = 20;
    s.shape.hold_rad_s = 10;
    Simulation simulation(hair, {}, s);
    MotionSettings motion;
    motion.kind = MotionKind::dance;
    run(simulation, motion, 2, 60);
    Strands now = hair;
    simulation.positions(now);
    for (const glm::vec3& p : now.vertices) EXPECT_TRUE(std::isfinite(glm::length(p)));
    if (solver == ChainSolver::dftl) {
      EXPECT_LE(worst_stretch_of(simulation), 1e-5);
    }
    Simulation none(Strands{}, {}, s);
    none.advance(0.1, {none.pivot(), glm::dquat(1.0, 0.0, 0.0, 0.0)});
  }
}

TEST(Simulation, HoldShapeKeepsAGroom) {
  for (const bool sag_free : {true, false}) {
    SimulationSettings s = bare(false);
    s.shape.hold_rad_s = 25;
    s.shape.hold_tip = 1;
    s.shape.sag_free = sag_free;
    const Strands rest = ball_of_hair(60, 16);
    Simulation simulation(rest, {}, s);
    settle(simulation, 3);
    Strands now = rest;
    simulation.positions(now);
    double most = 0;
    for (std::size_t v = 0; v < rest.vertices.size(); ++v)
      most = std::max(most, static_cast<double>(glm::distance(now.vertices[v], rest.vertices[v])));
    std::printf("hold-shape %s: most %.2f mm from the groom\n", sag_free ? "sag-free" : "sagging", 1e3 * most);
    if (sag_free) {
      EXPECT_LT(most, 0.001);
    } else {
      EXPECT_LT(most, 0.030);  // a free weight would sag by g / omega^2 = 15.7 mm; a chain's tip hangs on all before it
      EXPECT_GT(most, 0.003);
    }
  }
}

}  // namespace
}  // namespace pelage
