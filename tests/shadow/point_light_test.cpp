// Point lights through the density map's frustums (hard case 4).
#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <glm/geometric.hpp>
#include <random>

#include "fixture.h"
#include "pelage/data_schema/errors.h"
#include "pelage/shadow/density_map.h"

namespace pelage {
namespace {

using test::clumped_hair;
using test::light_at;
using test::light_from;

TEST(PointLight, FarAwayIsDirectional) {
  const Strands hair = clumped_hair(800);
  const glm::vec3 towards = glm::normalize(glm::vec3(0.3F, 0.8F, 0.4F));
  const DensityMap parallel({}, hair, 0.5F, light_from(towards));
  double last = 1;
  for (const float distance : {1.0F, 10.0F, 100.0F, 1e4F, 1e6F}) {
    const DensityMap point({}, hair, 0.5F, light_at(distance * towards));
    double square = 0;
    for (const glm::vec3& p : hair.vertices) {
      const double d = double(point.transmittance(p)) - double(parallel.transmittance(p));
      square += d * d;
    }
    const double rms = std::sqrt(square / static_cast<double>(hair.vertices.size()));
    EXPECT_LE(rms, last + 1e-3);
    last = rms;
  }
  // At 100 m rays differ by 1 mrad over 10 cm: a tenth of a millimetre; cells lie elsewhere all the same, and are
  // not averaged over a footprint.
  EXPECT_LT(last, 0.04);
}

/// Fibres on a sphere of 10 cm around the light, each tangential: depth a D len / (4 pi r^2) in every direction.
Strands shell(int count, float radius_m) {
  Strands s;
  s.diameter_m = 1e-4F;
  std::mt19937 random(3);
  std::normal_distribution<float> normal;
  for (int i = 0; i < count; ++i) {
    const glm::vec3 at = glm::normalize(glm::vec3(normal(random), normal(random), normal(random)));
    const glm::vec3 along = glm::normalize(glm::cross(at, glm::vec3(normal(random), normal(random), normal(random))));
    s.append(std::array{radius_m * at - 0.005F * along, radius_m * at + 0.005F * along});
  }
  return s;
}

TEST(PointLight, InsideTheHairSeesAllAround) {
  constexpr int kCount = 40'000;
  constexpr double kRadius = 0.1;
  const Strands hair = shell(kCount, static_cast<float>(kRadius));
  DensityMapSettings settings;
  settings.resolution = 8;  // 70 fibres to a cell at the edges of the cube, where it is smallest: 12 % noise
  for (const glm::vec3 light : {glm::vec3(0), glm::vec3(1e-3F, -2e-3F, 5e-4F)}) {
    const DensityMap map(settings, hair, 0.5F, light_at(light));
    const double depth = kCount * 0.5 * 1e-4 * 0.01 / (4 * 3.14159265 * kRadius * kRadius);
    std::mt19937 random(5);
    std::normal_distribution<float> normal;
    double sum = 0;
    for (int i = 0; i < 2000; ++i) {
      const glm::vec3 d = glm::normalize(glm::vec3(normal(random), normal(random), normal(random)));
      EXPECT_GT(map.transmittance(light + 0.05F * d), 0.97F) << "before the shell";
      const double behind = double(map.optical_depth(light + 0.13F * d));
      EXPECT_NEAR(behind, depth, 0.4 * depth) << d.x << ' ' << d.y << ' ' << d.z;
      sum += behind;
    }
    EXPECT_NEAR(sum / 2000, depth, 0.01 * depth + 0.05 * depth * (light.x != 0));
  }
}

TEST(PointLight, CountsVerticesAllAround) {
  // As printed: two vertices a fibre, at a mean sine of pi / 4 for what is tangential here.
  constexpr int kCount = 40'000;
  constexpr double kRadius = 0.1;
  const Strands hair = shell(kCount, static_cast<float>(kRadius));
  DensityMapSettings settings = DensityMapSettings::printed();
  settings.resolution = 8;
  const DensityMap map(settings, hair, 0.5F, light_at(glm::vec3(0)));
  const double depth = 0.785 * kCount * 0.5 * 1e-4 * 0.01 / (4 * 3.14159265 * kRadius * kRadius);
  double sum = 0;
  for (const float x : {-1.0F, 1.0F}) {
    for (int axis = 0; axis < 3; ++axis) {
      glm::vec3 d(0.05F);
      d[axis] = x;
      EXPECT_GT(map.transmittance(0.05F * d), 0.97F) << "before the shell";
      sum += double(map.optical_depth(0.15F * d)) / 6;
    }
  }
  // Where faces look straight at the shell their cells are the paper's; 250 vertices in each.
  EXPECT_NEAR(sum, depth, 0.15 * depth);
}

TEST(PointLight, ShadowIsContinuousFromFaceToFace) {
  const Strands hair = shell(40'000, 0.1F);
  DensityMapSettings settings;
  settings.resolution = 24;
  const DensityMap map(settings, hair, 0.5F, light_at(glm::vec3(0)));
  // Cells of two faces meet at the edge of the cube under other shapes: noise of 3 % of a depth of 1.6.
  double most = 0;
  for (float z = -0.09F; z < 0.09F; z += 0.004F) {
    const double a = double(map.transmittance({0.1F, 0.1001F, z})), b = double(map.transmittance({0.1001F, 0.1F, z}));
    most = std::max(most, std::abs(a - b));
  }
  EXPECT_LT(most, 0.05);
}

TEST(PointLight, NothingGetsThroughAFibreAtTheLight) {
  Strands hair;
  hair.diameter_m = 1e-3F;
  hair.append(std::array{glm::vec3(-0.01F, 0, 0), glm::vec3(0.01F, 0, 0)});
  const glm::vec3 light(0, 1e-3F, 0);  // the fibre covers 53 degrees
  for (const bool spread : {true, false}) {
    DensityMapSettings settings;
    settings.trilinear_deposit = spread;
    const DensityMap map(settings, hair, 1.0F, light_at(light));
    float darkest = 1;  // its middle is between two rows of cells, and spread into both
    for (int i = -500; i <= 500; ++i)
      darkest = std::min(darkest, map.transmittance({0, -0.1F, 1e-5F * static_cast<float>(i)}));
    EXPECT_LT(darkest, 0.01F);  // half a step away from the row's middle: cells are 1.6 mm here
    if (spread) {
      EXPECT_LT(map.transmittance({0, -0.1F, 0}), 1e-3F);
    }
    EXPECT_EQ(map.transmittance({0, 0.1F, 0}), 1.0F);
  }
}

TEST(PointLight, OddPlacesGiveFiniteShadows) {
  const Strands hair = clumped_hair(100);
  DensityMapSettings settings;
  settings.resolution = 16;
  const std::vector<glm::vec3> places{hair.vertices[5],                              // at a vertex
                                      0.5F * (hair.vertices[5] + hair.vertices[6]),  // on a fibre
                                      glm::vec3(0), glm::vec3(0, 1e4F, 0), glm::vec3(1e-8F)};
  for (const glm::vec3& place : places) {
    const DensityMap map(settings, hair, 0.5F, light_at(place));
    for (const glm::vec3& p : hair.vertices) {
      const float t = map.transmittance(p);
      ASSERT_TRUE(t >= 0 && t <= 1) << t;
    }
    ASSERT_TRUE(std::isfinite(map.transmittance(place)));
  }
  EXPECT_THROW(DensityMap(settings, hair, 0.5F, light_at({NAN, 0, 0})), InputError);
  const Strands none;
  EXPECT_EQ(DensityMap(settings, none, 0.5F, light_at({0, 1, 0})).transmittance(glm::vec3(0)), 1.0F);
}

}  // namespace
}  // namespace pelage
