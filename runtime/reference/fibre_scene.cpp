#include "pelage/reference/fibre_scene.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <glm/geometric.hpp>
#include <glm/vec4.hpp>
#include <string>

#include "pelage/data_schema/errors.h"
#include "pelage/reference/embree_scene.h"

namespace pelage {
namespace {

/// Widening of the candidates: of their radius, and, for Embree's rounding, of the hair's size and distance from the
/// world's origin: 16 eps.
constexpr double kWiden = 1.01, kRounding = 1e-6;
/// Embree drops hits within 2 radii of a ray's origin: it starts this many radii earlier.
constexpr double kBackOff_radii = 4;
constexpr std::uint32_t kNoPrimitive = 0xffffffffU;

/// Where a ray passes a segment: nearest to its axis, seen along the ray.
struct Pass {
  bool hit = false;
  double depth_m = 0, along = 0;
  double radius_m = 0, axis2 = 0, seen2 = 0;  // squared length of the axis, in space and as the ray sees it
  glm::dvec3 offset_m{0};

  /// Half chord, r / sin(theta), of a ray through the axis.
  double reach_m() const noexcept { return radius_m * std::sqrt(axis2 / seen2); }
};

struct Segment {
  glm::dvec3 a, b;
  double radius_a = 0, radius_b = 0;
  bool joint_a = false, joint_b = false;  // a neighbour goes on there
};

Pass pass_by(const FibreRay& ray, const Segment& s) noexcept {
  const glm::dvec3 to_a = s.a - ray.origin, axis = s.b - s.a;
  const double a_depth = glm::dot(to_a, ray.direction), axis_depth = glm::dot(axis, ray.direction);
  const glm::dvec3 a_seen = to_a - a_depth * ray.direction, axis_seen = axis - axis_depth * ray.direction;
  const double seen2 = glm::dot(axis_seen, axis_seen);
  const double unbounded = seen2 > 0 ? -glm::dot(a_seen, axis_seen) / seen2 : 0;
  Pass pass;
  if ((unbounded < 0 && !s.joint_a) || (unbounded > 1 && !s.joint_b)) return pass;
  pass.along = std::clamp(unbounded, 0.0, 1.0);
  pass.depth_m = a_depth + pass.along * axis_depth;
  pass.radius_m = s.radius_a + (s.radius_b - s.radius_a) * pass.along;
  pass.offset_m = -(a_seen + pass.along * axis_seen);
  pass.axis2 = glm::dot(axis, axis), pass.seen2 = seen2;
  pass.hit = glm::dot(pass.offset_m, pass.offset_m) < pass.radius_m * pass.radius_m && pass.depth_m > 0 &&
             pass.depth_m < ray.length_m;
  return pass;
}

/// Are these hits of neighbours one crossing?
bool together(const Pass& a, const Pass& b) noexcept {
  return std::abs(a.depth_m - b.depth_m) <= a.reach_m() + b.reach_m();
}

struct Box {
  glm::dvec3 low{std::numeric_limits<double>::infinity()}, high{-std::numeric_limits<double>::infinity()};
  void add(const glm::dvec3& p, double radius) noexcept {
    low = glm::min(low, p - radius);
    high = glm::max(high, p + radius);
  }
};

/// The part of a ray inside a box; empty: first > last.
struct Span {
  double first, last;
};
Span inside(const Box& box, const FibreRay& ray) noexcept {
  Span span{0, ray.length_m};
  for (int k = 0; k < 3; ++k) {
    const double o = ray.origin[k], d = ray.direction[k];
    if (d == 0) {
      if (o < box.low[k] || o > box.high[k]) return {1, 0};
      continue;
    }
    const double t0 = (box.low[k] - o) / d, t1 = (box.high[k] - o) / d;
    span.first = std::max(span.first, std::min(t0, t1));
    span.last = std::min(span.last, std::max(t0, t1));
  }
  return span;
}

bool finite(const glm::vec3& v) noexcept {
  return std::isfinite(v.x) && std::isfinite(v.y) && std::isfinite(v.z);
}

RTCRay embree_ray(const FibreRay& ray, double first, double last) noexcept {
  const glm::vec3 o(ray.origin + first * ray.direction), d(ray.direction);
  RTCRay r{};
  r.org_x = o.x, r.org_y = o.y, r.org_z = o.z;
  r.dir_x = d.x, r.dir_y = d.y, r.dir_z = d.z;
  r.tnear = 0;
  r.tfar = static_cast<float>(last - first);
  r.mask = 0xffffffffU;
  return r;
}

}  // namespace

struct FibreScene::State {
  EmbreeDevice device;
  EmbreeScene hair, skin;

