#include "pelage/shadow/opacity_maps.h"

#include <tbb/blocked_range.h>
#include <tbb/parallel_for.h>

#include <algorithm>
#include <chrono>
#include <cmath>
#include <limits>

#include "pelage/data_schema/errors.h"
#include "pelage/data_schema/numeric.h"
#include "pelage/shadow/hair_pieces.h"

namespace pelage {
namespace {

constexpr int kMargin = 2;  // pixels that stay empty around the hair
using Clock = std::chrono::steady_clock;

struct Picture {
  LightMapping mapping;  // x in metres from the first hair
  Box box;
  glm::ivec2 pixels;
};

Picture picture_of(const Strands& strands, float opacity, const Light& light, int resolution) {
  check_hair(strands, opacity);
  if (light.position) {
    throw InputError("light", "opacity maps take directional lights; give a direction, or use the density map");
  }
  Picture p;
  p.mapping.axes = light_axes(light.direction);
  if (!strands.vertices.empty()) p.mapping.centre = strands.vertices[0];
  p.box = box_along(p.mapping.axes, p.mapping.centre, strands.vertices);
  const glm::vec3 extent = p.box.extent();
  const float pixel_m = std::max({extent.y, extent.z, 1e-6F}) / static_cast<float>(std::clamp(resolution, 1, 4096));
  p.mapping.cells_per_unit = {1.0F, 1.0F / pixel_m, 1.0F / pixel_m};
  p.mapping.offset = -p.box.low * p.mapping.cells_per_unit + glm::vec3(0, kMargin, kMargin);
  p.pixels = glm::ivec2(static_cast<int>(extent.y / pixel_m), static_cast<int>(extent.z / pixel_m)) + 2 * kMargin + 1;
  return p;
}

}  // namespace

void OpacityShadowMap::build(const Strands& strands, float opacity, const Light& light) {
  const auto start = Clock::now();
  Picture picture = picture_of(strands, opacity, light, settings_.resolution);
  mapping_ = picture.mapping;
  const int slices = std::clamp(settings_.slices, 1, 1024);
  const float per_m = static_cast<float>(slices) / std::max(picture.box.extent().x, 1e-6F);
  mapping_.cells_per_unit.x = per_m;
  mapping_.offset.x = mapping_.offset.x * per_m + 1.0F;  // an empty slice before the hair
  grid_.reset({slices + 2, picture.pixels.x, picture.pixels.y}, 1);
  cut_hair(strands, mapping_, {true, true, opacity, 0, 1, {}}, 0, strands.vertices.size(),
           [&](PieceBlock& block) { grid_.add_nearest(block, 0); });
  times_.fill_ms = milliseconds_since(start);
  const auto filled = Clock::now();
  grid_.accumulate(DepthGrid::Values::planes, false);
  times_.transmittance_ms = milliseconds_since(filled);
}

void OpacityShadowMap::transmittance(std::span<const glm::vec3> points, std::span<float> out) const {
  CellBlock at{};
  for (std::size_t i = 0; i < points.size(); i += CellBlock::kSize) {
    const std::size_t n = std::min(CellBlock::kSize, points.size() - i);
    mapping_.cells(points.subspan(i, n), at);
    grid_.interpolate(at, n, out.subspan(i, n));
    for (std::size_t k = i; k < i + n; ++k) out[k] = exp_neg(out[k]) + not_finite(points[k]);
  }
}

std::size_t DeepOpacityMap::pixel(float y, float z) const noexcept {
  const auto bounded = [](float v, int n) {
    return static_cast<std::size_t>(std::min(std::max(v > 0 ? v : 0.0F, 0.0F), static_cast<float>(n - 1)));
  };
  return bounded(y, height_) * static_cast<std::size_t>(width_) + bounded(z, width_);
}

DeepOpacityMap::Place DeepOpacityMap::place(float behind_m) const noexcept {
  // Layer k ends at thinnest (k + 1)(k + 2) / 2.
  const auto last = static_cast<std::size_t>(std::clamp(settings_.layers, 1, 64)) - 1;
  const float in_first = std::max(behind_m, 0.0F) / thinnest_m_;
  const auto k = std::min(static_cast<std::size_t>(0.5F * (std::sqrt(1 + 8 * std::min(in_first, 1e6F)) - 1)), last);
  const auto kf = static_cast<float>(k);
  return {k, std::min((in_first - 0.5F * kf * (kf + 1)) / (kf + 1), 1.0F)};
}

void DeepOpacityMap::build(const Strands& strands, float opacity, const Light& light) {
  const auto start = Clock::now();
  const Picture picture = picture_of(strands, opacity, light, settings_.resolution);
  mapping_ = picture.mapping;
  height_ = picture.pixels.x, width_ = picture.pixels.y;
  const auto layers = static_cast<std::size_t>(std::clamp(settings_.layers, 1, 64));
  const auto count = static_cast<float>(layers);
  thinnest_m_ = std::max(picture.box.extent().x, 1e-6F) * 2 / (count * (count + 1));
  const std::size_t pixels = static_cast<std::size_t>(height_) * static_cast<std::size_t>(width_);
  first_.assign(pixels, std::numeric_limits<float>::infinity());
  depth_.assign(pixels * layers, 0.0F);
  const Cutting cutting{true, true, opacity, 0, 1, {}};
  // Two passes, as the GPU draws it: the depth of the first hair, then opacity behind it. One thread: sums of floats.
  cut_hair(strands, mapping_, cutting, 0, strands.vertices.size(), [&](PieceBlock& b) {
    for (std::size_t i = 0; i < b.count; ++i) {
      float& first = first_[pixel(b.y[i], b.z[i])];
      first = std::min(first, b.x[i]);
    }
  });
  cut_hair(strands, mapping_, cutting, 0, strands.vertices.size(), [&](PieceBlock& b) {
    for (std::size_t i = 0; i < b.count; ++i) {
      const std::size_t at = pixel(b.y[i], b.z[i]);
      depth_[at * layers + place(b.x[i] - first_[at]).layer] += b.depth[i];
    }
  });
  times_.fill_ms = milliseconds_since(start);
  const auto filled = Clock::now();
  for (std::size_t p = 0; p < pixels; ++p) {
    for (std::size_t k = 1; k < layers; ++k) depth_[p * layers + k] += depth_[p * layers + k - 1];
  }
  times_.transmittance_ms = milliseconds_since(filled);
}

float DeepOpacityMap::depth_at(std::size_t pixel, float x_m) const noexcept {
  if (!(x_m > first_[pixel])) return 0;
  const Place at = place(x_m - first_[pixel]);
  const float* const layer =
      depth_.data() + pixel * static_cast<std::size_t>(std::clamp(settings_.layers, 1, 64)) + at.layer;
  const float before = at.layer > 0 ? layer[-1] : 0.0F;
  return before + at.share * (*layer - before);
}

void DeepOpacityMap::transmittance(std::span<const glm::vec3> points, std::span<float> out) const {
  tbb::parallel_for(tbb::blocked_range<std::size_t>(0, points.size(), 4096), [&](const auto& range) {
    for (std::size_t i = range.begin(); i != range.end(); ++i) {
      const glm::vec3 at = mapping_.cells(points[i]);
      const float y = std::min(std::max(at.y - 0.5F, 0.0F), static_cast<float>(height_ - 1)),
                  z = std::min(std::max(at.z - 0.5F, 0.0F), static_cast<float>(width_ - 1));
      const float y0 = std::floor(y), z0 = std::floor(z), fy = y - y0, fz = z - z0;
      const float near = depth_at(pixel(y0, z0), at.x) * (1 - fz) + depth_at(pixel(y0, z0 + 1), at.x) * fz;
      const float far = depth_at(pixel(y0 + 1, z0), at.x) * (1 - fz) + depth_at(pixel(y0 + 1, z0 + 1), at.x) * fz;
      out[i] = exp_neg(near + fy * (far - near)) + not_finite(points[i]);
    }
  });
}

}  // namespace pelage
