#include "pelage/db/optical_scale.h"

#include <algorithm>
#include <cmath>
#include <numbers>

namespace pelage {
namespace {

constexpr double kLargestPeak = 4.0;

/// integral (1 - exp(-q exp(-x^2/2))) dx / sqrt(2 pi) = sum over k >= 1 of (-1)^(k+1) q^k / (k! sqrt(k)).
double blocked(double q) noexcept {
  double term = 1.0, sum = 0.0;
  for (int k = 1; k <= 40; ++k) {
    term *= -q / k;
    sum -= term / std::sqrt(static_cast<double>(k));
  }
  return sum;
}

}  // namespace

double gaussian_mass(double blocked_width_m, double sigma_m) noexcept {
  const double unit = std::sqrt(2.0 * std::numbers::pi) * sigma_m;
  const double wanted = blocked_width_m / unit;
  if (wanted >= blocked(kLargestPeak)) return blocked_width_m * kLargestPeak / blocked(kLargestPeak);
  // Bisection on a monotone function: 50 halvings reach rounding.
  double low = wanted, high = kLargestPeak;
  for (int i = 0; i < 50; ++i) {
    const double middle = 0.5 * (low + high);
    (blocked(middle) < wanted ? low : high) = middle;
  }
  return 0.5 * (low + high) * unit;
}

}  // namespace pelage
