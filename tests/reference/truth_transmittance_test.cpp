// Footprint-averaged transmittance: against the slab's formula, against single rays, and the honesty of its error bar.
#include "pelage/reference/truth_transmittance.h"

#include <gtest/gtest.h>
#include <tbb/global_control.h>

#include "pelage/data_schema/errors.h"
#include "pelage/reference/parallel_rays.h"
#include "sample_hair.h"

namespace pelage {
namespace {

constexpr float kD = 2e-4F;

Light from(const glm::vec3& direction) {
  Light l;
  l.direction = direction;
  return l;
}
Light at(const glm::vec3& position) {
  Light l;
  l.position = position;
  return l;
}

std::vector<TruthPoint> vertices_of(const Strands& s, std::size_t count, unsigned seed) {
  sample::Random random(seed);
  std::vector<TruthPoint> points;
  for (std::size_t i = 0; i < count; ++i) {
    const auto v = static_cast<std::uint32_t>(random.in(0, static_cast<double>(s.vertices.size())));
    points.push_back({s.vertices[v], v});
  }
  return points;
}

/// Dense enough for T of .1 to .9 inside.
Strands some_hair() {
  return sample::walks(800, 25, 0.02, 0.002, 0.3, kD, 1);
}

TEST(Truth, SlabOfParallelFibresStraightAndTilted) {
  // A slab of thickness h across z, crossed by fibres of random place at an angle theta to the light, z; a Poisson
  // number of them, so that E[T] = exp(-a rho D h sin(theta)) without a rest. Independent slabs, one point each.
  constexpr double kThick = 0.01, kTau = 1.0, kHalf = 0.008, kOpacity = 0.5;
  constexpr int kSlabs = 300;
  std::mt19937 engine(1);
  for (const double theta : {0.5, 1.0, std::numbers::pi / 2}) {
    const bool straight = theta > 1.5;
    const glm::dvec3 t(std::sin(theta), 0, std::cos(theta));
    const double length = straight ? 0.04 : kThick / t.z, seen = length * t.x;
    // Fibres start at z = 0 (straight ones anywhere in the slab), x in [-seen - half, half], y in [-half, half].
    const double per_area = kTau / (kOpacity * double(kD) * seen);
    std::poisson_distribution<int> poisson(per_area * (seen + 2 * kHalf) * 2 * kHalf);
    sample::Random random(2);
    double sum = 0, squares = 0;
    for (int i = 0; i < kSlabs; ++i) {
      Strands s;
      for (int k = poisson(engine); k > 0; --k) {
        const glm::dvec3 a(random.in(-seen - kHalf, kHalf), random.in(-kHalf, kHalf),
                           straight ? random.in(0, kThick) : 0);
        s.append(std::vector<glm::vec3>{glm::vec3(a), glm::vec3(a + 0.3 * length * t), glm::vec3(a + length * t)});
      }
      s.diameter_m = kD;
      TruthSettings settings;
      settings.rays = 256;
      const TruthPoint point{{0, 0, -0.001F}};
      const double mean = truth_transmittance(FibreScene(s, float(kOpacity)), {&point, 1}, from({0, 0, 3}), settings,
                                              static_cast<std::uint64_t>(i))[0]
                              .mean;
      sum += mean, squares += mean * mean;
    }
    const double mean = sum / kSlabs, error = std::sqrt((squares / kSlabs - mean * mean) / (kSlabs - 1));
    EXPECT_NEAR(mean, std::exp(-kTau), 4 * error) << theta;
    EXPECT_LT(error, 0.006) << "the test has teeth: 4 errors are 6 % of T";
  }
}

TEST(Truth, EmptySceneIsExactlyOne) {
  const FibreScene scene(Strands{}, 0.6F);
  const std::vector<TruthPoint> points{{{0, 0, 0}}, {{1, 2, 3}}};
  for (const Light& light : {Light{}, at({0, 5, 0})}) {
    for (const TruthEstimate& e : truth_transmittance(scene, points, light, {}, 1)) {
      EXPECT_EQ(e.mean, 1);
      EXPECT_EQ(e.standard_error, 0);
    }
  }
  EXPECT_TRUE(truth_transmittance(scene, {}, Light{}, {}, 1).empty());
}

TEST(Truth, HairWithoutWidthAlongTheRaysAndRepeatedVerticesAreNoTrouble) {
  Strands s = sample::one_strand({{0, 0, 1}, {0, 0, 2}, {0, 0, 2}}, 0);
  s.diameters_m = {0, 0, 0};
  const TruthPoint p{{0, 0, 0}};
  for (const Light& light : {from({0, 0, 1}), at({0, 0, 5})}) {
    EXPECT_EQ(truth_transmittance(FibreScene(s, 0.5F), {&p, 1}, light, {}, 1)[0].mean, 1);
  }
  s.diameters_m = {1e-2F, 1e-2F, 1e-2F};  // seen end on: finite, and a disc of no area by definition, or of D / 2
  for (const Light& light : {from({0, 0, 1}), at({0, 0, 5})}) {
    const double t = truth_transmittance(FibreScene(s, 0.5F), {&p, 1}, light, {}, 1)[0].mean;
    EXPECT_TRUE(t >= 0.5 && t <= 1) << t;
  }
}

TEST(Truth, RaysTracedTogetherCrossWhatSingleRaysCross) {
  // Hair of all kinds: bends, folds, steep to the rays, widths that vary, zero lengths.
  Strands all[] = {some_hair(), sample::walks(500, 20, 0.01, 0.002, 10, kD, 2),
                   sample::parallel_fibres(300, {0.01, 0.01, 0.01}, {0.02, 0.01, 1}, 0.03, 7, kD, 3),
                   sample::walks(300, 60, 0.01, 5e-5, 0.5, kD, 4)};
  sample::Random random(5);
  for (std::size_t i = 0; i < all[0].vertices.size(); ++i) all[0].diameters_m.push_back(float(random.in(0, 4e-4)));
  for (std::size_t i = 7; i < all[1].vertices.size(); i += 5) all[1].vertices[i] = all[1].vertices[i - 1];
  int rays = 0, crossings = 0, different = 0;
  for (const Strands& s : all) {
    const FibreScene scene(s, 0.5F);
    for (const glm::dvec3& direction : {glm::dvec3(0, 0, 1), glm::normalize(glm::dvec3(1, -2, 0.5))}) {
      const ParallelRays together(scene.curves(), LightFrame(direction));
      std::vector<ParallelRays::Band> bands;
      RayBundle bundle;
      for (const TruthPoint& p : vertices_of(s, 60, 6)) {
        const glm::dvec3 middle(p.position);
        const std::uint32_t owner = rays % 2 == 0 ? p.owner : kNoOwner;
        together.find(middle, 0.002, owner, bands);
        bundle.size = 77;
        for (std::size_t i = 0; i < bundle.size; ++i) {
          const double r = 0.002 * std::sqrt(random.in(0, 1)), turn = random.in(0, 7);
          bundle.x[i] = static_cast<float>(r * std::cos(turn)), bundle.y[i] = static_cast<float>(r * std::sin(turn));
        }
        ParallelRays::count(bands, bundle);
        for (std::size_t i = 0; i < bundle.size; ++i) {
          const int single = scene.count(together.ray(middle, bundle.x[i], bundle.y[i]), owner);
          different += single != bundle.count[i] ? 1 : 0;
          crossings += single;
          ++rays;
        }
      }
    }
  }
  EXPECT_GT(crossings, 30'000);
  // Float in the footprint's frame: coordinates of up to 4 mm, off by 2.4e-10 m; an edge within that of a ray, for 2
  // edges of a fibre of 0.2 mm: 1e-5 of the crossings, allowed: 1e-4.
  EXPECT_LE(different, crossings / 10'000) << "of " << rays << " rays, " << crossings << " crossings";
}

TEST(Truth, ErrorBarIsTheSpreadOverSeeds) {
  // Variance of the mean over S seeds against the mean of the stated variances, which is unbiased; averaged over
  // points. Relative standard deviation: sqrt(2 / (S - 1)) = .1 of the first, sqrt(2 / 15 S) = .026 of the second, /
  // sqrt(12) points: .030; 4 of these (false alarm 6e-5).
  const Strands s = some_hair();
  const FibreScene scene(s, 0.5F);
  const auto points = vertices_of(s, 12, 3);
  constexpr int kSeeds = 200;
  TruthSettings settings;
  settings.rays = 250;  // batches of 15 and of 16
  for (const Light& light : {from({1, 2, 3}), at({0.05F, 0.1F, 0.1F})}) {
    std::vector<double> sum(points.size()), squares(points.size()), stated(points.size());
    for (int seed = 0; seed < kSeeds; ++seed) {
      const auto t = truth_transmittance(scene, points, light, settings, static_cast<std::uint64_t>(seed));
      for (std::size_t i = 0; i < points.size(); ++i) {
        sum[i] += t[i].mean, squares[i] += t[i].mean * t[i].mean;
        stated[i] += t[i].standard_error * t[i].standard_error;
      }
    }
    double ratio = 0;
    int varied = 0;
    for (std::size_t i = 0; i < points.size(); ++i) {
      if (stated[i] == 0) continue;  // nothing above this point
      const double mean = sum[i] / kSeeds, spread = (squares[i] - kSeeds * mean * mean) / (kSeeds - 1);
      ratio += spread / (stated[i] / kSeeds);
      ++varied;
    }
    EXPECT_GE(varied, 8);
    EXPECT_NEAR(ratio / varied, 1, 4 * std::sqrt((2.0 / 199 + 2.0 / 3000) / varied));
  }
}

TEST(Truth, WellSpreadRaysLeaveASmallerErrorThanIndependentOnes) {
  // The gain grows with the rays of a batch: these must be closer to each other than fibres are wide.
  const Strands s = some_hair();
  const FibreScene scene(s, 0.5F);
  const auto points = vertices_of(s, 30, 3);
  const Light light = from({1, 2, 3});
  const ParallelRays together(scene.curves(), LightFrame(glm::normalize(glm::dvec3(1, 2, 3))));
  std::vector<ParallelRays::Band> bands;
  double variance = 0;  // of one ray, mean over points
  sample::Random random(5);
  for (const TruthPoint& p : points) {
    RayBundle bundle;
    bundle.size = RayBundle::kMost;
    for (std::size_t i = 0; i < bundle.size; ++i) {
      const double r = 0.002 * std::sqrt(random.in(0, 1)), turn = random.in(0, 2 * std::numbers::pi);
      bundle.x[i] = static_cast<float>(r * std::cos(turn)), bundle.y[i] = static_cast<float>(r * std::sin(turn));
    }
    together.find(glm::dvec3(p.position), 0.002, p.owner, bands);
    ParallelRays::count(bands, bundle);
    double sum = 0, squares = 0;
    for (std::size_t i = 0; i < bundle.size; ++i) {
      const double t = scene.transmittance(bundle.count[i]);
      sum += t, squares += t * t;
    }
    const auto n = static_cast<double>(bundle.size);
    variance += (squares / n - sum * sum / (n * n)) / static_cast<double>(points.size());
  }
  for (const auto& [rays, most] : {std::pair(1024, 0.95), std::pair(8192, 0.7), std::pair(65536, 0.45)}) {
    TruthSettings settings;
    settings.rays = rays;
    double stated = 0;
    for (const TruthEstimate& e : truth_transmittance(scene, points, light, settings, 1)) {
      stated += e.standard_error * e.standard_error / static_cast<double>(points.size());
    }
    const double gain = std::sqrt(stated / (variance / rays));
    RecordProperty("error_over_independent_" + std::to_string(rays), std::to_string(gain));
    EXPECT_LT(gain, most) << rays << " rays: standard error " << std::sqrt(stated);
  }
}

TEST(Truth, OwnersSegmentsCastNoShadow) {
  const Strands s = sample::one_strand({{-0.01F, 0, 0}, {0, 0, 0}, {0.01F, 0, 0}, {0.02F, 0, 0}, {0.03F, 0, 0}}, 6e-3F);
  const FibreScene scene(s, 0.5F);
  TruthSettings settings;
  settings.footprint_m = 0.001F;
  settings.rays = 64;
  const auto t = [&](const TruthPoint& p) {
    return truth_transmittance(scene, {&p, 1}, from({0, 0, 1}), settings, 1)[0];
  };
  EXPECT_EQ(t({{0, 0, -0.01F}, 1}).mean, 1);
  EXPECT_EQ(t({{0, 0, -0.01F}, kNoOwner}).mean, 0.5);
  EXPECT_EQ(t({{0.025F, 0, -0.01F}, 1}).mean, 0.5) << "two segments away";
  EXPECT_EQ(t({{0, 0, 0.01F}, kNoOwner}).mean, 1) << "behind the point";
}

TEST(Truth, RaysAreUniformInTheDisc) {
  // An opaque fibre so wide that only its edge crosses the disc, at half its radius: a cap of 1/3 - sqrt(3) / (4 pi).
  const double cap = 1.0 / 3 - std::sqrt(3.0) / (4 * std::numbers::pi);
  const Strands s = sample::one_strand({{-1, 0.011F, 1}, {1, 0.011F, 1}}, 0.02F);
  const FibreScene scene(s, 1.0F);
  TruthSettings settings;
  settings.rays = 65536;
  const TruthPoint p{{0, 0, 0}};
  for (const Light& light : {from({0, 0, 1}), at({0, 0, 1e6F})}) {
    const TruthEstimate t = truth_transmittance(scene, {&p, 1}, light, settings, 3)[0];
    EXPECT_NEAR(t.mean, 1 - cap, 4 * t.standard_error + 1e-4);  // the edge is off by 1e-8 of 2e-3 m
    EXPECT_LT(t.standard_error, 5e-4);
  }
}

TEST(Truth, FootprintOfRadiusZeroIsOneRay) {
  const Strands s = some_hair();
  const FibreScene scene(s, 0.5F);
  TruthSettings settings;
  settings.footprint_m = 0;
  settings.rays = 20;
  const auto points = vertices_of(s, 50, 4);
  const auto t = truth_transmittance(scene, points, from({0, 1, 1}), settings, 1);
  for (std::size_t i = 0; i < points.size(); ++i) {
    const FibreRay ray{glm::dvec3(points[i].position), glm::normalize(glm::dvec3(0, 1, 1))};
    EXPECT_NEAR(t[i].mean, scene.transmittance(scene.count(ray, points[i].owner)), 1e-15);
    EXPECT_LT(t[i].standard_error, 1e-15);
  }
}

TEST(Truth, AnyNumberOfRays) {
  const Strands s = some_hair();
  const FibreScene scene(s, 0.5F);
  const auto points = vertices_of(s, 20, 4);
  for (const int rays : {1, 2, 5, 16, 17, 40'000}) {
    TruthSettings settings;
    settings.rays = rays;
    for (const TruthEstimate& e : truth_transmittance(scene, points, Light{}, settings, 1)) {
      EXPECT_TRUE(e.mean >= 0 && e.mean <= 1 && e.standard_error >= 0 && e.standard_error <= 0.5) << rays;
      EXPECT_TRUE(rays > 1 || e.standard_error == 0.5);
    }
  }
}

TEST(Truth, FarPointLightIsADirectionalOne) {
  const Strands s = some_hair();
  const FibreScene scene(s, 0.5F);
  const auto points = vertices_of(s, 60, 4);
  TruthSettings settings;
  const auto parallel = truth_transmittance(scene, points, from({0, 3, 4}), settings, 1);
  const auto point = truth_transmittance(scene, points, at({0, 6000, 8000}), settings, 1);
  // Rays turn by 1e-5 (points 4 cm from the origin): 4e-7 m over the hair, .004 of a diameter; with two edges of each
  // of some 3 fibres 1 ray of 100 changes by .5 at random: .05 / sqrt(1024) x 4. Disk axes are the same.
  for (std::size_t i = 0; i < points.size(); ++i) EXPECT_NEAR(parallel[i].mean, point[i].mean, 0.006) << i;
}

TEST(Truth, PointLightInTheHairSeesOnlyWhatIsBetween) {
  Strands s;
  for (const float z : {0.01F, 0.02F, 0.03F}) s.append(std::vector<glm::vec3>{{-0.1F, 0, z}, {0.1F, 0, z}});
  s.diameter_m = 0.02F;
  const FibreScene scene(s, 0.5F);
  TruthSettings settings;
  settings.rays = 64;
  const TruthPoint p{{0, 0, 0}};
  const auto t = [&](float z) { return truth_transmittance(scene, {&p, 1}, at({0, 0, z}), settings, 1)[0].mean; };
  EXPECT_EQ(t(0.005F), 1);
  EXPECT_EQ(t(0.015F), 0.5);
  EXPECT_EQ(t(0.025F), 0.25);
  EXPECT_EQ(t(5), 0.125);
  EXPECT_EQ(t(-5), 1);
  EXPECT_EQ(t(0), 1) << "at the light itself";
}

TEST(Truth, EarlyStopIsOffByLessThanStated) {
  const Strands s = sample::walks(3000, 25, 0.02, 0.002, 0.3, kD, 1);
  const FibreScene scene(s, 0.3F);
  const auto points = vertices_of(s, 100, 4);
  TruthSettings settings;
  settings.rays = 128;
  const Light light = at({0, 0.5F, 0});
  const auto whole = truth_transmittance(scene, points, light, settings, 1);
  for (const float stop : {0.002F, 0.1F}) {
    settings.stop_below = stop;
    const auto stopped = truth_transmittance(scene, points, light, settings, 1);
    double most = 0;
    for (std::size_t i = 0; i < points.size(); ++i) {
      const double over = stopped[i].mean - whole[i].mean;
      EXPECT_TRUE(over >= 0 && over < double(stop)) << over;
      most = std::max(most, over);
    }
    EXPECT_TRUE(most > 0 || stop < 0.1F) << "rays did stop";
  }
}

TEST(Truth, SameNumbersForAnyNumberOfThreads) {
  const Strands s = some_hair();
  const auto points = vertices_of(s, 100, 4);
  TruthSettings settings;
  settings.rays = 100;
  for (const Light& light : {Light{}, at({0, 0.3F, 0})}) {
    std::vector<TruthEstimate> first;
    for (const std::size_t threads : {1U, 2U, 3U, 8U}) {
      const tbb::global_control limit(tbb::global_control::max_allowed_parallelism, threads);
      const FibreScene scene(s, 0.5F);
      const auto t = truth_transmittance(scene, points, light, settings, 9);
      if (first.empty()) first = t;
      for (std::size_t i = 0; i < t.size(); ++i) {
        EXPECT_EQ(t[i].mean, first[i].mean);
        EXPECT_EQ(t[i].standard_error, first[i].standard_error);
      }
    }
    EXPECT_NE(truth_transmittance(FibreScene(s, 0.5F), points, light, settings, 10)[0].mean, first[0].mean);
  }
}

TEST(Truth, ProgressComesFromOneThreadAtATimeAndMayInterrupt) {
  const Strands s = some_hair();
  const FibreScene scene(s, 0.5F);
  const auto points = vertices_of(s, 200, 4);
  TruthSettings settings;
  settings.rays = 16;
  std::uint64_t last = 0;
  truth_transmittance(scene, points, Light{}, settings, 1, [&](std::uint64_t done, std::uint64_t total) {
    EXPECT_EQ(done, last + 1);
    EXPECT_EQ(total, 200U);
    last = done;
  });
  EXPECT_EQ(last, 200U);
  EXPECT_THROW(truth_transmittance(scene, points, Light{}, settings, 1,
                                   [](std::uint64_t done, std::uint64_t) {
                                     if (done == 50) throw Interrupted("enough");
                                   }),
               Interrupted);
}

TEST(Truth, HeadCastsAShadowOnlyWhenAsked) {
  Mesh head;
  head.vertices = {{-1, -1, 0.5F}, {1, -1, 0.5F}, {0, 1, 0.5F}};
  head.normals.assign(3, glm::vec3(0, 0, 1));
  head.triangles = {{0, 1, 2}};
  const FibreScene scene(Strands{}, 0.5F, &head);
  const TruthPoint p{{0, 0, 0}};
  TruthSettings settings;
  settings.rays = 16;
  for (const Light& light : {from({0, 0, 1}), at({0, 0, 2})}) {
    EXPECT_EQ(truth_transmittance(scene, {&p, 1}, light, settings, 1)[0].mean, 1);
    EXPECT_EQ(truth_transmittance(scene, {&p, 1}, light, settings, 1, {}, HeadShadow::casts)[0].mean, 0);
  }
  EXPECT_EQ(truth_transmittance(scene, {&p, 1}, at({0, 0, 0.4F}), settings, 1, {}, HeadShadow::casts)[0].mean, 1);
}

TEST(Truth, LightWithoutADirectionIsRefused) {
  const FibreScene scene(Strands{}, 0.5F);
  const float nan = std::numeric_limits<float>::quiet_NaN();
  for (const Light& light : {from({0, 0, 0}), from({nan, 0, 1}), at({0, nan, 1})}) {
    EXPECT_THROW(truth_transmittance(scene, {}, light, {}, 1), UsageError);
  }
}

}  // namespace
}  // namespace pelage
