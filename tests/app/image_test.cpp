// Pictures on disk, tone and background.
#include <OpenImageIO/imageio.h>
#include <gmock/gmock.h>

#include <cmath>

#include "../data_schema/temporary.h"
#include "pelage/data_schema/errors.h"
#include "pelage/image/image_file.h"
#include "pelage/image/tone.h"

namespace pelage {
namespace {

using test::message_of;
using ::testing::HasSubstr;

/// Premultiplied colours from transparent to opaque; the last row is transparent.
Image gradient() {
  Image image(16, 9);
  for (int y = 0; y < 9; ++y) {
    for (int x = 0; x < 16; ++x) {
      const float alpha = float(8 - y) / 8;
      float* const p = image.pixel(x, y);
      p[0] = alpha * float(x) / 15, p[1] = alpha * 0.5F, p[2] = alpha * float(15 - x) / 15, p[3] = alpha;
    }
  }
  return image;
}

TEST(ImageFile, HoldsNoTimeOfDay) {
  const test::TemporaryFolder folder;
  for (const char* const name : {"a.exr", "a.png"}) {
    write_image(Image(3, 2), folder / name, {});
    const auto file = OIIO::ImageInput::open((folder / name).string());
    ASSERT_TRUE(file);
    const std::string date(file->spec().get_string_attribute("DateTime"));
    EXPECT_TRUE(date.empty() || date == "1970:01:01 00:00:00") << name << ": " << date;
  }
}

TEST(ImageFile, ExrKeepsHalfFloats) {
  const test::TemporaryFolder folder;
  Image image = gradient();
  image.pixel(3, 2)[0] = 1000.0F;  // brighter than any screen
  write_image(image, folder / "a.exr", {});
  const Image back = read_image(folder / "a.exr");
  ASSERT_EQ(back.width, 16);
  ASSERT_EQ(back.height, 9);
  for (std::size_t i = 0; i < image.rgba.size(); ++i)
    EXPECT_NEAR(back.rgba[i], image.rgba[i], 0x1p-11F * image.rgba[i]) << i;  // half an ulp of 11 bits
}

TEST(ImageFile, PngKeepsEightBitsOfStraightColour) {
  const test::TemporaryFolder folder;
  const Image image = gradient();
  write_image(image, folder / "a.png", {});
  const auto expected = to_srgb8(image), back = to_srgb8(read_image(folder / "a.png"));
  ASSERT_EQ(back.size(), expected.size());
  for (std::size_t i = 0; i < back.size(); ++i) {
    // OpenImageIO multiplies by alpha in 8 bits: half a step of 255 over alpha.
    const int alpha = expected[i - i % 4 + 3];
    const int tolerance = i % 4 == 3 ? 0 : alpha == 255 ? 0 : 1 + 255 / std::max(alpha, 1);
    EXPECT_LE(std::abs(int(back[i]) - int(expected[i])), tolerance) << i;
  }
}

TEST(ImageFile, OtherExtensionsAreRefused) {
  const test::TemporaryFolder folder;
  for (const char* name : {"a.jpg", "a", "a.PNGX", "a.txt"})
    EXPECT_THAT(message_of<UsageError>([&] { write_image(gradient(), folder / name, {}); }), HasSubstr(".png or .exr"));
  EXPECT_EQ(folder.entries(), 0U);
}

TEST(ImageFile, WhatCannotBeWrittenOrReadSaysSo) {
  const test::TemporaryFolder folder;
  EXPECT_THROW(write_image(gradient(), folder / "missing" / "a.png", {}), OutputError);
  EXPECT_EQ(folder.entries(), 0U);
  EXPECT_THROW(read_image(folder / "none.png"), InputError);
  EXPECT_THROW(read_image(folder.write("text.png", "this is no picture")), InputError);
  write_image(gradient(), folder / "a.exr", {});
  const std::string bytes = test::text_of(folder / "a.exr");
  EXPECT_THROW(read_image(folder.write("cut.exr", bytes.substr(0, bytes.size() / 2))), InputError);
}

TEST(Tone, NonFiniteValuesAreReplacedAndCounted) {
  Image image = gradient();
  EXPECT_EQ(remove_non_finite(image), 0U);
  image.rgba[5] = NAN, image.rgba[6] = INFINITY, image.rgba[7] = -INFINITY;
  EXPECT_EQ(remove_non_finite(image), 3U);
  EXPECT_EQ(image.rgba[5], 0.0F);
  EXPECT_EQ(remove_non_finite(image), 0U);
}

TEST(Tone, BackgroundShowsThroughByAlpha) {
  Image image = gradient();
  const Image before = image;
  compose_over(image, std::nullopt);
  EXPECT_EQ(image.rgba, before.rgba);
  compose_over(image, glm::vec3(0.2F, 0.4F, 0.6F));
  for (int y = 0; y < 9; ++y) {
    EXPECT_FLOAT_EQ(image.pixel(5, y)[1], before.pixel(5, y)[1] + float(y) / 8 * 0.4F);
    EXPECT_EQ(image.pixel(5, y)[3], 1.0F);
  }
}

TEST(Tone, AGradientDarkensTheBackgroundTowardsTheCornersAndNothingElse) {
  const glm::vec3 background(0.2F, 0.4F, 0.6F);
  Image image(101, 51);
  for (int x = 40; x < 60; ++x) image.pixel(x, 25)[3] = 1.0F;  // black and opaque
  Image none = image;
  compose_over(none, std::nullopt, Backdrop::gradient);
  EXPECT_EQ(none.rgba, image.rgba) << "transparent stays transparent";
  compose_over(image, background, Backdrop::gradient);
  EXPECT_EQ(image.pixel(50, 25)[1], 0.0F);
  EXPECT_NEAR(image.pixel(50, 20)[1], 0.4F, 0.002F) << "the middle is the background's own colour";
  for (const auto& [x, y] : {std::pair(0, 50), std::pair(100, 50)}) EXPECT_NEAR(image.pixel(x, y)[1], 0.18F, 0.001F);
  for (int x = 1; x <= 50; ++x) {
    EXPECT_GE(image.pixel(x, 10)[2], image.pixel(x - 1, 10)[2]) << x;
    EXPECT_NEAR(image.pixel(x, 10)[2], image.pixel(100 - x, 10)[2], 1e-6F) << "the same on both sides";
    EXPECT_NEAR(image.pixel(x, 10)[0] / image.pixel(x, 10)[2], 1.0F / 3, 1e-6F) << "of one hue";
  }
}

TEST(Tone, ExposureLeavesAlpha) {
  Image image = gradient();
  expose(image, 2.0F);
  EXPECT_EQ(image.pixel(15, 0)[0], 2.0F);
  EXPECT_EQ(image.pixel(15, 4)[3], 0.5F);
}

TEST(Tone, SrgbCurveHasItsKnownValues) {
  EXPECT_EQ(srgb_encode(0), 0.0F);
  EXPECT_NEAR(srgb_encode(1), 1.0F, 1e-6F);
  EXPECT_NEAR(srgb_encode(0.5F), 0.7353570F, 1e-6F);  // IEC 61966-2-1
  EXPECT_NEAR(srgb_encode(0.0031308F), 0.0404499F, 1e-6F);
  EXPECT_EQ(srgb_encode(-1), 0.0F);
  EXPECT_NEAR(srgb_encode(2), 1.0F, 1e-6F);
}

}  // namespace
}  // namespace pelage
