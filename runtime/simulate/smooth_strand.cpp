#include "pelage/simulate/smooth_strand.h"

#include <algorithm>
#include <glm/geometric.hpp>

namespace pelage {

using glm::dvec3;

void SmoothStrand::set(std::span<const glm::vec3> strand) {
  root_ = dvec3(strand[0]);
  knots_.assign(1, {0, dvec3(0), dvec3(0), dvec3(0)});
  for (std::size_t i = 1; i < strand.size(); ++i) {
    const Knot& k = knots_.back();
    const dvec3 y = dvec3(strand[i]) - root_;
    const double u = glm::distance(k.y, y);
    knots_.push_back({k.s + u, y, k.y1 + 0.5 * u * (k.y + y), k.y2 + u * k.y1 + u * u * (k.y / 3.0 + y / 6.0)});
  }
}

const SmoothStrand::Knot& SmoothStrand::before(double s) const noexcept {
  const auto after =
      std::upper_bound(knots_.begin() + 1, knots_.end(), s, [](double value, const Knot& k) { return value < k.s; });
  return *(after - 1);
}

dvec3 SmoothStrand::position(double s) const noexcept {
  const Knot& k = before(s);
  if (&k == &knots_.back()) return k.y;
  const Knot& next = *(&k + 1);
  return k.y + (s - k.s) / (next.s - k.s) * (next.y - k.y);
}

dvec3 SmoothStrand::within(double s) const noexcept {
  const Knot& k = before(s);
  const double u = s - k.s;
  if (&k == &knots_.back()) return k.y2 + u * k.y1 + 0.5 * u * u * k.y;
  const Knot& next = *(&k + 1);
  const dvec3 slope = (next.y - k.y) / (next.s - k.s);
  return k.y2 + u * (k.y1 + u * (0.5 * k.y + u / 6.0 * slope));
}

dvec3 SmoothStrand::second_antiderivative(double s) const noexcept {
  if (s < 0) return -within(-s);
  const double beyond = s - length_m();
  if (beyond <= 0) return within(s);
  const Knot& tip = knots_.back();
  return 2.0 * tip.y2 + beyond * beyond * tip.y - within(length_m() - beyond);
}

dvec3 SmoothStrand::at(double s, double half_width_m) const noexcept {
  if (!(half_width_m > 0)) return root_ + position(s);
  const dvec3 sum = second_antiderivative(s - half_width_m) - 2.0 * second_antiderivative(s) +
                    second_antiderivative(s + half_width_m);
  return root_ + sum / (half_width_m * half_width_m);
}

}  // namespace pelage
