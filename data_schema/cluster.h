// Cluster: the generalized disk [Xu2006 section 3.2, eqs. 1-3]: an ellipse swept along a curve, and the strands in it.
//
// The cross-section is a symmetric 2x2 matrix S [m] that maps the unit disk to the plate plane, its entries B-splines
// over t: unlike eq. 1's half-axes A, B and phase theta it has no axis to flip, and theta turns the ellipse (as
// printed, theta shifts the phase u and leaves the ellipse where it is). A plate point with disk coordinates (x, y) = v
// (cos u, sin u) lies at  centre(t) + [normal(t) binormal(t)] S(t) (x, y). `t` is relative arc length along the centre
// line, 0 at the root, 1 at the tip.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <glm/mat4x4.hpp>
#include <glm/vec2.hpp>
#include <glm/vec3.hpp>
#include <span>
#include <vector>

namespace pelage {

/// Symmetric 2x2 matrix S [m], positive definite: unit disk -> plate plane (first axis: frame normal, second:
/// binormal).
struct CrossSection {
  float xx = 0, xy = 0, yy = 0;

  glm::vec2 apply(glm::vec2 p) const noexcept { return {xx * p.x + xy * p.y, xy * p.x + yy * p.y}; }
  float determinant() const noexcept { return xx * yy - xy * xy; }
  /// S^-1 d; S must be positive definite.
  glm::vec2 solve(glm::vec2 d) const noexcept {
    const float inv = 1.0F / determinant();
    return {inv * (yy * d.x - xy * d.y), inv * (xx * d.y - xy * d.x)};
  }
};

/// Half-axes and phase of the same ellipse, as eq. 1 names them: a_m >= b_m > 0, theta in (-pi/2, pi/2].
struct EllipseAxes {
  float a_m, b_m, theta_rad;
};
EllipseAxes ellipse_axes(const CrossSection& s) noexcept;
CrossSection cross_section(const EllipseAxes& axes) noexcept;

/// A strand's passage at `t` through disk coordinates (x, y) = v (cos u, sin u); inside the envelope x^2 + y^2 <= 1.
struct DiskPoint {
  float t, x, y;
};

struct Cluster {
  std::vector<glm::vec3> centre_line;        // control points [m] of a clamped uniform cubic B-spline, >= 4
  std::vector<CrossSection> cross_sections;  // control values of a clamped uniform cubic B-spline over t, >= 4
  glm::vec3 first_normal{1, 0, 0};           // frame normal at t = 0; made orthogonal to the tangent there
  // Strands of the cluster, each its own curve in (t, x, y) with its own t-range, t increasing along the strand.
  std::vector<std::uint32_t> strand_offsets{0};  // [strands + 1]
  std::vector<DiskPoint> strand_points;
  std::vector<glm::mat4> transforms;  // macro-cluster: one instance per matrix; empty: one, untransformed
  glm::vec3 colour{-1.0F};            // linear RGB, or negative: the material decides

  std::size_t strand_count() const noexcept { return strand_offsets.size() - 1; }
  std::span<const DiskPoint> strand(std::size_t i) const noexcept {
    return {strand_points.data() + strand_offsets[i], strand_points.data() + strand_offsets[i + 1]};
  }
};

/// Rotation-minimising frame [Wang2008, double reflection] at one plate. Orthonormal, right-handed:
/// cross(normal, binormal) = tangent.
struct Frame {
  glm::vec3 position;  // metres
  glm::vec3 tangent, normal, binormal;
  float curvature_per_m;  // of the centre line
};

/// The centre line alone, evaluated anywhere. Finite for straight lines, inflections and 180-degree folds.
class CentreLine {
 public:
  /// @throws InputError when fewer than 4 control points are given, one is not finite, or the line has no length.
  CentreLine(std::span<const glm::vec3> control, glm::vec3 first_normal);

  double length_m() const noexcept { return length_m_; }
  /// @param t  relative arc length, clamped to [0, 1]
  Frame frame(double t) const noexcept;

 private:
  using Span = std::array<glm::dvec3, 4>;  // coefficients of 1, w, w^2, w^3, w in [0, 1]
  struct Place {
    std::size_t span;
    double w;
  };
  struct Sample {
    Place place;
    double s;  // arc length from the root [m]
    glm::dvec3 position, tangent, normal;
  };
  glm::dvec3 position(const Place& p) const noexcept;
  glm::dvec3 derivative(const Place& p) const noexcept;
  glm::dvec3 direction(const Place& p, const glm::dvec3& otherwise) const noexcept;
  double curvature(const Place& p) const noexcept;
  double arc(std::size_t span, double w0, double w1) const noexcept;
  void tabulate_length();
  void tabulate_frames(glm::vec3 first_normal);

  std::vector<Span> spans_;
  std::vector<Sample> samples_;
  double length_m_ = 0, standstill_ = 0;
};

/// The cluster evaluated on `plates + 1` equally spaced plates t_i = i / plates.
struct SweptCluster {
  float length_m = 0;                        // arc length of the centre line
  std::vector<Frame> frames;                 // [plates + 1]
  std::vector<CrossSection> cross_sections;  // [plates + 1]

  int plates() const noexcept { return static_cast<int>(frames.size()) - 1; }
  /// World position [m] of disk point (x, y) on plate i.
  glm::vec3 point(int i, glm::vec2 disk) const noexcept {
    const Frame& f = frames[static_cast<std::size_t>(i)];
    const glm::vec2 p = cross_sections[static_cast<std::size_t>(i)].apply(disk);
    return f.position + p.x * f.normal + p.y * f.binormal;
  }
};

/// Evaluates centre line, frames and cross-sections. Finite for straight lines, inflections and 180-degree folds.
/// @throws InputError when fewer than 4 control points are given, one is not finite, or the line has no length.
SweptCluster sweep(const Cluster& cluster, int plates);

/// Neighbouring plates that cut each other: where the cross-section's radius towards the centre of curvature exceeds
/// 1 / curvature. Such HSVs are turned inside out on their inner side.
int overlapping_plates(const SweptCluster& swept);

/// Value of a clamped uniform cubic B-spline with these control points at parameter x in [0,1] (Cox-de Boor).
glm::vec3 evaluate_b_spline(std::span<const glm::vec3> control, float x) noexcept;
CrossSection evaluate_b_spline(std::span<const CrossSection> control, float x) noexcept;

/// Where a strand crosses the plane t: disk coordinates by linear interpolation, or nothing outside its t-range.
struct Crossing {
  std::uint32_t strand;
  glm::vec2 disk;
};
std::vector<Crossing> plate_crossings(const Cluster& cluster, float t);

}  // namespace pelage
