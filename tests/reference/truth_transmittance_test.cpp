#include "pelage/reference/truth_transmittance.h"

#include <gtest/gtest.h>
#include <tbb/global_control.h>

#include "pelage/data_schema/errors.h"
#include "sample_hair.h"

namespace pelage {
namespace {

Light from(const glm::vec3& direction) {
  Light l;
  l.direction = direction;
  return l;
}

TEST(Truth, SlabOfParallelFibresStraightAndTilted) {
  // E[T] = exp(-a rho D h sin(theta)) over many slabs; within one slab the fibres stay the same, so points are spread
  // wide and the error is that of the means over points.
  constexpr double kHalf = 0.05, kThick = 0.01, kLength = 0.4;
  constexpr std::size_t kFibres = 4000;
  const float diameter = 2e-4F, opacity = 0.5F;
  for (const double theta : {1.5707963267948966, 0.7}) {
    // Fibres along x; the light turns in the x-z plane to stand at theta to them. The slab is across z.
    const glm::dvec3 to_light(std::cos(theta), 0, std::sin(theta));
    const Strands s = sample::parallel_fibres(kFibres, {kHalf, kHalf, kThick / 2}, {1, 0, 0}, kLength, 8, diameter, 5);
    const FibreScene scene(s, opacity);
    std::vector<TruthPoint> points;
    sample::Random random(6);
    for (int i = 0; i < 400; ++i) {
      points.push_back({glm::vec3(glm::dvec3(random.in(-0.04, 0.04), random.in(-0.045, 0.045), -kThick))});
    }
    TruthSettings settings;
    settings.rays = 256;
    settings.footprint_m = 0.001F;
    const auto t = truth_transmittance(scene, points, from(glm::vec3(to_light)), settings, 7);
    double sum = 0, squares = 0;
    for (const TruthEstimate& e : t) sum += e.mean, squares += e.mean * e.mean;
    const double n = double(t.size()), mean = sum / n, error = std::sqrt((squares / n - mean * mean) / (n - 1));
    // Length per volume, seen per unit of the slab's thickness: in y-z all fibres cross the slab's section.
    const double lines_per_area = double(kFibres) / (2 * kHalf * kThick);
    const double path = kThick / std::sin(theta);  // through the slab, across fibres: path sin(theta) = thickness
    const double expected = std::exp(-double(opacity) * double(diameter) * lines_per_area * path * std::sin(theta));
    // 400 points in 0.1 m of y share fibres: neighbours within 3 mm are alike, so about 30 independent places.
    EXPECT_NEAR(mean, expected, 4 * error * std::sqrt(400.0 / 30)) << theta;
  }
}

TEST(Truth, EmptySceneIsExactlyOne) {
  const FibreScene scene(Strands{}, 0.6F);
  const std::vector<TruthPoint> points{{{0, 0, 0}}, {{1, 2, 3}}};
  for (const TruthEstimate& e : truth_transmittance(scene, points, Light{}, {}, 1)) {
    EXPECT_EQ(e.mean, 1);
    EXPECT_EQ(e.standard_error, 0);
  }
}

}  // namespace
}  // namespace pelage
