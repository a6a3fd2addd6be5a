#include "pelage/reference/truth_image.h"

#include <gtest/gtest.h>
#include <tbb/global_control.h>

#include "pelage/data_schema/errors.h"
#include "pelage/data_schema/strand_tint.h"
#include "pelage/shading/head_lighting.h"
#include "sample_hair.h"

namespace pelage {
namespace {

/// Seen from +Z at 1 m; a pixel is `pixel_m` wide at the origin.
TruthRequest seen_from_z(int width, int height, double pixel_m, std::span<const Light> lights) {
  TruthRequest r;
  r.camera.fov_deg = static_cast<float>(2 * std::atan(0.5 * height * pixel_m) * 180 / std::numbers::pi);
  r.width = width;
  r.height = height;
  r.lights = lights;
  return r;
}

glm::vec4 pixel(const std::vector<float>& rgba, int width, int x, int y) {
  const float* p = rgba.data() + 4 * (y * width + x);
  return {p[0], p[1], p[2], p[3]};
}

const std::vector<Light> kOneLight{Light{{0, 0, 1}, {}, glm::vec3(1), 1}};

TEST(TruthImage, OneFibreStandsWhereItIsWithItsCoverage) {
  // Pixels of 1 mm, a fibre of 0.5 mm along x, its middle 3.3 mm above the centre line: y pixels up 3.05 .. 3.55.
  const Strands s = sample::one_strand({{-0.1F, 0.0033F, 0}, {0.1F, 0.0033F, 0}}, 5e-4F);
  const float opacity = 0.6F;
  const FibreScene scene(s, opacity);
  TruthRequest r = seen_from_z(21, 17, 1e-3, kOneLight);
  r.settings.samples = 1024;
  const auto rgba = truth_image(scene, s, r);
  // Row 8 holds the centre line: [-.5, .5] mm. 3.3 mm lies in row 8 - 3: [2.5, 3.5], 0.45 of the pixel covered; the
  // rest, .05, in row 4.
  const double expected[17] = {0, 0, 0, 0, 0.05, 0.45};
  for (int y = 0; y < 17; ++y) {
    for (int x = 0; x < 21; ++x) {
      // Well-spread samples of a straight edge: 1024 points are off by less than 1 / 32 of a row each... of two edges
      // at most 4 / 1024 measured; 6 / 1024 allowed. float: 1e-4 of a pixel.
      EXPECT_NEAR(double(pixel(rgba, 21, x, y).a), double(opacity) * expected[y], 6.0 / 1024) << x << " " << y;
    }
  }
}

TEST(TruthImage, SomePixelsAreThoseOfTheWholePicture) {
  const Strands s = sample::one_strand({{-0.1F, 0.0033F, 0}, {0.1F, 0.0033F, 0}}, 5e-4F);
  const FibreScene scene(s, 0.6F);
  TruthRequest r = seen_from_z(21, 17, 1e-3, kOneLight);
  r.settings.samples = 5;
  r.seed = 3;
  const auto whole = truth_image(scene, s, r);
  std::vector<glm::ivec2> pixels;
  for (int i = 0; i < 60; ++i) pixels.emplace_back((7 * i) % 21, (5 * i) % 17);
  const auto some = truth_pixels(scene, s, r, pixels);
  ASSERT_EQ(some.size(), 4 * pixels.size());
  for (std::size_t i = 0; i < pixels.size(); ++i)
    EXPECT_EQ(pixel(some, static_cast<int>(pixels.size()), static_cast<int>(i), 0),
              pixel(whole, 21, pixels[i].x, pixels[i].y));
}

TEST(TruthImage, RightIsRightAndUpIsUp) {
  // A short fibre right of the centre and above it, from a camera that looks along -z, and from one that looks along x.
  const Strands s = sample::one_strand({{0.004F, 0.003F, -0.006F}, {0.006F, 0.003F, -0.004F}}, 5e-4F);
  const FibreScene scene(s, 1.0F);
  TruthRequest r = seen_from_z(20, 20, 1e-3, kOneLight);
  const auto front = truth_image(scene, s, r);
  EXPECT_GT(pixel(front, 20, 15, 6).a, 0.1F);
  r.camera.eye = {-1, 0, 0};
  const auto side = truth_image(scene, s, r);
  EXPECT_GT(pixel(side, 20, 5, 6).a, 0.1F) << "from -x, -z is on the left";
  r.camera.eye = {0, 1, 0};
  const auto above = truth_image(scene, s, r);  // looks along up: then, as in render/camera.cpp, +z is up
  EXPECT_GT(pixel(above, 20, 5, 15).a, 0.1F);
}

TEST(TruthImage, LoneFibreShowsItsLightingTimesTheAzimuthTerm) {
  const Strands s = sample::one_strand({{-0.1F, 0, 0}, {0.1F, 0, 0}}, 1e-2F);
  const float opacity = 0.6F;
  const FibreScene scene(s, opacity);
  std::vector<Light> lights{{{0.1F, 0.5F, 1.0F}, {}, {1, 0.5F, 0.25F}, 2.0F}, {{0.3F, -1, 0.2F}, {}, {0, 0, 1}, 1.0F}};
  TruthRequest r = seen_from_z(3, 3, 1e-4, lights);
  r.settings.azimuth = false;
  const glm::vec4 seen = pixel(truth_image(scene, s, r), 3, 1, 1);
  const glm::vec3 t(1, 0, 0), v(0, 0, 1);
  glm::vec3 expected = r.material.ambient * glm::vec3(2, 1, 1.5F) * r.material.diffuse_colour;
  for (const Light& l : lights) {
    expected += hair_lighting(r.material, {}, t, v, glm::normalize(l.direction), v) * l.intensity * l.colour;
  }
  EXPECT_NEAR(seen.a, opacity, 1e-6);
  // The view turns by 1e-4 over the pixel, highlights with it: exponent 120, so 1e-3 of the colour at most.
  for (int k = 0; k < 3; ++k) EXPECT_NEAR(seen[k], opacity * expected[k], 1e-3F * expected[k]) << k;

  r.settings.azimuth = true;
  r.camera.eye = {0, 0, 1};
  lights = {{{0, 0, 1}, {}, glm::vec3(1), 1.0F}};
  r.lights = lights;
  r.material.ambient = 0;
  const float lit = pixel(truth_image(scene, s, r), 3, 1, 1).g;
  r.settings.azimuth = false;
  // Phong head on: (kd + ks) / mean, mean = .7 / pi + .3 * .2734 / 2 ... = 0.7 / pi + 0.3 * 35 / 256.
  const double gain = 1 / (0.7 / std::numbers::pi + 0.3 * 35.0 / 256 / 1.0);
  EXPECT_NEAR(double(lit / pixel(truth_image(scene, s, r), 3, 1, 1).g), gain, 2e-3 * gain);
}

TEST(TruthImage, ColoursOfStrandsReplaceTheMaterials) {
  Strands s = sample::one_strand({{-0.1F, 0.005F, 0}, {0.1F, 0.005F, 0}}, 4e-3F);
  s.append(std::vector<glm::vec3>{{-0.1F, -0.005F, 0}, {0.1F, -0.005F, 0}});
  s.colours = {{1, 0, 0}, {0, 1, 0}};
  const FibreScene scene(s, 1.0F);
  TruthRequest r = seen_from_z(11, 11, 2e-3, kOneLight);
  r.material.primary = 0;
  const auto rgba = truth_image(scene, s, r);
  const glm::vec4 upper = pixel(rgba, 11, 5, 3), lower = pixel(rgba, 11, 5, 7);
  EXPECT_GT(upper.r, 0.1F);
  EXPECT_EQ(upper.g, 0.0F);
  EXPECT_EQ(lower.r, 0.0F);
  EXPECT_GT(lower.g, 0.1F);
}

TEST(TruthImage, ColoursVaryByTheStrandsOwnFactor) {
  Strands s;
  for (int i = 0; i < 8; ++i) {
    const float y = 0.01F * float(i) - 0.035F;
    s.append(std::vector<glm::vec3>{{-0.1F, y, 0}, {0, y, 0}, {0.1F, y, 0}});
  }
  s.diameter_m = 4e-3F;
  for (const bool own : {false, true}) {
    if (own) s.colours.assign(8, {0.5F, 0.25F, 0.125F});
    const FibreScene scene(s, 1.0F);
    TruthRequest r = seen_from_z(1, 8, 1e-2, kOneLight);
    r.camera.fov_deg = static_cast<float>(2 * std::atan(0.04) * 180 / std::numbers::pi);
    r.settings.samples = 256;
    r.material.primary = 0;  // is the light's colour and does not vary
    const auto plain = truth_image(scene, s, r);
    r.material.variation = 0.8F;
    const auto varied = truth_image(scene, s, r);
    for (int i = 0; i < 8; ++i) {
      const glm::vec4 a = pixel(plain, 1, 0, 7 - i), b = pixel(varied, 1, 0, 7 - i);
      const glm::vec3 tint = strand_tint(static_cast<std::uint32_t>(i), 0.8F);
      EXPECT_EQ(a.a, b.a);
      for (int c = 0; c < 3; ++c) EXPECT_NEAR(b[c] / a[c], tint[c], 1e-5F) << "strand " << i << ", own colours " << own;
    }
    r.material.variation = 0;
    EXPECT_EQ(truth_image(scene, s, r), plain);
  }
}

TEST(TruthImage, NearFibresCoverFarOnesAndShadowThem) {
  // Ten opaque-ish layers behind each other along the view; light from the viewer: layer k has T = .4^k twice.
  Strands s;
  for (int k = 0; k < 10; ++k) {
    const float z = -0.01F * float(k);
    s.append(std::vector<glm::vec3>{{-0.1F, 0, z}, {0.1F, 0, z}});
  }
  s.diameter_m = 5e-3F;
  const FibreScene scene(s, 0.6F);
  TruthRequest r = seen_from_z(2, 2, 1e-4, kOneLight);
  r.material.primary = r.material.secondary = r.material.ambient = 0;
  r.settings.azimuth = false;
  r.settings.samples = 4096;
  const glm::vec4 p = pixel(truth_image(scene, s, r), 2, 0, 0);
  double expected = 0, t = 1;
  for (int k = 0; k < 10; ++k, t *= 0.4) expected += 0.6 * t * t;
  EXPECT_NEAR(double(p.a), 1 - t, 1e-6);
  // Of the tail, T = .064 from the fourth on, one crossing is chosen at random: standard deviation of its shadow
  // < .4^3 / 2, so .064 x .032 / sqrt(4096) = 3.2e-5; 4 of these.
  EXPECT_NEAR(double(p.g) / double(r.material.diffuse_colour.g), expected, 1.3e-4);
}

TEST(TruthImage, HeadIsOpaqueAndLiesInTheHairsShadow) {
  Mesh head;
  head.vertices = {{-1, -1, -0.1F}, {1, -1, -0.1F}, {0, 2, -0.1F}};
  head.normals.assign(3, {0, 0, 1});
  head.triangles = {{0, 1, 2}};
  Strands s = sample::one_strand({{-0.1F, 0, 0}, {0.1F, 0, 0}}, 2e-2F);   // in view
  s.append(std::vector<glm::vec3>{{-0.1F, 0, -0.3F}, {0.1F, 0, -0.3F}});  // behind the head
  const FibreScene scene(s, 0.6F, &head);
  TruthRequest r = seen_from_z(2, 2, 1e-4, kOneLight);
  r.lobes = {false, false, false};  // black hair
  r.material.ambient = 0;
  const glm::vec4 p = pixel(truth_image(scene, s, r), 2, 0, 0);
  EXPECT_EQ(p.a, 1.0F);
  const float ambient = head_ambient({0, 0, 1}), direct = head_direct({0, 0, 1}, {0, 0, 1});
  EXPECT_EQ(direct, 1.0F);
  EXPECT_NEAR(p.r, 0.4F * kHeadColour.r * (ambient + 0.4F), 1e-4F);  // seen through the fibre, and in its shadow
  const glm::vec4 bare = pixel(truth_image(FibreScene(Strands{}, 0.6F, &head), Strands{}, r), 2, 0, 0);
  EXPECT_NEAR(bare.g, kHeadColour.g * (1 + ambient), 1e-5F);
  const std::vector<Light> lamp{Light{{}, glm::vec3(0, 0, 1.9F), glm::vec3(1, 0, 0), 8}};  // 2 m away: 8 / 4
  r.lights = lamp;
  const glm::vec4 red = pixel(truth_image(FibreScene(Strands{}, 0.6F, &head), Strands{}, r), 2, 0, 0);
  EXPECT_NEAR(red.r, kHeadColour.r * 2 * (1 + ambient), 1e-4F);
  EXPECT_EQ(red.g, 0.0F);
}

TEST(TruthImage, ShadowOnTheHeadIsAsSoftAsTheLightIsLarge) {
  // A wide opaque ribbon of fibres ends at x = 0, 5 cm above the wall; the light above is seen under 2 atan(.2), so
  // that the wall sees the share of its disc that lies beyond the edge: half at x = 0, none at -1 cm, all at 1 cm.
  Mesh wall;
  wall.vertices = {{-1, -1, 0}, {1, -1, 0}, {0, 2, 0}};
  wall.normals.assign(3, {0, 0, 1});
  wall.triangles = {{0, 1, 2}};
  Strands s;
  for (int i = 0; i < 60; ++i) {
    const float x = -6e-4F - 1e-3F * float(i);
    s.append(std::vector<glm::vec3>{{x, -0.1F, 0.05F}, {x, 0.1F, 0.05F}});
  }
  s.diameter_m = 1.2e-3F;
  const FibreScene scene(s, 1.0F, &wall);
  std::vector<Light> lights = kOneLight;
  lights[0].size_deg = static_cast<float>(2 * std::atan(0.2) * 180 / std::numbers::pi);
  TruthRequest r = seen_from_z(1, 1, 1e-4, lights);
  r.settings.samples = 4096;
  const auto seen_from = [&](float x) {  // from under the hair: it is not in view
    r.camera = Camera{{x + 0.02F, 0, 0.04F}, {x, 0, 0}, {0, 1, 0}, 0.01F};
    const float direct = pixel(truth_image(scene, s, r), 1, 0, 0).g / kHeadColour.g - head_ambient({0, 0, 1});
    return double(direct);
  };
  // Share of a disc beyond a chord at q radii from its middle; four standard errors of 4096 rays: .031.
  const auto share = [](double q) { return 1 - (std::acos(q) - q * std::sqrt(1 - q * q)) / std::numbers::pi; };
  EXPECT_NEAR(seen_from(0), share(0), 0.031);
  EXPECT_NEAR(seen_from(0.005F), share(0.5), 0.031);
  EXPECT_NEAR(seen_from(-0.005F), 1 - share(0.5), 0.031);
  EXPECT_NEAR(seen_from(0.0105F), 1.0, 1e-6);
  EXPECT_NEAR(seen_from(-0.0105F), 0.0, 1e-6);
  lights[0].size_deg = 0;
  EXPECT_NEAR(seen_from(-0.001F), 0.0, 1e-6) << "of a light without size it is sharp";
  EXPECT_NEAR(seen_from(0.001F), 1.0, 1e-6);
}

TEST(TruthImage, HeadCastsAShadowOnlyWhenAsked) {
  Mesh head;  // between hair and light, not between hair and viewer
  head.vertices = {{-1, 0.5F, -1}, {1, 0.5F, -1}, {0, 0.5F, 2}};
  head.normals.assign(3, {0, 1, 0});
  head.triangles = {{0, 2, 1}};
  const Strands s = sample::one_strand({{-0.1F, 0, 0}, {0.1F, 0, 0}}, 2e-2F);
  const FibreScene scene(s, 0.6F, &head);
  const std::vector<Light> lights{Light{{0, 1, 0.5F}, {}, glm::vec3(1), 1}};
  TruthRequest r = seen_from_z(2, 2, 1e-4, lights);
  r.material.ambient = 0;
  EXPECT_GT(pixel(truth_image(scene, s, r), 2, 0, 0).g, 0.0F);
  r.head_shadow = HeadShadow::casts;
  EXPECT_EQ(pixel(truth_image(scene, s, r), 2, 0, 0).g, 0.0F);
}

TEST(TruthImage, SameBytesForAnyNumberOfThreadsAndProgressTellsAllPixels) {
  const Strands s = sample::walks(300, 20, 0.02, 0.002, 0.3, 4e-4F, 1);
  const FibreScene scene(s, 0.6F);
  TruthRequest r = seen_from_z(37, 29, 2e-3, kOneLight);
  r.settings.samples = 4;
  std::vector<float> first;
  for (const std::size_t threads : {1U, 2U, 3U, 8U}) {
    const tbb::global_control limit(tbb::global_control::max_allowed_parallelism, threads);
    std::uint64_t last = 0;
    const auto rgba = truth_image(scene, s, r, [&](std::uint64_t done, std::uint64_t total) {
      EXPECT_GT(done, last);
      EXPECT_EQ(total, 37U * 29U);
      last = done;
    });
    EXPECT_EQ(last, 37U * 29U);
    if (first.empty()) first = rgba;
    EXPECT_EQ(rgba, first) << threads;
  }
  r.seed = 2;
  EXPECT_NE(truth_image(scene, s, r), first);
  for (const float value : first) EXPECT_TRUE(std::isfinite(value) && value >= 0);
}

TEST(TruthImage, ProgressMayInterruptAndSenselessRequestsAreRefused) {
  const Strands s = sample::walks(30, 20, 0.02, 0.002, 0.3, 4e-4F, 1);
  const FibreScene scene(s, 0.6F);
  TruthRequest r = seen_from_z(40, 40, 2e-3, kOneLight);
  EXPECT_THROW(truth_image(scene, s, r, [](auto, auto) { throw Interrupted("enough"); }), Interrupted);
  r.camera.eye = r.camera.target;
  EXPECT_THROW(truth_image(scene, s, r), UsageError);
  std::vector<Light> none{Light{{0, 0, 0}, {}, glm::vec3(1), 1}};
  r = seen_from_z(4, 4, 1e-3, none);
  EXPECT_THROW(truth_image(scene, s, r), UsageError);
}

}  // namespace
}  // namespace pelage
