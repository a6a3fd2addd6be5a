// Vertices that ride on lines, each at its own place with an offset in the line's frame there.
// What rides turns with the head and with its line, does not spin, and stays on its root where its offset there is 0.
#pragma once

#include <cstddef>
#include <cstdint>
#include <glm/ext/quaternion_double.hpp>
#include <glm/ext/quaternion_float.hpp>
#include <glm/vec3.hpp>
#include <span>
#include <vector>

#include "pelage/data_schema/strands.h"

namespace pelage {

class MovingLine;

struct Riders {
  struct Place {
    glm::vec3 offset{0};  // from the line, in the frame there [m]
    float fraction = 0;   // of the segment, [0, 1]
    std::uint32_t segment = 0;
  };
  std::vector<std::uint32_t> offsets{0};       // [strands + 1] of what rides
  std::vector<std::uint32_t> line_offsets{0};  // [strands + 1]
  std::vector<Place> places;                   // [vertices]
  std::vector<glm::quat> first;                // [strands] frame of the root at rest

  Riders() = default;
  /// Room for vertices with these offsets on lines at rest, frames of their roots; places are to be filled.
  Riders(std::vector<std::uint32_t> vertex_offsets, const Strands& lines);

  std::span<Place> strand(std::size_t s) noexcept {
    return std::span(places).subspan(offsets[s], offsets[s + 1] - offsets[s]);
  }
  /// One strand. @param line  set to the strand's line, its first frame turned with the head
  void ride(std::size_t s, const MovingLine& line, std::span<glm::vec3> out) const noexcept;
  /// All strands. @param turn  rotation of the head since rest
  void ride(const Strands& lines, const glm::dquat& turn, std::span<glm::vec3> out) const;
};

}  // namespace pelage
