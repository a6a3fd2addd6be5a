// From linear light to a display: the one place where a value that is not finite is replaced, and counted.
#pragma once

#include <cstdint>
#include <glm/vec2.hpp>
#include <glm/vec3.hpp>
#include <optional>
#include <vector>

#include "pelage/data_schema/scene.h"
#include "pelage/image/image.h"

namespace pelage {

/// Replaces values that are not finite by 0 and returns how many there were; tests assert that it is 0.
std::size_t remove_non_finite(Image& image) noexcept;

/// What a backdrop makes of the background's colour at a place of a picture; both in pixels, rows from the top. A
/// gradient: 1 a little above the middle, falling smoothly to 0.45 in the corners. GPU twin: shaders/present.frag.
float backdrop_gain(Backdrop backdrop, glm::vec2 at, glm::vec2 size) noexcept;

/// Puts the image over a background (linear RGB), or leaves it transparent.
void compose_over(Image& image, const std::optional<glm::vec3>& background,
                  Backdrop backdrop = Backdrop::plain) noexcept;
/// One pixel, RGBA.
void compose_over(float* rgba, const glm::vec3& background) noexcept;

/// Multiplies the colours, not alpha.
void expose(Image& image, float gain) noexcept;

/// sRGB transfer curve of a linear value, clamped to [0, 1].
float srgb_encode(float linear) noexcept;
/// Its inverse on [0, 1].
float srgb_decode(float encoded) noexcept;

/// 8-bit sRGB with straight (un-premultiplied) alpha, [y][x][4].
std::vector<std::uint8_t> to_srgb8(const Image& image);

}  // namespace pelage
