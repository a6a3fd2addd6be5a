// What hair stays outside of: spheres, capsules, triangle meshes (distance fields), resting, moving by themselves or
// with the head.
#pragma once

#include <cstddef>
#include <memory>
#include <vector>

#include "pelage/data_schema/mesh.h"
#include "pelage/data_schema/simulation_settings.h"
#include "pelage/simulate/rigid_pose.h"
#include "pelage/simulate/strand_blocks.h"

namespace pelage {

/// Nearest surface of a lane's point. Grid frame: world's axes, origin at the head's pivot at the end of the step.
struct Nearest {
  Lanes distance;       // [m], negative inside
  Lanes3 normal;        // outward, unit
  Lanes3 displacement;  // of the surface there during the step [m], of the world
};

class Colliders {
 public:
  /// @param head  mesh in world coordinates at rest, may be empty      @param pivot  of the head at rest
  Colliders(const CollisionSettings& settings, const Mesh& head, const glm::dvec3& pivot);

  bool empty() const noexcept;
  /// Where everything is during the step from `before` to `after`, `time_s` being its end.
  void move(const RigidPose& before, const RigidPose& after, double time_s, double step_s);
  /// Distance to the union of all, where it matters: beyond `reach_m` any distance > reach_m will do.
  void nearest(const Lanes3& points, float reach_m, Nearest& out) const noexcept;
};

}  // namespace pelage
