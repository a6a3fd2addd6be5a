// Orders of transparent strands: exact against a sort on the CPU, the others against exact, lists in little memory.
#include <algorithm>
#include <chrono>
#include <glm/geometric.hpp>

#include "pelage/render/gl_objects.h"
#include "pelage/render/weighted_blend.h"
#include "strands.h"

namespace pelage {
namespace {

using test::checked;
using test::difference;
using test::unit;

class StrandOrders : public test::WithOpenGl {};

/// Upright and level straps across the view, far from the eye, nearer ones not first.
struct Straps {
  explicit Straps(int count) {
    std::mt19937 random(5);
    strands.diameter_m = 0.012F;
    for (int i = 0; i < count; ++i) {
      // Depths are all different, the order of drawing has nothing to do with them.
      const float z = 0.04F * (static_cast<float>(i * 37 % count) / static_cast<float>(count) - 0.5F);
      const float at = 0.1F * (unit(random) - 0.5F);
      if (i % 2 == 0) {
        strands.append(std::vector<glm::vec3>{{at, -0.1F, z}, {at, 0.1F, z}});
      } else {
        strands.append(std::vector<glm::vec3>{{-0.1F, at, z}, {0.1F, at, z}});
      }
      strands.colours.emplace_back(unit(random), unit(random), unit(random));
    }
    frame.camera = {{0, 0, 20}, {0, 0, 0}, {0, 1, 0}, 0.3F};
    frame.lights = {Light{}};
    test::shade_flat(frame);
  }

  /// Colour at the middle of a pixel; nothing near the edge of a strap.
  std::optional<glm::vec4> expected(int x, int y, int size, float opacity) const {
    const float slope = 2 * std::tan(glm::radians(0.15F)) / static_cast<float>(size);
    std::vector<std::pair<float, std::size_t>> hits;
    for (std::size_t s = 0; s < strands.count(); ++s) {
      const glm::vec3 p = strands.vertices[2 * s];
      const float sample = slope * (20 - p.z), half = 0.5F * static_cast<float>(size);
      const float across = s % 2 == 0 ? (static_cast<float>(x) + 0.5F - half) * sample - p.x
                                      : (half - static_cast<float>(y) - 0.5F) * sample - p.y;
      if (std::abs(std::abs(across) - 0.006F) < 0.1F * sample) return std::nullopt;
      if (std::abs(across) < 0.006F) hits.emplace_back(-p.z, s);
    }
    std::sort(hits.begin(), hits.end());
    glm::vec4 sum(0);
    for (const auto& [depth, s] : hits) sum += (1 - sum.a) * opacity * glm::vec4(strands.colours[s], 1);
    return sum;
  }

  double largest_error(const Image& image, float opacity) const {
    double most = 0;
    int compared = 0;
    for (int y = 0; y < image.height; ++y) {
      for (int x = 0; x < image.width; ++x) {
        const auto e = expected(x, y, image.width, opacity);
        if (!e) continue;
        ++compared;
        for (int c = 0; c < 4; ++c) most = std::max(most, std::abs(double(image.pixel(x, y)[c]) - double((*e)[c])));
      }
    }
    EXPECT_GT(compared, image.width * image.height / 8);
    return most;
  }

