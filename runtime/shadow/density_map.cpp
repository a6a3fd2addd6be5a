#include "pelage/shadow/density_map.h"

#include <tbb/blocked_range.h>
#include <tbb/global_control.h>
#include <tbb/parallel_for.h>
#include <tbb/task_arena.h>

#include <algorithm>
#include <array>
#include <chrono>
#include <cmath>
#include <glm/geometric.hpp>
#include <limits>
#include <numbers>
#include <numeric>
#include <optional>
#include <string>

#include "pelage/data_schema/errors.h"
#include "pelage/data_schema/numeric.h"
#include "pelage/shadow/hair_pieces.h"

#define PELAGE_CLONES __attribute__((target_clones("avx512f", "avx2", "default")))

namespace pelage {
namespace {

constexpr int kMargin = 2;  // cells: one for the trilinear deposit on the border, one that stays empty
constexpr int kMostCells = 1024 + 2 * kMargin;
/// Cosine of the half angle within which one frustum serves a point light.
constexpr float kOneFrustum = 0.64F;
/// Mean sine of the angle between the light and a segment of no preferred direction; calibrates the paper's f.
constexpr float kMeanSine = std::numbers::pi_v<float> / 4;
constexpr std::size_t kMostCopies = 8;

int checked_cells(double cells) {
  const double all = std::ceil(cells) + 2 * kMargin;
  if (all <= kMostCells) return static_cast<int>(all);
  throw InputError("density map", "the hair is " + std::to_string(cells) + " cells long, at most " +
                                      std::to_string(kMostCells - 2 * kMargin) +
                                      " are held: choose a lower resolution or a larger extent");
}

glm::ivec3 checked_cells(glm::vec3 cells) {
  return {checked_cells(static_cast<double>(cells.x)), checked_cells(static_cast<double>(cells.y)),
          checked_cells(static_cast<double>(cells.z))};
}

float longest(glm::vec3 v) noexcept {
  return std::max({v.x, v.y, v.z});
}

PELAGE_CLONES void exponentiate(float* __restrict depth, std::size_t n) noexcept {
  for (std::size_t i = 0; i < n; ++i) depth[i] = exp_neg(depth[i]);
}

/// Where a point light's rays come from, if they are parallel: rays that leave the hair's sphere by a thousandth of it
/// are, and farther away a float has no digits left for the differences between them. No hair is far from any light.
std::optional<glm::vec3> parallel_from(glm::vec3 light, const Strands& strands) {
  if (!std::isfinite(light.x + light.y + light.z)) {
    throw InputError("light", "a point light's position is not finite; give it in metres");
  }
  if (strands.vertices.empty()) return glm::vec3(0, 1, 0);
  const Box box = box_along(glm::mat3(1.0F), glm::vec3(0.0F), strands.vertices);
  const glm::vec3 towards = light - box.middle();
  if (glm::length(towards) <= 1000.0F * glm::length(box.extent()) + 1.0F) return std::nullopt;
  return towards;
}

}  // namespace

void DensityMap::build(const Strands& strands, float opacity, const Light& light) {
  check_hair(strands, opacity);
  const auto start = std::chrono::steady_clock::now();
  const auto parallel = light.position ? parallel_from(*light.position, strands) : light.direction;
  if (parallel)
    map_parallel(strands, *parallel);
  else
    map_point(strands, *light.position);
  if (!settings_.area) calibrate(strands);
  for (Face& face : faces_) {
    if (settings_.adaptive_slices) slice_by_content(strands, face);
    fill(strands, opacity, face);
  }
  times_.fill_ms = milliseconds_since(start);
  const auto filled = std::chrono::steady_clock::now();
  for (Face& face : faces_) {
    face.grid.accumulate(settings_.centred_lookup ? DepthGrid::Values::centre : DepthGrid::Values::far_corner,
                         !settings_.interpolate_depth);
  }
  times_.transmittance_ms = milliseconds_since(filled);
}

void DensityMap::map_parallel(const Strands& strands, glm::vec3 to_light) {
  faces_.resize(1);
  LightMapping& m = faces_[0].mapping;
  m = {};
  m.axes = light_axes(to_light);
  if (!strands.vertices.empty()) m.centre = strands.vertices[0];
  const Box box = box_along(m.axes, m.centre, strands.vertices);
  const auto resolution = static_cast<float>(std::clamp(settings_.resolution, 1, 1024));
  const float extent = settings_.extent_m > 0 ? settings_.extent_m
                       : settings_.fitted     ? longest(box.extent())
                                              : (calibrate(strands), constant_extent_m_);
  const float cell = std::max(extent, 1e-6F) / resolution;
  m.cells_per_unit = glm::vec3(1.0F / cell);
  glm::vec3 low = box.low;  // of the grid, without margin, in metres from the centre
  if (!settings_.fitted) {
    // Cells are anchored at the world's origin: multiples of the cell size.
    for (int i = 0; i < 3; ++i) {
      const double from = glm::dot(glm::dvec3(m.axes[i]), glm::dvec3(m.centre)), ds = static_cast<double>(cell);
      low[i] = static_cast<float>(ds * std::floor((from + static_cast<double>(box.low[i])) / ds) - from);
    }
  }
  m.offset = -low / cell + static_cast<float>(kMargin);
  faces_[0].cells = checked_cells((box.high - low) / cell);
}

void DensityMap::map_point(const Strands& strands, glm::vec3 light) {
  const auto resolution = static_cast<float>(std::clamp(settings_.resolution, 1, 1024));
  const glm::mat3 world(1.0F);
  const Box around = box_along(world, light, strands.vertices);
  const glm::vec3 towards = around.middle();
  const float distance = glm::length(towards);
  bool one = distance > 0;
  for (const glm::vec3& p : strands.vertices) {
    if (!one) break;
    one = glm::dot(p - light, towards) > kOneFrustum * distance * glm::length(p - light);
  }
  std::vector<glm::mat3> axes;
  if (one) {
    axes.push_back(light_axes(-towards));
  } else {
    for (const glm::vec3 x : {glm::vec3(1, 0, 0), glm::vec3(0, 1, 0), glm::vec3(0, 0, 1)}) {
      axes.push_back(light_axes(-x));
      axes.push_back(light_axes(x));
    }
  }
  faces_.resize(axes.size());
  for (std::size_t i = 0; i < axes.size(); ++i) {
    faces_[i].mapping = {};
    faces_[i].mapping.axes = axes[i];
    faces_[i].mapping.centre = light;
    faces_[i].mapping.point_light = true;
    map_frustum(strands, resolution, one, faces_[i]);
  }
}

/// @param whole_hair  the frustum is fitted to all of it; else it is a face of the cube, slopes -1 to 1
void DensityMap::map_frustum(const Strands& strands, float resolution, bool whole_hair, Face& face) {
  LightMapping& m = face.mapping;
  Box box = box_along(m.axes, m.centre, strands.vertices);
  glm::vec2 low(-1), high(1);
  if (whole_hair) {
    low = glm::vec2(3e38F), high = glm::vec2(-3e38F);
    for (const glm::vec3& p : strands.vertices) {
      const glm::vec3 q = m.local(p);
      const glm::vec2 slope(q.y / q.x, q.z / q.x);
      low = glm::min(low, slope), high = glm::max(high, slope);
    }
  } else {
    box.low.x = 0;
    box.high.x = std::max(box.high.x, 1e-6F);
  }
  const float slope = std::max({high.x - low.x, high.y - low.y, 1e-6F}) / resolution;
  const float length = std::max(box.extent().x, 1e-6F) / resolution;
  m.cells_per_unit = {1.0F / length, 1.0F / slope, 1.0F / slope};
  m.offset = glm::vec3(-box.low.x / length, -low.x / slope, -low.y / slope) + static_cast<float>(kMargin);
  face.cells = checked_cells(glm::vec3(box.extent().x / length, (high.x - low.x) / slope, (high.y - low.y) / slope));
}

void DensityMap::calibrate(const Strands& strands) {
  const std::array<float, 4> hair{static_cast<float>(strands.vertices.size()), static_cast<float>(strands.count()),
                                  static_cast<float>(strands.diameters_m.size()), strands.diameter_m};
  if (calibrated_for_ == hair) return;
  calibrated_for_ = hair;
  constant_extent_m_ = constant_extent_m(strands);
  double area = 0;
  for (std::size_t s = 0; s < strands.count(); ++s) {
    for (std::size_t i = strands.offsets[s] + 1; i < strands.offsets[s + 1]; ++i) {
      area += static_cast<double>(glm::distance(strands.vertices[i - 1], strands.vertices[i])) *
              static_cast<double>(diameter_at(strands, i));
    }
  }
  blocked_area_m2_ = static_cast<float>(area / static_cast<double>(std::max<std::size_t>(strands.vertices.size(), 1)));
}

void DensityMap::slice_by_content(const Strands& strands, Face& face) {
  constexpr std::size_t kSteps = 1024;
  // Half of the slices are spread evenly, so that none becomes too thick to place a shadow in.
  std::vector<double> content(kSteps, 0.0);
  const double inner = static_cast<double>(face.cells.x - 2 * kMargin);
  const auto span = static_cast<float>(face.cells.x);
  for (const glm::vec3& p : strands.vertices) {
    const float x = face.mapping.cells(p).x / span * static_cast<float>(kSteps);
    if (x >= 0 && x < static_cast<float>(kSteps)) content[static_cast<std::size_t>(x)] += 1;
  }
  const double all = std::accumulate(content.begin(), content.end(), 0.0);
  SliceMap map;
  map.steps_per_cell = static_cast<float>(kSteps) / span;
  double before = 0;
  for (std::size_t i = 0; i <= kSteps; ++i) {
    const double x = static_cast<double>(i) / static_cast<double>(map.steps_per_cell);
    const double even = (x - kMargin) / inner;
    const bool margin = !(even > 0 && even < 1) || all == 0;  // keeps its own slices
    map.at.push_back(static_cast<float>(margin ? x : kMargin + 0.5 * inner * (even + before / all)));
    if (i < kSteps) before += content[i];
  }
  face.mapping.slices = std::move(map);
}

void DensityMap::fill(const Strands& strands, float opacity, Face& face) {
  const std::size_t vertices = strands.vertices.size();
  // Threads fill copies, which are added up later: more than there is work for would cost more than they save.
  const std::size_t allowed = tbb::global_control::active_value(tbb::global_control::max_allowed_parallelism);
  const std::size_t threads =
      std::min({static_cast<std::size_t>(tbb::this_task_arena::max_concurrency()), allowed, kMostCopies});
  const std::size_t copies = std::clamp<std::size_t>(vertices / 4096, 1, threads);
  face.grid.reset(face.cells, copies);
  Cutting cutting{settings_.area, settings_.split, opacity, 0, settings_.factor, {}};
  if (face.mapping.point_light) cutting.cells = face.cells;
  if (!settings_.area) {
    const LightMapping& m = face.mapping;
    const float distance = m.point_light && vertices > 0 ? glm::distance(m.centre, strands.vertices[vertices / 2]) : 1;
    const float cell_m = std::max(distance, 1e-3F) / m.cells_per_unit.y;
    cutting.vertex_depth = settings_.factor * opacity * kMeanSine * blocked_area_m2_ / (cell_m * cell_m);
  }
  tbb::parallel_for(std::size_t{0}, copies, [&](std::size_t copy) {
    const std::size_t first = vertices * copy / copies, last = vertices * (copy + 1) / copies;
    cut_hair(strands, face.mapping, cutting, first, last, [&](PieceBlock& block) {
      if (settings_.trilinear_deposit)
        face.grid.add_trilinear(block, copy);
      else
        face.grid.add_nearest(block, copy);
    });
  });
}

const DensityMap::Face& DensityMap::face_of(glm::vec3 p) const noexcept {
  if (faces_.size() == 1) return faces_[0];
  const glm::vec3 d = p - faces_[0].mapping.centre, size = glm::abs(d);
  const int axis = size.x >= size.y && size.x >= size.z ? 0 : size.y >= size.z ? 1 : 2;
  return faces_[static_cast<std::size_t>(2 * axis + (d[axis] < 0 ? 1 : 0))];
}

void DensityMap::read(const Face& face, std::span<const glm::vec3> points, std::span<float> out) const noexcept {
  CellBlock at{};
  const std::size_t n = points.size();
  face.mapping.cells(points, at);
  const float spread = tap_cells(face);
  if (spread > 0)
    read_footprint(face, at, spread, out);
  else
    read_once(face, at, out);
  for (std::size_t i = 0; i < n; ++i) out[i] += not_finite(points[i]);
}

void DensityMap::read_once(const Face& face, const CellBlock& at, std::span<float> out) const noexcept {
  if (settings_.filter)
    face.grid.interpolate(at, out.size(), out);
  else
    face.grid.nearest(at, out.size(), out);
  if (settings_.interpolate_depth) exponentiate(out.data(), out.size());
}

float DensityMap::tap_cells(const Face& face) const noexcept {
  if (!settings_.filter || face.mapping.point_light) return 0;
  // Variances along an axis, in cells: a disc's r^2 / 4; deposit 1/6 (nearest: 1/12) and interpolation 1/6 have spread
  // the hair by that much already. Two taps at +-d add d^2.
  const float radius = settings_.footprint_m * face.mapping.cells_per_unit.y;
  const float left = 0.25F * radius * radius - (settings_.trilinear_deposit ? 1.0F / 3.0F : 0.25F);
  return left > 0 ? std::sqrt(left) : 0;
}

void DensityMap::read_footprint(const Face& face, const CellBlock& at, float spread,
                                std::span<float> out) const noexcept {
  const std::size_t n = out.size();
  std::array<float, CellBlock::kSize> tap;
  CellBlock moved = at;
  std::fill(out.begin(), out.end(), 0.0F);
  for (const float y : {-spread, spread}) {
    for (std::size_t i = 0; i < n; ++i) moved.y[i] = at.y[i] + y;
    for (const float z : {-spread, spread}) {
      for (std::size_t i = 0; i < n; ++i) moved.z[i] = at.z[i] + z;
      read_once(face, moved, std::span(tap).first(n));
      for (std::size_t i = 0; i < n; ++i) out[i] += 0.25F * tap[i];
    }
  }
}

void DensityMap::transmittance(std::span<const glm::vec3> points, std::span<float> out) const {
  constexpr std::size_t kBlock = CellBlock::kSize;
  const std::size_t blocks = (points.size() + kBlock - 1) / kBlock;
  tbb::parallel_for(tbb::blocked_range<std::size_t>(0, blocks, 16), [&](const auto& range) {
    for (std::size_t b = range.begin(); b != range.end(); ++b) {
      const std::size_t first = b * kBlock, n = std::min(kBlock, points.size() - first);
      if (faces_.size() == 1)
        read(faces_[0], points.subspan(first, n), out.subspan(first, n));
      else
        read_faces(points.subspan(first, n), out.subspan(first, n));
    }
  });
}

void DensityMap::read_faces(std::span<const glm::vec3> points, std::span<float> out) const noexcept {
  std::array<glm::vec3, CellBlock::kSize> of_face;
  std::array<float, CellBlock::kSize> result;
  for (const Face& face : faces_) {
    std::size_t n = 0;
    for (const glm::vec3& p : points) {
      if (&face_of(p) == &face) of_face[n++] = p;
    }
    read(face, std::span(of_face).first(n), std::span(result).first(n));
    n = 0;
    for (std::size_t i = 0; i < points.size(); ++i) {
      if (&face_of(points[i]) == &face) out[i] = result[n++];
    }
  }
}

float DensityMap::optical_depth(glm::vec3 p) const noexcept {
  const Face& face = face_of(p);
  CellBlock at{};
  face.mapping.cells(std::span(&p, 1), at);
  float value = 0;
  face.grid.interpolate(at, 1, std::span(&value, 1));
  // The smallest normal float: depth stays finite (hard case 6).
  if (!settings_.interpolate_depth) value = -std::log(std::max(value, std::numeric_limits<float>::min()));
  return value + not_finite(p);
}

float DensityMap::transmittance(glm::vec3 p) const noexcept {
  float result = 0;
  read(face_of(p), std::span(&p, 1), std::span(&result, 1));
  return result;
}

std::size_t DensityMap::bytes() const noexcept {
  std::size_t sum = 0;
  for (const Face& face : faces_) sum += face.grid.bytes();
  return sum;
}

double DensityMap::deposited_area_m2() const noexcept {
  const double cell = static_cast<double>(cell_size_m());
  return faces_[0].grid.total() * cell * cell;
}

std::optional<DepthTexture> DensityMap::depth_texture() const {
  const Face& face = faces_.front();
  if (face.mapping.point_light || !face.mapping.slices.at.empty()) return std::nullopt;
  if (!settings_.filter) return std::nullopt;
  DepthTexture texture;
  texture.values.reserve(face.grid.bytes() / sizeof(float));
  texture.transmittance = !settings_.interpolate_depth;
  texture.tap_cells = tap_cells(face);
  texture.size = face.grid.cells();
  for (int x = 0; x < texture.size.x; ++x) {
    for (int y = 0; y < texture.size.y; ++y) {
      for (int z = 0; z < texture.size.z; ++z) texture.values.push_back(face.grid.value(x, y, z));
    }
  }
  // Rows of the affine map: cells = axes (p - centre) * scale + offset, less where values sit in their cells.
  const LightMapping& m = face.mapping;
  const float at = face.grid.values() == DepthGrid::Values::centre ? 0.5F : 1.0F;
  glm::mat4 map(1.0F);
  for (int row = 0; row < 3; ++row) {
    const glm::vec3 scaled = m.axes[row] * m.cells_per_unit[row];
    for (int column = 0; column < 3; ++column) map[column][row] = scaled[column];
    map[3][row] = m.offset[row] - glm::dot(scaled, m.centre) - at;
  }
  texture.world_to_cell = map;
  return texture;
}

}  // namespace pelage
