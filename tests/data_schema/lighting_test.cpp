// Lightings by name, and the places that stand for the disc of a light of some size.
#include "pelage/data_schema/lighting.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <glm/geometric.hpp>
#include <glm/trigonometric.hpp>

namespace pelage {
namespace {

TEST(Lighting, PaperIsWhatASceneHasThatSaysNothing) {
  Scene scene;
  scene.material.ambient = 0.5F;
  scene.image.exposure = 3;
  const std::string before = to_json(scene);
  set_lighting(scene, Lighting::portrait);
  EXPECT_NE(to_json(scene), before);
  set_lighting(scene, Lighting::paper);
  EXPECT_EQ(to_json(scene), before) << "nothing but lights, background and backdrop is set";
}

TEST(Lighting, PortraitIsASceneFileThatReadsBack) {
  Scene scene;
  scene.hair = "x.hair";
  set_lighting(scene, Lighting::portrait);
  ASSERT_EQ(scene.lights.size(), 3U) << "one more than three is left to --set or a file";
  const Scene again = scene_from_json(to_json(scene), "text");
  EXPECT_EQ(again.lights, scene.lights);
  EXPECT_EQ(again.image, scene.image);
  EXPECT_EQ(again.image.backdrop, Backdrop::gradient);
}

TEST(LightParts, OfALightWithoutSizeAreTheLightItself) {
  Light point;
  point.position = glm::vec3(1, 2, 3);
  point.size_deg = 20;
  for (const Light& light : {Light{}, point}) {
    ASSERT_EQ(parts_of(light).size(), 1U);
    EXPECT_EQ(parts_of(light)[0], light);
  }
}

/// Angle between a light's direction and another's [degrees].
double angle_deg(const Light& a, const Light& b) {
  const glm::dvec3 x = glm::normalize(glm::dvec3(a.direction)), y = glm::normalize(glm::dvec3(b.direction));
  return glm::degrees(std::atan2(glm::length(glm::cross(x, y)), glm::dot(x, y)));
}

TEST(LightParts, LieWithinTheDiscAndAroundItsMiddle) {
  for (const glm::vec3& direction : {glm::vec3(0.4F, 0.7F, 0.6F), glm::vec3(0, 5, 0), glm::vec3(-1e-3F, 0, 0)}) {
    Light light;
    light.direction = direction;
    light.colour = {1, 0.5F, 0.25F};
    light.size_deg = 20;
    glm::dvec3 sum(0);
    double farthest = 0;
    for (const Light& part : parts_of(light)) {
      EXPECT_EQ(part.size_deg, 0.0F);
      EXPECT_EQ(part.colour, light.colour);
      EXPECT_EQ(part.intensity, light.intensity) << "they are averaged, not summed";
      farthest = std::max(farthest, angle_deg(part, light));
      sum += glm::dvec3(part.direction);
    }
    EXPECT_LT(farthest, 10);
    EXPECT_GT(farthest, 9) << "the outermost of eight equal areas lies at .97 of the radius";
    Light middle;
    middle.direction = glm::vec3(sum);
    EXPECT_LT(angle_deg(middle, light), 0.8) << "eight places lean a little; .08 of the radius";
    EXPECT_NEAR(angle_deg(part_of(light, {1, 0}), light), 10, 1e-4) << "the edge";
    EXPECT_NEAR(angle_deg(part_of(light, {0, 0}), light), 0, 1e-4);
  }
}

}  // namespace
}  // namespace pelage
