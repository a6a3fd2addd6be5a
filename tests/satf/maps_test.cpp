#include "pelage/satf/maps.h"

#include <gtest/gtest.h>
#include <tbb/global_control.h>

#include "fixture.h"
#include "pelage/db/optical_scale.h"

namespace pelage::test {
namespace {

TEST(Texel, RoundTripsToHalfAStep) {
  for (const float alpha : {0.0F, 0.3F, 1.0F}) {
    for (const float re : {0.0F, 1.0F, 3.79F, 8.0F}) {
      for (const float transmittance : {0.0F, 0.77F, 1.0F}) {
        const TexelValues v = unpack_texel(pack_texel({alpha, re, transmittance}));
        EXPECT_NEAR(v.alpha, alpha, 0.5F / 1023 + 1e-6F);
        EXPECT_NEAR(v.re, re, 4.0F / 4095 + 1e-6F);
        EXPECT_NEAR(v.transmittance, transmittance, 0.5F / 1023 + 1e-6F);
      }
    }
  }
}

/// Optical depth of a ray through the whole cluster at impact parameter b (in disk radii): near side of every layer
/// that it meets, then the far side of those whose inner surface it crosses.
float depth_through(const std::vector<std::vector<float>>& rings, const Division& division, float phi, float b) {
  float sum = 0;
  for (std::size_t j = 0; j < rings.size(); ++j) {
    const float outer = layer_radius(division, static_cast<int>(j) + 1),
                inner = layer_radius(division, static_cast<int>(j));
    if (std::abs(b) < outer) sum += at_azimuth(rings[j], phi + std::asin(b / outer));
    if (std::abs(b) < inner) sum += at_azimuth(rings[j], phi + kPi - std::asin(b / inner));
  }
  return sum;
}

class MassConserved : public ::testing::TestWithParam<CrossSection> {};

TEST_P(MassConserved, DepthIntegratesToTheStrands) {
  // Independent of records, angles and rings: depth integrated across the cluster is the mass of its strands, whatever
  // the shape of the ellipse and the direction of view (HARD_CASES 12).
  Cluster cluster = straight_cluster(GetParam());
  fill_disk(cluster, 300);
  BakeSettings bake;
  bake.samples = 32;
  const Scene scene(style_of(std::move(cluster)), bake);
  const CrossSection s = scene.model.instances[0].swept.cross_sections[4];
  for (const float a : {0.0F, 0.9F, 2.3F, 4.0F}) {
    const glm::vec3 towards{std::cos(a), 0.0F, std::sin(a)};
    const SweptCluster& swept = scene.model.instances[0].swept;
    const PlateDirection d = plate_direction(swept.frames[4], s, towards);
    std::vector<std::vector<float>> rings;
    for (int j = 0; j < 4; ++j) rings.push_back(scene.depth(j, 4, towards));
    double sum = 0;
    constexpr int kRays = 4000;
    for (int i = 0; i < kRays; ++i) {
      sum += static_cast<double>(
          depth_through(rings, scene.model.division, d.phi, 2.0F * (static_cast<float>(i) + 0.5F) / kRays - 1.0F));
    }
    // A disk-space impact parameter b lies det(S) |S^-1 d| b from the axis across the view.
    const double across = 2.0 / kRays * static_cast<double>(s.determinant() * d.stretch);
    const double mass = static_cast<double>(scene.model.mass_per_area[4 * 4 + 2] * s.determinant());
    // 3 %: sectors are taken as parallelograms (the ring's arc within +-1 spacing), and M differs by layer.
    EXPECT_NEAR(sum * across / (300 * mass), 1.0, 0.03) << "view " << a;
  }
}

INSTANTIATE_TEST_SUITE_P(Ellipses, MassConserved,
                         ::testing::Values(CrossSection{.01F, 0, .01F}, CrossSection{.01F, 0, .005F},
                                           cross_section({.01F, .002F, 0}), cross_section({.01F, .004F, .8F})));

TEST(Maps, RotatedEllipseLooksTheSameFromTheRotatedEye) {
  // HARD_CASES 12: turning cross-section, strands and eye together changes nothing but where u begins.
  Cluster plain = straight_cluster(cross_section({.01F, .004F, 0}));
  fill_disk(plain, 120);
  const float turn = 2 * kPi / 24 * 5;  // whole sectors of the outermost ring
  Cluster turned = straight_cluster(cross_section({.01F, .004F, turn}));
  for (std::size_t i = 0; i < plain.strand_count(); ++i) {
    const DiskPoint p = plain.strand(i).front();
    add_strand(turned, std::hypot(p.x, p.y), std::atan2(p.y, p.x) + turn);
  }
  const Scene a(style_of(std::move(plain))), b(style_of(std::move(turned)));
  const Frame& frame = a.model.instances[0].swept.frames[4];
  const auto view = [&](float angle) { return std::cos(angle) * frame.normal + std::sin(angle) * frame.binormal; };
  const auto ring_a = a.depth(3, 4, view(0.4F)), ring_b = b.depth(3, 4, view(0.4F + turn));
  const std::size_t shift = ring_a.size() / 24 * 5;
  for (std::size_t x = 0; x < ring_a.size(); ++x) {
    EXPECT_NEAR(ring_b[(x + shift) % ring_b.size()], ring_a[x], 2e-3F * (0.1F + ring_a[x])) << x;
  }
}

TEST(Maps, AreFiniteAndContinuousAroundTheAxis) {
  // HARD_CASES 14: view or light along the axis. One texel of alpha is 1/1023; around the axis a move of 1e-3 rad may
  // change alpha by no more than a few of them, however the azimuth turns.
  Cluster cluster = straight_cluster({.01F, 0, .006F});
  fill_disk(cluster, 100);
  const Scene scene(style_of(std::move(cluster)));
  std::vector<Texel> last;
  for (int i = 0; i <= 16; ++i) {
    const float a = 2 * kPi * static_cast<float>(i) / 16;
    MapRequest request;
    request.eye = {1e-3F * std::cos(a) * (i > 0 ? 1.0F : 0.0F), 2.0F, 1e-3F * std::sin(a)};
    request.to_light = glm::normalize(glm::vec3(1e-3F * std::cos(a), 1, 1e-3F * std::sin(a)));
    const auto texels = scene.maps(request);
    for (std::size_t t = 0; t < texels.size() && !last.empty(); ++t) {
      const TexelValues now = unpack_texel(texels[t]), before = unpack_texel(last[t]);
      ASSERT_NEAR(now.alpha, before.alpha, 4.0F / 1023) << "step " << i << " texel " << t;
      ASSERT_NEAR(now.re, before.re, 0.02F) << "step " << i << " texel " << t;
    }
    last = texels;
  }
}

TEST(Maps, PaperShadowIsTheExponentialOfEq12) {
  // HARD_CASES 17: 1 - sum of alpha would go negative; exp stays in (0, 1], decreases inwards, and one layer shadows
  // itself by half.
  for (const int layers : {1, 4}) {
    Cluster cluster = straight_cluster({.004F, 0, .004F});
    fill_disk(cluster, 2000);
    const Scene scene(style_of(std::move(cluster), {layers, 24, 4, 0.1F}));
    MapRequest request;
    request.eye = {1, -0.1F, 0};
    request.to_light = {0, 0, 1};
    request.settings.self_shadow = SelfShadow::paper;
    request.settings.self_shadow_strength = 2.0F;
    const auto texels = scene.maps(request);
    for (std::size_t x = 0; x < static_cast<std::size_t>(scene.model.layout.widths[0]); ++x) {
      const TexelValues inner = unpack_texel(texels[scene.model.layout.texel(0, 0, 2) + x]);
      EXPECT_GT(inner.transmittance, 0.0F);
      EXPECT_LE(inner.transmittance, 1.0F);
      if (layers == 1) {
        EXPECT_NEAR(inner.transmittance, std::exp(-inner.alpha), 2e-3F);
      } else {
        EXPECT_LT(inner.transmittance, 0.9F);
      }
    }
  }
}

TEST(Maps, NoStrandsAreTransparentAndManyAreOpaque) {
  // HARD_CASES 10, 17, 18: alpha 0 and alpha 1 everywhere.
  const MapRequest request{{1, -0.1F, 0}, {0, 0, 1}, {}};
  const Scene empty(style_of(straight_cluster({.01F, 0, .01F})));
  for (const Texel t : empty.maps(request)) EXPECT_EQ(unpack_texel(t).alpha, 0.0F);
  Cluster cluster = straight_cluster({.001F, 0, .001F});
  fill_disk(cluster, 10'000);
  const Scene full(style_of(std::move(cluster), {2, 12, 2, 0.1F}));
  const auto texels = full.maps(request);
  const std::size_t first = full.model.layout.texel(0, 1, 1);
  const auto width = static_cast<std::size_t>(full.model.layout.widths[1]);
  // Towards the eye (+x = azimuth 0) the ring is opaque; alpha never leaves [0, 1].
  EXPECT_GT(unpack_texel(texels[first]).alpha, 0.999F);
  EXPECT_GT(unpack_texel(texels[first + width / 2]).alpha, 0.999F);
}

TEST(Maps, OfFoldsAndOverlappingPlatesAreFiniteAndBounded) {
  // HARD_CASES 15: there and back on one line, a hairpin, and bends tighter than the cross-section is wide.
  const std::vector<std::vector<glm::vec3>> lines{
      {{0, 0, 0}, {0, -.1F, 0}, {0, -.2F, 0}, {0, -.1F, 0}, {0, 0, 0}},
      {{0, 0, 0}, {0, -.1F, 0}, {0, -.2F, 0}, {1e-6F, -.2F, 0}, {1e-6F, -.1F, 0}, {1e-6F, 0, 0}},
      {{0, 0, 0}, {0, -.02F, 0}, {.01F, -.02F, 0}, {.01F, 0, 0}},
      {{0, 0, 0}, {.01F, -.01F, 0}, {0, -.02F, 0}, {.01F, -.03F, 0}, {0, -.04F, 0}}};
  int overlapping = 0;
  for (const std::vector<glm::vec3>& line : lines) {
    Cluster cluster = straight_cluster({.02F, 0, .015F});
    cluster.centre_line = line;
    cluster.first_normal = {0, 0, 1};
    fill_disk(cluster, 60);
    const Scene scene(style_of(std::move(cluster), {3, 12, 16, 0.1F}));
    overlapping += overlapping_plates(scene.model.instances[0].swept);
    for (const SelfShadow shadow : {SelfShadow::light, SelfShadow::paper}) {
      for (const glm::vec3 eye : {glm::vec3(0.5F, 0.1F, 0.3F), glm::vec3(0, -0.05F, 0), glm::vec3(0, 1, 0)}) {
        MapRequest request{eye, glm::normalize(glm::vec3(0.2F, 1, 0)), {}};
        request.settings.self_shadow = shadow;
        float most = 0;
        for (const Texel t : scene.maps(request)) {
          const TexelValues v = unpack_texel(t);
          ASSERT_TRUE(v.alpha >= 0 && v.alpha <= 1 && v.re >= 0 && v.re <= 8 && v.transmittance >= 0 &&
                      v.transmittance <= 1);
          most = std::max(most, v.alpha);
        }
        EXPECT_GT(most, 0.1F) << "hair is there";
      }
    }
  }
  EXPECT_GT(overlapping, 10);
}

TEST(Maps, AreTheSameBytesForAnyNumberOfThreads) {
  Hairstyle style = style_of(straight_cluster({.01F, 0, .008F}));
  fill_disk(style.clusters[0], 80, 1.0F);
  for (int i = 0; i < 5; ++i) style.clusters.push_back(style.clusters[0]);
  const Scene scene(std::move(style));
  const MapRequest request{{1, -0.1F, 0.3F}, {0, 0.6F, 0.8F}, {}};
  std::vector<Texel> reference;
  for (const std::size_t threads : {1U, 2U, 3U, 8U}) {
    const tbb::global_control limit(tbb::global_control::max_allowed_parallelism, threads);
    const auto texels = scene.maps(request);
    if (reference.empty()) reference = texels;
    EXPECT_EQ(texels, reference) << threads << " threads";
  }
}

TEST(Model, RefusesSamplesThatCannotTileARing) {
  EXPECT_THROW(make_model(style_of(straight_cluster({.01F, 0, .01F})), BakeSettings{}, 30), InputError);
}

TEST(Model, RefusesADivisionOfNothing) {  // HARD_CASES 17: no layers
  for (const Division& none : {Division{0, 24, 8, 0.1F},
                               {-1, 24, 8, 0.1F},
                               {4, 0, 8, 0.1F},
                               {4, 24, 0, 0.1F},
                               {4, 24, 8, -0.1F},
                               {4, 24, 8, 1.0F},
                               {4, 24, 8, NAN}}) {
    EXPECT_THROW(make_model(style_of(straight_cluster({.01F, 0, .01F}), none), BakeSettings{}, 32), InputError)
        << none.layers << ' ' << none.sectors << ' ' << none.plates << ' ' << none.core;
  }
}

TEST(Model, InstancesCarryTheirTransform) {
  Hairstyle style = style_of(straight_cluster({.01F, 0, .01F}));
  glm::mat4 move{2.0F};
  move[3] = {1, 2, 3, 1};
  style.clusters[0].transforms = {glm::mat4(1.0F), move};
  const auto instances = instances_of(style);
  ASSERT_EQ(instances.size(), 2U);
  EXPECT_NEAR(instances[1].swept.length_m, 2 * instances[0].swept.length_m, 1e-5F);
  EXPECT_NEAR(instances[1].swept.cross_sections[0].xx, 0.02F, 1e-6F);
  EXPECT_LT(glm::distance(instances[1].swept.frames[0].position, glm::vec3(1, 2, 3)), 1e-5F);
}

}  // namespace
}  // namespace pelage::test
