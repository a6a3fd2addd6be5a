// One internal step of the strands as chains of equal masses: prediction, hold-shape, inextensibility, cone,
// collisions, kinematic velocity. Strands do not meet here (voxel_grid.h).
//
// Solvers behind one interface (ChainSolver):
//   dftl            one pass from root to tip; what a follower was moved by comes back to its leader as velocity
//                   [Mueller2012; Almeida2014 eq. 3.1]. The printed Algorithm 2 has the sign of both terms reversed,
//                   drops d, and reads past the tip; here the tip has no follower and its impulse is 0.
//                   d saturates, or tips fly: kSaturated in chain_kernels.h
//   position_based  distance constraints of equal masses relaxed from root to tip, `iterations` times [Mueller2006]
//   tridiagonal     all constraints of a strand linearised and solved at once, `iterations` Newton steps [Han2013]
//
// Two velocities (DESIGN section 7): `velocity` is kinematic, (p - x) / dt; `impulse` is -s d_next / dt, motion still
// to come. Their sum is eq. 3.1's v. Damping acts on the first only.
#pragma once

#include <glm/mat3x3.hpp>
#include <glm/vec3.hpp>
#include <span>

#include "pelage/data_schema/simulation_settings.h"
#include "pelage/simulate/colliders.h"
#include "pelage/simulate/strand_blocks.h"

namespace pelage {

/// What all strands share in a step.
struct ChainStep {
  float step_s = 1.0F / 480;
  glm::mat3 turn{1.0F};         // head's axes -> world's at the end of the step
  glm::mat3 turn_change{0.0F};  // that minus the one at its beginning, the difference taken in double
  glm::vec3 shift{0.0F};        // of the pivot during the step [m]
  ChainSettings chain;
  float hold_rad_s = 0, hold_tip = 1;  // ShapeSettings
  bool sag_free = false;
  const Colliders* colliders = nullptr;  // null: none
  float collision_margin_m = 0, contact_friction = 0;
  std::span<const Lanes> cone_cos;   // [vertex] least cosine between a segment and the one before, or empty
  std::span<const Lanes> clearance;  // [vertex] distance to keep from colliders [m], or empty where there are none
  bool pin_tips = false;             // the last vertex stays in the root's frame; not for dftl
};

/// Steps blocks [begin, end). Independent of each other: any partition gives the same bits.
/// @param fastest  [blocks] out: greatest squared kinematic speed in each [m^2/s^2], before damping
void step_chains(StrandBlocks& blocks, std::size_t begin, std::size_t end, const ChainStep& step,
                 std::span<float> fastest) noexcept;

/// [vertex] least cosines: at the root the limit is cone_deg, it grows evenly to 90 degrees at cone_end and is gone
/// beyond [Almeida2014 section 3.3.3]; nowhere less than the groom bends by itself. The first segment's axis is its own
/// direction at rest.
std::vector<Lanes> cone_limits(const StrandBlocks& blocks, const ShapeSettings& shape);

}  // namespace pelage
