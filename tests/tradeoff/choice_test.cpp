#include "pelage/tradeoff/choice.h"

#include <gtest/gtest.h>

#include <cmath>
#include <random>
#include <stdexcept>

namespace pelage {
namespace {

/// Error falls with the square root of time; three references of different size.
std::vector<Candidate> ladder() {
  std::vector<Candidate> result;
  for (int i = 0; i < 12; ++i) {
    const double ms = std::pow(1.6, i), error = 0.2 / std::sqrt(ms);
    result.push_back({{"n=" + std::to_string(i)}, {error, 0.5 * error, 1.4 * error}, {ms, 3 * ms, 0.5 * ms}});
  }
  return result;
}

/// A scene three times as hard and seven times as slow as the references.
Probe other_scene(std::size_t c) {
  const double ms = std::pow(1.6, static_cast<double>(c));
  return {3 * 0.2 / std::sqrt(ms), 0, 7 * ms};
}

TEST(Choose, TargetIsMetByTheCheapest) {
  for (const double target : {.5, .3, .12, .06}) {
    const Choice c = choose(ladder(), {.budget_ms = {}, .target_error = target}, other_scene, 5);
    EXPECT_TRUE(c.met);
    EXPECT_LE(c.probe.error, target);
    ASSERT_GT(c.candidate, 0U);
    EXPECT_GT(other_scene(c.candidate - 1).error, target) << "a cheaper one would have done";
    EXPECT_LE(c.tried.size(), 4U);
  }
}

TEST(Choose, BudgetBuysTheMostAccurate) {
  for (const double budget : {20.0, 100.0, 500.0}) {
    const Choice c = choose(ladder(), {.budget_ms = budget, .target_error = {}}, other_scene, 5);
    EXPECT_TRUE(c.met);
    EXPECT_LE(c.probe.ms, budget);
    EXPECT_GT(other_scene(c.candidate + 1).ms, budget) << "a more accurate one would have done";
  }
}

TEST(Choose, PredictsFromOtherProbes) {
  const Choice c = choose(ladder(), {.budget_ms = {}, .target_error = .12}, other_scene, 5);
  ASSERT_GE(c.tried.size(), 2U);
  EXPECT_NEAR(c.predicted_error, c.probe.error, 1e-9);  // the ratios of this scene are the references' own
  EXPECT_NEAR(c.predicted_ms, c.probe.ms, 1e-9);
}

TEST(Choose, SaysWhatComesClosest) {
  const Choice fine = choose(ladder(), {.budget_ms = {}, .target_error = 1e-6}, other_scene, 5);
  EXPECT_FALSE(fine.met);
  EXPECT_EQ(fine.candidate, ladder().size() - 1);
  const Choice fast = choose(ladder(), {.budget_ms = 1e-3, .target_error = {}}, other_scene, 5);
  EXPECT_FALSE(fast.met);
  EXPECT_EQ(fast.candidate, 0U);
  const Choice both = choose(ladder(), {.budget_ms = 30, .target_error = .06}, other_scene, 8);
  EXPECT_FALSE(both.met);
}

TEST(Choose, BothGoalsGiveTheCheapestOfTheTarget) {
  const Choice c = choose(ladder(), {.budget_ms = 1000, .target_error = .12}, other_scene, 8);
  const Choice target_alone = choose(ladder(), {.budget_ms = {}, .target_error = .12}, other_scene, 8);
  EXPECT_TRUE(c.met);
  EXPECT_EQ(c.candidate, target_alone.candidate);
}

TEST(Choose, ErrorBarIsKeptClear) {
  const auto noisy = [](std::size_t c) {
    Probe p = other_scene(c);
    p.error_bar = 0.1 * p.error;
    return p;
  };
  const Choice c = choose(ladder(), {.budget_ms = {}, .target_error = .12}, noisy, 6);
  EXPECT_TRUE(c.met);
  EXPECT_LE(c.probe.error + c.probe.error_bar, .12);
}

TEST(Choose, ScenesUnlikeTheReferencesStillMeetTheirGoals) {
  std::mt19937 random(3);
  std::normal_distribution<double> spread(0, 0.3);
  const std::vector<Candidate> candidates = ladder();
  for (int scene = 0; scene < 100; ++scene) {
    std::vector<Probe> probes;
    for (std::size_t c = 0; c < candidates.size(); ++c) {
      Probe p = other_scene(c);
      p.error *= std::exp(spread(random));
      p.ms *= std::exp(spread(random));
      probes.push_back(p);
    }
    int asked = 0;
    const Choice c = choose(
        candidates, {.budget_ms = {}, .target_error = .2},
        [&](std::size_t i) {
          ++asked;
          return probes[i];
        },
        12);
    EXPECT_TRUE(c.met);
    EXPECT_LE(c.probe.error, .2);
    EXPECT_EQ(static_cast<std::size_t>(asked), c.tried.size()) << "nothing is probed twice";
  }
}

TEST(Choose, RefusesWhatItCannotDo) {
  EXPECT_THROW(choose({}, {.budget_ms = 1, .target_error = {}}, other_scene, 3), std::invalid_argument);
  EXPECT_THROW(choose(ladder(), {}, other_scene, 3), std::invalid_argument);
  std::vector<Candidate> uneven = ladder();
  uneven[2].ms.pop_back();
  EXPECT_THROW(choose(uneven, {.budget_ms = 1, .target_error = {}}, other_scene, 3), std::invalid_argument);
}

}  // namespace
}  // namespace pelage
