// The truth's rays and the rasteriser's matrices are one projection.
#include <gtest/gtest.h>

#include <glm/mat4x4.hpp>
#include <glm/vec4.hpp>

#include "pelage/reference/truth_image.h"
#include "pelage/render/camera.h"
#include "sample_hair.h"

namespace pelage {
namespace {

TEST(TruthCamera, ProjectsAsTheRasteriserDoes) {
  sample::Random random(1);
  for (int i = 0; i < 200; ++i) {
    Camera camera;
    camera.eye = glm::vec3(random.in_cube(2));
    camera.target = camera.eye + glm::vec3(random.in(0.1, 3) * random.direction());
    if (i % 5 == 0) camera.target = camera.eye + glm::vec3(0, i % 2 == 0 ? 1 : -1, 0);  // along up
    camera.fov_deg = static_cast<float>(random.in(1, 160));
    const int width = 1 + static_cast<int>(random.in(0, 2000)), height = 1 + static_cast<int>(random.in(0, 2000));
    const TruthCamera truth(camera, width, height);
    const double x = random.in(0, width), y = random.in(0, height), depth = random.in(0.5, 3);
    const FibreRay ray = truth.ray(x, y);
    const glm::dvec3 p = ray.origin + depth * ray.direction;
    Bounds bounds;
    bounds.add(glm::vec3(p) - 0.1F);
    bounds.add(glm::vec3(p) + 0.1F);
    const float aspect = static_cast<float>(width) / static_cast<float>(height);
    const glm::vec4 clip = world_to_clip(camera, bounds, aspect) * glm::vec4(glm::vec3(p), 1.0F);
    // Float matrices: 2e-6 of the picture where the view is as wide as far, more the narrower it is, and than a pixel.
    const double tolerance =
        4e-6 * std::max(width, height) / std::tan(0.5 * double(camera.fov_deg) * std::numbers::pi / 180);
    EXPECT_NEAR((double(clip.x / clip.w) * 0.5 + 0.5) * width, x, std::max(tolerance, 4e-6 * width)) << i;
    EXPECT_NEAR((0.5 - double(clip.y / clip.w) * 0.5) * height, y, std::max(tolerance, 4e-6 * height)) << i;
  }
}

}  // namespace
}  // namespace pelage
