// Private to this box: three floats per lane. Plain arithmetic on values, so that loops over lanes become vectors.
#pragma once

#include <cmath>
#include <cstddef>

#include "pelage/simulate/lane_loops.h"
#include "pelage/simulate/strand_blocks.h"

// What a function of PELAGE_CLONES calls is inlined into each of its versions, or it stays the slowest.
#define PELAGE_INLINE inline __attribute__((always_inline))

namespace pelage {

struct Vec {
  float x, y, z;
};
PELAGE_INLINE Vec operator+(Vec a, Vec b) noexcept {
  return {a.x + b.x, a.y + b.y, a.z + b.z};
}
PELAGE_INLINE Vec operator-(Vec a, Vec b) noexcept {
  return {a.x - b.x, a.y - b.y, a.z - b.z};
}
PELAGE_INLINE Vec operator*(float s, Vec a) noexcept {
  return {s * a.x, s * a.y, s * a.z};
}
PELAGE_INLINE float dot(Vec a, Vec b) noexcept {
  return a.x * b.x + a.y * b.y + a.z * b.z;
}
PELAGE_INLINE Vec choose(bool first, Vec a, Vec b) noexcept {
  return {first ? a.x : b.x, first ? a.y : b.y, first ? a.z : b.z};
}
PELAGE_INLINE Vec load(const Lanes3& a, int lane) noexcept {
  return {a.x[lane], a.y[lane], a.z[lane]};
}
PELAGE_INLINE void store(Lanes3& a, int lane, Vec v) noexcept {
  a.x[lane] = v.x;
  a.y[lane] = v.y;
  a.z[lane] = v.z;
}
/// Vertices relative to their roots, in the grid frame.
PELAGE_INLINE void in_grid_frame(const Lanes3& roots, const Lanes3& vertices, Lanes3& out) noexcept {
  PELAGE_EACH_LANE
  for (int l = 0; l < kLanes; ++l) store(out, l, load(roots, l) + load(vertices, l));
}

/// Squares below this have lost their digits: lengths under 1e-12 m are no direction.
inline constexpr float kNoLengthSq = 1e-24F;

/// v / |v|, or `otherwise` where v has no length.
PELAGE_INLINE Vec direction(Vec v, Vec otherwise) noexcept {
  const float sq = dot(v, v);
  const float inverse = 1.0F / std::sqrt(sq > kNoLengthSq ? sq : 1.0F);
  return choose(sq > kNoLengthSq, inverse * v, otherwise);
}

/// Of |across|^2: below, what is left of a unit vector across another is their rounding, and points anywhere.
inline constexpr float kAlongSq = 1e-12F;

/// Unit vector at right angles to `axis`, towards d; where d lies along the axis any will do: one through the axis'
/// smallest coordinate. Taken across twice: the first time a short remainder keeps rounding along the axis.
PELAGE_INLINE Vec across(Vec axis, Vec d) noexcept {
  const Vec towards = d - dot(axis, d) * axis;
  const Vec any = choose(std::fabs(axis.x) > 0.6F, {-axis.x * axis.y, 1.0F - axis.y * axis.y, -axis.z * axis.y},
                         {1.0F - axis.x * axis.x, -axis.y * axis.x, -axis.z * axis.x});
  const Vec side = direction(choose(dot(towards, towards) > kAlongSq, towards, any), any);
  return direction(side - dot(axis, side) * axis, side);
}

}  // namespace pelage
