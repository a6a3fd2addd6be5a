// Strands made for the tests of the strand renderer.
#pragma once

#include <cmath>
#include <random>

#include "fixture.h"
#include "pelage/render/strand_frame.h"

namespace pelage::test {

/// In [0, 1), the same on every machine.
inline float unit(std::mt19937& random) {
  return static_cast<float>(random() >> 8) * 0x1p-24F;
}

/// A wavy lock that hangs from `root` down, 20 cm long and 2 cm thick.
inline Strands strand_lock(std::size_t count, int vertices = 24, glm::vec3 root = {0, 0.1F, 0},
                           std::uint32_t seed = 1) {
  std::mt19937 random(seed);
  Strands strands;
  strands.diameter_m = 3e-4F;
  std::vector<glm::vec3> points;
  for (std::size_t s = 0; s < count; ++s) {
    const float r = 0.01F * std::sqrt(unit(random)), phi = 6.2831853F * unit(random);
    const float phase = phi + 0.8F * unit(random);
    points.clear();
    for (int i = 0; i < vertices; ++i) {
      const float x = static_cast<float>(i) / static_cast<float>(vertices - 1);
      const glm::vec3 wave{0.006F * x * std::sin(14.0F * x + phase), 0, 0.006F * x * std::cos(14.0F * x + phase)};
      points.push_back(root + glm::vec3(r * std::cos(phi), -0.2F * x, r * std::sin(phi)) + wave);
    }
    strands.append(points);
  }
  return strands;
}

inline StrandFrameSettings strands_from_the_front() {
  StrandFrameSettings frame;
  frame.camera.eye = {0, 0, 0.6F};
  frame.camera.target = {0, 0, 0};
  frame.lights = {Light{}};
  frame.shadow.density_map.resolution = 32;
  return frame;
}

/// Every fragment has its strand's own colour, premultiplied with its alpha.
inline void shade_flat(StrandFrameSettings& frame) {
  frame.method = Method::unshadowed;
  frame.material.diffuse = frame.material.primary = frame.material.secondary = 0.0F;
  frame.material.ambient = 1.0F;
}

}  // namespace pelage::test
