// The oracle of FibreScene on small scenes: every ray against every segment, in double, by other arithmetic. Definition
// of a crossing: fibre_scene.h.
#pragma once

#include <cstdint>
#include <vector>

#include "pelage/data_schema/strands.h"
#include "pelage/reference/fibre_scene.h"

namespace pelage {

/// Depths of all crossings of the ray, ascending, without those of the owner's segment and its two neighbours.
std::vector<double> brute_force_crossings(const Strands& strands, const FibreRay& ray, std::uint32_t owner = kNoOwner);

}  // namespace pelage
