#include "pelage/simulate/relaxed_chain.h"

namespace pelage {
namespace {

/// What lies beyond a strand's own vertices repeats its tip.
void repeat_tips(RelaxedChain& chain) {
  for (std::uint32_t i = 1; i < chain.block.length; ++i)
    for (int l = 0; l < kLanes; ++l)
      if (chain.segments[i].v[l] <= 0.0F) store(chain.at[i], l, load(chain.at[i - 1], l));
}

/// Every segment as long as it came out, turned where cone or colliders want it; the next one follows.
void turn_segments(const StrandBlocks& s, std::size_t block, const ChainStep& step, RelaxedChain& chain) {
  Placing p = {};
  begin_along(s, chain.block, rows_of(step.turn), p.along);
  Lanes3 solved = chain.at[0];  // the vertex before, before it was turned
  for (std::uint32_t i = 1; i < chain.block.length; ++i) {
    const Lanes3 axis = p.along;
    for (int l = 0; l < kLanes; ++l) {
      const Vec here = load(chain.at[i], l), d = here - load(solved, l);
      store(solved, l, here);
      store(p.before, l, load(chain.at[i - 1], l));
      store(p.along, l, direction(here - load(p.before, l), load(axis, l)));
      p.length.v[l] = chain.segments[i].v[l] > 0.0F ? std::sqrt(dot(d, d)) : 0.0F;
    }
    if (!step.cone_cos.empty()) keep_in_cone(step.cone_cos[chain.block.first + i], axis, p.along);
    place(p, chain.at[i]);
    if (step.colliders != nullptr) collide(s, chain.block, block, i, step, p, chain.at[i]);
  }
}

}  // namespace

RelaxedChain begin_relaxed(StrandBlocks& s, std::size_t block, const ChainStep& step) {
  RelaxedChain chain;
  chain.block = begin_block(s, block, step);
  const std::uint32_t n = chain.block.length;
  chain.at.resize(n);
  chain.segments.resize(n);
  chain.weights.resize(n);
  const float h = step.step_s;
  const glm::vec3 g = h * h * step.chain.gravity;
  const Matrix turn = rows_of(step.turn);
  for (std::uint32_t i = 0; i < n; ++i) {
    for (int l = 0; l < kLanes; ++l) {
      const bool tip = step.pin_tips && static_cast<float>(i + 1) >= s.vertices[block].v[l];
      chain.segments[i].v[l] = i == 0 ? 0.0F : segment(chain.block, i, l);
      chain.weights[i].v[l] = i == 0 || tip ? 0.0F : 1.0F;
      const Vec free = predicted(s, chain.block, chain.block.first + i, l, h, {g.x, g.y, g.z});
      const Vec pinned = turn * load(s.rest[chain.block.first + i], l);
      store(chain.at[i], l, i == 0 ? Vec{0, 0, 0} : choose(tip, pinned, free));
    }
    if (i > 0 && step.hold_rad_s > 0) hold_shape(s, chain.block, i, step, turn, chain.at[i]);
  }
  return chain;
}

float finish_relaxed(StrandBlocks& s, std::size_t block, const ChainStep& step, RelaxedChain& chain) {
  repeat_tips(chain);
  if (!step.cone_cos.empty() || step.colliders != nullptr) turn_segments(s, block, step, chain);
  Lanes moved;
  begin_moved(chain.block, moved);
  const float damping = std::exp(-step.chain.damping_per_s * step.step_s), per_s = 1.0F / step.step_s;
  for (std::uint32_t i = 1; i < chain.block.length; ++i) {
    arrive(s, chain.block, chain.block.first + i, per_s, damping, chain.at[i], moved);
    s.impulse[chain.block.first + i] = Lanes3{};
  }
  return *std::max_element(moved.v, moved.v + kLanes) * (per_s * per_s);
}

}  // namespace pelage
