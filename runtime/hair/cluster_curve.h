// Least-squares B-splines of a cluster: its centre line through weighted points, and its cross-sections from the spread
// of points in their plate planes. Both are clamped uniform cubic B-splines as data_schema/cluster.h evaluates them.
#pragma once

#include <array>
#include <cstddef>
#include <glm/vec2.hpp>
#include <glm/vec3.hpp>
#include <span>
#include <vector>

#include "pelage/data_schema/cluster.h"

namespace pelage::hair {

/// The four basis functions that are not 0 at x: they weigh control points first ... first + 3 and sum to 1.
struct BasisRow {
  std::size_t first;
  std::array<double, 4> weights;
};
BasisRow basis_row(std::size_t controls, double x);

/// A point that the curve shall pass near at parameter x in [0,1].
struct CurveSample {
  double x;
  glm::dvec3 point;
  double weight;
};

/// The curve shall move by `step` from x0 to x1.
struct StepSample {
  double x0, x1;
  glm::dvec3 step;
  double weight;
};

/// Control points (`controls` >= 4) that minimise
///   [sum w |C(x) - p|^2 + sum w |C(x1) - C(x0) - step|^2] / sum w of points  +  smoothing * integral |C''|^2 dx
/// [P-splines, Eilers and Marx 1996; the integral by differences over Greville abscissae: straight lines cost nothing].
/// A sine of n periods loses the share (2 pi n)^4 smoothing of its amplitude.
std::vector<glm::vec3> fit_curve(std::span<const CurveSample> points, std::span<const StepSample> steps,
                                 std::size_t controls, double smoothing);

/// A point in the plate plane of t.
struct PlaneSample {
  double t;
  glm::dvec2 plane_m;
  double weight;
};

/// Cross-sections whose ellipses follow the spread (second moments about the centre line) along t and hold the share
/// `coverage` of the samples' weight; both radii at least `min_radius_m`. Where few samples are, the spread of the
/// whole cluster fills in.
std::vector<CrossSection> fit_cross_sections(std::span<const PlaneSample> samples, std::size_t controls,
                                             double coverage, double min_radius_m);

}  // namespace pelage::hair
