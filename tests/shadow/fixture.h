// Hair for the tests of shadows.
#pragma once

#include <algorithm>
#include <cmath>
#include <glm/geometric.hpp>
#include <random>
#include <vector>

#include "pelage/data_schema/strands.h"
#include "pelage/shadow/hair_shadow.h"

namespace pelage::test {

inline Light light_from(glm::vec3 towards) {
  Light light;
  light.direction = towards;
  return light;
}

inline Light light_at(glm::vec3 position) {
  Light light;
  light.position = position;
  return light;
}

/// Wavy strands in locks, 20 points each, in a box of some 20 cm around the origin.
inline Strands clumped_hair(std::size_t strands, unsigned seed = 7) {
  std::mt19937 random(seed);
  std::normal_distribution<float> normal;
  Strands s;
  s.diameter_m = 2e-4F;
  glm::vec3 lock{0};
  for (std::size_t i = 0; i < strands; ++i) {
    if (i % 20 == 0) lock = 0.04F * glm::vec3(normal(random), normal(random), normal(random));
    const glm::vec3 root = lock + 0.004F * glm::vec3(normal(random), normal(random), normal(random));
    std::vector<glm::vec3> line;
    for (int k = 0; k < 20; ++k) {
      const float t = static_cast<float>(k) / 19;
      line.push_back(
          root + glm::vec3(0.01F * std::sin(9 * t + lock.x * 99), -0.12F * t, 0.01F * std::cos(7 * t + lock.y * 99)));
    }
    s.append(line);
  }
  return s;
}

/// As a shader reads it: the mean of four taps where the texture asks for it.
inline float read_texture(const DepthTexture& t, glm::vec3 p) {
  const glm::vec3 at = glm::vec3(t.world_to_cell * glm::vec4(p, 1));
  float sum = 0;
  for (int tap = 0; tap < 4; ++tap) {
    const glm::vec3 moved = at + t.tap_cells * glm::vec3(0, tap & 1 ? 1 : -1, tap & 2 ? 1 : -1);
    const glm::vec3 held = glm::clamp(moved, glm::vec3(0), glm::vec3(t.size - 1));
    const glm::ivec3 base = glm::min(glm::ivec3(held), t.size - 2);
    const glm::vec3 f = held - glm::vec3(base);
    float value = 0;
    for (int corner = 0; corner < 8; ++corner) {
      const glm::ivec3 c{corner >> 2, (corner >> 1) & 1, corner & 1};
      const float w = (c.x ? f.x : 1 - f.x) * (c.y ? f.y : 1 - f.y) * (c.z ? f.z : 1 - f.z);
      const glm::ivec3 cell = base + c;
      value += w * t.values[static_cast<std::size_t>((cell.x * t.size.y + cell.y) * t.size.z + cell.z)];
    }
    sum += 0.25F * (t.transmittance ? value : std::exp(-value));
  }
  return sum;
}

}  // namespace pelage::test
