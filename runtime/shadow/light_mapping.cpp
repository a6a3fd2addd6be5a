#include "pelage/shadow/light_mapping.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstring>
#include <glm/geometric.hpp>
#include <glm/matrix.hpp>
#include <string>

#include "pelage/data_schema/errors.h"

#define PELAGE_CLONES __attribute__((target_clones("avx512f", "avx2", "default")))

namespace pelage {
namespace {

/// Beyond this squares of lengths in cells leave float; hair is metres away, not light seconds.
constexpr float kFarthest_m = 1e9F;
/// Nearer than this to a point light along the axis a slope has no digits left.
constexpr float kNearest_m = 1e-6F;

using Lanes = float __attribute__((vector_size(64)));
constexpr std::size_t kLanes = 16;

/// Per lane: a reduction that the compiler may not reorder by itself.
struct Extremes {
  Lanes low[3], high[3];
  Lanes odd;  // NaN once a coordinate was not finite, else 0
};

/// Widens the extremes by whole lanes of positions.
PELAGE_CLONES void widen(const CellBlock& b, std::size_t n, Extremes& e) noexcept {
  const float* const axes[3] = {b.x.data(), b.y.data(), b.z.data()};
  for (std::size_t axis = 0; axis < 3; ++axis) {
    Lanes low = e.low[axis], high = e.high[axis], odd = e.odd;
    for (std::size_t i = 0; i < n; i += kLanes) {
      Lanes v;
      std::memcpy(&v, axes[axis] + i, sizeof v);
      low = v < low ? v : low;
      high = v > high ? v : high;
      odd += v - v;
    }
    e.low[axis] = low, e.high[axis] = high, e.odd = odd;
  }
}

[[noreturn]] void refuse(std::span<const glm::vec3> points) {
  for (std::size_t i = 0; i < points.size(); ++i) {
    for (int axis = 0; axis < 3; ++axis) {
      if (std::abs(points[i][axis]) <= kFarthest_m) continue;
      throw InputError("shadow", "vertex " + std::to_string(i) +
                                     " has a coordinate that is not finite or beyond 1e9 m; check the hair and its "
                                     "transforms");
    }
  }
  throw InputError("shadow", "the hair has a coordinate that is not finite, or beyond 1e9 m from its first vertex");
}

/// m: rows of the scaled axes; c: centre; o: offset.
PELAGE_CLONES void parallel_cells(const float* __restrict m, const float* __restrict c, const float* __restrict o,
                                  const float* __restrict p, std::size_t n, float* __restrict x, float* __restrict y,
                                  float* __restrict z) noexcept {
  for (std::size_t i = 0; i < n; ++i) {
    const float dx = p[3 * i] - c[0], dy = p[3 * i + 1] - c[1], dz = p[3 * i + 2] - c[2];
    x[i] = m[0] * dx + m[1] * dy + m[2] * dz + o[0];
    y[i] = m[3] * dx + m[4] * dy + m[5] * dz + o[1];
    z[i] = m[6] * dx + m[7] * dy + m[8] * dz + o[2];
  }
}

}  // namespace

float SliceMap::operator()(float x) const noexcept {
  if (at.empty()) return x;
  const float last = static_cast<float>(at.size() - 1);
  const float step = x * steps_per_cell, bounded = std::min(step > 0 ? step : 0.0F, last);  // NaN too
  const auto i = std::min(static_cast<std::size_t>(bounded), at.size() - 2);
  return at[i] + (bounded - static_cast<float>(i)) * (at[i + 1] - at[i]);
}

glm::vec3 LightMapping::local(glm::vec3 p) const noexcept {
  return (p - centre) * axes;  // dot products with the columns
}

glm::vec3 LightMapping::cells_of_local(glm::vec3 p) const noexcept {
  if (point_light) {
    const float x = std::max(p.x, kNearest_m);
    p = {p.x, p.y / x, p.z / x};
  }
  p = p * cells_per_unit + offset;
  p.x = slices(p.x);
  return p;
}

void LightMapping::cells(std::span<const glm::vec3> points, CellBlock& out) const noexcept {
  if (point_light) {
    for (std::size_t i = 0; i < points.size(); ++i) {
      const glm::vec3 p = cells(points[i]);
      out.x[i] = p.x, out.y[i] = p.y, out.z[i] = p.z;
    }
    return;
  }
  const glm::mat3 rows{axes[0] * cells_per_unit.x, axes[1] * cells_per_unit.y, axes[2] * cells_per_unit.z};
  parallel_cells(&rows[0][0], &centre[0], &offset[0], points.empty() ? nullptr : &points[0][0], points.size(),
                 out.x.data(), out.y.data(), out.z.data());
  if (slices.at.empty()) return;
  for (std::size_t i = 0; i < points.size(); ++i) out.x[i] = slices(out.x[i]);
}

glm::mat3 light_axes(glm::vec3 to_light) {
  // Scaled first: squares of a very long or short vector leave float.
  const float largest = std::max({std::abs(to_light.x), std::abs(to_light.y), std::abs(to_light.z)});
  if (!(largest > 0.0F) || !std::isfinite(to_light.x + to_light.y + to_light.z)) {
    throw InputError("light", "the direction (" + std::to_string(to_light.x) + ", " + std::to_string(to_light.y) +
                                  ", " + std::to_string(to_light.z) +
                                  ") is none; give a finite vector that is not zero");
  }
  const glm::vec3 x = -glm::normalize(to_light / largest);
  const glm::vec3 helper = std::abs(x.x) < 0.6F ? glm::vec3(1, 0, 0) : glm::vec3(0, 1, 0);
  const glm::vec3 y = glm::normalize(glm::cross(helper, x));
  return {x, y, glm::cross(x, y)};
}

Box box_along(const glm::mat3& axes, glm::vec3 centre, std::span<const glm::vec3> points) {
  if (points.empty()) return {};
  LightMapping mapping;
  mapping.axes = axes;
  mapping.centre = centre;
  CellBlock at{};
  Extremes e{};
  for (int axis = 0; axis < 3; ++axis) e.low[axis] = Lanes{} + 3e38F, e.high[axis] = Lanes{} - 3e38F;
  for (std::size_t i = 0; i < points.size(); i += CellBlock::kSize) {
    std::size_t n = std::min(CellBlock::kSize, points.size() - i);
    mapping.cells(points.subspan(i, n), at);
    for (; n % kLanes != 0; ++n) at.x[n] = at.x[n - 1], at.y[n] = at.y[n - 1], at.z[n] = at.z[n - 1];
    widen(at, n, e);
  }
  Box box{glm::vec3(3e38F), glm::vec3(-3e38F)};
  bool odd = false;
  for (std::size_t lane = 0; lane < kLanes; ++lane) odd = odd || e.odd[lane] != 0;  // NaN is not 0
  for (int axis = 0; axis < 3; ++axis) {
    for (std::size_t lane = 0; lane < kLanes; ++lane) {
      box.low[axis] = std::min(box.low[axis], e.low[axis][lane]);
      box.high[axis] = std::max(box.high[axis], e.high[axis][lane]);
    }
  }
  const glm::vec3 farthest = glm::max(glm::abs(box.low), glm::abs(box.high));
  if (odd || std::max({farthest.x, farthest.y, farthest.z}) > kFarthest_m) refuse(points);
  return box;
}

float constant_extent_m(const Strands& strands) noexcept {
  glm::vec3 low(3e38F), high(-3e38F);
  double longest = 0;
  for (std::size_t s = 0; s < strands.count(); ++s) {
    const auto points = strands.strand(s);
    double length = 0;
    for (std::size_t i = 1; i < points.size(); ++i)
      length += static_cast<double>(glm::distance(points[i - 1], points[i]));
    longest = std::max(longest, length);
    if (!points.empty()) low = glm::min(low, points[0]), high = glm::max(high, points[0]);
  }
  const glm::vec3 head = glm::max(high - low, 0.0F);
  return static_cast<float>(2.0 * longest) + std::max({head.x, head.y, head.z});
}

}  // namespace pelage
