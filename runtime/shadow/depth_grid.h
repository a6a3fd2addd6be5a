// Optical depth on a grid whose x axis runs along the light: where hair deposits it, how it adds up along the light,
// how it is read. The kernel of the density map [Bertails2005 section 3] and of opacity shadow maps; knows neither hair
// nor light, only pieces and points in cells.
//
// Cell (i, j, k) covers [i, i + 1) x [j, j + 1) x [k, k + 1). Layout [x][y][z], slice after slice from the light, so
// that adding up is one stream of whole slices. Depth is held as whole quanta of 2^-24 in 31 bits, saturating at 128
// (a transmittance of e^-128): sums of integers do not depend on their order, so the same hair gives the same bytes
// whatever the number of threads.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <glm/vec3.hpp>
#include <span>
#include <vector>

namespace pelage {

/// Pieces or points, structure of arrays, positions in cells.
struct CellBlock {
  static constexpr std::size_t kSize = 256;
  alignas(64) std::array<float, kSize + 8> x, y, z;  // 8 more: whole vectors may be written behind the last
};

/// Pieces of hair: what each blocks, as optical depth of one cell.
struct PieceBlock : CellBlock {
  alignas(64) std::array<float, kSize + 8> depth;
  std::size_t count = 0;
};

class DepthGrid {
 public:
  /// Where in its cell a value sits: planes is far along the light, in the middle across it.
  enum class Values { centre, far_corner, planes };

  static constexpr float kQuantum = 1.0F / (1 << 24);  // of optical depth

  /// Empty, of at least 2 cells a side. Keeps its memory when it shrinks. @param copies  grids that threads fill
  /// @throws InputError beyond 2^31 - 1 cells
  void reset(glm::ivec3 cells, std::size_t copies);

  /// Positions are held inside the grid. `copy` is the caller's own: no two threads share one.
  void add_nearest(PieceBlock& block, std::size_t copy) noexcept;
  /// Spread over the eight nearest cells; what they receive sums to the piece's depth, rounded to whole quanta.
  void add_trilinear(PieceBlock& block, std::size_t copy) noexcept;

  /// Adds up along the light, once, over all copies. centre: a cell counts half of itself; else all of itself
  /// [Bertails2005 eq. 3]. @param transmittance  the values become exp(-depth)
  void accumulate(Values values, bool transmittance) noexcept;

  /// Values at positions, trilinear, clamped to the grid (which is empty at its sides).
  void interpolate(const CellBlock& at, std::size_t count, std::span<float> out) const noexcept;
  /// Value of the cell that holds the position.
  void nearest(const CellBlock& at, std::size_t count, std::span<float> out) const noexcept;

  glm::ivec3 cells() const noexcept { return {shape_.x, shape_.y, shape_.z}; }
  Values values() const noexcept { return values_; }
  std::size_t bytes() const noexcept;
  float value(int x, int y, int z) const noexcept;
  /// Sum over columns of what lies in them, in optical depth of a cell; after accumulate().
  double total() const noexcept { return total_; }

  struct Shape {
    std::int32_t x = 2, y = 2, z = 2;
    std::int32_t slice() const noexcept { return y * z; }
    std::size_t size() const noexcept {
      return static_cast<std::size_t>(x) * static_cast<std::size_t>(y) * static_cast<std::size_t>(z);
    }
  };

 private:
  std::size_t size() const noexcept { return shape_.size(); }
  Shape shape_;
  Values values_ = Values::centre;
  double total_ = 0;
  std::vector<std::vector<std::int32_t>> copies_;  // [copy][x][y][z] quanta; after accumulate() the first holds floats
};

}  // namespace pelage
