// Strands in the coordinates of a centre line.
#include "pelage/hair/cluster_projection.h"

#include <gtest/gtest.h>

#include <algorithm>

#include "test_clusters.h"

namespace pelage::hair {
namespace {

const CentreLine kBent{test::bent_cluster().centre_line, glm::vec3(1, 0, 0)};

/// A vertex made in the plane of t at (x, y) is found there.
TEST(Projection, FindsThePlaneOfEachVertex) {
  std::vector<glm::vec3> strand;
  const auto t_of = [](int i) { return 0.05 + 0.9 * i / 29; };
  for (int i = 0; i < 30; ++i) {
    const Frame f = kBent.frame(t_of(i));
    strand.push_back(f.position + .008F * f.normal - .003F * f.binormal);
  }
  const std::vector<PlanePoint> points = Projector(kBent).project(strand);
  ASSERT_EQ(points.size(), 30U);
  for (int i = 0; i < 30; ++i) {
    const PlanePoint& p = points[static_cast<std::size_t>(i)];
    EXPECT_NEAR(p.t, t_of(i), 1e-4) << i;  // 3 Newton steps at radius x curvature up to .5
    EXPECT_NEAR(p.plane_m.x, .008, 1e-5);
    EXPECT_NEAR(p.plane_m.y, -.003, 1e-5);
  }
  EXPECT_EQ(increasing_part(points, strand).size(), 30U);
}

TEST(Projection, GoesOnStraightBeyondTheEnds) {
  const Frame root = kBent.frame(0), tip = kBent.frame(1);
  const float length = static_cast<float>(kBent.length_m());
  const std::vector<glm::vec3> strand{root.position - .1F * length * root.tangent + .002F * root.normal,
                                      kBent.frame(.5).position, tip.position + .2F * length * tip.tangent};
  const std::vector<PlanePoint> points = Projector(kBent).project(strand);
  EXPECT_NEAR(points[0].t, -0.1, 1e-5);
  EXPECT_NEAR(points[0].plane_m.x, .002, 1e-6);
  EXPECT_NEAR(points[1].t, 0.5, 1e-5);
  EXPECT_NEAR(points[2].t, 1.2, 1e-5);
}

/// On a narrow U a strand of the left leg that drifts nearer to the right one must not jump across.
TEST(Projection, StaysOnItsLegOfAHairpin) {
  const std::vector<glm::vec3> u{{0, 0, 0},       {0, -.1F, 0},    {0, -.2F, 0}, {.005F, -.21F, 0},
                                 {.01F, -.2F, 0}, {.01F, -.1F, 0}, {.01F, 0, 0}};
  const CentreLine line(u, {0, 0, 1});
  std::vector<glm::vec3> strand;
  for (int i = 0; i <= 20; ++i) {
    const float drift = .0007F * static_cast<float>(std::min(i, 10));
    strand.push_back(line.frame(0.05 + 0.015 * i).position + glm::vec3(drift, 0, 0));
  }
  const std::vector<PlanePoint> points = Projector(line).project(strand);
  for (std::size_t i = 0; i < points.size(); ++i) {
    EXPECT_NEAR(points[i].t, 0.05 + 0.015 * static_cast<double>(i), 0.01) << i;
  }
}

PlanePoint at(double t, std::uint32_t vertex) {
  return {t, glm::dvec2(0), vertex};
}

TEST(IncreasingPart, KeepsTheLongestRunAndWhatGoesOn) {
  const std::vector<glm::vec3> strand{{0, 0, 0}, {1, 0, 0}, {2, 0, 0}, {3, 0, 0}, {4, 0, 0}, {5, 0, 0}, {6, 0, 0}};
  const std::vector<PlanePoint> points{at(.3, 0), at(.1, 1), at(.2, 2), at(.5, 3), at(.4, 4), at(.6, 5), at(.6, 6)};
  std::vector<std::uint32_t> kept;
  for (const PlanePoint& p : increasing_part(points, strand)) kept.push_back(p.vertex);
  EXPECT_EQ(kept, (std::vector<std::uint32_t>{1, 2, 3, 5}));
}

TEST(IncreasingPart, ReversedStrandKeepsOneVertex) {
  const std::vector<glm::vec3> strand{{0, 0, 0}, {1, 0, 0}, {2, 0, 0}};
  const std::vector<PlanePoint> points{at(.9, 0), at(.5, 1), at(.1, 2)};
  EXPECT_EQ(increasing_part(points, strand).size(), 1U);
  EXPECT_TRUE(increasing_part({}, {}).empty());
}

}  // namespace
}  // namespace pelage::hair
