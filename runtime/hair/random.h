// Private to this box: random numbers by counter [Salmon2011, Philox 4x32-10], so that each strand's do not depend on
// the others, and the few functions that must give the same bits on every CPU.
#pragma once

#include <Random123/philox.h>

#include <array>
#include <cmath>
#include <cstdint>

namespace pelage::hair {

class CounterRandom {
 public:
  explicit CounterRandom(std::uint64_t seed) noexcept
      : key_{{static_cast<std::uint32_t>(seed), static_cast<std::uint32_t>(seed >> 32)}} {}

  /// Four uniform numbers in [0, 1) for element `index` of `stream`.
  std::array<float, 4> uniform(std::uint32_t stream, std::uint32_t index) const noexcept {
    const auto bits = r123::Philox4x32()({{index, stream, 0, 0}}, key_);
    std::array<float, 4> u;
    for (std::size_t k = 0; k < 4; ++k) u[k] = static_cast<float>(bits[k] >> 8) * 0x1p-24F;
    return u;
  }

 private:
  r123::Philox4x32::key_type key_;
};

/// sin(2 pi x), error < 1e-7, from multiplications only.
inline float sin_turns(float turns) noexcept {
  double f = static_cast<double>(turns) - std::floor(static_cast<double>(turns) + 0.5);
  if (f > 0.25) f = 0.5 - f;
  if (f < -0.25) f = -0.5 - f;
  const double x = 6.283185307179586 * f, x2 = x * x;
  const double series =
      1.0 + x2 * (-1.0 / 6 + x2 * (1.0 / 120 + x2 * (-1.0 / 5040 + x2 * (1.0 / 362880 - x2 * (1.0 / 39916800)))));
  return static_cast<float>(x * series);
}
inline float cos_turns(float turns) noexcept {
  return sin_turns(turns + 0.25F);
}

/// 0 below a, 1 above b, smooth between.
inline float smooth_step(float a, float b, float x) noexcept {
  const float t = std::fmin(std::fmax((x - a) / (b - a), 0.0F), 1.0F);
  return t * t * (3.0F - 2.0F * t);
}

}  // namespace pelage::hair
