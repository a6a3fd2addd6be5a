// The solvers against mechanics: NUMBERS, "Hanging chain", "Pendulum", "Catenary", "DFTL".
#include <gtest/gtest.h>

#include "chains.h"

namespace pelage {
namespace {

constexpr double kGravity = 9.81;
constexpr double kLength = 0.3;

/// Laguerre polynomial L_n(x).
double laguerre(int n, double x) {
  double before = 1, now = 1 - x;
  if (n == 0) return 1;
  for (int k = 1; k < n; ++k) {
    const double next = ((2 * k + 1 - x) * now - k * before) / (k + 1);
    before = now;
    now = next;
  }
  return now;
}

struct Mode {
  int links;
  double x1, period;  // first zero of L_N; T1 / sqrt(L / g)
};
constexpr Mode kModes[] = {{5, .26356032, 5.473371}, {10, .13779347, 5.352609}, {20, .07053989, 5.289900}};

/// A chain in its exact first mode, 2 mm at the tip: u_j = L_j(x_1), j links from the free end.
StrandBlocks in_first_mode(const Mode& mode) {
  const double link = kLength / mode.links;
  std::vector<glm::vec3> points{{0, 0, 0}};
  glm::dvec3 p(0);
  for (int i = 1; i <= mode.links; ++i) {
    const double x = 0.002 * laguerre(mode.links - i, mode.x1);
    const double dx = x - p.x;
    p = {x, p.y - std::sqrt(link * link - dx * dx), 0};
    points.push_back(glm::vec3(p));
  }
  return one_chain(points);
}

struct Swing {
  double error;   // of the period, relative
  double growth;  // greatest amplitude of the tip in the last quarter over that at the start
};

Swing swing(const Mode& mode, double step_s, ChainStep step, double seconds = 6) {
  StrandBlocks chain = in_first_mode(mode);
  SwingClock clock;
  double late = 0;
  const int steps = static_cast<int>(seconds / step_s);
  for (int k = 1; k <= steps; ++k) {
    step_all(chain, step);
    const double x = static_cast<double>(at(chain, 0, static_cast<std::uint32_t>(mode.links)).x);
    clock.sample(k * step_s, x);
    if (4 * k > 3 * steps) late = std::max(late, std::abs(x));
  }
  const double exact = mode.period * std::sqrt(kLength / kGravity);
  return {clock.period_s() / exact - 1, late / 0.002};
}

TEST(ChainPhysics, DftlHasThePeriodOfAHangingChain) {
  // NUMBERS, s = 1: +.049 % (N = 5) and +.13 % (N = 10) at 1/480 s; the tolerance is half of that again, for float.
  EXPECT_NEAR(swing(kModes[0], 1.0 / 480, undamped(1.0 / 480)).error, .00049, .00025);
  EXPECT_NEAR(swing(kModes[1], 1.0 / 480, undamped(1.0 / 480)).error, .0013, .00065);
  EXPECT_NEAR(swing(kModes[1], 1.0 / 240, undamped(1.0 / 240)).error, .0045, .0010);
}

}  // namespace
}  // namespace pelage
