// Resampling: even arc length, exact ends, points on the polyline.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <glm/glm.hpp>

#include "pelage/data_schema/errors.h"
#include "pelage/hair/resample.h"

namespace pelage::hair {
namespace {

/// A helix with unevenly placed vertices.
std::vector<glm::vec3> helix(int count) {
  std::vector<glm::vec3> points;
  for (int k = 0; k < count; ++k) {
    const float t = static_cast<float>(k * k) / static_cast<float>((count - 1) * (count - 1));
    points.emplace_back(0.02F * std::cos(9 * t), -0.2F * t, 0.02F * std::sin(9 * t));
  }
  return points;
}

TEST(Resample, StraightLineIsCutEvenly) {
  const std::vector<glm::vec3> line{{0, 0, 0}, {0.1F, 0, 0}, {1, 0, 0}};
  const auto points = resample_polyline(line, 5);
  for (std::size_t k = 0; k < 5; ++k) EXPECT_NEAR(points[k].x, 0.25F * static_cast<float>(k), 1e-7F);
}

TEST(Resample, KeepsEndsBitForBitAndEvenSpacing) {
  const std::vector<glm::vec3> curve = helix(400);
  const auto points = resample_polyline(curve, 100);
  EXPECT_EQ(points.front(), curve.front());
  EXPECT_EQ(points.back(), curve.back());
  const double mean = arc_length_m(points) / 99;
  // Chords of a curve of curvature k vary by (k s)^2 / 24 < 1 % at s = 2.7 mm and k < 50 /m; 0.1 % of slack.
  for (std::size_t k = 1; k < points.size(); ++k) {
    EXPECT_NEAR(static_cast<double>(glm::distance(points[k - 1], points[k])), mean, 0.011 * mean);
  }
}

TEST(Resample, DegenerateStrandsStayFinite) {
  for (const auto& points : {std::vector<glm::vec3>{{1, 2, 3}}, std::vector<glm::vec3>(4, glm::vec3(1, 2, 3))}) {
    for (const glm::vec3& p : resample_polyline(points, 7)) EXPECT_EQ(p, glm::vec3(1, 2, 3));
  }
}

TEST(Resample, StrandsKeepDiametersAndColours) {
  Strands s;
  s.append(std::vector<glm::vec3>{{0, 0, 0}, {0, -1, 0}});
  s.append(helix(10));
  s.diameters_m.assign(12, 1e-4F);
  s.diameters_m[1] = 0.0F;
  s.colours = {{1, 0, 0}, {0, 1, 0}};
  const Strands r = resample(s, 5);
  EXPECT_EQ(r.offsets, (std::vector<std::uint32_t>{0, 5, 10}));
  EXPECT_FLOAT_EQ(r.diameters_m[2], 0.5e-4F);
  EXPECT_EQ(r.colours, s.colours);
}

TEST(Resample, SpacingIsAnUpperBound) {
  Strands s;
  s.append(helix(50));
  const Strands r = resample_to_spacing(s, 0.007F);
  for (std::size_t k = 1; k < r.vertices.size(); ++k) {
    EXPECT_LE(glm::distance(r.vertices[k - 1], r.vertices[k]), 0.007F * (1 + 1e-5F));
  }
  EXPECT_EQ(r.vertices.size(), static_cast<std::size_t>(std::ceil(arc_length_m(s.strand(0)) / 0.007)) + 1);
}

TEST(Resample, RefusesMoreVerticesThanCanBeCounted) {
  Strands s;
  for (int i = 0; i < 65'540; ++i) s.append(std::vector<glm::vec3>{{0, 0, 0}, {0, 1000, 0}});
  EXPECT_THAT([&] { resample(s, 65'536); }, testing::ThrowsMessage<UsageError>(testing::HasSubstr("4295229440")));
  EXPECT_THROW(resample(s, 2'000'000'000), UsageError);
  EXPECT_THROW(resample_to_spacing(s, 1e-3F), UsageError);
}

TEST(Resample, RefusesNonsense) {
  Strands s;
  s.append(helix(5));
  EXPECT_THROW(resample(s, 1), UsageError);
  for (const float bad : {0.0F, -1.0F, NAN, HUGE_VALF}) EXPECT_THROW(resample_to_spacing(s, bad), UsageError);
}

}  // namespace
}  // namespace pelage::hair
