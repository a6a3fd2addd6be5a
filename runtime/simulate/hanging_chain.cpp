#include "pelage/simulate/hanging_chain.h"

#include <cmath>

namespace pelage {

double laguerre(int n, double x) noexcept {
  double before = 1, now = 1 - x;
  if (n == 0) return 1;
  for (int k = 1; k < n; ++k) {
    const double next = ((2 * k + 1 - x) * now - k * before) / (k + 1);
    before = now;
    now = next;
  }
  return now;
}

double first_laguerre_zero(int n) noexcept {
  // L_n falls from 1 at 0 and is convex up to its first zero: Newton's steps from 0 stay below it.
  double x = 0;
  for (int i = 0; i < 60; ++i) {
    // x L_n' = n (L_n - L_{n-1}); at 0, L_n' = -n.
    const double value = laguerre(n, x), slope = x > 0 ? n * (value - laguerre(n - 1, x)) / x : -n;
    const double next = x - value / slope;
    if (!(next > x)) break;
    x = next;
  }
  return x;
}

std::vector<glm::vec3> chain_in_mode(int links, double length_m, double x, double amplitude_m,
                                     const glm::dvec3& aside) {
  const double link_m = length_m / links, top = laguerre(links, x);
  std::vector<glm::vec3> points{{0, 0, 0}};
  double along_m = 0, down_m = 0;
  for (int i = 1; i <= links; ++i) {
    const double to_m = amplitude_m * (laguerre(links - i, x) - top), d_m = to_m - along_m;
    along_m = to_m;
    down_m += std::sqrt(link_m * link_m - d_m * d_m);
    points.emplace_back(along_m * aside - glm::dvec3(0, down_m, 0));
  }
  return points;
}

}  // namespace pelage
