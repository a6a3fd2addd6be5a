// Colour that varies from strand to strand: a factor on a strand's own colours (diffuse and secondary; the primary
// highlight is the light's colour). The strand renderer and the truth take it from here, by the strand's index alone.
#pragma once

#include <cstdint>
#include <glm/vec3.hpp>
#include <vector>

namespace pelage {

/// Of the factor at variation 1: half the range of a strand's brightness, and of its warmth (red against blue).
inline constexpr float kBrightnessRange = 0.6F, kWarmthRange = 0.2F;

/// A factor is at most 1 + this times the variation.
inline constexpr float kMostTint = kBrightnessRange + kWarmthRange;

/// Random bits of a number: a mixing function of 32 bits, one to one [Wellons2018, lowbias32].
constexpr std::uint32_t mixed_bits(std::uint32_t x) noexcept {
  x = (x ^ (x >> 16)) * 0x7feb352dU;
  x = (x ^ (x >> 15)) * 0x846ca68bU;
  return x ^ (x >> 16);
}

/// In (-1, 1), of mean 0.
constexpr float signed_unit(std::uint32_t bits) noexcept {
  return (static_cast<float>(bits >> 8) + 0.5F) * 0x1p-23F - 1.0F;
}

/// Per channel in (0.2, 1.8), of mean 1 over all strands; exactly 1 for variation 0.
/// @param variation  [0, 1]
constexpr glm::vec3 strand_tint(std::uint32_t strand, float variation) noexcept {
  const float brightness = kBrightnessRange * signed_unit(mixed_bits(2 * strand));
  const float warmth = kWarmthRange * signed_unit(mixed_bits(2 * strand + 1));
  return glm::vec3(1.0F) + variation * glm::vec3(brightness + warmth, brightness, brightness - warmth);
}

/// [strands]
inline std::vector<glm::vec3> strand_tints(std::size_t strands, float variation) {
  std::vector<glm::vec3> tints;
  tints.reserve(strands);
  for (std::size_t s = 0; s < strands; ++s) tints.push_back(strand_tint(static_cast<std::uint32_t>(s), variation));
  return tints;
}

}  // namespace pelage
