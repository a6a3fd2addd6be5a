// Fitting clusters to strands whose clusters are known, and to strands that no cluster fits.
#include "pelage/hair/cluster_fit.h"

#include <gtest/gtest.h>
#include <oneapi/tbb/global_control.h>

#include <cmath>
#include <cstring>
#include <fstream>
#include <limits>
#include <numbers>
#include <random>
#include <set>

#include "pelage/data_schema/errors.h"
#include "pelage/hair/cluster_kmeans.h"
#include "pelage/hair/hair_file.h"
#include "test_clusters.h"

namespace pelage::hair {
namespace {

FitSettings clusters(int n) {
  FitSettings s;
  s.clusters = n;
  return s;
}

/// Invariants of every fit.
void expect_valid(const ClusterFit& fit) {
  ASSERT_FALSE(fit.clusters.empty());
  EXPECT_EQ(fit.report.clusters.size(), fit.clusters.size());
  for (const Cluster& c : fit.clusters) {
    EXPECT_NO_THROW(sweep(c, 16));
    EXPECT_GT(c.strand_count(), 0U);
    for (std::size_t i = 0; i < c.strand_count(); ++i) {
      ASSERT_GE(c.strand(i).size(), 2U);
      EXPECT_GE(c.strand(i).front().t, 0.0F);
      EXPECT_LE(c.strand(i).back().t, 1.0F);
      for (std::size_t k = 0; k < c.strand(i).size(); ++k) {
        const DiskPoint& p = c.strand(i)[k];
        ASSERT_TRUE(std::isfinite(p.x) && std::isfinite(p.y));
        ASSERT_TRUE(k == 0 || c.strand(i)[k - 1].t < p.t) << i << ' ' << k;
      }
    }
  }
}

/// A tuft of `count` parallel strands of `length` m from `root` along +y.
void add_tuft(Strands& strands, glm::vec3 root, int count, float length, int vertices = 8) {
  std::mt19937 random(static_cast<unsigned>(count));
  std::uniform_real_distribution<float> uniform(-.004F, .004F);
  for (int i = 0; i < count; ++i) {
    const glm::vec3 from = root + glm::vec3(uniform(random), 0, uniform(random));
    std::vector<glm::vec3> points;
    for (int k = 0; k < vertices; ++k) {
      points.push_back(from + glm::vec3(0, length * static_cast<float>(k) / static_cast<float>(vertices - 1), 0));
    }
    strands.append(points);
  }
}

/// Strands made from a cluster of at most 10 mm radius: one fitted cluster holds them. Vertices come back to the
/// residual of the projection; between them the centre line's own curve differs from the chord by step^2 curvature / 8
/// <= (0.3 m / 39)^2 * 30 / 8 = 0.2 mm at most, so the RMS is < 1 % of the radius.
TEST(ClusterFit, RecoversAKnownCluster) {
  const Cluster known = test::bent_cluster();
  const ClusterFit fit = fit_clusters(test::strands_in(known, 300, 40), clusters(1));
  expect_valid(fit);
  ASSERT_EQ(fit.clusters.size(), 1U);
  EXPECT_EQ(fit.report.strands, 300U);
  EXPECT_EQ(fit.report.cut_points, 0U);
  EXPECT_GT(fit.report.inside, 0.94);
  EXPECT_LT(fit.report.rms_m, 0.01 * 0.0065);
  const SweptCluster a = sweep(known, 20), b = sweep(fit.clusters[0], 20);
  EXPECT_NEAR(b.length_m / a.length_m, 1, 0.05);
  for (std::size_t i = 5; i <= 15; ++i) {  // same place, same size: where all strands are
    const EllipseAxes known_axes = ellipse_axes(a.cross_sections[i]), axes = ellipse_axes(b.cross_sections[i]);
    EXPECT_LT(glm::distance(a.frames[i].position, b.frames[i].position), 0.03F * a.length_m) << i;
    EXPECT_GT(glm::dot(a.frames[i].tangent, b.frames[i].tangent), 0.98F) << i;
    // a uniform disk's 95 % lie within sqrt(.95) = .975 of its radius
    EXPECT_NEAR(axes.a_m / known_axes.a_m, 0.975, 0.1) << i;
    EXPECT_NEAR(axes.b_m / known_axes.b_m, 0.975, 0.1) << i;
  }
}

/// What a reader of the hairstyle sees: every vertex of the strands, rebuilt from the cluster alone, lies where it was.
/// The cluster's strands keep their order; 0.05 mm: what three Newton steps of the projection leave at this radius.
TEST(ClusterFit, ClusterAloneRebuildsItsStrands) {
  const Strands strands = test::strands_in(test::bent_cluster(), 50, 20);
  const Cluster c = fit_clusters(strands, clusters(1)).clusters.at(0);
  ASSERT_EQ(c.strand_points.size(), strands.vertices.size());
  const CentreLine line(c.centre_line, c.first_normal);
  for (std::size_t i = 0; i < c.strand_points.size(); ++i) {
    const DiskPoint& p = c.strand_points[i];
    const Frame f = line.frame(static_cast<double>(p.t));
    const glm::vec2 q = evaluate_b_spline(std::span<const CrossSection>(c.cross_sections), p.t).apply({p.x, p.y});
    EXPECT_LT(glm::distance(f.position + q.x * f.normal + q.y * f.binormal, strands.vertices[i]), 5e-5F) << i;
  }
}

TEST(ClusterFit, FullCoverageHoldsNearlyAll) {
  FitSettings s = clusters(1);
  s.coverage = 1;
  EXPECT_GT(fit_clusters(test::strands_in(test::bent_cluster(), 300, 40), s).report.inside, 0.98);
}

/// Roots spread along the tangent as much as across, and lengths differ threefold: each strand keeps its t-range.
TEST(ClusterFit, StrandsKeepTheirOwnRange) {
  Strands strands;
  std::mt19937 random(2);
  std::uniform_real_distribution<float> uniform(0, 1);
  for (int i = 0; i < 100; ++i) {
    const float x = .01F * uniform(random), z = .01F * uniform(random), y = .03F * uniform(random);
    const float length = .05F + .1F * uniform(random);
    std::vector<glm::vec3> points;
    for (int k = 0; k < 10; ++k) points.emplace_back(x, -y - length * static_cast<float>(k) / 9, z);
    strands.append(points);
  }
  const ClusterFit fit = fit_clusters(strands, clusters(1));
  expect_valid(fit);
  EXPECT_EQ(fit.report.cut_points, 0U);
  EXPECT_LT(fit.report.rms_m, 2e-5);
  std::set<float> firsts;
  for (std::size_t i = 0; i < 100; ++i) firsts.insert(fit.clusters[0].strand(i).front().t);
  EXPECT_GT(firsts.size(), 90U);
  EXPECT_GT(*firsts.rbegin() - *firsts.begin(), 0.1F);
}

TEST(ClusterFit, FindsSeparateTufts) {
  Strands strands;
  for (int i = 0; i < 5; ++i) add_tuft(strands, {.1F * static_cast<float>(i), 0, 0}, 20 + i, .1F);
  const ClusterFit fit = fit_clusters(strands, clusters(5));
  expect_valid(fit);
  std::multiset<std::size_t> counts;
  for (const ClusterReport& r : fit.report.clusters) counts.insert(r.strands);
  EXPECT_EQ(counts, (std::multiset<std::size_t>{20, 21, 22, 23, 24}));
}

/// A patch of fur wider than its strands are long: the centre line runs along the strands, not across the patch.
TEST(ClusterFit, WidePatchOfShortStrandsRunsAlongThem) {
  Strands strands;
  std::mt19937 random(4);
  std::normal_distribution<float> normal(0.0F, .05F);
  for (int i = 0; i < 400; ++i) {
    const glm::vec3 root(normal(random), 0, normal(random));
    const glm::vec3 lean(.3F * normal(random), .04F, .3F * normal(random));
    std::vector<glm::vec3> points;
    for (int k = 0; k < 6; ++k) points.push_back(root + lean * (static_cast<float>(k) / 5));
    strands.append(points);
  }
  const ClusterFit fit = fit_clusters(strands, clusters(1));
  expect_valid(fit);
  EXPECT_EQ(fit.report.strands, 400U);
  EXPECT_LT(static_cast<double>(fit.report.cut_points), 0.01 * static_cast<double>(fit.report.points));
  EXPECT_GT(sweep(fit.clusters[0], 4).frames[2].tangent.y, 0.95F);
}

/// The part of a strand that turns back is cut and counted, the rest is kept.
TEST(ClusterFit, CutsWhatTurnsBack) {
  Strands strands;
  add_tuft(strands, {0, 0, 0}, 60, .1F, 11);
  strands.append(
      std::vector<glm::vec3>{{0, 0, 0}, {0, .02F, 0}, {0, .04F, 0}, {0, .06F, 0}, {.002F, .05F, 0}, {.002F, .03F, 0}});
  const ClusterFit fit = fit_clusters(strands, clusters(1));
  expect_valid(fit);
  EXPECT_EQ(fit.report.strands, 61U);
  EXPECT_EQ(fit.report.cut_points, 2U);
}

bool same_bytes(const ClusterFit& a, const ClusterFit& b) {
  const auto equal = [](const auto& x, const auto& y) {
    return x.size() == y.size() && std::memcmp(x.data(), y.data(), x.size() * sizeof(x[0])) == 0;
  };
  if (a.clusters.size() != b.clusters.size()) return false;
  for (std::size_t i = 0; i < a.clusters.size(); ++i) {
    const Cluster &p = a.clusters[i], &q = b.clusters[i];
    if (!equal(p.centre_line, q.centre_line) || !equal(p.cross_sections, q.cross_sections) ||
        !equal(p.strand_offsets, q.strand_offsets) || !equal(p.strand_points, q.strand_points) ||
        p.first_normal != q.first_normal) {
      return false;
    }
  }
  return a.report.inside == b.report.inside && a.report.rms_m == b.report.rms_m;
}

Strands shaggy_groom() {
  Strands strands;
  std::mt19937 random(9);
  std::normal_distribution<float> normal;
  for (int i = 0; i < 1500; ++i) {
    glm::vec3 p = .1F * glm::normalize(glm::vec3(normal(random), normal(random), normal(random)));
    glm::vec3 d = .01F * glm::normalize(p);
    std::vector<glm::vec3> points{p};
    for (int k = 0; k < 11; ++k) {
      d += .002F * glm::vec3(normal(random), normal(random) - 1.0F, normal(random));
      points.push_back(p += d);
    }
    strands.append(points);
  }
  return strands;
}

TEST(ClusterFit, SameBytesForAnyNumberOfThreads) {
  const Strands strands = shaggy_groom();
  std::vector<ClusterFit> fits;
  for (const std::size_t threads : {1U, 2U, 3U, 8U}) {
    const tbb::global_control limit(tbb::global_control::max_allowed_parallelism, threads);
    fits.push_back(fit_clusters(strands, clusters(40)));
    EXPECT_TRUE(same_bytes(fits.front(), fits.back())) << threads << " threads";
  }
  expect_valid(fits.front());
  FitSettings other = clusters(40);
  other.seed = 2;
  EXPECT_FALSE(same_bytes(fits.front(), fit_clusters(strands, other)));
}

TEST(ClusterFit, OneStrand) {
  Strands strands;
  strands.diameter_m = 1e-4F;
  strands.append(std::vector<glm::vec3>{{0, 0, 0}, {0, .05F, 0}, {.03F, .08F, 0}, {.08F, .08F, 0}});
  const ClusterFit fit = fit_clusters(strands, clusters(150));
  expect_valid(fit);
  ASSERT_EQ(fit.clusters.size(), 1U);
  EXPECT_EQ(fit.report.cut_points, 0U);
  EXPECT_GE(ellipse_axes(sweep(fit.clusters[0], 8).cross_sections[4]).b_m, 0.999e-4F);
}

TEST(ClusterFit, TwoVertexStrands) {
  Strands strands;
  add_tuft(strands, {0, 0, 0}, 50, .1F, 2);
  const ClusterFit fit = fit_clusters(strands, clusters(3));
  expect_valid(fit);
  EXPECT_EQ(fit.report.strands, 50U);
  EXPECT_EQ(fit.report.cut_points, 0U);
}

TEST(ClusterFit, IdenticalStrandsMakeOneCluster) {
  Strands strands;
  for (int i = 0; i < 30; ++i) strands.append(std::vector<glm::vec3>{{0, 0, 0}, {0, .1F, 0}, {.05F, .15F, 0}});
  const ClusterFit fit = fit_clusters(strands, clusters(10));
  expect_valid(fit);
  EXPECT_EQ(fit.clusters.size(), 1U);
  EXPECT_EQ(fit.report.strands, 30U);
}

TEST(ClusterFit, MoreClustersThanStrands) {
  Strands strands;
  for (int i = 0; i < 7; ++i) add_tuft(strands, {.05F * static_cast<float>(i), 0, 0}, 1, .1F);
  const ClusterFit fit = fit_clusters(strands, clusters(100));
  expect_valid(fit);
  EXPECT_EQ(fit.clusters.size(), 7U);
}

/// Opposite strands have a mean of no length; half of them runs against any centre line and is dropped, and that is
/// said.
TEST(ClusterFit, OppositeStrandsInOneCluster) {
  Strands strands;
  for (int i = 0; i < 10; ++i) {
    const float x = .001F * static_cast<float>(i), end = i % 2 == 0 ? .05F : -.05F;
    strands.append(std::vector<glm::vec3>{{x, -end, 0}, {x, 0, 0}, {x, end, 0}});
  }
  const ClusterFit fit = fit_clusters(strands, clusters(1));
  expect_valid(fit);
  EXPECT_EQ(fit.report.strands + fit.report.dropped, 10U);
  EXPECT_GE(fit.report.strands, 5U);
}

TEST(ClusterFit, DropsStrandsWithoutLength) {
  Strands strands;
  add_tuft(strands, {0, 0, 0}, 10, .1F);
  strands.append(std::vector<glm::vec3>{{0, 0, 0}});
  strands.append(std::vector<glm::vec3>{{0, 0, 0}, {0, 0, 0}});
  const ClusterFit fit = fit_clusters(strands, clusters(2));
  EXPECT_EQ(fit.report.strands, 10U);
  EXPECT_EQ(fit.report.dropped, 2U);
}

TEST(ClusterFit, ColoursAreAveraged) {
  Strands strands;
  add_tuft(strands, {0, 0, 0}, 2, .1F);
  strands.colours = {{1, 0, 0}, {0, .5F, 0}};
  EXPECT_LT(glm::distance(fit_clusters(strands, clusters(1)).clusters[0].colour, glm::vec3(.5F, .25F, 0)), 1e-6F);
}

TEST(ClusterFit, RefusesWhatIsNotHair) {
  Strands strands;
  EXPECT_THROW(fit_clusters(strands, {}), InputError);
  strands.append(std::vector<glm::vec3>{{1, 1, 1}, {1, 1, 1}});
  EXPECT_THROW(fit_clusters(strands, {}), InputError);
  add_tuft(strands, {0, 0, 0}, 3, .1F);
  strands.vertices[4].y = std::numeric_limits<float>::quiet_NaN();
  try {
    fit_clusters(strands, {});
    FAIL() << "NaN was accepted";
  } catch (const InputError& e) {
    EXPECT_STREQ(e.what(), "strand 1, vertex 2: not a finite position");
  }
  strands.vertices[4].y = std::numeric_limits<float>::infinity();
  EXPECT_THROW(fit_clusters(strands, {}), InputError);
}

TEST(ClusterFit, RefusesImpossibleSettings) {
  Strands strands;
  add_tuft(strands, {0, 0, 0}, 3, .1F);
  EXPECT_THROW(fit_clusters(strands, clusters(0)), UsageError);
  EXPECT_THROW(fit_clusters(strands, clusters(10001)), UsageError);
  FitSettings s;
  s.coverage = std::numeric_limits<double>::quiet_NaN();
  EXPECT_THROW(fit_clusters(strands, s), UsageError);
  s = {};
  s.diameter_m = -1;
  EXPECT_THROW(fit_clusters(strands, s), UsageError);
}

TEST(ClusterFit, SintelBob) {
  const std::filesystem::path file = PELAGE_SOURCE_DIR "/../shared/data/sintel/sintel_hair_16points.tfx";
  if (!std::filesystem::exists(file)) GTEST_SKIP() << "the real grooms are not here";
  const ClusterFit fit = fit_clusters(read_hair(file), clusters(150));
  expect_valid(fit);
  EXPECT_EQ(fit.report.strands, 11400U);
  EXPECT_GT(fit.report.inside, 0.94);     // measured .952
  EXPECT_LT(fit.report.rms_m, 2e-4);      // measured 0.08 mm
  EXPECT_LT(fit.report.cut_points, 30U);  // measured 3 of 182,400; 53 if centre lines did not extend
}

/// The clustering itself: never worse than any assignment to its own centres.
TEST(KMeans, RowsBelongToTheNearestCentre) {
  Features features{2, {}};
  std::mt19937 random(6);
  std::uniform_real_distribution<float> uniform(0, 1);
  for (int i = 0; i < 1000; ++i) features.values.push_back(uniform(random));
  const KMeans means = k_means(features, 12, 3, 100);
  ASSERT_EQ(means.centres.rows(), 12U);
  for (std::size_t i = 0; i < features.rows(); ++i) {
    EXPECT_EQ(means.labels[i], nearest_centres(means.centres, features.row(i), 1).front());
  }
}

}  // namespace
}  // namespace pelage::hair
