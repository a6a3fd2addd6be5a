// Collisions of one group of vertices, as their strands are built from root to tip. A segment that ends too near to a
// surface turns about its beginning, towards the normal n: with the distance phi at its end, the turned direction d'
// has  n.d' = n.d + (clearance - phi) / length,  exact for a plane and never too little for a convex shape, so that
// few rounds do for meshes. Where that exceeds 1 the segment points straight out: its beginning is deeper than it is
// long.
#include <algorithm>

#include "pelage/simulate/chain_kernels.h"

namespace pelage {
namespace {

constexpr int kRounds = 4;

/// How much too near each lane is [m]; 0 where it is free or has no length to turn.
PELAGE_INLINE bool shortfalls(const Placing& p, const Nearest& near, Lanes& depth) noexcept {
  int touched = 0;
  PELAGE_EACH_LANE
  for (int l = 0; l < kLanes; ++l) {
    const float missing = p.clearance.v[l] - near.distance.v[l];
    const bool touches = missing > 0.0F && p.length.v[l] > 0.0F;
    depth.v[l] = touches ? missing : 0.0F;
    touched |= touches ? 1 : 0;
  }
  return touched != 0;
}

void look(const StrandBlocks& s, std::size_t block, const ChainStep& step, const Lanes3& at, Nearest& near) noexcept {
  Lanes3 points;
  in_grid_frame(s.root[block], at, points);
  step.colliders->nearest(points, step.collision_margin_m, near);
}

/// Coulomb: what slides along the surface is held back by at most `friction` times what it is pushed out by. Depths
/// follow to first order.
PELAGE_CLONES void hold_back(const StrandBlocks& s, const ChainBlock& b, std::uint32_t vertex, float friction,
                             const Nearest& near, Lanes& depth, Placing& p, const Lanes3& at) noexcept {
  PELAGE_EACH_LANE
  for (int l = 0; l < kLanes; ++l) {
    const Vec n = load(near.normal, l), q = load(at, l);
    const Vec moved = q - load(s.position[vertex], l) + load(b.root_shift, l) - load(near.displacement, l);
    const Vec slide = moved - dot(moved, n) * n;
    const float sq = dot(slide, slide);
    const float most = friction * depth.v[l];
    const float share = sq > most * most ? most / std::sqrt(sq > 0.0F ? sq : 1.0F) : 1.0F;
    const Vec along = load(p.along, l), before = load(p.before, l);
    const Vec held = direction(q - share * slide - before, along);
    const float nearer = dot(before + p.length.v[l] * held - q, n);
    const bool touches = depth.v[l] > 0.0F;
    store(p.along, l, choose(touches, held, along));
    depth.v[l] = touches ? std::max(depth.v[l] - nearer, 0.0F) : 0.0F;
  }
}

PELAGE_CLONES void turn_out(const Nearest& near, const Lanes& depth, Placing& p) noexcept {
  PELAGE_EACH_LANE
  for (int l = 0; l < kLanes; ++l) {
    const Vec n = load(near.normal, l), d = load(p.along, l);
    const float length = p.length.v[l] > 0.0F ? p.length.v[l] : 1.0F;
    const float now = dot(n, d);
    const float raised = std::min(now + depth.v[l] / length, 1.0F);
    const Vec out = raised * n + std::sqrt(std::max(1.0F - raised * raised, 0.0F)) * across(n, d);
    store(p.along, l, choose(depth.v[l] > 0.0F, out, d));
  }
}

}  // namespace

void collide(const StrandBlocks& s, const ChainBlock& b, std::size_t block, std::uint32_t i, const ChainStep& step,
             Placing& p, Lanes3& at) noexcept {
  p.clearance = step.clearance[b.first + i];
  Nearest near;
  Lanes depth;
  look(s, block, step, at, near);
  if (!shortfalls(p, near, depth)) return;
  if (step.contact_friction > 0) hold_back(s, b, b.first + i, step.contact_friction, near, depth, p, at);
  for (int round = 0; round < kRounds; ++round) {
    turn_out(near, depth, p);
    place(p, at);
    look(s, block, step, at, near);
    if (!shortfalls(p, near, depth)) return;
  }
}

}  // namespace pelage
