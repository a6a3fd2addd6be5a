#include "pelage/tradeoff/combine.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

namespace pelage {
namespace {

using testing::ElementsAre;
using testing::IsEmpty;

const SinglePoint kBase{"", {}, 0.10, 100};

TEST(Combine, PutsTogetherWhatIsFasterAndWhatIsMoreAccurate) {
  // a=1 takes half the time at little loss, b=1 buys accuracy at twice the time: both at once cost as much as the base.
  const std::vector<SinglePoint> singles{{"a", {"a=1"}, .105, 50}, {"b", {"b=1"}, .05, 200}};
  EXPECT_THAT(worth_combining(kBase, singles, {}, 8), ElementsAre(ElementsAre("a=1", "b=1")));
}

TEST(Combine, LeavesOutWhatHelpsNobodyAndOneKnobAlone) {
  EXPECT_THAT(
      worth_combining(kBase, std::vector<SinglePoint>{{"a", {"a=1"}, .1, 120}, {"b", {"b=1"}, .05, 200}}, {}, 8),
      IsEmpty());
  EXPECT_THAT(worth_combining(kBase, std::vector<SinglePoint>{{"a", {"a=1"}, .11, 50}, {"a", {"a=2"}, .12, 30}}, {}, 8),
              IsEmpty());
  EXPECT_THAT(worth_combining(kBase, {}, {}, 8), IsEmpty());
}

TEST(Combine, LeavesOutWhatAMeasuredPointBeats) {
  const std::vector<SinglePoint> singles{{"a", {"a=1"}, .105, 50}, {"b", {"b=1"}, .05, 200}};
  TradeoffRow row;
  row.error = .04;
  row.time.median_ms = 90;
  EXPECT_THAT(worth_combining(kBase, singles, std::vector<TradeoffRow>{row}, 8), IsEmpty());
  row.failed = "why";
  EXPECT_EQ(worth_combining(kBase, singles, std::vector<TradeoffRow>{row}, 8).size(), 1U);
}

TEST(Combine, KeepsToItsNumberAndSpreadsOverTheFront) {
  std::vector<SinglePoint> singles;
  for (int i = 1; i <= 9; ++i) {
    singles.push_back({"fast", {"fast=" + std::to_string(i)}, .1 + .001 * i, 100 - 9.0 * i});
    singles.push_back({"fine", {"fine=" + std::to_string(i)}, .1 - .01 * i, 100 + 60.0 * i});
  }
  const auto all = worth_combining(kBase, singles, {}, 1000), few = worth_combining(kBase, singles, {}, 4);
  ASSERT_GT(all.size(), 8U);
  ASSERT_EQ(few.size(), 4U);
  EXPECT_EQ(few.front(), all.front());
  EXPECT_EQ(few.back(), all.back());
}

}  // namespace
}  // namespace pelage
