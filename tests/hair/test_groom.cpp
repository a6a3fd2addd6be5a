// Grooms: the asked-for counts, outside of the head, evenly spaced, and the same bytes again.
#include <gtest/gtest.h>
#include <tbb/global_control.h>

#include <algorithm>
#include <chrono>
#include <cmath>
#include <glm/glm.hpp>

#include "pelage/data_schema/errors.h"
#include "pelage/hair/groom.h"
#include "pelage/hair/resample.h"
#include "pelage/hair/scalp.h"

namespace pelage::hair {
namespace {

class Grooms : public testing::TestWithParam<GroomStyle> {
 protected:
  GroomSettings settings(std::uint32_t strands) const {
    GroomSettings s;
    s.style = GetParam();
    s.strands = strands;
    return s;
  }
};

TEST_P(Grooms, HaveTheCountsAskedFor) {
  for (const std::uint32_t n : {1U, 2U, 7U, 1001U}) {
    const Strands s = groom(settings(n));
    ASSERT_EQ(s.count(), n);
    EXPECT_EQ(s.vertices.size(), std::size_t{n} * (GetParam() == GroomStyle::curly ? 64 : 32));
  }
  GroomSettings few = settings(10);
  few.vertices = 9;
  EXPECT_EQ(groom(few).vertices.size(), 90U);
}

TEST_P(Grooms, StayOutsideOfTheHead) {
  for (const std::uint64_t seed : {1, 2, 3, 4}) {
    GroomSettings g = settings(2000);
    g.seed = seed;
    const Strands s = groom(g);
    for (const glm::vec3& p : s.vertices) {
      ASSERT_TRUE(std::isfinite(p.x) && std::isfinite(p.y) && std::isfinite(p.z));
      ASSERT_GT(head_distance_m({}, p), -0.5e-3F) << p.x << " " << p.y << " " << p.z;
    }
    for (std::size_t i = 0; i < s.count(); ++i) ASSERT_LT(head_distance_m({}, s.strand(i).front()), 1e-3F);
  }
}

TEST_P(Grooms, SegmentsAreEven) {
  const Strands s = groom(settings(1000));
  std::vector<float> ratios;
  for (std::size_t i = 0; i < s.count(); ++i) {
    const auto points = s.strand(i);
    const auto mean = static_cast<float>(arc_length_m(points) / static_cast<double>(points.size() - 1));
    for (std::size_t k = 1; k < points.size(); ++k) ratios.push_back(glm::distance(points[k - 1], points[k]) / mean);
  }
  std::sort(ratios.begin(), ratios.end());
  // Even in arc length; chords are shorter where hair bends (curls: 12 vertices per turn make 1 %), and the way out of
  // the head after resampling moves single vertices. One segment of 31 holds the ponytail's sharp turn at the tie:
  // hence 5 %.
  EXPECT_GT(ratios[ratios.size() / 20], 0.80F);
  EXPECT_LT(ratios[ratios.size() - ratios.size() / 20], 1.15F);
}

TEST_P(Grooms, AreTheSameForAnyNumberOfThreads) {
  const Strands many = groom(settings(500));
  const tbb::global_control one(tbb::global_control::max_allowed_parallelism, 1);
  const Strands again = groom(settings(500));
  EXPECT_EQ(many.vertices, again.vertices);
  EXPECT_EQ(many.offsets, again.offsets);
}

TEST_P(Grooms, SeedsDiffer) {
  GroomSettings other = settings(100);
  other.seed = 2;
  EXPECT_NE(groom(settings(100)).vertices, groom(other).vertices);
}

TEST_P(Grooms, RootsAreSpreadEvenly) {
  const Strands s = groom(settings(1000));
  std::vector<float> nearest;
  for (std::size_t i = 0; i < s.count(); ++i) {
    float least = 1.0F;
    for (std::size_t k = 0; k < s.count(); ++k) {
      if (k != i) least = std::min(least, glm::distance(s.strand(i).front(), s.strand(k).front()));
    }
    nearest.push_back(least);
  }
  std::sort(nearest.begin(), nearest.end());
  // Random points: the tenth percentile of nearest distances is 0.39 of the median; a lattice: near 1.
  EXPECT_GT(nearest[100], 0.6F * nearest[500]);
}

TEST_P(Grooms, TaperToTheirTips) {
  const Strands s = groom(settings(400));
  ASSERT_EQ(s.diameters_m.size(), s.vertices.size());
  int fine = 0;
  for (std::size_t i = 0; i < s.count(); ++i) {
    const float* d = s.diameters_m.data() + s.offsets[i];
    const std::size_t n = s.offsets[i + 1] - s.offsets[i];
    for (std::size_t k = 1; k < n; ++k) ASSERT_LE(d[k], d[k - 1]);
    EXPECT_EQ(d[n / 2], d[0]);
    EXPECT_FLOAT_EQ(d[n - 1], 0.25F * d[0]);
    EXPECT_LE(d[0], default_diameter_m(400));
    fine += d[0] < default_diameter_m(400);
  }
  EXPECT_GT(fine, 4);  // baby hairs
  EXPECT_LT(fine, 80);
}

TEST_P(Grooms, HaveASoftHairline) {
  const Strands s = groom(settings(4000));
  int outside = 0, edge = 0, inner = 0;  // bands of equal width along the hairline
  double short_m = 0;
  for (std::size_t i = 0; i < s.count(); ++i) {
    const glm::vec3 d = glm::normalize(s.strand(i).front() - skull_centre_m({}));
    const float inside = d.y - hairline_sine(d);
    outside += inside < -0.05F;
    edge += inside >= 0 && inside < 0.05F;
    inner += inside >= 0.10F && inside < 0.15F;
    if (inside < 0.05F && arc_length_m(s.strand(i)) < 0.04) short_m += 1;
  }
  EXPECT_EQ(outside, 0);
  EXPECT_GT(edge, inner / 3);
  EXPECT_LT(edge, 9 * inner / 10);
  EXPECT_GT(short_m, 0.1 * edge);  // baby hairs, of 1 to 3.4 cm
}

TEST_P(Grooms, LeaveTheFaceFree) {
  const Strands s = groom(settings(2000));
  std::size_t before = 0;  // below the brow, in front of the face
  for (const glm::vec3& p : s.vertices) before += p.z > 0.065F && p.y < 0.0F && p.y > -0.09F && std::abs(p.x) < 0.03F;
  EXPECT_EQ(before, 0U);
}

INSTANTIATE_TEST_SUITE_P(Groom, Grooms,
                         testing::Values(GroomStyle::straight, GroomStyle::wavy, GroomStyle::curly, GroomStyle::bob,
                                         GroomStyle::ponytail));

TEST(Groom, BobEndsAtTheChin) {
  GroomSettings g;
  g.style = GroomStyle::bob;
  g.strands = 1000;
  const Strands s = groom(g);
  for (const glm::vec3& p : s.vertices) ASSERT_GT(p.y, -0.10F);
}

/// Mean height of the tips whose roots `choose` picks.
template <class Choose>
double mean_tip_m(const Strands& s, Choose choose) {
  double sum = 0;
  int count = 0;
  for (std::size_t i = 0; i < s.count(); ++i) {
    if (!choose(s.strand(i).front()) || arc_length_m(s.strand(i)) < 0.05) continue;
    sum += static_cast<double>(s.strand(i).back().y);
    ++count;
  }
  return sum / count;
}

TEST(Groom, LongHairIsCutInLayers) {
  for (const GroomStyle style : {GroomStyle::straight, GroomStyle::wavy}) {
    GroomSettings g;
    g.style = style;
    g.strands = 3000;
    const Strands s = groom(g);
    const double crown = mean_tip_m(s, [](glm::vec3 root) { return root.y > 0.09F && root.z < 0; });
    const double nape = mean_tip_m(s, [](glm::vec3 root) { return root.y < 0.0F && root.z < -0.05F; });
    EXPECT_GT(crown, nape + 0.01);
    EXPECT_LT(crown, nape + 0.09);
  }
}

TEST(Groom, HairToTheWaistStaysOutsideOfTheBust) {
  for (const GroomStyle style : {GroomStyle::straight, GroomStyle::wavy, GroomStyle::ponytail}) {
    GroomSettings g;
    g.style = style;
    g.strands = 2000;
    g.length_scale = 2;
    for (const glm::vec3& p : groom(g).vertices) ASSERT_GT(head_distance_m({}, p), -0.5e-3F) << p.x << " " << p.y;
  }
}

TEST(Groom, LongHairFallsBeforeAndBehindTheShoulders) {
  GroomSettings g;
  g.style = GroomStyle::straight;
  g.strands = 3000;
  const Strands s = groom(g);
  int before = 0, behind = 0, low = 0, aside = 0;
  for (std::size_t i = 0; i < s.count(); ++i) {
    const glm::vec3 tip = s.strand(i).back();
    if (tip.y > -0.16F) continue;
    ++low;
    before += tip.z > 0.0F;
    behind += tip.z < -0.07F;
    aside += std::abs(tip.x) > 0.13F;
  }
  EXPECT_GT(low, 1500);
  EXPECT_GT(before, low / 6);
  EXPECT_GT(behind, low / 6);
  EXPECT_GT(before + behind, 9 * low / 10);
  EXPECT_LT(aside, low / 100);
}

/// |x| where strands before `least_z_m` fall through the height y, in order.
std::vector<float> crossings_m(const Strands& s, float y, float least_z_m) {
  std::vector<float> found;
  for (std::size_t i = 0; i < s.count(); ++i) {
    const auto p = s.strand(i);
    for (std::size_t k = 1; k < p.size(); ++k) {
      if (p[k - 1].y <= y || p[k].y > y || p[k].z <= least_z_m) continue;
      found.push_back(std::abs(p[k].x));
      break;
    }
  }
  std::sort(found.begin(), found.end());
  return found;
}

TEST(Groom, BobCoversTheTemples) {
  GroomSettings g;
  g.style = GroomStyle::bob;
  g.strands = 3000;
  EXPECT_GT(crossings_m(groom(g), -0.03F, 0.045F).size(), 120U);  // 29 of 3000 left a strip of bare head
}

TEST(Groom, LongHairSpreadsOverTheChest) {
  for (const GroomStyle style : {GroomStyle::straight, GroomStyle::wavy}) {
    GroomSettings g;
    g.style = style;
    g.strands = 3000;
    const std::vector<float> x = crossings_m(groom(g), -0.16F, 0.0F);
    ASSERT_GT(x.size(), 1500U);
    EXPECT_GT(x[9 * x.size() / 10] - x[x.size() / 10], 0.03F);  // one strand on each side is 0.01 to 0.02 m wide
  }
}

TEST(Groom, HeadHeightScalesEverything) {
  GroomSettings g;
  g.strands = 50;
  const Strands one = groom(g);
  g.head.height_m = 0.48F;
  const Strands two = groom(g);
  for (std::size_t k = 0; k < one.vertices.size(); ++k) EXPECT_EQ(two.vertices[k], 2.0F * one.vertices[k]);
}

TEST(Groom, RefusesNonsense) {
  const auto refuses = [](auto change) {
    GroomSettings g;
    g.strands = 10;
    change(g);
    EXPECT_THROW(groom(g), UsageError);
  };
  refuses([](GroomSettings& g) { g.strands = 0; });
  refuses([](GroomSettings& g) { g.strands = 4'000'000'000U; });
  refuses([](GroomSettings& g) { g.vertices = 1; });
  refuses([](GroomSettings& g) { g.length_scale = NAN; });
  refuses([](GroomSettings& g) { g.head.height_m = HUGE_VALF; });
  EXPECT_THROW(parse_groom_style("mohawk"), UsageError);
}

}  // namespace
}  // namespace pelage::hair
