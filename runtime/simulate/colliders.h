// What hair stays outside of: spheres, capsules, triangle meshes (distance fields), resting, moving by themselves or
// with the head.
//
// A sphere or capsule that moves farther than its radius in a step counts as the volume that it sweeps, so that it does
// not jump over hair: the rounded segment or the two rounded triangles between both places (an arc counts as its
// chord). Poses are related to each other in double; distances are floats near the pivot, good to 4e-7 of the distance
// from it. Limits: the mesh is not swept (its hair moves with it), and where solids overlap a point is pushed out of
// the one it is deeper in.
#pragma once

#include <cstddef>
#include <glm/mat3x3.hpp>
#include <memory>
#include <vector>

#include "pelage/data_schema/mesh.h"
#include "pelage/data_schema/simulation_settings.h"
#include "pelage/simulate/mesh_distance.h"
#include "pelage/simulate/rigid_pose.h"
#include "pelage/simulate/strand_blocks.h"

namespace pelage {

/// Nearest surface of a lane's point. Grid frame: world's axes, origin at the head's pivot at the end of the step.
struct Nearest {
  Lanes distance;       // [m], negative inside
  Lanes3 normal;        // outward, unit
  Lanes3 displacement;  // of the surface there during the step [m], of the world
};

/// How the surface point q (grid frame, at the end of the step) moved: offset + turn q.
struct SurfaceMotion {
  glm::vec3 offset_m{0};
  glm::mat3 turn{0};
};

/// A capsule during a step: the rounded segment (a, b), or swept, the rounded triangles (a, b, c) and (b, c, d).
struct CapsuleSolid {
  glm::vec3 a, b, c, d;
  bool swept = false;
  float radius_m;
  glm::vec3 normal;  // of a point on the segment or the triangles
  SurfaceMotion motion;
};

class Colliders {
 public:
  /// @param head  mesh in world coordinates at rest, may be empty      @param pivot  of the head at rest
  /// @throws UsageError for a capsule, InputError for a mesh that is not finite
  Colliders(const CollisionSettings& settings, const Mesh& head, const glm::dvec3& pivot);

  bool empty() const noexcept;
  /// Where everything is during the step from `before` to `after`, `time_s` being its end.
  void move(const RigidPose& before, const RigidPose& after, double time_s, double step_s);
  /// Distance to the union of all, where it matters: beyond `reach_m` any distance > reach_m will do.
  void nearest(const Lanes3& points, float reach_m, Nearest& out) const noexcept;

  /// The head's field in the head's axes, relative to the pivot; null without a head.
  const MeshDistance* field() const noexcept { return field_.get(); }

 private:
  void nearest_of_field(const Lanes3& points, float reach_m, Nearest& out) const noexcept;
  CapsuleSolid solid_of(const ColliderCapsule& capsule, const RigidPose& before, const RigidPose& after, double time_s,
                        double step_s) const;

  std::vector<ColliderCapsule> capsules_;
  glm::dvec3 rest_pivot_;
  std::shared_ptr<const MeshDistance> field_;
  SurfaceMotion head_motion_;
  glm::mat3 head_turn_{1};            // from the head's axes to the world's
  std::vector<CapsuleSolid> solids_;  // as they are during the step
};

}  // namespace pelage
