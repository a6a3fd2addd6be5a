#include "pelage/reference/truth_image.h"

#include <tbb/blocked_range.h>
#include <tbb/parallel_for.h>

#include <algorithm>
#include <cmath>
#include <glm/geometric.hpp>
#include <glm/trigonometric.hpp>
#include <glm/vec4.hpp>

#include "pelage/data_schema/errors.h"
#include "pelage/data_schema/lighting.h"
#include "pelage/data_schema/strand_tint.h"
#include "pelage/reference/azimuth.h"
#include "pelage/reference/light_ray.h"
#include "pelage/reference/progress_counter.h"
#include "pelage/reference/sampling.h"
#include "pelage/shading/head_lighting.h"
#include "pelage/shading/light.h"

namespace pelage {
namespace {

constexpr int kTile = 16;  // pixels

/// Numbers of a pixel that are drawn apart; kLightDisc + i are those of the i-th light.
enum Stream : std::uint32_t { kSquare, kTailChoice, kLightDisc };

/// One of a pixel's rays.
struct Sample {
  std::uint32_t x, y, index;
};

/// The materials of strands that have colours of their own, or vary.
class Materials {
 public:
  Materials(const HairMaterial& material, const Strands& strands) : one_(material), strands_(strands) {}
  HairMaterial of(std::uint32_t vertex) const {
    HairMaterial m = one_;
    if (strands_.colours.empty() && m.variation == 0) return m;
    const auto& o = strands_.offsets;
    const auto strand = static_cast<std::size_t>(std::upper_bound(o.begin(), o.end(), vertex) - o.begin() - 1);
    if (!strands_.colours.empty()) m.diffuse_colour = m.secondary_colour = strands_.colours[strand];
    const glm::vec3 tint = strand_tint(static_cast<std::uint32_t>(strand), m.variation);
    m.diffuse_colour *= tint;
    m.secondary_colour *= tint;
    return m;
  }

 private:
  const HairMaterial& one_;
  const Strands& strands_;
};

class PixelTracer {
 public:
  PixelTracer(const FibreScene& scene, const Strands& strands, const TruthRequest& request)
      : scene_(scene),
        request_(request),
        camera_(request.camera, request.width, request.height),
        materials_(request.material, strands),
        azimuth_(request.phong),
        ambient_(static_cast<double>(request.material.ambient)),
        opacity_(1 - scene.transmittance(1)),
        enough_(scene.enough(request.settings.stop_below)) {
    for (const Light& light : request.lights) check_light(light);
  }

  glm::dvec4 trace(int x, int y, std::vector<FibreCrossing>& crossings) const {
    const auto px = static_cast<std::uint32_t>(x), py = static_cast<std::uint32_t>(y);
    const auto digits = random_bits(request_.seed, px, py, 0, kSquare);
    const SquareSequence square(digits[0], digits[1]);
    const auto samples = static_cast<std::uint32_t>(std::max(request_.settings.samples, 1));
    glm::dvec4 sum(0);
    for (std::uint32_t i = 0; i < samples; ++i) {
      const glm::dvec2 at = glm::dvec2(x, y) + square.point(i);
      sum += along(camera_.ray(at.x, at.y), {px, py, i}, crossings);
    }
    return sum / static_cast<double>(samples);
  }

 private:
  /// What a ray sees.
  glm::dvec4 along(FibreRay ray, const Sample& sample, std::vector<FibreCrossing>& crossings) const {
    const std::optional<HeadHit> head = scene_.head(ray);
    if (head) ray.length_m = head->depth_m;
    scene_.collect(ray, crossings);
    const auto count = static_cast<int>(crossings.size());
    const double through = scene_.transmittance(count);
    glm::dvec3 colour(0);
    int n = 0;
    for (; n < count && scene_.transmittance(n) >= kTail; ++n) {
      colour += opacity_ * scene_.transmittance(n) * shade(ray, crossings[static_cast<std::size_t>(n)]);
    }
    if (n < count) {
      const double choice = unit(random_bits(request_.seed, sample.x, sample.y, sample.index, kTailChoice)[0]);
      const double tail = scene_.transmittance(n) - through, chosen = scene_.transmittance(n) - choice * tail;
      int m = n;  // the crossing that takes T below `chosen`
      while (m + 1 < count && scene_.transmittance(m + 1) > chosen) ++m;
      if (tail > 0) colour += tail * shade(ray, crossings[static_cast<std::size_t>(m)]);
    }
    if (!head) return {colour, 1 - through};
    return {colour + through * shade(ray, *head, sample), 1.0};
  }

  /// T of the hair, and of the head where it casts shadows, from a point to a light.
  double lit(const Light& light, const glm::dvec3& at, std::uint32_t owner) const {
    const FibreRay ray = ray_to_light(light, at);
    if (request_.head_shadow == HeadShadow::casts && scene_.head(ray)) return 0;
    return scene_.transmittance(scene_.count(ray, owner, enough_));
  }

  glm::dvec3 shade(const FibreRay& ray, const FibreCrossing& c) const {
    const glm::dvec3 at = ray.origin + c.depth_m * ray.direction;
    const HairMaterial material = materials_.of(c.vertex);
    const glm::vec3 t = c.tangent, v = glm::vec3(-ray.direction), n = facing_normal(t, v);
    glm::dvec3 sum(0);
    for (const Light& light : request_.lights) {
      const Arriving arriving_here = arriving(light, glm::vec3(at));
      const glm::vec3 l = arriving_here.to_light;
      sum += ambient_ * glm::dvec3(material.diffuse_colour * arriving_here.irradiance);
      const glm::dvec3 lobes(hair_lighting(material, request_.lobes, t, n, l, v) * arriving_here.irradiance);
      if (lobes == glm::dvec3(0)) continue;
      const double around = request_.settings.azimuth
                                ? azimuth_(glm::dvec3(t), -ray.direction, glm::dvec3(l), glm::dvec3(c.offset))
                                : 1.0;
      if (around > 0) sum += lit(light, at, c.vertex) * around * lobes;
    }
    return sum;
  }

