// The solvers against mechanics: NUMBERS, "Hanging chain", "Pendulum", "Catenary", "DFTL".
#include <gtest/gtest.h>

#include <array>
#include <cstdio>

#include "chains.h"

namespace pelage {
namespace {

constexpr double kGravity = 9.81;
constexpr double kLength = 0.3;

struct Mode {
  int links;
  double x;       // a zero of L_N
  double period;  // T / sqrt(L / g)
};
constexpr double kTurn = 6.283185307179586;
constexpr Mode kFirst[] = {{5, .26356032, 5.473371}, {10, .13779347, 5.352609}, {20, .07053989, 5.289900}};
/// x_2 = omega2^2 / N.
constexpr Mode kSecond[] = {{5, 2.658386 * 2.658386 / 5, kTurn / 2.658386},
                            {10, 2.700842 * 2.700842 / 10, kTurn / 2.700842}};
constexpr double kAmplitude = 0.002;

/// A chain in an exact mode, 2 mm at the tip.
StrandBlocks in_mode(const Mode& mode) {
  return one_chain(chain_in_mode(mode.links, kLength, mode.x, kAmplitude));
}

struct Swing {
  double error;    // of the period, relative
  double damping;  // zeta, from the extremes' decrease
};

/// Greatest |x| of each half swing.
class Extremes {
 public:
  void sample(double x) {
    if (last_ * x < 0) {
      values_.push_back(most_);
      most_ = 0;
    }
    most_ = std::max(most_, std::abs(x));
    last_ = x;
  }
  double zeta() const {
    const double per_half = std::log(values_[1] / values_.back()) / static_cast<double>(values_.size() - 2);
    return per_half / std::sqrt(per_half * per_half + kTurn * kTurn / 4);
  }

