// Density features and their scale (HARD_CASES 13, 18).
#include "pelage/db/features.h"

#include <gtest/gtest.h>
#include <tbb/global_control.h>

#include <cmath>
#include <random>

namespace pelage {
namespace {

constexpr FeatureSet kSets[] = {FeatureSet::paper3, FeatureSet::moments5, FeatureSet::profile11};

std::vector<float> features(SectorCrossings points, FeatureSet set) {
  std::vector<float> out(static_cast<std::size_t>(dimension(set)));
  density_features(projections(points, 32, 0.05), set, out);
  return out;
}

std::vector<glm::vec2> scatter(int count, unsigned seed, float low = 0.2F, float high = 0.8F) {
  std::mt19937 random(seed);
  std::uniform_real_distribution<float> at(low, high);
  std::vector<glm::vec2> points;
  for (int i = 0; i < count; ++i) {
    const float s = at(random);
    points.emplace_back(s, at(random));
  }
  return points;
}

TEST(Features, MomentsOfALoneStrand) {
  const std::vector<glm::vec2> one{{0.4F, 0.6F}};
  const std::vector<float> f = features(one, FeatureSet::moments5);
  // The prior of .001 strands at 1/2 moves means by 1e-4 and adds .001/12 to a variance of .0025 (1.7 % of the spread).
  EXPECT_NEAR(f[0], 1, 1e-4);
  EXPECT_NEAR(f[1], 0.4, 2e-4);
  EXPECT_NEAR(f[2], 0.6, 2e-4);
  EXPECT_NEAR(f[3], 0.05, 0.0012);
  EXPECT_NEAR(f[4], 0.05, 0.0012);
}

TEST(Features, Paper3IsTheBeginningOfMoments5) {
  const auto points = scatter(9, 1);
  const auto a = features(points, FeatureSet::paper3), b = features(points, FeatureSet::moments5);
  EXPECT_TRUE(std::equal(a.begin(), a.end(), b.begin()));
}

TEST(Features, CosineCoefficientsOfALoneStrand) {
  const std::vector<glm::vec2> one{{0.4F, 0.6F}};
  const std::vector<float> f = features(one, FeatureSet::profile11);
  for (int k = 1; k <= 5; ++k) {
    // Fourier transform of the Gaussian: exp(-(pi k sigma)^2 / 2) cos(pi k s). Its reflection at the border is < 1e-14.
    const double damping = std::exp(-0.5 * std::pow(M_PI * k * 0.05, 2));
    EXPECT_NEAR(f[static_cast<std::size_t>(k)], damping * std::cos(M_PI * k * 0.4), 1e-5) << k;
    EXPECT_NEAR(f[static_cast<std::size_t>(5 + k)], damping * std::cos(M_PI * k * 0.6), 1e-5) << k;
  }
}

TEST(Features, EmptySectorIsDefinedAndNearlyEmptyOnesLeadToIt) {
  const std::vector<glm::vec2> none;
  for (const FeatureSet set : kSets)
    for (const float f : features(none, set)) EXPECT_TRUE(std::isfinite(f));
  const auto empty = features(none, FeatureSet::moments5);
  EXPECT_EQ(empty[0], 0);
  EXPECT_FLOAT_EQ(empty[1], 0.5F);
  EXPECT_FLOAT_EQ(empty[2], 0.5F);
  EXPECT_NEAR(empty[3], std::sqrt(1.0 / 12), 1e-6);
  // A strand that leaves: the means come back to 1/2 without a jump.
  float last = features(std::vector<glm::vec2>{{-0.1F, 0.2F}}, FeatureSet::paper3)[2];
  for (float s = -0.1F; s > -0.35F; s -= 0.002F) {
    const float mean_r = features(std::vector<glm::vec2>{{s, 0.2F}}, FeatureSet::paper3)[2];
    EXPECT_LT(std::abs(mean_r - last), 0.02F) << s;
    last = mean_r;
  }
  EXPECT_NEAR(last, 0.5, 0.01);
}

TEST(Features, ManyStrandsAndStrandsOnTheBorderAreFinite) {
  std::vector<glm::vec2> border;
  for (int i = 0; i < 50; ++i) border.emplace_back(i % 2, 0.02F * static_cast<float>(i));
  for (const FeatureSet set : kSets) {
    for (const float f : features(scatter(10000, 2, 0, 1), set)) EXPECT_TRUE(std::isfinite(f));
    for (const float f : features(border, set)) EXPECT_TRUE(std::isfinite(f));
  }
}

TEST(Features, ScaleGivesMeanZeroAndVarianceOne) {
  for (const FeatureSet set : kSets) {
    std::vector<float> all;
    for (unsigned i = 0; i < 300; ++i) {
      const auto f = features(scatter(static_cast<int>(1 + i % 20), i), set);
      all.insert(all.end(), f.begin(), f.end());
    }
    const FeatureScale scale = fit_scale(all, dimension(set));
    scale.apply(all);
    const auto width = static_cast<std::size_t>(dimension(set));
    for (std::size_t d = 0; d < width; ++d) {
      double mean = 0, square = 0;
      for (std::size_t i = d; i < all.size(); i += width)
        mean += double{all[i]} / 300, square += double{all[i]} * double{all[i]} / 300;
      EXPECT_NEAR(mean, 0, 1e-6) << d;
      EXPECT_NEAR(square, 1, 1e-5) << d;
    }
  }
}

TEST(Features, ConstantDimensionIsIgnoredNotInfinite) {
  const std::vector<float> same{1, 0.3F, 2, 0.3F, 3, 0.3F};
  const FeatureScale scale = fit_scale(same, 2);
  EXPECT_EQ(scale.inv_sigma[1], 0);
  std::vector<float> query{2, 9};
  scale.apply(query);
  EXPECT_FLOAT_EQ(query[0], 0);
  EXPECT_EQ(query[1], 0);
}

TEST(Features, OfASectorSetAreTheSameForAnyNumberOfThreads) {
  SectorSet set;
  set.plates = 1;
  for (unsigned i = 0; i < 500; ++i) {
    for (const glm::vec2& p : scatter(static_cast<int>(i % 30), i)) set.crossings.push_back(p);
    set.offsets.push_back(static_cast<std::uint32_t>(set.crossings.size()));
  }
  const auto alone = density_features(set, FeatureSet::profile11, 32, 0.05);
  EXPECT_EQ(std::vector<float>(alone.begin() + 11 * 7, alone.begin() + 11 * 8),
            features(set.sector(7), FeatureSet::profile11));
  for (const std::size_t threads : {1U, 2U, 3U, 8U}) {
    const tbb::global_control limit(tbb::global_control::max_allowed_parallelism, threads);
    EXPECT_EQ(density_features(set, FeatureSet::profile11, 32, 0.05), alone) << threads;
  }
}

}  // namespace
}  // namespace pelage
