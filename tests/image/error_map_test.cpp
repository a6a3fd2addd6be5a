#include "pelage/image/error_map.h"

#include <gmock/gmock.h>

#include "pelage/data_schema/errors.h"
#include "pelage/image/draw.h"
#include "pelage/image/flip.h"
#include "pelage/image/tone.h"
#include "pictures.h"

namespace pelage::test {
namespace {

glm::vec3 encoded(const Image& image, int x, int y) {
  const float* const p = image.pixel(x, y);
  return {srgb_encode(p[0]), srgb_encode(p[1]), srgb_encode(p[2])};
}

void expect_colour(const glm::vec3& seen, const glm::vec3& wanted) {
  for (int c = 0; c < 3; ++c) EXPECT_NEAR(seen[c], wanted[c], 1e-5F) << c;
}

/// Error .125 of luminance on a scale that ends at .25 is the middle of the ramp, in either direction.
TEST(ErrorMap, ShowsLuminanceOnItsScale) {
  const Image truth = constant(80, 3, {.5F, .5F, .5F});
  for (const float value : {.375F, .625F}) {
    const Image map = error_map(constant(80, 3, {value, value, value}), truth, .25F);
    expect_colour(encoded(map, 40, 1), draw::ramp(.5F));
  }
  expect_colour(encoded(error_map(constant(80, 3, {0, .5F, .5F}), truth, .25F), 0, 0), draw::ramp(.5F * .2126F / .25F));
  expect_colour(encoded(error_map(constant(80, 3, {9, 9, 9}), truth, .25F), 0, 0), draw::ramp(1));
}

TEST(ErrorMap, SignsDifferInColour) {
  const Image truth = constant(80, 3, {.5F, .5F, .5F});
  const auto at = [&](float value) {
    return encoded(error_map(constant(80, 3, {value, value, value}), truth, .25F, ErrorSign::with_sign), 5, 1);
  };
  EXPECT_GT(at(.3F).z, at(.3F).x + .2F);  // darker: blue
  EXPECT_GT(at(.7F).x, at(.7F).z + .2F);  // brighter: red
  EXPECT_NEAR(at(.5F).x, at(.5F).z, .01F);
  expect_colour(at(.625F), .5F * (at(.5F) + at(.75F)));  // half of the scale
  expect_colour(at(.75F), at(9));
}

/// Dark of a row of pixels and all below.
float ink(const Image& image, int left, int right, int top) {
  float sum = 0;
  for (int y = top; y < image.height; ++y)
    for (int x = left; x < right; ++x) sum += 1 - encoded(image, x, y).x;
  return sum;
}

TEST(ErrorMap, NumbersOfTheBarAreThoseOfItsScale) {
  const auto middle_of = [](float scale, ErrorSign sign) {
    const Image map = error_map(noise(300, 4, 1), noise(300, 4, 1), scale, sign);
    return ink(map, 110, 190, 4 + 18);
  };
  // 4 is half of 8, 0 is the middle of any scale with signs.
  Image paper = constant(300, 40, {1, 1, 1});
  draw::text(paper, {150, 20}, "4", 13, {.1F, .1F, .12F});
  EXPECT_NEAR(middle_of(8, ErrorSign::absolute), ink(paper, 0, 300, 0), 0.01F);
  EXPECT_EQ(middle_of(2, ErrorSign::with_sign), middle_of(4, ErrorSign::with_sign));
  EXPECT_NE(middle_of(8, ErrorSign::absolute), middle_of(4, ErrorSign::absolute));
}

TEST(ErrorMap, HasABarWithTheColoursOfItsScale) {
  const Image map = error_map(noise(300, 20, 1), noise(300, 20, 1), .25F);
  ASSERT_EQ(map.width, 300);
  ASSERT_EQ(map.height, 20 + colour_bar_height(300));
  const int bar = 20 + 8;
  expect_colour(encoded(map, 150, bar), draw::ramp(150.5F / 300));
  int ink = 0;
  for (int y = 20 + 18; y < map.height; ++y)
    for (int x = 0; x < map.width; ++x) ink += encoded(map, x, y).x < .5F ? 1 : 0;
  EXPECT_GT(ink, 30) << "no numbers";
}

TEST(ErrorMap, OfOnePixelHasNoBar) {
  const Image map = error_map(noise(1, 1, 1), noise(1, 1, 2), .25F);
  EXPECT_EQ(map.width, 1);
  EXPECT_EQ(map.height, 1);
}

TEST(ErrorMap, RefusesWhatHasNoMap) {
  EXPECT_THROW(error_map(noise(2, 2, 1), noise(3, 2, 1), .25F), UsageError);
  EXPECT_THROW(error_map(noise(2, 2, 1), noise(2, 2, 1), 0), UsageError);
}

TEST(FlipPicture, KeepsTheMapAboveItsBar) {
  std::vector<float> map(70 * 2, .25F);
  map[71] = 1;
  const Image picture = flip_picture(map, 70, 2);
  expect_colour(encoded(picture, 0, 0), draw::ramp(.25F));
  expect_colour(encoded(picture, 1, 1), draw::ramp(1));
  EXPECT_EQ(picture.height, 2 + colour_bar_height(70));
}

}  // namespace
}  // namespace pelage::test
