// Hair as the ray-traced truth sees it: which fibres a straight ray meets, and where.
//
// A fibre of diameter D blocks a D len sin(theta) of area (DESIGN section 3). So each segment is a band of width D that
// faces the ray, round at the joints inside a strand and flat at its two ends; a width that varies is linear along the
// segment. Seen along the ray, two bands that meet at a joint overlap on the inside of the bend by as much as their
// round ends fill on the outside (to third order of the angle): the sum over segments holds at bends too.
//
// A crossing is a run of neighbouring segments that the ray meets at one place: it counts once. Two neighbours are met
// at one place when the depths of the ray's nearest points to their axes differ by no more than their half chords,
// r / sin(theta) each; at every bend below 90 degrees, as the ray sees it, that is always so. A strand that curls back
// over the ray, or folds sharply with its legs apart, is a second crossing. A run is counted by its first segment, so
// that a ray needs no list and the order of hits has no meaning. A crossing lies on the ray when that nearest point of
// the axis is beyond its origin and before its end.
//
// How. Embree finds candidates: flat linear curves, widened by 1 % and by Embree's rounding, so that it finds too many
// rather than too few. Which of them count is decided in double from the segments themselves. Embree's own
// counts are wrong for hair (measured on wavy hair): flat curves count each joint twice, too many by D / len of all
// crossings (+1.5 % at D / len = 1.4 %, +16 % at 15 %), and drop hits within a diameter of the origin; round ones and
// cones report entry and exit (+100 %), and joints as well (+1 % to +11 % when each segment counts once).
//
// Limit: coordinates are float, so the hair should lie within some 100 times its size from the world's origin.
#pragma once

#include <cstddef>
#include <cstdint>
#include <glm/vec3.hpp>
#include <limits>
#include <memory>
#include <optional>
#include <span>
#include <vector>

#include "pelage/data_schema/mesh.h"
#include "pelage/data_schema/strands.h"

namespace pelage {

struct FibreCurves;  // fibre_curves.h

/// A straight ray. Double: the direction of a float ray of half a metre is off by a thousandth of a fibre.
struct FibreRay {
  glm::dvec3 origin{0};
  glm::dvec3 direction{0, 0, 1};  // unit
  double length_m = std::numeric_limits<double>::infinity();
};

/// No segment owns the ray.
inline constexpr std::uint32_t kNoOwner = 0xffffffffU;

/// Where a ray meets a fibre.
struct FibreCrossing {
  double depth_m = 0;        // along the ray, > 0
  std::uint32_t vertex = 0;  // the run's segment nearest to the ray starts at this vertex of Strands
  float along = 0;           // where on that segment, [0, 1]
  glm::vec3 offset{0};       // of the ray from the axis, across the ray, in radii: length in [0, 1]
  glm::vec3 tangent{0};      // unit, towards the tip: half-way between its segments' directions at a vertex, and
                             // between the two vertices' here
};

/// Where a ray meets the head first.
struct HeadHit {
  double depth_m = 0;
  glm::vec3 normal{0};  // unit, interpolated, outward
};

/// Immutable; any number of threads may ask.
class FibreScene {
 public:
  /// Diameters: per vertex, else for all, else the default of DESIGN section 3. Strands of one vertex and segments
  /// without length are invisible. @param opacity the fibres' a, [0, 1]
  /// @throws InputError for a coordinate or diameter that is not finite, or a diameter below 0
  FibreScene(const Strands& strands, float opacity, const Mesh* head = nullptr);
  ~FibreScene();
  FibreScene(FibreScene&&) noexcept;
  FibreScene& operator=(FibreScene&&) noexcept;

  /// Crossings of the ray, without those of the owner's segment and its two neighbours. The owner is a vertex: its
  /// segment is the one that starts there (of a strand's last vertex: that ends there).
  /// @param enough  the count may stop here: the result is then min(crossings, enough)
  int count(const FibreRay& ray, std::uint32_t owner = kNoOwner,
            int enough = std::numeric_limits<int>::max()) const noexcept;
  /// The same crossings, nearest first. Replaces the content of `out`.
  void collect(const FibreRay& ray, std::vector<FibreCrossing>& out) const;
  /// Nothing without a head.
  std::optional<HeadHit> head(const FibreRay& ray) const noexcept;

  /// (1 - a)^crossings.
  double transmittance(int crossings) const noexcept;
  /// The crossings from which on transmittance is below `stop_below`, or exactly 0: no need to count on. A ray that
  /// stops there is off by less than `stop_below`.
  int enough(float stop_below) const noexcept;

  std::size_t segments() const noexcept;
  bool has_head() const noexcept;
  /// Of all that is visible of the hair; low > high when nothing is.
  glm::vec3 low() const noexcept;
  glm::vec3 high() const noexcept;
  /// For this box's own use.
  const FibreCurves& curves() const noexcept;

 private:
  struct State;
  std::unique_ptr<State> state_;
};

}  // namespace pelage
