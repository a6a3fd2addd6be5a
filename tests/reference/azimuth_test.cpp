#include "pelage/reference/azimuth.h"

#include <gtest/gtest.h>

#include "pelage/bake/planar_reference.h"
#include "sample_hair.h"

namespace pelage {
namespace {

constexpr double kPi = std::numbers::pi;
const glm::dvec3 kT(0, 1, 0);

/// A direction at an angle to the fibre and an azimuth; the viewer's azimuth is 0.
glm::dvec3 direction(double incline, double azimuth) {
  return {std::cos(incline) * std::sin(azimuth), std::sin(incline), std::cos(incline) * std::cos(azimuth)};
}

TEST(Azimuth, MeanOverLightAnglesAndWidthIsOne) {
  // Midpoint rule over a circle: exact for the lobes but for their kinks, error below 1e-5 at 2000 angles.
  for (const PlanarPhong& phong :
       {PlanarPhong{}, PlanarPhong{1, 0, 1}, PlanarPhong{0, 1, 80}, PlanarPhong{0.2, 3, 1}}) {
    const AzimuthTerm term(phong);
    for (const double view : {0.0, 0.7, -1.4}) {
      for (const double light : {0.3, -1.2}) {
        double sum = 0;
        constexpr int kWidths = 20, kAngles = 2000;
        for (int i = 0; i < kWidths; ++i) {
          const double h = 2 * (i + 0.5) / kWidths - 1;
          for (int j = 0; j < kAngles; ++j) {
            sum += term(kT, direction(view, 0), direction(light, 2 * kPi * (j + 0.5) / kAngles), {h, 0, 0});
          }
        }
        EXPECT_NEAR(sum / (kWidths * kAngles), 1, 1e-5) << phong.exponent << " " << view << " " << light;
      }
    }
  }
}

/// azimuth_mean() is the mean of this term over the width, as the strand renderer sees a whole fibre.
TEST(Azimuth, MeanOverTheWidthIsTheClosedForm) {
  struct Case {
    PlanarPhong phong;
    double near_tolerance, far_tolerance;  // light within 90 degrees of the viewer, and beyond, where lobes wrap
  };
  for (const Case& c : {Case{{1, 0, 1}, 1e-5, 1e-5}, Case{{}, 1e-5, 0.03}, Case{{0, 1, 80}, 1e-5, 0.045}}) {
    const AzimuthTerm term(c.phong);
    const glm::vec2 k = azimuth_coefficients(c.phong);
    for (const double incline : {0.0, 0.5}) {
      for (double azimuth = 0; azimuth <= kPi; azimuth += 0.1) {
        const glm::dvec3 v = direction(incline, 0), l = direction(-0.3, azimuth);
        constexpr int kWidths = 20000;
        double sum = 0;
        for (int i = 0; i < kWidths; ++i) sum += term(kT, v, l, {2 * (i + 0.5) / kWidths - 1, 0, 0});
        const double closed = static_cast<double>(azimuth_mean(k, glm::vec3(kT), glm::vec3(v), glm::vec3(l)));
        EXPECT_NEAR(closed, sum / kWidths, azimuth <= kPi / 2 ? c.near_tolerance : c.far_tolerance)
            << c.phong.exponent << " at " << azimuth;
      }
    }
    double around = 0;
    for (int j = 0; j < 3600; ++j)
      around += static_cast<double>(azimuth_mean(k, glm::vec3(kT), glm::vec3(direction(0, 0)),
                                                 glm::vec3(direction(0, 2 * kPi * (j + 0.5) / 3600))));
    EXPECT_NEAR(around / 3600, 1, 0.003) << c.phong.exponent;
    EXPECT_LE(azimuth_mean(k, {0, 1, 0}, {0, 0, 1}, {0, 0, 1}), 2.47F);  // what the gates of runtime/effects count on
  }
}

TEST(Azimuth, MeanOverTheWidthFadesAlongTheFibre) {
  const glm::vec2 k = azimuth_coefficients({});
  EXPECT_EQ(azimuth_mean(k, {0, 1, 0}, {0, 1, 0}, {1, 0, 0}), 1);
  EXPECT_NEAR(azimuth_mean(k, {0, 1, 0}, glm::normalize(glm::vec3(1e-4F, 1, 0)), {1, 0, 0}), 1, 1e-3F);
}

TEST(Azimuth, IsTheBakersPhongAtTheTrueNormal) {
  // The baker's normal is minus the gradient; density 0 makes its share of Phong 1. Here the share is
  // known^2 / (known^2 + kAlongFibre^2), and 1 across the fibre up to 4e-4.
  const BakeSettings settings;
  const PlanarShading baker(settings);
  const AzimuthTerm term(settings.phong);
  const double share = 1 / (1 + kAlongFibre * kAlongFibre);
  for (double h = -0.95; h < 1; h += 0.1) {
    for (double azimuth = 0; azimuth < 2 * kPi; azimuth += 0.2) {
      const glm::dvec2 normal(h, std::sqrt(1 - h * h)), light(std::sin(azimuth), std::cos(azimuth));
      const double expected = baker.reflectance(0, -normal, {0, 1}, light);
      EXPECT_NEAR(term(kT, direction(0, 0), direction(0, azimuth), {h, 0, 0}), share * expected + 1 - share, 1e-12);
    }
  }
}

TEST(Azimuth, FrontLitIsBrighterThanBackLit) {
  const AzimuthTerm term(PlanarPhong{});
  EXPECT_GT(term(kT, direction(0, 0), direction(0, 0), {0, 0, 0}), 2);
  EXPECT_LT(term(kT, direction(0, 0), direction(0, kPi), {0, 0, 0}), 0.01);
  // Light from +x: the fibre's right side, as the viewer sees it, is bright.
  EXPECT_GT(term(kT, direction(0, 0), direction(0, kPi / 2), {0.8, 0, 0}), 1);
  EXPECT_LT(term(kT, direction(0, 0), direction(0, kPi / 2), {-0.8, 0, 0}), 0.01);
}

TEST(Azimuth, FiniteAndContinuousAroundTheFibresOwnDirection) {
  const AzimuthTerm term(PlanarPhong{0.7, 0.3, 1000});
  for (const double tilt : {0.0, 1e-12, 1e-7, 1e-4}) {
    for (double azimuth = 0; azimuth < 2 * kPi; azimuth += 0.3) {
      const glm::dvec3 along = direction(kPi / 2 - tilt, azimuth), side = direction(0, 0);
      for (const auto& [v, l] : {std::pair(along, side), std::pair(side, along), std::pair(along, along)}) {
        // Phong <= (kd + ks) / mean < 4; its share <= (tilt / kAlongFibre)^2 = 2.5e-5.
        EXPECT_NEAR(term(kT, v, l, {0.5, 0, 0}), 1, 1.1e-4) << tilt << " " << azimuth;
      }
    }
  }
}

}  // namespace
}  // namespace pelage
