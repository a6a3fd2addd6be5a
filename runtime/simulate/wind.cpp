#include "pelage/simulate/wind.h"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <glm/geometric.hpp>
#include <glm/vec2.hpp>

#include "pelage/simulate/lane_math.h"

namespace pelage {
namespace {

constexpr std::array<float, 4> kShare{0.4F, 0.3F, 0.2F, 0.1F};         // of the waves, sum 1: |g| <= 1
constexpr std::array<double, 4> kLength{1.0, 1.3247, 0.7549, 0.5698};  // turns per gust_m: no common multiple
constexpr std::array<double, 4> kPeriod{1.0, 0.6180, 1.4656, 1.8393};  // turns per gust_s
constexpr double kLeast = 1e-3;  // of gust_m and gust_s: below, a gust is shorter than what it blows on
/// Of the waves' directions, across the wind, per unit along it.
constexpr std::array<glm::dvec2, 4> kAcross{{{0.0, 0.3}, {0.5, -0.2}, {-0.4, -0.5}, {0.1, 0.7}}};

/// sin(2 pi x), error < 5e-6, from operations that are the same everywhere. |x| < 2^31.
inline float sin_turns(float x) noexcept {
  const auto whole = static_cast<float>(static_cast<std::int32_t>(x + (x < 0 ? -0.5F : 0.5F)));
  const float f = x - whole;  // [-0.5, 0.5]
  const float half = f < 0 ? -0.5F : 0.5F;
  const float a = 6.28318531F * (f * f > 0.0625F ? half - f : f), a2 = a * a;
  return a * (1 + a2 * (-1.0F / 6 + a2 * (1.0F / 120 + a2 * (-1.0F / 5040 + a2 * (1.0F / 362880)))));
}

double wrapped(double turns) noexcept {
  return turns - std::nearbyint(turns);
}

/// Two unit vectors across a direction.
std::array<glm::dvec3, 2> across(const glm::dvec3& along) noexcept {
  const glm::dvec3 other = std::abs(along.y) < 0.7 ? glm::dvec3(0, 1, 0) : glm::dvec3(1, 0, 0);
  const glm::dvec3 side = glm::normalize(glm::cross(along, other));
  return {side, glm::cross(along, side)};
}

PELAGE_CLONES void add_wave(const float* x, const float* y, const float* z, glm::vec3 per_m, float phase, float share,
                            float* g, std::size_t n) noexcept {
  for (std::size_t i = 0; i < n; ++i) {
    g[i] += share * sin_turns(per_m.x * x[i] + per_m.y * y[i] + per_m.z * z[i] + phase);
  }
}

}  // namespace

Wind::Wind(const WindSettings& settings) : mean_m_s_(settings.velocity_m_s), gust_(settings.gust) {
  const glm::dvec3 mean(mean_m_s_);
  still_ = !(glm::dot(mean, mean) > 0) || !(settings.drag_per_s > 0);
  if (still_) return;
  const glm::dvec3 along = glm::normalize(mean);
  const auto [side, up] = across(along);
  for (std::size_t k = 0; k < kWaves; ++k) {
    const glm::dvec3 direction = glm::normalize(along + kAcross[k].x * side + kAcross[k].y * up);
    waves_[k].per_m = direction * (kLength[k] / std::max(static_cast<double>(settings.gust_m), kLeast));
    waves_[k].per_s = kPeriod[k] / std::max(static_cast<double>(settings.gust_s), kLeast);
    waves_[k].phase = 0.381966 * static_cast<double>(k);
  }
}

void Wind::set(double time_s, const glm::dvec3& pivot) noexcept {
  for (std::size_t k = 0; k < kWaves; ++k) {
    const Wave& w = waves_[k];
    phase_[k] = static_cast<float>(wrapped(glm::dot(w.per_m, pivot) - w.per_s * time_s + w.phase));
  }
}

void Wind::gusts(const float* x, const float* y, const float* z, float* g, std::size_t n) const noexcept {
  for (std::size_t i = 0; i < n; ++i) g[i] = 0;
  for (std::size_t k = 0; k < kWaves; ++k) add_wave(x, y, z, glm::vec3(waves_[k].per_m), phase_[k], kShare[k], g, n);
}

glm::vec3 Wind::at(const glm::vec3& p) const noexcept {
  float g = 0;
  gusts(&p.x, &p.y, &p.z, &g, 1);
  return mean_m_s_ * (1 + gust_ * g);
}

}  // namespace pelage
