// The least-squares splines of a cluster.
#include "pelage/hair/cluster_curve.h"

#include <gtest/gtest.h>

#include <cmath>
#include <random>

#include "test_clusters.h"

namespace pelage::hair {
namespace {

/// Two routes to the same spline: the fit's basis functions, the runtime's blossom.
TEST(ClusterCurve, BasisAgreesWithTheEvaluation) {
  std::mt19937 random(3);
  std::uniform_real_distribution<float> uniform(-1, 1);
  for (const std::size_t n : {4U, 5U, 6U, 7U, 12U, 32U}) {
    std::vector<glm::vec3> control;
    for (std::size_t i = 0; i < n; ++i) control.emplace_back(uniform(random), uniform(random), uniform(random));
    for (int i = 0; i <= 200; ++i) {
      const BasisRow row = basis_row(n, i / 200.0);
      glm::dvec3 p(0);
      double sum = 0;
      for (std::size_t j = 0; j < 4; ++j) {
        EXPECT_GE(row.weights[j], 0.0);
        p += row.weights[j] * glm::dvec3(control[row.first + j]);
        sum += row.weights[j];
      }
      EXPECT_NEAR(sum, 1.0, 1e-14);
      EXPECT_LT(glm::distance(glm::vec3(p),
                              evaluate_b_spline(std::span<const glm::vec3>(control), static_cast<float>(i / 200.0))),
                1e-5F)
          << n << ' ' << i;
    }
  }
}

/// Samples of a spline give back the spline.
TEST(ClusterCurve, FitReproducesSplines) {
  const Cluster c = test::bent_cluster();
  const std::vector<glm::vec3> fitted = test::controls_of(c.centre_line.size(), [&](double u) {
    const BasisRow row = basis_row(c.centre_line.size(), u);
    glm::dvec3 p(0);
    for (std::size_t j = 0; j < 4; ++j) p += row.weights[j] * glm::dvec3(c.centre_line[row.first + j]);
    return p;
  });
  for (std::size_t i = 0; i < fitted.size(); ++i) EXPECT_LT(glm::distance(fitted[i], c.centre_line[i]), 1e-7F);
}

TEST(ClusterCurve, SmoothingLeavesStraightLinesAlone) {
  std::vector<CurveSample> samples;
  for (int i = 0; i <= 50; ++i) samples.push_back({i / 50.0, glm::dvec3(1, 2, 3) * (i / 50.0), 1.0});
  const std::vector<glm::vec3> line = fit_curve(samples, {}, 9, 1.0);
  for (const float x : {0.0F, 0.3F, 1.0F}) {
    EXPECT_LT(glm::distance(evaluate_b_spline(std::span(line), x), x * glm::vec3(1, 2, 3)), 1e-5F);
  }
}

/// A sine of n periods loses about (2 pi n)^4 smoothing of its amplitude: fit_curve's promise.
TEST(ClusterCurve, SmoothingDampsWavesAsStated) {
  const double periods = 3, smoothing = 1e-6;
  std::vector<CurveSample> samples;
  for (int i = 0; i <= 600; ++i) {
    samples.push_back({i / 600.0, glm::dvec3(0, std::sin(2 * 3.14159265358979 * periods * i / 600.0), 0), 1.0});
  }
  const std::vector<glm::vec3> wave = fit_curve(samples, {}, 40, smoothing);
  const double kept = 1 / (1 + smoothing * std::pow(2 * 3.14159265358979 * periods, 4));
  EXPECT_NEAR(static_cast<double>(evaluate_b_spline(std::span(wave), 5.0F / 12).y), kept, 0.02);
}

/// Steps alone fix the shape, one point the place.
TEST(ClusterCurve, StepsGiveTheDirection) {
  std::vector<StepSample> steps;
  for (int i = 0; i < 20; ++i) steps.push_back({i / 20.0, (i + 1) / 20.0, glm::dvec3(0, 0.01, 0), 1.0});
  const std::vector<CurveSample> point{{0.5, glm::dvec3(1, 0, 0), 1.0}};
  const std::vector<glm::vec3> line = fit_curve(point, steps, 6, 1e-9);
  EXPECT_LT(glm::distance(evaluate_b_spline(std::span(line), 1.0F), glm::vec3(1, 0.1F, 0)), 1e-4F);
  EXPECT_LT(glm::distance(evaluate_b_spline(std::span(line), 0.0F), glm::vec3(1, -0.1F, 0)), 1e-4F);
}

TEST(ClusterCurve, CrossSectionsHoldTheShareAskedFor) {
  std::mt19937 random(5);
  std::normal_distribution<double> normal;
  std::vector<PlaneSample> samples;
  for (int i = 0; i < 20000; ++i) {
    const double t = i / 20000.0;
    samples.push_back({t, glm::dvec2((1 + t) * 2e-3 * normal(random), 1e-3 * normal(random)), 1.0});
  }
  const std::vector<CrossSection> s = fit_cross_sections(samples, 8, 0.95, 1e-5);
  int inside = 0;
  for (const PlaneSample& p : samples) {
    const glm::vec2 d = evaluate_b_spline(std::span(s), static_cast<float>(p.t)).solve(glm::vec2(p.plane_m));
    inside += glm::dot(d, d) <= 1;
  }
  EXPECT_NEAR(inside / 20000.0, 0.95, 0.001);
  // 95 % of a two-dimensional normal distribution lie within 2.448 standard deviations; 3 %: 20,000 samples in 8
  // sections
  EXPECT_NEAR(static_cast<double>(s.front().xx), 2.448 * 2e-3, 0.06 * 2.448 * 2e-3);
  EXPECT_NEAR(static_cast<double>(s.back().xx), 2.448 * 4e-3, 0.06 * 2.448 * 4e-3);
  EXPECT_NEAR(static_cast<double>(s[4].yy), 2.448 * 1e-3, 0.03 * 2.448 * 1e-3);
}

TEST(ClusterCurve, CrossSectionsAreNeverThinnerThanAStrand) {
  const std::vector<PlaneSample> one{{0.5, glm::dvec2(0), 1.0}};
  for (const CrossSection& s : fit_cross_sections(one, 8, 0.95, 1e-4)) {
    EXPECT_FLOAT_EQ(ellipse_axes(s).b_m, 1e-4F);
    EXPECT_FLOAT_EQ(ellipse_axes(s).a_m, 1e-4F);
  }
}

}  // namespace
}  // namespace pelage::hair
