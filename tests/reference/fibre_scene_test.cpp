// Crossings of rays with fibres: against the brute-force oracle, and by hand where the answer is known.
#include "pelage/reference/fibre_scene.h"

#include <gtest/gtest.h>

#include <functional>
#include <glm/vec2.hpp>

#include "pelage/data_schema/errors.h"
#include "pelage/reference/fibre_brute_force.h"
#include "sample_hair.h"

namespace pelage {
namespace {

constexpr float kD = 80e-6F;
constexpr float kOpacity = 0.6F;

FibreRay ray_through(const glm::dvec3& at, const glm::dvec3& direction, double before) {
  return {at - before * direction, direction, std::numeric_limits<double>::infinity()};
}

struct Comparison {
  int rays = 0, crossings = 0, different = 0;
};

/// Rays aimed at the strands themselves, off their axes by up to two diameters, a third of them at joints.
Comparison compare(const Strands& strands, int rays, unsigned seed,
                   const std::function<glm::dvec3(sample::Random&, const glm::dvec3& tangent)>& direction) {
  const FibreScene scene(strands, kOpacity);
  sample::Random random(seed);
  std::vector<FibreCrossing> found;
  Comparison c;
  for (int i = 0; i < rays; ++i) {
    const auto strand = static_cast<std::size_t>(random.in(0, static_cast<double>(strands.count())));
    const auto points = strands.strand(strand);
    const auto k = static_cast<std::size_t>(random.in(0, static_cast<double>(points.size() - 1)));
    const glm::dvec3 a(points[k]), b(points[k + 1]);
    const glm::dvec3 on_axis = a + (i % 3 == 0 ? 0.0 : random.in(0, 1)) * (b - a);
    const glm::dvec3 aim = on_axis + random.in_cube(2 * double(strands.diameter_m));
    const FibreRay ray = ray_through(aim, direction(random, glm::normalize(b - a)), random.in(-0.1, 0.4));
    const std::uint32_t owner =
        i % 4 == 0 ? strands.offsets[strand] + static_cast<std::uint32_t>(random.in(0, double(points.size())))
                   : kNoOwner;
    const auto expected = static_cast<int>(brute_force_crossings(strands, ray, owner).size());
    const int count = scene.count(ray, owner);
    c.different += count != expected ? 1 : 0;
    c.crossings += expected;
    ++c.rays;
    if (owner != kNoOwner) continue;
    scene.collect(ray, found);
    EXPECT_EQ(static_cast<int>(found.size()), count) << "count() and collect() share one definition, ray " << i;
  }
  return c;
}

glm::dvec3 anywhere(sample::Random& random, const glm::dvec3&) {
  return random.direction();
}
/// Along the segment to within a few hundredths, down to nothing.
glm::dvec3 grazing(sample::Random& random, const glm::dvec3& tangent) {
  return glm::normalize(tangent + std::pow(10.0, random.in(-9, -1)) * random.direction());
}

/// Embree finds candidates and double decides, as the oracle does: they differ only where a ray passes an edge by less
/// than double's rounding or that of a radius stored as float (6e-8 of a radius, so of 5e-8 of the crossings), and
/// where Embree misses a candidate: never seen.
void expect_equal(const Comparison& c, int least_crossings) {
  EXPECT_EQ(c.different, 0) << "of " << c.rays << " rays, " << c.crossings << " crossings";
  EXPECT_GT(c.crossings, least_crossings);
}

TEST(FibreSceneAgainstBruteForce, LooseSegments) {
  expect_equal(compare(sample::loose_segments(400, 0.05, 0.02, kD, 1), 6000, 11, anywhere), 1000);
}
TEST(FibreSceneAgainstBruteForce, SegmentsShorterThanTheirWidth) {
  expect_equal(compare(sample::walks(40, 30, 0.02, 30e-6, 0.5, kD, 2), 6000, 12, anywhere), 1000);
}
TEST(FibreSceneAgainstBruteForce, Bends) {
  expect_equal(compare(sample::walks(60, 10, 0.05, 0.004, 0.6, kD, 3), 6000, 13, anywhere), 1000);
}
TEST(FibreSceneAgainstBruteForce, SharpFolds) {
  expect_equal(compare(sample::walks(60, 10, 0.03, 0.003, 10, kD, 4), 6000, 14, anywhere), 1000);
}
TEST(FibreSceneAgainstBruteForce, Curls) {
  expect_equal(compare(sample::curls(60, 0.03, 0.004, 0.006, 8, 5, kD, 5), 6000, 15, anywhere), 1000);
}
TEST(FibreSceneAgainstBruteForce, NearlyAlongTheFibre) {
  expect_equal(compare(sample::walks(60, 10, 0.05, 0.004, 0.02, kD, 6), 6000, 16, grazing), 1000);
}
TEST(FibreSceneAgainstBruteForce, WidthsThatVary) {
  Strands s = sample::walks(60, 10, 0.05, 0.004, 0.6, kD, 7);
  sample::Random random(8);
  for (std::size_t i = 0; i < s.vertices.size(); ++i) s.diameters_m.push_back(float(random.in(0, 3e-4)));
  expect_equal(compare(s, 6000, 17, anywhere), 1000);
}
TEST(FibreSceneAgainstBruteForce, RepeatedVerticesAndLoneOnes) {
  Strands s;
  sample::Random random(9);
  for (int i = 0; i < 60; ++i) {
    std::vector<glm::vec3> points;
    glm::dvec3 at = random.in_cube(0.05);
    for (int k = 0; k < 12; ++k) {
      points.emplace_back(at);
      if (random.in(0, 1) < 0.5) at += 0.004 * random.direction();
    }
    s.append(points);
    s.append(std::vector<glm::vec3>{glm::vec3(at)});
  }
  s.append(std::vector<glm::vec3>{});
  s.diameter_m = kD;
  // compare() aims at segments: give it those of the whole strands only.
  const FibreScene scene(s, kOpacity);
  int crossings = 0;
  for (int i = 0; i < 6000; ++i) {
    const std::size_t strand = 2 * static_cast<std::size_t>(random.in(0, 60));
    const glm::dvec3 aim = glm::dvec3(s.strand(strand)[std::size_t(random.in(0, 12))]) + random.in_cube(1e-4);
    const FibreRay ray = ray_through(aim, random.direction(), 0.2);
    const std::uint32_t owner =
        i % 2 == 0 ? s.offsets[strand] + static_cast<std::uint32_t>(random.in(0, 12)) : kNoOwner;
    const auto expected = brute_force_crossings(s, ray, owner);
    ASSERT_EQ(scene.count(ray, owner), int(expected.size())) << i;
    crossings += int(expected.size());
  }
  EXPECT_GT(crossings, 1000);
}
TEST(FibreSceneAgainstBruteForce, FarFromTheOriginOfTheWorld) {
  Strands s = sample::walks(60, 10, 0.05, 0.004, 0.6, 4e-4F, 7);
  for (glm::vec3& p : s.vertices) p += glm::vec3(10, -20, 5);
  expect_equal(compare(s, 3000, 18, anywhere), 500);
}

TEST(FibreScene, OneCrossingAtEachPlaceOfAFibre) {
  // A quarter circle of 1 cm in 4 segments, seen along its axis: every ray within half a diameter of it crosses once.
  std::vector<glm::vec3> points;
  for (int k = 0; k <= 4; ++k) {
    const float angle = 0.3926991F * float(k);
    points.emplace_back(0.01F * std::cos(angle), 0.01F * std::sin(angle), 0.002F * float(k % 2));
  }
  const Strands s = sample::one_strand(points, 2e-4F);
  const FibreScene scene(s, kOpacity);
  for (std::size_t k = 0; k + 1 < points.size(); ++k) {
    const glm::dvec3 a(points[k]), b(points[k + 1]);
    const glm::dvec2 along = glm::normalize(glm::dvec2(b - a)), side(along.y, -along.x);
    for (double u = k == 0 ? 0.001 : 0.0; u <= (k == 3 ? 0.999 : 1.0); u += 0.001) {
      for (const double off : {-0.99e-4, -0.5e-4, 0.0, 0.5e-4, 0.99e-4}) {
        const glm::dvec3 at = a + u * (b - a) + glm::dvec3(off * side, 0);
        EXPECT_EQ(scene.count({{at.x, at.y, -1}, {0, 0, 1}}), 1) << k << " " << u << " " << off;
      }
    }
  }
}

TEST(FibreScene, LegsOfAFoldCountTwiceWhereTheyAreApart) {
  // Down along y, then back up 5 mm behind, seen along z: once at the fold's joints, twice higher up.
  const Strands s = sample::one_strand({{0, 0.02F, 0}, {0, 0, 0}, {0, 0.02F, 0.005F}}, 2e-4F);
  const FibreScene scene(s, kOpacity);
  EXPECT_EQ(scene.count({{0, 0.015, -1}, {0, 0, 1}}), 2);
  EXPECT_EQ(scene.count({{0, 0.0005, -1}, {0, 0, 1}}), 1) << "0.1 mm apart: they overlap";
  EXPECT_EQ(scene.count({{0, -0.00005, -1}, {0, 0, 1}}), 1) << "the round joint";
}

TEST(FibreScene, BlockedAreaIsOpacityTimesDiameterLengthSine) {
  // Rays on a grid across z; one fibre of three segments with bends, and its length as seen from z.
  const std::vector<glm::vec3> points{
      {-0.004F, 0, 0}, {-0.001F, 0.001F, 0.002F}, {0.001F, -0.001F, 0.001F}, {0.004F, 0, -0.005F}};
  const float diameter = 2e-4F;
  const FibreScene scene(sample::one_strand(points, diameter), kOpacity);
  double seen_length = 0;
  for (std::size_t k = 0; k + 1 < points.size(); ++k)
    seen_length += glm::distance(glm::dvec2(points[k]), glm::dvec2(points[k + 1]));
  // One ray at random in each cell of a grid: a regular one is biased by slopes that are fractions.
  constexpr double kStep = 5e-6;
  sample::Random random(1);
  double blocked = 0;
  for (double x = -0.0045; x < 0.0045; x += kStep) {
    for (double y = -0.0015; y < 0.0015; y += kStep) {
      const FibreRay ray{{x + random.in(0, kStep), y + random.in(0, kStep), -1}, {0, 0, 1}};
      blocked += (1 - scene.transmittance(scene.count(ray))) * kStep * kStep;
    }
  }
  const double expected = double(kOpacity) * double(diameter) * seen_length;
  // Bends overlap by r^2 (tan(b/2) - b/2) more than their round joints fill: b = 1.107 rad twice, 7e-4 of the area.
  // The grid: 3800 cells on the edges, each off by at most half a cell, standard deviation .4 of a cell: 25 of 73,000
  // cells, 3.4e-4; 4 of these.
  EXPECT_NEAR(blocked / expected, 1 - 7e-4, 4 * 3.4e-4);
}

TEST(FibreScene, OwnersSegmentAndItsNeighboursCastNoShadow) {
  // Five segments in a row along the ray's plane: zigzag along z, each crossed by the ray x = y = 0 once.
  std::vector<glm::vec3> points;
  for (int k = 0; k <= 5; ++k) points.emplace_back(k % 2 == 0 ? -0.01F : 0.01F, 0.0F, 0.01F * float(k));
  const Strands s = sample::one_strand(points, kD);
  const FibreScene scene(s, kOpacity);
  const FibreRay ray{{0, 0, -1}, {0, 0, 1}};
  EXPECT_EQ(scene.count(ray), 5);
  const int expected[6] = {3, 2, 2, 2, 3, 3};  // at the ends of the strand one neighbour only
  for (std::uint32_t owner = 0; owner < 6; ++owner) EXPECT_EQ(scene.count(ray, owner), expected[owner]) << owner;
  EXPECT_EQ(scene.count(ray, 6), 5) << "no such vertex";
}

TEST(FibreScene, CrossingsLieBetweenTheRaysEnds) {
  const FibreScene scene(sample::one_strand({{-0.01F, 0, 0.5F}, {0.01F, 0, 0.5F}}, kD), kOpacity);
  const auto count = [&](double z, double length) { return scene.count({{0, 0, z}, {0, 0, 1}, length}); };
  EXPECT_EQ(count(0.5 + 1e-9, 1), 0);
  EXPECT_EQ(count(0.5 - 1e-9, 1), 1) << "Embree alone drops hits nearer than a diameter";
  EXPECT_EQ(count(0, 0.5 - 1e-9), 0);
  EXPECT_EQ(count(0, 0.5 + 1e-9), 1);
  EXPECT_EQ(count(-1e4, 1e5), 1) << "far origins are as good";
}

TEST(FibreScene, CollectsNearestFirstWithPlaceAndOffset) {
  Strands s = sample::one_strand({{-0.01F, 0, 0.02F}, {0.03F, 0, 0.02F}}, 2e-4F);
  s.append(std::vector<glm::vec3>{{0, -0.01F, 0.01F}, {0, 0.01F, 0.01F}});
  const FibreScene scene(s, kOpacity);
  std::vector<FibreCrossing> found;
  scene.collect({{0.00005, 0.000025, -0.5}, {0, 0, 1}}, found);
  ASSERT_EQ(found.size(), 2U);
  EXPECT_EQ(found[0].vertex, 2U);
  EXPECT_NEAR(found[0].depth_m, 0.51, 1e-8);
  EXPECT_NEAR(found[0].offset.x, 0.5, 1e-5);
  EXPECT_NEAR(found[0].tangent.y, 1, 1e-6);
  EXPECT_EQ(found[1].vertex, 0U);
  EXPECT_NEAR(found[1].along, 0.25125, 1e-5);
  EXPECT_NEAR(found[1].offset.y, 0.25, 1e-5);
}

TEST(FibreScene, TangentsTurnSmoothlyAlongAStrand) {
  const Strands s = sample::one_strand({{0, 0, 0}, {0.01F, 0, 0}, {0.01F, 0, 0}, {0.01F, 0.01F, 0}}, 2e-4F);
  const FibreScene scene(s, kOpacity);
  const auto tangent = [&](double x, double y) {
    std::vector<FibreCrossing> found;
    scene.collect({{x, y, -1}, {0, 0, 1}}, found);
    return found.at(0).tangent;
  };
  const auto near = [](const glm::vec3& a, const glm::vec3& b) { return glm::length(a - glm::normalize(b)) < 1e-4F; };
  EXPECT_TRUE(near(tangent(1e-7, 0), {1, 0, 0}));
  EXPECT_TRUE(near(tangent(0.005, 0), glm::vec3(1, 0, 0) + glm::normalize(glm::vec3(1, 1, 0))));
  EXPECT_TRUE(near(tangent(0.01, 0), {1, 1, 0}));
  EXPECT_TRUE(near(tangent(0.01, 0.01 - 1e-7), {0, 1, 0}));
}

TEST(FibreScene, CountMayStopWhenItIsEnough) {
  const Strands s = sample::parallel_fibres(2000, {0.01, 0.01, 0.01}, {1, 0, 0}, 0.1, 4, 2e-4F, 1);
  const FibreScene scene(s, kOpacity);
  sample::Random random(2);
  for (int i = 0; i < 300; ++i) {
    const FibreRay ray{{random.in(-0.01, 0.01), random.in(-0.01, 0.01), -1}, {0, 0, 1}};
    for (const int enough : {1, 3, 7})
      EXPECT_EQ(scene.count(ray, kNoOwner, enough), std::min(scene.count(ray), enough));
  }
  EXPECT_EQ(scene.enough(0.0F), 814) << "0.4^813 is the last power above 2^-1075, which rounds to 0";
  EXPECT_EQ(scene.enough(1 / 510.0F), 7);  // 0.4^6 = .0041, 0.4^7 = .0016
  EXPECT_EQ(FibreScene(s, 1.0F).enough(0.0F), 1);
  EXPECT_GT(FibreScene(s, 0.0F).enough(0.5F), 1'000'000'000);
}

TEST(FibreScene, TransmittanceIsThePowerAlsoOfManyCrossings) {
  const FibreScene scene(Strands{}, 1e-3F);
  for (const int n : {0, 1, 10, 4095, 4096, 100'000}) {
    EXPECT_NEAR(scene.transmittance(n) / std::pow(1 - double(1e-3F), n), 1, 1e-12) << n;
  }
  EXPECT_EQ(FibreScene(Strands{}, 1.0F).transmittance(5), 0);
  EXPECT_EQ(FibreScene(Strands{}, 0.0F).transmittance(5), 1);
}

TEST(FibreScene, EmptyHairAndHairWithoutExtentIsInvisible) {
  Strands lone;
  lone.append(std::vector<glm::vec3>{{0, 0, 0}});
  lone.append(std::vector<glm::vec3>{{0, 0, 1}, {0, 0, 1}, {0, 0, 1}});
  lone.diameter_m = 1e-3F;
  for (const Strands& s : {Strands{}, lone}) {
    const FibreScene scene(s, kOpacity);
    EXPECT_EQ(scene.segments(), 0U);
    EXPECT_EQ(scene.count({{0, 0, -1}, {0, 0, 1}}, 0), 0);
  }
  Strands thin = sample::one_strand({{-1, 0, 0}, {1, 0, 0}}, 0);
  thin.diameters_m = {0, 0};
  EXPECT_EQ(FibreScene(thin, kOpacity).count({{0, 0, -1}, {0, 0, 1}}), 0);
}

TEST(FibreScene, RefusesWhatIsNotFinite) {
  const float bad[] = {std::numeric_limits<float>::quiet_NaN(), std::numeric_limits<float>::infinity()};
  for (const float value : bad) {
    Strands s = sample::loose_segments(3, 0.1, 0.1, kD, 1);
    s.vertices[3].y = value;
    try {
      const FibreScene scene(s, kOpacity);
      FAIL() << value;
    } catch (const InputError& e) {
      EXPECT_NE(std::string(e.what()).find("strand 1, vertex 1"), std::string::npos) << e.what();
    }
  }
  Strands s = sample::loose_segments(3, 0.1, 0.1, kD, 1);
  s.diameters_m.assign(6, -1e-6F);
  EXPECT_THROW(FibreScene(s, kOpacity), InputError);
}

TEST(FibreScene, HeadIsHitFirstOnItsNearSide) {
  Mesh m;
  m.vertices = {{-1, -1, 0.5F}, {1, -1, 0.5F}, {0, 1, 0.5F}, {-1, -1, 0.9F}, {1, -1, 0.9F}, {0, 1, 0.9F}};
  m.normals.assign(6, glm::vec3(0, 0, -1));
  m.triangles = {{3, 4, 5}, {0, 1, 2}};
  const FibreScene scene(Strands{}, kOpacity, &m);
  const auto hit = scene.head({{0, 0, -2}, {0, 0, 1}});
  ASSERT_TRUE(hit.has_value());
  EXPECT_NEAR(hit->depth_m, 2.5, 1e-6);
  EXPECT_EQ(hit->normal, glm::vec3(0, 0, -1));
  EXPECT_FALSE(scene.head({{0, 0, -2}, {0, 0, 1}, 2.4}).has_value());
  EXPECT_FALSE(scene.head({{3, 0, -2}, {0, 0, 1}}).has_value());
  EXPECT_FALSE(FibreScene(Strands{}, kOpacity).head({{0, 0, -2}, {0, 0, 1}}).has_value());
}

}  // namespace
}  // namespace pelage
