#include "pelage/console/progress.h"

#include <gtest/gtest.h>

namespace pelage::console {
namespace {

std::string text(std::uint64_t done, std::uint64_t total, std::uint64_t first, double elapsed_s) {
  return progress_text("bake", "sectors", {done, total, first, elapsed_s});
}

TEST(Progress, ShowsShareRateAndEta) {
  EXPECT_EQ(text(0, 2000, 0, 0), "bake: 0 %, 0/2000 sectors");
  EXPECT_EQ(text(500, 2000, 0, 10), "bake: 25 %, 500/2000 sectors, 50 sectors/s, ETA 0:30");
  EXPECT_EQ(text(10, 2000, 0, 5), "bake: 0 %, 10/2000 sectors, 2.0 sectors/s, ETA 16:35");
  EXPECT_EQ(text(2000, 2000, 0, 61), "bake: 100 %, 2000/2000 sectors, 33 sectors/s, 1:01");
}

TEST(Progress, ResumedWorkCountsOnlyWhatWasDoneNow) {
  EXPECT_EQ(text(1500, 2000, 1000, 10), "bake: 75 %, 1500/2000 sectors, 50 sectors/s, ETA 0:10");
}

TEST(Progress, NeverRoundsUpToDone) {
  EXPECT_EQ(text(1999, 2000, 1999, 1), "bake: 99 %, 1999/2000 sectors");
}

TEST(Progress, SurvivesOddNumbers) {
  EXPECT_EQ(text(5, 0, 0, 0), "bake: 100 %, 1/1 sectors");
  EXPECT_EQ(text(1, 1'000'000'000'000'000, 0, 1e9).substr(0, 9), "bake: 0 %");
}

}  // namespace
}  // namespace pelage::console
