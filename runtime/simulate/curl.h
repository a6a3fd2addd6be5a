// Curls as a rest shape: a helix around each strand on rotation-minimising frames [Almeida2014 section 3.1.2, with
// Wang2008 in place of averaged normals].
//
// At arc length s of a line of length S the strand is at  line(s) + rho (cos phi, sin phi)  in the normal plane, with
// phi = 2 pi (phase + (s + growth s^2 / 2 S) / pitch)  and rho rising smoothly from 0 at the root to the radius. The
// helix adds length: with pitch p and radius R the strand is sqrt(1 + (2 pi R / p)^2) times as long as its line where
// the radius is full (R = 1 cm, p = 3 cm: 2.3 times), a little less as a polygon. A groom that shall keep its length
// wants lines shorter by that.
//
// Phases vary smoothly over the scalp, by about a turn in 5 cm, so that neighbours curl as a lock and locks do not
// march in step; phase_spread is scattered on top, strand by strand.
#pragma once

#include <glm/ext/quaternion_double.hpp>

#include "pelage/data_schema/simulation_settings.h"
#include "pelage/data_schema/strands.h"
#include "pelage/simulate/riders.h"

namespace pelage {

class Curls {
 public:
  Curls() = default;
  /// @param lines  at rest, of any number of vertices: phases belong to roots at rest, or they would change with the
  /// head   @throws UsageError for settings out of range, or more than 2^32 - 1 vertices
  Curls(const Strands& lines, const CurlSettings& settings);

  /// The strands at rest: layout, diameters and colours for apply(). Each segment is cut into settings.subdivision,
  /// along a Catmull-Rom curve, also where the radius is 0. Roots stay.
  const Strands& rest() const noexcept { return rest_; }
  /// Curls on moved lines. @param turn  rotation of the head since rest   @param out  laid out as rest()
  void apply(const Strands& lines, const glm::dquat& turn, Strands& out) const;

 private:
  Riders riders_;
  Strands rest_;
};

/// The strands with a helix around them, at rest. Radius 0: a copy.
Strands curled(const Strands& lines, const CurlSettings& settings);

}  // namespace pelage
