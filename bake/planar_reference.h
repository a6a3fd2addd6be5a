// Planar ray trace of one sector, the straightforward way: one march per (view, light, ray), in double [Xu2006 section
// 5.1, eq. 5; DESIGN section 4]. This is the definition of the model, the oracle of bake/planar_tracer and the baseline
// of its speed. Nobody bakes with it.
//
// March. Angles [rad] from outward r, positive towards +s; a viewer at theta looks from (sin theta, cos theta) in
// (s, r). With cos theta >= 0 the ray enters at (s, 1) and goes inwards, else it enters at (s, 0) and goes outwards.
// It wraps in s, ends where it leaves 0 <= r <= 1, and is at most `max_path` long. n equal steps of at most half a
// cell, sampled in their middles. |cos theta| < 1e-6 counts as 0 (the ray runs along r = 1). Density is the bilinear
// interpolant of the grid; beyond the outermost cell centres in r it goes on linearly (not below 0), and its gradient
// is the central difference over +-1 cell of that. Optical depth: tau = c0 * line integral. A step has opacity 1 -
// exp(-dtau); reflectance is composited front to back until the accumulated opacity reaches `early_stop` (tau goes on).
// Reflectance of a step: Phong with normal n = -gradient normalised, mirrored towards the viewer across the plane
// perpendicular to the view where it faces away, n' = n - 2 min(0, n.v) v, divided by its mean over light angles:
// mean 1. Isotropic (1) where the gradient vanishes: share of Phong g^2 / (g^2 + (kFlatness rho / sigma)^2). Along s,
// tau, opacity A and premultiplied reflectance P are smoothed by a periodic Gaussian of sigma * smoothing; stored is re
// = (P + kEmptyOpacity) / (A + kEmptyOpacity): straight, and 1 where there is nothing to see. Limit: the mean over the
// table's lights is the mean over all angles only while the lobe is wider than the spacing of lights (error .002 at
// exponent 8 and 32 lights; wrong beyond an exponent of about (lights / 2)^2 / 4).
#pragma once

#include <glm/vec2.hpp>

#include "pelage/data_schema/bake_settings.h"
#include "pelage/data_schema/hrir_record.h"
#include "pelage/db/density_grid.h"

namespace pelage {

/// |gradient| sigma / rho at which reflectance is half Phong, half isotropic: .05 sigma from a lone strand's centre.
inline constexpr double kFlatness = 0.05;
/// Opacity at which straight reflectance is half the sector's, half 1: well below what 8 bits of alpha show.
inline constexpr double kEmptyOpacity = 1e-4;
/// |cos| of the view angle below which a ray runs along the border.
inline constexpr double kGrazingCosine = 1e-6;
/// Share of a step by which steps may exceed half a cell, so that a float angle and the double that it stands for take
/// the same number of steps (a length of exactly 2 at 60 degrees, say).
inline constexpr double kStepSlack = 1e-3;

/// Mean over all light angles of kd max(0, cos) + ks max(0, cos)^p: kd / pi + ks Gamma((p+1)/2) / (2 sqrt(pi)
/// Gamma(p/2+1)).
double mean_phong(const PlanarPhong& phong);

/// Reflectance of a step of a ray, mean 1 over light angles.
class PlanarShading {
 public:
  explicit PlanarShading(const BakeSettings& settings)
      : phong_(settings.phong), mean_(mean_phong(settings.phong)), flat_(kFlatness / settings.sigma) {}

  /// At density `rho` with this gradient; `view` and `light` are unit vectors (s, r) towards viewer and light.
  double reflectance(double rho, glm::dvec2 gradient, glm::dvec2 view, glm::dvec2 light) const;

 private:
  PlanarPhong phong_;
  double mean_, flat_;
};

/// What one ray sees, before smoothing.
struct RayTrace {
  double tau = 0;            // unstopped, at c0
  double opacity = 0;        // accumulated until the early stop
  double premultiplied = 0;  // sum of weight times reflectance
};
RayTrace trace_ray_reference(const DensityGrid& grid, const BakeSettings& settings, const PlanarShading& shading,
                             double view_rad, double light_rad, double s);

HrirRecord trace_record_reference(const DensityGrid& grid, const BakeSettings& settings);

}  // namespace pelage
