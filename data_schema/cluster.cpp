// Evaluates generalized disks: clamped uniform cubic B-splines by their blossom, arc length by a dense table (3-point
// Gauss-Legendre, then one Newton step), rotation-minimising frames by double reflection [Wang2008], all in double.
// Frames are propagated along the table, not from plate to plate: they do not depend on the number of plates.
// Where the line stands still (duplicate control points) or turns on the spot (a fold) the tangent before is kept.
#include "pelage/data_schema/cluster.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <glm/geometric.hpp>
#include <numbers>
#include <string>

#include "pelage/data_schema/errors.h"

namespace pelage {
namespace {

using glm::dvec3;

constexpr int kSamplesPerSpan = 32;
constexpr double kMinLength_m = 1e-9;        // shorter centre lines have no direction in float
constexpr double kMaxCurvature_per_m = 1e6;  // bounds the curvature of a cusp, infinite otherwise
constexpr double kStandstill = 1e-9;         // |derivative| below this share of the line's size has no direction

dvec3 widen(const glm::vec3& v) {
  return dvec3(v);
}

struct Symmetric {
  double xx, xy, yy;
};
Symmetric widen(const CrossSection& s) {
  return {static_cast<double>(s.xx), static_cast<double>(s.xy), static_cast<double>(s.yy)};
}

dvec3 mix(const dvec3& a, const dvec3& b, double w) {
  return a + w * (b - a);
}
Symmetric mix(const Symmetric& a, const Symmetric& b, double w) {
  return {a.xx + w * (b.xx - a.xx), a.xy + w * (b.xy - a.xy), a.yy + w * (b.yy - a.yy)};
}

double knot(int i, int spans) {
  return std::clamp(i - 3, 0, spans) / static_cast<double>(spans);
}

/// Blossom of span `k` at (x[0], x[1], x[2]): de Boor with its own parameter on each level. Equal parameters give the
/// curve, the span's ends in mixed order its Bezier points.
template <class Value>
auto blossom(std::span<const Value> control, int k, const std::array<double, 3>& x) {
  const int spans = static_cast<int>(control.size()) - 3;
  std::array<decltype(widen(control[0])), 4> d;
  for (int j = 0; j < 4; ++j) d[static_cast<std::size_t>(j)] = widen(control[static_cast<std::size_t>(k + j)]);
  for (int r = 1; r <= 3; ++r) {
    for (int j = 3; j >= r; --j) {
      const double a = knot(k + j, spans), b = knot(k + j + 4 - r, spans);
      const auto to = static_cast<std::size_t>(j);
      d[to] = mix(d[to - 1], d[to], (x[static_cast<std::size_t>(r - 1)] - a) / (b - a));
    }
  }
  return d[3];
}

template <class Value>
auto evaluate(std::span<const Value> control, double x) {
  PELAGE_ASSERT(control.size() >= 4);
  const int spans = static_cast<int>(control.size()) - 3;
  x = std::clamp(x, 0.0, 1.0);
  const int k = std::min(static_cast<int>(x * spans), spans - 1);
  return blossom(control, k, {x, x, x});
}

bool is_finite(const glm::vec3& v) {
  return std::isfinite(v.x) && std::isfinite(v.y) && std::isfinite(v.z);
}
bool is_positive_definite(const CrossSection& s) {
  const Symmetric d = widen(s);
  return std::isfinite(d.xx) && std::isfinite(d.yy) && d.xx > 0 && d.yy > 0 && d.xx * d.yy - d.xy * d.xy > 0;
}

void check_control_points(std::span<const glm::vec3> control) {
  if (control.size() < 4) {
    throw InputError("centre_line", std::to_string(control.size()) + " control points, at least 4 are needed");
  }
  for (std::size_t i = 0; i < control.size(); ++i) {
    if (!is_finite(control[i])) throw InputError("centre_line[" + std::to_string(i) + "]", "not a finite point");
  }
}

void check_cross_sections(std::span<const CrossSection> control) {
  if (control.size() < 4) {
    throw InputError("cross_sections", std::to_string(control.size()) + " control values, at least 4 are needed");
  }
  for (std::size_t i = 0; i < control.size(); ++i) {
    if (!is_positive_definite(control[i])) {
      throw InputError("cross_sections[" + std::to_string(i) + "]", "not positive definite: both radii must be > 0");
    }
  }
}

double extent(std::span<const glm::vec3> control) {
  dvec3 low(control[0]), high(control[0]);
  for (const glm::vec3& p : control) {
    low = glm::min(low, dvec3(p));
    high = glm::max(high, dvec3(p));
  }
  return glm::length(high - low);
}

dvec3 any_perpendicular(const dvec3& t) {
  const dvec3 a = glm::abs(t);
  const dvec3 axis = a.x <= a.y && a.x <= a.z ? dvec3(1, 0, 0) : a.y <= a.z ? dvec3(0, 1, 0) : dvec3(0, 0, 1);
  return glm::normalize(axis - glm::dot(axis, t) * t);
}

/// `v` made orthogonal to the unit vector `t`, or any perpendicular where that leaves nothing.
dvec3 orthogonalised(const dvec3& v, const dvec3& t) {
  const dvec3 w = v - glm::dot(v, t) * t;
  const double length = glm::length(w);
  return length > 1e-6 * glm::length(v) && std::isfinite(length) ? w / length : any_perpendicular(t);
}

/// [Wang2008, Table I]: two reflections take (tangent, normal) along the chord `v1` to the tangent `to`. Where the line
/// turns on the spot the first reflection alone, or none, leaves the normal as it is.
dvec3 double_reflection(const dvec3& v1, const dvec3& from, const dvec3& normal, const dvec3& to) {
  const double c1 = glm::dot(v1, v1);
  if (!(c1 > 0)) return orthogonalised(normal, to);
  const dvec3 n = normal - (2 * glm::dot(v1, normal) / c1) * v1;
  const dvec3 v2 = to - (from - (2 * glm::dot(v1, from) / c1) * v1);
  const double c2 = glm::dot(v2, v2);
  return orthogonalised(c2 > 1e-24 ? n - (2 * glm::dot(v2, n) / c2) * v2 : n, to);
}

}  // namespace

CentreLine::CentreLine(std::span<const glm::vec3> control, glm::vec3 first_normal) {
  check_control_points(control);
  const int spans = static_cast<int>(control.size()) - 3;
  spans_.reserve(static_cast<std::size_t>(spans));
  for (int k = 0; k < spans; ++k) {
    const double a = knot(k + 3, spans), b = knot(k + 4, spans);
    const dvec3 b0 = blossom(control, k, {a, a, a}), b1 = blossom(control, k, {a, a, b});
    const dvec3 b2 = blossom(control, k, {a, b, b}), b3 = blossom(control, k, {b, b, b});
    spans_.push_back({b0, 3.0 * (b1 - b0), 3.0 * (b2 - 2.0 * b1 + b0), b3 - 3.0 * b2 + 3.0 * b1 - b0});
  }
  standstill_ = kStandstill * extent(control);
  tabulate_length();
  if (!(length_m_ > kMinLength_m)) throw InputError("centre_line", "has no length: all control points coincide");
  tabulate_frames(first_normal);
}

dvec3 CentreLine::position(const Place& p) const noexcept {
  const Span& c = spans_[p.span];
  return c[0] + p.w * (c[1] + p.w * (c[2] + p.w * c[3]));
}

dvec3 CentreLine::derivative(const Place& p) const noexcept {
  const Span& c = spans_[p.span];
  return c[1] + p.w * (2.0 * c[2] + 3.0 * p.w * c[3]);
}

/// Arc length of one span from w0 to w1, 3-point Gauss-Legendre.
double CentreLine::arc(std::size_t span, double w0, double w1) const noexcept {
  const double half = 0.5 * (w1 - w0), mid = 0.5 * (w0 + w1), off = half * 0.77459666924148338;
  return half * (5.0 / 9 * glm::length(derivative({span, mid - off})) + 8.0 / 9 * glm::length(derivative({span, mid})) +
                 5.0 / 9 * glm::length(derivative({span, mid + off})));
}

void CentreLine::tabulate_length() {
  samples_.push_back({{0, 0.0}, 0.0, {}, {}, {}});
  for (std::size_t k = 0; k < spans_.size(); ++k) {
    for (int i = 1; i <= kSamplesPerSpan; ++i) {
      const double w0 = (i - 1) / static_cast<double>(kSamplesPerSpan), w1 = i / static_cast<double>(kSamplesPerSpan);
      length_m_ += arc(k, w0, w1);
      samples_.push_back({{k, w1}, length_m_, {}, {}, {}});
    }
  }
}

void CentreLine::tabulate_frames(glm::vec3 first_normal) {
  dvec3 tangent(0);
  for (Sample& s : samples_) {  // the first direction there is
    tangent = derivative(s.place);
    if (glm::length(tangent) > standstill_) break;
  }
  tangent = glm::normalize(tangent);
  dvec3 normal = orthogonalised(dvec3(first_normal), tangent);
  dvec3 last = position(samples_[0].place);
  for (Sample& s : samples_) {
    s.position = position(s.place);
    s.tangent = direction(s.place, tangent);
    s.normal = double_reflection(s.position - last, tangent, normal, s.tangent);
    last = s.position, tangent = s.tangent, normal = s.normal;
  }
}

dvec3 CentreLine::direction(const Place& p, const dvec3& otherwise) const noexcept {
  const dvec3 d = derivative(p);
  const double speed = glm::length(d);
  return speed > standstill_ ? d / speed : otherwise;
}

double CentreLine::curvature(const Place& p) const noexcept {
  const Span& c = spans_[p.span];
  const dvec3 d1 = derivative(p), d2 = 2.0 * c[2] + 6.0 * p.w * c[3];
  const double speed = glm::length(d1);
  if (speed <= standstill_) return 0;  // a stop, or a fold on the spot: no circle touches it
  return std::min(glm::length(glm::cross(d1, d2)) / (speed * speed * speed), kMaxCurvature_per_m);
}

Frame CentreLine::frame(double t) const noexcept {
  const double s = std::clamp(t, 0.0, 1.0) * length_m_;
  const auto next = std::lower_bound(samples_.begin() + 1, samples_.end() - 1, s,
                                     [](const Sample& a, double value) { return a.s < value; });
  const Sample& from = *(next - 1);
  const std::size_t span = next->place.span;
  const double w0 = next->place.w - 1.0 / kSamplesPerSpan, w1 = next->place.w;
  const double step = next->s - from.s;
  Place p{span, step > 0 ? w0 + (w1 - w0) * (s - from.s) / step : w0};
  const double speed = glm::length(derivative(p));
  if (speed > standstill_) p.w = std::clamp(p.w - (from.s + arc(span, w0, p.w) - s) / speed, w0, w1);
  const dvec3 x = position(p), tangent = direction(p, from.tangent);
  const dvec3 normal = double_reflection(x - from.position, from.tangent, from.normal, tangent);
  return {glm::vec3(x), glm::vec3(tangent), glm::vec3(normal), glm::vec3(glm::cross(tangent, normal)),
          static_cast<float>(curvature(p))};
}

SweptCluster sweep(const Cluster& cluster, int plates) {
  if (plates < 1) throw InputError("plates", std::to_string(plates) + ", at least 1 is needed");
  check_cross_sections(cluster.cross_sections);
  const CentreLine line(cluster.centre_line, cluster.first_normal);
  SweptCluster swept;
  swept.length_m = static_cast<float>(line.length_m());
  for (int i = 0; i <= plates; ++i) {
    const double t = i / static_cast<double>(plates);
    swept.frames.push_back(line.frame(t));
    swept.cross_sections.push_back(evaluate_b_spline(cluster.cross_sections, static_cast<float>(t)));
  }
  return swept;
}

int overlapping_plates(const SweptCluster& swept) {
  // Farthest reach of plate `a` past the plane of plate `b`, along b's tangent.
  const auto reach = [&](std::size_t a, std::size_t b) {
    const Frame &from = swept.frames[a], &to = swept.frames[b];
    const glm::vec2 along(glm::dot(from.normal, to.tangent), glm::dot(from.binormal, to.tangent));
    const float side = b > a ? 1.0F : -1.0F;
    return side * glm::dot(from.position - to.position, to.tangent) + glm::length(swept.cross_sections[a].apply(along));
  };
  int count = 0;
  for (std::size_t i = 0; i + 1 < swept.frames.size(); ++i) count += reach(i, i + 1) > 0 || reach(i + 1, i) > 0;
  return count;
}

glm::vec3 evaluate_b_spline(std::span<const glm::vec3> control, float x) noexcept {
  return glm::vec3(evaluate(control, static_cast<double>(x)));
}

CrossSection evaluate_b_spline(std::span<const CrossSection> control, float x) noexcept {
  const Symmetric s = evaluate(control, static_cast<double>(x));
  return {static_cast<float>(s.xx), static_cast<float>(s.xy), static_cast<float>(s.yy)};
}

EllipseAxes ellipse_axes(const CrossSection& s) noexcept {
  const Symmetric d = widen(s);
  const double a = 0.5 * (d.xx + d.yy) + std::hypot(0.5 * (d.xx - d.yy), d.xy);
  const double b = a > 0 ? (d.xx * d.yy - d.xy * d.xy) / a : 0.0;  // det / a: the difference would cancel
  double theta = 0.5 * std::atan2(2 * d.xy, d.xx - d.yy);
  if (theta <= -0.5 * std::numbers::pi) theta = 0.5 * std::numbers::pi;  // atan2(-0, -1) = -pi
  return {static_cast<float>(a), static_cast<float>(b), static_cast<float>(theta)};
}

CrossSection cross_section(const EllipseAxes& axes) noexcept {
  const double a = static_cast<double>(axes.a_m), b = static_cast<double>(axes.b_m);
  const double c = std::cos(static_cast<double>(axes.theta_rad)), s = std::sin(static_cast<double>(axes.theta_rad));
  return {static_cast<float>(a * c * c + b * s * s), static_cast<float>((a - b) * c * s),
          static_cast<float>(a * s * s + b * c * c)};
}

std::vector<Crossing> plate_crossings(const Cluster& cluster, float t) {
  std::vector<Crossing> crossings;
  for (std::size_t i = 0; i < cluster.strand_count(); ++i) {
    const std::span<const DiskPoint> points = cluster.strand(i);
    if (points.empty() || !(t >= points.front().t && t <= points.back().t)) continue;
    const auto after =
        std::upper_bound(points.begin(), points.end(), t, [](float value, const DiskPoint& p) { return value < p.t; });
    const DiskPoint& a = *(after - 1);
    glm::vec2 disk(a.x, a.y);
    if (after != points.end()) disk += (t - a.t) / (after->t - a.t) * (glm::vec2(after->x, after->y) - disk);
    crossings.push_back({static_cast<std::uint32_t>(i), disk});
  }
  return crossings;
}

}  // namespace pelage
