// The bound that lets self-shadow be skipped: never below what a map of the hair holds.
#include "pelage/shadow/depth_bound.h"

#include <gtest/gtest.h>

#include <cmath>

#include "../shadow/fixture.h"
#include "pelage/data_schema/errors.h"
#include "pelage/shadow/density_map.h"

namespace pelage {
namespace {

constexpr float kAll = 1e9F;

/// Behind all hair, on a raster finer than the map's cells.
float deepest(const DensityMap& map, const Strands& hair, glm::vec3 to_light) {
  const glm::vec3 away = -glm::normalize(to_light);
  float most = 0;
  for (const glm::vec3& p : hair.vertices)
    for (int k = 0; k < 4; ++k)
      most = std::max(most, map.optical_depth(p + away * (k == 0 ? 0.0F : 0.2F * static_cast<float>(k))));
  return most;
}

TEST(DepthBound, NoMapIsDeeper) {
  for (unsigned seed = 1; seed <= 24; ++seed) {
    const Strands hair = test::clumped_hair(20 + 40 * (seed % 5), seed);
    std::mt19937 random(seed);
    std::normal_distribution<float> normal;
    const glm::vec3 light =
        seed % 4 == 0 ? glm::vec3(0, 1, 0) : glm::vec3(normal(random), normal(random), normal(random));
    for (const int resolution : {8, 32, 128}) {
      DensityMapSettings settings;
      settings.resolution = resolution;
      const DensityMap map(settings, hair, 0.6F, test::light_from(light));
      const float bound = greatest_depth(hair, 0.6F, test::light_from(light), resolution, kAll);
      EXPECT_GE(bound, deepest(map, hair, light)) << "seed " << seed << " at " << resolution;
      EXPECT_GT(bound, 0);
    }
  }
}

TEST(DepthBound, NorAreThoseOfTheMethodsItIsComparedWith) {
  for (const Method method : {Method::deep_opacity, Method::opacity_shadow}) {
    ShadowSettings settings;
    settings.opacity_map.resolution = 64;
    const Strands hair = test::clumped_hair(60, 3);
    const glm::vec3 light{0.3F, 1, 0.2F};
    const auto shadow = make_shadow(method, settings, hair, 0.6F, test::light_from(light));
    std::vector<float> through(hair.vertices.size());
    shadow->transmittance(hair.vertices, through);
    const float bound = greatest_depth(hair, 0.6F, test::light_from(light), 64, kAll);
    for (const float t : through) EXPECT_GE(t, std::exp(-bound) - 1e-6F);
  }
}

/// A wisp narrower than a cell, along the light, wherever it lies among the columns: the map may have all of it in one
/// where the bound's are elsewhere.
TEST(DepthBound, NarrowWispsAreNotSplitAmongColumns) {
  std::mt19937 random(9);
  std::uniform_real_distribution<float> any(-0.04F, 0.04F);
  for (int trial = 0; trial < 100; ++trial) {
    Strands hair;
    hair.diameter_m = 1e-4F;
    for (const float x : {-0.05F, 0.05F})  // what the map has to span
      hair.append(std::vector<glm::vec3>{{x, -0.05F, x}, {x, 0.05F, x}});
    const glm::vec3 at{any(random), -0.05F, any(random)};
    for (int i = 0; i < 30; ++i) {
      const glm::vec3 p = at + 4e-4F * glm::vec3(static_cast<float>(i % 6), 0, static_cast<float>(i / 6));
      hair.append(std::vector<glm::vec3>{p, p + glm::vec3(1e-4F, 0.1F, 0)});
    }
    const Light light = test::light_from({0, 1, 0});
    for (const int resolution : {8, 32}) {
      DensityMapSettings settings;
      settings.resolution = resolution;
      const DensityMap map(settings, hair, 0.6F, light);
      EXPECT_GE(greatest_depth(hair, 0.6F, light, resolution, kAll), deepest(map, hair, light.direction))
          << "trial " << trial << " at " << resolution;
    }
  }
}

/// Hair is summed in pieces of 8192 vertices; the one thick segment goes from the last of one to the first of the next.
TEST(DepthBound, NothingIsLostBetweenTwoLooksAtTheSums) {
  const auto bound_of = [](int thick) {
    Strands hair;
    for (int i = 0; i < 4000; ++i) {
      const float x = i == thick ? 0 : 1e-5F * static_cast<float>(i - 2000), d = i == thick ? 1e-3F : 1e-9F;
      hair.append(std::vector<glm::vec3>{{x, 0, 0}, {x, 1e-3F, 0}, {x, 0.1F, 0}});
      hair.diameters_m.insert(hair.diameters_m.end(), {1e-9F, d, d});
    }
    return greatest_depth(hair, 0.6F, test::light_from({1, 0, 0}), 64, kAll);
  };
  EXPECT_NEAR(bound_of(2730), bound_of(5), 0.01F * bound_of(5));
}

TEST(DepthBound, StopsAtTheFirstSumThatIsEnough) {
  const Strands hair = test::clumped_hair(4000);
  const Light light = test::light_from({0, 1, 0});
  const float all = greatest_depth(hair, 0.6F, light, 64, kAll);
  const float some = greatest_depth(hair, 0.6F, light, 64, 0.01F);
  EXPECT_GT(some, 0.01F);
  EXPECT_LT(some, all);  // the rest of the hair was not looked at
}

/// Ten thousand strands that nobody sees, and forty that stand close.
TEST(DepthBound, OneDenseClumpInAnEmptyHeadIsFound) {
  Strands hair;
  hair.diameter_m = 1e-9F;
  for (int i = 0; i < 10000; ++i) {
    const float x = 0.001F * static_cast<float>(i % 100), z = 0.001F * static_cast<float>(i / 100);
    hair.append(std::vector<glm::vec3>{{x, 0, z}, {x + 1e-4F, 0.1F, z}});
  }
  const Light light = test::light_from({0.2F, 0.1F, 1});
  const float thin = greatest_depth(hair, 0.6F, light, 128, kAll);
  EXPECT_LT(thin, 0.01F);
  hair.diameters_m.assign(hair.vertices.size(), 1e-9F);
  for (int i = 0; i < 40; ++i)
    hair.append(std::vector<glm::vec3>{{0.05F, 0.05F, 0.001F * static_cast<float>(i)},
                                       {0.0501F, 0.06F, 0.001F * static_cast<float>(i)}});
  hair.diameters_m.resize(hair.vertices.size(), 1e-4F);
  EXPECT_GT(greatest_depth(hair, 0.6F, light, 128, kAll), 0.05F);
}

TEST(DepthBound, NothingBlocksNothingAndPointLightsHaveNoColumns) {
  Strands none;
  none.diameter_m = 1e-4F;
  EXPECT_EQ(greatest_depth(none, 0.6F, test::light_from({0, 1, 0}), 64, kAll), 0);
  EXPECT_EQ(greatest_depth(test::clumped_hair(5), 0.0F, test::light_from({0, 1, 0}), 64, kAll), 0);
  EXPECT_THROW(greatest_depth(test::clumped_hair(5), 0.6F, test::light_at({0, 1, 0}), 64, kAll), UsageError);
}

}  // namespace
}  // namespace pelage