  std::vector<glm::vec4> points;          // [kept vertices + 1] position, widened radius; one more for Embree's loads
  std::vector<std::uint32_t> first;       // [segment] its first point: Embree's index buffer
  std::vector<std::uint32_t> vertex_of;   // [segment] its first vertex in Strands
  std::vector<std::uint32_t> segment_of;  // [vertex of Strands] or kNoPrimitive
  std::array<double, 4096> powers{};      // (1 - a)^n
  double least_widening = 0, greatest_radius = 0;
  Box box;

  std::vector<glm::vec4> head_points;  // one more than the head has
  std::vector<glm::uvec3> triangles;
  std::vector<glm::vec3> normals;
  Box head_box;

  bool follows(std::uint32_t segment) const noexcept { return segment > 0 && first[segment - 1] + 1 == first[segment]; }
  bool goes_on(std::uint32_t segment) const noexcept { return segment + 1 < first.size() && follows(segment + 1); }
  double radius(float widened) const noexcept { return (static_cast<double>(widened) - least_widening) / kWiden; }
  Segment segment(std::uint32_t i) const noexcept {
    const glm::vec4 a = points[first[i]], b = points[first[i] + 1];
    return {glm::dvec3(a), glm::dvec3(b), radius(a.w), radius(b.w), follows(i), goes_on(i)};
  }

