#include "pelage/image/error_map.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <functional>
#include <glm/common.hpp>

#include "pelage/data_schema/errors.h"
#include "pelage/image/draw.h"
#include "pelage/image/flip.h"
#include "pelage/image/picture_error.h"
#include "pelage/image/tone.h"

namespace pelage {
namespace {

constexpr int kBar = 12, kText = 13, kGap = 4, kHeight = kBar + kText + 3 * kGap;
constexpr int kNarrowest = 64;  // two numbers side by side
constexpr draw::Colour kPaper{1, 1, 1}, kInk{.1F, .1F, .12F};

using Colours = std::function<draw::Colour(float)>;  // of [0, 1] along the bar

float luminance(const float* rgb) noexcept {
  return 0.2126F * rgb[0] + 0.7152F * rgb[1] + 0.0722F * rgb[2];
}

/// Blue, white, red; as bright at equal distance from the middle.
draw::Colour diverging(float value) {
  const draw::Colour blue{.13F, .40F, .67F}, red{.70F, .09F, .17F}, white{.97F, .97F, .97F};
  const float t = std::clamp(2 * value - 1, -1.0F, 1.0F);
  return glm::mix(white, t < 0 ? blue : red, std::abs(t));
}

void put(Image& image, int x, int y, draw::Colour colour) {
  float* const p = image.pixel(x, y);
  for (int c = 0; c < 3; ++c) p[c] = srgb_decode(colour[c]);
  p[3] = 1;
}

/// Width of a line of text, drawn where it does not show.
int text_width(const std::string& line) {
  Image nowhere(1, 1);
  return draw::text(nowhere, {-10000, -10000}, line, kText, kInk);
}

/// Below the map: the colours from left to right, numbers at both ends and, where there is room, in the middle.
void draw_bar(Image& image, int top, const Colours& colours, const std::array<std::string, 3>& labels) {
  draw::fill(image, {0, top}, {image.width, image.height - top}, kPaper);
  for (int x = 0; x < image.width; ++x) {
    const draw::Colour colour = colours((static_cast<float>(x) + 0.5F) / static_cast<float>(image.width));
    for (int y = top + kGap; y < top + kGap + kBar; ++y) put(image, x, y, colour);
  }
  const int base = top + 2 * kGap + kBar + kText - 3;
  const int last = image.width - text_width(labels[2]) - 2, middle = (image.width - text_width(labels[1])) / 2;
  draw::text(image, {2, base}, labels[0], kText, kInk);
  if (image.width >= 3 * kNarrowest) draw::text(image, {middle, base}, labels[1], kText, kInk);
  draw::text(image, {last, base}, labels[2], kText, kInk);
}

Image with_bar(int width, int height) {
  return {width, height + colour_bar_height(width)};
}

}  // namespace

int colour_bar_height(int width) noexcept {
  return width >= kNarrowest ? kHeight : 0;
}

Image error_map(const Image& picture, const Image& truth, float scale, ErrorSign sign) {
  check_same_size(picture, truth);
  check_finite(picture, "the picture");
  check_finite(truth, "the truth");
  if (!(scale > 0) || !std::isfinite(scale)) throw UsageError("the scale of an error map is a number above 0");
  const bool both = sign == ErrorSign::with_sign;
  const Colours colours = both ? Colours(diverging) : Colours(draw::ramp);
  Image map = with_bar(picture.width, picture.height);
  for (int y = 0; y < picture.height; ++y)
    for (int x = 0; x < picture.width; ++x) {
      const float error = (luminance(picture.pixel(x, y)) - luminance(truth.pixel(x, y))) / scale;
      put(map, x, y, colours(both ? 0.5F + 0.5F * error : std::abs(error)));
    }
  if (map.height == picture.height) return map;
  draw_bar(map, picture.height, colours,
           both ? std::array{fmt::format("<= -{:g}", scale), std::string("0"), fmt::format(">= +{:g}", scale)}
                : std::array{std::string("0"), fmt::format("{:g}", scale / 2), fmt::format(">= {:g}", scale)});
  return map;
}

Image flip_picture(const std::vector<float>& map, int width, int height) {
  const Image colours = ramp_picture(map, width, height);
  Image picture = with_bar(width, height);
  std::copy(colours.rgba.begin(), colours.rgba.end(), picture.rgba.begin());
  if (picture.height > height) draw_bar(picture, height, draw::ramp, {"0", "FLIP 0.5", "1"});
  return picture;
}

}  // namespace pelage
