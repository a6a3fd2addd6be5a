#include "pelage/render/camera.h"

#include <gtest/gtest.h>

#include <cmath>
#include <glm/geometric.hpp>
#include <glm/vec4.hpp>
#include <span>
#include <vector>

#include "pelage/data_schema/errors.h"

namespace pelage {
namespace {

const Bounds kBox{glm::vec3(-.1F, 0, -.1F), glm::vec3(.1F, .3F, .2F)};

glm::vec3 project(const glm::mat4& m, glm::vec3 p) {
  const glm::vec4 c = m * glm::vec4(p, 1);
  return glm::vec3(c) / c.w;
}

/// Largest distance of a projected point from the middle of the picture, of half its width and of half its height.
glm::vec2 reach(const Camera& camera, std::span<const glm::vec3> points, float aspect) {
  Bounds bounds;
  for (const glm::vec3& p : points) bounds.add(p);
  const glm::mat4 m = world_to_clip(camera, bounds, aspect);
  glm::vec2 most(0);
  for (const glm::vec3& point : points) {
    const glm::vec3 p = project(m, point);
    EXPECT_LE(std::abs(p.z), 1.0F) << "between near and far plane";
    most = glm::max(most, glm::abs(glm::vec2(p)));
  }
  return most;
}

/// A tuft of `count` strands of 8 vertices and 0.1 m at `root`.
Strands tuft(std::size_t count, glm::vec3 root) {
  Strands hair;
  for (std::size_t i = 0; i < count; ++i) {
    std::vector<glm::vec3> strand;
    const float turn = static_cast<float>(i);
    for (int k = 0; k < 8; ++k) {
      const float s = static_cast<float>(k) / 70.0F;
      strand.push_back(root + glm::vec3(0.3F * s * std::cos(turn) + 0.001F * turn, -s, 0.3F * s * std::sin(turn)));
    }
    hair.append(strand);
  }
  return hair;
}

TEST(Camera, FramedCameraLeavesFourPercentOnTheSidesThatArePressed) {
  // Far from the origin, float coordinates have steps of 1e-5 m: 1e-4 of the picture.
  for (const glm::vec3 root : {glm::vec3(0), glm::vec3(50, -20, 30)}) {
    const Strands hair = tuft(40, root);
    for (const float aspect : {0.25F, 1.0F, 16.0F / 9, 100.0F}) {
      const glm::vec2 most = reach(framed_camera(hair.vertices, aspect), hair.vertices, aspect);
      EXPECT_NEAR(std::max(most.x, most.y), 0.92F, 2e-3F) << aspect;
    }
  }
}

TEST(Camera, FramedCameraSeesWhatIsNear) {
  // Perspective: a point towards the eye needs more room than one behind it.
  const std::vector<glm::vec3> points{{0.3F, 0.4F, 0.2F}, {-0.5F, 0, -1}, {0.2F, -0.6F, 0}};
  const glm::vec2 most = reach(framed_camera(points, 1.3F), points, 1.3F);
  EXPECT_NEAR(std::max(most.x, most.y), 0.92F, 1e-3F);
}

TEST(Camera, HairThatPointsAtTheEyeDoesNotDrawItIn) {
  const glm::vec3 towards_eye = glm::normalize(glm::vec3(0.55F, 0.18F, 1));
  const std::vector<glm::vec3> points{-1.0F * towards_eye, glm::vec3(0), 1.0F * towards_eye};
  const Camera camera = framed_camera(points, 1);
  const glm::vec2 most = reach(camera, points, 1);
  EXPECT_LE(std::max(most.x, most.y), 0.92F + 1e-3F);
  EXPECT_GT(glm::distance(camera.eye, points[2]), 0.4F);
}

TEST(Camera, StrayStrandsAreNotFramed) {
  const Strands hair = tuft(100, glm::vec3(0));
  Strands with = hair;
  for (int i = 0; i < 5; ++i) {
    const glm::vec3 away = 500.0F * glm::vec3(std::cos(static_cast<float>(i)), 0.3F, std::sin(static_cast<float>(i)));
    with.append(std::vector<glm::vec3>{hair.vertices[0], away});
  }
  EXPECT_EQ(framed_points(with, {}), hair.vertices);
  // One of two is not stray: nobody could say which.
  Strands two = tuft(1, glm::vec3(0));
  two.append(std::vector<glm::vec3>{glm::vec3(0), glm::vec3(0, -1, 0)});
  EXPECT_EQ(framed_points(two, {}), two.vertices);
}

TEST(Camera, OnlyTheHeadNearTheHairIsFramed) {
  const Strands hair = tuft(40, glm::vec3(0));
  Mesh head;
  head.vertices = {{0, -0.11F, 0}, {0, -1.5F, 0}, {40, 0, 0}};  // below the tips; a foot; something else in the file
  std::vector<glm::vec3> wanted = hair.vertices;
  wanted.push_back(head.vertices[0]);
  EXPECT_EQ(framed_points(hair, head), wanted);
}

TEST(Camera, NothingAndASinglePointAreFramedAllTheSame) {
  for (const std::vector<glm::vec3>& points : {std::vector<glm::vec3>{}, std::vector<glm::vec3>{{1, 2, 3}}}) {
    const Camera camera = framed_camera(points, 1.5F);
    EXPECT_GT(glm::distance(camera.eye, camera.target), 5e-4F);
    EXPECT_LT(glm::distance(camera.target, points.empty() ? glm::vec3(0) : points[0]), points.empty() ? 0.1F : 1e-6F);
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
