// Small hand-made hair and one headless context for the tests of the renderer.
#pragma once

#include <gtest/gtest.h>

#include <cmath>
#include <glm/ext/matrix_transform.hpp>
#include <memory>
#include <optional>

#include "pelage/bake/direct_source.h"
#include "pelage/data_schema/errors.h"
#include "pelage/data_schema/procedural_strands.h"
#include "pelage/image/tone.h"
#include "pelage/render/gl_context.h"
#include "pelage/render/satf_frame.h"

namespace pelage::test {

/// Skips, visibly, where there is no OpenGL.
class WithOpenGl : public ::testing::Test {
 protected:
  void SetUp() override {
    try {
      context_.emplace();
    } catch (const GraphicsError& error) {
      GTEST_SKIP() << error.what();
    }
  }

 private:
  std::optional<HeadlessContext> context_;
};

inline BakeSettings small_bake() {
  BakeSettings bake;
  bake.grid = 16;
  bake.views = bake.lights = 8;
  bake.samples = 16;
  bake.sectors = 60;
  return bake;
}

/// A lock that hangs from `root` down, 20 cm long and 2 cm thick.
inline Cluster lock(glm::vec3 root, float bend_m, std::size_t strands = 150, std::uint64_t seed = 1) {
  Cluster c;
  for (int i = 0; i < 5; ++i) {
    const float x = static_cast<float>(i) / 4;
    c.centre_line.push_back(root + glm::vec3(bend_m * std::sin(3.0F * x), -0.2F * x, 0.5F * bend_m * x * x));
  }
  c.cross_sections.assign(4, cross_section({.010F, .008F, .3F}));
  append_procedural_strands(c, strands, StrandDistribution::shell, seed);
  return c;
}

inline Hairstyle style_of(std::vector<Cluster> clusters) {
  Hairstyle style;
  style.name = "test";
  style.division = {3, 8, 6, 0.1F};
  style.diameter_m = 2e-4F;
  style.clusters = std::move(clusters);
  return style;
}

inline Hairstyle three_locks() {
  return style_of({lock({-.03F, .1F, 0}, .01F, 150, 1), lock({0, .1F, .01F}, -.01F, 150, 2),
                   lock({.03F, .1F, -.01F}, .015F, 150, 3)});
}

/// Straight down the y axis, from y = 0.1 to y = -0.1.
inline Hairstyle straight_lock(std::size_t strands = 150) {
  return style_of({lock({0, .1F, 0}, 0, strands)});
}

inline std::unique_ptr<SatfFrame> frame_of(Hairstyle style, Mesh head = {}) {
  const BakeSettings bake = small_bake();
  return std::make_unique<SatfFrame>(std::move(style), std::make_unique<DirectSource>(bake), bake, std::move(head));
}

inline FrameSettings front_view() {
  FrameSettings frame;
  frame.camera.eye = {0, 0, 0.6F};
  frame.camera.target = {0, 0, 0};
  frame.lights = {Light{}};
  frame.satf.shadow_resolution = 24;
  return frame;
}

/// A square behind the hair, facing +z, fine enough for shadows by vertex.
inline Mesh wall() {
  constexpr unsigned kSide = 16;
  Mesh m;
  for (unsigned y = 0; y <= kSide; ++y) {
    for (unsigned x = 0; x <= kSide; ++x) {
      const glm::vec2 at = 0.2F / kSide * glm::vec2(static_cast<float>(x), static_cast<float>(y)) - 0.1F;
      m.vertices.emplace_back(at, -0.05F);
      if (x == kSide || y == kSide) continue;
      const unsigned a = y * (kSide + 1) + x, c = a + kSide + 1;
      m.triangles.emplace_back(a, a + 1, c);
      m.triangles.emplace_back(a + 1, c + 1, c);
    }
  }
  m.normals.assign(m.vertices.size(), {0, 0, 1});
  return m;
}

/// Share of pixels with alpha above 0.02.
inline double coverage(const Image& image) {
  std::size_t n = 0;
  for (std::size_t i = 3; i < image.rgba.size(); i += 4) n += image.rgba[i] > 0.02F;
  return 4.0 * static_cast<double>(n) / static_cast<double>(image.rgba.size());
}

inline double mean(const Image& image, std::size_t channel) {
  double sum = 0;
  for (std::size_t i = channel; i < image.rgba.size(); i += 4) sum += static_cast<double>(image.rgba[i]);
  return 4 * sum / static_cast<double>(image.rgba.size());
}

struct Difference {
  double rms = 0, most = 0;
};
inline Difference difference(const Image& a, const Image& b) {
  Difference d;
  for (std::size_t i = 0; i < a.rgba.size(); ++i) {
    const double x = std::abs(static_cast<double>(a.rgba[i]) - static_cast<double>(b.rgba[i]));
    d.rms += x * x;
    d.most = std::max(d.most, x);
  }
  d.rms = std::sqrt(d.rms / static_cast<double>(a.rgba.size()));
  return d;
}

/// The picture; it holds no value that is not finite, and colours and alpha are in range.
inline Image checked(Image image) {
  EXPECT_EQ(remove_non_finite(image), 0U);
  for (std::size_t i = 0; i < image.rgba.size(); ++i) {
    EXPECT_GE(image.rgba[i], 0.0F);
    EXPECT_TRUE(i % 4 != 3 || image.rgba[i] <= 1.0F + 1e-3F) << image.rgba[i];
    if (::testing::Test::HasFailure()) break;
  }
  return image;
}

}  // namespace pelage::test
