#include "pelage/tradeoff/front.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <random>

namespace pelage {
namespace {

TradeoffRow row(std::string id, double ms, double error, double amount = std::nan("")) {
  TradeoffRow r;
  r.id = std::move(id);
  r.knob = "knob";
  r.amount = amount;
  r.time = {ms, ms, ms, 1};
  r.error = error;
  return r;
}

bool dominates(const TradeoffRow& a, const TradeoffRow& b) {
  const double ta = a.time.median_ms, tb = b.time.median_ms;
  return ta <= tb && a.error <= b.error && (ta < tb || a.error < b.error);
}

TEST(Front, ListsNoDominatedPointAndLeavesOutNoOther) {
  std::mt19937 random(7);
  for (int round = 0; round < 200; ++round) {
    std::vector<TradeoffRow> rows;
    for (int i = 0; i < 30; ++i) {
      // Few different values: ties are many.
      rows.push_back(
          row(std::to_string(i), static_cast<double>(1 + random() % 12), static_cast<double>(1 + random() % 12)));
      if (random() % 8 == 0) rows.back().failed = "out of memory";
    }
    mark_front(rows);
    for (const TradeoffRow& r : rows) {
      bool is_dominated = false, has_twin_before = false;
      for (const TradeoffRow& other : rows) {
        if (!other.failed.empty() || !r.failed.empty()) continue;
        is_dominated = is_dominated || dominates(other, r);
        has_twin_before =
            has_twin_before || (&other < &r && other.time.median_ms == r.time.median_ms && other.error == r.error);
      }
      EXPECT_EQ(r.on_front, r.failed.empty() && !is_dominated && !has_twin_before);
      EXPECT_EQ(r.dominated_by.empty(), r.on_front || !r.failed.empty());
      for (const TradeoffRow& other : rows) {
        if (other.id != r.dominated_by) continue;
        EXPECT_TRUE(other.on_front && (dominates(other, r) || has_twin_before));
      }
    }
  }
}

TEST(Front, PlantedSlowOrWrongPointFallsOff) {
  std::vector<TradeoffRow> rows{row("fast", 1, .1), row("middle", 2, .05), row("fine", 4, .01)};
  mark_front(rows);
  for (const TradeoffRow& r : rows) EXPECT_TRUE(r.on_front) << r.id;
  rows.push_back(row("slow", 2.1, .05));
  rows.push_back(row("wrong", 4, .02));
  mark_front(rows);
  EXPECT_FALSE(rows[3].on_front);
  EXPECT_EQ(rows[3].dominated_by, "middle");
  EXPECT_FALSE(rows[4].on_front);
  EXPECT_EQ(rows[4].dominated_by, "fine");
  for (int i = 0; i < 3; ++i) EXPECT_TRUE(rows[static_cast<std::size_t>(i)].on_front);
}

TEST(Slopes, FindsThePowerThatThePointsFollow) {
  std::vector<TradeoffRow> rows;
  for (const double n : {16.0, 32.0, 64.0, 128.0}) rows.push_back(row("a", 0.01 * n * n, 3 * std::pow(n, -0.6), n));
  const std::vector<Curve> curves{{"knob", "", "cells"}, {"other", "", "cells"}};
  const std::vector<Slope> slopes = fit_slopes(curves, rows);
  ASSERT_EQ(slopes.size(), 2U);
  EXPECT_EQ(slopes[0].against, "cells");
  EXPECT_NEAR(slopes[0].slope, -0.6, 1e-12);
  EXPECT_NEAR(slopes[0].standard_error, 0, 1e-7);
  EXPECT_EQ(slopes[1].against, "ms");
  EXPECT_NEAR(slopes[1].slope, -0.3, 1e-12);
  EXPECT_EQ(slopes[1].points, 4);
}

TEST(Slopes, StandardErrorIsThatOfLeastSquares) {
  std::vector<TradeoffRow> rows;  // ln x = 0, 1, 2, 3; ln y = 0, 1, 1, 3: slope .9
  const double y[] = {0, 1, 1, 3};
  for (int i = 0; i < 4; ++i) rows.push_back(row("a", 1, std::exp(y[i]), std::exp(i)));
  const std::vector<Curve> curves{{"knob", "", ""}};
  const Slope s = fit_slopes(curves, rows).at(0);
  EXPECT_NEAR(s.slope, 0.9, 1e-12);
  EXPECT_NEAR(s.standard_error, std::sqrt(0.7 / 2 / 5), 1e-12);  // residuals .1, .2, -.7, .4
}

TEST(Slopes, LeavesOutNoiseFailuresAndWhatHasNoPlace) {
  std::vector<TradeoffRow> rows;
  for (const double n : {1.0, 2.0, 4.0}) rows.push_back(row("a", n, 1 / n, n));
  rows.push_back(row("noise", 8, .5, 8));
  rows.back().error_bar = .2;
  rows.push_back(row("failed", 16, 9, 16));
  rows.back().failed = "why";
  rows.push_back(row("zero", 32, 0, 32));
  rows.push_back(row("choice", 64, 9));
  rows.push_back(row("negative", 64, 9, -1));
  rows.push_back(row("endless", 64, std::numeric_limits<double>::infinity(), 64));
  const std::vector<Curve> curves{{"knob", "", "n"}};
  const Slope s = fit_slopes(curves, rows).at(0);
  EXPECT_EQ(s.points, 3);
  EXPECT_NEAR(s.slope, -1, 1e-12);
}

TEST(Slopes, OnePointOrOnePlaceHasNone) {
  const std::vector<Curve> curves{{"knob", "", "n"}};
  EXPECT_TRUE(fit_slopes(curves, std::vector<TradeoffRow>{row("a", 1, 1, 1)}).empty());
  EXPECT_TRUE(fit_slopes(curves, std::vector<TradeoffRow>{row("a", 1, 1, 1), row("b", 1, 2, 1)}).empty());
  const auto two = fit_slopes(curves, std::vector<TradeoffRow>{row("a", 1, 1, 1), row("b", 1, 2, 2)});
  ASSERT_EQ(two.size(), 1U);
  EXPECT_TRUE(std::isnan(two[0].standard_error));
}

}  // namespace
}  // namespace pelage
