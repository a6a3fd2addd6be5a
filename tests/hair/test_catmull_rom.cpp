// Smoothing: through the vertices, smooth at them, and defined whatever the vertices (hard case 26).
#include <gtest/gtest.h>

#include <cmath>
#include <glm/geometric.hpp>
#include <limits>

#include "pelage/data_schema/errors.h"
#include "pelage/hair/catmull_rom.h"

namespace pelage::hair {
namespace {

Strands strand_of(const std::vector<glm::vec3>& points) {
  Strands strands;
  strands.append(points);
  return strands;
}

std::vector<glm::vec3> helix(int count) {
  std::vector<glm::vec3> points;
  for (int k = 0; k < count; ++k) {
    const float t = 6.0F * static_cast<float>(k) / static_cast<float>(count - 1);
    points.emplace_back(0.02F * std::cos(t), -0.03F * t, 0.02F * std::sin(t));
  }
  return points;
}

TEST(CatmullRom, OnePieceChangesNothing) {
  Strands strands = strand_of({{0, 0, 0}, {0, 0, 0}, {1, 2, 3}});
  strands.append({});
  strands.diameters_m = {1, 2, 3};
  strands.colours = {{1, 0, 0}, {0, 1, 0}};
  const Strands same = smooth(strands, 1);
  EXPECT_EQ(same.vertices, strands.vertices);
  EXPECT_EQ(same.offsets, strands.offsets);
  EXPECT_EQ(same.diameters_m, strands.diameters_m);
  EXPECT_EQ(same.colours, strands.colours);
}

TEST(CatmullRom, GoesThroughTheVerticesBitForBit) {
  Strands strands = strand_of(helix(12));
  strands.append(std::vector<glm::vec3>{{1, 1, 1}});
  strands.append({});
  strands.append(helix(2));
  strands.diameter_m = 7e-5F;
  strands.colours.assign(4, {0.1F, 0.2F, 0.3F});
  for (const int pieces : {2, 5, 32}) {
    const Strands fine = smooth(strands, pieces);
    ASSERT_EQ(fine.count(), 4U);
    ASSERT_EQ(fine.strand(0).size(), std::size_t(11 * pieces + 1));
    for (std::size_t i = 0; i < 12; ++i) EXPECT_EQ(fine.strand(0)[i * std::size_t(pieces)], strands.strand(0)[i]);
    EXPECT_EQ(fine.strand(1).size(), 1U);
    EXPECT_EQ(fine.strand(2).size(), 0U);
    EXPECT_EQ(fine.strand(3).size(), std::size_t(pieces + 1));
    EXPECT_EQ(fine.diameter_m, strands.diameter_m);
    EXPECT_EQ(fine.colours, strands.colours);
    EXPECT_TRUE(fine.diameters_m.empty());
  }
}

TEST(CatmullRom, AStraightEvenStrandStaysStraightAndEven) {
  const Strands fine = smooth(strand_of({{0, 0, 0}, {1, 0, 0}, {2, 0, 0}, {3, 0, 0}}), 4);
  for (std::size_t i = 0; i < fine.vertices.size(); ++i) {
    EXPECT_NEAR(fine.vertices[i].x, 0.25F * static_cast<float>(i), 1e-6F);
    EXPECT_EQ(fine.vertices[i].y, 0.0F);
  }
}

TEST(CatmullRom, ErrorFallsWithTheThirdPowerOfTheSpacing) {
  // A circle's tangents from three points are exact to second order: halving the spacing divides the error by 8, or by
  // 16 where, as here between even vertices, the third order cancels.
  const auto error = [](int count) {
    const Strands fine = smooth(strand_of(helix(count)), 8);
    double most = 0;
    for (std::size_t i = 8; i + 8 < fine.vertices.size(); ++i) {
      const glm::dvec3 p(fine.vertices[i]);
      most = std::max(most, std::abs(std::hypot(p.x, p.z) - 0.02));
    }
    return most;
  };
  EXPECT_LT(error(24), 1e-5);
  EXPECT_GT(error(12) / error(24), 8.0);
}

TEST(CatmullRom, IsSmoothAtTheVerticesHoweverUneven) {
  const Strands coarse =
      strand_of({{0, 0, 0}, {1, 0, 0}, {1.1F, 0.1F, 0}, {1.2F, 1, 0}, {1.2F, 1.001F, 0.001F}, {0, 2, 1}});
  constexpr std::size_t kPieces = 32;
  const Strands fine = smooth(coarse, kPieces);
  double most = -1;
  for (std::size_t i = 1; i + 1 < fine.vertices.size(); ++i) {
    const glm::dvec3 a(fine.vertices[i - 1]), b(fine.vertices[i]), c(fine.vertices[i + 1]);
    most = std::max(most, std::acos(std::min(glm::dot(glm::normalize(b - a), glm::normalize(c - b)), 1.0)));
  }
  // No cusp and no loop: pieces turn little; the polyline turns by 1.8 at its sharpest.
  EXPECT_LT(most, 0.8);
}

TEST(CatmullRom, DuplicatePointsGiveNoZeroTangentAndNoNan) {
  const glm::vec3 p{0.1F, 1.7F, 0.2F}, q = p + glm::vec3(0.01F, 0, 0), r = q + glm::vec3(0, 0.01F, 0);
  const float ulp = std::nextafter(1.7F, 2.0F) - 1.7F;
  const std::vector<std::vector<glm::vec3>> all{{p, p, q, r},
                                                {p, q, q, r},
                                                {p, q, r, r},
                                                {p, p},
                                                {p, p, p, p},
                                                {p, q, p, q},
                                                {p, q, p},
                                                {r, q, q, q, p},
                                                {p, p, q},
                                                {p, p + glm::vec3(0, ulp, 0), q, r},
                                                {p, glm::vec3(0), p},
                                                {glm::vec3(0), glm::vec3(1e-30F, 0, 0), p}};
  for (std::size_t k = 0; k < all.size(); ++k) {
    const Strands fine = smooth(strand_of(all[k]), 6);
    for (std::size_t i = 0; i < fine.vertices.size(); ++i) {
      for (int c = 0; c < 3; ++c) ASSERT_TRUE(std::isfinite(fine.vertices[i][c])) << k;
      if (i > 0) {
        ASSERT_GT(glm::distance(glm::dvec3(fine.vertices[i]), glm::dvec3(fine.vertices[i - 1])), 0.0) << k << " " << i;
      }
    }
  }
  EXPECT_EQ(smooth(strand_of({p, p, q, r}), 6).vertices, smooth(strand_of({p, q, r}), 6).vertices);
  EXPECT_EQ(smooth(strand_of({p, p, p}), 6).vertices.size(), 1U);
}

TEST(CatmullRom, DiametersAreInterpolated) {
  Strands strands = strand_of({{0, 0, 0}, {1, 0, 0}, {1, 0, 0}, {3, 0, 0}});
  strands.diameters_m = {4, 2, 9, 0};
  EXPECT_EQ(smooth(strands, 2).diameters_m, (std::vector<float>{4, 3, 2, 1, 0}));
}

TEST(CatmullRom, RefusesPiecesOutOfRange) {
  for (const int pieces : {-1, 0, 33}) EXPECT_THROW(smooth({}, pieces), UsageError);
}

}  // namespace
}  // namespace pelage::hair
