// All distance constraints of a strand at once [Han2013, tridiagonal matrix formulation]. With unit directions u_i of
// the segments, inverse masses w and multipliers lambda, positions move by w_i (lambda_{i+1} u_{i+1} - lambda_i u_i);
// that the linearised constraints C_i = |p_i - p_{i-1}| - l vanish is
//   -w_{i-1} (u_{i-1}.u_i) lambda_{i-1} + (w_{i-1} + w_i) lambda_i - w_i (u_i.u_{i+1}) lambda_{i+1} = C_i,
// tridiagonal, solved by elimination. Each iteration is one Newton step.
#include "pelage/simulate/relaxed_chain.h"

namespace pelage {
namespace {

struct Rows {
  std::vector<Lanes3> u;               // [length] of the segment that ends at each vertex
  std::vector<Lanes> wrong, diagonal;  // [length] C_i, then lambda; pivots
};

void linearise(const RelaxedChain& chain, Rows& rows) noexcept {
  for (std::uint32_t i = 1; i < chain.block.length; ++i) {
    for (int l = 0; l < kLanes; ++l) {
      const Vec d = load(chain.at[i], l) - load(chain.at[i - 1], l);
      const bool real = chain.segments[i].v[l] > 0.0F;
      store(rows.u[i], l, direction(d, kDown));
      rows.wrong[i].v[l] = real ? std::sqrt(dot(d, d)) - chain.segments[i].v[l] : 0.0F;
      rows.diagonal[i].v[l] = real ? chain.weights[i - 1].v[l] + chain.weights[i].v[l] : 1.0F;
    }
  }
}

/// -w_{i-1} (u_{i-1}.u_i), 0 where one of the segments is none.
float beside(const RelaxedChain& chain, const Rows& rows, std::uint32_t i, int l) noexcept {
  const bool real = chain.segments[i].v[l] > 0.0F && chain.segments[i - 1].v[l] > 0.0F;
  return real ? -chain.weights[i - 1].v[l] * dot(load(rows.u[i - 1], l), load(rows.u[i], l)) : 0.0F;
}

/// Leaves lambda in `wrong`. A strand that is straight and pinned at both ends has a singular row: it stays as it is.
void eliminate(const RelaxedChain& chain, Rows& rows) noexcept {
  const std::uint32_t n = chain.block.length;
  for (std::uint32_t i = 2; i < n; ++i) {
    for (int l = 0; l < kLanes; ++l) {
      const float b = beside(chain, rows, i, l), ratio = b / rows.diagonal[i - 1].v[l];
      const float pivot = rows.diagonal[i].v[l] - ratio * b;
      rows.diagonal[i].v[l] = std::max(pivot, 1e-6F);  // keeps a singular row from dividing by zero
      rows.wrong[i].v[l] -= ratio * rows.wrong[i - 1].v[l];
    }
  }
  for (std::uint32_t i = n; i-- > 1;) {
    for (int l = 0; l < kLanes; ++l) {
      const float above = i + 1 < n ? beside(chain, rows, i + 1, l) * rows.wrong[i + 1].v[l] : 0.0F;
      rows.wrong[i].v[l] = (rows.wrong[i].v[l] - above) / rows.diagonal[i].v[l];
    }
  }
}

void move(RelaxedChain& chain, const Rows& rows) noexcept {
  const std::uint32_t n = chain.block.length;
  for (std::uint32_t i = 1; i < n; ++i) {
    for (int l = 0; l < kLanes; ++l) {
      Vec pull = -rows.wrong[i].v[l] * load(rows.u[i], l);
      if (i + 1 < n) pull = pull + rows.wrong[i + 1].v[l] * load(rows.u[i + 1], l);
      store(chain.at[i], l, load(chain.at[i], l) + chain.weights[i].v[l] * pull);
    }
  }
}

}  // namespace

float step_tridiagonal(StrandBlocks& s, std::size_t block, const ChainStep& step) noexcept {
  RelaxedChain chain = begin_relaxed(s, block, step);
  const std::uint32_t n = chain.block.length;
  Rows rows{std::vector<Lanes3>(n), std::vector<Lanes>(n), std::vector<Lanes>(n)};
  for (int pass = 0; pass < step.chain.iterations && n > 1; ++pass) {
    linearise(chain, rows);
    eliminate(chain, rows);
    move(chain, rows);
  }
  return finish_relaxed(s, block, step, chain);
}

}  // namespace pelage
