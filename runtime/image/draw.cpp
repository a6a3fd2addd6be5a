#include "pelage/image/draw.h"

#include <OpenImageIO/imagebuf.h>
#include <OpenImageIO/imagebufalgo.h>

#include <algorithm>
#include <cmath>
#include <glm/common.hpp>
#include <iterator>

#include "pelage/image/tone.h"

namespace pelage::draw {
namespace {

constexpr const char* kFont = "DejaVuSans";

void blend(Image& image, int x, int y, glm::vec3 linear, float opacity) {
  if (x < 0 || y < 0 || x >= image.width || y >= image.height) return;
  float* const pixel = image.pixel(x, y);
  for (int c = 0; c < 3; ++c) pixel[c] += opacity * (linear[c] - pixel[c]);
  pixel[3] += opacity * (1 - pixel[3]);
}

glm::vec3 to_linear(Colour colour) {
  return {srgb_decode(colour.x), srgb_decode(colour.y), srgb_decode(colour.z)};
}

}  // namespace

void fill(Image& image, glm::ivec2 corner, glm::ivec2 size, Colour colour) {
  const glm::vec3 linear = to_linear(colour);
  for (int y = corner.y; y < corner.y + size.y; ++y) {
    for (int x = corner.x; x < corner.x + size.x; ++x) blend(image, x, y, linear, 1);
  }
}

void disc(Image& image, glm::vec2 centre, float radius, Colour colour, float opacity) {
  const glm::vec3 linear = to_linear(colour);
  const glm::ivec2 first(glm::floor(centre - radius - 1.0F)), last(glm::ceil(centre + radius + 1.0F));
  for (int y = first.y; y <= last.y; ++y) {
    for (int x = first.x; x <= last.x; ++x) {
      const float dx = static_cast<float>(x) + 0.5F - centre.x, dy = static_cast<float>(y) + 0.5F - centre.y;
      const float inside = radius + 0.5F - std::sqrt(dx * dx + dy * dy);
      if (inside > 0) blend(image, x, y, linear, opacity * std::min(inside, 1.0F));
    }
  }
}

void frame(Image& image, glm::ivec2 corner, glm::ivec2 size, Colour colour) {
  fill(image, corner, {size.x, 1}, colour);
  fill(image, {corner.x, corner.y + size.y - 1}, {size.x, 1}, colour);
  fill(image, corner, {1, size.y}, colour);
  fill(image, {corner.x + size.x - 1, corner.y}, {1, size.y}, colour);
}

int text(Image& image, glm::ivec2 at, const std::string& line, int height_px, Colour colour) {
  const OIIO::ROI size = OIIO::ImageBufAlgo::text_size(line, height_px, kFont);
  if (!size.defined()) {
    OIIO::geterror();  // taken note of: the caller sees 0
    return 0;
  }
  // Coverage first, so that it is blended here whatever the image holds.
  OIIO::ImageBuf coverage(OIIO::ImageSpec(size.xend + 2, 2 * height_px, 1, OIIO::TypeDesc::FLOAT));
  const float one = 1;
  if (!OIIO::ImageBufAlgo::render_text(coverage, 0, height_px, line, height_px, kFont, one)) return 0;
  const glm::vec3 linear = to_linear(colour);
  for (int y = 0; y < 2 * height_px; ++y) {
    for (int x = 0; x < size.xend + 2; ++x) {
      blend(image, at.x + x, at.y + y - height_px, linear, std::clamp(coverage.getchannel(x, y, 0, 0), 0.0F, 1.0F));
    }
  }
  return size.xend;
}

Colour ramp(float value) {
  static constexpr float kStops[][3] = {
      {.27F, .00F, .33F}, {.23F, .32F, .55F}, {.13F, .57F, .55F}, {.37F, .79F, .38F}, {.99F, .91F, .14F}};
  const float x = std::clamp(value, 0.0F, 1.0F) * 4;
  const auto i = std::min(static_cast<std::size_t>(x), std::size(kStops) - 2);
  const float t = x - static_cast<float>(i);
  Colour colour;
  for (int c = 0; c < 3; ++c) colour[c] = kStops[i][c] + t * (kStops[i + 1][c] - kStops[i][c]);
  return colour;
}

}  // namespace pelage::draw