  Strands strands;
  StrandFrameSettings frame;
};

TEST_F(StrandOrders, ExactAndSortedEqualASortOnTheCpu) {
  // 200 straps of 5 %: many batches of the resolving pass. 30 of 60 %: it ends early.
  for (const auto& [count, opacity] : {std::pair(30, 0.6F), std::pair(200, 0.05F)}) {
    Straps scene(count);
    StrandFrame frame(scene.strands, opacity, {});
    const double exact = scene.largest_error(checked(frame.render(scene.frame, 64, 64, 1)), opacity);
    scene.frame.strands.order = StrandOrder::sorted;
    const double sorted = scene.largest_error(checked(frame.render(scene.frame, 64, 64, 1)), opacity);
    scene.frame.strands.order = StrandOrder::weighted;
    const double weighted = scene.largest_error(checked(frame.render(scene.frame, 64, 64, 1)), opacity);
    std::printf("%d straps of %g: largest error exact %.2g, sorted %.2g, weighted %.2g\n", count, double(opacity),
                exact, sorted, weighted);
    // Colours are half floats, 2^-12 of each, and what shines through less than 2^-12 is left out.
    EXPECT_LT(exact, 0x1p-11);
    EXPECT_LT(sorted, 1e-5);
    EXPECT_GT(weighted, 1e-2) << "the order matters in this scene";
  }
}

/// Draws by the renderer itself, with lists of a size of the test's own.
Image draw(const Straps& scene, std::span<const StrandSegment> segments, std::size_t most_list_bytes) {
  StrandRenderer renderer(most_list_bytes);
  renderer.set_vertices(strand_vertices(scene.strands), strand_tangents(scene.strands), scene.strands.colours);
  renderer.set_transmittance(std::vector<glm::vec4>(scene.strands.vertices.size(), glm::vec4(1)));
  renderer.set_segments(segments);
  Bounds bounds;
  for (const glm::vec3& p : scene.strands.vertices) bounds.add(p);
  StrandDrawRequest request;
  request.world_to_clip = world_to_clip(scene.frame.camera, bounds, 1);
  request.eye = scene.frame.camera.eye;
  request.lights = scene.frame.lights;
  request.material = scene.frame.material;
  request.opacity = 0.1F;
  request.settings.order = StrandOrder::exact;
  request.shadowed = false;
  Framebuffer target(64, 64, GL_RGBA32F, true);
  for (int i = 0; i < 2; ++i) renderer.draw(request, target);
  Image image(64, 64);
  PictureOutput(GL_RGBA32F).read(target, 1, image, 0, 0);
  return checked(std::move(image));
}

TEST_F(StrandOrders, ExactDoesNotDependOnTheOrderOfDrawing) {
  Straps scene(100);
  // Half of them once more at the same depth, in other colours.
  for (std::size_t s = 0; s < 50; ++s) {
    scene.strands.append(std::vector<glm::vec3>{scene.strands.vertices[2 * s], scene.strands.vertices[2 * s + 1]});
    scene.strands.colours.push_back(scene.strands.colours[s + 50]);
  }
  std::vector<StrandSegment> segments = strand_segments(scene.strands);
  const Image first = draw(scene, segments, FragmentLists::kMostListBytes);
  std::reverse(segments.begin(), segments.end());
  EXPECT_EQ(draw(scene, segments, FragmentLists::kMostListBytes).rgba, first.rgba);
}

TEST_F(StrandOrders, ListsInLittleMemoryGiveTheSamePicture) {
  const Straps scene(100);
  const auto segments = strand_segments(scene.strands);
  const Image whole = draw(scene, segments, FragmentLists::kMostListBytes);
  // About 100 x 64 x 8 fragments of 16 bytes: strips of a few rows, then of one.
  EXPECT_EQ(draw(scene, segments, 200'000).rgba, whole.rgba);
  EXPECT_EQ(draw(scene, segments, 60'000).rgba, whole.rgba);
  EXPECT_THROW(draw(scene, segments, 5'000), GraphicsError) << "one row does not fit";
}

TEST_F(StrandOrders, ErrorOfTheCheaperOrders) {
  struct Case {
    const char* name;
    std::size_t strands;
    float limit_sorted, limit_weighted;
  };
  // Limits: 1.5 times what was measured; relative RMSE over covered pixels.
  for (const Case& c : {Case{"thin lock", 100, 0.05F, 0.6F}, Case{"thick lock", 1500, 0.05F, 0.8F}}) {
    StrandFrame frame(test::strand_lock(c.strands), 0.6F, {});
    StrandFrameSettings settings = test::strands_from_the_front();
    settings.camera.fov_deg = 22;
    const auto timed = [&](StrandOrder order) {
      settings.strands.order = order;
      frame.render(settings, 60, 120, 2);
      const auto start = std::chrono::steady_clock::now();
      Image image = checked(frame.render(settings, 60, 120, 2));
      const std::chrono::duration<double, std::milli> spent = std::chrono::steady_clock::now() - start;
      return std::pair(std::move(image), spent.count());
    };
    const auto relative = [](const Image& a, const Image& b) {
      double squares = 0, sum = 0;
      for (std::size_t i = 0; i < a.rgba.size(); ++i) {
        if (i % 4 == 3 || a.rgba[i | 3] <= 0.02F) continue;
        squares += std::pow(double(a.rgba[i]) - double(b.rgba[i]), 2);
        sum += double(a.rgba[i]);
      }
      double n = 0;
      for (std::size_t i = 3; i < a.rgba.size(); i += 4) n += 3 * (a.rgba[i] > 0.02F);
      return std::sqrt(squares / n) / (sum / n);
    };
    const auto [exact, exact_ms] = timed(StrandOrder::exact);
    const auto [sorted, sorted_ms] = timed(StrandOrder::sorted);
    const auto [weighted, weighted_ms] = timed(StrandOrder::weighted);
    std::printf("%s: exact %.0f ms; sorted %.0f ms, error %.3f; weighted %.0f ms, error %.3f\n", c.name, exact_ms,
                sorted_ms, relative(exact, sorted), weighted_ms, relative(exact, weighted));
    EXPECT_LT(relative(exact, sorted), c.limit_sorted);
    EXPECT_LT(relative(exact, weighted), c.limit_weighted);
    // Opacity needs no order: half floats of the lists, and what is left out behind 1 - 2^-12.
    EXPECT_NEAR(test::mean(sorted, 3), test::mean(exact, 3), 1e-3);
    EXPECT_NEAR(test::mean(weighted, 3), test::mean(sorted, 3), 1e-5);
  }
}

}  // namespace
}  // namespace pelage
