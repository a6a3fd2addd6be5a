// Private to this box: what the solvers share. Each function works on one group of kLanes vertices.
#pragma once

#include <algorithm>

#include "pelage/simulate/chain_step.h"
#include "pelage/simulate/lane_math.h"

namespace pelage {

/// What a segment without length points along.
inline constexpr Vec kDown{0, -1, 0};

/// The correction of eq. 3.1 saturates: at one segment, reached at kSaturated of them; x - x^3 / 3 in between. A
/// segment that is thrown about by more than its own length in a step turns over, and its correction, given back whole
/// as velocity, turns the leader over in the next: some strands then spin for ever at two segments per step, whatever
/// the damping, and these are the flying tips of [Almeida2014 section 4]. Measured after half a turn of the head in one
/// frame: unbounded 14 % of the strands spin, saturating at 1.5 segments 1 %, at one none (nor with 8 or 32 vertices,
/// steps of 1/240 to 1/960 s, damping of .5 /s); a sharp bound at half a segment stops them too, but throws tips at 3.6
/// times the roots' speed (this: 1.4). To second order without effect, so the scheme converges as before; segments
/// should be longer than N g h^2 (4 mm for 24 vertices at 1/240 s, .6 mm for 16 at 1/480 s).
inline constexpr float kSaturated = 1.5F;

/// A block's strands during one step.
struct ChainBlock {
  std::uint32_t first, length;
  std::uint32_t whole;  // vertices that all lanes have; 0 where one has no strand or no length
  Lanes3 root_shift;    // of each root during the step [m]
  Lanes along;          // 1 / (vertices - 1)
  Lanes vertices, segment_m;
  Lanes saturation_m, per_saturation;  // kSaturated segments [m], and 1 / that [1/m]; 0 where there is no length
};

/// What a step reads and writes of all blocks; at hand, so that loops need not ask the vectors.
struct ChainArrays {
  Lanes3 *position, *velocity, *impulse;
};
inline ChainArrays arrays_of(StrandBlocks& s) noexcept {
  return {s.position.data(), s.velocity.data(), s.impulse.data()};
}

struct Matrix {  // of floats, by rows
  Vec x, y, z;
};
PELAGE_INLINE Matrix rows_of(const glm::mat3& m) noexcept {
  return {{m[0][0], m[1][0], m[2][0]}, {m[0][1], m[1][1], m[2][1]}, {m[0][2], m[1][2], m[2][2]}};
}
PELAGE_INLINE Vec operator*(const Matrix& m, Vec v) noexcept {
  return {dot(m.x, v), dot(m.y, v), dot(m.z, v)};
}

/// Length of the segment that ends at vertex i: 0 beyond a strand's own vertices.
PELAGE_INLINE float segment(const ChainBlock& b, std::uint32_t i, int lane) noexcept {
  const float count = b.vertices.v[lane], length = b.segment_m.v[lane];
  return static_cast<float>(i) < count ? length : 0.0F;
}

/// Roots to the end of the step.
PELAGE_INLINE ChainBlock begin_block(StrandBlocks& s, std::size_t block, const ChainStep& step) noexcept {
  ChainBlock b{s.first[block], s.length(block), 0, {}, {}, s.vertices[block], s.segment_m[block], {}, {}};
  const Matrix turn = rows_of(step.turn), change = rows_of(step.turn_change);
  const Vec shift{step.shift.x, step.shift.y, step.shift.z};
  const float per_s = 1.0F / step.step_s;
  PELAGE_EACH_LANE
  for (int l = 0; l < kLanes; ++l) {
    const Vec rest = load(s.root_rest[block], l);
    const Vec moved = change * rest + shift;
    store(b.root_shift, l, moved);
    store(s.root[block], l, turn * rest);
    store(s.position[b.first], l, {0, 0, 0});
    store(s.velocity[b.first], l, per_s * moved);
    store(s.impulse[b.first], l, {0, 0, 0});
    const float length = b.segment_m.v[l];
    b.saturation_m.v[l] = kSaturated * length;
    b.per_saturation.v[l] = length > 0.0F ? 1.0F / (length > 0.0F ? kSaturated * length : 1.0F) : 0.0F;
    b.along.v[l] = 1.0F / std::max(s.vertices[block].v[l] - 1.0F, 1.0F);
  }
  float whole = static_cast<float>(b.length);
  for (int l = 0; l < kLanes; ++l) whole = std::min(whole, b.segment_m.v[l] > 0.0F ? b.vertices.v[l] : 0.0F);
  b.whole = static_cast<std::uint32_t>(whole);
  return b;
}

/// Where a vertex would be without constraints, relative to its root at the end of the step.
PELAGE_INLINE Vec predicted(const StrandBlocks& s, const ChainBlock& b, std::uint32_t vertex, int l, float h,
                            Vec fall) noexcept {
  const Vec v = load(s.velocity[vertex], l) + load(s.impulse[vertex], l);
  return load(s.position[vertex], l) - load(b.root_shift, l) + h * v + fall;
}

/// Pull back to the groom's own shape as an implicit spring of frequency omega: beta = (omega h)^2 / (1 + (omega h)^2)
/// of the way, so that a weight sags by g / omega^2 whatever the step (DESIGN section 7). Sag-free, the shape is lifted
/// by just that: a groom at rest bears gravity already.
PELAGE_INLINE void hold_shape(const StrandBlocks& s, const ChainBlock& b, std::uint32_t i, const ChainStep& step,
                              const Matrix& turn, Lanes3& at) noexcept {
  const Lanes3& rest = s.rest[b.first + i];
  const float slope = step.hold_tip - 1.0F;
  const glm::vec3 gravity = step.sag_free ? step.chain.gravity : glm::vec3(0.0F);
  const Vec borne = step.step_s * step.step_s * (turn * Vec{gravity.x, gravity.y, gravity.z});
  PELAGE_EACH_LANE
  for (int l = 0; l < kLanes; ++l) {
    const float omega_h = step.step_s * step.hold_rad_s * (1.0F + slope * (static_cast<float>(i) * b.along.v[l]));
    const float square = omega_h * omega_h;
    const float free = 1.0F / (1.0F + square);
    const Vec p = load(at, l);
    store(at, l, p + (square * free) * (turn * load(rest, l) - p) - free * borne);
  }
}

/// Turns directions into the cone around the segment before, where they leave it.
PELAGE_INLINE void keep_in_cone(const Lanes& least_cos, const Lanes3& before, Lanes3& along) noexcept {
  PELAGE_EACH_LANE
  for (int l = 0; l < kLanes; ++l) {
    const Vec axis = load(before, l), d = load(along, l);
    const float limit = least_cos.v[l];
    const float c = dot(axis, d);
    const float sine = std::sqrt(std::max(1.0F - limit * limit, 0.0F));
    store(along, l, choose(c < limit, limit * axis + sine * across(axis, d), d));
  }
}

/// A group of vertices on its way to its place.
struct Placing {
  Lanes3 before;    // the vertex before, relative to the root
  Lanes3 along;     // direction of the segment, unit
  Lanes length;     // of the segment
  Lanes clearance;  // to keep from colliders [m]
};

PELAGE_INLINE void place(const Placing& p, Lanes3& at) noexcept {
  PELAGE_EACH_LANE
  for (int l = 0; l < kLanes; ++l) store(at, l, load(p.before, l) + p.length.v[l] * load(p.along, l));
}

/// Turns segments out of what their vertices have run into; lengths stay. Coulomb friction holds back what slides.
void collide(const StrandBlocks& s, const ChainBlock& b, std::size_t block, std::uint32_t i, const ChainStep& step,
             Placing& p, Lanes3& at) noexcept;

/// Kinematic velocity of a group that goes to `at`; the greatest squared displacement so far is kept.
PELAGE_INLINE void arrive(StrandBlocks& s, const ChainBlock& b, std::uint32_t vertex, float per_s, float damping,
                          const Lanes3& at, Lanes& moved) noexcept {
  PELAGE_EACH_LANE
  for (int l = 0; l < kLanes; ++l) {
    const Vec p = load(at, l);
    const Vec d = p - (load(s.position[vertex], l) - load(b.root_shift, l));
    const float sq = dot(d, d);
    moved.v[l] = sq > moved.v[l] ? sq : moved.v[l];
    store(s.velocity[vertex], l, (damping * per_s) * d);
    store(s.position[vertex], l, p);
  }
}

/// Squared displacements of the roots, to be exceeded.
PELAGE_INLINE void begin_moved(const ChainBlock& b, Lanes& moved) noexcept {
  PELAGE_EACH_LANE
  for (int l = 0; l < kLanes; ++l) moved.v[l] = dot(load(b.root_shift, l), load(b.root_shift, l));
}

/// Axis of the first segment's cone: its direction at rest.
PELAGE_INLINE void begin_along(const StrandBlocks& s, const ChainBlock& b, const Matrix& turn, Lanes3& along) noexcept {
  const Lanes3& rest = s.rest[b.first + std::min(b.length - 1, 1U)];
  PELAGE_EACH_LANE
  for (int l = 0; l < kLanes; ++l) store(along, l, direction(turn * load(rest, l), kDown));
}

/// The comparison solvers' step of one block. @return greatest squared speed
float step_position_based(StrandBlocks& s, std::size_t block, const ChainStep& step) noexcept;
float step_tridiagonal(StrandBlocks& s, std::size_t block, const ChainStep& step) noexcept;

}  // namespace pelage
