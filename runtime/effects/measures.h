// What gates measure of hair: cheap where hair is dense, which is where the answer is known at once.
#pragma once

#include <glm/vec3.hpp>
#include <span>

#include "pelage/data_schema/cluster.h"
#include "pelage/data_schema/mesh.h"
#include "pelage/data_schema/scene.h"
#include "pelage/data_schema/strands.h"

namespace pelage {

struct Extent {
  glm::vec3 low{1e30F}, high{-1e30F};
  bool empty() const noexcept { return low.x > high.x; }
  /// From a point to the nearest of the box [m]; 0 inside.
  float distance_m(glm::vec3 p) const noexcept;
};
Extent extent_of(std::span<const glm::vec3> points) noexcept;
/// Of its envelope, untransformed: B-splines lie within their control points' hull.
Extent extent_of(const Cluster& cluster) noexcept;

/// Can two strands ever come within `near_m` of each other, however they move about roots that keep their distances?
/// Conservative: of boxes around roots, as wide as the strands are long.
bool strands_can_meet(const Strands& strands, float near_m);

/// Of the longest strand, along it [m].
float longest_strand_m(const Strands& strands) noexcept;

/// Most by which a centripetal Catmull-Rom curve through the vertices (runtime/hair/catmull_rom.h) leaves the polyline
/// [m]: Hermite's cubics deviate from the chord by at most 4/27 of what the tangents have across it.
float curve_deviation_m(const Strands& strands) noexcept;

/// Least distance between any root and the capsule, less the strand's length, the radius and `margin_m` [m]: where it
/// is positive the capsule is out of reach while it keeps its place among the roots.
float out_of_reach_m(const Strands& strands, const ColliderCapsule& capsule, float margin_m) noexcept;
/// The same for what lies within a box.
float out_of_reach_m(const Strands& strands, const Extent& box, float margin_m) noexcept;

/// Can light that leaves the cluster in this direction meet it again? Yes where two parts farther apart along it than
/// four of its radii overlap as the light sees them, or where it turns by more than 30 degrees within that length.
/// Else all but a thousandth of the light that leaves a plate's rim meets no hair again (tests/effects).
bool may_shade_itself(const SweptCluster& cluster, glm::vec3 to_light) noexcept;

}  // namespace pelage
