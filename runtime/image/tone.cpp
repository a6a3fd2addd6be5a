#include "pelage/image/tone.h"

#include <algorithm>
#include <cmath>
#include <glm/common.hpp>
#include <glm/geometric.hpp>

namespace pelage {

std::size_t remove_non_finite(Image& image) noexcept {
  std::size_t count = 0;
  for (float& v : image.rgba) {
    if (std::isfinite(v)) continue;
    v = 0.0F;
    ++count;
  }
  return count;
}

float backdrop_gain(Backdrop backdrop, glm::vec2 at, glm::vec2 size) noexcept {
  if (backdrop == Backdrop::plain) return 1.0F;
  const float off = glm::length(at - glm::vec2(0.5F, 0.42F) * size) / (0.5F * glm::length(size));
  return glm::mix(1.0F, 0.45F, glm::smoothstep(0.0F, 1.0F, off));
}

void compose_over(float* rgba, const glm::vec3& background) noexcept {
  for (int c = 0; c < 3; ++c) rgba[c] += (1.0F - rgba[3]) * background[c];
  rgba[3] = 1.0F;
}

void compose_over(Image& image, const std::optional<glm::vec3>& background, Backdrop backdrop) noexcept {
  if (!background) return;
  const glm::vec2 size(image.width, image.height);
  for (int y = 0; y < image.height; ++y) {
    for (int x = 0; x < image.width; ++x) {
      const float gain = backdrop_gain(backdrop, glm::vec2(x, y) + 0.5F, size);
      compose_over(image.pixel(x, y), gain * *background);
    }
  }
}

void expose(Image& image, float gain) noexcept {
  for (std::size_t i = 0; i < image.rgba.size(); i += 4) {
    for (std::size_t c = 0; c < 3; ++c) image.rgba[i + c] *= gain;
  }
}

float srgb_encode(float linear) noexcept {
  const float x = std::clamp(linear, 0.0F, 1.0F);
  return x <= 0.0031308F ? 12.92F * x : 1.055F * std::pow(x, 1.0F / 2.4F) - 0.055F;
}

float srgb_decode(float v) noexcept {
  return v <= 0.04045F ? v / 12.92F : std::pow((v + 0.055F) / 1.055F, 2.4F);
}

std::vector<std::uint8_t> to_srgb8(const Image& image) {
  std::vector<std::uint8_t> out(image.rgba.size());
  const auto byte = [](float v) { return static_cast<std::uint8_t>(std::clamp(v, 0.0F, 1.0F) * 255.0F + 0.5F); };
  for (std::size_t i = 0; i < out.size(); i += 4) {
    const float alpha = image.rgba[i + 3];
    for (std::size_t c = 0; c < 3; ++c) {
      out[i + c] = alpha > 0.0F ? byte(srgb_encode(image.rgba[i + c] / alpha)) : std::uint8_t{0};
    }
    out[i + 3] = byte(alpha);
  }
  return out;
}

}  // namespace pelage
