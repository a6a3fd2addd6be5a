// Which sectors are baked: random ones (the generic database, [Xu2006 section 5.1]) or representatives of a hairstyle
// (the adapted database, DESIGN section 4).
#pragma once

#include <cstdint>
#include <glm/vec2.hpp>
#include <span>
#include <vector>

#include "pelage/data_schema/bake_settings.h"

namespace pelage {

/// Crossings of the index-th random sector; depends only on (settings.seed, settings.max_strands, index).
///
/// The number of strands inside [0,1]^2 is log-uniform in [1, max_strands]; the sector is uniform, clumped (1 to 4
/// clumps) or layered (a band in r), one third each. 2 kSectorMargin strands per strand inside lie beyond the borders
/// r = 0 and r = 1, at most kSectorMargin away, and reach in. In s the sector is a torus: strands within kSectorMargin
/// of one end are listed again beyond the other.
std::vector<glm::vec2> random_sector(const BakeSettings& settings, std::uint64_t index);

/// Indices, ascending, of at most `count` representative rows of scaled features [n][dimension]: k-means++ seeds, a few
/// Lloyd steps, then the member nearest to each centre. Fewer than `count` come back where there are fewer distinct
/// rows. The same for any number of threads and on any CPU. From more than 32,768 rows, evenly spaced ones are taken
/// (tracks are long and neighbours on them nearly equal). About 2 s for 1500 of 250,000 x 11 on two cores.
std::vector<std::uint32_t> representatives(std::span<const float> scaled_features, int dimension, int count,
                                           std::uint64_t seed);

}  // namespace pelage
