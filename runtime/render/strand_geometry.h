// Strands as the strand renderer's shaders read them, and the order of their segments. No OpenGL here.
#pragma once

#include <cstdint>
#include <glm/vec3.hpp>
#include <glm/vec4.hpp>
#include <span>
#include <vector>

#include "pelage/data_schema/strands.h"

namespace pelage {

/// Mirrors Segments of shaders/strands.vert. Both ends are vertices `first` and `first + 1`.
struct StrandSegment {
  static constexpr std::uint32_t kFirst = 0x80000000U, kLast = 0x40000000U, kVertex = 0x3fffffffU;
  std::uint32_t vertex_and_flags;  // first vertex; kFirst, kLast: of its strand
  std::uint32_t strand;

  std::uint32_t first() const noexcept { return vertex_and_flags & kVertex; }
};

/// Segments of all strands in the order of the strands; those of no length too.
/// @throws UsageError for more than 2^30 vertices
std::vector<StrandSegment> strand_segments(const Strands& strands);

/// xyz: position [m], w: drawn diameter [m]. [vertices]
std::vector<glm::vec4> strand_vertices(const Strands& strands);

/// Unit tangents at the vertices, towards the tip: half-way between the directions of the two segments. Vertices that
/// coincide with a neighbour take the next direction that there is, a strand of a single place +Y. [vertices]
std::vector<glm::vec4> strand_tangents(const Strands& strands);

/// The segments, farthest first by the depth of their middles along `forward`; equal depths keep their order. The same
/// for any machine. `sorted` is as long as `segments`.
void sort_by_depth(std::span<const StrandSegment> segments, std::span<const glm::vec3> vertices, const glm::vec3& eye,
                   const glm::vec3& forward, std::span<StrandSegment> sorted);

}  // namespace pelage
