#include "pelage/satf/plate_direction.h"

#include <gtest/gtest.h>

#include "fixture.h"

namespace pelage::test {
namespace {

TEST(PlateDirection, SectorAngleIsTheJacobiansOne) {
  // db/sectors.h maps with J^-1 at the middle of a sector; the ring's closed form must agree, for sheared and 5:1
  // ellipses too (HARD_CASES 12).
  const Division division{4, 24, 8, 0.1F};
  for (const EllipseAxes axes :
       {EllipseAxes{.01F, .01F, 0}, {.01F, .002F, 0}, {.01F, .002F, .7F}, {.01F, .006F, -1.2F}}) {
    const CrossSection s = cross_section(axes);
    for (int layer = 0; layer < division.layers; ++layer) {
      const RingShape ring = ring_shape(division, layer);
      for (int k = 0; k < ring.sectors; ++k) {
        const glm::mat2 jacobian = sector_jacobian(division, layer, k, s);
        for (float a = -3.0F; a < 3.1F; a += 0.37F) {
          const glm::vec3 towards{std::cos(a), 0.0F, std::sin(a)};
          const Frame frame{{0, 0, 0}, {0, -1, 0}, {1, 0, 0}, {0, 0, 1}, 0};
          const PlateDirection d = plate_direction(frame, s, towards);
          const float u = 2 * kPi * (static_cast<float>(k) + 0.5F) / static_cast<float>(ring.sectors);
          const float difference = warp_angle(ring, d.phi - u) - sector_angle(jacobian, {std::cos(a), std::sin(a)});
          // Equal up to whole turns; 1e-4 rad: float rounding through a 5:1 ellipse.
          EXPECT_NEAR(std::remainder(difference, 2 * kPi), 0.0F, 1e-4F)
              << "layer " << layer << " sector " << k << " a " << a;
        }
      }
    }
  }
}

TEST(PlateDirection, WarpIsContinuousAndKeepsTurns) {
  const RingShape ring = ring_shape({4, 24, 8, 0.1F}, 3);
  float last = warp_angle(ring, -7.0F);
  for (float theta = -7.0F; theta < 7.0F; theta += 0.01F) {
    const float now = warp_angle(ring, theta);
    EXPECT_GE(now, last - 1e-5F);
    EXPECT_LT(now - last, 0.05F) << theta;  // largest slope is the aspect, below 3 here
    last = now;
    EXPECT_NEAR(warp_angle(ring, theta + 2 * kPi), now + 2 * kPi, 1e-5F);
  }
}

TEST(PlateDirection, IsFiniteAlongTheAxis) {
  const Frame frame{{0, 0, 0}, {0, -1, 0}, {1, 0, 0}, {0, 0, 1}, 0};
  for (const glm::vec3 towards : {glm::vec3(0, 1, 0), glm::vec3(0, -1, 0), glm::normalize(glm::vec3(1e-8F, 1, 0))}) {
    const PlateDirection d = plate_direction(frame, {.01F, 0, .01F}, towards);
    EXPECT_TRUE(std::isfinite(d.phi) && std::isfinite(d.stretch));
    EXPECT_LT(azimuth_weight(d.planar), 1e-6F);
  }
}

}  // namespace
}  // namespace pelage::test
