// Rotation-minimising frames along polylines by double reflection [Wang2008, "Computation of Rotation Minimizing
// Frames", Table I], as quaternions: two reflections are one rotation, (v1 . v2, v1 x v2) up to its length.
//
// A frame is a unit quaternion that takes z to the tangent and x to the normal (y: the binormal). The tangent of an
// inner vertex is that of the chord between its neighbours. Consecutive frames lie in the same half-space of
// quaternions, so that they can be interpolated componentwise. Where the line stands still or folds onto itself the
// frame turns as little as possible, about its own normal if need be: always finite, never a flip of the normal.
#pragma once

#include <cmath>
#include <cstddef>
#include <glm/ext/quaternion_float.hpp>
#include <glm/geometric.hpp>
#include <glm/vec3.hpp>
#include <span>

namespace pelage {

inline glm::vec3 frame_tangent(const glm::quat& q) noexcept {
  return {2 * (q.x * q.z + q.w * q.y), 2 * (q.y * q.z - q.w * q.x), 1 - 2 * (q.x * q.x + q.y * q.y)};
}
inline glm::vec3 frame_normal(const glm::quat& q) noexcept {
  return {1 - 2 * (q.y * q.y + q.z * q.z), 2 * (q.x * q.y + q.w * q.z), 2 * (q.x * q.z - q.w * q.y)};
}

/// `v` turned by q, which need not be of unit length (> 0).
inline glm::vec3 turned(const glm::quat& q, const glm::vec3& v) noexcept {
  const glm::vec3 u(q.x, q.y, q.z);
  const float uu = glm::dot(u, u), scale = 1.0F / (q.w * q.w + uu);
  return scale * ((q.w * q.w - uu) * v + 2 * glm::dot(u, v) * u + 2 * q.w * glm::cross(u, v));
}

/// The frame turned as little as possible so that its tangent is the unit vector `tangent`.
glm::quat carried_to(const glm::quat& frame, const glm::vec3& tangent) noexcept;

/// First direction of a polyline that is none of rounding, or `otherwise` where it has no length.
glm::vec3 first_direction(std::span<const glm::vec3> line, const glm::vec3& otherwise) noexcept;

/// Frame of a line at rest: from the head's axes by the smallest turn.
glm::quat first_frame(std::span<const glm::vec3> line) noexcept;

/// Frames of all vertices. The first is `first` carried to the line's first direction: give the frame that the line had
/// at rest, turned with the head, and what rides on the frames turns with the head and does not spin.
void rotation_frames(std::span<const glm::vec3> line, const glm::quat& first, std::span<glm::quat> frames) noexcept;

inline constexpr std::size_t kFrameLanes = 8;

/// The same of up to kFrameLanes lines at once, one SIMD lane each: the same bits, sooner. Lines may be of different
/// lengths. @param frames  [line][stride], stride >= the longest line
void rotation_frames(std::span<const std::span<const glm::vec3>> lines, std::span<const glm::quat> first,
                     std::span<glm::quat> frames, std::size_t stride) noexcept;

}  // namespace pelage
