// Wisps: about a hundred, three simulated guides each, and the strands between them interpolated [Bertails2005 section
// 4.1].
#pragma once

#include <cstdint>
#include <glm/ext/quaternion_double.hpp>
#include <vector>

#include "pelage/data_schema/strands.h"

namespace pelage {

class Wisps {
 public:
  /// Groups centre lines at rest by root and shape and picks three guides of each group.
  Wisps(const Strands& lines, int wisps);

  /// The guides' lines at rest, to be simulated.
  const Strands& guides() const noexcept;
  /// Lines of all strands from those of the guides: `out` is laid out as the lines that the wisps were made of. A line
  /// at rest is given back to rounding when the guides are at rest.
  void interpolate(const Strands& guides, const glm::dquat& turn, Strands& out) const;
};

}  // namespace pelage
