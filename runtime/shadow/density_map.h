// Light-oriented density map [Bertails2005 section 2], in the corrected form of DESIGN section 6: how much light
// reaches a point through the hair.
//
// A box grid whose x axis runs along the light's travel; every segment deposits the area a D len sin(segment, light)
// that it blocks, trilinearly; the running sum along x is optical depth. Depth is interpolated (trilinear,
// cell-centred), the exponential taken at lookup. The grid is fitted to the hair, so nothing wraps and nothing folds.
// Outside the box a point has the depth of the box's nearest border along the light: 0 before it, the column's total
// behind it, and 0 beside it.
#pragma once

#include <cstdint>
#include <glm/mat3x3.hpp>
#include <glm/vec3.hpp>
#include <span>
#include <vector>

namespace pelage {

/// A straight piece of hair.
struct Segment {
  glm::vec3 a, b;  // metres
};

class DensityMap {
 public:
  /// @param segments     each coordinate within 1e9 m (InputError otherwise)
  /// @param to_light     towards the light, any length > 0 (InputError otherwise)
  /// @param blocked_width_m  a D: width [m] that a fibre blocks when seen from the side
  /// @param resolution   cells along the longest side of the box, [1, 1024]
  DensityMap(std::span<const Segment> segments, glm::vec3 to_light, float blocked_width_m, int resolution);

  /// Optical depth >= 0 between p and the light; NaN where p is not finite (a caller's error stays visible).
  float optical_depth(glm::vec3 p) const noexcept;
  /// exp(-optical_depth), in [0, 1].
  float transmittance(glm::vec3 p) const noexcept;

  std::size_t bytes() const noexcept { return depth_.size() * sizeof(float); }
  float cell_size_m() const noexcept { return cell_; }
  /// Blocked area [m^2] that was deposited in all.
  double deposited_area_m2() const noexcept { return deposited_area_m2_; }

 private:
  void fit_box(std::span<const Segment> segments, int resolution);
  void deposit(glm::vec3 q, float depth) noexcept;
  void sum_along_light() noexcept;
  std::size_t index(int x, int y, int z) const noexcept;
  float at(int x, int y, int z) const noexcept;

  glm::mat3 to_light_frame_{1.0F};  // rows: direction of travel, and two axes across it
  glm::vec3 origin_{0.0F};          // of the grid, in the light's frame [m]
  float cell_ = 1.0F;               // cell size ds [m]
  glm::ivec3 size_{1};              // cells: along the light, across, across
  std::vector<float> depth_;        // [x][y][z] optical depth from the light to the far end of the cell's centre plane
  double deposited_area_m2_ = 0;
};

}  // namespace pelage
