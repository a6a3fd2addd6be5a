// FLIP where its paper's formulas can be worked out by hand; the rest is compared in flip_twin.py.
#include "pelage/image/flip.h"

#include <gmock/gmock.h>
#include <tbb/global_control.h>

#include <algorithm>
#include <cmath>
#include <limits>

#include "../data_schema/temporary.h"
#include "pelage/data_schema/errors.h"
#include "pictures.h"

namespace pelage::test {
namespace {

using ::testing::Each;
using ::testing::FloatNear;
using ::testing::HasSubstr;

constexpr float kRounding = 1e-6F;  // of a float near 1

TEST(Flip, SeesWhatThePaperSees) {
  EXPECT_NEAR(kFlipPixelsPerDegree, 67.02, 0.005);
}

TEST(Flip, EqualPicturesAreNotTold) {
  EXPECT_THAT(flip_map(noise(31, 17, 1), noise(31, 17, 1)), Each(0.0F));
}

/// Constant pictures: filters change nothing and there are no features. L* is 0 and 100, so HyAB is 100; 100^.7 =
/// 25.1189 lies above .4 * 41.2760 = 16.5104, so .95 + .05 (25.1189 - 16.5104) / (41.2760 - 16.5104) = .96738.
TEST(Flip, BlackAgainstWhiteIsWorkedOutByHand) {
  EXPECT_THAT(flip_map(constant(20, 12, {0, 0, 0}), constant(20, 12, {1, 1, 1})), Each(FloatNear(.96738F, 5e-6F)));
}

/// The greatest colour error that there is.
TEST(Flip, GreenAgainstBlueIsOne) {
  EXPECT_THAT(flip_map(constant(9, 9, {0, 1, 0}), constant(9, 9, {0, 0, 1})), Each(FloatNear(1, kRounding)));
}

/// Y of mid-grey .184187 has L* = 50.0: HyAB 50 against black, 50^.7 = 15.4625 < 16.5104, times .95 / 16.5104 = .88970.
TEST(Flip, MidGreyIsBelowTheBend) {
  const float y = std::pow(66.0F / 116, 3.0F);
  EXPECT_THAT(flip_map(constant(5, 5, {0, 0, 0}), constant(5, 5, {y, y, y})), Each(FloatNear(.88970F, 5e-6F)));
}

TEST(Flip, IsSymmetric) {
  EXPECT_EQ(flip_map(noise(23, 40, 1), noise(23, 40, 2)), flip_map(noise(23, 40, 2), noise(23, 40, 1)));
}

TEST(Flip, AnEdgeCountsMoreThanItsColourAlone) {
  Image flat = constant(41, 41, {.5F, .5F, .5F}), line = flat;
  for (int y = 0; y < 41; ++y) std::fill_n(line.pixel(20, y), 3, 0.0F);
  const std::vector<float> with_feature = flip_map(flat, line);
  Image spread = flat;  // the same darkness over three rows of pixels has less of an edge
  for (int y = 0; y < 41; ++y)
    for (int x = 19; x < 22; ++x) std::fill_n(spread.pixel(x, y), 3, .5F * 2 / 3);
  EXPECT_GT(with_feature[20 * 41 + 20], 1.02F * flip_map(flat, spread)[20 * 41 + 20]);
}

TEST(Flip, OfOnePixel) {
  EXPECT_THAT(flip_map(constant(1, 1, {0, 0, 0}), constant(1, 1, {1, 1, 1})), Each(FloatNear(.96738F, 5e-6F)));
}

TEST(Flip, FromAfarSmallThingsVanish) {
  Image dots = constant(64, 64, {0, 0, 0});
  for (int y = 0; y < 64; y += 2)
    for (int x = y / 2 % 2; x < 64; x += 2) std::fill_n(dots.pixel(x, y), 3, 1.0F);
  Image shifted = constant(64, 64, {0, 0, 0});
  for (int y = 0; y < 64; ++y) std::copy_n(dots.pixel(0, y), 4 * 63, shifted.pixel(1, y));
  const std::size_t middle = 32 * 64 + 32;
  EXPECT_LT(flip_map(dots, shifted, 120)[middle], 0.5F * flip_map(dots, shifted, 20)[middle]);
}

TEST(Flip, IsTheSameForAnyNumberOfThreads) {
  const std::vector<float> many = flip_map(noise(50, 41, 1), noise(50, 41, 2));
  const tbb::global_control one(tbb::global_control::max_allowed_parallelism, 1);
  EXPECT_EQ(flip_map(noise(50, 41, 1), noise(50, 41, 2)), many);
}

TEST(Flip, RefusesWhatIsNotAPicture) {
  EXPECT_THROW(flip_map(noise(4, 4, 1), noise(4, 5, 1)), UsageError);
  EXPECT_THROW(flip_map(Image(), Image()), UsageError);
  Image bad = noise(4, 4, 1);
  bad.rgba[5] = std::numeric_limits<float>::quiet_NaN();
  EXPECT_THROW(flip_map(bad, noise(4, 4, 1)), InputError);
}

}  // namespace
}  // namespace pelage::test
