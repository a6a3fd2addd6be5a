// Density grid: mass, accuracy of the sampled Gaussian, borders, projections, given fields (HARD_CASES 11, 18).
#include "pelage/db/density_grid.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <numeric>
#include <random>

#include "pelage/data_schema/errors.h"

namespace pelage {
namespace {

double gaussian(double x, double sigma) {
  return std::exp(-0.5 * x * x / (sigma * sigma)) / (sigma * 2.506628274631);
}

double mean(const std::vector<double>& v) {
  return std::accumulate(v.begin(), v.end(), 0.0) / static_cast<double>(v.size());
}

std::vector<glm::vec2> scatter(int count, unsigned seed) {
  std::mt19937 random(seed);
  std::uniform_real_distribution<float> at(-kSectorMargin, 1 + kSectorMargin);
  std::vector<glm::vec2> points;
  for (int i = 0; i < count; ++i) {
    const float s = at(random);
    points.emplace_back(s, at(random));
  }
  return points;
}

TEST(DensityGrid, CellsHoldTheGaussianAtTheirCentres) {
  const std::vector<glm::vec2> points = scatter(5, 1);
  const DensityGrid grid = density_grid(points, 32, 0.05);
  for (int r = 0; r < 32; ++r)
    for (int s = 0; s < 32; ++s) {
      double expected = 0;
      for (const glm::vec2& p : points)
        expected += gaussian((s + 0.5) / 32 - double{p.x}, 0.05) * gaussian((r + 0.5) / 32 - double{p.y}, 0.05);
      // Cut at 6.5 sigma: 7e-10 of the peak (63.7) per axis.
      EXPECT_NEAR(grid.at(r, s), expected, 1e-7) << r << ' ' << s;
    }
}

TEST(DensityGrid, OneStrandInTheMiddleHasMassOne) {
  for (const int size : {8, 32, 128})
    for (const double sigma : {0.01, 0.05, 0.08}) {
      const std::vector<glm::vec2> one{{0.47F, 0.52F}};
      // Aliasing of a Gaussian at least 0.6 cells wide: 2 exp(-2 pi^2 0.36) = .0016 per axis.
      EXPECT_NEAR(mean(density_grid(one, size, sigma).values), 1, 0.0034) << size << ' ' << sigma;
    }
}

TEST(DensityGrid, StrandsOutsideReachInAndDoNotWrap) {
  const std::vector<glm::vec2> outside{{-0.02F, 0.5F}};
  const DensityGrid grid = density_grid(outside, 32, 0.05);
  EXPECT_GT(grid.at(16, 0), 10);
  EXPECT_EQ(grid.at(16, 31), 0);
  // The part of the Gaussian that lies inside: Phi(-0.02 / 0.05) = .3446; the midpoint rule at its cut end errs by
  // -h^2 / 24 times the slope there (59), the next order is a tenth of that.
  EXPECT_NEAR(mean(grid.values), 0.3446 - 0.0024, 3e-4);
}

// The choice stated in the header: the bilinear interpolant of point samples is nearer to the Gaussian than that of
// cell means (differences of erf).
TEST(DensityGrid, PointSamplesBeatCellMeans) {
  constexpr int kSize = 32;
  constexpr double kSigma = 0.05;
  const auto point = [](double x) { return gaussian(x, kSigma); };
  const auto cell = [](double x) {
    const double k = kSigma * std::sqrt(2.0), half = 0.5 / kSize;
    return 0.5 * kSize * (std::erf((x + half) / k) - std::erf((x - half) / k));
  };
  // Largest error over positions in a cell; the other axis is the same, so along one axis it is half of the error in
  // 2D.
  const auto worst = [&](const auto& sample) {
    double error = 0;
    for (int phase = 0; phase < 32; ++phase)
      for (double x = -0.2; x < 0.2; x += 0.001) {
        const double offset = phase / (32.0 * kSize);
        const double left = std::floor((x - offset) * kSize) / kSize + offset;
        const double t = (x - left) * kSize;
        error = std::max(error, std::abs((1 - t) * sample(left) + t * sample(left + 1.0 / kSize) - point(x)));
      }
    return error / point(0);
  };
  RecordProperty("point_samples", std::to_string(worst(point)));
  RecordProperty("cell_means", std::to_string(worst(cell)));
  EXPECT_LT(worst(point), 0.05);
  EXPECT_LT(worst(point), 0.8 * worst(cell));
}

TEST(DensityGrid, ExtremeSectorsAreFinite) {
  std::vector<glm::vec2> many = scatter(10000, 2);
  std::vector<glm::vec2> border;
  for (int i = 0; i < 100; ++i) border.emplace_back(0.01F * static_cast<float>(i), i % 2 == 0 ? 0.0F : 1.0F);
  const std::vector<glm::vec2> none;
  for (const std::vector<glm::vec2>& points : {many, border, none}) {
    const DensityGrid grid = density_grid(points, 32, 0.05);
    for (const double v : grid.values) ASSERT_TRUE(std::isfinite(v) && v >= 0);
  }
  EXPECT_EQ(mean(density_grid(none, 32, 0.05).values), 0);
  // Half of each; in s another 100 sigma / sqrt(2 pi) = 2 leave at each end.
  EXPECT_NEAR(mean(density_grid(border, 32, 0.05).values), 0.5 * (100 - 4), 0.3);
}

TEST(DensityGrid, ProjectionsOfCrossingsAreThoseOfTheGrid) {
  for (const int size : {8, 31, 128}) {
    const std::vector<glm::vec2> points = scatter(40, 3);
    const Projections direct = projections(points, size, 0.05);
    const Projections of_grid = projections(density_grid(points, size, 0.05));
    for (std::size_t i = 0; i < direct.along_s.size(); ++i) {
      EXPECT_NEAR(direct.along_s[i], of_grid.along_s[i], 1e-12 * (1 + of_grid.along_s[i]));
      EXPECT_NEAR(direct.along_r[i], of_grid.along_r[i], 1e-12 * (1 + of_grid.along_r[i]));
    }
  }
}

TEST(DensityGrid, GivenFieldIsResampled) {
  const std::vector<double> uniform(5 * 7, 3.0);
  for (const double v : density_grid(uniform, 5, 7, 32).values) EXPECT_NEAR(v, 3, 1e-12);
  const DensityGrid grid = density_grid(scatter(20, 4), 32, 0.05);
  EXPECT_EQ(density_grid(grid.values, 32, 32, 32).values, grid.values);
  // A ramp along s, 64 columns to 16: averaging keeps it a ramp away from the ends.
  std::vector<double> ramp;
  for (int i = 0; i < 64; ++i) ramp.push_back((i + 0.5) / 64);
  const DensityGrid coarse = density_grid(ramp, 1, 64, 16);
  for (int s = 1; s < 15; ++s) EXPECT_NEAR(coarse.at(8, s), (s + 0.5) / 16, 1e-12);
}

TEST(DensityGrid, ImpossibleFieldsAreRefusedByIndexAndValue) {
  std::vector<double> field(12, 1.0);
  EXPECT_THROW(density_grid(field, 3, 5, 32), InputError);
  EXPECT_THROW(density_grid(std::vector<double>{}, 0, 0, 32), InputError);
  for (const double bad : {-1.0, std::numeric_limits<double>::quiet_NaN(), std::numeric_limits<double>::infinity()}) {
    field[7] = bad;
    try {
      density_grid(field, 3, 4, 32);
      FAIL() << bad;
    } catch (const InputError& e) {
      EXPECT_NE(std::string(e.what()).find("index 7"), std::string::npos) << e.what();
    }
  }
}

}  // namespace
}  // namespace pelage
