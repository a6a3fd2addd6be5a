// Private to this box: FibreScene::count for many parallel rays that start near each other, as those of a footprint do.
//
// Seen along their direction, rays are points and segments are bands of a plane. So the segments within reach of a
// whole footprint are looked up once (in a grid of that plane: nothing of Embree), and each is compared with all rays
// by plain loops. In double up to the footprint's middle, then in float: coordinates of millimetres, so that a band's
// edge is off by less than 1e-4 of its width, and as many rays as cross there may differ from FibreScene::count
// (tests/reference compares).
#pragma once

#include <cstdint>
#include <glm/vec2.hpp>
#include <glm/vec3.hpp>
#include <optional>
#include <span>
#include <vector>

#include "pelage/reference/fibre_curves.h"
#include "pelage/reference/light_ray.h"

namespace pelage {

/// Crossings of up to kMost rays, and what counting them takes.
struct RayBundle {
  static constexpr std::size_t kMost = 1024;

  std::size_t size = 0;
  alignas(64) float x[kMost], y[kMost];  // start, from the bundle's middle along the frame's x, y
  alignas(64) std::int32_t count[kMost];
  alignas(64) float depth[kMost], reach[kMost];  // of the hit of the segment before; reach < 0: none
};

class ParallelRays {
 public:
  /// @param frame  its z is the direction of all rays
  ParallelRays(const FibreCurves& curves, const LightFrame& frame);

  /// The ray of a bundle that starts at (x, y).
  FibreRay ray(const glm::dvec3& middle, float x, float y) const noexcept {
    return {middle + static_cast<double>(x) * frame_.x + static_cast<double>(y) * frame_.y, frame_.z};
  }

  /// A segment in the frame of a bundle.
  struct Band {
    std::uint32_t segment;
    float x, y, depth;                    // its start
    float dx, dy, ddepth;                 // from start to end
    float per_seen2;                      // 1 / (dx^2 + dy^2), or 0
    float radius, dradius, reach_factor;  // 1 / sin(theta)
    float least_along, most_along;        // where it is round: no bounds
  };

  /// Segments that a ray which starts within `radius_m` of `middle` can hit, ascending.
  void find(const glm::dvec3& middle, double radius_m, std::uint32_t owner, std::vector<Band>& out) const;

  /// Fills rays.count for rays.x, rays.y.
  static void count(std::span<const Band> bands, RayBundle& rays) noexcept;

 private:
  template <class Visit>
  void visit_cells(std::uint32_t segment, const Visit& visit) const;
  std::optional<Band> band(std::uint32_t segment, const glm::dvec3& middle, double radius_m) const noexcept;
  int column(double x) const noexcept;
  int row(double y) const noexcept;
  glm::dvec3 seen(const glm::dvec3& p) const noexcept {
    return {glm::dot(p, frame_.x), glm::dot(p, frame_.y), glm::dot(p, frame_.z)};
  }

  const FibreCurves& curves_;
  LightFrame frame_;
  // Segments by the square cells that their bands may touch.
  glm::dvec2 corner_{0};
  double cell_m_ = 1;
  int columns_ = 0, rows_ = 0;
  std::vector<std::size_t> begins_;      // [rows][columns] + 1, into segments_
  std::vector<std::uint32_t> segments_;  // ascending in a cell
};

}  // namespace pelage
