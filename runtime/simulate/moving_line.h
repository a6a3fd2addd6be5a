// Private to this box: a line with its frames, to be evaluated anywhere: Catmull-Rom through its vertices, frames
// interpolated between them. Made once per thread and set to one line after the other, so that none allocates.
#pragma once

#include <algorithm>
#include <array>
#include <cstddef>
#include <glm/ext/quaternion_float.hpp>
#include <glm/vec3.hpp>
#include <span>
#include <vector>

#include "pelage/simulate/rotation_frames.h"

namespace pelage {

/// Four floats that are added and multiplied together.
using Four = float __attribute__((vector_size(16)));

class MovingLine {
 public:
  /// @param line  >= 1 vertex   @param frames  of its vertices
  void set(std::span<const glm::vec3> line, const glm::quat* frames) {
    segments_.resize(std::max<std::size_t>(line.size(), 2) - 1);
    const std::size_t last = line.size() - 1;
    // The curve goes on straight beyond both ends.
    glm::vec3 here = line[std::min<std::size_t>(1, last)] - line[0], before = here;
    for (std::size_t k = 0; k < segments_.size(); ++k) {
      const glm::vec3 after = k + 2 <= last ? line[k + 2] - line[k + 1] : here;
      const glm::quat &a = frames[k], &b = frames[std::min(k + 1, last)];
      Segment& s = segments_[k];
      s.from = four(line[k]), s.step = four(here), s.before = four(before - here), s.after = four(after - here);
      s.frame = Four{a.x, a.y, a.z, a.w};
      s.turn = Four{b.x, b.y, b.z, b.w} - s.frame;
      const Four squares = s.turn * s.turn;
      s.apart = squares[0] + squares[1] + squares[2] + squares[3];
      before = here, here = after;
    }
  }
  /// Frames from the first, see rotation_frames().
  void set(std::span<const glm::vec3> line, const glm::quat& first) {
    frames_.resize(line.size());
    rotation_frames(line, first, frames_);
    set(line, frames_.data());
  }

  /// What lies at `offset` from the line in the frame at share f of segment k; f in the offset's last component.
  Four carried(std::size_t k, Four offset_and_share) const noexcept {
    const Segment& s = segments_[k];
    const Four f = __builtin_shufflevector(offset_and_share, offset_and_share, 3, 3, 3, 3), g = 1 - f;
    // Hermite's form by differences, which keeps the digits of the segment.
    const Four point = s.from + f * (s.step + (0.5F * g) * (g * s.before - f * s.after));
    const Four q = s.frame + f * s.turn, w = __builtin_shufflevector(q, q, 3, 3, 3, 3);
    const float share = offset_and_share[3];
    const float scale = 2.0F / (1.0F - share * (1.0F - share) * s.apart);  // of |q|^2, both ends being unit
    const Four across = cross(q, offset_and_share);
    return point + offset_and_share + scale * (w * across + cross(q, across));
  }
  glm::vec3 point(std::size_t k, float f) const noexcept { return vec(carried(k, Four{0, 0, 0, f})); }
  /// The offset that carried() takes to `place`.
  glm::vec3 offset_of(const glm::vec3& place, std::size_t k, float f) const noexcept {
    const Four q = segments_[k].frame + f * segments_[k].turn;
    return turned(glm::quat(q[3], -q[0], -q[1], -q[2]), place - point(k, f));
  }

  static glm::vec3 vec(Four v) noexcept { return {v[0], v[1], v[2]}; }

 private:
  struct Segment {
    Four from, step;     // vertex, to the next
    Four before, after;  // the steps before and after less this one
    Four frame, turn;    // x, y, z, w at the vertex; to that at the next
    float apart;         // |turn|^2
  };
  static Four four(const glm::vec3& v) noexcept { return Four{v.x, v.y, v.z, 0}; }
  /// Of the first three components; the last is 0.
  static Four cross(Four a, Four b) noexcept {
    const Four c = a * __builtin_shufflevector(b, b, 1, 2, 0, 3) - __builtin_shufflevector(a, a, 1, 2, 0, 3) * b;
    return __builtin_shufflevector(c, c, 1, 2, 0, 3);
  }

  std::vector<Segment> segments_;
  std::vector<glm::quat> frames_;
};

/// Up to kFrameLanes lines at once: their frames are computed together.
class MovingLines {
 public:
  void set(std::span<const std::span<const glm::vec3>> lines, std::span<const glm::quat> first) {
    std::size_t stride = 1;
    for (const auto& line : lines) stride = std::max(stride, line.size());
    frames_.resize(stride * kFrameLanes);
    rotation_frames(lines, first, frames_, stride);
    for (std::size_t l = 0; l < lines.size(); ++l)
      if (!lines[l].empty()) lines_[l].set(lines[l], frames_.data() + l * stride);
  }
  const MovingLine& operator[](std::size_t l) const noexcept { return lines_[l]; }

 private:
  std::array<MovingLine, kFrameLanes> lines_;
  std::vector<glm::quat> frames_;  // [line][stride]
};

}  // namespace pelage
