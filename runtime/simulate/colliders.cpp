#include "pelage/simulate/colliders.h"

#include <algorithm>
#include <cmath>
#include <glm/geometric.hpp>
#include <glm/gtc/quaternion.hpp>
#include <string>

#include "pelage/data_schema/errors.h"
#include "pelage/simulate/lane_loops.h"

namespace pelage {
namespace {

using glm::dmat3;
using glm::dvec3;
using glm::vec3;

constexpr float kFar_m = 1e6F;        // distance where nothing is within reach
constexpr float kOnAxis_m2 = 1e-30F;  // squared distance below which a direction has no digits left
constexpr float kLargest_m = 1e9F;    // coordinates beyond this are refused: squares must stay finite
constexpr vec3 kFarNormal{0, 1, 0};

void check(const ColliderCapsule& c, std::size_t k) {
  const auto usable = [](const vec3& v) {
    return std::abs(v.x) < kLargest_m && std::abs(v.y) < kLargest_m && std::abs(v.z) < kLargest_m;
  };
  const std::string where = "collider " + std::to_string(k);
  if (!usable(c.from) || !usable(c.to) || !usable(c.velocity_m_s))
    throw UsageError(where + ": ends or velocity are not finite: give numbers");
  if (!(c.radius_m >= 0 && c.radius_m < kLargest_m))
    throw UsageError(where + ": radius " + std::to_string(c.radius_m) + ": give 0 or more");
}

/// Unit vector at right angles to `along`, as much upwards as that allows.
vec3 across(const vec3& along) {
  const float length = glm::length(along);
  if (!(length > 0)) return kFarNormal;
  const vec3 t = along / length;
  const vec3 other = std::abs(t.y) < 0.9F ? vec3(0, 1, 0) : vec3(1, 0, 0);
  return glm::normalize(other - glm::dot(other, t) * t);
}

vec3 sheet_normal(const vec3& a, const vec3& b, const vec3& c) {
  const vec3 n = glm::cross(b - a, c - a);
  const float length = glm::length(n);
  return length > 1e-12F ? n / length : across(std::max(glm::length(b - a), 0.0F) > 0 ? b - a : c - a);
}

SurfaceMotion motion_of(const RigidPose& before, const RigidPose& after) {
  const dmat3 turn = glm::mat3_cast(before.rotation * glm::conjugate(after.rotation));
  return {vec3(after.position - before.position), glm::mat3(dmat3(1) - turn)};
}

Mesh relative_to(const dvec3& pivot, const Mesh& mesh) {
  Mesh moved{{}, {}, mesh.triangles};
  for (const vec3& v : mesh.vertices) moved.vertices.emplace_back(dvec3(v) - pivot);
  return moved;
}

// Over lanes --------------------------------------------------------------------------------------------------------

/// Vectors from the nearest point of something to each lane's point.
struct Away {
  Lanes3 way;
  Lanes dist_sq;
};

[[gnu::always_inline]] inline vec3 from_segment(const vec3& p, const vec3& a, const vec3& ab,
                                                float per_length_sq) noexcept {
  const vec3 ap(p.x - a.x, p.y - a.y, p.z - a.z);
  const float along = (ap.x * ab.x + ap.y * ab.y + ap.z * ab.z) * per_length_sq;
  const float above = along > 0.0F ? along : 0.0F;
  const float t = above < 1.0F ? above : 1.0F;
  return {ap.x - t * ab.x, ap.y - t * ab.y, ap.z - t * ab.z};
}

float per_length_sq(const vec3& ab) noexcept {
  const float length_sq = glm::dot(ab, ab);
  return length_sq > kOnAxis_m2 ? 1.0F / length_sq : 0.0F;
}

PELAGE_CLONES void away_from_segment(const vec3 a, const vec3 ab, const float per_sq, const Lanes3& points,
                                     Away& out) noexcept {
  PELAGE_EACH_LANE
  for (int l = 0; l < kLanes; ++l) {
    const vec3 w = from_segment({points.x[l], points.y[l], points.z[l]}, a, ab, per_sq);
    out.way.x[l] = w.x, out.way.y[l] = w.y, out.way.z[l] = w.z;
    out.dist_sq.v[l] = w.x * w.x + w.y * w.y + w.z * w.z;
  }
}

void keep_nearer(const Away& from, Away& into) noexcept {
  PELAGE_EACH_LANE
  for (int l = 0; l < kLanes; ++l) {
    if (!(from.dist_sq.v[l] < into.dist_sq.v[l])) continue;
    into.way.x[l] = from.way.x[l], into.way.y[l] = from.way.y[l], into.way.z[l] = from.way.z[l];
    into.dist_sq.v[l] = from.dist_sq.v[l];
  }
}

/// Where a point lies over the triangle's inside: the way from its plane.
void away_from_face(const vec3& a, const vec3& b, const vec3& c, const Lanes3& points, Away& nearest) noexcept {
  const vec3 n = glm::cross(b - a, c - a);
  const float n_sq = glm::dot(n, n);
  if (!(n_sq > kOnAxis_m2)) return;
  PELAGE_EACH_LANE
  for (int l = 0; l < kLanes; ++l) {
    const vec3 p(points.x[l], points.y[l], points.z[l]);
    const bool inside = glm::dot(glm::cross(b - a, p - a), n) >= 0 && glm::dot(glm::cross(c - b, p - b), n) >= 0 &&
                        glm::dot(glm::cross(a - c, p - c), n) >= 0;
    if (!inside) continue;
    const vec3 w = glm::dot(p - a, n) / n_sq * n;
    nearest.way.x[l] = w.x, nearest.way.y[l] = w.y, nearest.way.z[l] = w.z;
    nearest.dist_sq.v[l] = glm::dot(w, w);
  }
}

void away_from_sheet(const CapsuleSolid& s, const Lanes3& points, Away& out) noexcept {
  const vec3 edges[5][2] = {{s.a, s.b}, {s.a, s.c}, {s.b, s.c}, {s.b, s.d}, {s.c, s.d}};
  std::fill_n(out.dist_sq.v, kLanes, INFINITY);
  for (const auto& e : edges) {
    Away away;
    away_from_segment(e[0], e[1] - e[0], per_length_sq(e[1] - e[0]), points, away);
    keep_nearer(away, out);
  }
  away_from_face(s.a, s.b, s.c, points, out);
  away_from_face(s.b, s.c, s.d, points, out);
}

PELAGE_CLONES void squares(const Lanes3& v, Lanes& out) noexcept {
  PELAGE_EACH_LANE
  for (int l = 0; l < kLanes; ++l) out.v[l] = v.x[l] * v.x[l] + v.y[l] * v.y[l] + v.z[l] * v.z[l];
}

PELAGE_CLONES void turn_lanes(const glm::mat3 turn, const Lanes3& v, Lanes3& out) noexcept {
  PELAGE_EACH_LANE
  for (int l = 0; l < kLanes; ++l) {
    const float x = v.x[l], y = v.y[l], z = v.z[l];
    out.x[l] = turn[0].x * x + turn[1].x * y + turn[2].x * z;
    out.y[l] = turn[0].y * x + turn[1].y * y + turn[2].y * z;
    out.z[l] = turn[0].z * x + turn[1].z * y + turn[2].z * z;
  }
}

/// Distance from a rounded axis, and the normal there.
PELAGE_CLONES void round_off(const Away& away, const float radius_m, const vec3 on_axis, Lanes& distance,
                             Lanes3& normal) noexcept {
  PELAGE_EACH_LANE
  for (int l = 0; l < kLanes; ++l) {
    const float length = std::sqrt(away.dist_sq.v[l]);
    const bool digits = away.dist_sq.v[l] > kOnAxis_m2;
    const float per = 1.0F / (digits ? length : 1.0F);
    distance.v[l] = length - radius_m;
    normal.x[l] = digits ? away.way.x[l] * per : on_axis.x;
    normal.y[l] = digits ? away.way.y[l] * per : on_axis.y;
    normal.z[l] = digits ? away.way.z[l] * per : on_axis.z;
  }
}

/// Takes a surface over where it is the nearest so far.
PELAGE_CLONES void take(const Lanes& distance, const Lanes3& n, const Lanes3& points, const SurfaceMotion& motion,
                        Nearest& out) noexcept {
  const vec3 o = motion.offset_m;
  const glm::mat3 turn = motion.turn;
  PELAGE_EACH_LANE
  for (int l = 0; l < kLanes; ++l) {
    const float d = distance.v[l];
    const bool nearer = d < out.distance.v[l];
    const float x = points.x[l] - d * n.x[l], y = points.y[l] - d * n.y[l], z = points.z[l] - d * n.z[l];
    const float mx = o.x + (turn[0].x * x + turn[1].x * y + turn[2].x * z);
    const float my = o.y + (turn[0].y * x + turn[1].y * y + turn[2].y * z);
    const float mz = o.z + (turn[0].z * x + turn[1].z * y + turn[2].z * z);
    out.distance.v[l] = nearer ? d : out.distance.v[l];
    out.normal.x[l] = nearer ? n.x[l] : out.normal.x[l];
    out.normal.y[l] = nearer ? n.y[l] : out.normal.y[l];
    out.normal.z[l] = nearer ? n.z[l] : out.normal.z[l];
    out.displacement.x[l] = nearer ? mx : out.displacement.x[l];
    out.displacement.y[l] = nearer ? my : out.displacement.y[l];
    out.displacement.z[l] = nearer ? mz : out.displacement.z[l];
  }
}

PELAGE_CLONES bool any_within(const Lanes& a, const float most) noexcept {
  int within = 0;
  for (int l = 0; l < kLanes; ++l) within |= a.v[l] <= most ? 1 : 0;
  return within != 0;
}

void set_far(Nearest& out) noexcept {
  std::fill_n(out.distance.v, kLanes, kFar_m);
  out.normal = out.displacement = {};
  std::fill_n(out.normal.y, kLanes, 1.0F);
}

void nearest_solid(const CapsuleSolid& s, const Lanes3& points, float reach_m, Nearest& out) noexcept {
  Away away;
  if (s.swept)
    away_from_sheet(s, points, away);
  else
    away_from_segment(s.a, s.b - s.a, per_length_sq(s.b - s.a), points, away);
  const float within_m = s.radius_m + reach_m;
  if (!any_within(away.dist_sq, within_m * within_m)) return;
  Lanes distance;
  Lanes3 normal;
  round_off(away, s.radius_m, s.normal, distance, normal);
  take(distance, normal, points, s.motion, out);
}

}  // namespace

Colliders::Colliders(const CollisionSettings& settings, const Mesh& head, const dvec3& pivot)
    : capsules_(settings.capsules), rest_pivot_(pivot) {
  for (std::size_t k = 0; k < capsules_.size(); ++k) check(capsules_[k], k);
  if (settings.head && !head.triangles.empty()) {
    if (!(settings.field_cell_m > 0 && settings.field_cell_m < kLargest_m))
      throw UsageError("field cell of " + std::to_string(settings.field_cell_m) + " m: give more than 0");
    auto field = std::make_shared<const MeshDistance>(relative_to(pivot, head), settings.field_cell_m);
    if (!field->empty()) field_ = std::move(field);
  }
  const RigidPose rest{pivot, {1, 0, 0, 0}};
  move(rest, rest, 0, 0);
}

bool Colliders::empty() const noexcept {
  return capsules_.empty() && !field_;
}

CapsuleSolid Colliders::solid_of(const ColliderCapsule& c, const RigidPose& before, const RigidPose& after,
                                 double time_s, double step_s) const {
  dvec3 now[2] = {dvec3(c.from), dvec3(c.to)}, then[2];
  for (int e = 0; e < 2; ++e) {
    if (c.with_head) {
      const dvec3 in_head = now[e] - rest_pivot_;
      now[e] = after.rotation * in_head;
      then[e] = before.rotation * in_head + (before.position - after.position);
    } else {
      now[e] += dvec3(c.velocity_m_s) * time_s - after.position;
      then[e] = now[e] - dvec3(c.velocity_m_s) * step_s;
    }
  }
  CapsuleSolid solid{.a = vec3(now[0]),
                     .b = vec3(now[1]),
                     .c = vec3(then[0]),
                     .d = vec3(then[1]),
                     .swept = false,
                     .radius_m = c.radius_m,
                     .normal = across(vec3(now[1] - now[0])),
                     .motion = {}};
  solid.motion = c.with_head ? head_motion_ : SurfaceMotion{vec3(now[0] - then[0]), glm::mat3(0)};
  const double way_m = std::max(glm::distance(now[0], then[0]), glm::distance(now[1], then[1]));
  if (way_m <= static_cast<double>(c.radius_m)) return solid;

  if (c.from == c.to) {  // a sphere: the capsule between both places
    solid.b = solid.c;
    solid.normal = across(solid.b - solid.a);
    return solid;
  }
  solid.swept = true;
  solid.normal = sheet_normal(solid.a, solid.b, solid.c);
  return solid;
}

void Colliders::move(const RigidPose& before, const RigidPose& after, double time_s, double step_s) {
  head_motion_ = motion_of(before, after);
  head_turn_ = glm::mat3(glm::mat3_cast(after.rotation));
  solids_.clear();
  for (const ColliderCapsule& c : capsules_) solids_.push_back(solid_of(c, before, after, time_s, step_s));
}

void Colliders::nearest(const Lanes3& points, float reach_m, Nearest& out) const noexcept {
  set_far(out);
  for (const CapsuleSolid& s : solids_) nearest_solid(s, points, reach_m, out);
  if (field_) nearest_of_field(points, reach_m, out);
}

void Colliders::nearest_of_field(const Lanes3& points, float reach_m, Nearest& out) const noexcept {
  Lanes3 in_head, normal;
  Lanes distance;
  squares(points, distance);
  const float within_m = field_->radius_m() + reach_m;
  if (!any_within(distance, within_m * within_m)) return;
  turn_lanes(glm::transpose(head_turn_), points, in_head);
  if (!field_->sample(in_head, reach_m, distance, normal)) return;
  turn_lanes(head_turn_, normal, in_head);
  take(distance, in_head, points, head_motion_, out);
}

}  // namespace pelage
