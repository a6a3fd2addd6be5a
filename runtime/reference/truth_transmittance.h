// The truth of a shadow: footprint-averaged transmittance T* at points (NUMBERS.md, Shadows).
//
// T*(P) is the mean over M rays towards the light of (1 - a)^crossings, without the crossings of the point's own
// segment and its two neighbours. The rays start in a disc of radius r_f around P, across the direction to the light,
// and run parallel to it (directional light) or each to the light itself (point light). A footprint narrower than 4
// mean strand spacings aliases.
//
// Error bar. The M rays are kBatches independent, equally distributed sets, each well spread over the disc
// (sampling.h); the standard error is that of the mean of the batches' means, itself uncertain by 1 / sqrt(2 (kBatches
// - 1)) = 18 %. Well-spread rays leave a smaller error than independent ones (measured in tests/reference: see there).
#pragma once

#include <cstdint>
#include <functional>
#include <glm/vec3.hpp>
#include <span>
#include <vector>

#include "pelage/data_schema/scene.h"
#include "pelage/data_schema/strand_settings.h"
#include "pelage/reference/fibre_scene.h"

namespace pelage {

/// Independent sets of a point's rays; with fewer rays than that, each ray is a set.
inline constexpr int kTruthBatches = 16;

struct TruthPoint {
  glm::vec3 position{0};           // metres
  std::uint32_t owner = kNoOwner;  // vertex of Strands: its segment and the two neighbours cast no shadow on the point
};

struct TruthEstimate {
  double mean = 1;            // T*, [0, 1]
  double standard_error = 0;  // of `mean`; of a single ray it is unknown: 0.5, the most that a value in [0, 1] can have
};

/// What the rays may end at besides hair.
enum class HeadShadow { none, casts };  // the methods compared with have none

/// @param settings  rays, footprint_m, stop_below (T* of a point light is then too high by less than it; the rays of a
///                  directional light are traced together, which is faster than any stop)
/// @param seed      the result depends on it and on a point's index, not on the number of threads
/// @param progress  told the points done, by one thread at a time; may throw to interrupt
/// @throws UsageError for a light without a direction. T* of a point light at the point itself is 1.
std::vector<TruthEstimate> truth_transmittance(
    const FibreScene& scene, std::span<const TruthPoint> points, const Light& light, const TruthSettings& settings,
    std::uint64_t seed, const std::function<void(std::uint64_t done, std::uint64_t total)>& progress = {},
    HeadShadow head = HeadShadow::none);

}  // namespace pelage
