#include "pelage/satf/self_shadow.h"

#include <gtest/gtest.h>

#include "fixture.h"

namespace pelage::test {
namespace {

/// True optical depth in a plate from a point of the disk to outside, towards `d`: every strand is a Gaussian of mass M
/// and the width that the maps give it (sigma of the layer's sectors), integrated exactly along the half-ray.
double true_depth(const Scene& scene, glm::vec2 from, glm::vec2 d, double radius_m) {
  double sum = 0;
  for (const Crossing& c : plate_crossings(scene.style.clusters[0], 0.5F)) {
    const glm::vec2 w = c.disk - from;
    const double along = static_cast<double>(w.x * d.x + w.y * d.y),
                 across = static_cast<double>(w.x * d.y - w.y * d.x);
    const RingShape ring = ring_shape(scene.model.division, 2);
    const double sigma = static_cast<double>(scene.model.profile_sigma * ring.width);
    const double mass = static_cast<double>(scene.model.blocked_width_m);
    const double profile = mass / (std::sqrt(2.0 * std::numbers::pi) * sigma * radius_m) *
                           std::exp(-0.5 * across * across / (sigma * sigma));
    sum += profile * 0.5 * (1.0 + std::erf(along / (std::sqrt(2.0) * sigma)));
  }
  return sum;
}

struct ShadowError {
  double lit = 0, unlit = 0, lit_mean = 0;
};

ShadowError shadow_error(const Scene& scene, const std::vector<std::uint16_t>& shadows, glm::vec2 light) {
  double lit2 = 0, unlit2 = 0, mean = 0;
  int lit = 0, unlit = 0;
  for (int j = 0; j < scene.model.division.layers; ++j) {
    const float v = 0.5F * (layer_radius(scene.model.division, j) + layer_radius(scene.model.division, j + 1));
    const int width = scene.model.layout.widths[static_cast<std::size_t>(j)];
    for (int x = 0; x < width; ++x) {
      const float u = 2 * kPi * (static_cast<float>(x) + 0.5F) / static_cast<float>(width);
      const glm::vec2 p = v * glm::vec2(std::cos(u), std::sin(u));
      const double truth = std::exp(-true_depth(scene, p, light, 0.01));
      const double got = shadows[scene.model.layout.texel(0, j, 4) + static_cast<std::size_t>(x)] / 65535.0;
      const bool front = glm::dot(p, light) > 0;
      (front ? lit2 : unlit2) += (got - truth) * (got - truth);
      ++(front ? lit : unlit);
      if (front) mean += truth;
    }
  }
  return {std::sqrt(lit2 / lit), std::sqrt(unlit2 / unlit), mean / lit};
}

class SelfShadowTruth : public ::testing::TestWithParam<float> {};

TEST_P(SelfShadowTruth, FollowsTheLight) {
  Cluster cluster = straight_cluster({.01F, 0, .01F});
  fill_disk(cluster, 150);
  const Scene scene(style_of(std::move(cluster)));
  const Frame& frame = scene.model.instances[0].swept.frames[4];
  const float a = GetParam();
  const glm::vec3 to_light = std::cos(a) * frame.normal + std::sin(a) * frame.binormal;
  std::vector<std::uint16_t> shadows(scene.model.texels());
  build_shadows(scene.model, scene.source, {to_light, true, true, nullptr}, shadows);
  const ShadowError e = shadow_error(scene, shadows, {std::cos(a), std::sin(a)});
  // NUMBERS.md: unlit side .12 for mean density x path, any form of eq. 12 .33-.39 there and .21-.25 on the lit side;
  // lit side: its .004 is for the exact crossing, ours stands at the middle of a layer and blends near the terminator.
  EXPECT_LT(e.lit, 0.08) << "mean transmittance " << e.lit_mean;
  EXPECT_LT(e.unlit, 0.12);
  RecordProperty("lit_rmse", std::to_string(e.lit));
  RecordProperty("unlit_rmse", std::to_string(e.unlit));
  std::printf("self-shadow RMSE at light %.1f: lit %.3f, unlit %.3f\n", static_cast<double>(a), e.lit, e.unlit);
}

INSTANTIATE_TEST_SUITE_P(Lights, SelfShadowTruth, ::testing::Values(0.0F, 1.0F, 2.5F, 4.4F));

TEST(SelfShadow, OffAndAloneIsFullLight) {
  Cluster cluster = straight_cluster({.01F, 0, .01F});
  fill_disk(cluster, 50);
  const Scene scene(style_of(std::move(cluster)));
  std::vector<std::uint16_t> shadows(scene.model.texels());
  build_shadows(scene.model, scene.source, {{0, 0, 1}, false, true, nullptr}, shadows);
  for (const std::uint16_t s : shadows) ASSERT_EQ(s, 65535);
}

TEST(SelfShadow, DensityMapShadowsFromOutside) {
  // A sheet of hair between light and cluster: its depth arrives at every texel that looks at it.
  Cluster cluster = straight_cluster({.01F, 0, .01F});
  fill_disk(cluster, 10);
  const Scene scene(style_of(std::move(cluster)));
  constexpr float kWidth_m = 1e-4F;
  Strands sheet;
  sheet.diameter_m = kWidth_m;
  for (int i = 0; i < 2000; ++i) {
    const float x = -0.1F + 0.2F * (static_cast<float>(i) + 0.5F) / 2000;
    sheet.append(std::array{glm::vec3(x, -0.3F, 0.05F), glm::vec3(x, 0.1F, 0.05F)});
  }
  DensityMapSettings settings;
  settings.trilinear_deposit = true;  // no matter where in its cell hair lies
  settings.resolution = 64;
  const DensityMap map(settings, sheet, 1.0F, Light{{0, 0, 1}, {}, glm::vec3(1), 1});
  std::vector<std::uint16_t> shadows(scene.model.texels());
  build_shadows(scene.model, scene.source, {{0, 0, 1}, false, true, &map}, shadows);
  const double expected = std::exp(-2000 * double(kWidth_m) / 0.2);  // a D per spacing
  // 2 %: the deposit's sampling of a sheet by 64 cells.
  for (const std::uint16_t s : shadows) ASSERT_NEAR(s / 65535.0, expected, 0.02);
}

TEST(HairStrands, JoinEveryStrandFromPlateToPlate) {
  Cluster cluster = straight_cluster({.01F, 0, .01F});
  fill_disk(cluster, 7);
  const Scene scene(style_of(std::move(cluster)));
  const Strands strands = hair_strands(scene.style, scene.model);
  ASSERT_EQ(strands.count(), 7U);
  for (std::size_t s = 0; s < strands.count(); ++s) {
    const auto points = strands.strand(s);
    ASSERT_EQ(points.size(), 9U);
    for (std::size_t i = 1; i < points.size(); ++i)
      EXPECT_NEAR(glm::distance(points[i - 1], points[i]), 0.2F / 8, 1e-4F);
  }
}

}  // namespace
}  // namespace pelage::test
