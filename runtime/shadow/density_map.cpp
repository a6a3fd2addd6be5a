#include "pelage/shadow/density_map.h"

#include <algorithm>
#include <cmath>
#include <glm/geometric.hpp>
#include <glm/vector_relational.hpp>
#include <limits>
#include <numeric>

#include "pelage/data_schema/errors.h"

namespace pelage {
namespace {

/// Rows: unit direction of travel (away from the light) and two unit axes across it.
glm::mat3 light_frame(glm::vec3 to_light) {
  const float length = glm::length(to_light);
  if (!(length > 0.0F) || !std::isfinite(length)) {
    throw InputError("light",
                     "the direction has length " + std::to_string(length) + "; give a finite vector that is not zero");
  }
  const glm::vec3 x = -to_light / length;
  const glm::vec3 helper = std::abs(x.x) < 0.6F ? glm::vec3(1, 0, 0) : glm::vec3(0, 1, 0);
  const glm::vec3 y = glm::normalize(glm::cross(helper, x));
  return glm::transpose(glm::mat3(x, y, glm::cross(x, y)));
}

/// Beyond this squares of lengths in cells leave float; hair is metres away, not light seconds.
constexpr float kFarthest_m = 1e9F;

void check_finite(std::span<const Segment> segments) {
  const auto near = [](glm::vec3 p) { return glm::all(glm::lessThanEqual(glm::abs(p), glm::vec3(kFarthest_m))); };
  for (std::size_t i = 0; i < segments.size(); ++i) {
    if (near(segments[i].a) && near(segments[i].b)) continue;
    throw InputError("density map",
                     "segment " + std::to_string(i) +
                         " has a coordinate that is not finite or beyond 1e9 m; check the hair and its transforms");
  }
}

}  // namespace

DensityMap::DensityMap(std::span<const Segment> segments, glm::vec3 to_light, float blocked_width_m, int resolution)
    : to_light_frame_(light_frame(to_light)) {
  check_finite(segments);
  fit_box(segments, resolution);
  depth_.assign(
      static_cast<std::size_t>(size_.x) * static_cast<std::size_t>(size_.y) * static_cast<std::size_t>(size_.z), 0.0F);
  for (const Segment& s : segments) {
    const glm::vec3 a = to_light_frame_ * s.a;
    const glm::vec3 step = to_light_frame_ * s.b - a;
    const float across = std::sqrt(step.y * step.y + step.z * step.z);  // length times sine to the light
    const int pieces = std::clamp(static_cast<int>(std::ceil(2.0F * glm::length(step) / cell_)), 1, 4096);
    const float depth = blocked_width_m * across / (cell_ * cell_) / static_cast<float>(pieces);
    for (int i = 0; i < pieces; ++i) {
      deposit(a + ((static_cast<float>(i) + 0.5F) / static_cast<float>(pieces)) * step, depth);
    }
  }
  const double sum = std::accumulate(depth_.begin(), depth_.end(), 0.0);
  deposited_area_m2_ = sum * static_cast<double>(cell_) * static_cast<double>(cell_);
  sum_along_light();
}

void DensityMap::fit_box(std::span<const Segment> segments, int resolution) {
  glm::vec3 low{std::numeric_limits<float>::max()};
  glm::vec3 high{std::numeric_limits<float>::lowest()};
  for (const Segment& s : segments) {
    for (const glm::vec3& p : {to_light_frame_ * s.a, to_light_frame_ * s.b}) {
      low = glm::min(low, p);
      high = glm::max(high, p);
    }
  }
  if (segments.empty()) low = high = glm::vec3(0.0F);
  const glm::vec3 extent = high - low;
  cell_ = std::max({extent.x, extent.y, extent.z, 1e-6F}) / static_cast<float>(std::clamp(resolution, 1, 1024));
  // One cell of margin on each side takes the trilinear deposit of hair on the border.
  origin_ = low - glm::vec3(cell_);
  size_ = glm::ivec3(glm::ceil(extent / cell_)) + 3;
}

std::size_t DensityMap::index(int x, int y, int z) const noexcept {
  return (static_cast<std::size_t>(x) * static_cast<std::size_t>(size_.y) + static_cast<std::size_t>(y)) *
             static_cast<std::size_t>(size_.z) +
         static_cast<std::size_t>(z);
}

void DensityMap::deposit(glm::vec3 q, float depth) noexcept {
  const glm::vec3 g = (q - origin_) / cell_ - 0.5F;  // cell-centred
  const glm::vec3 base = glm::clamp(glm::floor(g), glm::vec3(0.0F), glm::vec3(size_ - 2));
  const glm::vec3 f = g - base;
  const int x = static_cast<int>(base.x), y = static_cast<int>(base.y), z = static_cast<int>(base.z);
  for (int corner = 0; corner < 8; ++corner) {
    const int i = corner >> 2, j = (corner >> 1) & 1, k = corner & 1;
    const float w = (i ? f.x : 1 - f.x) * (j ? f.y : 1 - f.y) * (k ? f.z : 1 - f.z);
    depth_[index(x + i, y + j, z + k)] += w * depth;
  }
}

void DensityMap::sum_along_light() noexcept {
  // Depth at a cell's centre plane: all cells nearer to the light and half of the cell itself.
  const std::size_t slice = static_cast<std::size_t>(size_.y) * static_cast<std::size_t>(size_.z);
  std::vector<float> total(slice, 0.0F);
  for (std::size_t x = 0; x < static_cast<std::size_t>(size_.x); ++x) {
    float* const row = depth_.data() + x * slice;
    for (std::size_t i = 0; i < slice; ++i) {
      const float own = row[i];
      row[i] = total[i] + 0.5F * own;
      total[i] += own;
    }
  }
}

float DensityMap::at(int x, int y, int z) const noexcept {
  if (y < 0 || z < 0 || y >= size_.y || z >= size_.z || x < 0) return 0.0F;
  return depth_[index(std::min(x, size_.x - 1), y, z)];
}

float DensityMap::optical_depth(glm::vec3 p) const noexcept {
  const glm::vec3 g = (to_light_frame_ * p - origin_) / cell_ - 0.5F;
  if (std::isnan(g.x + g.y + g.z)) return std::numeric_limits<float>::quiet_NaN();
  // Bounded before the conversion to int: floor of a far point does not fit.
  const glm::vec3 bounded = glm::clamp(g, glm::vec3(-2.0F), glm::vec3(size_) + 1.0F);
  const glm::vec3 base = glm::floor(bounded);
  const glm::vec3 f = bounded - base;
  const int x = static_cast<int>(base.x), y = static_cast<int>(base.y), z = static_cast<int>(base.z);
  float sum = 0.0F;
  for (int corner = 0; corner < 8; ++corner) {
    const int i = corner >> 2, j = (corner >> 1) & 1, k = corner & 1;
    const float w = (i ? f.x : 1 - f.x) * (j ? f.y : 1 - f.y) * (k ? f.z : 1 - f.z);
    sum += w * at(x + i, y + j, z + k);
  }
  return sum;
}

float DensityMap::transmittance(glm::vec3 p) const noexcept {
  return std::exp(-optical_depth(p));
}

}  // namespace pelage
