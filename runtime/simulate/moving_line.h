// Private to this box: a line with its frames, to be evaluated anywhere: Catmull-Rom through its vertices, frames
// interpolated between them. Made once per thread and set to one line after the other, so that none allocates.
#pragma once

#include <cstddef>
#include <glm/ext/quaternion_float.hpp>
#include <glm/vec3.hpp>
#include <span>
#include <vector>

#include "pelage/simulate/rotation_frames.h"

namespace pelage {

class MovingLine {
 public:
  /// @param line  >= 1 vertex   @param first  see rotation_frames()
  void set(std::span<const glm::vec3> line, const glm::quat& first) {
    line_ = line;
    frames_.resize(line.size() + 1);
    rotation_frames(line, first, std::span(frames_).first(line.size()));
    frames_[line.size()] = frames_[line.size() - 1];
    // The curve goes on straight beyond both ends.
    steps_.resize(line.size() + 2);
    for (std::size_t i = 1; i < line.size(); ++i) steps_[i] = line[i] - line[i - 1];
    steps_[0] = line.size() > 1 ? steps_[1] : glm::vec3(0);
    steps_[line.size()] = steps_[line.size() - 1];
    steps_[line.size() + 1] = glm::vec3(0);
  }

  /// Place on segment k at share f; Hermite's form by differences, which keeps the digits of the segment.
  glm::vec3 point(std::size_t k, float f) const noexcept {
    const glm::vec3 &before = steps_[k], &here = steps_[k + 1], &after = steps_[k + 2];
    const glm::vec3 bend = (1 - f) * (before - here) - f * (after - here);
    return line_[k] + (f * here + (0.5F * f * (1 - f)) * bend);
  }
  /// Not of unit length.
  glm::quat frame(std::size_t k, float f) const noexcept {
    const glm::quat &a = frames_[k], &b = frames_[k + 1];
    return {a.w + f * (b.w - a.w), a.x + f * (b.x - a.x), a.y + f * (b.y - a.y), a.z + f * (b.z - a.z)};
  }
  const glm::quat& vertex_frame(std::size_t k) const noexcept { return frames_[k]; }

 private:
  std::span<const glm::vec3> line_;
  std::vector<glm::quat> frames_;  // [vertices + 1], the last twice
  std::vector<glm::vec3> steps_;   // [i] from vertex i - 1 to i
};

}  // namespace pelage
