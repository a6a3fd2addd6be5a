// Strands made up for a hand-written cluster. Deterministic: a strand depends on (seed, its index) only, and no libm
// function is used, so that every CPU gives the same bits.
#pragma once

#include <cstdint>

#include "pelage/data_schema/cluster.h"

namespace pelage {

enum class StrandDistribution { uniform, shell };  // over the whole disk | beyond 0.6 of its radius

/// Appends `count` strands that run from t = 0 to 1 inside the unit disk, each with a slow wander of its own.
void append_procedural_strands(Cluster& cluster, std::size_t count, StrandDistribution distribution,
                               std::uint64_t seed);

}  // namespace pelage
