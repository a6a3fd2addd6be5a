#include "pelage/render/camera.h"

#include <gtest/gtest.h>

#include <cmath>
#include <glm/geometric.hpp>
#include <glm/vec4.hpp>

#include "pelage/data_schema/errors.h"

namespace pelage {
namespace {

const Bounds kBox{glm::vec3(-.1F, 0, -.1F), glm::vec3(.1F, .3F, .2F)};

glm::vec3 project(const glm::mat4& m, glm::vec3 p) {
  const glm::vec4 c = m * glm::vec4(p, 1);
  return glm::vec3(c) / c.w;
}

TEST(Camera, FramedCameraShowsAllAndFillsThePicture) {
  for (const float aspect : {0.25F, 1.0F, 16.0F / 9, 16384.0F}) {
    const Camera camera = framed_camera(kBox, aspect);
    const glm::mat4 m = world_to_clip(camera, kBox, aspect);
    // Hair fills the ellipsoid in the box; the box's corners, where there is hardly any, may leave by a little.
    const glm::vec3 middle = 0.5F * (kBox.low + kBox.high), half = 0.5F * (kBox.high - kBox.low);
    float most = 0, corners = 0;
    for (int i = 0; i < 27; ++i) {
      const glm::vec3 d(i % 3 - 1, i / 3 % 3 - 1, i / 9 - 1);
      const bool corner = d.x != 0 && d.y != 0 && d.z != 0;
      const glm::vec3 p = project(m, middle + half * d),
                      round = project(m, middle + half * d / std::max(glm::length(d), 1.0F));
      EXPECT_LE(std::abs(p.z), 1.0F) << "between near and far plane";
      most = std::max({most, std::abs(round.x), std::abs(round.y)});
      if (corner) corners = std::max({corners, std::abs(p.x), std::abs(p.y)});
    }
    EXPECT_LE(corners, 1.05F) << aspect;
    EXPECT_LE(most, 1.0F) << aspect;
    EXPECT_GE(most, 0.5F) << aspect;
  }
}

TEST(Camera, EyeAtTheTargetIsRefused) {
  Camera camera;
  camera.eye = camera.target;
  EXPECT_THROW(world_to_clip(camera, kBox, 1), UsageError);
}

TEST(Camera, AnyDirectionAndPlaceGivesAFiniteMatrix) {
  for (const glm::vec3 eye : {glm::vec3(0, 5, 0), glm::vec3(0, -5, 0), glm::vec3(0, 0.15F, 0.01F),
                              glm::vec3(0, 0, 1e6F), glm::vec3(1e-5F, 1, 0)}) {
    for (const Bounds& bounds : {kBox, Bounds{}, Bounds{glm::vec3(0), glm::vec3(0)}}) {
      Camera camera;
      camera.eye = eye;
      const glm::mat4 m = world_to_clip(camera, bounds, 1.5F);
      for (int c = 0; c < 4; ++c)
        for (int r = 0; r < 4; ++r) EXPECT_TRUE(std::isfinite(m[c][r])) << eye.y;
    }
  }
}

}  // namespace
}  // namespace pelage
