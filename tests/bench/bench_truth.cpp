// Shadow rays of the truth: rays/s of FibreScene::count as a ratio to raw Embree on the same rays, the early stop, and
// footprint-averaged transmittance. Raw: rtcOccluded1 over the same segments (flat linear curves, true width) with a
// filter that only counts: it counts joints twice and drops hits near the origin, so its answer is not the truth.
// Hair: wavy strands in an ellipsoid shell, 25 cm long and as thick as DESIGN section 3 says. dense: 8 cm short and
// 400 um thick. One thread (CPU time) but for truth/two_threads.
#include <benchmark/benchmark.h>
#include <embree3/rtcore.h>
#include <tbb/global_control.h>

#include <cmath>
#include <glm/geometric.hpp>
#include <glm/vec4.hpp>
#include <map>
#include <numbers>
#include <random>
#include <utility>

#include "pelage/reference/truth_transmittance.h"

namespace pelage {
namespace {

constexpr float kOpacity = 0.6F;
/// Below half of what one step of 8 bits shows.
constexpr float kStop = 1.0F / 510.0F;
constexpr int kPerStrand = 24, kRaysPerPoint = 64, kPoints = 500;
const glm::vec3 kToLight(0.4F, 0.7F, 0.6F);

/// Strands that leave an ellipsoid of half axes (.07, .1, .08) m, fall and wave.
Strands wavy_hair(std::size_t strands, double length_m, float diameter_m) {
  std::mt19937 engine(1);
  const auto random = [&] { return static_cast<double>(engine()) * 0x1p-32; };
  Strands s;
  for (std::size_t i = 0; i < strands; ++i) {
    const double z = 1.6 * random() - 0.6, around = 2 * std::numbers::pi * random(), phase = 6 * random();
    const glm::dvec3 out(std::sqrt(1 - z * z) * std::cos(around), z, std::sqrt(1 - z * z) * std::sin(around));
    glm::dvec3 at = out * glm::dvec3(0.07, 0.1, 0.08);
    const double step = length_m * (0.6 + 0.4 * random()) / kPerStrand;
    std::vector<glm::vec3> points{glm::vec3(at)};
    for (int k = 1; k <= kPerStrand; ++k) {
      const double t = static_cast<double>(k) / kPerStrand;
      const glm::dvec3 wave(std::sin(12 * t + phase), 0, std::cos(12 * t + phase));
      at += step * glm::normalize((1 - t) * out + 1.5 * t * glm::dvec3(0, -1, 0) + 0.4 * wave);
      points.emplace_back(at);
    }
    s.append(points);
  }
  s.diameter_m = diameter_m;
  return s;
}

/// 25 cm long and as thick as DESIGN section 3 says; 8 cm short and 400 um thick.
enum class Kind { hair, dense };

struct Hair {
  Strands strands;
  FibreScene scene;
  std::vector<TruthPoint> points;
  std::vector<FibreRay> rays;  // [points][kRaysPerPoint] parallel, in a disc of 2 mm

  Hair(std::size_t segments, Kind kind)
      : strands(kind == Kind::dense
                    ? wavy_hair(segments / kPerStrand, 0.08, 4e-4F)
                    : wavy_hair(segments / kPerStrand, 0.25, default_diameter_m(segments / kPerStrand))),
        scene(strands, kOpacity) {
    std::mt19937 engine(2);
    const auto random = [&] { return static_cast<double>(engine()) * 0x1p-31 - 1; };
    const glm::dvec3 d = glm::normalize(glm::dvec3(kToLight)), x = glm::normalize(glm::cross(d, glm::dvec3(1, 0, 0)));
    const glm::dvec3 y = glm::cross(d, x);
    for (int i = 0; i < kPoints; ++i) {
      const auto vertex = static_cast<std::uint32_t>(engine() % strands.vertices.size());
      points.push_back({strands.vertices[vertex], vertex});
      for (int k = 0; k < kRaysPerPoint; ++k) {
        const glm::dvec3 jitter = 0.002 * (random() * x + random() * y);
        rays.push_back({glm::dvec3(strands.vertices[vertex]) + jitter, d});
      }
    }
  }
};

const Hair& hair(std::int64_t segments, Kind kind) {
  static std::map<std::pair<std::int64_t, Kind>, Hair> all;
  const auto key = std::pair(segments, kind);
  const auto it = all.find(key);
  return it != all.end() ? it->second : all.emplace(key, Hair(static_cast<std::size_t>(segments), kind)).first->second;
}

struct RawContext {
  RTCIntersectContext context;
  std::int64_t hits;
};
void count_hit(const RTCFilterFunctionNArguments* args) {
  ++reinterpret_cast<RawContext*>(args->context)->hits;
  args->valid[0] = 0;
}

class RawScene {
 public:
  explicit RawScene(const Strands& s) : device_(rtcNewDevice(nullptr)), scene_(rtcNewScene(device_)) {
    for (const glm::vec3& p : s.vertices) points_.emplace_back(p, 0.5F * s.diameter_m);
    points_.emplace_back(0.0F);
    for (std::size_t i = 0; i < s.count(); ++i) {
      for (std::uint32_t k = s.offsets[i]; k + 1 < s.offsets[i + 1]; ++k) first_.push_back(k);
    }
    const RTCGeometry g = rtcNewGeometry(device_, RTC_GEOMETRY_TYPE_FLAT_LINEAR_CURVE);
    rtcSetSharedGeometryBuffer(g, RTC_BUFFER_TYPE_VERTEX, 0, RTC_FORMAT_FLOAT4, points_.data(), 0, sizeof(glm::vec4),
                               points_.size() - 1);
    rtcSetSharedGeometryBuffer(g, RTC_BUFFER_TYPE_INDEX, 0, RTC_FORMAT_UINT, first_.data(), 0, sizeof(std::uint32_t),
                               first_.size());
    rtcCommitGeometry(g);
    rtcAttachGeometry(scene_, g);
    rtcReleaseGeometry(g);
    rtcSetSceneBuildQuality(scene_, RTC_BUILD_QUALITY_HIGH);
    rtcSetSceneFlags(scene_, RTC_SCENE_FLAG_CONTEXT_FILTER_FUNCTION);
    rtcCommitScene(scene_);
  }
  ~RawScene() {
    rtcReleaseScene(scene_);
    rtcReleaseDevice(device_);
  }
  RawScene(const RawScene&) = delete;
  RawScene& operator=(const RawScene&) = delete;

