#include "pelage/db/optical_scale.h"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

namespace pelage {
namespace {

/// integral (1 - exp(-tau(x))) dx by the midpoint rule; exact to rounding for a Gaussian this wide.
double blocked_width(double mass, double sigma) {
  double sum = 0;
  const double h = sigma / 200;
  for (double x = -10 * sigma; x < 10 * sigma; x += h) {
    const double z = (x + 0.5 * h) / sigma;
    sum += h * -std::expm1(-mass / (std::sqrt(2 * std::numbers::pi) * sigma) * std::exp(-0.5 * z * z));
  }
  return sum;
}

TEST(GaussianMass, BlocksTheWidthOfTheFibre) {
  for (const double sigma : {1e-5, 1e-4, 1e-3}) {
    for (const double peak : {1e-3, 0.1, 0.5, 1.0, 2.0, 3.9}) {
      const double wanted = blocked_width(peak * std::sqrt(2 * std::numbers::pi) * sigma, sigma);
      EXPECT_NEAR(blocked_width(gaussian_mass(wanted, sigma), sigma) / wanted, 1.0, 1e-6) << sigma << " " << peak;
    }
  }
}

TEST(GaussianMass, IsTheFigureOfTheDesign) {
  // DESIGN section 3: mass a D itself blocks 8 % too little at peak depth .25 and 16 % at .5.
  const double unit = std::sqrt(2 * std::numbers::pi);
  EXPECT_NEAR(1 - blocked_width(0.25 * unit, 1) / (0.25 * unit), 0.08, 0.01);
  EXPECT_NEAR(1 - blocked_width(0.50 * unit, 1) / (0.50 * unit), 0.16, 0.01);
}

TEST(GaussianMass, StaysFiniteForAProfileNarrowerThanTheFibre) {
  const double mass = gaussian_mass(1e-3, 1e-9);
  EXPECT_TRUE(std::isfinite(mass));
  EXPECT_GE(mass, 1e-3);
}

}  // namespace
}  // namespace pelage
