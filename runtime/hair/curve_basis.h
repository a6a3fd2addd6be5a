// Private to this box: cubic curves from control points, evaluated to two vertices per control point, evenly in the
// parameter. Uniform cubic B-spline, uniform Catmull-Rom (tension 1/2) and Bezier, as USD's BasisCurves defines them:
// the first span has control points 0 to 3, the next starts one (Bezier: three) further on; a curve with open ends
// starts at its first control point for Bezier only.
#pragma once

#include <cstddef>
#include <glm/vec4.hpp>
#include <span>

namespace pelage::hair {

enum class Basis { b_spline, catmull_rom, bezier };

/// How a strand of `control_points` (>= 4) divides.
struct CurveSpans {
  std::size_t spans, step;  // control points from one span to the next
  std::size_t used;         // control points; the rest belongs to no whole span
  std::size_t vertices;     // to evaluate

  /// Parameter of vertex k, in [0, spans].
  double parameter(std::size_t k) const noexcept {
    return static_cast<double>(k * spans) / static_cast<double>(vertices - 1);
  }
};
CurveSpans divide(Basis basis, std::size_t control_points) noexcept;

/// Vertex k of the curve; all four components are treated alike.
glm::vec4 evaluate(Basis basis, const CurveSpans& spans, std::span<const glm::vec4> control, std::size_t k) noexcept;

}  // namespace pelage::hair
