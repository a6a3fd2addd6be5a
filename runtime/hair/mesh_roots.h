// Roots on somebody's head mesh: spread evenly by area over the part of it where hair grows, which is told from the
// mesh's shape alone: the skull under its highest point, and on the skull the hairline of the parametric head
// (scalp.h). Darts are thrown on the triangles and taken where no root is nearer than a radius that shrinks until there
// are enough [Cook1986]. Limits: the face must look along an axis of the mesh, and the head must be upright.
#pragma once

#include <cstdint>
#include <functional>
#include <glm/vec3.hpp>
#include <string_view>
#include <vector>

#include "pelage/data_schema/mesh.h"
#include "pelage/hair/head.h"
#include "pelage/hair/scalp.h"

namespace pelage::hair {

/// Signed distance to the mesh [m], negative inside, and the unit direction outwards; called by many threads.
using DistanceField = std::function<HeadField::Sample(glm::vec3)>;

/// Where the face looks: "+z", "-z", "+x" or "-x". @throws UsageError
glm::vec3 parse_face(std::string_view name);

struct Skull {
  glm::vec3 centre_m{0};
  float height_m = 0.24F;   // of the head, crown to the middle of the neck
  glm::vec3 face{0, 0, 1};  // unit, horizontal

  /// A direction as the hairline knows it: face towards +Z.
  glm::vec3 to_own_axes(const glm::vec3& direction) const noexcept;
  bool grows_at(const glm::vec3& p) const noexcept;
};

/// The skull below the mesh's highest point. @param height_m  of the head, crown to the middle of the neck; a
/// bust below it does not matter
/// @throws UsageError for a mesh that is lower than half of that: a unit or a height to be given
Skull find_skull(const Mesh& mesh, float height_m, const glm::vec3& face);

/// Exactly `count` roots, in no order, with the mesh's own normals between its vertices. Surfaces that have others
/// within a centimetre above them (inner shells, folds) grow none. The result depends on the arguments only.
/// @throws InputError when the skull holds too little surface for roots
std::vector<Root> mesh_roots(const Mesh& mesh, const Skull& skull, const DistanceField& field, std::uint32_t count,
                             std::uint64_t seed);

}  // namespace pelage::hair
