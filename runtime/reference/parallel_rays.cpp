#include "pelage/reference/parallel_rays.h"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <glm/vec2.hpp>
#include <limits>
#include <numeric>
#include <utility>

namespace pelage {
namespace {

/// Room for the rays' starts, which are float, and for their radius of at most 1 + 1e-8 footprints.
constexpr double kRayRounding = 1e-5;
constexpr float kNone = -1e30F;  // minus any reach is still far below 0
constexpr double kLongestReach = 1e9;

using Band = ParallelRays::Band;

/// One band against all rays. `after`: the band of the segment before was the last one counted.
__attribute__((target_clones("avx512f", "avx2", "default"))) void count_band(const Band& band, bool after,
                                                                             RayBundle& rays) noexcept {
  const std::size_t n = rays.size;
  const float nothing = after ? 0.0F : 2 * kNone;
  const Band b = band;
  for (std::size_t i = 0; i < n; ++i) {
    const float wx = rays.x[i] - b.x, wy = rays.y[i] - b.y;
    const float unbounded = (wx * b.dx + wy * b.dy) * b.per_seen2;
    const float along = std::min(std::max(unbounded, 0.0F), 1.0F);
    const float off_x = wx - along * b.dx, off_y = wy - along * b.dy;
    const float radius = b.radius + along * b.dradius, depth = b.depth + along * b.ddepth;
    const bool hit = (off_x * off_x + off_y * off_y < radius * radius) & (depth > 0.0F) & (unbounded >= b.least_along) &
                     (unbounded <= b.most_along);
    const float reach = hit ? radius * b.reach_factor : kNone;
    const bool same = std::abs(depth - rays.depth[i]) <= reach + rays.reach[i] + nothing;
    rays.count[i] += hit & !same ? 1 : 0;
    rays.depth[i] = depth;
    rays.reach[i] = reach;
  }
}

}  // namespace

int ParallelRays::column(double x) const noexcept {
  return static_cast<int>(std::clamp((x - corner_.x) / cell_m_, 0.0, columns_ - 1.0));
}
int ParallelRays::row(double y) const noexcept {
  return static_cast<int>(std::clamp((y - corner_.y) / cell_m_, 0.0, rows_ - 1.0));
}

/// Row by row, so that a long oblique segment is in few cells.
template <class Visit>
void ParallelRays::visit_cells(std::uint32_t segment, const Visit& visit) const {
  const Segment s = curves_.segment(segment);
  glm::dvec2 a(seen(s.a)), b(seen(s.b));
  if (a.y > b.y) std::swap(a, b);
  // least_widening: far more than double's rounding of a row's border.
  const double radius = std::max(s.radius_a, s.radius_b) + curves_.least_widening, rise = b.y - a.y;
  for (int j = row(a.y - radius); j <= row(b.y + radius); ++j) {
    const double low = corner_.y + j * cell_m_ - radius, high = corner_.y + (j + 1) * cell_m_ + radius;
    const double from = rise > 0 ? std::clamp((low - a.y) / rise, 0.0, 1.0) : 0;
    const double to = rise > 0 ? std::clamp((high - a.y) / rise, 0.0, 1.0) : 1;
    const double x0 = a.x + from * (b.x - a.x), x1 = a.x + to * (b.x - a.x);
    for (int i = column(std::min(x0, x1) - radius); i <= column(std::max(x0, x1) + radius); ++i) {
      visit(static_cast<std::size_t>(j) * static_cast<std::size_t>(columns_) + static_cast<std::size_t>(i));
    }
  }
}

ParallelRays::ParallelRays(const FibreCurves& curves, const LightFrame& frame) : curves_(curves), frame_(frame) {
  const std::uint32_t segments = curves.size();
  if (segments == 0) return;
  FibreBox box;
  for (std::uint32_t i = 0; i < segments; ++i) {
    const Segment s = curves.segment(i);
    box.add(seen(s.a), s.radius_a);
    box.add(seen(s.b), s.radius_b);
  }
  const glm::dvec2 size(box.high - box.low);
  corner_ = glm::dvec2(box.low);
  // Hair without width that runs along the rays has no size.
  const double longest = std::max({size.x, size.y, curves.least_widening});
  cell_m_ = longest / std::clamp(std::sqrt(static_cast<double>(segments)) / 8, 1.0, 1024.0);
  columns_ = static_cast<int>(size.x / cell_m_) + 1;
  rows_ = static_cast<int>(size.y / cell_m_) + 1;
  begins_.assign(static_cast<std::size_t>(columns_) * static_cast<std::size_t>(rows_) + 1, 0);
  for (std::uint32_t i = 0; i < segments; ++i) visit_cells(i, [&](std::size_t cell) { ++begins_[cell + 1]; });
  std::partial_sum(begins_.begin(), begins_.end(), begins_.begin());
  segments_.resize(begins_.back());
  std::vector<std::size_t> next(begins_.begin(), begins_.end() - 1);
  for (std::uint32_t i = 0; i < segments; ++i) visit_cells(i, [&](std::size_t cell) { segments_[next[cell]++] = i; });
}

std::optional<Band> ParallelRays::band(std::uint32_t segment, const glm::dvec3& middle,
                                       double radius_m) const noexcept {
  const Segment s = curves_.segment(segment);
  const glm::dvec3 a = seen(s.a - middle), d = seen(s.b - middle) - a;
  const double seen2 = d.x * d.x + d.y * d.y;
  const double along = seen2 > 0 ? std::clamp(-(a.x * d.x + a.y * d.y) / seen2, 0.0, 1.0) : 0;
  const double x = a.x + along * d.x, y = a.y + along * d.y, most = radius_m + std::max(s.radius_a, s.radius_b);
  if (std::max(a.z, a.z + d.z) <= 0 || x * x + y * y > most * most * (1 + kRayRounding)) return std::nullopt;
  const auto f = [](double value) { return static_cast<float>(value); };
  constexpr float kFar = std::numeric_limits<float>::infinity();
  return Band{segment,
              f(a.x),
              f(a.y),
              f(a.z),
              f(d.x),
              f(d.y),
              f(d.z),
              seen2 > 0 ? f(1 / seen2) : 0.0F,
              f(s.radius_a),
              f(s.radius_b - s.radius_a),
              f(std::min(std::sqrt((seen2 + d.z * d.z) / seen2), kLongestReach)),
              s.joint_a ? -kFar : 0.0F,
              s.joint_b ? kFar : 1.0F};
}

void ParallelRays::find(const glm::dvec3& middle, double radius_m, std::uint32_t owner, std::vector<Band>& out) const {
  out.clear();
  if (segments_.empty()) return;
  const glm::dvec3 at = seen(middle);
  const OwnSegments own = curves_.owned_by(owner);
  const int last_row = row(at.y + radius_m), last_column = column(at.x + radius_m);
  for (int j = row(at.y - radius_m); j <= last_row; ++j) {
    for (int i = column(at.x - radius_m); i <= last_column; ++i) {
      const auto cell = static_cast<std::size_t>(j) * static_cast<std::size_t>(columns_) + static_cast<std::size_t>(i);
      for (std::size_t k = begins_[cell]; k < begins_[cell + 1]; ++k) {
        if (own.has(segments_[k])) continue;
        if (const auto b = band(segments_[k], middle, radius_m)) out.push_back(*b);
      }
    }
  }
  std::sort(out.begin(), out.end(), [](const Band& a, const Band& b) { return a.segment < b.segment; });
  const auto same = [](const Band& a, const Band& b) { return a.segment == b.segment; };
  out.erase(std::unique(out.begin(), out.end(), same), out.end());
}

void ParallelRays::count(std::span<const Band> bands, RayBundle& rays) noexcept {
  std::fill_n(rays.count, rays.size, 0);
  std::fill_n(rays.depth, rays.size, 0.0F);
  std::fill_n(rays.reach, rays.size, kNone);
  for (std::size_t k = 0; k < bands.size(); ++k) {
    const bool joint = bands[k].least_along < 0;
    const bool after = joint && k > 0 && bands[k - 1].segment + 1 == bands[k].segment;
    count_band(bands[k], after, rays);
  }
}

}  // namespace pelage