  /// The light, or a place of its disc at random.
  Light seen(std::size_t light, const Sample& s) const {
    const Light& whole = request_.lights[light];
    if (!has_size(whole)) return whole;
    const auto stream = static_cast<std::uint32_t>(kLightDisc + light);
    const auto digits = random_bits(request_.seed, s.x, s.y, 0, stream);
    return part_of(whole, in_disk(SquareSequence(digits[0], digits[1]).point(s.index)));
  }

  glm::dvec3 shade(const FibreRay& ray, const HeadHit& head, const Sample& sample) const {
    const glm::dvec3 at = ray.origin + (1 - 1e-5) * head.depth_m * ray.direction;
    glm::dvec3 sum(0);
    for (std::size_t i = 0; i < request_.lights.size(); ++i) {
      const Arriving arriving_here = arriving(request_.lights[i], glm::vec3(at));
      double direct = static_cast<double>(head_direct(head.normal, arriving_here.to_light));
      if (direct > 0) direct *= lit(seen(i, sample), at, kNoOwner);
      sum += (direct + static_cast<double>(head_ambient(head.normal))) * glm::dvec3(arriving_here.irradiance);
    }
    return glm::dvec3(kHeadColour) * sum;
  }

  const FibreScene& scene_;
  const TruthRequest& request_;
  TruthCamera camera_;
  Materials materials_;
  AzimuthTerm azimuth_;
  double ambient_, opacity_;
  int enough_;
};

}  // namespace

TruthCamera::TruthCamera(const Camera& camera, int width, int height)
    : eye_(camera.eye), half_width_(0.5 * width), half_height_(0.5 * height) {
  const glm::dvec3 way = glm::dvec3(camera.target) - eye_, up(camera.up);
  const double length = glm::length(way);
  if (!(length > 0 && std::isfinite(length))) {
    throw UsageError("camera: eye and target are the same point; give two different ones");
  }
  forward_ = way / length;
  const bool parallel = glm::length(glm::cross(forward_, up)) < 1e-4 * glm::length(up);
  const glm::dvec3 above = parallel ? glm::dvec3(0, 0, forward_.y > 0 ? -1 : 1) : up;
  const glm::dvec3 right = glm::normalize(glm::cross(forward_, above));
  const double pixel = std::tan(glm::radians(0.5 * static_cast<double>(camera.fov_deg))) / half_height_;
  right_ = pixel * right;
  down_ = pixel * glm::cross(forward_, right);
}

FibreRay TruthCamera::ray(double x, double y) const noexcept {
  return {eye_, glm::normalize(forward_ + (x - half_width_) * right_ + (y - half_height_) * down_)};
}

std::vector<float> truth_image(const FibreScene& scene, const Strands& strands, const TruthRequest& request,
                               const std::function<void(std::uint64_t done, std::uint64_t total)>& progress) {
  const PixelTracer tracer(scene, strands, request);
  const int w = request.width, h = request.height, across = (w + kTile - 1) / kTile, down = (h + kTile - 1) / kTile;
  std::vector<float> rgba(4U * static_cast<std::size_t>(w) * static_cast<std::size_t>(h));
  ProgressCounter counter(progress, static_cast<std::uint64_t>(w) * static_cast<std::uint64_t>(h));
  tbb::parallel_for(tbb::blocked_range<int>(0, across * down, 1), [&](const auto& range) {
    std::vector<FibreCrossing> crossings;
    for (int tile = range.begin(); tile != range.end(); ++tile) {
      const int x0 = tile % across * kTile, y0 = tile / across * kTile;
      const int x1 = std::min(x0 + kTile, w), y1 = std::min(y0 + kTile, h);
      for (int y = y0; y < y1; ++y) {
        for (int x = x0; x < x1; ++x) {
          const glm::dvec4 pixel = tracer.trace(x, y, crossings);
          const auto first =
              4 * (static_cast<std::size_t>(y) * static_cast<std::size_t>(w) + static_cast<std::size_t>(x));
          for (int k = 0; k < 4; ++k) rgba[first + static_cast<std::size_t>(k)] = static_cast<float>(pixel[k]);
        }
      }
      counter.add(static_cast<std::uint64_t>(x1 - x0) * static_cast<std::uint64_t>(y1 - y0));
    }
  });
  return rgba;
}

std::vector<float> truth_pixels(const FibreScene& scene, const Strands& strands, const TruthRequest& request,
                                std::span<const glm::ivec2> pixels) {
  const PixelTracer tracer(scene, strands, request);
  std::vector<float> rgba(4 * pixels.size());
  tbb::parallel_for(tbb::blocked_range<std::size_t>(0, pixels.size(), 16), [&](const auto& range) {
    std::vector<FibreCrossing> crossings;
    for (std::size_t i = range.begin(); i != range.end(); ++i) {
      const glm::dvec4 pixel = tracer.trace(pixels[i].x, pixels[i].y, crossings);
      for (int k = 0; k < 4; ++k) rgba[4 * i + static_cast<std::size_t>(k)] = static_cast<float>(pixel[k]);
    }
  });
  return rgba;
}

}  // namespace pelage
