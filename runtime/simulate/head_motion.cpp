#include "pelage/simulate/head_motion.h"

#include <algorithm>
#include <cmath>
#include <glm/common.hpp>
#include <glm/geometric.hpp>
#include <glm/gtc/quaternion.hpp>
#include <string>

#include "pelage/data_schema/errors.h"

namespace pelage {
namespace {

using glm::dquat;
using glm::dvec3;

constexpr double kPi = 3.141592653589793;

// Periods of the built-in motions [s]; each ends at rest, so that hair can settle before it begins again.
constexpr double kShake_s = 4, kNod_s = 4, kTurn_s = 3.2, kJump_s = 4, kDance_s = 8;

struct Offset {
  dvec3 position_m{0};
  dvec3 turn_deg{0};  // about x, then y, then z
};

/// sin(2 pi x) to rounding by multiplications only: the same bits on every CPU.
double sin_turns(double turns) noexcept {
  double f = turns - std::floor(turns + 0.5);
  if (f > 0.25) f = 0.5 - f;
  if (f < -0.25) f = -0.5 - f;
  const double x = 2 * kPi * f, x2 = x * x;
  double series = 1;
  for (int k = 10; k >= 1; --k) series = 1 - x2 / ((2 * k) * (2 * k + 1)) * series;
  return x * series;
}

double cos_turns(double turns) noexcept {
  return sin_turns(turns + 0.25);
}

/// 0 below a, 1 above b, between them 3t^2 - 2t^3; steepest in the middle with 1.5 / (b - a).
double ease(double a, double b, double t) noexcept {
  const double u = std::clamp((t - a) / (b - a), 0.0, 1.0);
  return u * u * (3 - 2 * u);
}

/// 1 between a and b, 0 outside, eased over `soft_s` within.
double window(double a, double b, double soft_s, double t) noexcept {
  return ease(a, a + soft_s, t) * (1 - ease(b - soft_s, b, t));
}

dquat about_axis(int axis, double turn_deg) noexcept {
  dquat q(cos_turns(turn_deg / 720), 0, 0, 0);
  q[axis] = sin_turns(turn_deg / 720);
  return q;
}

dquat rotation(const dvec3& turn_deg) noexcept {
  if (turn_deg == dvec3(0)) return {1, 0, 0, 0};  // without rounding
  return about_axis(2, turn_deg.z) * about_axis(1, turn_deg.y) * about_axis(0, turn_deg.x);
}

/// 50 degrees to either side at 1.2 Hz for 3 s: 377 deg/s at the most, 0.7 m/s at 0.1 m from the axis.
Offset shake(double t) noexcept {
  return {.turn_deg = {0, 50 * window(0, 3, 0.5, t) * sin_turns(1.2 * t), 0}};
}

/// 25 degrees down and up at 1 Hz for 3 s: 157 deg/s.
Offset nod(double t) noexcept {
  return {.turn_deg = {25 * window(0, 3, 0.5, t) * sin_turns(t), 0, 0}};
}

/// Half a turn in 0.6 s, a second's rest, and back: 450 deg/s in the middle.
Offset turn(double t) noexcept {
  return {.turn_deg = {0, 180 * (ease(0, 0.6, t) - ease(1.6, 2.2, t)), 0}};
}

/// 0.3 m to the left at once after 0.5 s, back after 2.5 s. Not continuous: what abrupt tracking data looks like.
Offset jump(double t) noexcept {
  return {.position_m = {t >= 0.5 && t < 2.5 ? 0.3 : 0.0, 0, 0}};
}

/// Sway and bob all through; nods (1.5 to 3.5 s), fast turns (3.5 to 5.6 s), a toss: down, then back with a tilt (5.8
/// to 7.8 s). At the most about 0.5 m/s of the pivot and 500 deg/s.
Offset dance(double t) noexcept {
  const double all = window(0, 8, 0.8, t);
  const double nods = window(1.5, 3.5, 0.4, t) * sin_turns(2 * (t - 1.5));
  const double turns = window(3.5, 5.6, 0.4, t) * sin_turns(1.1 * (t - 3.5));
  const double down = window(5.8, 6.7, 0.4, t), back = window(6.3, 7.8, 0.4, t);
  const dvec3 position(0.12 * all * sin_turns(t / 2), -0.025 * all * (1 - cos_turns(2 * t)),
                       0.04 * all * sin_turns(t / 4));
  const dvec3 turn_deg(18 * nods + 40 * down - 45 * back, 20 * all * sin_turns(t / 4) + 65 * turns,
                       10 * all * sin_turns(t / 2) + 14 * back * sin_turns(0.7 * (t - 6.3)));
  return {position, turn_deg};
}

struct BuiltIn {
  double period_s;
  Offset (*offset)(double t) noexcept;
};

BuiltIn built_in(MotionKind kind) noexcept {
  switch (kind) {
    case MotionKind::shake:
      return {kShake_s, shake};
    case MotionKind::nod:
      return {kNod_s, nod};
    case MotionKind::turn:
      return {kTurn_s, turn};
    case MotionKind::jump:
      return {kJump_s, jump};
    case MotionKind::dance:
      return {kDance_s, dance};
    case MotionKind::none:
    case MotionKind::keyframes:
      break;
  }
  return {0, nullptr};
}

RigidPose built_in_pose(const MotionSettings& motion, const dvec3& pivot, double time_s) {
  const BuiltIn b = built_in(motion.kind);
  const double speed = static_cast<double>(motion.speed), amplitude = static_cast<double>(motion.amplitude);
  const Offset o = b.offset(std::fmod(std::max(time_s, 0.0) * speed, b.period_s));
  return {pivot + amplitude * o.position_m, rotation(amplitude * o.turn_deg)};
}

// Keyframes ---------------------------------------------------------------------------------------------------------

/// Rotation by the vector's length about its direction.
dquat exp_of(const dvec3& v) noexcept {
  const double half = 0.5 * glm::length(v);
  const double s = half > 1e-9 ? 0.5 * std::sin(half) / half : 0.5;
  return {std::cos(half), s * v.x, s * v.y, s * v.z};
}

/// The vector of the shorter way round, at most pi long.
dvec3 log_of(dquat q) noexcept {
  if (q.w < 0) q = -q;
  const dvec3 v(q.x, q.y, q.z);
  const double sine = glm::length(v);
  return sine > 1e-12 ? 2 * std::atan2(sine, q.w) / sine * v : 2.0 * v;
}

/// Slope at a key between two chords: their weighted harmonic mean, 0 where they differ in sign [Fritsch1984]: no
/// component overshoots its keys.
dvec3 key_slope(const dvec3& before, double h0, const dvec3& after, double h1) noexcept {
  const double w0 = 2 * h1 + h0, w1 = h1 + 2 * h0;
  dvec3 slope(0);
  for (int a = 0; a < 3; ++a)
    if (before[a] * after[a] > 0) slope[a] = (w0 + w1) / (w0 / before[a] + w1 / after[a]);
  return slope;
}

struct Knot {
  double time_s;
  dvec3 position_m;
  dquat rotation;
};

void check(const std::vector<MotionKey>& keys) {
  if (keys.empty()) throw UsageError("motion of keyframes without keys: give at least one");
  double last_s = -1;
  for (std::size_t k = 0; k < keys.size(); ++k) {
    const std::string where = "motion key " + std::to_string(k);
    const glm::vec3 sum = keys[k].position_m + keys[k].turn_deg;
    if (!std::isfinite(keys[k].time_s) || !std::isfinite(sum.x + sum.y + sum.z))
      throw UsageError(where + " is not finite: give numbers");
    if (keys[k].time_s < 0 || keys[k].time_s <= last_s)
      throw UsageError(where + " at " + std::to_string(keys[k].time_s) + " s: give times from 0 on that increase");
    last_s = keys[k].time_s;
  }
}

/// Key `k`, counted from the head's rest at time 0 where the keys begin later.
Knot knot(const std::vector<MotionKey>& keys, std::size_t k) {
  const bool rest_first = keys.front().time_s > 0;
  if (rest_first && k == 0) return {0, dvec3(0), dquat(1, 0, 0, 0)};
  const MotionKey& key = keys[rest_first ? k - 1 : k];
  return {key.time_s, dvec3(key.position_m), rotation(dvec3(key.turn_deg))};
}

dvec3 slope_m_s(const Knot& a, const Knot& b, const Knot& c) noexcept {
  const double h0 = b.time_s - a.time_s, h1 = c.time_s - b.time_s;
  return key_slope((b.position_m - a.position_m) / h0, h0, (c.position_m - b.position_m) / h1, h1);
}

/// Angular velocity at b [rad/s], in b's axes.
dvec3 slope_rad_s(const Knot& a, const Knot& b, const Knot& c) noexcept {
  const double h0 = b.time_s - a.time_s, h1 = c.time_s - b.time_s;
  return key_slope(log_of(glm::conjugate(a.rotation) * b.rotation) / h0, h0,
                   log_of(glm::conjugate(b.rotation) * c.rotation) / h1, h1);
}

struct Slopes {
  dvec3 from_m_s{0}, to_m_s{0}, from_rad_s{0}, to_rad_s{0};
};

/// Cubic Hermite in space; for rotations the same with the cumulative Bernstein basis [Kim1995].
RigidPose between(const Knot& a, const Knot& b, const Slopes& s, double time_s) noexcept {
  const double h = b.time_s - a.time_s, u = (time_s - a.time_s) / h, v = 1 - u;
  const dvec3 a1 = a.position_m + h / 3 * s.from_m_s, b1 = b.position_m - h / 3 * s.to_m_s;
  const dvec3 position = v * v * v * a.position_m + 3 * u * v * v * a1 + 3 * u * u * v * b1 + u * u * u * b.position_m;

  const dvec3 w1 = h / 3 * s.from_rad_s, w3 = h / 3 * s.to_rad_s;
  const dvec3 w2 = log_of(exp_of(-w1) * glm::conjugate(a.rotation) * b.rotation * exp_of(-w3));
  const double c1 = 1 - v * v * v, c2 = u * u * (3 - 2 * u), c3 = u * u * u;
  return {position, glm::normalize(a.rotation * exp_of(c1 * w1) * exp_of(c2 * w2) * exp_of(c3 * w3))};
}

RigidPose key_pose(const std::vector<MotionKey>& keys, const dvec3& pivot, double time_s) {
  check(keys);
  const std::size_t count = keys.size() + (keys.front().time_s > 0 ? 1 : 0);
  std::size_t k = 0;  // the last knot not after the time
  while (k + 1 < count && knot(keys, k + 1).time_s <= time_s) ++k;
  const Knot a = knot(keys, k);
  if (k + 1 == count || time_s <= a.time_s) return {pivot + a.position_m, a.rotation};

  const Knot b = knot(keys, k + 1);
  Slopes slopes;  // zero at the first and the last key
  if (k > 0) {
    slopes.from_m_s = slope_m_s(knot(keys, k - 1), a, b);
    slopes.from_rad_s = slope_rad_s(knot(keys, k - 1), a, b);
  }
  if (k + 2 < count) {
    slopes.to_m_s = slope_m_s(a, b, knot(keys, k + 2));
    slopes.to_rad_s = slope_rad_s(a, b, knot(keys, k + 2));
  }
  const RigidPose offset = between(a, b, slopes, time_s);
  return {pivot + offset.position, offset.rotation};
}

}  // namespace

RigidPose head_pose(const MotionSettings& motion, const dvec3& pivot, double time_s) {
  if (motion.kind == MotionKind::none) return {pivot, dquat(1, 0, 0, 0)};
  if (motion.kind == MotionKind::keyframes) return key_pose(motion.keys, pivot, time_s);
  return built_in_pose(motion, pivot, time_s);
}

double motion_length_s(const MotionSettings& motion) {
  if (motion.kind == MotionKind::none) return 0;
  if (motion.kind != MotionKind::keyframes) return built_in(motion.kind).period_s / static_cast<double>(motion.speed);
  check(motion.keys);
  return motion.keys.back().time_s;
}

}  // namespace pelage
