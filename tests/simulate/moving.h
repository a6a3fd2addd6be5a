// Hair and heads for tests of the whole simulation.
#pragma once

#include <cmath>
#include <glm/gtc/quaternion.hpp>
#include <vector>

#include "pelage/simulate/simulation.h"

namespace pelage {

/// `strands` strands of `vertices` vertices and 0.3 m on the upper half of a ball of 0.1 m around (0, 1.6, 0), standing
/// out and bent down.
inline Strands ball_of_hair(std::size_t strands, int vertices, float length_m = 0.3F) {
  Strands hair;
  for (std::size_t s = 0; s < strands; ++s) {
    const float turn = 2.3999632F * static_cast<float>(s);
    const float y = 1.0F - 0.9F * (static_cast<float>(s) + 0.5F) / static_cast<float>(strands);
    const glm::vec3 out(std::sqrt(1 - y * y) * std::cos(turn), y, std::sqrt(1 - y * y) * std::sin(turn));
    glm::vec3 p = glm::vec3(0, 1.6F, 0) + 0.1F * out, d = out;
    std::vector<glm::vec3> points{p};
    const float segment = length_m / static_cast<float>(vertices - 1);
    for (int i = 1; i < vertices; ++i) {
      p += segment * d;
      points.push_back(p);
      d += glm::vec3(0, -0.25F, 0);
      d /= std::sqrt(d.x * d.x + d.y * d.y + d.z * d.z);
    }
    hair.append(points);
  }
  return hair;
}

/// Without wind, caps, collisions, hold and cone: gravity, damping and hair among hair. Steps and vertices are those
/// that the bounds of these tests were measured with.
inline SimulationSettings bare(bool grid = true) {
  SimulationSettings s;
  s.life.step_s = 1.0 / 480;
  s.vertices = 16;
  if (!grid) s.interaction.friction_per_s = s.interaction.repulsion_m_s2 = 0;
  s.collision.head = false;
  return s;
}

inline RigidPose turned(const glm::dvec3& pivot, double turn_rad, const glm::dvec3& shift = glm::dvec3(0)) {
  return {pivot + shift, glm::angleAxis(turn_rad, glm::dvec3(0, 1, 0))};
}

inline double worst_stretch_of(const Simulation& simulation) {
  const StrandBlocks& b = simulation.blocks();
  double worst = 0;
  for (std::size_t s = 0; s < b.strands; ++s) {
    const std::size_t block = b.block_of[s] / kLanes, lane = b.block_of[s] % kLanes;
    const double rest = static_cast<double>(b.segment_m[block].v[lane]);
    for (std::uint32_t i = 1; static_cast<float>(i) < b.vertices[block].v[lane]; ++i) {
      const Lanes3 &p = b.position[b.first[block] + i], &q = b.position[b.first[block] + i - 1];
      const double x = static_cast<double>(p.x[lane]) - static_cast<double>(q.x[lane]),
                   y = static_cast<double>(p.y[lane]) - static_cast<double>(q.y[lane]),
                   z = static_cast<double>(p.z[lane]) - static_cast<double>(q.z[lane]);
      if (rest > 0) worst = std::max(worst, std::abs(std::sqrt(x * x + y * y + z * z) / rest - 1));
    }
  }
  return worst;
}

}  // namespace pelage
