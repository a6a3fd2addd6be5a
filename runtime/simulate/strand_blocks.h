// Strands as the solver holds them: blocks of kLanes strands, structure of arrays across strands, so that one SIMD lane
// is one strand. Positions are relative to the strand's own root, with the world's axes: as good far from the origin as
// at it, and a segment's length keeps its digits. Everything that strands share lies in the grid frame: the world's
// axes, origin at the head's pivot, wherever that is now.
//
// Strands of different lengths: a block is as long as its longest strand; lanes beyond their own last vertex repeat it
// (`vertices` says how many count), lanes without a strand have 0 vertices. Blocks hold strands of like length that
// grow near each other, so little is padding and a block's hair shares voxels.
#pragma once

#include <cstddef>
#include <cstdint>
#include <glm/mat3x3.hpp>
#include <glm/vec3.hpp>
#include <vector>

#include "pelage/data_schema/strands.h"

namespace pelage {

inline constexpr int kLanes = 16;

struct alignas(64) Lanes {
  float v[kLanes];
};
struct alignas(64) Lanes3 {
  float x[kLanes], y[kLanes], z[kLanes];
};

struct StrandBlocks {
  static constexpr std::uint32_t kNoStrand = 0xFFFFFFFFU;

  std::size_t strands = 0;
  std::vector<std::uint32_t> first{0};   // [blocks + 1] first vertex of each block; vertex 0 of a block: the roots
  std::vector<std::uint32_t> strand_of;  // [block][lane] strand, or kNoStrand
  std::vector<std::uint32_t> block_of;   // [strands] block * kLanes + lane
  std::vector<Lanes> vertices;           // [block] as floats, to compare with; 0: no strand
  std::vector<Lanes> segment_m;          // [block] rest length of every segment of the strand
  std::vector<Lanes3> root_rest;         // [block] root relative to the pivot, head's axes
  std::vector<Lanes3> root;              // [block] root in the grid frame now
  std::vector<Lanes3> rest;              // [vertex] relative to the root, head's axes
  std::vector<Lanes3> position;          // [vertex] relative to the root, world's axes
  std::vector<Lanes3> velocity;          // [vertex] kinematic, of the world [m/s]
  std::vector<Lanes3> impulse;           // [vertex] -s d_next / dt of eq. 3.1 [m/s]

  std::size_t count() const noexcept { return first.size() - 1; }
  std::uint32_t length(std::size_t block) const noexcept { return first[block + 1] - first[block]; }
};

/// Blocks at rest in the pose (rotation identity, pivot where it is). Segments of a strand get their mean length.
/// @throws InputError for a strand without vertices, or one that is not finite
StrandBlocks make_blocks(const Strands& lines, const glm::dvec3& pivot);

/// World positions [m] of all vertices into `out`, which has the layout of the strands that the blocks were made of.
/// @param pivot  where it is now
void world_positions(const StrandBlocks& blocks, const glm::dvec3& pivot, Strands& out);

}  // namespace pelage