  void take(const Strands& strands);
  void widen();
  void build_hair();
  void build_head(const Mesh& mesh);
};

namespace {

/// Diameter of a vertex. @throws InputError
float diameter_at(const Strands& strands, std::size_t strand, std::size_t i) {
  const float all = strands.diameter_m > 0 ? strands.diameter_m : default_diameter_m(strands.count());
  const float d = strands.diameters_m.empty() ? all : strands.diameters_m[i];
  const glm::vec3 p = strands.vertices[i];
  if (finite(p) && std::isfinite(d) && d >= 0) return d;
  throw InputError("strand " + std::to_string(strand) + ", vertex " + std::to_string(i - strands.offsets[strand]),
                   "position (" + std::to_string(p.x) + ", " + std::to_string(p.y) + ", " + std::to_string(p.z) +
                       ") m, diameter " + std::to_string(d) + " m: both must be finite, and the diameter not below 0");
}

}  // namespace

/// Keeps vertices that differ from the one before, and strands of at least two.
void FibreScene::State::take(const Strands& strands) {
  points.reserve(strands.vertices.size() + 1);
  segment_of.assign(strands.vertices.size(), kNoPrimitive);
  for (std::size_t s = 0; s < strands.count(); ++s) {
    const std::size_t begin = strands.offsets[s], end = strands.offsets[s + 1], before = first.size();
    std::size_t waiting = begin;  // vertices from here on belong to the next segment
    for (std::size_t i = begin; i < end; ++i) {
      const glm::vec4 point(strands.vertices[i], 0.5F * diameter_at(strands, s, i));
      if (i > begin && glm::vec3(points.back()) == glm::vec3(point)) continue;
      points.push_back(point);
      if (i == begin) continue;
      for (; waiting < i; ++waiting) segment_of[waiting] = static_cast<std::uint32_t>(first.size());
      vertex_of.push_back(static_cast<std::uint32_t>(i - 1));
      first.push_back(static_cast<std::uint32_t>(points.size() - 2));
    }
    if (first.size() == before) continue;
    for (; waiting < end; ++waiting) segment_of[waiting] = static_cast<std::uint32_t>(first.size() - 1);
  }
}

/// Radii as Embree gets them.
void FibreScene::State::widen() {
  for (const std::uint32_t i : first) {
    for (const std::uint32_t p : {i, i + 1}) {
      box.add(glm::dvec3(points[p]), static_cast<double>(points[p].w));
      greatest_radius = std::max(greatest_radius, static_cast<double>(points[p].w));
    }
  }
  if (first.empty()) return;
  const glm::dvec3 farthest = glm::max(glm::abs(box.low), glm::abs(box.high));
  // As float: then a radius of 0 comes back as 0.
  least_widening =
      static_cast<double>(static_cast<float>(kRounding * (glm::length(box.high - box.low) + glm::length(farthest))));
  for (glm::vec4& p : points) p.w = static_cast<float>(kWiden * static_cast<double>(p.w) + least_widening);
  points.emplace_back(0.0F);
}

void FibreScene::State::build_hair() {
  hair.reset(rtcNewScene(device.get()));
  rtcSetSceneBuildQuality(hair.get(), RTC_BUILD_QUALITY_HIGH);
  rtcSetSceneFlags(hair.get(), RTC_SCENE_FLAG_CONTEXT_FILTER_FUNCTION);
  if (!first.empty()) {
    const RTCGeometry g = rtcNewGeometry(device.get(), RTC_GEOMETRY_TYPE_FLAT_LINEAR_CURVE);
    rtcSetSharedGeometryBuffer(g, RTC_BUFFER_TYPE_VERTEX, 0, RTC_FORMAT_FLOAT4, points.data(), 0, sizeof(glm::vec4),
                               points.size() - 1);
    rtcSetSharedGeometryBuffer(g, RTC_BUFFER_TYPE_INDEX, 0, RTC_FORMAT_UINT, first.data(), 0, sizeof(std::uint32_t),
                               first.size());
    rtcCommitGeometry(g);
    rtcAttachGeometry(hair.get(), g);
    rtcReleaseGeometry(g);
  }
  rtcCommitScene(hair.get());
  check_embree(device.get());
}

void FibreScene::State::build_head(const Mesh& mesh) {
  for (const glm::vec3& p : mesh.vertices) {
    head_points.emplace_back(p, 0.0F);
    head_box.add(glm::dvec3(p), 0);
  }
  head_points.emplace_back(0.0F);
  triangles = mesh.triangles;
  normals = mesh.normals;
  skin.reset(rtcNewScene(device.get()));
  rtcSetSceneFlags(skin.get(), RTC_SCENE_FLAG_ROBUST);  // no light through edges
  const RTCGeometry g = rtcNewGeometry(device.get(), RTC_GEOMETRY_TYPE_TRIANGLE);
  rtcSetSharedGeometryBuffer(g, RTC_BUFFER_TYPE_VERTEX, 0, RTC_FORMAT_FLOAT3, head_points.data(), 0, sizeof(glm::vec4),
                             mesh.vertices.size());
  rtcSetSharedGeometryBuffer(g, RTC_BUFFER_TYPE_INDEX, 0, RTC_FORMAT_UINT3, triangles.data(), 0, sizeof(glm::uvec3),
                             triangles.size());
  rtcCommitGeometry(g);
  rtcAttachGeometry(skin.get(), g);
  rtcReleaseGeometry(g);
  rtcCommitScene(skin.get());
  check_embree(device.get());
}

namespace {

/// A segment that a ray met.
struct Met {
  std::uint32_t segment;
  Pass pass;
};

/// What Embree hands to the filters below.
template <class State>
struct Query {
  RTCIntersectContext context;  // first: Embree gives its address back
  const State* state;
  const FibreRay* ray;
  std::uint32_t skip_first, skip_last;  // segments, none when first > last
  int count, enough;
  std::vector<Met>* met;
};

template <class State>
bool skipped(const Query<State>& q, std::uint32_t segment) noexcept {
  return segment >= q.skip_first && segment <= q.skip_last;
}

template <class State>
Query<State>& query_of(const RTCFilterFunctionNArguments* args) noexcept {
  return *reinterpret_cast<Query<State>*>(args->context);
}

/// Counts a run at its first segment.
template <class State>
void count_candidate(const RTCFilterFunctionNArguments* args) noexcept {
  Query<State>& q = query_of<State>(args);
  const std::uint32_t i = RTCHitN_primID(args->hit, 1, 0);
  args->valid[0] = 0;  // go on
  if (skipped(q, i)) return;
  const Pass pass = pass_by(*q.ray, q.state->segment(i));
  if (!pass.hit) return;
  if (q.state->follows(i) && !skipped(q, i - 1)) {
    const Pass before = pass_by(*q.ray, q.state->segment(i - 1));
    if (before.hit && together(pass, before)) return;
  }
  if (++q.count >= q.enough) args->valid[0] = -1;  // ends the ray
}

template <class State>
void collect_candidate(const RTCFilterFunctionNArguments* args) noexcept {
  Query<State>& q = query_of<State>(args);
  const std::uint32_t i = RTCHitN_primID(args->hit, 1, 0);
  args->valid[0] = 0;
  const Pass pass = pass_by(*q.ray, q.state->segment(i));
  if (pass.hit) q.met->push_back({i, pass});
}

template <class State>
void trace(Query<State>& q, RTCFilterFunctionN filter) noexcept {
  const double back_off = kBackOff_radii * (kWiden * q.state->greatest_radius + q.state->least_widening);
  const Span span = inside(q.state->box, *q.ray);
  if (!(span.first <= span.last)) return;
  RTCRay ray = embree_ray(*q.ray, span.first - back_off, span.last + back_off);
  rtcInitIntersectContext(&q.context);
  q.context.filter = filter;
  rtcOccluded1(q.state->hair.get(), &q.context, &ray);
}

}  // namespace

FibreScene::FibreScene(const Strands& strands, float opacity, const Mesh* head) : state_(std::make_unique<State>()) {
  PELAGE_ASSERT(opacity >= 0 && opacity <= 1);
  State& s = *state_;
  s.device = embree_device();
  s.take(strands);
  s.widen();
  s.build_hair();
  if (head && !head->triangles.empty()) s.build_head(*head);
  const double through = 1.0 - static_cast<double>(opacity);
  s.powers[0] = 1;
  for (std::size_t n = 1; n < s.powers.size(); ++n) s.powers[n] = through * s.powers[n - 1];
}
FibreScene::~FibreScene() = default;
FibreScene::FibreScene(FibreScene&&) noexcept = default;
FibreScene& FibreScene::operator=(FibreScene&&) noexcept = default;

int FibreScene::count(const FibreRay& ray, std::uint32_t owner, int enough) const noexcept {
  const State& s = *state_;
  Query<State> q{{}, &s, &ray, 1, 0, 0, enough, nullptr};
  const std::uint32_t own = owner < s.segment_of.size() ? s.segment_of[owner] : kNoPrimitive;
  if (own != kNoPrimitive) {
    q.skip_first = s.follows(own) ? own - 1 : own;
    q.skip_last = s.goes_on(own) ? own + 1 : own;
  }
  trace(q, count_candidate<State>);
  return q.count;
}

void FibreScene::collect(const FibreRay& ray, std::vector<FibreCrossing>& out) const {
  const State& s = *state_;
  std::vector<Met> met;
  Query<State> q{{}, &s, &ray, 1, 0, 0, 0, &met};
  trace(q, collect_candidate<State>);
  std::sort(met.begin(), met.end(), [](const Met& a, const Met& b) { return a.segment < b.segment; });
  const auto off_axis = [](const Met& m) { return glm::dot(m.pass.offset_m, m.pass.offset_m); };
  out.clear();
  for (std::size_t i = 0; i < met.size();) {
    std::size_t best = i, end = i + 1;
    for (; end < met.size() && met[end].segment == met[end - 1].segment + 1 && s.follows(met[end].segment) &&
           together(met[end].pass, met[end - 1].pass);
         ++end) {
      if (off_axis(met[end]) < off_axis(met[best])) best = end;
    }
    const Segment segment = s.segment(met[best].segment);
    const Pass& pass = met[best].pass;
    out.push_back({pass.depth_m, s.vertex_of[met[best].segment], static_cast<float>(pass.along),
                   glm::vec3(pass.offset_m / pass.radius_m), glm::vec3(glm::normalize(segment.b - segment.a))});
    i = end;
  }
  std::sort(out.begin(), out.end(), [](const FibreCrossing& a, const FibreCrossing& b) {
    return a.depth_m != b.depth_m ? a.depth_m < b.depth_m : a.vertex < b.vertex;
  });
}

std::optional<HeadHit> FibreScene::head(const FibreRay& ray) const noexcept {
  const State& s = *state_;
  if (!s.skin) return std::nullopt;
  const Span span = inside(s.head_box, ray);
  if (!(span.first <= span.last)) return std::nullopt;
  const double slack = kRounding * glm::length(s.head_box.high - s.head_box.low);
  const double first = span.first > slack ? span.first - slack : 0;
  RTCRayHit hit{embree_ray(ray, first, std::min(span.last + slack, ray.length_m)), {}};
  hit.hit.geomID = RTC_INVALID_GEOMETRY_ID;
  RTCIntersectContext context;
  rtcInitIntersectContext(&context);
  rtcIntersect1(s.skin.get(), &context, &hit);
  if (hit.hit.geomID == RTC_INVALID_GEOMETRY_ID) return std::nullopt;
  const glm::uvec3 t = s.triangles[hit.hit.primID];
  const float u = hit.hit.u, v = hit.hit.v;
  const glm::vec3 normal = (1.0F - u - v) * s.normals[t.x] + u * s.normals[t.y] + v * s.normals[t.z];
  return HeadHit{first + static_cast<double>(hit.ray.tfar), glm::normalize(normal)};
}

double FibreScene::transmittance(int crossings) const noexcept {
  const auto n = static_cast<std::size_t>(crossings);
  const auto& p = state_->powers;
  return n < p.size() ? p[n] : std::pow(p[1], crossings);
}

int FibreScene::enough(float stop_below) const noexcept {
  const auto& p = state_->powers;
  const double bound = static_cast<double>(stop_below);
  const auto it = std::find_if(p.begin(), p.end(), [&](double t) { return t < bound || t == 0; });
  return it == p.end() ? std::numeric_limits<int>::max() : static_cast<int>(it - p.begin());
}

std::size_t FibreScene::segments() const noexcept {
  return state_->first.size();
}
bool FibreScene::has_head() const noexcept {
  return state_->skin != nullptr;
}
glm::vec3 FibreScene::low() const noexcept {
  return glm::vec3(state_->box.low);
}
glm::vec3 FibreScene::high() const noexcept {
  return glm::vec3(state_->box.high);
}

}  // namespace pelage
