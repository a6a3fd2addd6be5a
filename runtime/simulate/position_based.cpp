// Distance constraints of equal masses, relaxed one after the other from root to tip [Mueller2006]: each pass leaves
// stretch that the next one shares out, so hair is as stiff as iterations are many.
#include "pelage/simulate/relaxed_chain.h"

namespace pelage {
namespace {

void relax(RelaxedChain& chain, std::uint32_t i) noexcept {
  for (int l = 0; l < kLanes; ++l) {
    const Vec a = load(chain.at[i - 1], l), b = load(chain.at[i], l);
    const float wa = chain.weights[i - 1].v[l], wb = chain.weights[i].v[l];
    const Vec d = b - a;
    const Vec missing = chain.segments[i].v[l] * direction(d, kDown) - d;
    const bool real = chain.segments[i].v[l] > 0.0F && wa + wb > 0.0F;
    const float share = real ? 1.0F / (wa + wb) : 0.0F;
    store(chain.at[i - 1], l, a - share * wa * missing);
    store(chain.at[i], l, real ? b + share * wb * missing : b);
  }
}

}  // namespace

float step_position_based(StrandBlocks& s, std::size_t block, const ChainStep& step) noexcept {
  RelaxedChain chain = begin_relaxed(s, block, step);
  for (int pass = 0; pass < step.chain.iterations; ++pass)
    for (std::uint32_t i = 1; i < chain.block.length; ++i) relax(chain, i);
  return finish_relaxed(s, block, step, chain);
}

}  // namespace pelage
