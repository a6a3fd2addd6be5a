// From the world to the cells of one light's grid: parallel light, or the rays of a point light through one frustum.
//
// Parallel: x runs along the light's travel, y and z across it, cells of one size. Point light [Bertails2005 section 6,
// "angular space partition"]: x is the distance along the frustum's axis, y and z are slopes (tangents of angles), so
// that a column is what the light's rays pass.
#pragma once

#include <glm/mat3x3.hpp>
#include <glm/vec3.hpp>
#include <span>
#include <vector>

#include "pelage/data_schema/scene.h"
#include "pelage/data_schema/strands.h"
#include "pelage/shadow/depth_grid.h"

namespace pelage {

/// Monotone map of cells along the light: thin slices where much hair is. [Mertens2004] used clusters to this end.
struct SliceMap {
  std::vector<float> at;     // slice coordinate at even steps of x; empty: x itself
  float steps_per_cell = 1;  // of x before the map
  float operator()(float x) const noexcept;
};

struct LightMapping {
  glm::mat3 axes{1.0F};    // columns: unit vectors along the travel of light and across it
  glm::vec3 centre{0.0F};  // world; subtracted first, which keeps digits far from the origin. The point light's place
  glm::vec3 offset{0.0F};  // cells at `centre`
  glm::vec3 cells_per_unit{1};  // per metre; across a point light: per unit of slope
  bool point_light = false;
  SliceMap slices;

  float cell_across_m() const noexcept { return 1.0F / cells_per_unit.y; }  // parallel light
  glm::vec3 local(glm::vec3 p) const noexcept;                              // metres along the axes
  glm::vec3 cells_of_local(glm::vec3 p) const noexcept;
  glm::vec3 cells(glm::vec3 p) const noexcept { return cells_of_local(local(p)); }
  /// Positions of up to CellBlock::kSize points. A point light's own place goes to the first slice.
  void cells(std::span<const glm::vec3> points, CellBlock& out) const noexcept;
};

/// Columns: unit direction of travel, and two unit axes across it. @throws InputError when it has no direction
glm::mat3 light_axes(glm::vec3 to_light);

/// NaN where p is not finite, else 0: added to a result, a caller's error stays visible.
inline float not_finite(glm::vec3 p) noexcept {
  const float sum = p.x + p.y + p.z;
  return sum - sum;
}

struct Box {
  glm::vec3 low{0.0F}, high{0.0F};
  glm::vec3 extent() const noexcept { return high - low; }
  glm::vec3 middle() const noexcept { return 0.5F * (low + high); }
};

/// Box of points along `axes` seen from `centre`. Without points: all 0.
/// @throws InputError naming the vertex that is not finite or beyond 1e9 m
Box box_along(const glm::mat3& axes, glm::vec3 centre, std::span<const glm::vec3> points);

/// Side of a map that holds the hair however it moves [Bertails2005 section 2.2]: 2 l_max + h_max, with the longest
/// strand and the largest side of the roots' box.
float constant_extent_m(const Strands& strands) noexcept;

}  // namespace pelage
