// Private to this box: a strand smoothed over its arc length by a hat of half-width h, exactly: the second difference
// (F(s - h) - 2 F(s) + F(s + h)) / h^2 of its second antiderivative F, a cubic on each segment. Beyond its ends the
// strand goes on as its point reflection there: ends stay, and so does what is straight. In double.
#pragma once

#include <cstddef>
#include <glm/vec3.hpp>
#include <span>
#include <vector>

namespace pelage {

class SmoothStrand {
 public:
  /// @param strand  >= 1 vertex, finite
  void set(std::span<const glm::vec3> strand);
  double length_m() const noexcept { return knots_.back().s; }
  double arc_m(std::size_t vertex) const noexcept { return knots_[vertex].s; }
  /// @param s  arc length [m] in [0, length]   @param half_width_m  at most the length; 0: not smoothed
  glm::dvec3 at(double s, double half_width_m) const noexcept;

 private:
  struct Knot {
    double s;
    glm::dvec3 y, y1, y2;  // relative to the root; first and second antiderivative
  };
  const Knot& before(double s) const noexcept;
  glm::dvec3 position(double s) const noexcept;
  glm::dvec3 second_antiderivative(double s) const noexcept;
  glm::dvec3 within(double s) const noexcept;

  std::vector<Knot> knots_;
  glm::dvec3 root_{0};
};

}  // namespace pelage
