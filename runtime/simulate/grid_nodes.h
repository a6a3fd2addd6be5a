// Private to this box: what the nodes of the voxel grid know (density, velocity) and what they do to a vertex.
//
// A vertex takes  v' = (1 - c) v + F  with (F, c) interpolated between nodes. At a node with velocity V, friction f =
// 1 - exp(-friction_per_s h) and then wind w = (1 - exp(-drag_per_s h)) exp(-shelter rho / rho_0) towards W give
//   1 - c = (1 - f)(1 - w),   F = (1 - w) f V + w W + a h,
// so that steps of any length add up to the same decay. Repulsion a is bounded by A = repulsion_m_s2:
//   gradient: a = -A g / (|g| + rho_0 / cell), g by central differences over a cell [Almeida2014 eqs. 3.5, 3.7; as
//     printed hair moves up the gradient, by a distance per step]: a flat field gives 0.
//   overfull: every cell whose mean density exceeds `overfull` rho_0 by e rho_0 pushes its eight nodes away from its
//     centre by e [Bertails2005 section 4.1]; a = A sum / (|sum| + 1). Between the nodes the push is trilinear, so it
//     is 0 at the centre of a lone cell and continuous, and it cancels where all cells are as full.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "pelage/simulate/grid_deposit.h"
#include "pelage/simulate/grid_frame.h"
#include "pelage/simulate/wind.h"

namespace pelage::grid {

/// Of a step.
struct Terms {
  float cell_m = 0;
  float friction = 0;       // f
  float wind = 0;           // 1 - exp(-drag_per_s h)
  float shelter_m2 = 0;     // shelter / rho_0
  float repulsion_m_s = 0;  // A h
  bool overfull = false;    // else gradient
  float rest_density = 1;   // rho_0 [m of hair per m^3]
  float full_density = 0;   // overfull x rho_0
  const Wind* gusts = nullptr;
};

class Nodes {
 public:
  /// Adds up the deposits in their order; density and velocity of each node. Rows are looked for only when some deposit
  /// made new ones; another box than last time: all of them did.
  void merge(std::span<const Deposit> deposits, const Box& box, float cell_m);
  /// What the nodes do to a vertex.
  void act(const Terms& terms);

  const Box& box() const noexcept { return box_; }
  /// 4 floats of each of a row's kRow + 1 nodes: F, c. Row 0: a vertex stays as it is.
  const float* fields() const noexcept { return fields_.data(); }
  const Directory& directory() const noexcept { return directory_; }

  std::size_t rows() const noexcept { return keys_.size(); }
  std::size_t used_nodes() const noexcept;
  /// Square of the greatest speed of a node of the row that begins there.
  float fastest_sq(std::uint32_t begin) const noexcept { return fastest_sq_[begin / kRowFloats]; }
  /// Density [m/m^3] (0) or a component of velocity (1, 2, 3) at a node (cell coordinates).
  float value(int quantity, const glm::ivec3& node) const noexcept;
  std::size_t bytes() const noexcept;

 private:
  bool goes_on(std::span<const Deposit> deposits, std::uint32_t key) const noexcept;
  void collect_keys(std::span<const Deposit> deposits, const Box& box);

  Box box_;
  Directory directory_;
  std::vector<std::uint32_t> keys_;  // [rows], increasing
  std::vector<std::uint32_t> ends_;  // of rows without a next one
  std::vector<float> values_;        // [1 + rows][density, velocity x, y, z][kRow]
  std::vector<float> fastest_sq_;    // [1 + rows]
  std::vector<float> fields_;        // [1 + rows][kRow + 1][4]
};

}  // namespace pelage::grid
