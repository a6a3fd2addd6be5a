// How far strands are from the same strands in another state: distances between their places.
#pragma once

#include <span>
#include <vector>

#include "pelage/data_schema/strands.h"

namespace pelage::app {

/// Appends distances [m] vertex by vertex; where curls or detail give strands vertices of their own, at evenly spaced
/// shares of their length.
void add_distances(const Strands& a, const Strands& b, std::vector<float>& distances_m);

/// Of distances: root mean square, 99th percentile, greatest [mm]; 0 of none.
double rms_mm(std::span<const float> distances_m);
double p99_mm(std::span<const float> distances_m);
double max_mm(std::span<const float> distances_m);
double rms_mm(const Strands& a, const Strands& b);

}  // namespace pelage::app
