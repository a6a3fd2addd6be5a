#include "pelage/image/picture_error.h"

#include <gmock/gmock.h>
#include <tbb/global_control.h>

#include <cmath>
#include <limits>

#include "../data_schema/temporary.h"
#include "pelage/data_schema/errors.h"
#include "pelage/image/tone.h"
#include "pictures.h"

namespace pelage::test {
namespace {

using ::testing::HasSubstr;

PictureError error_of(const Image& picture, const Image& truth) {
  return picture_error(picture, truth, covered(truth));
}

TEST(PictureError, OfEqualPicturesIsZero) {
  const PictureError e = error_of(noise(20, 11, 3), noise(20, 11, 3));
  for (const double zero : {e.rmse, e.bias, e.rel_mse, e.flip, e.max, e.rmse_covered}) EXPECT_EQ(zero, 0);
  EXPECT_EQ(e.psnr_db, std::numeric_limits<double>::infinity());
}

/// .5 is exact, so is .5 + .125: what follows are formulas.
TEST(PictureError, OfAConstantOffset) {
  const Image truth = constant(7, 5, {.5F, .5F, .5F}), brighter = constant(7, 5, {.625F, .625F, .625F});
  const PictureError e = error_of(brighter, truth);
  EXPECT_DOUBLE_EQ(e.rmse, .125);
  EXPECT_DOUBLE_EQ(e.bias, .125);
  EXPECT_DOUBLE_EQ(e.max, .125);
  EXPECT_DOUBLE_EQ(e.rmse_covered, .125);
  EXPECT_DOUBLE_EQ(e.rel_mse, .125 * .125 / (.25 + .01));
  // IEC 61966-2-1: 1.055 x^(1/2.4) - .055, in float
  const double apart = 1.055 * (std::pow(.625, 1 / 2.4) - std::pow(.5, 1 / 2.4));
  EXPECT_NEAR(e.psnr_db, -20 * std::log10(apart), 1e-4);
  EXPECT_DOUBLE_EQ(error_of(truth, brighter).bias, -.125);
}

TEST(PictureError, OfOneChannelOfOnePixel) {
  const Image truth = constant(4, 2, {.25F, .25F, .25F});
  Image picture = truth;
  picture.pixel(1, 1)[2] = .75F;
  const PictureError e = error_of(picture, truth);
  EXPECT_DOUBLE_EQ(e.max, .5);
  EXPECT_DOUBLE_EQ(e.rmse, .5 / std::sqrt(24));
  EXPECT_DOUBLE_EQ(e.bias, .5 / 24);
  picture.pixel(2, 0)[0] = -.75F;  // in a row before
  EXPECT_DOUBLE_EQ(error_of(picture, truth).max, 1);
}

TEST(PictureError, DoesNotKnowWhichIsWhichBesidesItsSign) {
  const PictureError ab = error_of(noise(16, 9, 1), noise(16, 9, 2)), ba = error_of(noise(16, 9, 2), noise(16, 9, 1));
  EXPECT_EQ(ab.rmse, ba.rmse);
  EXPECT_EQ(ab.bias, -ba.bias);
  EXPECT_EQ(ab.psnr_db, ba.psnr_db);
  EXPECT_EQ(ab.flip, ba.flip);
  EXPECT_EQ(ab.max, ba.max);
}

TEST(PictureError, CoveredPixelsCountAlone) {
  const Image truth = constant(2, 1, {0, 0, 0});
  Image picture = truth;
  picture.pixel(1, 0)[0] = picture.pixel(1, 0)[1] = picture.pixel(1, 0)[2] = .5F;
  const std::vector<float> none{.49F, .49F}, second{.49F, .5F};
  EXPECT_DOUBLE_EQ(picture_error(picture, truth, second).rmse_covered, .5);
  EXPECT_DOUBLE_EQ(picture_error(picture, truth, none).rmse_covered, 0);
  EXPECT_DOUBLE_EQ(picture_error(picture, truth, none).rmse, .5 / std::sqrt(2));
}

TEST(PictureError, AlphaOfThePictureDoesNotCount) {
  Image picture = constant(3, 3, {.5F, .5F, .5F});
  picture.rgba[3] = 0;
  EXPECT_EQ(error_of(picture, constant(3, 3, {.5F, .5F, .5F})).rmse, 0);
}

TEST(PictureError, BrighterThanWhiteCountsInLinearLightOnly) {
  const PictureError e = error_of(constant(2, 2, {3, 3, 3}), constant(2, 2, {1, 1, 1}));
  EXPECT_DOUBLE_EQ(e.rmse, 2);
  EXPECT_EQ(e.psnr_db, std::numeric_limits<double>::infinity());
  EXPECT_EQ(e.flip, 0);
}

TEST(PictureError, IsTheSameForAnyNumberOfThreads) {
  const PictureError many = error_of(noise(61, 43, 1), noise(61, 43, 2));
  const tbb::global_control one(tbb::global_control::max_allowed_parallelism, 1);
  const PictureError single = error_of(noise(61, 43, 1), noise(61, 43, 2));
  EXPECT_EQ(single.rmse, many.rmse);
  EXPECT_EQ(single.bias, many.bias);
  EXPECT_EQ(single.rel_mse, many.rel_mse);
  EXPECT_EQ(single.psnr_db, many.psnr_db);
  EXPECT_EQ(single.flip, many.flip);
}

TEST(PictureError, RefusesOtherSizes) {
  const std::string said = message_of<UsageError>([] { error_of(noise(4, 3, 1), noise(3, 4, 1)); });
  EXPECT_THAT(said, HasSubstr("4 x 3"));
  EXPECT_THAT(said, HasSubstr("3 x 4"));
  EXPECT_THROW(error_of(Image(), Image()), UsageError);
}

TEST(PictureError, CountsWhatIsNotFinite) {
  for (const float bad : {std::numeric_limits<float>::quiet_NaN(), std::numeric_limits<float>::infinity()}) {
    Image picture = noise(4, 4, 1);
    picture.rgba[0] = picture.rgba[9] = bad;
    EXPECT_THAT(message_of<InputError>([&] { error_of(picture, noise(4, 4, 1)); }),
                HasSubstr("picture: 2 of its values"));
    EXPECT_THAT(message_of<InputError>([&] { error_of(noise(4, 4, 1), picture); }),
                HasSubstr("truth: 2 of its values"));
  }
}

TEST(Flicker, OfACopyIsZeroAndOfAnOffsetToo) {
  const Image t0 = noise(8, 8, 1), t1 = noise(8, 8, 2);
  EXPECT_EQ(flicker(t1, t0, t1, t0), 0);
  Image p0 = t0, p1 = t1;
  for (Image* const p : {&p0, &p1})
    for (float& v : p->rgba) v += 1;
  EXPECT_NEAR(flicker(p1, p0, t1, t0), 0, 1e-7);
}

TEST(Flicker, IsTheErrorOfTheChange) {
  const Image still = constant(4, 4, {.5F, .5F, .5F}), on = constant(4, 4, {.75F, .75F, .75F});
  EXPECT_DOUBLE_EQ(flicker(on, still, still, still), .25);  // it blinks
  EXPECT_DOUBLE_EQ(flicker(still, still, on, still), .25);  // it stands still and should not
  EXPECT_DOUBLE_EQ(flicker(still, on, on, still), .5);
}

}  // namespace
}  // namespace pelage::test
