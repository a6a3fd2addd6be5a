#include "pelage/simulate/rotation_frames.h"

#include <cstddef>

namespace pelage {
namespace {

using glm::quat;
using glm::vec3;

constexpr float kStandstill_m2 = 1e-18F;  // squares of shorter steps leave float's normal range before long
// Of |v2|^2, which is 4 on a straight line, and of 1 + cos of a turn: below kNoAxis the axis is rounding's, below
// kCoarseAxis it is off by more than the tangent may be, and a second, small turn sets that right.
constexpr float kNoAxis = 1e-9F, kCoarseAxis = 0.1F;

/// p q with the product scaled to unit length, p in the half-space of w >= 0: the turn p after the frame q.
quat turned_by(float w, const vec3& v, const quat& q) noexcept {
  const quat r(w * q.w - v.x * q.x - v.y * q.y - v.z * q.z, w * q.x + v.x * q.w + v.y * q.z - v.z * q.y,
               w * q.y - v.x * q.z + v.y * q.w + v.z * q.x, w * q.z + v.x * q.y - v.y * q.x + v.z * q.w);
  const float scale = std::copysign(1.0F / std::sqrt(r.w * r.w + r.x * r.x + r.y * r.y + r.z * r.z), w);
  return {scale * r.w, scale * r.x, scale * r.y, scale * r.z};
}

quat reflected_twice(const quat& frame, const vec3& chord, const vec3& to) noexcept {
  const vec3 from = frame_tangent(frame);
  const float c1 = glm::dot(chord, chord);
  if (!(c1 > kStandstill_m2)) return carried_to(frame, to);
  const vec3 v1 = chord / std::sqrt(c1), v2 = to - from + 2 * glm::dot(v1, from) * v1;
  const float c2 = glm::dot(v2, v2);
  if (!(c2 > kNoAxis)) return carried_to(frame, to);
  const quat turn = turned_by(glm::dot(v1, v2), glm::cross(v1, v2), frame);
  return c2 > kCoarseAxis ? turn : carried_to(turn, to);
}

}  // namespace

quat carried_to(const quat& frame, const vec3& tangent) noexcept {
  const vec3 from = frame_tangent(frame), sum = from + tangent;
  const float w = 0.5F * glm::dot(sum, sum);  // 1 + cos, exact where that cancels
  if (w > kCoarseAxis) return turned_by(w, glm::cross(from, tangent), frame);
  const quat turn =
      w > kNoAxis ? turned_by(w, glm::cross(from, tangent), frame) : turned_by(0, frame_normal(frame), frame);
  const vec3 now = frame_tangent(turn);
  return turned_by(1 + glm::dot(now, tangent), glm::cross(now, tangent), turn);
}

vec3 first_direction(std::span<const vec3> line, const vec3& otherwise) noexcept {
  for (std::size_t i = 1; i < line.size(); ++i) {
    const vec3 d = line[i] - line[i - 1];
    const float dd = glm::dot(d, d);
    if (dd > kStandstill_m2) return d / std::sqrt(dd);
  }
  return otherwise;
}

quat first_frame(std::span<const vec3> line) noexcept {
  return carried_to(quat(1, 0, 0, 0), first_direction(line, {0, 0, 1}));
}

void rotation_frames(std::span<const vec3> line, const quat& first, std::span<quat> frames) noexcept {
  if (line.empty()) return;
  vec3 tangent = first_direction(line, frame_tangent(first));
  quat frame = carried_to(first, tangent);
  frames[0] = frame;
  for (std::size_t i = 1; i < line.size(); ++i) {
    const vec3 across = line[i + 1 < line.size() ? i + 1 : i] - line[i - 1];
    const float length2 = glm::dot(across, across);
    if (length2 > kStandstill_m2) tangent = across / std::sqrt(length2);
    frame = reflected_twice(frame, line[i] - line[i - 1], tangent);
    frames[i] = frame;
  }
}

}  // namespace pelage
