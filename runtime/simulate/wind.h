// Wind with gusts: the mean wind times 1 + gust x g(p, t), where g is a sum of four waves that run through the world in
// directions near the wind's own, their lengths and periods around gust_m and gust_s without a common multiple. g is
// smooth, has mean 0 and lies in [-1, 1] by construction; it is the same on every machine (no libm).
#pragma once

#include <array>
#include <cstddef>
#include <glm/vec3.hpp>

#include "pelage/data_schema/simulation_settings.h"

namespace pelage {

class Wind {
 public:
  explicit Wind(const WindSettings& settings);

  /// No wind: nothing to ask.
  bool still() const noexcept { return still_; }
  /// From here on at this time, points being relative to the pivot.
  void set(double time_s, const glm::dvec3& pivot) noexcept;
  /// g at n points (arrays of coordinates).
  void gusts(const float* x, const float* y, const float* z, float* g, std::size_t n) const noexcept;
  /// Velocity at a point.
  glm::vec3 at(const glm::vec3& p) const noexcept;

  const glm::vec3& mean_m_s() const noexcept { return mean_m_s_; }
  float gust() const noexcept { return gust_; }

 private:
  static constexpr std::size_t kWaves = 4;
  struct Wave {
    glm::dvec3 per_m{0};  // turns
    double per_s = 0;     // turns
    double phase = 0;     // turns
  };
  std::array<Wave, kWaves> waves_;
  std::array<float, kWaves> phase_{};  // at the pivot now, [-0.5, 0.5] turns
  glm::vec3 mean_m_s_{0};
  float gust_ = 0;
  bool still_ = true;
};

}  // namespace pelage