  std::int64_t hits(const FibreRay& ray) const {
    RTCRay r{};
    r.org_x = static_cast<float>(ray.origin.x);
    r.org_y = static_cast<float>(ray.origin.y);
    r.org_z = static_cast<float>(ray.origin.z);
    r.dir_x = static_cast<float>(ray.direction.x);
    r.dir_y = static_cast<float>(ray.direction.y);
    r.dir_z = static_cast<float>(ray.direction.z);
    r.tfar = std::numeric_limits<float>::infinity();
    r.mask = 0xffffffffU;
    RawContext context{{}, 0};
    rtcInitIntersectContext(&context.context);
    context.context.filter = count_hit;
    rtcOccluded1(scene_, &context.context, &r);
    return context.hits;
  }

 private:
  RTCDevice device_;
  RTCScene scene_;
  std::vector<glm::vec4> points_;
  std::vector<std::uint32_t> first_;
};

void raw(benchmark::State& state, Kind kind) {
  const Hair& h = hair(state.range(0), kind);
  const RawScene scene(h.strands);
  std::int64_t hits = 0, rays = 0;
  for (auto _ : state) {
    for (const FibreRay& ray : h.rays) hits += scene.hits(ray);
    rays += static_cast<std::int64_t>(h.rays.size());
  }
  state.SetItemsProcessed(rays);
  state.counters["hits/ray"] = static_cast<double>(hits) / static_cast<double>(rays);
}

void count(benchmark::State& state, Kind kind, float stop_below) {
  const Hair& h = hair(state.range(0), kind);
  const int enough = h.scene.enough(stop_below);
  std::int64_t hits = 0, rays = 0;
  for (auto _ : state) {
    for (const FibreRay& ray : h.rays) hits += h.scene.count(ray, kNoOwner, enough);
    rays += static_cast<std::int64_t>(h.rays.size());
  }
  state.SetItemsProcessed(rays);
  state.counters["hits/ray"] = static_cast<double>(hits) / static_cast<double>(rays);
}

void truth(benchmark::State& state, std::size_t threads) {
  const Hair& h = hair(state.range(0), Kind::hair);
  const tbb::global_control limit(tbb::global_control::max_allowed_parallelism, threads);
  Light light;
  light.direction = kToLight;
  TruthSettings settings;
  settings.rays = 8192;
  double t = 0, error = 0;
  for (auto _ : state) {
    for (const TruthEstimate& e : truth_transmittance(h.scene, h.points, light, settings, 1)) {
      t += e.mean, error += e.standard_error;
    }
  }
  state.SetItemsProcessed(state.iterations() * kPoints * settings.rays);
  const double points = static_cast<double>(state.iterations()) * kPoints;
  state.counters["T"] = t / points;
  state.counters["error"] = error / points;
}

void build(benchmark::State& state) {
  const Hair& h = hair(state.range(0), Kind::hair);
  for (auto _ : state) {
    const FibreScene scene(h.strands, kOpacity);
    benchmark::DoNotOptimize(scene.segments());
  }
}

/// Dense hair gets denser with its count: 1.2, 13 and 50 crossings a ray.
void densities(benchmark::internal::Benchmark* b) {
  b->Arg(100'000)->Arg(1'100'000)->Arg(4'400'000)->Unit(benchmark::kMillisecond);
}
void sizes(benchmark::internal::Benchmark* b) {
  b->Arg(100'000)->Arg(1'100'000)->Unit(benchmark::kMillisecond);
}
BENCHMARK_CAPTURE(raw, hair, Kind::hair)->Apply(sizes);
BENCHMARK_CAPTURE(count, hair, Kind::hair, 0.0F)->Apply(sizes);
BENCHMARK_CAPTURE(count, hair_stop, Kind::hair, kStop)->Apply(sizes);
BENCHMARK_CAPTURE(raw, dense, Kind::dense)->Apply(densities);
BENCHMARK_CAPTURE(count, dense, Kind::dense, 0.0F)->Apply(densities);
BENCHMARK_CAPTURE(count, dense_stop, Kind::dense, kStop)->Apply(densities);
BENCHMARK_CAPTURE(truth, one_thread, 1)->Apply(sizes)->Iterations(1)->UseRealTime();
BENCHMARK_CAPTURE(truth, two_threads, 2)->Apply(sizes)->Iterations(1)->UseRealTime();
BENCHMARK(build)->Apply(sizes)->Iterations(1)->UseRealTime();

}  // namespace
}  // namespace pelage

BENCHMARK_MAIN();
