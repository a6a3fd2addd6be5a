// Thin strands keep their coverage; strips have neither gaps nor overlaps.
#include <glm/geometric.hpp>
#include <glm/gtc/constants.hpp>

#include "strands.h"

namespace pelage {
namespace {

using test::checked;
using test::unit;

class StrandCoverage : public test::WithOpenGl {};

constexpr float kOpacity = 0.6F;
constexpr float kDiameter_m = 4e-4F;

/// Straight strands side by side, 2 mm apart or more, in a plane across the view, turned by `angle`.
Strands comb(int count, float angle) {
  std::mt19937 random(3);
  Strands strands;
  strands.diameter_m = kDiameter_m;
  const glm::vec3 along{std::cos(angle), std::sin(angle), 0}, across{-along.y, along.x, 0};
  for (int i = 0; i < count; ++i) {
    const float at = 0.08F * ((static_cast<float>(i) + 0.1F * unit(random)) / static_cast<float>(count) - 0.5F);
    const float shift = 0.01F * unit(random);
    std::vector<glm::vec3> points;
    for (int k = 0; k < 4; ++k) {
      const float x = 0.08F * static_cast<float>(k) / 3 - 0.04F;
      points.push_back(at * across + (x + shift) * along);
    }
    strands.append(points);
  }
  return strands;
}

/// Mean alpha of a picture that sees 14 x 14 cm from far away with samples of this width.
double mean_alpha(const Strands& strands, StrandShape shape, float sample_m, int supersampling = 1) {
  StrandFrame frame(strands, kOpacity, {});
  StrandFrameSettings settings = test::strands_from_the_front();
  settings.method = Method::unshadowed;
  settings.strands.shape = shape;
  const int size = int(0.14F / sample_m);
  settings.camera.eye = {0, 0, 10};
  settings.camera.fov_deg = glm::degrees(2 * std::atan(0.07F / 10));
  return test::mean(checked(frame.render(settings, size, size, supersampling)), 3);
}

TEST_F(StrandCoverage, DoesNotDependOnDistance) {
  double most = 0;
  constexpr int kCount = 36;
  // Not 45 degrees: there every strand covers a whole number of diagonals of samples, 1 or 2.
  for (const float angle : {0.0F, 0.3F, 0.75F, 1.2F, glm::half_pi<float>()}) {
    const Strands strands = comb(kCount, angle);
    const double expected = double(kOpacity * kDiameter_m) * kCount * 0.08 / (0.14 * 0.14);
    // At .2 samples are 2 mm wide: beyond that strands share samples, see below.
    for (const float samples_per_diameter : {1.6F, 1.0F, 0.5F, 0.2F}) {
      for (const StrandShape shape : {StrandShape::ribbons, StrandShape::lines}) {
        if (shape == StrandShape::lines && samples_per_diameter > 0.7F) continue;  // they cannot cover more
        const double alpha = mean_alpha(strands, shape, kDiameter_m / samples_per_diameter);
        most = std::max(most, std::abs(alpha / expected - 1));
        // The ends of each strand fall between samples: a standard deviation of half a sample of 40 or more, for 36
        // strands .002; four of them. Where strands wider than a sample lie on rows of samples (angle 0) each covers 1
        // or 2 of them: .5 / 1.6 / sqrt(36); two of them.
        const double tolerance = samples_per_diameter > 1 ? 0.1 : 0.008;
        EXPECT_NEAR(alpha / expected, 1.0, tolerance)
            << "angle " << angle << ", " << samples_per_diameter << " samples per diameter, shape " << int(shape);
      }
    }
  }
  std::printf("coverage of a comb: largest relative error %.3g\n", most);
}

TEST_F(StrandCoverage, ThinStrandsHaveNoGaps) {
  Strands strands;
  strands.diameter_m = 1e-4F;
  strands.append(std::vector<glm::vec3>{{-0.06F, -0.05F, 0}, {-0.01F, 0.02F, 0}, {0.06F, 0.05F, 0}});
  for (const StrandShape shape : {StrandShape::ribbons, StrandShape::lines}) {
    StrandFrame frame(strands, kOpacity, {});
    StrandFrameSettings settings = test::strands_from_the_front();
    settings.strands.shape = shape;
    settings.camera.eye = {0, 0, 10};
    settings.camera.fov_deg = glm::degrees(2 * std::atan(0.07F / 10));
    const Image image = checked(frame.render(settings, 140, 140, 1));  // a tenth of a sample wide
    for (int x = 12; x < 128; ++x) {
      float column = 0;
      for (int y = 0; y < 140; ++y) column += image.pixel(x, y)[3];
      ASSERT_GT(column, 0.9F * 0.1F * kOpacity) << x;
      ASSERT_LT(column, 4 * 0.1F * kOpacity) << x;
    }
  }
}

TEST_F(StrandCoverage, OfALockIsThatOfItsFinePicture) {
  Strands strands = test::strand_lock(120);
  strands.diameter_m = kDiameter_m;
  for (glm::vec3& p : strands.vertices) p *= 0.6F;
  for (const float samples_per_diameter : {0.5F, 0.1F}) {
    const float sample_m = kDiameter_m / samples_per_diameter;
    const double fine = mean_alpha(strands, StrandShape::ribbons, sample_m, 8);
    for (const StrandShape shape : {StrandShape::ribbons, StrandShape::lines}) {
      const double coarse = mean_alpha(strands, shape, sample_m);
      std::printf("lock, %g samples per diameter: alpha %.5f, of 8 x 8 samples %.5f, error %.2g %%\n",
                  double(samples_per_diameter), coarse, fine, 100 * (coarse / fine - 1));
      // Strands that share a sample stop 1 - (1 - a)^n, as if they lay anywhere in it. Where the lock is unevenly dense
      // within a sample (4 mm at .1, the lock 12 mm) that is more than they do.
      EXPECT_NEAR(coarse / fine, 1.0, samples_per_diameter > 0.3F ? 0.01 : 0.12);
    }
  }
}

TEST_F(StrandCoverage, JointsHaveNeitherGapNorOverlap) {
  for (const float turn : {0.0F, 0.2F, 1.0F, 1.5F, 1.9F}) {
    Strands strands;
    strands.diameter_m = 0.01F;
    std::vector<glm::vec3> points;
    glm::vec3 at{-0.05F, 0, 0};
    for (int k = 0; k < 5; ++k) {
      points.push_back(at);
      const float angle = (k % 2 == 0 ? 0.5F : -0.5F) * turn;
      at += 0.025F * glm::vec3(std::cos(angle), std::sin(angle), 0);
    }
    strands.append(points);
    StrandFrame frame(strands, kOpacity, {});
    StrandFrameSettings settings = test::strands_from_the_front();
    settings.method = Method::unshadowed;
    settings.strands.order = StrandOrder::sorted;
    settings.camera.eye = {0, 0, 10};
    settings.camera.fov_deg = glm::degrees(2 * std::atan(0.07F / 10));
    constexpr int kSize = 280;
    const Image image = checked(frame.render(settings, kSize, kSize, 1));
    double covered = 0;
    for (std::size_t i = 3; i < image.rgba.size(); i += 4) {
      covered += image.rgba[i] > 0;
      ASSERT_TRUE(image.rgba[i] == 0.0F || std::abs(image.rgba[i] - kOpacity) < 1e-6F) << "once or not at all";
    }
    const double sample_m = 0.14 / kSize;
    // Mitres: what the outer side gains the inner one loses.
    EXPECT_NEAR(covered * sample_m * sample_m, 0.01 * 0.1, 0.01 * 0.01 * 0.1) << "turn " << turn;
    for (int k = 0; k <= 400; ++k) {  // along the centre line, but not at the very ends
      const float s = 0.005F + 3.99F * static_cast<float>(k) / 400;
      const auto i = std::size_t(s);
      const glm::vec3 p = glm::mix(points[i], points[i + 1], s - float(i));
      const int x = int((p.x / 0.14F + 0.5F) * kSize), y = int((0.5F - p.y / 0.14F) * kSize);
      ASSERT_GT(image.pixel(x, y)[3], 0.0F) << "a gap at " << s << ", turn " << turn;
    }
  }
}

TEST_F(StrandCoverage, EndsAreSquareWhateverStrandsAreNext) {
  Strands strands;
  strands.diameter_m = 0.02F;
  strands.append(std::vector<glm::vec3>{{-0.06F, 0.06F, 0}, {-0.06F, 0.05F, 0}});
  strands.append(std::vector<glm::vec3>{{-0.04F, -0.02F, 0}, {0.04F, -0.02F, 0}});
  strands.append(std::vector<glm::vec3>{{0.06F, 0.06F, 0}, {0.06F, 0.05F, 0}});
  StrandFrame frame(strands, kOpacity, {});
  StrandFrameSettings settings = test::strands_from_the_front();
  settings.camera.eye = {0, 0, 10};
  settings.camera.fov_deg = glm::degrees(2 * std::atan(0.07F / 10));
  const Image image = checked(frame.render(settings, 140, 140, 1));  // samples of 1 mm
  for (int y = 60; y < 140; ++y) {
    for (int x = 0; x < 140; ++x) {
      const bool inside = x >= 30 && x < 110 && y >= 80 && y < 100;
      ASSERT_EQ(image.pixel(x, y)[3] > 0, inside) << x << " " << y;
    }
  }
}

TEST_F(StrandCoverage, DiametersTaper) {
  Strands strands;
  strands.append(std::vector<glm::vec3>{{0, 0.05F, 0}, {0, -0.05F, 0}});
  strands.diameters_m = {0.02F, 0.0F};
  strands.diameter_m = 0.5F;
  // A triangle of 10 x 2 cm.
  EXPECT_NEAR(mean_alpha(strands, StrandShape::ribbons, 5e-4F), 0.6 * 0.001 / (0.14 * 0.14), 5e-4);
}

}  // namespace
}  // namespace pelage
