#include "pelage/hair/cluster_curve.h"

#include <Eigen/Dense>
#include <algorithm>
#include <cmath>
#include <initializer_list>
#include <utility>

namespace pelage::hair {
namespace {

/// Weight of the whole cluster's spread in each cross-section, as a share of what a section has on average.
constexpr double kPriorShare = 0.02;
/// The thinner radius is at least this share of the larger: flatter disks have sectors sheared beyond DESIGN section 4.
constexpr double kMinAspect = 0.2;
/// Bounds of the envelope in standard deviations. A uniform disk ends at 2, a normal distribution has 95 % within 2.45.
constexpr double kMinEnvelope = 1.0, kMaxEnvelope = 4.0;

double knot(std::size_t i, std::size_t controls) {
  const double spans = static_cast<double>(controls - 3);
  return std::clamp(static_cast<double>(i) - 3.0, 0.0, spans) / spans;
}

/// Abscissa at which control point i has its greatest influence: the mean of its three inner knots.
double greville(std::size_t i, std::size_t controls) {
  return (knot(i + 1, controls) + knot(i + 2, controls) + knot(i + 3, controls)) / 3;
}

/// Adds smoothing * integral |C''|^2 dx to the normal matrix, C'' by second divided differences of the control points.
void add_smoothing(Eigen::MatrixXd& normal, std::size_t controls, double smoothing) {
  for (std::size_t i = 1; i + 1 < controls; ++i) {
    const double before = greville(i, controls) - greville(i - 1, controls);
    const double after = greville(i + 1, controls) - greville(i, controls);
    const double width = 0.5 * (before + after);
    const Eigen::Vector3d d(1 / (before * width), -(1 / before + 1 / after) / width, 1 / (after * width));
    const auto at = static_cast<Eigen::Index>(i - 1);
    normal.block<3, 3>(at, at) += smoothing * width * d * d.transpose();
  }
}

/// Normal equations of a curve's control points.
struct NormalEquations {
  explicit NormalEquations(std::size_t controls)
      : normal(Eigen::MatrixXd::Zero(static_cast<Eigen::Index>(controls), static_cast<Eigen::Index>(controls))),
        right(Eigen::MatrixXd::Zero(static_cast<Eigen::Index>(controls), 3)) {}

  /// The sum of factor * C(x) over `terms` shall be `value`.
  void add(std::initializer_list<std::pair<double, BasisRow>> terms, const glm::dvec3& value, double weight) {
    for (const auto& [fa, a] : terms) {
      const Eigen::Map<const Eigen::Vector4d> wa(a.weights.data());
      const auto row = static_cast<Eigen::Index>(a.first);
      right.block<4, 3>(row, 0) += weight * fa * wa * Eigen::RowVector3d(value.x, value.y, value.z);
      for (const auto& [fb, b] : terms) {
        const Eigen::Map<const Eigen::Vector4d> wb(b.weights.data());
        normal.block<4, 4>(row, static_cast<Eigen::Index>(b.first)) += weight * fa * fb * wa * wb.transpose();
      }
    }
  }
  void scale(double factor) { normal *= factor, right *= factor; }
  std::vector<glm::vec3> solve() const {
    const Eigen::MatrixXd solution = normal.ldlt().solve(right);
    std::vector<glm::vec3> points;
    for (Eigen::Index i = 0; i < solution.rows(); ++i) {
      points.emplace_back(solution(i, 0), solution(i, 1), solution(i, 2));
    }
    return points;
  }

