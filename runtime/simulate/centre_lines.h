// Hair split in two: centre lines of few, equal segments, which are simulated, and what they leave out of each strand
// (waves, curls, the run between vertices), which rides on their rotation-minimising frames [Wang2008]. At rest the two
// give the hair back to rounding.
#pragma once

#include <cstdint>
#include <glm/ext/quaternion_double.hpp>
#include <glm/vec3.hpp>
#include <vector>

#include "pelage/data_schema/strands.h"

namespace pelage {

/// @param vertices  of the longest line, >= 2; shorter strands have fewer, so that segments are of like length
/// Root and length along the line stay; waves shorter than two segments do not.
Strands centre_lines(const Strands& hair, int vertices);

class StrandDetail {
 public:
  /// @param lines  centre lines of the hair's strands at rest, one for each
  StrandDetail(const Strands& hair, const Strands& lines);

  /// The hair on moved lines. @param turn  rotation of the head since rest   @param out  laid out as the hair
  void apply(const Strands& lines, const glm::dquat& turn, Strands& out) const;
};

}  // namespace pelage
