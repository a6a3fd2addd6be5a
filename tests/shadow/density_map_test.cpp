// The light-oriented density map against formulas and through its hard cases (HARD_CASES 1-6, 9).
#include "pelage/shadow/density_map.h"

#include <gmock/gmock.h>

#include <array>
#include <cmath>
#include <glm/geometric.hpp>
#include <limits>
#include <random>

#include "pelage/data_schema/errors.h"

namespace pelage {
namespace {

using ::testing::HasSubstr;

constexpr float kWidth_m = 1e-4F;  // a D

/// A straight piece of hair.
struct Segment {
  glm::vec3 a, b;  // metres
};

/// The corrected map of segments that block `width_m`, one strand each. Deposits are spread and depth is interpolated,
/// so that what is linear can be tested as such, over no footprint but the cells' own.
DensityMap map_of(std::span<const Segment> segments, glm::vec3 to_light, float width_m, int resolution,
                  bool spread = true) {
  Strands strands;
  strands.diameter_m = width_m;
  for (const Segment& s : segments) strands.append(std::array{s.a, s.b});
  DensityMapSettings settings;
  settings.resolution = resolution;
  settings.trilinear_deposit = spread;
  settings.interpolate_depth = true;
  settings.footprint_m = 0;
  return {settings, strands, 1.0F, Light{to_light, {}, glm::vec3(1), 1}};
}
const std::vector<glm::vec3> kAxes{{1, 0, 0}, {-1, 0, 0}, {0, 1, 0}, {0, -1, 0}, {0, 0, 1}, {0, 0, -1}};

/// Short segments everywhere in a box of half side `half_m`.
std::vector<Segment> random_segments(int count, float half_m, unsigned seed = 3) {
  std::mt19937 random(seed);
  std::uniform_real_distribution<float> uniform(-1.0F, 1.0F);
  std::vector<Segment> all;
  for (int i = 0; i < count; ++i) {
    const glm::vec3 a = half_m * glm::vec3(uniform(random), uniform(random), uniform(random));
    all.push_back({a, a + 0.2F * half_m * glm::vec3(uniform(random), uniform(random), uniform(random))});
  }
  return all;
}

double blocked_area(std::span<const Segment> segments, glm::dvec3 to_light) {
  double sum = 0;
  for (const Segment& s : segments)
    sum += double(kWidth_m) * glm::length(glm::cross(glm::dvec3(s.b) - glm::dvec3(s.a), glm::normalize(to_light)));
  return sum;
}

TEST(DensityMap, EmptyMapLetsAllLightThrough) {
  const DensityMap map = map_of({}, {0, 1, 0}, kWidth_m, 16);
  for (const glm::vec3 p : {glm::vec3(0), glm::vec3(1, 2, 3), glm::vec3(-1e30F, 1e30F, 0)})
    EXPECT_EQ(map.transmittance(p), 1.0F);
  EXPECT_EQ(map.deposited_area_m2(), 0.0);
}

/// Fibres that cross the slab 0 <= x <= 2 cm, h thick along the light's x; each makes the angle tilt with the light.
/// E[T] = exp(-a rho D sin(tilt) h) behind it. [NUMBERS.md "Exact"]
void expect_slab(double tilt_rad) {
  constexpr double kThick = 0.02, kHalf = 0.03, kSpacing = 2.5e-4;
  std::mt19937 random(5);
  std::uniform_real_distribution<double> uniform(-0.5, 0.5);
  std::vector<Segment> fibres;
  const bool across = tilt_rad > 1.57;
  // Across: on a lattice of x and y, along z. Tilted: on a lattice of y and z, through the slab from x = 0. Jittered
  // within their lattice cells.
  for (double u = across ? kSpacing / 2 : -kHalf; u < (across ? kThick : kHalf); u += kSpacing) {
    for (double y = -kHalf; y < kHalf; y += kSpacing) {
      const double ju = u + kSpacing * uniform(random), jy = y + kSpacing * uniform(random);
      if (across) {
        fibres.push_back({glm::vec3(glm::dvec3(ju, jy, -kHalf)), glm::vec3(glm::dvec3(ju, jy, kHalf))});
      } else {
        const double rise = kThick * std::tan(tilt_rad);
        fibres.push_back(
            {glm::vec3(glm::dvec3(0, jy, ju - rise / 2)), glm::vec3(glm::dvec3(kThick, jy, ju + rise / 2))});
      }
    }
  }
  const double density = 1 / (kSpacing * kSpacing) / (across ? 1.0 : std::cos(tilt_rad));
  const double expected = std::exp(-double(kWidth_m) * density * std::sin(tilt_rad) * kThick);
  const DensityMap map = map_of(fibres, {-1, 0, 0}, kWidth_m, 48);
  double sum = 0;
  int count = 0;
  for (float y = -0.01F; y <= 0.01F; y += 0.0004F) {
    for (float z = -0.01F; z <= 0.01F; z += 0.0004F) sum += double(map.transmittance({0.5F, y, z})), ++count;
  }
  // About 80 x 80 jittered fibres (across: 80 rows, which alone count) cover the area looked at: jitter moves 1 / 80 of
  // the edge rows in or out, of an optical depth near 32 / sin: relative error of tau <= 1/80 * sqrt(2/12).
  const double tau = -std::log(expected);
  EXPECT_NEAR(-std::log(sum / count), tau, 0.01 * tau) << "tilt " << tilt_rad;
}

TEST(DensityMap, SlabObeysBeerLambert) {
  expect_slab(std::acos(-1.0) / 2);
  expect_slab(1.0);
  expect_slab(0.3);
}

TEST(DensityMap, DepositsTheBlockedAreaWhereverTheLight) {
  // Each of 10,000 segments is rounded to whole quanta, an error of 0.29 quanta each, without bias; float positions and
  // lengths leave 1e-6.
  const auto segments = random_segments(10'000, 0.1F);
  for (const glm::vec3 light : {glm::vec3(0, 1, 0), glm::vec3(1, 2, 3), glm::vec3(-0.6F, 0.8F, 0)}) {
    const double expected = blocked_area(segments, light);
    for (const int resolution : {1, 7, 64}) {
      const DensityMap map = map_of(segments, light, kWidth_m, resolution);
      const double quantum_m2 = double(DepthGrid::kQuantum) * double(map.cell_size_m()) * double(map.cell_size_m());
      const double tolerance = 1e-6 * expected + 4 * 0.29 * 100 * quantum_m2;
      EXPECT_NEAR(map.deposited_area_m2(), expected, tolerance) << resolution;
      EXPECT_LT(resolution == 64 ? tolerance : 0, 1e-5 * expected);
    }
  }
}

TEST(DensityMap, FibreAlongTheLightBlocksNothing) {
  const std::vector<Segment> along{{{0, 0, 0}, {0, 0.1F, 0}}};
  const DensityMap map = map_of(along, {0, 1, 0}, kWidth_m, 32);
  EXPECT_EQ(map.deposited_area_m2(), 0.0);
  EXPECT_EQ(map.transmittance({0, -1, 0}), 1.0F);
}

TEST(DensityMap, DepthNeverDecreasesAwayFromTheLight) {
  const auto segments = random_segments(3000, 0.1F);
  std::mt19937 random(9);
  std::uniform_real_distribution<float> uniform(-0.13F, 0.13F);
  std::vector<glm::vec3> lights = kAxes;
  lights.push_back({1, 2, -3});
  for (const glm::vec3& light : lights) {
    const DensityMap map = map_of(segments, light, 10 * kWidth_m, 24);
    const glm::vec3 travel = -glm::normalize(light);
    for (int column = 0; column < 50; ++column) {
      const glm::vec3 p{uniform(random), uniform(random), uniform(random)};
      float last = 0;
      for (float x = -0.4F; x <= 0.4F; x += 0.003F) {
        const float depth = map.optical_depth(p + x * travel);
        // Moving along the light in the world moves rounding error across it: 1e-6 of the depth.
        ASSERT_GE(depth, last - 1e-5F * std::max(last, 1.0F)) << x;
        last = depth;
      }
    }
  }
}

TEST(DensityMap, IsOneBeforeTheHairAndTheColumnsTotalBehindIt) {
  const auto segments = random_segments(5000, 0.1F);
  for (const glm::vec3& light : kAxes) {
    const DensityMap map = map_of(segments, light, 10 * kWidth_m, 24);
    const glm::vec3 across = glm::vec3(light.y, light.z, light.x);
    for (const float far_m : {0.2F, 1.0F, 1e6F, 1e30F}) {
      EXPECT_EQ(map.transmittance(far_m * light), 1.0F);  // hard case 2
      EXPECT_EQ(map.transmittance(far_m * across), 1.0F);
      EXPECT_FLOAT_EQ(map.optical_depth(-far_m * light), map.optical_depth(-0.2F * light));
    }
    EXPECT_GT(map.optical_depth(-0.2F * light), 0.1F);
  }
}

TEST(DensityMap, LightNextToAnAxisGivesTheSameShadow) {
  const auto segments = random_segments(2000, 0.1F);
  for (const glm::vec3& light : kAxes) {
    const DensityMap exact = map_of(segments, light, kWidth_m, 24);
    const DensityMap off = map_of(segments, light + 1e-8F * glm::vec3(1, -1, 1), kWidth_m, 24);
    for (const Segment& s : segments) EXPECT_NEAR(exact.optical_depth(s.a), off.optical_depth(s.a), 1e-5F);
  }
}

TEST(DensityMap, LengthOfTheLightVectorDoesNotMatter) {
  const auto segments = random_segments(500, 0.1F);
  const DensityMap unit = map_of(segments, {0, 0.6F, 0.8F}, kWidth_m, 24);
  for (const float scale : {1e-15F, 1e-3F, 1e3F, 1e15F}) {
    const DensityMap map = map_of(segments, scale * glm::vec3(0, 0.6F, 0.8F), kWidth_m, 24);
    for (const Segment& s : segments) EXPECT_NEAR(unit.optical_depth(s.a), map.optical_depth(s.a), 1e-5F);
  }
}

template <class Action>
std::string why(const Action& action) {
  try {
    action();
  } catch (const InputError& error) {
    return error.what();
  }
  return "accepted";
}

TEST(DensityMap, RefusesALightOfNoDirection) {
  constexpr float kInf = std::numeric_limits<float>::infinity();
  for (const glm::vec3 light : {glm::vec3(0), glm::vec3(NAN, 0, 1), glm::vec3(kInf, 0, 0)}) {
    EXPECT_THAT(why([&] { map_of({}, light, kWidth_m, 8); }),
                AllOf(HasSubstr("light"), HasSubstr("give a finite vector that is not zero")));
  }
}

TEST(DensityMap, RefusesSegmentsThatAreNowhere) {
  constexpr float kInf = std::numeric_limits<float>::infinity();
  for (const float bad : {NAN, kInf, -kInf, 1e30F}) {
    auto segments = random_segments(4, 0.1F);
    segments[2].b.y = bad;
    EXPECT_THAT(why([&] { map_of(segments, {0, 1, 0}, kWidth_m, 8); }), HasSubstr("vertex 5")) << bad;
  }
}

TEST(DensityMap, OddHairGivesFiniteShadows) {
  const std::vector<Segment> none, point{{{0.1F, 0.2F, 0.3F}, {0.1F, 0.2F, 0.3F}}}, points(1000, point[0]);
  const std::vector<Segment> tiny(1000, {{0, 0, 0}, {1e-9F, 1e-9F, 0}});  // all hair in one cell
  const std::vector<Segment> far{{{1e6F, 0, 0}, {1e6F, 0.1F, 0}}};
  const std::vector<Segment> zeros{{{-0.0F, -0.0F, -0.0F}, {0, 0, 0}}, {{0, 0, 0}, {-1e-38F, 1e-38F, 0}}};
  for (const auto& hair : {none, point, points, tiny, far, zeros}) {
    for (const int resolution : {1, 2, 64}) {
      const DensityMap map = map_of(hair, {0, 0, 1}, kWidth_m, resolution);
      for (const glm::vec3 p : {glm::vec3(0), glm::vec3(-0.0F), glm::vec3(0.1F, 0.2F, 0.3F), glm::vec3(1e30F),
                                glm::vec3(-1e30F), glm::vec3(1e6F, 0.05F, -1)}) {
        ASSERT_TRUE(map.optical_depth(p) >= 0 && std::isfinite(map.optical_depth(p)));
        ASSERT_TRUE(map.transmittance(p) >= 0 && map.transmittance(p) <= 1);
      }
    }
  }
}

TEST(DensityMap, PointsThatAreNowhereStayVisible) {
  const auto segments = random_segments(1000, 0.1F);
  const DensityMap map = map_of(segments, {0, 1, 0}, kWidth_m, 16);
  constexpr float kInf = std::numeric_limits<float>::infinity();
  for (const float bad : {NAN, kInf, -kInf}) {
    for (int axis = 0; axis < 3; ++axis) {
      glm::vec3 p{0.0F};
      p[axis] = bad;
      EXPECT_TRUE(std::isnan(map.transmittance(p))) << bad << " on axis " << axis;
    }
  }
}

TEST(DensityMap, ThickHairUnderflowsToDarkNotToNaN) {
  const auto segments = random_segments(10'000, 0.1F);
  const DensityMap map = map_of(segments, {0, 1, 0}, 1e3F * kWidth_m, 16);
  EXPECT_TRUE(std::isfinite(map.optical_depth({0, -1, 0})));
  EXPECT_GT(map.optical_depth({0, -1, 0}), 100.0F);
  EXPECT_EQ(map.transmittance({0, -1, 0}), 0.0F);
}

TEST(DensityMap, AFibreShadowsItselfByHalfAndWhereItIs) {
  // Hard case 5: half of the own cell counts, whatever the fibre's place in its cell; its shadow lies behind it.
  constexpr float kCell_m = 0.01F;
  for (const float shift : {0.0F, 0.1F, 0.37F, 0.5F, 0.93F}) {
    const glm::vec3 at = kCell_m * glm::vec3(shift, 0.7F * shift, 0);
    // Two points without length hold the box at 16 cells of 1 cm.
    const std::vector<Segment> hair{{at - glm::vec3(0, 0, 0.06F), at + glm::vec3(0, 0, 0.06F)},
                                    {glm::vec3(-0.08F), glm::vec3(-0.08F)},
                                    {glm::vec3(0.08F), glm::vec3(0.08F)}};
    const DensityMap map = map_of(hair, {0, 1, 0}, 0.01F, 16);
    ASSERT_FLOAT_EQ(map.cell_size_m(), kCell_m);
    const float total = map.optical_depth(at - glm::vec3(0, 0.05F, 0));
    EXPECT_GE(total, 0.5F) << "a D / ds, spread over two columns";
    EXPECT_NEAR(map.optical_depth(at), 0.5F * total, 1e-5F) << shift;
    const DensityMap nearest = map_of(hair, {0, 1, 0}, 0.01F, 16, false);
    const float whole = nearest.optical_depth(at - glm::vec3(0, 0.05F, 0));
    EXPECT_GE(nearest.optical_depth(at), 0.25F * whole - 1e-5F) << shift;
    EXPECT_LE(nearest.optical_depth(at), 0.75F * whole + 1e-5F) << shift;
    // First moment of the shadow across the fibre: linear weights keep it.
    double sum = 0, moment = 0;
    for (int i = -300; i <= 300; ++i) {
      const float x = 1e-4F * static_cast<float>(i);
      const double depth = double(map.optical_depth(glm::vec3(x, -0.05F, 0)));
      sum += depth;
      moment += double(x) * depth;
    }
    EXPECT_NEAR(moment / sum, double(at.x), 0.01 * double(kCell_m)) << shift;
  }
}

TEST(DensityMap, MovesWithTheHair) {
  // Shifted by whole cells, the same numbers but for the rounding of coordinates.
  const auto segments = random_segments(3000, 0.1F);
  const DensityMap map = map_of(segments, {0, 1, 0}, kWidth_m, 32);
  for (const float cells : {1.0F, -7.0F, 1000.0F}) {
    const glm::vec3 move = cells * map.cell_size_m() * glm::vec3(1, -1, 1);
    auto moved = segments;
    for (Segment& s : moved) s.a += move, s.b += move;
    const DensityMap other = map_of(moved, {0, 1, 0}, kWidth_m, 32);
    // Coordinates of `cells` cells round to eps * cells of one cell; depths change by about as much of themselves.
    const float tolerance = 1e-5F + 4 * std::numeric_limits<float>::epsilon() * std::abs(cells);
    for (const Segment& s : segments) ASSERT_NEAR(map.optical_depth(s.a), other.optical_depth(s.a + move), tolerance);
  }
}

TEST(DensityMap, DepthIsContinuousAcrossCellsAndTheBoxesBorder) {
  const auto segments = random_segments(2000, 0.1F);
  const DensityMap map = map_of(segments, {0, 1, 0}, 10 * kWidth_m, 16);
  const float step = 1e-3F * map.cell_size_m();
  for (const glm::vec3 d : {glm::vec3(1, 0, 0), glm::vec3(0, 1, 0), glm::vec3(0, 0, 1)}) {
    // Trilinear: at most the largest difference of neighbours per cell; the greatest depth bounds that.
    const float bound = 1.1e-3F * map.optical_depth({0, -1, 0}) * 8;
    for (float x = -0.16F; x < 0.16F; x += step)
      ASSERT_LE(std::abs(map.optical_depth(x * d) - map.optical_depth((x + step) * d)), bound) << x;
  }
}

TEST(DensityMap, TheFirstLitFibreKeepsAllButHalfOfItsOwnCell) {
  // Hard case 5 with the settings that pictures are made with: a fibre above all others is as bright as it is alone,
  // and no darker than half of its own depth makes it; three quarters where that is not spread: up to half a cell
  // behind its cell's centre, where half counts, on the way to the next one's, where all does.
  std::mt19937 random(4);
  std::uniform_real_distribution<float> uniform(-0.08F, 0.08F);
  Strands all;
  all.diameter_m = 4e-4F;
  std::vector<glm::vec3> top;
  for (int i = 0; i <= 40; ++i) top.push_back({0.003F * static_cast<float>(i - 20), 0.11F, 0.01F});
  all.append(top);
  for (int i = 0; i < 2000; ++i) {
    const float x = uniform(random), z = uniform(random), y = uniform(random);
    all.append(std::array{glm::vec3(x, y, -0.1F), glm::vec3(z, y, 0.1F)});
  }
  Strands alone = all;  // in the same box: the others keep their places, not their lengths
  for (std::size_t s = 1; s < alone.count(); ++s) alone.vertices[alone.offsets[s] + 1] = alone.strand(s)[0];
  for (const glm::vec3& corner : {glm::vec3(-0.15F), glm::vec3(0.15F)}) {
    all.append(std::array{corner, corner});
    alone.append(std::array{corner, corner});
  }
  for (const int kind : {0, 1, 2, 3}) {
    for (const float footprint_m : {0.0F, 0.002F}) {
      DensityMapSettings settings;
      settings.resolution = 64;
      settings.interpolate_depth = kind % 2 == 1;
      settings.trilinear_deposit = kind >= 2;
      settings.footprint_m = footprint_m;
      const float most = settings.trilinear_deposit ? 0.5F : 0.75F;
      const Light light{{0, 1, 0}, {}, glm::vec3(1), 1};
      const DensityMap among(settings, all, 0.6F, light), lone(settings, alone, 0.6F, light);
      ASSERT_FLOAT_EQ(among.cell_size_m(), lone.cell_size_m());
      for (const glm::vec3& v : top) {
        const float own = 1 - lone.transmittance({v.x, 0.09F, v.z});
        EXPECT_GT(own, 0.005F);
        EXPECT_GE(among.transmittance(v), 1 - most * own - 1e-4F) << v.x;
        EXPECT_NEAR(among.transmittance(v), lone.transmittance(v), 1e-4F) << v.x;
      }
      EXPECT_LT(among.transmittance({0, -0.2F, 0}), 0.8F) << "the others do cast a shadow";
    }
  }
}

}  // namespace
}  // namespace pelage
