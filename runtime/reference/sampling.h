// Private to this box: well-spread random numbers that depend on nothing but their index. Elements 0 .. n-1 of the
// (0,2)-sequence of van der Corput and Sobol, shifted by random digits (xor) [KolligKeller2002]: each point is
// uniform in the unit square, so means are unbiased for any n, and two sequences with different digits are independent.
// The same bits on every CPU and for any number of threads.
#pragma once

#include <Random123/philox.h>

#include <cmath>
#include <cstdint>
#include <glm/vec2.hpp>

namespace pelage {

/// Random bits by counter [Salmon2011, Philox 4x32-10].
inline r123::Philox4x32::ctr_type random_bits(std::uint64_t seed, std::uint32_t a, std::uint32_t b, std::uint32_t c = 0,
                                              std::uint32_t d = 0) noexcept {
  return r123::Philox4x32()({{a, b, c, d}},
                            {{static_cast<std::uint32_t>(seed), static_cast<std::uint32_t>(seed >> 32)}});
}

/// Middle of the 2^-32 that `bits` name, in (0, 1).
inline double unit(std::uint32_t bits) noexcept {
  return (static_cast<double>(bits) + 0.5) * 0x1p-32;
}

class SquareSequence {
 public:
  SquareSequence(std::uint32_t digits_x, std::uint32_t digits_y) noexcept : x_(digits_x), y_(digits_y) {}

  glm::dvec2 point(std::uint32_t i) const noexcept {
    std::uint32_t x = x_, y = y_, sobol = 1U << 31;
    for (std::uint32_t k = 31; i != 0; i >>= 1, --k, sobol ^= sobol >> 1) {
      if ((i & 1U) == 0) continue;
      x ^= 1U << k;
      y ^= sobol;
    }
    return {unit(x), unit(y)};
  }

 private:
  std::uint32_t x_, y_;
};

/// (cos, sin) of 2 pi x for x in [0, 1), error < 1e-8, from multiplications only.
inline glm::dvec2 on_circle(double turns) noexcept {
  const double quarter = std::floor(4 * turns + 0.5);
  const double x = 6.283185307179586 * (turns - 0.25 * quarter), x2 = x * x;  // |x| <= pi / 4
  const double s = x * (1 + x2 * (-1.0 / 6 + x2 * (1.0 / 120 + x2 * (-1.0 / 5040 + x2 * (1.0 / 362880)))));
  const double c = 1 + x2 * (-0.5 + x2 * (1.0 / 24 + x2 * (-1.0 / 720 + x2 * (1.0 / 40320))));
  switch (static_cast<int>(quarter) & 3) {
    case 0:
      return {c, s};
    case 1:
      return {-s, c};
    case 2:
      return {-c, -s};
    default:
      return {s, -c};
  }
}

/// Uniform in the unit disk where `square` is uniform in the unit square.
inline glm::dvec2 in_disk(const glm::dvec2& square) noexcept {
  return std::sqrt(square.x) * on_circle(square.y);
}

}  // namespace pelage
