// Cross-sections as matrices and as half-axes with a phase; where strands cross plates.
#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

#include "pelage/data_schema/cluster.h"
#include "test_clusters.h"

namespace pelage {
namespace {

constexpr double kPi = std::numbers::pi;

/// Eq. 1 as printed shifts the phase u by theta and leaves the ellipse where it is; here theta turns it: the point at u
/// = 0 lies at distance a in direction theta.
TEST(CrossSection, ThetaTurnsTheEllipse) {
  const CrossSection s = cross_section({3.0F, 1.0F, static_cast<float>(kPi / 6)});
  const glm::vec2 axis(std::cos(kPi / 6), std::sin(kPi / 6));
  EXPECT_LT(glm::distance(s.apply(axis), 3.0F * axis), 1e-6F);
  const glm::vec2 across(-axis.y, axis.x);
  EXPECT_LT(glm::distance(s.apply(across), across), 1e-6F);
}

TEST(CrossSection, AxesRoundTrip) {
  for (const float ratio : {0.02F, 0.2F, 0.9F, 0.999F}) {
    for (int i = -17; i <= 18; ++i) {
      const EllipseAxes in{0.01F, 0.01F * ratio, static_cast<float>(i * kPi / 36)};
      const EllipseAxes out = ellipse_axes(cross_section(in));
      EXPECT_NEAR(out.a_m / in.a_m, 1, 1e-6);
      EXPECT_NEAR((out.b_m - in.b_m) / in.a_m, 0, 4e-7);  // S is stored in float: an ulp of a
      // theta is as well defined as the axes differ; -pi/2 and pi/2 are the same ellipse
      const double error = std::remainder(static_cast<double>(out.theta_rad - in.theta_rad), kPi);
      EXPECT_NEAR(error, 0, 1e-6 / (1 - static_cast<double>(ratio)));
      EXPECT_GT(out.theta_rad, -static_cast<float>(kPi / 2));
      EXPECT_LE(out.theta_rad, static_cast<float>(kPi / 2));
    }
  }
}

TEST(CrossSection, CircleAndNegativeZeroHaveAnglesInRange) {
  EXPECT_EQ(ellipse_axes({2, 0, 2}).theta_rad, 0.0F);
  EXPECT_FLOAT_EQ(ellipse_axes({1, -0.0F, 2}).theta_rad, static_cast<float>(kPi / 2));
  EXPECT_FLOAT_EQ(ellipse_axes({1, 0, 2}).a_m, 2.0F);
}

/// Convex combinations of positive definite matrices are positive definite: thin ellipses at right angles, every t.
TEST(CrossSection, SplineStaysPositiveDefinite) {
  std::vector<CrossSection> control;
  for (int i = 0; i < 7; ++i) control.push_back(cross_section({.01F, .0002F, static_cast<float>(1.3 * i)}));
  for (int i = 0; i <= 1000; ++i) {
    const CrossSection s = evaluate_b_spline(std::span<const CrossSection>(control), static_cast<float>(i) / 1000.0F);
    const EllipseAxes axes = ellipse_axes(s);
    EXPECT_GE(axes.b_m, .0002F * 0.999F) << i;  // the smallest eigenvalue is at least the smallest of the controls
    EXPECT_LE(axes.a_m, .01F * 1.001F) << i;
  }
}

TEST(CrossSection, SolveInvertsApply) {
  const CrossSection s = cross_section({.012F, .004F, .7F});
  const glm::vec2 p(.3F, -.8F);
  EXPECT_LT(glm::distance(s.solve(s.apply(p)), p), 1e-6F);
}

TEST(PlateCrossings, InterpolatesInsideTheRangeOnly) {
  Cluster c;
  c.strand_points = {{.2F, 0, 0}, {.4F, 1, 0}, {.8F, 1, -1}, {.5F, .5F, .5F}, {.6F, .5F, .5F}};
  c.strand_offsets = {0, 3, 5};
  const auto at = [&](float t) { return plate_crossings(c, t); };
  EXPECT_TRUE(at(.19F).empty());
  EXPECT_TRUE(at(.81F).empty());
  EXPECT_TRUE(at(std::nanf("")).empty());
  ASSERT_EQ(at(.2F).size(), 1U);
  EXPECT_EQ(at(.2F)[0].disk, glm::vec2(0, 0));
  EXPECT_EQ(at(.8F)[0].disk, glm::vec2(1, -1));
  EXPECT_LT(glm::distance(at(.3F)[0].disk, glm::vec2(.5F, 0)), 1e-6F);
  ASSERT_EQ(at(.55F).size(), 2U);
  EXPECT_EQ(at(.55F)[0].strand, 0U);
  EXPECT_EQ(at(.55F)[1].strand, 1U);
  EXPECT_LT(glm::distance(at(.6F)[0].disk, glm::vec2(1, -.5F)), 1e-6F);
}

}  // namespace
}  // namespace pelage
