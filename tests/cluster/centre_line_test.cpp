// B-splines, arc length and frames of data_schema/cluster.h against formulas.
#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <numbers>

#include "pelage/data_schema/cluster.h"
#include "pelage/data_schema/errors.h"
#include "test_clusters.h"

namespace pelage {
namespace {

using test::controls_of;
constexpr double kPi = std::numbers::pi;

double angle(const glm::vec3& a, const glm::vec3& b) {
  const glm::dvec3 p(a), q(b);
  return std::atan2(glm::length(glm::cross(p, q)), glm::dot(p, q));
}

/// Angle of the rotation that takes one frame to the other.
double turn(const Frame& a, const Frame& b) {
  const double trace = static_cast<double>(glm::dot(a.tangent, b.tangent) + glm::dot(a.normal, b.normal) +
                                           glm::dot(a.binormal, b.binormal));
  return std::acos(std::clamp(0.5 * (trace - 1), -1.0, 1.0));
}

std::vector<glm::vec3> arc(double radius, double degrees, std::size_t controls) {
  const double a = degrees * kPi / 180;
  return controls_of(controls,
                     [=](double u) { return glm::dvec3(radius * std::cos(a * u), radius * std::sin(a * u), 0); });
}

TEST(BSpline, PartitionOfUnity) {
  const std::vector<glm::vec3> same(7, glm::vec3(1, 2, 3));
  for (int i = 0; i <= 1000; ++i) {
    const glm::vec3 p = evaluate_b_spline(std::span<const glm::vec3>(same), static_cast<float>(i) / 1000.0F);
    EXPECT_EQ(p, glm::vec3(1, 2, 3)) << i;
  }
}

TEST(BSpline, EndsAtItsEndPointsAndIsBezierWithFour) {
  const std::vector<glm::vec3> c{{0, 0, 0}, {1, 3, 0}, {2, -1, 4}, {5, 0, 1}};
  for (const float x : {0.0F, 0.25F, 0.7F, 1.0F}) {
    const float y = 1 - x;
    const glm::vec3 bezier = y * y * y * c[0] + 3 * x * y * y * c[1] + 3 * x * x * y * c[2] + x * x * x * c[3];
    EXPECT_LT(glm::distance(evaluate_b_spline(std::span<const glm::vec3>(c), x), bezier), 2e-6F);  // ulps of 5
  }
}

/// At an inner knot of the uniform part a cubic B-spline is (P0 + 4 P1 + P2) / 6.
TEST(BSpline, UniformKnotValue) {
  std::vector<glm::vec3> c(11, glm::vec3(0));  // 8 spans: knots at k / 8
  c[5] = {6, 0, 0};
  const auto at = [&](float x) { return evaluate_b_spline(std::span<const glm::vec3>(c), x).x; };
  EXPECT_NEAR(at(0.5F), 4, 1e-6);
  EXPECT_NEAR(at(0.375F), 1, 1e-6);
  EXPECT_NEAR(at(0.625F), 1, 1e-6);
  EXPECT_NEAR(at(0.75F), 0, 1e-6);
}

TEST(CentreLine, StraightLineIsExact) {
  const std::vector<glm::vec3> control{{0, 0, 0}, {0, .1F, 0}, {0, .15F, 0}, {0, .3F, 0}, {0, .5F, 0}};
  const CentreLine line(control, {1, 0, 0});
  EXPECT_NEAR(line.length_m(), 0.5, 1e-8);
  for (const double t : {0.0, 0.1, 0.37, 0.5, 0.99, 1.0}) {
    const Frame f = line.frame(t);
    EXPECT_NEAR(static_cast<double>(f.position.y), 0.5 * t, 1e-7);
    EXPECT_EQ(f.curvature_per_m, 0.0F);
    EXPECT_EQ(f.normal, glm::vec3(1, 0, 0));
  }
}

/// A spline with 16 control points follows a quarter circle to 1e-8 of its radius.
TEST(CentreLine, CircleArcHasItsLengthCurvatureAndEvenSpacing) {
  const double radius = 0.05;
  const std::vector<glm::vec3> control = arc(radius, 90, 16);
  const CentreLine line(control, {0, 0, 1});
  EXPECT_NEAR(line.length_m(), radius * kPi / 2, 1e-6 * radius);
  for (int i = 0; i <= 40; ++i) {
    const double t = i / 40.0;
    const Frame f = line.frame(t);
    EXPECT_NEAR(static_cast<double>(f.curvature_per_m), 1 / radius, 0.01 / radius) << t;
    EXPECT_NEAR(std::atan2(static_cast<double>(f.position.y), static_cast<double>(f.position.x)), t * kPi / 2, 1e-5);
    EXPECT_NEAR(static_cast<double>(f.normal.z), 1, 1e-6) << "the normal of the plane stays";
  }
}

/// Uneven control points: t must be arc length all the same, against a chord sum of a million steps (1e-9).
TEST(CentreLine, ArcLengthTo1e4OnHardLines) {
  for (const test::NamedLine& hard : test::hard_lines()) {
    SCOPED_TRACE(hard.name);
    constexpr int kSteps = 100000;
    std::vector<double> length(kSteps + 1, 0.0);
    std::vector<glm::dvec3> at(kSteps + 1);
    const auto n = hard.control.size();
    for (int i = 0; i <= kSteps; ++i) {
      const hair::BasisRow row = hair::basis_row(n, i / static_cast<double>(kSteps));
      glm::dvec3 p(0);
      for (std::size_t j = 0; j < 4; ++j) p += row.weights[j] * glm::dvec3(hard.control[row.first + j]);
      const auto k = static_cast<std::size_t>(i);
      at[k] = p;
      if (i > 0) length[k] = length[k - 1] + glm::distance(p, at[k - 1]);
    }
    const CentreLine line(hard.control, {0, 0, 1});
    EXPECT_NEAR(line.length_m(), length.back(), 1e-4 * length.back());
    for (int i = 1; i < 20; ++i) {
      const double t = i / 20.0;
      const auto k =
          static_cast<std::size_t>(std::lower_bound(length.begin(), length.end(), t * length.back()) - length.begin());
      const double scale = std::max(length.back(), 0.01 * glm::length(at[k]));  // float far from the origin
      EXPECT_LT(glm::distance(glm::dvec3(line.frame(t).position), at[k]), 2e-4 * scale) << t;
    }
  }
}

TEST(CentreLine, FramesAreOrthonormalAndNeverFlip) {
  for (const test::NamedLine& hard : test::hard_lines()) {
    SCOPED_TRACE(hard.name);
    const CentreLine line(hard.control, {0.3F, 0.4F, 0.5F});
    Frame last = line.frame(0);
    for (int i = 0; i <= 4000; ++i) {
      const Frame f = line.frame(i / 4000.0);
      ASSERT_NEAR(glm::length(f.tangent), 1, 1e-6) << i;
      ASSERT_NEAR(glm::length(f.normal), 1, 1e-6) << i;
      ASSERT_NEAR(glm::dot(f.normal, f.tangent), 0, 1e-6) << i;
      ASSERT_LT(glm::distance(glm::cross(f.normal, f.binormal), f.tangent), 1e-6) << i;
      ASSERT_TRUE(std::isfinite(f.curvature_per_m) && f.curvature_per_m >= 0) << i;
      // Frames turn with their segments, not more than twice as far; 2e-3: float noise of acos near 1.
      ASSERT_LE(turn(last, f), 2 * angle(last.tangent, f.tangent) + 2e-3) << i;
      last = f;
    }
  }
}

TEST(CentreLine, FoldKeepsTheNormal) {
  const std::vector<glm::vec3> fold{{0, 0, 0}, {.1F, 0, 0}, {.2F, 0, 0}, {.1F, 0, 0}, {0, 0, 0}};
  const CentreLine line(fold, {0, 0, 1});
  EXPECT_NEAR(line.frame(0).tangent.x, 1, 1e-6);
  EXPECT_NEAR(line.frame(1).tangent.x, -1, 1e-6);
  EXPECT_NEAR(line.frame(1).normal.z, 1, 1e-6);
  EXPECT_NEAR(line.frame(0.5).position.x, 0.15, 1e-4);  // where the spline turns: (2 * .1 + 4 * .2 + ...) by symmetry
}

/// A helix of curvature k and torsion w: the rotation-minimising frame turns against the principal normal by the
/// integral of the torsion.
TEST(CentreLine, HelixTwistIsTheIntegralOfTorsion) {
  const double radius = 0.02, pitch = 0.01, turns = 3;  // pitch per radian
  const std::vector<glm::vec3> control = controls_of(80, [=](double u) {
    const double a = 2 * kPi * turns * u;
    return glm::dvec3(radius * std::cos(a), radius * std::sin(a), pitch * a);
  });
  const CentreLine line(control, {1, 0, 0});
  const double scale_sq = radius * radius + pitch * pitch;
  const double torsion = pitch / scale_sq, length = 2 * kPi * turns * std::sqrt(scale_sq);
  const auto from_principal =
      [&](double t) {  // angle of the frame's normal from the principal normal, about the tangent
        const Frame f = line.frame(t);
        const double a = 2 * kPi * turns * t;
        const glm::dvec3 principal(-std::cos(a), -std::sin(a), 0);
        return std::atan2(glm::dot(glm::cross(principal, glm::dvec3(f.normal)), glm::dvec3(f.tangent)),
                          glm::dot(principal, glm::dvec3(f.normal)));
      };
  EXPECT_NEAR(line.length_m(), length, 1e-4 * length);
  for (const double t : {0.1, 0.35, 0.5, 0.8, 1.0}) {
    const double expected = -torsion * length * t;
    const double error = std::remainder(from_principal(t) - from_principal(0.0) - expected, 2 * kPi);
    EXPECT_NEAR(error, 0, 2e-3) << t;  // the spline follows the helix to 1e-6 of its radius, its ends worse
  }
}

TEST(CentreLine, RefusesWhatHasNoShape) {
  const float nan = std::numeric_limits<float>::quiet_NaN();
  EXPECT_THROW(CentreLine(std::vector<glm::vec3>(3, glm::vec3(1)), {1, 0, 0}), InputError);
  EXPECT_THROW(CentreLine(std::vector<glm::vec3>(5, glm::vec3(1)), {1, 0, 0}), InputError);
  try {
    const CentreLine line(std::vector<glm::vec3>{{0, 0, 0}, {1, 0, 0}, {nan, 0, 0}, {3, 0, 0}}, {1, 0, 0});
    FAIL() << "NaN was accepted";
  } catch (const InputError& e) {
    EXPECT_STREQ(e.what(), "centre_line[2]: not a finite point");
  }
}

TEST(CentreLine, AnyFirstNormalWillDo) {
  const float nan = std::numeric_limits<float>::quiet_NaN();
  const std::vector<glm::vec3> control{{0, 0, 0}, {1, 0, 0}, {2, 0, 0}, {3, 0, 0}};
  for (const glm::vec3 n : {glm::vec3(1, 0, 0), glm::vec3(0), glm::vec3(nan), glm::vec3(1e30F, 1e30F, 0)}) {
    const Frame f = CentreLine(control, n).frame(0.5);
    EXPECT_NEAR(glm::length(f.normal), 1, 1e-6);
    EXPECT_NEAR(glm::dot(f.normal, f.tangent), 0, 1e-6);
  }
}

/// A plate of a circular arc of radius 50 mm cuts its neighbour as soon as it is wider than that, and not before.
TEST(Sweep, CountsPlatesThatOverlap) {
  for (const float radius : {0.045F, 0.049F, 0.051F, 0.06F}) {
    Cluster c;
    c.centre_line = arc(0.05, 90, 16);
    c.cross_sections.assign(4, cross_section({radius, radius, 0}));
    EXPECT_EQ(overlapping_plates(sweep(c, 20)), radius > 0.05F ? 20 : 0) << radius;
  }
}

TEST(Sweep, FramesDoNotDependOnThePlates) {
  const Cluster c = test::bent_cluster();
  const SweptCluster coarse = sweep(c, 5), fine = sweep(c, 50);
  for (std::size_t i = 0; i <= 5; ++i) EXPECT_EQ(coarse.frames[i].normal, fine.frames[10 * i].normal);
}

TEST(Sweep, RefusesBadClusters) {
  Cluster c = test::bent_cluster();
  EXPECT_THROW(sweep(c, 0), InputError);
  c.cross_sections[2] = {1e-3F, 2e-3F, 1e-3F};  // not positive definite
  EXPECT_THROW(sweep(c, 8), InputError);
  c.cross_sections.resize(3);
  EXPECT_THROW(sweep(c, 8), InputError);
}

}  // namespace
}  // namespace pelage
