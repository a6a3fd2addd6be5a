// Random sectors and representatives of a hairstyle.
#include "pelage/bake/sector_sampling.h"

#include <gtest/gtest.h>
#include <tbb/global_control.h>

#include <algorithm>
#include <cmath>
#include <random>
#include <set>

#include "pelage/data_schema/sector.h"

namespace pelage {
namespace {

int strands_inside(const std::vector<glm::vec2>& sector) {
  return static_cast<int>(std::count_if(sector.begin(), sector.end(),
                                        [](glm::vec2 p) { return p.x >= 0 && p.x < 1 && p.y >= 0 && p.y <= 1; }));
}

TEST(RandomSector, DependsOnSeedAndIndexOnly) {
  BakeSettings settings;
  const auto seventh = random_sector(settings, 7);
  random_sector(settings, 8);
  EXPECT_EQ(random_sector(settings, 7), seventh);
  EXPECT_NE(random_sector(settings, 9), seventh);
  settings.sectors = 5;
  settings.views = 4;
  EXPECT_EQ(random_sector(settings, 7), seventh);
  settings.seed = 2;
  EXPECT_NE(random_sector(settings, 7), seventh);
}

TEST(RandomSector, StrandCountIsLogUniform) {
  const BakeSettings settings;
  constexpr int kSectors = 4000;
  int below_5 = 0, most = 0;
  for (std::uint64_t i = 0; i < kSectors; ++i) {
    const int n = strands_inside(random_sector(settings, i));
    ASSERT_GE(n, 1);
    most = std::max(most, n);
    below_5 += n < 5 ? 1 : 0;
  }
  EXPECT_EQ(most, 24);
  // floor(25^u) < 5 for u < 1/2; 4 standard errors of a share of 4000.
  EXPECT_NEAR(below_5 / double{kSectors}, 0.5, 4 * 0.5 / std::sqrt(kSectors));
}

TEST(RandomSector, IsATorusInSAndReachesInFromAboveAndBelow) {
  const BakeSettings settings;
  int beyond = 0, inside = 0, below = 0;
  for (std::uint64_t i = 0; i < 1000; ++i) {
    const auto sector = random_sector(settings, i);
    inside += strands_inside(sector);
    for (const glm::vec2& p : sector) {
      ASSERT_TRUE(p.x >= -kSectorMargin && p.x <= 1 + kSectorMargin && p.y >= -kSectorMargin &&
                  p.y <= 1 + kSectorMargin);
      const bool base = p.x >= 0 && p.x < 1;
      if (base && (p.y < 0 || p.y > 1)) ++beyond;
      if (base && p.y < 0) ++below;
      // The margin itself may round either way.
      const float copy = p.x + 1;
      if (!base || copy > 1 + kSectorMargin - 1e-4F) continue;
      EXPECT_TRUE(std::any_of(sector.begin(), sector.end(),
                              [&](glm::vec2 q) { return std::abs(q.x - copy) < 1e-6F && q.y == p.y; }))
          << i << ' ' << p.x;
    }
  }
  const double expected = 0.7 * inside;  // 2 margins per strand inside; 4 standard errors of a binomial
  EXPECT_NEAR(beyond, expected, 4 * std::sqrt(0.3 * expected));
  EXPECT_NEAR(below, 0.5 * beyond, 4 * std::sqrt(0.25 * beyond));
}

TEST(RandomSector, ArrangementsDiffer) {
  // Spread of r inside: a band is narrower than a uniform sector (.289); both occur.
  BakeSettings settings;
  settings.max_strands = 200;
  int narrow = 0, wide = 0;
  for (std::uint64_t i = 0; i < 300; ++i) {
    double n = 0, sum = 0, square = 0;
    for (const glm::vec2& p : random_sector(settings, i))
      if (p.x >= 0 && p.x < 1 && p.y >= 0 && p.y <= 1) n += 1, sum += double{p.y}, square += double{p.y} * double{p.y};
    if (n < 40) continue;
    const double spread = std::sqrt(square / n - sum * sum / (n * n));
    narrow += spread < 0.15 ? 1 : 0;
    wide += spread > 0.26 ? 1 : 0;
  }
  EXPECT_GT(narrow, 10);
  EXPECT_GT(wide, 10);
}

std::vector<float> groups(int count, int members, int dimension, unsigned seed) {
  std::mt19937 random(seed);
  std::normal_distribution<float> normal;
  std::vector<float> rows;
  std::vector<std::vector<float>> centres(static_cast<std::size_t>(count));
  for (auto& c : centres)
    for (int d = 0; d < dimension; ++d) c.push_back(10 * normal(random));
  for (int i = 0; i < count * members; ++i)
    for (int d = 0; d < dimension; ++d)
      rows.push_back(centres[static_cast<std::size_t>(i % count)][static_cast<std::size_t>(d)] + 0.1F * normal(random));
  return rows;
}

double mean_distance_sq(const std::vector<float>& rows, std::size_t dimension,
                        const std::vector<std::uint32_t>& chosen) {
  double total = 0;
  for (std::size_t i = 0; i < rows.size(); i += dimension) {
    double best = 1e30;
    for (const std::uint32_t c : chosen) {
      double sum = 0;
      for (std::size_t d = 0; d < dimension; ++d) {
        const double x = double{rows[i + d]} - double{rows[c * dimension + d]};
        sum += x * x;
      }
      best = std::min(best, sum);
    }
    total += best;
  }
  return total / static_cast<double>(rows.size() / dimension);
}

TEST(Representatives, FindOneMemberOfEachGroup) {
  const auto rows = groups(40, 50, 5, 1);
  const auto chosen = representatives(rows, 5, 40, 1);
  std::set<std::uint32_t> found;
  for (const std::uint32_t i : chosen) found.insert(i % 40);
  // k-means++ may start twice in one group; Lloyd steps do not mend that. At most one in ten here.
  EXPECT_GE(found.size(), 36U);
}

TEST(Representatives, AreNearerThanRandomOnes) {
  const auto rows = groups(300, 10, 11, 2);
  const auto chosen = representatives(rows, 11, 100, 1);
  std::vector<std::uint32_t> every;
  for (std::uint32_t i = 0; i < 100; ++i) every.push_back(i * 30 + i % 7);
  EXPECT_LT(mean_distance_sq(rows, 11, chosen), 0.8 * mean_distance_sq(rows, 11, every));
}

TEST(Representatives, AreDistinctAscendingAndAtMostTheCount) {
  const auto rows = groups(20, 100, 3, 3);
  const auto chosen = representatives(rows, 3, 300, 1);
  EXPECT_LE(chosen.size(), 300U);
  EXPECT_GE(chosen.size(), 290U);
  EXPECT_TRUE(std::is_sorted(chosen.begin(), chosen.end()));
  EXPECT_EQ(std::set<std::uint32_t>(chosen.begin(), chosen.end()).size(), chosen.size());
}

TEST(Representatives, FewerDistinctRowsThanAskedFor) {
  std::vector<float> rows;
  for (int i = 0; i < 60; ++i) rows.push_back(static_cast<float>(i % 3)), rows.push_back(1);
  EXPECT_EQ(representatives(rows, 2, 10, 1).size(), 3U);
  EXPECT_EQ(representatives(std::vector<float>{1, 2}, 2, 10, 1), std::vector<std::uint32_t>{0});
  EXPECT_TRUE(representatives(std::vector<float>{}, 2, 10, 1).empty());
}

TEST(Representatives, AreTheSameForAnyNumberOfThreads) {
  const auto rows = groups(500, 100, 11, 4);  // 50,000 rows: thinned
  const auto chosen = representatives(rows, 11, 60, 1);
  EXPECT_NE(representatives(rows, 11, 60, 2), chosen);
  for (const std::size_t threads : {1U, 2U, 3U, 8U}) {
    const tbb::global_control limit(tbb::global_control::max_allowed_parallelism, threads);
    EXPECT_EQ(representatives(rows, 11, 60, 1), chosen) << threads;
  }
}

}  // namespace
}  // namespace pelage
