// Drawing orders [Xu2006 eq. 14, DESIGN section 5]: patches sorted, clusters in layers, and exact per pixel.
#include <epoxy/gl.h>
#include <algorithm>
#include <random>
#include <set>

#include "fixture.h"
#include "pelage/render/gl_objects.h"
#include "pelage/satf/maps.h"

namespace pelage {
namespace {

/// A hairstyle drawn by the Renderer itself, with an order of the test's own.
struct Scene {
  explicit Scene(const Hairstyle& style) {
    const BakeSettings bake = test::small_bake();
    DirectSource source(bake);
    model = make_model(style, bake, source.samples());
    source.attach(model.sectors);
    surfaces = make_surfaces(model);
    renderer.set_hair(model, style.clusters);
    renderer.set_surfaces(surfaces);
    std::vector<Texel> texels(model.texels());
    build_maps(model, source, {frame.camera.eye, glm::normalize(frame.lights[0].direction), frame.satf}, {}, texels);
    renderer.set_texels(texels);
    for (const SurfaceVertex& v : surfaces.vertices) bounds.add(v.position);
  }
  std::vector<std::uint32_t> indices(DrawOrder order) const {
    return ordered_indices(surfaces, model.division, order, frame.camera.eye);
  }
  Image draw(DrawOrder order, std::span<const std::uint32_t> triangles) {
    renderer.set_order(triangles);
    Framebuffer target(96, 96, GL_RGBA16F, true);
    DrawRequest request{world_to_clip(frame.camera, bounds, 1), frame.camera.eye, frame.lights, frame.material,
                        frame.satf};
    request.settings.draw_order = order;
    renderer.draw(request, target);
    Image image(96, 96);
    output.read(target, 1, image, 0, 0);
    return test::checked(std::move(image));
  }
  Image draw(DrawOrder order) { return draw(order, indices(order)); }

  FrameSettings frame = test::front_view();
  SatfModel model;
  HairSurfaces surfaces;
  Bounds bounds;
  Renderer renderer;
  PictureOutput output{GL_RGBA16F};
};

class Order : public test::WithOpenGl {};

TEST_F(Order, ExactDoesNotDependOnTheOrderOfPatches) {
  Scene scene(test::three_locks());
  const auto in_order = scene.indices(DrawOrder::exact);
  const Image reference = scene.draw(DrawOrder::exact, in_order);
  EXPECT_GT(test::coverage(reference), 0.05);
  std::mt19937 random(1);
  for (int round = 0; round < 3; ++round) {
    std::vector<std::size_t> patches(in_order.size() / 6);
    for (std::size_t i = 0; i < patches.size(); ++i) patches[i] = i;
    std::shuffle(patches.begin(), patches.end(), random);
    std::vector<std::uint32_t> shuffled;
    for (const std::size_t p : patches)
      shuffled.insert(shuffled.end(), in_order.begin() + std::ptrdiff_t(6 * p),
                      in_order.begin() + std::ptrdiff_t(6 * p + 6));
    const Image image = scene.draw(DrawOrder::exact, shuffled);
    EXPECT_EQ(image.rgba, reference.rgba) << "largest difference " << test::difference(image, reference).most;
  }
}

TEST_F(Order, ClustersIsExactForOneConvexCluster) {
  Scene scene(test::straight_lock());
  const Image exact = scene.draw(DrawOrder::exact), clusters = scene.draw(DrawOrder::clusters);
  const test::Difference d = test::difference(exact, clusters);
  std::printf("clusters against exact, one convex cluster: rms %.2g, most %.2g\n", d.rms, d.most);
  // Lists hold half floats and one target rounds after each layer: 6 layers of 2^-11. A faceted ring is not quite
  // convex layer by layer: single pixels at the silhouette differ by a swap of two layers.
  EXPECT_LT(d.rms, 2e-3);
  EXPECT_GT(test::difference(exact, scene.draw(DrawOrder::clusters,
                                               [&] {
                                                 auto reversed = scene.indices(DrawOrder::clusters);
                                                 std::vector<std::uint32_t> out;
                                                 for (std::size_t i = reversed.size(); i >= 6; i -= 6)
                                                   out.insert(out.end(), reversed.begin() + std::ptrdiff_t(i - 6),
                                                              reversed.begin() + std::ptrdiff_t(i));
                                                 return out;
                                               }()))
                .rms,
            4 * d.rms)
      << "the order matters in this picture";
}

TEST_F(Order, PatchesIsCloseToExact) {
  Scene scene(test::three_locks());
  const Image exact = scene.draw(DrawOrder::exact);
  const auto patches = test::difference(exact, scene.draw(DrawOrder::patches));
  const auto clusters = test::difference(exact, scene.draw(DrawOrder::clusters));
  std::printf("three locks against exact: patches rms %.2g most %.2g, clusters rms %.2g most %.2g\n", patches.rms,
              patches.most, clusters.rms, clusters.most);
  EXPECT_LT(patches.rms, 0.01);
  EXPECT_LT(clusters.rms, 0.02);
}

TEST_F(Order, EveryOrderDrawsTheSameQuads) {
  Scene scene(test::three_locks());
  const auto all = [&](DrawOrder order) {
    const auto indices = scene.indices(order);
    std::multiset<std::uint32_t> first;
    for (std::size_t i = 0; i < indices.size(); i += 6) first.insert(indices[i]);
    return first;
  };
  // A patch on a silhouette shows both of its quads, or none; the others one.
  const auto quads = static_cast<double>(all(DrawOrder::exact).size());
  EXPECT_NEAR(quads / static_cast<double>(scene.surfaces.patches.size()), 1.0, 0.1);
  EXPECT_EQ(all(DrawOrder::exact), all(DrawOrder::patches));
  EXPECT_EQ(all(DrawOrder::exact), all(DrawOrder::clusters));
}

TEST_F(Order, PatchesGoFromFarToNear) {
  Scene scene(test::three_locks());
  const auto indices = scene.indices(DrawOrder::patches);
  float last = std::numeric_limits<float>::infinity();
  for (std::size_t i = 0; i < indices.size(); i += 6) {
    glm::vec3 centre{0.0F};
    for (const std::size_t k : {i, i + 1, i + 2, i + 5}) centre += 0.25F * scene.surfaces.vertices[indices[k]].position;
    const float far_m = glm::length(centre - scene.frame.camera.eye);
    ASSERT_LE(far_m, last + 1e-6F);
    last = far_m;
  }
}

}  // namespace
}  // namespace pelage
