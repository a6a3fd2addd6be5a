// Light-oriented density map [Bertails2005]: optical depth from the light to any point through the hair.
//
// Three stages, each one function with its own time: fill (hair into cells), accumulate (along the light),
// transmittance (filter: read at points). As the paper prints it, or corrected [DESIGN section 6], each correction a
// switch of DensityMapSettings:
// - a segment deposits the area a D len sin(segment, light) that it blocks, not a count per vertex, in pieces of half a
//   cell; spreading each trilinearly over eight cells costs time and, at 128^3, accuracy (10,000 wavy strands: RMSE
//   .032 against .027), since hair is not as blurred as that. It stays as a switch;
// - values sit at cell centres and count half of their own cell, so that a fibre shadows itself by half;
// - transmittance is interpolated, as the paper has it: interpolating depth instead (DESIGN section 6) triples the bias
//   in clumped hair and adds a third to the error (10,000 wavy strands, 128^3: RMSE .043 against .033, bias -.013
//   against -.004), since light goes between the clumps. It stays as a switch;
// - where cells are finer than the footprint over which the truth is averaged, so are reads: 256^3 .023 -> .017.
// The paper's torus (cell index modulo N) is a way to store a box that moves through a space of constant size. Here the
// occupied box itself is stored, densely, and grows with the hair: what the torus has to guard against (negative
// indices, the first slice next to the last, hair that folds onto itself) cannot happen. `fitted = false` keeps the
// paper's constant cells, anchored in space.
// Before the hair, and beside it, a point has depth 0; behind it the column's total.
// Point lights: one frustum around the hair where the light sees it within 50 degrees, else the six faces of a cube;
// from a thousand times the hair's size on, parallel.
#pragma once

#include <array>
#include <cstddef>
#include <glm/vec3.hpp>
#include <span>
#include <vector>

#include "pelage/shadow/depth_grid.h"
#include "pelage/shadow/hair_shadow.h"
#include "pelage/shadow/light_mapping.h"

namespace pelage {

class DensityMap final : public HairShadow {
 public:
  explicit DensityMap(const DensityMapSettings& settings) : settings_(settings) {}
  /// Built at once. @throws as build
  DensityMap(const DensityMapSettings& settings, const Strands& strands, float opacity, const Light& light)
      : settings_(settings) {
    build(strands, opacity, light);
  }

  void build(const Strands& strands, float opacity, const Light& light) override;
  void transmittance(std::span<const glm::vec3> points, std::span<float> out) const override;
  std::size_t bytes() const noexcept override;
  std::optional<DepthTexture> depth_texture() const override;
  BuildTimes times() const noexcept override { return times_; }

  /// Optical depth >= 0 between p and the light, up to 128 (87 where transmittance is what is interpolated), over no
  /// footprint; NaN where p is not finite.
  float optical_depth(glm::vec3 p) const noexcept;
  float transmittance(glm::vec3 p) const noexcept;

  /// Size of a cell across the light [m]; parallel light only.
  float cell_size_m() const noexcept { return faces_.front().mapping.cell_across_m(); }
  glm::ivec3 cells() const noexcept { return faces_.front().grid.cells(); }
  /// Blocked area [m^2] that lies in the map; parallel light only.
  double deposited_area_m2() const noexcept;

 private:
  /// One grid: all of a parallel light, or a frustum of a point light.
  struct Face {
    LightMapping mapping;
    glm::ivec3 cells{0};
    DepthGrid grid;
  };
  void map_parallel(const Strands& strands, glm::vec3 to_light);
  void map_point(const Strands& strands, glm::vec3 light);
  static void map_frustum(const Strands& strands, float resolution, bool whole_hair, Face& face);
  void calibrate(const Strands& strands);
  static void slice_by_content(const Strands& strands, Face& face);
  void fill(const Strands& strands, float opacity, Face& face);
  const Face& face_of(glm::vec3 p) const noexcept;
  void read_faces(std::span<const glm::vec3> points, std::span<float> out) const noexcept;
  void read_once(const Face& face, const CellBlock& at, std::span<float> out) const noexcept;
  /// Distance of the four taps of a footprint from its middle, in cells; 0: the map is coarser than the footprint.
  float tap_cells(const Face& face) const noexcept;
  void read_footprint(const Face& face, const CellBlock& at, float spread, std::span<float> out) const noexcept;
  void read(const Face& face, std::span<const glm::vec3> points, std::span<float> out) const noexcept;

  DensityMapSettings settings_;
  std::vector<Face> faces_;
  BuildTimes times_;
  // Lengths do not change when hair moves; measured when these do: numbers of vertices, strands, diameters, and D.
  std::array<float, 4> calibrated_for_{-1, -1, -1, -1};
  float blocked_area_m2_ = 0;  // D len of all segments, per vertex
  float constant_extent_m_ = 0;
};

}  // namespace pelage
