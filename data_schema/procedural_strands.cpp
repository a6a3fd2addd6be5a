// A strand is p(t) = R(t) (p_0 + d(t)): a place p_0 on the disk, a drift d and a small turn R, both cubic B-splines
// over t with random control values. A spline stays in the hull of its controls, and the drift's are at most the gap
// between p_0 and kRim long, so that |p| <= kRim < 1 along the whole strand.
#include "pelage/data_schema/procedural_strands.h"

#include <array>
#include <cmath>

namespace pelage {
namespace {

constexpr float kRim = 0.98F;         // outermost radius that a strand reaches
constexpr float kShell = 0.6F;        // innermost starting radius of a shell
constexpr float kDrift = 0.12F;       // longest drift across the disk
constexpr float kHalfTurn = 0.06F;    // tan of half the largest turn: 7 degrees
constexpr std::size_t kControls = 7;  // four spans: about two slow waves from root to tip
constexpr std::size_t kPoints = 33;   // per strand

/// SplitMix64 [Steele, Lea, Flood 2014], counter-based: value n of a strand's stream.
class Random {
 public:
  Random(std::uint64_t seed, std::uint64_t strand) : state_(mix(seed + kGamma) ^ mix(strand * kGamma + 1)) {}
  /// [-1, 1)
  float signed_unit() { return static_cast<float>(mix(state_ += kGamma) >> 40U) * 0x1p-23F - 1.0F; }
  /// Uniform on the disk between the two radii, by rejection.
  glm::vec2 on_disk(float inner, float outer) {
    for (;;) {
      const glm::vec2 p{outer * signed_unit(), outer * signed_unit()};
      const float r2 = p.x * p.x + p.y * p.y;
      if (r2 >= inner * inner && r2 <= outer * outer) return p;
    }
  }

 private:
  static constexpr std::uint64_t kGamma = 0x9E3779B97F4A7C15U;
  static std::uint64_t mix(std::uint64_t z) {
    z = (z ^ z >> 30U) * 0xBF58476D1CE4E5B9U;
    z = (z ^ z >> 27U) * 0x94D049BB133111EBU;
    return z ^ z >> 31U;
  }
  std::uint64_t state_;
};

/// By the angle 2 atan(h).
glm::vec2 turned(glm::vec2 p, float h) {
  const float scale = 1.0F / (1.0F + h * h), c = (1.0F - h * h) * scale, s = 2.0F * h * scale;
  return {c * p.x - s * p.y, s * p.x + c * p.y};
}

}  // namespace

void append_procedural_strands(Cluster& cluster, std::size_t count, StrandDistribution distribution,
                               std::uint64_t seed) {
  for (std::size_t i = 0; i < count; ++i) {
    Random random(seed, i);
    const glm::vec2 start = random.on_disk(distribution == StrandDistribution::shell ? kShell : 0.0F, kRim);
    const float reach = std::min(kDrift, kRim - std::sqrt(start.x * start.x + start.y * start.y));
    std::array<glm::vec3, kControls> controls;  // drift x, y; tan of half the turn
    for (glm::vec3& c : controls) {
      const glm::vec2 drift = reach > 0 ? random.on_disk(0.0F, reach) : glm::vec2(0.0F);
      c = {drift.x, drift.y, kHalfTurn * random.signed_unit()};
    }
    for (std::size_t k = 0; k < kPoints; ++k) {
      const float t = static_cast<float>(k) / static_cast<float>(kPoints - 1);
      const glm::vec3 wander = evaluate_b_spline(controls, t);
      const glm::vec2 p = turned({start.x + wander.x, start.y + wander.y}, wander.z);
      cluster.strand_points.push_back({t, p.x, p.y});
    }
    cluster.strand_offsets.push_back(static_cast<std::uint32_t>(cluster.strand_points.size()));
  }
}

}  // namespace pelage
