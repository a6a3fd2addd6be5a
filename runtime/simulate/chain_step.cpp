#include "pelage/simulate/chain_step.h"

#include <algorithm>
#include <cmath>

#include "pelage/simulate/chain_kernels.h"

namespace pelage {
namespace {

constexpr float kDegrees = 0.017453293F;

/// Where a follower goes that would like to be `to` away from its leader, and by how much the constraint moves it
/// along that way: d of eq. 3.1 = moved_m x along.
struct Followed {
  Vec along;      // unit
  float moved_m;  // saturating, see below
};

/// What saturates, and why: kSaturated.
/// @param saturation_m  the block's; 0 where there is no follower (beyond a strand's own tip): no correction
PELAGE_INLINE Followed follow(Vec to, float length, float saturation_m, float per_saturation) noexcept {
  const float sq = dot(to, to);
  const bool somewhere = sq > kNoLengthSq;
  const float inverse = 1.0F / std::sqrt(somewhere ? sq : 1.0F);
  const float x = (length - (somewhere ? sq * inverse : 0.0F)) * per_saturation;
  const float above = x > -1.0F ? x : -1.0F, within = above < 1.0F ? above : 1.0F;
  return {choose(somewhere, inverse * to, kDown), saturation_m * (within - (1.0F / 3.0F) * (within * within * within))};
}

/// Follow-the-leader of one group: `wish` is where it would like to be; out: its direction from the leader, and what it
/// gives back to the leader.
PELAGE_INLINE void follow_leaders(const ChainBlock& b, std::uint32_t i, float correction_per_s, const Lanes3& wish,
                                  Placing& p, Lanes3& leader_impulse) noexcept {
  PELAGE_EACH_LANE
  for (int l = 0; l < kLanes; ++l) {
    const float length = segment(b, i, l);
    const float saturation_m = length > 0.0F ? b.saturation_m.v[l] : 0.0F;
    const Followed f = follow(load(wish, l) - load(p.before, l), length, saturation_m, b.per_saturation.v[l]);
    store(leader_impulse, l, (-correction_per_s * f.moved_m) * f.along);
    store(p.along, l, f.along);
    p.length.v[l] = length;
  }
}

struct Factors {
  float h, per_s, correction_per_s, damping;
  Vec fall;  // h^2 g
};

Factors factors_of(const ChainStep& step) noexcept {
  const float h = step.step_s;
  const glm::vec3 fall = h * h * step.chain.gravity;
  return {
      h, 1.0F / h, step.chain.ftl_correction / h, std::exp(-step.chain.damping_per_s * h), {fall.x, fall.y, fall.z}};
}

/// The fast road: nothing but gravity and inextensibility, all of a vertex in one loop.
/// @tparam kWhole  every lane has a segment here: no masks
/// @param moved  out: greatest squared displacement of a vertex so far [m^2]
template <bool kWhole>
PELAGE_INLINE void follow_freely(const ChainArrays& s, const ChainBlock& b, std::uint32_t i, const Factors f,
                                 Lanes& moved) noexcept {
  Lanes3* const __restrict position = s.position + b.first + i;
  Lanes3* const __restrict velocity = s.velocity + b.first + i;
  Lanes3* const __restrict impulse = s.impulse + b.first + i;
  const float velocity_per_m = f.damping * f.per_s;
  PELAGE_EACH_LANE
#pragma GCC unroll 1
  for (int l = 0; l < kLanes; ++l) {
    const float length = kWhole ? b.segment_m.v[l] : segment(b, i, l);
    const float saturation_m = kWhole || length > 0.0F ? b.saturation_m.v[l] : 0.0F;
    const Vec x = load(position[0], l) - load(b.root_shift, l);
    const Vec q = x + f.h * (load(velocity[0], l) + load(impulse[0], l)) + f.fall;
    const Vec before = load(position[-1], l);
    const Followed way = follow(q - before, length, saturation_m, b.per_saturation.v[l]);
    const Vec at = before + length * way.along;
    const Vec d = at - x;
    const float sq = dot(d, d);
    moved.v[l] = sq > moved.v[l] ? sq : moved.v[l];
    store(impulse[-1], l, (-f.correction_per_s * way.moved_m) * way.along);
    store(velocity[0], l, velocity_per_m * d);
    store(position[0], l, at);
  }
}

/// A block on its way from root to tip.
struct Walk {
  ChainBlock block;
  Placing place;
  Lanes moved;
};

PELAGE_INLINE void follow_constrained(StrandBlocks& s, std::size_t block, std::uint32_t i, const ChainStep& step,
                                      const Matrix& turn, const Factors& f, Walk& w) noexcept {
  const ChainBlock& b = w.block;
  Placing& p = w.place;
  const std::uint32_t vertex = b.first + i;
  Lanes3 wish, at, before_along = p.along;
  PELAGE_EACH_LANE
  for (int l = 0; l < kLanes; ++l) store(wish, l, predicted(s, b, vertex, l, f.h, f.fall));
  if (step.hold_rad_s > 0) hold_shape(s, b, i, step, turn, wish);
  follow_leaders(b, i, f.correction_per_s, wish, p, s.impulse[vertex - 1]);
  if (!step.cone_cos.empty()) keep_in_cone(step.cone_cos[vertex], before_along, p.along);
  place(p, at);
  if (step.colliders != nullptr) collide(s, b, block, i, step, p, at);
  arrive(s, b, vertex, f.per_s, f.damping, at, w.moved);
  p.before = at;
}

PELAGE_INLINE void begin_walk(StrandBlocks& s, std::size_t block, const ChainStep& step, Walk& w) noexcept {
  w.block = begin_block(s, block, step);
  begin_along(s, w.block, rows_of(step.turn), w.place.along);
  w.place.before = Lanes3{};
  begin_moved(w.block, w.moved);
}

PELAGE_INLINE float end_walk(StrandBlocks& s, const Walk& w, const Factors& f) noexcept {
  s.impulse[w.block.first + w.block.length - 1] = Lanes3{};
  return *std::max_element(w.moved.v, w.moved.v + kLanes) * (f.per_s * f.per_s);
}

PELAGE_INLINE void walk_on(const ChainArrays& arrays, std::uint32_t from, const Factors f, Walk& w) noexcept {
  std::uint32_t i = from;
  for (; i < w.block.whole; ++i) follow_freely<true>(arrays, w.block, i, f, w.moved);
  for (; i < w.block.length; ++i) follow_freely<false>(arrays, w.block, i, f, w.moved);
}

/// Two blocks side by side: the next vertex of a strand waits for the one before, another block's does not.
PELAGE_CLONES void walk_two(StrandBlocks& s, std::size_t first, const ChainStep& step, float* fastest) noexcept {
  const Factors f = factors_of(step);
  const ChainArrays arrays = arrays_of(s);
  Walk a, b;
  begin_walk(s, first, step, a);
  begin_walk(s, first + 1, step, b);
  const std::uint32_t both = std::max(1U, std::min(a.block.whole, b.block.whole));
  for (std::uint32_t i = 1; i < both; ++i) {
    follow_freely<true>(arrays, a.block, i, f, a.moved);
    follow_freely<true>(arrays, b.block, i, f, b.moved);
  }
  walk_on(arrays, both, f, a);
  walk_on(arrays, both, f, b);
  fastest[first] = end_walk(s, a, f);
  fastest[first + 1] = end_walk(s, b, f);
}

PELAGE_CLONES void walk_one(StrandBlocks& s, std::size_t block, const ChainStep& step, float* fastest) noexcept {
  const Factors f = factors_of(step);
  Walk w;
  begin_walk(s, block, step, w);
  walk_on(arrays_of(s), 1, f, w);
  fastest[block] = end_walk(s, w, f);
}

PELAGE_CLONES void walk_constrained(StrandBlocks& s, std::size_t block, const ChainStep& step,
                                    float* fastest) noexcept {
  const Matrix turn = rows_of(step.turn);
  const Factors f = factors_of(step);
  Walk w;
  begin_walk(s, block, step, w);
  for (std::uint32_t i = 1; i < w.block.length; ++i) follow_constrained(s, block, i, step, turn, f, w);
  fastest[block] = end_walk(s, w, f);
}

/// Cosine between the segments that end and begin at vertex i - 1 at rest; 1 where there is one only.
float bend_cosine(const StrandBlocks& s, std::size_t block, std::uint32_t i, int l) {
  if (i < 2) return 1;
  const std::uint32_t v = s.first[block] + i;
  const Vec a = load(s.rest[v - 1], l) - load(s.rest[v - 2], l), b = load(s.rest[v], l) - load(s.rest[v - 1], l);
  const float lengths = std::sqrt(dot(a, a) * dot(b, b));
  return lengths > kNoLengthSq ? dot(a, b) / lengths : 1.0F;
}

}  // namespace

void step_chains(StrandBlocks& blocks, std::size_t begin, std::size_t end, const ChainStep& step,
                 std::span<float> fastest) noexcept {
  const bool dftl = step.chain.solver == ChainSolver::dftl;
  if (dftl && step.hold_rad_s <= 0 && step.cone_cos.empty() && step.colliders == nullptr) {
    std::size_t b = begin;
    for (; b + 1 < end; b += 2) walk_two(blocks, b, step, fastest.data());
    if (b < end) walk_one(blocks, b, step, fastest.data());
    return;
  }
  for (std::size_t b = begin; b < end; ++b) {
    if (dftl)
      walk_constrained(blocks, b, step, fastest.data());
    else
      fastest[b] = step.chain.solver == ChainSolver::position_based ? step_position_based(blocks, b, step)
                                                                    : step_tridiagonal(blocks, b, step);
  }
}

std::vector<Lanes> cone_limits(const StrandBlocks& blocks, const ShapeSettings& shape) {
  std::vector<Lanes> limits(blocks.first.back(), Lanes{});
  for (std::size_t b = 0; b < blocks.count(); ++b) {
    for (std::uint32_t i = 0; i < blocks.length(b); ++i) {
      for (int l = 0; l < kLanes; ++l) {
        const float t = static_cast<float>(i) / std::max(blocks.vertices[b].v[l] - 1.0F, 1.0F);
        const float share = t / shape.cone_end;
        const float limit =
            share < 1 ? std::cos(kDegrees * (shape.cone_deg + (90.0F - shape.cone_deg) * share)) : -1.0F;
        limits[blocks.first[b] + i].v[l] = std::min(limit, bend_cosine(blocks, b, i, l));
      }
    }
  }
  return limits;
}

}  // namespace pelage
