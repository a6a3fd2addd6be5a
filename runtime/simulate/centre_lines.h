// Hair split in two: centre lines of few, equal segments, which are simulated, and what they leave out of each strand
// (waves, curls, the run between vertices), which rides on their rotation-minimising frames [Wang2008]. At rest the two
// give the hair back to rounding.
//
// A line is the strand smoothed over its arc length by a hat of two segments to either side (waves of one or two
// segments are gone, of four 40 % of the amplitude stays, a bend of radius R moves inwards by a third of a squared
// segment over R), continued at both ends by its point reflection, so that ends stay where they are and straight
// strands straight; then cut into equal chords. Between its vertices a line is a Catmull-Rom curve.
#pragma once

#include <glm/ext/quaternion_double.hpp>

#include "pelage/data_schema/strands.h"
#include "pelage/simulate/riders.h"

namespace pelage {

/// @param vertices  of the longest line, >= 2; shorter strands have fewer, so that segments are of like length; at
/// least 3 (where `vertices` allows) for a strand of more than 2 vertices, else 2
/// Root and tip stay. A strand without length gives a line without length, one without vertices none. Chords of a line
/// are equal to 1e-6 of its length, but for the last one of a strand that folds back within a segment.
/// @throws InputError for a strand that is not finite, UsageError for fewer than 2 vertices
Strands centre_lines(const Strands& hair, int vertices);

class StrandDetail {
 public:
  StrandDetail() = default;
  /// @param lines  centre lines of the hair's strands at rest, one for each   @throws InputError where they are not
  StrandDetail(const Strands& hair, const Strands& lines);

  /// The hair on moved lines. @param turn  rotation of the head since rest   @param out  laid out as the hair
  void apply(const Strands& lines, const glm::dquat& turn, Strands& out) const;

 private:
  Riders riders_;
};

}  // namespace pelage
