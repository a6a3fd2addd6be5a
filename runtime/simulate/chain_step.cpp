#include "pelage/simulate/chain_step.h"

#include <algorithm>
#include <cmath>

#include "pelage/simulate/chain_kernels.h"

namespace pelage {
namespace {

constexpr float kDegrees = 0.017453293F;

/// Follow-the-leader of one group: q is where it would like to be; out: its direction from the leader, and as the
/// leader's impulse what the constraint alone moved it by.
PELAGE_INLINE void follow(const StrandBlocks& s, std::size_t block, std::uint32_t i, float correction_per_s,
                          const Lanes3& wish, Placing& p, Lanes3& leader_impulse) noexcept {
#pragma GCC ivdep
  for (int l = 0; l < kLanes; ++l) {
    const float length = segment(s, block, i, l);
    const Vec q = load(wish, l), before = load(p.before, l);
    const Vec along = direction(q - before, load(p.along, l));
    const Vec d = before + length * along - q;
    store(leader_impulse, l, choose(length > 0.0F, -correction_per_s * d, Vec{0, 0, 0}));
    store(p.along, l, along);
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

float greatest(const Lanes& lanes) noexcept {
  return *std::max_element(lanes.v, lanes.v + kLanes);
}

/// The fast road: nothing but gravity and inextensibility, all of a vertex in one loop.
PELAGE_INLINE void follow_freely(StrandBlocks& s, std::size_t block, const ChainBlock& b, std::uint32_t i,
                                 const Factors& f, Placing& p, Lanes& fastest) noexcept {
  const std::uint32_t vertex = b.first + i;
#pragma GCC ivdep
  for (int l = 0; l < kLanes; ++l) {
    const float length = segment(s, block, i, l);
    const Vec x = load(s.position[vertex], l) - load(b.root_shift, l);
    const Vec q = x + f.h * (load(s.velocity[vertex], l) + load(s.impulse[vertex], l)) + f.fall;
    const Vec before = load(p.before, l);
    const Vec along = direction(q - before, load(p.along, l));
    const Vec at = before + length * along;
    const Vec v = f.per_s * (at - x);
    const float sq = dot(v, v);
    fastest.v[l] = sq > fastest.v[l] ? sq : fastest.v[l];
    store(s.impulse[vertex - 1], l, choose(length > 0.0F, -f.correction_per_s * (at - q), Vec{0, 0, 0}));
    store(s.velocity[vertex], l, f.damping * v);
    store(s.position[vertex], l, at);
    store(p.along, l, along);
    store(p.before, l, at);
  }
}

PELAGE_INLINE void follow_constrained(StrandBlocks& s, std::size_t block, const ChainBlock& b, std::uint32_t i,
                                      const ChainStep& step, const Matrix& turn, const Factors& f, Placing& p,
                                      Lanes& fastest) noexcept {
  const std::uint32_t vertex = b.first + i;
  Lanes3 wish, at, before_along = p.along;
#pragma GCC ivdep
  for (int l = 0; l < kLanes; ++l) store(wish, l, predicted(s, b, vertex, l, f.h, f.fall));
  if (step.hold_rad_s > 0) hold_shape(s, b, i, step, turn, wish);
  follow(s, block, i, f.correction_per_s, wish, p, s.impulse[vertex - 1]);
  if (!step.cone_cos.empty()) keep_in_cone(step.cone_cos[vertex], before_along, p.along);
  place(p, at);
  if (step.colliders != nullptr) collide(s, b, block, i, step, p, at);
  arrive(s, b, vertex, f.per_s, f.damping, at, fastest);
  p.before = at;
}

/// Blocks whose roads are walked side by side: the next vertex of a strand waits for the one before, another block's
/// does not.
constexpr std::size_t kTogether = 2;

PELAGE_CLONES void step_dftl(StrandBlocks& s, std::size_t begin, std::size_t end, const ChainStep& step,
                             const Factors& f, bool free, float* fastest) noexcept {
  const Matrix turn = rows_of(step.turn);
  for (std::size_t first = begin; first < end; first += kTogether) {
    const std::size_t n = std::min(kTogether, end - first);
    ChainBlock blocks[kTogether];
    Placing places[kTogether] = {};
    Lanes speeds[kTogether];
    std::uint32_t longest = 0;
    for (std::size_t k = 0; k < n; ++k) {
      blocks[k] = begin_block(s, first + k, step);
      begin_along(s, blocks[k], turn, places[k].along);
      begin_fastest(s, blocks[k], speeds[k]);
      longest = std::max(longest, blocks[k].length);
    }
    for (std::uint32_t i = 1; i < longest; ++i)
      for (std::size_t k = 0; k < n; ++k) {
        if (i >= blocks[k].length) continue;
        if (free)
          follow_freely(s, first + k, blocks[k], i, f, places[k], speeds[k]);
        else
          follow_constrained(s, first + k, blocks[k], i, step, turn, f, places[k], speeds[k]);
      }
    for (std::size_t k = 0; k < n; ++k) {
      s.impulse[blocks[k].first + blocks[k].length - 1] = Lanes3{};
      fastest[first + k] = greatest(speeds[k]);
    }
  }
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
  const Factors f = factors_of(step);
  if (step.chain.solver == ChainSolver::dftl) {
    const bool free = step.hold_rad_s <= 0 && step.cone_cos.empty() && step.colliders == nullptr;
    step_dftl(blocks, begin, end, step, f, free, fastest.data());
    return;
  }
  for (std::size_t b = begin; b < end; ++b) {
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