  Eigen::MatrixXd normal, right;
};

using Matrix2 = Eigen::Matrix2d;

Matrix2 second_moment(const glm::dvec2& p) {
  return Matrix2{{p.x * p.x, p.x * p.y}, {p.x * p.y, p.y * p.y}};
}

/// Mean second moments around each control value [m^2].
std::vector<Matrix2> moments(std::span<const PlaneSample> samples, std::size_t controls) {
  std::vector<Matrix2> sums(controls, Matrix2::Zero());
  std::vector<double> weights(controls, 0.0);
  Matrix2 all = Matrix2::Zero();
  double total = 0;
  for (const PlaneSample& s : samples) {
    const BasisRow row = basis_row(controls, s.t);
    const Matrix2 m = second_moment(s.plane_m);
    for (std::size_t j = 0; j < 4; ++j) {
      sums[row.first + j] += s.weight * row.weights[j] * m;
      weights[row.first + j] += s.weight * row.weights[j];
    }
    all += s.weight * m;
    total += s.weight;
  }
  const double prior = kPriorShare * total / static_cast<double>(controls);
  for (std::size_t k = 0; k < controls; ++k) {
    sums[k] = (sums[k] + prior / total * all) / (weights[k] + prior);
  }
  return sums;
}

/// Ellipse of `envelope` standard deviations, with both radii at least min_radius_m.
CrossSection ellipse(const Matrix2& moment, double envelope, double min_radius_m) {
  const Eigen::SelfAdjointEigenSolver<Matrix2> eigen(moment);
  Eigen::Vector2d radii = envelope * eigen.eigenvalues().cwiseMax(0.0).cwiseSqrt();
  radii[1] = std::max(radii[1], min_radius_m);
  radii[0] = std::max({radii[0], min_radius_m, kMinAspect * radii[1]});
  const Matrix2 s = eigen.eigenvectors() * radii.asDiagonal() * eigen.eigenvectors().transpose();
  return {static_cast<float>(s(0, 0)), static_cast<float>(0.5 * (s(0, 1) + s(1, 0))), static_cast<float>(s(1, 1))};
}

std::vector<CrossSection> ellipses(const std::vector<Matrix2>& spread, double envelope, double min_radius_m) {
  std::vector<CrossSection> sections;
  for (const Matrix2& m : spread) sections.push_back(ellipse(m, envelope, min_radius_m));
  return sections;
}

/// Smallest radius v such that `share` of the weight lies within it.
double radius_quantile(std::vector<std::pair<double, double>> radius_and_weight, double share) {
  std::sort(radius_and_weight.begin(), radius_and_weight.end());
  double total = 0, sum = 0;
  for (const auto& [radius, weight] : radius_and_weight) total += weight;
  for (const auto& [radius, weight] : radius_and_weight) {
    sum += weight;
    if (sum >= share * total) return radius;
  }
  return radius_and_weight.back().first;
}

}  // namespace

BasisRow basis_row(std::size_t controls, double x) {
  x = std::clamp(x, 0.0, 1.0);
  const std::size_t spans = controls - 3;
  const std::size_t first = std::min(static_cast<std::size_t>(x * static_cast<double>(spans)), spans - 1);
  std::array<double, 4> n{1, 0, 0, 0};  // Cox-de Boor, degree by degree
  for (std::size_t degree = 1; degree <= 3; ++degree) {
    double carried = 0;
    for (std::size_t j = 0; j < degree; ++j) {
      const double right = knot(first + 4 + j, controls), left = knot(first + 4 + j - degree, controls);
      const double part = n[j] / (right - left);
      n[j] = carried + (right - x) * part;
      carried = (x - left) * part;
    }
    n[degree] = carried;
  }
  return {first, n};
}

std::vector<glm::vec3> fit_curve(std::span<const CurveSample> points, std::span<const StepSample> steps,
                                 std::size_t controls, double smoothing) {
  NormalEquations equations(controls);
  double total = 0;
  for (const CurveSample& s : points) {
    equations.add({{1.0, basis_row(controls, s.x)}}, s.point, s.weight);
    total += s.weight;
  }
  for (const StepSample& s : steps) {
    equations.add({{1.0, basis_row(controls, s.x1)}, {-1.0, basis_row(controls, s.x0)}}, s.step, s.weight);
  }
  equations.scale(1 / total);
  add_smoothing(equations.normal, controls, smoothing);
  return equations.solve();
}

std::vector<CrossSection> fit_cross_sections(std::span<const PlaneSample> samples, std::size_t controls,
                                             double coverage, double min_radius_m) {
  const std::vector<Matrix2> spread = moments(samples, controls);
  const std::vector<CrossSection> unit = ellipses(spread, 1.0, min_radius_m);
  std::vector<std::pair<double, double>> radii;
  radii.reserve(samples.size());
  for (const PlaneSample& s : samples) {
    const CrossSection section = evaluate_b_spline(std::span(unit), static_cast<float>(s.t));
    const glm::vec2 disk = section.solve(glm::vec2(s.plane_m));
    radii.emplace_back(std::hypot(static_cast<double>(disk.x), static_cast<double>(disk.y)), s.weight);
  }
  const double envelope = std::clamp(radius_quantile(std::move(radii), coverage), kMinEnvelope, kMaxEnvelope);
  return ellipses(spread, envelope, min_radius_m);
}

}  // namespace pelage::hair
