// The small swings of a hanging chain, which solvers are measured against: N equal masses on links of L/N swing with
// omega_k^2 = (g N / L) x_k, x_k the k-th zero of the Laguerre polynomial L_N, and in the shape u_j = L_j(x_k), j links
// from the free end. N to infinity: x_k N -> j_{0,k}^2 / 4, the zeros of Bessel's J0 [Bernoulli 1733].
#pragma once

#include <glm/vec3.hpp>
#include <vector>

namespace pelage {

/// Laguerre polynomial L_n(x).
double laguerre(int n, double x) noexcept;
/// Its least zero, to rounding. @param n  >= 1
double first_laguerre_zero(int n) noexcept;

/// The chain in the mode of zero x, `amplitude_m` at its tip along the horizontal `aside`; from its root at the origin.
std::vector<glm::vec3> chain_in_mode(int links, double length_m, double x, double amplitude_m,
                                     const glm::dvec3& aside = {1, 0, 0});

/// Time of one swing [s]: mean over the sign changes of `x(t)` sampled at every step, from the first to the last.
class SwingClock {
 public:
  void sample(double time_s, double x) noexcept {
    if (last_ * x < 0) {
      const double crossing = time_s - (time_s - last_time_) * x / (x - last_);
      if (crossings_++ == 0) first_crossing_ = crossing;
      last_crossing_ = crossing;
    }
    last_ = x;
    last_time_ = time_s;
  }
  int crossings() const noexcept { return crossings_; }
  /// Of at least two crossings.
  double period_s() const noexcept { return 2 * (last_crossing_ - first_crossing_) / (crossings_ - 1); }

 private:
  double last_ = 0, last_time_ = 0, first_crossing_ = 0, last_crossing_ = 0;
  int crossings_ = 0;
};

}  // namespace pelage
