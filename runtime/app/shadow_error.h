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
  // Standard error of `rmse` (delta method: s.d. of the squared errors / (2 rmse sqrt(n))) and, added in squares, what
  // the truth's own error puts on it: its mean square / (2 rmse).
  double rmse_error = 0;
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
  std::vector<double> sum_ms;                              // build + filter of each repetition
  std::size_t bytes = 0;
};

/// How often something is measured: at least so often, then until so much time has passed or it was often enough.
struct Repeats {
  int least = 3, most = 1000;
  double within_ms = 1000;
};

/// Builds the row's map once to warm up and then repeatedly, reads it at all vertices and at the truth's points.
ShadowResult measure_shadow(const ShadowRow& row, const Strands& strands, float opacity, const Light& light,
                            const ShadowTruth& truth, const Repeats& repeats);

}  // namespace pelage::app
