// What each way to shadow hair costs and how far it is from the truth: T at points of a groom by every method, against
// the footprint-averaged, ray-traced T* [NUMBERS.md "Shadows"; DESIGN section 9].
#pragma once

#include <cstdint>
#include <functional>
#include <string>
#include <vector>

#include "pelage/data_schema/scene.h"
#include "pelage/reference/truth_transmittance.h"
#include "pelage/shadow/hair_shadow.h"

namespace pelage::app {

/// T* of one light at vertices drawn at random.
struct ShadowTruth {
  std::vector<glm::vec3> points;  // metres
  std::vector<TruthEstimate> estimates;
  double mean = 0, deviation = 0;  // of T* over the points
  double standard_error = 0;       // root mean square over the points: the part of an RMSE that is the truth's own
};

ShadowTruth shadow_truth(const Strands& strands, float opacity, const Light& light, const TruthSettings& settings,
                         std::size_t points, std::uint64_t seed,
                         const std::function<void(std::uint64_t, std::uint64_t)>& progress);

/// Of T - T*, over the points.
struct ShadowError {
  double rmse = 0, bias = 0, p99 = 0, max = 0;  // p99 and max of the absolute error
};

/// @throws std::invalid_argument unless both are as long
ShadowError shadow_error(const std::vector<float>& transmittance, const std::vector<TruthEstimate>& truth);

/// One line of the table: a method with its settings.
struct ShadowRow {
  std::string method, setting;
  Method how = Method::density_map;
  ShadowSettings settings;
};

/// The methods at the given resolutions: nothing, paper A as printed, corrected step by step (at the second finest
/// resolution) and corrected, opacity shadow maps, deep opacity maps.
std::vector<ShadowRow> shadow_rows(const ShadowSettings& base, std::vector<int> resolutions);

struct ShadowResult {
  ShadowError error;
  double build_ms = 0, fill_ms = 0, transmittance_ms = 0;  // medians
  double filter_ms = 0;                                    // of all vertices of the groom
  double spread_ms = 0;                                    // of build + filter: half the distance between quartiles
  std::size_t bytes = 0;
};

/// Builds the row's map `repeats` times, reads it at all vertices and at the truth's points.
ShadowResult measure_shadow(const ShadowRow& row, const Strands& strands, float opacity, const Light& light,
                            const ShadowTruth& truth, int repeats);

}  // namespace pelage::app
