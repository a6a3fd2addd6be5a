// Colours that vary from strand to strand.
#include "pelage/data_schema/strand_tint.h"

#include <gtest/gtest.h>

#include <cmath>

namespace pelage {
namespace {

constexpr std::uint32_t kStrands = 100'000;

TEST(StrandTint, IsExactlyOneWhereNothingVaries) {
  for (std::uint32_t s = 0; s < 1000; ++s) ASSERT_EQ(strand_tint(s, 0.0F), glm::vec3(1.0F));
}

TEST(StrandTint, HasTheMeanOneAndStaysWithinItsBounds) {
  for (const float variation : {0.3F, 1.0F}) {
    glm::dvec3 sum(0), squares(0);
    for (std::uint32_t s = 0; s < kStrands; ++s) {
      const glm::dvec3 tint(strand_tint(s, variation));
      for (int c = 0; c < 3; ++c) {
        ASSERT_LT(std::abs(tint[c] - 1), double(kMostTint * variation)) << s;
        ASSERT_GT(tint[c], 0) << s;
      }
      sum += tint;
      squares += tint * tint;
    }
    const glm::dvec3 mean = sum / double(kStrands);
    // Uniform numbers of half ranges .6 and .2 (red and blue; green has the first alone): deviation half range /
    // sqrt 3.
    const glm::dvec3 expected = double(variation) * glm::dvec3(std::sqrt(0.40), 0.6, std::sqrt(0.40)) / std::sqrt(3.0);
    for (int c = 0; c < 3; ++c) {
      const double deviation = std::sqrt(squares[c] / kStrands - mean[c] * mean[c]);
      EXPECT_NEAR(mean[c], 1, 4 * deviation / std::sqrt(double(kStrands))) << c;
      EXPECT_NEAR(deviation, expected[c], 0.01 * expected[c]) << c;
    }
  }
}

TEST(StrandTint, OfNeighboursHasNothingInCommon) {
  double brightness = 0, both = 0, square = 0;
  for (std::uint32_t s = 0; s < kStrands; ++s) {
    const double own = double(strand_tint(s, 1).g) - 1, next = double(strand_tint(s + 1, 1).g) - 1;
    const double warmth = 0.5 * double(strand_tint(s, 1).r - strand_tint(s, 1).b);
    brightness += own * next;
    both += own * warmth;
    square += own * own;
  }
  // A correlation of independent numbers is 0 with a standard error of 1 / sqrt(n).
  EXPECT_LT(std::abs(brightness / square), 4 / std::sqrt(double(kStrands)));
  EXPECT_LT(std::abs(both / square), 4 / std::sqrt(double(kStrands)) * double(kWarmthRange / kBrightnessRange));
}

}  // namespace
}  // namespace pelage
