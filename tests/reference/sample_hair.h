// Strands and rays for the tests of the truth. Deterministic.
#pragma once

#include <cmath>
#include <cstdint>
#include <glm/geometric.hpp>
#include <numbers>
#include <random>
#include <vector>

#include "pelage/data_schema/strands.h"
#include "pelage/reference/fibre_scene.h"

namespace pelage::sample {

class Random {
 public:
  explicit Random(unsigned seed) : engine_(seed) {}
  double in(double low, double high) { return low + (high - low) * (static_cast<double>(engine_()) * 0x1p-32); }
  glm::dvec3 in_cube(double half) { return {in(-half, half), in(-half, half), in(-half, half)}; }
  glm::dvec3 direction() {
    for (;;) {
      const glm::dvec3 v = in_cube(1);
      const double length = glm::length(v);
      if (length > 0.1 && length < 1) return v / length;
    }
  }

 private:
  std::mt19937 engine_;
};

inline Strands one_strand(const std::vector<glm::vec3>& points, float diameter_m) {
  Strands s;
  s.append(points);
  s.diameter_m = diameter_m;
  return s;
}

/// Segments here and there in a cube, each a strand.
inline Strands loose_segments(std::size_t count, double half, double length, float diameter_m, unsigned seed) {
  Random random(seed);
  Strands s;
  for (std::size_t i = 0; i < count; ++i) {
    const glm::dvec3 a = random.in_cube(half);
    s.append(std::vector<glm::vec3>{glm::vec3(a), glm::vec3(a + length * random.direction())});
  }
  s.diameter_m = diameter_m;
  return s;
}

/// Random walks: each step turns by up to `bend` (1: about 60 degrees; 10: anywhere).
inline Strands walks(std::size_t count, int segments, double half, double step, double bend, float diameter_m,
                     unsigned seed) {
  Random random(seed);
  Strands s;
  for (std::size_t i = 0; i < count; ++i) {
    glm::dvec3 at = random.in_cube(half), way = random.direction();
    std::vector<glm::vec3> points{glm::vec3(at)};
    for (int k = 0; k < segments; ++k) {
      way = glm::normalize(way + bend * random.direction());
      at += step * way;
      points.emplace_back(at);
    }
    s.append(points);
  }
  s.diameter_m = diameter_m;
  return s;
}

/// Helices around +Y.
inline Strands curls(std::size_t count, double half, double radius, double pitch, int per_turn, int turns,
                     float diameter_m, unsigned seed) {
  Random random(seed);
  Strands s;
  for (std::size_t i = 0; i < count; ++i) {
    const glm::dvec3 root = random.in_cube(half);
    std::vector<glm::vec3> points;
    for (int k = 0; k <= per_turn * turns; ++k) {
      const double angle = 2 * std::numbers::pi * k / per_turn;
      points.emplace_back(root + glm::dvec3(radius * std::cos(angle), pitch * k / per_turn, radius * std::sin(angle)));
    }
    s.append(points);
  }
  s.diameter_m = diameter_m;
  return s;
}

/// Parallel fibres of random place in a box of half sides `half`, along `tangent`, longer than the box by `more` on
/// either side: rays through the middle never see an end.
inline Strands parallel_fibres(std::size_t count, const glm::dvec3& half, const glm::dvec3& tangent, double length,
                               int segments, float diameter_m, unsigned seed) {
  Random random(seed);
  Strands s;
  for (std::size_t i = 0; i < count; ++i) {
    const glm::dvec3 middle(random.in(-half.x, half.x), random.in(-half.y, half.y), random.in(-half.z, half.z));
    std::vector<glm::vec3> points;
    for (int k = 0; k <= segments; ++k) {
      points.emplace_back(middle + length * (static_cast<double>(k) / segments - 0.5) * tangent);
    }
    s.append(points);
  }
  s.diameter_m = diameter_m;
  return s;
}

}  // namespace pelage::sample
