#include "pelage/reference/fibre_scene.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <glm/geometric.hpp>
#include <glm/vec4.hpp>

#include "pelage/data_schema/errors.h"
#include "pelage/reference/embree_scene.h"
#include "pelage/reference/fibre_curves.h"

namespace pelage {
namespace {

/// Rounding of a head's triangles, in sizes of the head.
constexpr double kRounding = 1e-6;
/// Embree drops hits within 2 radii of a ray's origin: it starts this many radii earlier.
constexpr double kBackOff_radii = 4;

/// The part of a ray inside a box; empty: first > last.
struct Span {
  double first, last;
};
Span inside(const FibreBox& box, const FibreRay& ray) noexcept {
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

  FibreCurves curves;
  std::array<double, 4096> powers{};   // (1 - a)^n
  std::vector<glm::vec4> head_points;  // one more than the head has
  std::vector<glm::uvec3> triangles;
  std::vector<glm::vec3> normals;
  FibreBox head_box;

  explicit State(const Strands& strands) : curves(strands) {}
  void build_hair();
  void build_head(const Mesh& mesh);
};

void FibreScene::State::build_hair() {
  hair.reset(rtcNewScene(device.get()));
  rtcSetSceneBuildQuality(hair.get(), RTC_BUILD_QUALITY_HIGH);
  rtcSetSceneFlags(hair.get(), RTC_SCENE_FLAG_CONTEXT_FILTER_FUNCTION);
  if (!curves.first.empty()) {
    const RTCGeometry g = rtcNewGeometry(device.get(), RTC_GEOMETRY_TYPE_FLAT_LINEAR_CURVE);
    rtcSetSharedGeometryBuffer(g, RTC_BUFFER_TYPE_VERTEX, 0, RTC_FORMAT_FLOAT4, curves.points.data(), 0,
                               sizeof(glm::vec4), curves.points.size() - 1);
    rtcSetSharedGeometryBuffer(g, RTC_BUFFER_TYPE_INDEX, 0, RTC_FORMAT_UINT, curves.first.data(), 0,
                               sizeof(std::uint32_t), curves.first.size());
    rtcCommitGeometry(g);
    rtcAttachGeometry(hair.get(), g);
    rtcReleaseGeometry(g);
  }
  rtcCommitScene(hair.get());
  check_embree(device.get());
}

void FibreScene::State::build_head(const Mesh& mesh) {
  PELAGE_ASSERT(mesh.normals.size() == mesh.vertices.size());
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

/// The strand's tangent at a share `along` of segment i.
glm::vec3 tangent_at(const FibreCurves& curves, std::uint32_t i, double along) {
  const auto direction = [&](std::uint32_t k) {
    const Segment s = curves.segment(k);
    return glm::normalize(s.b - s.a);
  };
  const glm::dvec3 own = direction(i);
  const auto half_way = [&](const glm::dvec3& other) {
    const glm::dvec3 sum = own + other;
    return glm::dot(sum, sum) < 1e-8 ? own : glm::normalize(sum);  // a turn back on itself has no half-way
  };
  const glm::dvec3 at_a = curves.follows(i) ? half_way(direction(i - 1)) : own;
  const glm::dvec3 at_b = curves.goes_on(i) ? half_way(direction(i + 1)) : own;
  const glm::dvec3 between = (1 - along) * at_a + along * at_b;
  return glm::vec3(glm::dot(between, between) < 1e-8 ? own : glm::normalize(between));
}

/// What Embree hands to the filters below.
struct Query {
  RTCIntersectContext context;  // first: Embree gives its address back
  const FibreCurves* curves;
  const FibreRay* ray;
  OwnSegments own;
  int count, enough;
  std::vector<Met>* met;
};

/// Counts a run at its first segment.
void count_candidate(const RTCFilterFunctionNArguments* args) noexcept {
  Query& q = *reinterpret_cast<Query*>(args->context);
  const std::uint32_t i = RTCHitN_primID(args->hit, 1, 0);
  args->valid[0] = 0;  // go on
  if (q.own.has(i)) return;
  const Segment segment = q.curves->segment(i);
  const Pass pass = pass_by(*q.ray, segment);
  if (!pass.hit) return;
  if (segment.joint_a && !q.own.has(i - 1)) {
    const Pass before = pass_by(*q.ray, q.curves->segment(i - 1));
    if (before.hit && together(pass, before)) return;
  }
  if (++q.count >= q.enough) args->valid[0] = -1;  // ends the ray
}

void collect_candidate(const RTCFilterFunctionNArguments* args) noexcept {
  Query& q = *reinterpret_cast<Query*>(args->context);
  const std::uint32_t i = RTCHitN_primID(args->hit, 1, 0);
  args->valid[0] = 0;
  const Pass pass = pass_by(*q.ray, q.curves->segment(i));
  if (pass.hit) q.met->push_back({i, pass});
}

void trace(Query& q, RTCScene hair, RTCFilterFunctionN filter) noexcept {
  const double back_off = kBackOff_radii * q.curves->greatest_widened();
  const Span span = inside(q.curves->box, *q.ray);
  if (!(span.first <= span.last)) return;
  RTCRay ray = embree_ray(*q.ray, span.first - back_off, span.last + back_off);
  rtcInitIntersectContext(&q.context);
  q.context.filter = filter;
  rtcOccluded1(hair, &q.context, &ray);
}

}  // namespace

FibreScene::FibreScene(const Strands& strands, float opacity, const Mesh* head)
    : state_(std::make_unique<State>(strands)) {
  PELAGE_ASSERT(opacity >= 0 && opacity <= 1);
  State& s = *state_;
  s.device = embree_device();
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
  const FibreCurves& curves = state_->curves;
  Query q{{}, &curves, &ray, curves.owned_by(owner), 0, enough, nullptr};
  trace(q, state_->hair.get(), count_candidate);
  return q.count;
}

void FibreScene::collect(const FibreRay& ray, std::vector<FibreCrossing>& out) const {
  const FibreCurves& curves = state_->curves;
  std::vector<Met> met;
  Query q{{}, &curves, &ray, {}, 0, 0, &met};
  trace(q, state_->hair.get(), collect_candidate);
  std::sort(met.begin(), met.end(), [](const Met& a, const Met& b) { return a.segment < b.segment; });
  const auto off_axis = [](const Met& m) { return glm::dot(m.pass.offset_m, m.pass.offset_m); };
  out.clear();
  for (std::size_t i = 0; i < met.size();) {
    std::size_t best = i, end = i + 1;
    for (; end < met.size() && met[end].segment == met[end - 1].segment + 1 && curves.follows(met[end].segment) &&
           together(met[end].pass, met[end - 1].pass);
         ++end) {
      if (off_axis(met[end]) < off_axis(met[best])) best = end;
    }
    const auto& [segment, pass] = met[best];
    out.push_back({pass.depth_m, curves.vertex_of[segment], static_cast<float>(pass.along),
                   glm::vec3(pass.offset_m / pass.radius_m), tangent_at(curves, segment, pass.along)});
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
  return state_->curves.first.size();
}
const FibreCurves& FibreScene::curves() const noexcept {
  return state_->curves;
}
bool FibreScene::has_head() const noexcept {
  return state_->skin != nullptr;
}
glm::vec3 FibreScene::low() const noexcept {
  return glm::vec3(state_->curves.box.low);
}
glm::vec3 FibreScene::high() const noexcept {
  return glm::vec3(state_->curves.box.high);
}

}  // namespace pelage
