// Density features: what describes a sector to the search of the HRIR-DB [Xu2006 section 5.2].
//
//   paper3     mean density, mean s, mean r
//   moments5   the same and the standard deviations of s and r
//   profile11  mean density, 5 cosine coefficients of the projection on s, 5 of that on r
// "Average of the histogram" read literally gives the mean density three times; it is read as the mean of the
// distribution (DESIGN section 4). Features describe count and arrangement of strands, not the fibre's width (that is
// the optical scale c). All are finite for every density; an empty sector has means 1/2 and the spreads of a uniform
// one, and a nearly empty one (less than about 0.001 strands) blends into it. Cosine coefficient k of a projection p is
// mean_i p_i cos(pi k (i + 1/2) / N), of the density itself: it is linear in the strands.
// Density and positions differ in unit, so the search works on features scaled to unit variance; the scale is fitted to
// the baked sectors and stored in the database.
#pragma once

#include <cstddef>
#include <span>
#include <vector>

#include "pelage/data_schema/bake_settings.h"
#include "pelage/db/density_grid.h"

namespace pelage {

inline constexpr int kMaxDimension = 11;

int dimension(FeatureSet set) noexcept;

/// Writes dimension(set) features.
void density_features(const Projections& projections, FeatureSet set, std::span<float> out);

/// Features of all sectors, [sector][dimension]; on all threads that TBB offers, the same bits for any number.
std::vector<float> density_features(const SectorSet& sectors, FeatureSet set, int grid, double sigma);

/// x -> (x - mean) inv_sigma per dimension. A dimension that does not vary has inv_sigma = 0: it cannot tell sectors
/// apart.
struct FeatureScale {
  std::vector<double> mean, inv_sigma;  // [dimension]

  /// Scales [n][dimension] features in place.
  void apply(std::span<float> features) const noexcept;
};
/// Fits the scale to `features` [n][dimension], n >= 1.
FeatureScale fit_scale(std::span<const float> features, int dimension);

}  // namespace pelage
