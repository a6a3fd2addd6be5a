// Curves and clusters that several tests use.
#pragma once

#include <cmath>
#include <cstdint>
#include <glm/geometric.hpp>
#include <glm/vec3.hpp>
#include <random>
#include <vector>

#include "pelage/data_schema/cluster.h"
#include "pelage/data_schema/strands.h"
#include "pelage/hair/cluster_curve.h"

namespace pelage::test {

/// Control points of a spline fitted to curve(u), u in [0,1].
template <class Curve>
std::vector<glm::vec3> controls_of(std::size_t controls, const Curve& curve) {
  std::vector<hair::CurveSample> samples;
  for (int i = 0; i <= 400; ++i) samples.push_back({i / 400.0, curve(i / 400.0), 1.0});
  return hair::fit_curve(samples, {}, controls, 0.0);
}

struct NamedLine {
  const char* name;
  std::vector<glm::vec3> control;
};

/// HARD_CASES 15, 25, 26, at the scale of hair.
inline std::vector<NamedLine> hard_lines() {
  std::vector<NamedLine> lines{
      {"straight", {{0, 0, 0}, {0, -.1F, 0}, {0, -.2F, 0}, {0, -.3F, 0}}},
      {"inflection", {{0, 0, 0}, {.1F, 0, 0}, {.1F, .1F, 0}, {.2F, .1F, 0}, {.2F, .2F, 0}}},
      {"fold", {{0, 0, 0}, {.1F, 0, 0}, {.2F, 0, 0}, {.1F, 0, 0}, {0, 0, 0}}},
      {"fold between samples", {{0, 0, 0}, {.13F, 0, 0}, {.17F, 0, 0}, {.11F, 0, 0}, {.02F, 0, 0}, {-.1F, 0, 0}}},
      {"hairpin 1 um wide", {{0, 0, 0}, {.1F, 0, 0}, {.2F, 0, 0}, {.2F, 1e-6F, 0}, {.1F, 1e-6F, 0}, {0, 1e-6F, 0}}},
      {"duplicates inside", {{0, 0, 0}, {.1F, 0, 0}, {.1F, 0, 0}, {.1F, 0, 0}, {.1F, .1F, 0}, {.1F, .1F, .1F}}},
      {"duplicates at the ends", {{0, 0, 0}, {0, 0, 0}, {0, 0, 0}, {.1F, 0, 0}, {.1F, .1F, 0}, {.1F, .1F, 0}}},
      {"loop", {{0, 0, 0}, {.2F, 0, 0}, {0, .2F, 0}, {0, 0, 0}}},
      {"far away", {{1000, 0, 0}, {1000, 1, 0}, {1001, 1, 0}, {1001, 1, 1}}}};
  std::mt19937 random(7);
  std::uniform_real_distribution<float> uniform(-.1F, .1F);
  for (int i = 0; i < 40; ++i) {
    NamedLine line{"random", {}};
    for (int k = 0; k < 4 + i % 7; ++k) line.control.emplace_back(uniform(random), uniform(random), uniform(random));
    lines.push_back(line);
  }
  return lines;
}

/// A bent line with a growing, turning ellipse.
inline Cluster bent_cluster() {
  Cluster c;
  c.centre_line = {{0, 0, 0},          {0, .03F, 0},        {.05F, .06F, 0},
                   {.12F, .02F, .02F}, {.15F, -.05F, .04F}, {.15F, -.12F, .05F}};
  c.cross_sections = {cross_section({.006F, .004F, .1F}), cross_section({.008F, .005F, .3F}),
                      cross_section({.010F, .006F, .5F}), cross_section({.010F, .008F, .9F})};
  return c;
}

/// `count` strands of `vertices` vertices that run through the cluster at constant disk coordinates, spread evenly over
/// the disk, each over its own t-range.
inline Strands strands_in(const Cluster& cluster, int count, int vertices) {
  const CentreLine line(cluster.centre_line, cluster.first_normal);
  std::mt19937 random(11);
  std::uniform_real_distribution<double> uniform(0.0, 1.0);
  Strands strands;
  for (int i = 0; i < count; ++i) {
    const double v = std::sqrt(uniform(random)), u = 6.283185307179586 * uniform(random);
    const double first = 0.1 * uniform(random), last = 1 - 0.1 * uniform(random);
    const glm::vec2 disk(v * std::cos(u), v * std::sin(u));
    std::vector<glm::vec3> points;
    for (int k = 0; k < vertices; ++k) {
      const double t = first + (last - first) * k / (vertices - 1);
      const Frame f = line.frame(t);
      const glm::vec2 p =
          evaluate_b_spline(std::span<const CrossSection>(cluster.cross_sections), static_cast<float>(t)).apply(disk);
      points.push_back(f.position + p.x * f.normal + p.y * f.binormal);
    }
    strands.append(points);
  }
  return strands;
}

}  // namespace pelage::test
