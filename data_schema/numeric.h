// Small numerics that must give the same bits on every CPU (libm's do not: glibc picks FMA variants at run time).
#pragma once

#include <algorithm>
#include <bit>
#include <cstdint>

namespace pelage {

/// exp(-x) for x >= 0, relative error < 3e-7 up to x = 87 (the end of float's normal range), 0 from x = 87.7 on.
/// Branch-free and auto-vectorisable (with -fno-trapping-math; a select at the end would stop AVX2 from it). Range
/// reduction to [-ln2/2, ln2/2], then a Taylor polynomial of degree 6 (remainder < 1.3e-7).
inline float exp_neg(float x) noexcept {
  const float bounded = std::min(std::max(x, 0.0F), 88.0F);
  const float scaled = -1.44269504F * bounded;
  const auto k = static_cast<std::int32_t>(scaled - 0.5F);  // round half away, scaled <= 0
  const auto kf = static_cast<float>(k);
  const float r = (-bounded - kf * 0.693359375F) + kf * 2.12194440e-4F;  // Cody-Waite: ln2 in two parts
  float p = 1.0F / 720.0F;
  p = p * r + 1.0F / 120.0F;
  p = p * r + 1.0F / 24.0F;
  p = p * r + 1.0F / 6.0F;
  p = p * r + 0.5F;
  p = p * r + 1.0F;
  p = p * r + 1.0F;
  return p * std::bit_cast<float>((k + 127) << 23);  // 2^k; k = -127 at the end of the range: 0
}

}  // namespace pelage
