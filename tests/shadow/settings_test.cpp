// The density map's settings: the printed one against the paper's text written down (paper_map.h), threads, anchoring,
// slices, footprint, and the texture for the GPU.
#include <gtest/gtest.h>
#include <tbb/global_control.h>
#include <tbb/task_arena.h>

#include <array>
#include <cmath>
#include <glm/ext/quaternion_trigonometric.hpp>
#include <glm/geometric.hpp>
#include <glm/gtc/quaternion.hpp>
#include <random>

#include "fixture.h"
#include "paper_map.h"
#include "pelage/data_schema/errors.h"
#include "pelage/shadow/density_map.h"

namespace pelage {
namespace {

using test::clumped_hair;
using test::light_from;

double mean_difference(const std::vector<float>& a, const std::vector<float>& b) {
  double sum = 0;
  for (std::size_t i = 0; i < a.size(); ++i) sum += std::abs(double(a[i]) - double(b[i]));
  return sum / static_cast<double>(a.size());
}

std::vector<float> read(const HairShadow& shadow, const std::vector<glm::vec3>& points) {
  std::vector<float> t(points.size());
  shadow.transmittance(points, t);
  return t;
}

TEST(PrintedDensityMap, IsThePapersText) {
  // [Bertails2005 sections 2, 3] in whole-number stages on the occupied box, against the same on a torus in floats.
  Strands hair = clumped_hair(400);
  hair.diameter_m = 1e-3F;
  const Light light = light_from({0.3F, 0.8F, 0.5F});
  DensityMapSettings printed = DensityMapSettings::printed();
  printed.resolution = 48;
  const DensityMap map(printed, hair, 0.5F, light);
  const float extent = constant_extent_m(hair), ds = extent / 48;
  double length = 0;
  for (std::size_t s = 0; s < hair.count(); ++s) {
    const auto p = hair.strand(s);
    for (std::size_t i = 1; i < p.size(); ++i) length += double(glm::distance(p[i - 1], p[i]));
  }
  // The calibrated f: a vertex blocks a D times the mean segment, at a mean sine of pi / 4.
  const double f_ds =
      0.5 * double(hair.diameter_m) * length / double(hair.vertices.size()) * 0.785398163 / double(ds * ds);
  const glm::mat3 axes = light_axes(light.direction);
  paper::Map paper{48, ds, static_cast<float>(f_ds), axes[0], axes[1], axes[2], {}, {}};
  std::vector<paper::Vertex> vertices;
  float first = 1e30F;
  for (const glm::vec3& p : hair.vertices) {
    vertices.push_back({p, {}, 0, {}});
    first = std::min(first, glm::dot(p, axes[0]));
  }
  paper.reset();
  paper.fill(vertices);
  paper.transmit(static_cast<int>(std::floor(first / ds)));
  const std::vector<float> ours = read(map, hair.vertices);
  int on_a_face = 0;
  double most = 0;
  for (std::size_t i = 0; i < ours.size(); ++i) {
    const float theirs = paper.filter(hair.vertices[i], static_cast<int>(std::floor(first / ds)));
    // A vertex within rounding of a cell's face may be counted on its other side.
    if (std::abs(ours[i] - theirs) > 1e-4F) ++on_a_face;
    most = std::max(most, std::abs(double(ours[i]) - double(theirs)));
  }
  EXPECT_LT(on_a_face, static_cast<int>(ours.size() / 200));
  EXPECT_LT(most, 0.1) << "one vertex's depth or two";
  EXPECT_GT(mean_difference(ours, std::vector<float>(ours.size(), 1)), 0.3) << "there is shadow at all";
}

TEST(DensityMapThreads, GiveTheSameBits) {
  const Strands hair = clumped_hair(2000);
  std::vector<std::vector<float>> all;
  for (const int threads : {1, 2, 3, 8}) {
    const tbb::global_control limit(tbb::global_control::max_allowed_parallelism, static_cast<std::size_t>(threads));
    tbb::task_arena arena(threads);
    arena.execute([&] {
      const DensityMap map({}, hair, 0.5F, light_from({1, 2, 3}));
      all.push_back(read(map, hair.vertices));
    });
    EXPECT_EQ(all.back(), all.front()) << threads << " threads";
  }
}

TEST(DensityMapThreads, SaturateAlike) {
  // 8,000 fibres as thick as a cell through one point: 31 bits are full long before the last.
  Strands hair;
  hair.diameter_m = 1;
  for (int i = 0; i < 8000; ++i)
    hair.append(std::array{glm::vec3(0), glm::vec3(0, 0, 1e-3F * static_cast<float>(i % 7))});
  std::vector<float> first;
  for (const int threads : {1, 2, 8}) {
    const tbb::global_control limit(tbb::global_control::max_allowed_parallelism, static_cast<std::size_t>(threads));
    tbb::task_arena arena(threads);
    arena.execute([&] {
      DensityMapSettings settings;
      settings.resolution = 4;
      const DensityMap map(settings, hair, 1.0F, light_from({0, 1, 0}));
      std::vector<float> depths;
      for (int i = -10; i < 10; ++i)
        depths.push_back(map.transmittance(1e-3F * static_cast<float>(i) * glm::vec3(1, 1, 1)));
      if (first.empty()) first = depths;
      EXPECT_EQ(depths, first);
      for (const float t : depths) EXPECT_TRUE(t >= 0 && t <= 1) << t;
    });
  }
}

TEST(DensityMapFrame, TurnsWithTheScene) {
  const Strands hair = clumped_hair(800);
  const glm::vec3 towards = glm::normalize(glm::vec3(0.4F, 0.7F, 0.6F));
  DensityMapSettings settings;
  settings.resolution = 40;
  const DensityMap map(settings, hair, 0.5F, light_from(towards));
  const std::vector<float> before = read(map, hair.vertices);
  std::mt19937 random(2);
  std::uniform_real_distribution<float> uniform(-1, 1);
  for (int turn = 0; turn < 6; ++turn) {
    const glm::quat q = glm::normalize(glm::quat(uniform(random), uniform(random), uniform(random), uniform(random)));
    Strands turned = hair;
    for (glm::vec3& p : turned.vertices) p = q * p;
    const DensityMap other(settings, turned, 0.5F, light_from(q * towards));
    // The axes across the light differ, so cells do: as two resolutions differ, by a few hundredths.
    EXPECT_LT(mean_difference(before, read(other, turned.vertices)), 0.02) << turn;
  }
}

TEST(AnchoredDensityMap, DoesNotShimmer) {
  // Shifted by whole cells nothing changes but the rounding of coordinates; around the origin, where indices change
  // sign (hard case 1).
  const Strands hair = clumped_hair(300);
  DensityMapSettings settings;
  settings.fitted = false;
  settings.extent_m = 0.512F;
  settings.resolution = 64;
  const float ds = 0.512F / 64;
  const Light light = light_from({0, -1, 0});
  const DensityMap map(settings, hair, 0.5F, light);
  const std::vector<float> before = read(map, hair.vertices);
  for (const int k : {1, -1, 13, -64, 640}) {
    Strands moved = hair;
    for (glm::vec3& p : moved.vertices) p += static_cast<float>(k) * ds * glm::vec3(1, -1, 1);
    const DensityMap other(settings, moved, 0.5F, light);
    const std::vector<float> after = read(other, moved.vertices);
    const float tolerance = 1e-5F + 1e-7F * static_cast<float>(std::abs(k));
    for (std::size_t i = 0; i < after.size(); ++i) ASSERT_NEAR(after[i], before[i], tolerance) << k;
  }
}

TEST(AnchoredDensityMap, TakesPlacesOnCellFacesAndSignedZeros) {
  DensityMapSettings settings;
  settings.fitted = false;
  settings.resolution = 16;
  settings.extent_m = 0.16F;
  for (const float place : {0.0F, -0.0F, 0.01F, -0.01F, 0.03F + 1e-9F, -0.03F - 1e-9F, 1e-38F, -1e-38F}) {
    Strands hair;
    hair.diameter_m = 0.01F;
    hair.append(std::array{glm::vec3(place, place, -0.05F), glm::vec3(place, place, 0.05F)});
    const DensityMap map(settings, hair, 1.0F, light_from({0, 1, 0}));
    EXPECT_EQ(map.transmittance({place, 1, 0}), 1.0F);
    EXPECT_LT(map.transmittance({place, -1, 0}), 0.75F) << place;
    EXPECT_EQ(map.transmittance({place + 0.05F, -1, 0}), 1.0F);
  }
}

TEST(AnchoredDensityMap, GrowsWithHairThatIsLongerThanTheMap) {
  // Hard case 3: on the paper's torus the ends of this strand would fold onto each other.
  Strands hair;
  hair.diameter_m = 0.01F;
  hair.append(std::array{glm::vec3(-0.5F, 0, 0), glm::vec3(-0.4F, 0, 0)});
  hair.append(std::array{glm::vec3(0.4F, -0.3F, 0), glm::vec3(0.5F, -0.3F, 0)});
  DensityMapSettings settings;
  settings.fitted = false;
  settings.resolution = 32;
  settings.extent_m = 0.32F;
  const DensityMap map(settings, hair, 1.0F, light_from({0, 1, 0}));
  EXPECT_LT(map.transmittance({-0.45F, -0.2F, 0}), 0.7F);
  EXPECT_EQ(map.transmittance({0.45F, -0.2F, 0}), 1.0F) << "the other strand is below";
  settings.extent_m = 1e-4F;
  EXPECT_THROW(DensityMap(settings, hair, 1.0F, light_from({0, 1, 0})), InputError);
}

TEST(DensityMapSlices, EqualContentKeepsTotalsAndPlacesShadowsBetter) {
  // Two thin sheets far apart along the light: even slices are thick, adaptive ones lie where the sheets are.
  Strands hair;
  hair.diameter_m = 1e-4F;
  for (int i = 0; i < 4000; ++i) {
    const float x = -0.05F + 0.1F * static_cast<float>(i % 2000) / 2000, y = i < 2000 ? 0.0F : -0.5F;
    hair.append(std::array{glm::vec3(x, y - 0.002F * static_cast<float>(i % 5), -0.05F),
                           glm::vec3(x, y - 0.002F * static_cast<float>(i % 5), 0.05F)});
  }
  DensityMapSettings even;
  even.resolution = 32;
  DensityMapSettings adaptive = even;
  adaptive.adaptive_slices = true;
  const Light light = light_from({0, 1, 0});
  const DensityMap a(even, hair, 0.5F, light), b(adaptive, hair, 0.5F, light);
  const double total = 2 * 2000 * 0.5 * 1e-4 / 0.1;  // depth of both sheets
  EXPECT_NEAR(double(b.optical_depth({0, -1, 0})), total, 0.05 * total);
  EXPECT_EQ(b.transmittance({0, 1, 0}), 1.0F);
  EXPECT_EQ(b.transmittance({0, 0.1F, 0}), 1.0F);
  // 1 cm behind the first sheet, which is 8 mm thick, all of its shadow should have fallen.
  const double at = total / 2, even_error = std::abs(double(a.optical_depth({0, -0.02F, 0})) - at),
               adaptive_error = std::abs(double(b.optical_depth({0, -0.02F, 0})) - at);
  EXPECT_LT(adaptive_error, 0.05 * total);
  EXPECT_LT(adaptive_error, even_error);
}

TEST(DensityMapSlices, TakeHairThatIsFlatAlongTheLight) {
  Strands hair;
  hair.diameter_m = 0.01F;
  hair.append(std::array{glm::vec3(0, 0, -0.1F), glm::vec3(0, 0, 0.1F)});
  DensityMapSettings even;
  even.resolution = 32;
  DensityMapSettings adaptive = even;
  adaptive.adaptive_slices = true;
  const DensityMap a(even, hair, 1.0F, light_from({0, 1, 0})), b(adaptive, hair, 1.0F, light_from({0, 1, 0}));
  for (float y = -0.05F; y <= 0.05F; y += 1e-3F)
    EXPECT_FLOAT_EQ(b.transmittance({0, y, 0}), a.transmittance({0, y, 0})) << y;
}

TEST(PrintedDensityMap, IsAsWideAsHeadAndTwoStrands) {
  Strands hair;  // [Bertails2005 section 2.2]
  hair.append(std::array{glm::vec3(0), glm::vec3(0, -0.1F, 0), glm::vec3(0, -0.1F, 0.2F)});
  hair.append(std::array{glm::vec3(0.15F, 0.05F, 0), glm::vec3(0.15F, 0, 0)});
  EXPECT_FLOAT_EQ(constant_extent_m(hair), 2 * 0.3F + 0.15F);
}

TEST(PrintedDensityMap, IsCalibratedAnewForOtherHair) {
  const Strands a = clumped_hair(300, 1);
  Strands b = clumped_hair(200, 2);
  for (glm::vec3& p : b.vertices) p *= 0.5F;
  DensityMap reused(DensityMapSettings::printed(), a, 0.5F, light_from({0, 1, 0}));
  reused.build(b, 0.5F, light_from({0, 1, 0}));
  const DensityMap fresh(DensityMapSettings::printed(), b, 0.5F, light_from({0, 1, 0}));
  EXPECT_EQ(read(reused, b.vertices), read(fresh, b.vertices));
}

TEST(PrintedDensityMap, IsOneBeforeTheHair) {
  // Hard case 2: as printed too, nothing comes around the torus from the last slice.
  const Strands hair = clumped_hair(300);
  for (const glm::vec3 towards : {glm::vec3(0, 1, 0), glm::vec3(-1, 0, 0), glm::vec3(0.3F, -0.8F, 0.5F)}) {
    const glm::vec3 light = glm::normalize(towards);
    DensityMapSettings printed = DensityMapSettings::printed();
    printed.resolution = 32;
    const DensityMap map(printed, hair, 0.5F, light_from(light));
    float first = -1e30F;
    for (const glm::vec3& p : hair.vertices) first = std::max(first, glm::dot(p, light));
    for (const glm::vec3& p : hair.vertices) {
      for (const float cells : {2.0F, 5.0F, 40.0F}) {
        const glm::vec3 before = p + (first - glm::dot(p, light) + cells * map.cell_size_m()) * light;
        ASSERT_EQ(map.transmittance(before), 1.0F) << cells;
      }
    }
  }
}

TEST(DensityMapDeposit, TakesWidthsOfVertices) {
  Strands hair;
  hair.append(std::array{glm::vec3(0), glm::vec3(0.1F, 0, 0), glm::vec3(0.1F, 0, 0.2F)});
  hair.append(std::array{glm::vec3(0, 0.1F, 0), glm::vec3(0, 0.1F, 0.1F)});
  hair.diameters_m = {3e-4F, 1e-4F, 2e-4F, 5e-4F, 1e-4F};
  const DensityMap map({}, hair, 0.5F, light_from({0, 1, 0}));
  const double expected = 0.5 * (0.1 * 2e-4 + 0.2 * 1.5e-4 + 0.1 * 3e-4);
  EXPECT_NEAR(map.deposited_area_m2(), expected, 1e-4 * expected);
}

void expect_footprint(bool along_z, bool spread) {
  // One opaque-ish fibre across the light: behind it, T averaged over a disc of radius r has a profile of that width.
  Strands hair;
  hair.diameter_m = 1e-3F;
  hair.append(std::array{glm::vec3(0, 0, -0.1F), glm::vec3(0, 0, 0.1F)});
  for (glm::vec3& p : hair.vertices) p = glm::vec3(along_z ? 0 : p.z, 0, along_z ? p.z : 0);
  // Cells of 0.4 and of 2 mm: in the latter deposit and interpolation have spread the fibre by half as much already.
  for (const int resolution : {512, 100}) {
    DensityMapSettings settings;
    settings.resolution = resolution;
    settings.trilinear_deposit = spread;
    settings.footprint_m = 0.004F;
    const DensityMap map(settings, hair, 0.02F, light_from({0, 1, 0}));
    double sum = 0, first = 0, square = 0;
    for (int i = -200; i <= 200; ++i) {
      const double x = 1e-4 * i,
                   dark = 1 - double(map.transmittance(along_z ? glm::vec3(x, -0.05F, 0) : glm::vec3(0, -0.05F, x)));
      sum += dark;
      first += x * dark;
      square += x * x * dark;
    }
    const double aside = first / sum;  // a fibre that is not spread lies in the middle of its cell
    EXPECT_NEAR(std::sqrt(square / sum - aside * aside), 0.5 * 0.004, spread ? 0.05 * 0.002 : 0.2 * 0.002)
        << "a disc's standard deviation along an axis is r / 2";
    EXPECT_NEAR(aside, 0, spread ? 2e-5 : 0.51 * double(map.cell_size_m())) << "around where it is read";
  }
}

TEST(DensityMapFootprint, AveragesOverItsDiscWhereCellsAreFiner) {
  for (const bool spread : {true, false}) {
    expect_footprint(true, spread);
    expect_footprint(false, spread);
  }
}

TEST(DensityMapTexture, IsWhatTheMapReads) {
  const Strands hair = clumped_hair(500);
  for (int kind = 0; kind < 3; ++kind) {
    const bool depth = kind == 0;
    DensityMapSettings settings = kind == 2 ? DensityMapSettings::printed() : DensityMapSettings{};
    settings.resolution = 32;
    settings.interpolate_depth = depth;
    const DensityMap map(settings, hair, 0.5F, light_from({1, 1, 0.3F}));
    const auto texture = map.depth_texture();
    ASSERT_TRUE(texture.has_value());
    EXPECT_EQ(texture->transmittance, !depth);
    std::mt19937 random(4);
    std::uniform_real_distribution<float> uniform(-0.2F, 0.2F);
    for (int i = 0; i < 500; ++i) {
      const glm::vec3 p{uniform(random), uniform(random), uniform(random)};
      EXPECT_NEAR(test::read_texture(*texture, p), map.transmittance(p), 2e-5F);
    }
  }
}

}  // namespace
}  // namespace pelage