 private:
  double last_ = 0, most_ = 0;
  std::vector<double> values_;
};

Swing swing(const Mode& mode, double step_s, double seconds = 6, float correction = 1) {
  StrandBlocks chain = in_mode(mode);
  ChainStep step = undamped(step_s);
  step.chain.ftl_correction = correction;
  SwingClock clock;
  Extremes extremes;
  const int steps = static_cast<int>(seconds / step_s);
  for (int k = 1; k <= steps; ++k) {
    step_all(chain, step);
    const double x = static_cast<double>(at(chain, 0, static_cast<std::uint32_t>(mode.links)).x);
    clock.sample(k * step_s, x);
    extremes.sample(x);
  }
  const double exact = mode.period * std::sqrt(kLength / kGravity);
  return {clock.period_s() / exact - 1, extremes.zeta()};
}

TEST(ChainPhysics, ZerosOfLaguerrePolynomials) {
  for (const Mode& mode : kFirst) {
    EXPECT_NEAR(first_laguerre_zero(mode.links), mode.x, 5e-9);  // NUMBERS' digits
    EXPECT_NEAR(kTurn / std::sqrt(mode.links * mode.x), mode.period, 5e-7);
  }
  EXPECT_DOUBLE_EQ(first_laguerre_zero(1), 1);
  EXPECT_NEAR(first_laguerre_zero(32), .04448937, 5e-9);
}

TEST(ChainPhysics, PeriodsOfAHangingChain) {
  // At 1/1920 s what the step leaves is a sixteenth of NUMBERS' errors at 1/480 s (.13 % for N = 10; N = 20 about
  // three times that); the rest of the tolerance is float's.
  for (const Mode& mode : kFirst) {
    const double error = swing(mode, 1.0 / 1920, 5).error;
    std::printf("N = %d, first mode: %+.3f %%\n", mode.links, 100 * error);
    EXPECT_NEAR(error, 0, .0008);
  }
  for (const Mode& mode : kSecond) {
    const double error = swing(mode, 1.0 / 1920, 2).error;
    std::printf("N = %d, second mode: %+.3f %%\n", mode.links, 100 * error);
    EXPECT_NEAR(error, 0, .004);  // (omega2 / omega1)^2 = 5 times as much
  }
}

TEST(ChainPhysics, PeriodConvergesQuadraticallyWithTheWholeCorrection) {
  // NUMBERS, s = 1, N = 10. The values to a tenth of each and 3e-4, what float makes of 2 mm. (At 1/60 s the weight of
  // ten links moves a vertex by a segment: the correction saturates, and 6.52 % become 5.6 %.)
  const std::array<double, 4> expected{.0170, .0045, .0013, .00039};
  std::array<double, 4> errors{};
  for (std::size_t k = 0; k < errors.size(); ++k) {
    errors[k] = swing(kFirst[1], 1.0 / (120 << k)).error;
    std::printf("s = 1, N = 10, 1/%d s: %+.3f %%\n", 120 << k, 100 * errors[k]);
    EXPECT_NEAR(errors[k], expected[k], 0.1 * expected[k] + 3e-4);
  }
  // Order two; the shortest step is left out, where float is as large as the error.
  const double slope = std::log2(errors[0] / errors[2]) / 2;
  std::printf("slope %.2f\n", slope);
  EXPECT_NEAR(slope, 2, 0.2);
  EXPECT_NEAR(swing(kFirst[0], 1.0 / 480).error, .00049, .00025);
}

TEST(ChainPhysics, APartOfTheCorrectionDoesNotConverge) {
  // NUMBERS, s = .9, N = 10: -3.4, -3.7, -3.80 %: a shorter step does not help.
  const std::array<double, 3> expected{-.034, -.037, -.0380};
  double before = 0;
  for (std::size_t k = 0; k < expected.size(); ++k) {
    const double error = swing(kFirst[1], 1.0 / (240 << k), 6, 0.9F).error;
    std::printf("s = .9, N = 10, 1/%d s: %+.2f %%\n", 240 << k, 100 * error);
    EXPECT_NEAR(error, expected[k], .002);
    EXPECT_LT(error, before);
    before = error;
  }
}

TEST(ChainPhysics, NumericDampingIsAsKnown) {
  // NUMBERS: zeta = omega1 dt (0.5 + 0.177 (N - 1)), a fit; to a tenth.
  for (const int k : {0, 1}) {
    const double omega = kTurn / (kFirst[k].period * std::sqrt(kLength / kGravity));
    for (const int per_s : {480, 960}) {
      const double expected = omega / per_s * (0.5 + 0.177 * (kFirst[k].links - 1));
      const double zeta = swing(kFirst[k], 1.0 / per_s, 4).damping;
      std::printf("N = %d, 1/%d s: zeta %.5f, fit %.5f\n", kFirst[k].links, per_s, zeta, expected);
      EXPECT_NEAR(zeta, expected, 0.1 * expected);
    }
  }
}

/// Time from rest at an angle to the vertical [s].
double quarter_swing(double angle, double step_s) {
  const glm::dvec3 d(std::sin(angle), -std::cos(angle), 0);
  StrandBlocks chain = one_chain(straight_chain(1, static_cast<float>(kLength), glm::vec3(d)));
  const ChainStep step = undamped(step_s);
  double last = static_cast<double>(at(chain, 0, 1).x);
  for (int k = 1;; ++k) {
    step_all(chain, step);
    const double x = static_cast<double>(at(chain, 0, 1).x);
    if (x <= 0) return step_s * (k - x / (x - last));
    last = x;
  }
}

TEST(ChainPhysics, PendulumOfAnyAmplitude) {
  const double t0 = kTurn * std::sqrt(kLength / kGravity);
  const std::array<std::array<double, 2>, 7> exact{{{5, 1.000476},
                                                    {10, 1.001907},
                                                    {30, 1.017409},
                                                    {60, 1.073182},
                                                    {90, 1.180341},
                                                    {120, 1.372881},
                                                    {150, 1.762204}}};
  for (const auto& [degrees, ratio] : exact) {
    // One link loses zeta = omega dt / 2: the first order in dt is extrapolated away. Float adds .06 % at 1/480 s (in
    // double 1.00045 for 5 degrees), .36 % at 1/960: it rounds h^2 g.
    const double angle = degrees * kTurn / 360;
    const double found = 4 * (2 * quarter_swing(angle, 1.0 / 960) - quarter_swing(angle, 1.0 / 480)) / t0;
    std::printf("pendulum %3.0f degrees: T/T0 %.5f, exact %.5f\n", degrees, found, ratio);
    EXPECT_NEAR(found / ratio, 1, .001) << degrees;
  }
}

/// Sag / L of n links between ends r L apart: slopes of the links are evenly spaced.
double discrete_sag(int n, double r) {
  const auto sum = [n](double weight, bool sag) {
    double result = 0;
    for (int k = 0; k < (sag ? n / 2 : n); ++k) {
      const double slope = weight * (0.5 * (n - 1) - k);
      result += (sag ? slope : 1) / std::sqrt(1 + slope * slope) / n;
    }
    return result;
  };
  double low = 0, high = 1e4;
  for (int k = 0; k < 200; ++k) (sum(0.5 * (low + high), false) > r ? low : high) = 0.5 * (low + high);
  return sum(low, true);
}

/// A chain pinned at both ends, hanging as a V at first.
std::vector<glm::vec3> pinned_chain(int n, double r) {
  std::vector<glm::vec3> points;
  const double depth = kLength * std::sqrt(1 - r * r) / n;
  for (int i = 0; i <= n; ++i)
    points.push_back(glm::vec3(glm::dvec3(kLength * r * i / n, -depth * std::min(i, n - i), 0)));
  return points;
}

TEST(ChainPhysics, Catenary) {
  EXPECT_NEAR(discrete_sag(10, .5), .402185, 1e-6);
  EXPECT_NEAR(discrete_sag(20, .5), .399137, 1e-6);
  const std::array<std::array<double, 2>, 3> smooth{{{.2, .472834}, {.5, .398194}, {.8, .265438}}};
  for (const auto& [r, sag] : smooth) {
    EXPECT_NEAR(discrete_sag(2000, r), sag, 1e-5);
    for (const int n : {10, 20}) {
      for (const ChainSolver solver : {ChainSolver::position_based, ChainSolver::tridiagonal}) {
        StrandBlocks chain = one_chain(pinned_chain(n, r));
        ChainStep step = undamped(1.0 / 480);
        step.chain.damping_per_s = 12;
        step.chain.solver = solver;
        step.chain.iterations = solver == ChainSolver::tridiagonal ? 4 : 150;
        step.pin_tips = true;
        for (int k = 0; k < 700; ++k) step_all(chain, step);
        float lowest = 0;
        for (int i = 0; i <= n; ++i) lowest = std::min(lowest, at(chain, 0, static_cast<std::uint32_t>(i)).y);
        const double found = -static_cast<double>(lowest) / kLength;
        std::printf("catenary r = %.1f, n = %d, %s: sag/L %.5f, discrete %.5f, stretch %.1e\n", r, n,
                    solver == ChainSolver::tridiagonal ? "tridiagonal" : "position-based", found, discrete_sag(n, r),
                    worst_stretch(chain));
        // Stretch e lengthens the chain by e L and lets the middle sink by about as much over the slope's sine.
        EXPECT_NEAR(found, discrete_sag(n, r), 1e-3);
        const glm::vec3 end = at(chain, 0, static_cast<std::uint32_t>(n));
        EXPECT_NEAR(end.x, kLength * r, 1e-6);
        EXPECT_NEAR(end.y, 0, 1e-6);
      }
    }
  }
}

TEST(ChainPhysics, WhatFallsFreelyKeepsItsShape) {
  // Head and hair are thrown at 3 m/s and fall: the hair does not notice.
  for (const ChainSolver solver : {ChainSolver::dftl, ChainSolver::position_based, ChainSolver::tridiagonal}) {
    StrandBlocks chain = one_chain(straight_chain(12, 0.3F, {0.6F, 0.8F, 0}));
    ChainStep step = undamped(1.0 / 480);
    step.chain.solver = solver;
    const glm::dvec3 thrown(3, 2, 0), g(0, -kGravity, 0);
    const double h = 1.0 / 480;
    for (Lanes3& v : chain.velocity) v.x[0] = 3, v.y[0] = 2;
    for (int k = 1; k <= 480; ++k) {
      step.shift = glm::vec3(h * thrown + k * h * h * g);
      step_all(chain, step);
    }
    // A place loses up to half an ulp (1.5e-8 m) per step, its velocity 480 times that: after 480 steps, were all of
    // them to one side, 1.7 mm.
    for (std::uint32_t i = 1; i <= 12; ++i) {
      EXPECT_NEAR(at(chain, 0, i).x, 0.6 * 0.025 * i, 1e-3);
      EXPECT_NEAR(at(chain, 0, i).y, 0.8 * 0.025 * i, 1e-3);
    }
    EXPECT_NEAR(chain.velocity[5].x[0], 3, 1e-2);
    EXPECT_NEAR(chain.velocity[5].y[0], 2 - kGravity, 1e-2);
    if (solver == ChainSolver::dftl) {
      EXPECT_LE(worst_stretch(chain), 1e-5);
    }
  }
}

TEST(ChainPhysics, DampingIsPerSecond) {
  // A link that turns in the plane without gravity slows down as exp(-c t).
  for (const double step_s : {1.0 / 240, 1.0 / 480, 1.0 / 960}) {
    StrandBlocks chain = one_chain(straight_chain(1, 0.3F, {1, 0, 0}));
    chain.velocity[1].z[0] = 0.6F;
    ChainStep step = undamped(step_s);
    step.chain.gravity = glm::vec3(0);
    step.chain.damping_per_s = 4;
    const int steps = static_cast<int>(0.5 / step_s + 0.5);
    for (int k = 0; k < steps; ++k) step_all(chain, step);
    const double vx = static_cast<double>(chain.velocity[1].x[0]), vz = static_cast<double>(chain.velocity[1].z[0]);
    EXPECT_NEAR(std::sqrt(vx * vx + vz * vz) / 0.6, std::exp(-4 * 0.5), 0.003 * std::exp(-2.0)) << step_s;
  }
}

TEST(ChainPhysics, HeldWeightSagsByGravityOverOmegaSquared) {
  // A link held horizontally: across it only gravity and the hold act, g cos = omega^2 L sin: L tan(angle) = g /
  // omega^2 whatever the step.
  for (const int per_s : {60, 120, 240, 480, 960}) {
    StrandBlocks chain = one_chain(straight_chain(1, 0.3F, {1, 0, 0}));
    ChainStep step = undamped(1.0 / per_s);
    step.chain.damping_per_s = 40;
    step.hold_rad_s = 25;
    for (int k = 0; k < 3 * per_s; ++k) step_all(chain, step);
    const glm::dvec3 p(at(chain, 0, 1));
    EXPECT_NEAR(-0.3 * p.y / p.x, kGravity / 625, 1e-4 * kGravity / 625) << per_s;
    // The hold is weaker at the tip; lifted by what it would sag it does not sag.
    step.hold_tip = 0.5F;
    for (int k = 0; k < 3 * per_s; ++k) step_all(chain, step);
    const glm::dvec3 q(at(chain, 0, 1));
    EXPECT_NEAR(-0.3 * q.y / q.x, 4 * kGravity / 625, 2e-4 * 4 * kGravity / 625) << per_s;
    step.sag_free = true;
    for (int k = 0; k < 3 * per_s; ++k) step_all(chain, step);
    EXPECT_NEAR(at(chain, 0, 1).y, 0, 1e-6F) << per_s;
  }
}

TEST(ChainPhysics, HoldReturnsAlikeAtAnyInternalStep) {
  // HARD_CASES 22: a link turned aside by .4 rad swings back as x'' = -omega^2 x - c x' of a held weight, however long
  // the step; what the implicit spring damps more, omega^2 h / 2 of it a second, stays within 10 % of the way.
  const auto angles = [](int per_s) {
    StrandBlocks chain = one_chain(straight_chain(1, 0.3F, {1, 0, 0}));
    chain.position[1].x[0] = 0.3F * std::cos(0.4F);
    chain.position[1].z[0] = 0.3F * std::sin(0.4F);
    ChainStep step = undamped(1.0 / per_s);
    step.chain.gravity = glm::vec3(0);
    step.chain.damping_per_s = 8;
    step.hold_rad_s = 15;
    std::vector<double> swing;
    for (int k = 1; k <= per_s; ++k) {
      step_all(chain, step);
      const glm::dvec3 p(at(chain, 0, 1));
      if (k % (per_s / 60) == 0) swing.push_back(std::atan2(p.z, p.x));
    }
    return swing;
  };
  const std::vector<double> fine = angles(960);
  EXPECT_LT(*std::min_element(fine.begin(), fine.end()), -0.02);  // beyond and back
  EXPECT_NEAR(fine.back(), 0, 0.02);
  for (const int per_s : {240, 480}) {
    const std::vector<double> coarse = angles(per_s);
    double most = 0;
    for (std::size_t k = 0; k < fine.size(); ++k) most = std::max(most, std::abs(coarse[k] - fine[k]));
    std::printf("hold at 1/%d s: %.1f %% of the way from 1/960 s\n", per_s, 100 * most / 0.4);
    EXPECT_LT(most, 0.1 * 0.4) << per_s;
  }
}

TEST(ChainPhysics, NothingMovesAtRest) {
  // Kinematic speed is 0 at rest; eq. 3.1's v is (N - 1) g dt at the root, to hold the rest up.
  for (const int links : {1, 7, 31}) {
    StrandBlocks chain = one_chain(straight_chain(links, 0.3F));
    const ChainStep step = undamped(1.0 / 480);
    std::vector<float> fastest(1);
    for (int k = 0; k < 200; ++k) {
      step_chains(chain, 0, 1, step, fastest);
      ASSERT_LT(fastest[0], 1e-9F) << links << " links, step " << k;
    }
    // To 4 %: what saturation takes off, link by link.
    EXPECT_NEAR(chain.impulse[0].y[0] / (static_cast<float>(-links) * 9.81F / 480), 1, 0.04);
    EXPECT_EQ(chain.impulse[static_cast<std::size_t>(links)].y[0], 0.0F);
  }
}

/// Kinetic and potential energy per mass of all vertices [m^2/s^2].
double energy_of(const StrandBlocks& chain) {
  double sum = 0;
  for (std::uint32_t i = 1; i < chain.length(0); ++i) {
    const glm::dvec3 v(chain.velocity[i].x[0], chain.velocity[i].y[0], chain.velocity[i].z[0]);
    sum += 0.5 * (v.x * v.x + v.y * v.y + v.z * v.z) + kGravity * static_cast<double>(at(chain, 0, i).y);
  }
  return sum / static_cast<double>(chain.length(0) - 1);
}

TEST(ChainPhysics, FallingHairGainsNoEnergy) {
  // Let go horizontally, undamped. Above the start by at most what eq. 3.1's delay is worth: a step of the fall, at the
  // whip's speed (m/s) h g = 2 % of g L.
  for (const int links : {5, 15, 30}) {
    StrandBlocks chain = one_chain(straight_chain(links, 0.3F, {1, 0, 0}));
    const ChainStep step = undamped(1.0 / 480);
    double most = -INFINITY, last = 0;
    for (int k = 0; k < 6 * 480; ++k) {
      step_all(chain, step);
      last = energy_of(chain);
      most = std::max(most, last);
    }
    std::printf("let go, %d links: most %+.4f, after 6 s %+.4f of g L\n", links, most / (kGravity * 0.3),
                last / (kGravity * 0.3));
    EXPECT_LE(most, 0.02 * kGravity * 0.3);
    EXPECT_LE(last, 0);
    EXPECT_LE(worst_stretch(chain), 1e-5);
  }
}

TEST(ChainPhysics, SolversStretchByTheirIterations) {
  const auto stretch = [](ChainSolver solver, int iterations) {
    StrandBlocks chain = one_chain(straight_chain(15, 0.3F, {1, 0, 0}));
    ChainStep step = undamped(1.0 / 480);
    step.chain.solver = solver;
    step.chain.iterations = iterations;
    double worst = 0;
    for (int k = 0; k < 480; ++k) {
      step_all(chain, step);
      worst = std::max(worst, worst_stretch(chain));
    }
    return worst;
  };
  double before = 1;
  for (const int iterations : {2, 8, 32, 128}) {
    const double now = stretch(ChainSolver::position_based, iterations);
    std::printf("position-based, %3d iterations: stretch %.2e\n", iterations, now);
    EXPECT_LT(now, 0.6 * before);
    before = now;
  }
  before = 1;
  for (const int iterations : {1, 2, 4}) {
    const double now = stretch(ChainSolver::tridiagonal, iterations);
    std::printf("tridiagonal, %d iterations: stretch %.2e\n", iterations, now);
    EXPECT_LT(now, std::max(0.2 * before, 1e-5));
    before = now;
  }
  EXPECT_LT(before, 1e-5);  // Newton's steps
  EXPECT_LE(stretch(ChainSolver::dftl, 1), 1e-5);
}

}  // namespace
}  // namespace pelage
