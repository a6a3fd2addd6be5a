// Strands and turns for the tests of the simulation's shapes.
#pragma once

#include <gtest/gtest.h>

#include <cmath>
#include <filesystem>
#include <functional>
#include <glm/ext/quaternion_double.hpp>
#include <glm/ext/quaternion_trigonometric.hpp>
#include <glm/geometric.hpp>
#include <numbers>
#include <random>
#include <span>
#include <vector>

#include "pelage/data_schema/strands.h"
#include "pelage/hair/hair_file.h"

namespace pelage::test {

using glm::dvec3;
using glm::vec3;

inline constexpr double kPi = std::numbers::pi;

inline double length_of(std::span<const vec3> line) {
  double sum = 0;
  for (std::size_t i = 1; i < line.size(); ++i) sum += glm::distance(dvec3(line[i - 1]), dvec3(line[i]));
  return sum;
}

inline dvec3 turned_by(const glm::dquat& q, const dvec3& v) {
  const dvec3 u(q.x, q.y, q.z);
  return v + 2.0 * q.w * glm::cross(u, v) + 2.0 * glm::cross(u, glm::cross(u, v));
}

inline glm::dquat turn_about(const dvec3& axis, double angle_rad) {
  return glm::angleAxis(angle_rad, glm::normalize(axis));
}

/// Every vertex moved by a function of its place.
inline Strands moved(Strands strands, const std::function<dvec3(const dvec3&)>& to) {
  for (vec3& p : strands.vertices) p = vec3(to(dvec3(p)));
  return strands;
}

inline std::vector<vec3> curve(std::size_t vertices, const std::function<dvec3(double)>& at) {
  std::vector<vec3> points;
  for (std::size_t i = 0; i < vertices; ++i)
    points.emplace_back(at(static_cast<double>(i) / static_cast<double>(vertices - 1)));
  return points;
}

/// A walk in steps of `step_m` that turns by up to `bend_rad` at each.
inline std::vector<vec3> random_walk(std::mt19937& random, std::size_t vertices, double step_m, double bend_rad) {
  std::normal_distribution<double> normal;
  const auto direction = [&] { return glm::normalize(dvec3(normal(random), normal(random), normal(random))); };
  std::uniform_real_distribution<double> angle(0, bend_rad);
  dvec3 at = 0.1 * direction(), d = direction();
  std::vector<vec3> points{vec3(at)};
  while (points.size() < vertices) {
    d = turned_by(turn_about(glm::cross(d, direction()), angle(random)), d);
    points.emplace_back(at += step_m * d);
  }
  return points;
}

/// Strands of 1 to 40 vertices of all lengths, some without any length.
inline Strands random_strands(std::size_t count, unsigned seed) {
  std::mt19937 random(seed);
  Strands strands;
  for (std::size_t s = 0; s < count; ++s) {
    std::vector<vec3> points = random_walk(random, 1 + (s * 7) % 40, 0.002 + 0.001 * static_cast<double>(s % 13), 0.8);
    if (s % 17 == 3) points.assign(points.size(), points[0]);
    if (s % 11 == 5 && points.size() > 4) points[2] = points[3];
    strands.append(points);
  }
  return strands;
}

/// Largest distance between vertices, and the size of the hair.
inline double largest_distance(const Strands& a, const Strands& b) {
  double most = 0;
  for (std::size_t v = 0; v < a.vertices.size(); ++v) {
    const double d = glm::distance(dvec3(a.vertices[v]), dvec3(b.vertices[v]));
    if (!(d <= most)) most = d;  // keeps a NaN
  }
  return most;
}
inline double size_of(const Strands& strands) {
  double most = 0;
  for (const vec3& p : strands.vertices) most = std::max(most, glm::length(dvec3(p)));
  return most;
}

struct RealGroom {
  const char* name;
  const char* file;
  double metres_per_unit;
  hair::Curve curve;
};
inline constexpr RealGroom kRealGrooms[] = {
    {"sintel", "/../shared/data/sintel/sintel_hair_16points.tfx", 1, hair::Curve::polyline},
    {"ratboy", "/../shared/data/ratboy/Ratboy_mohawk.tfx", 1, hair::Curve::polyline},
    {"fur", "/../shared/data/fur/fur.hair", 0.1, hair::Curve::b_spline}};

/// Empty where the file is absent: skip then.
inline Strands read(const RealGroom& groom) {
  const std::filesystem::path file = std::string(PELAGE_SOURCE_DIR) + groom.file;
  if (!std::filesystem::exists(file)) return {};
  hair::ReadOptions options;
  options.metres_per_unit = groom.metres_per_unit;
  options.curve = groom.curve;
  options.check_unit = false;
  return hair::read_hair(file, options);
}

}  // namespace pelage::test
