// Resampling: the same polyline, walked at even arc length. End points are kept exactly; corners between samples are
// cut, by at most the sagitta of the spacing.
#pragma once

#include <glm/vec3.hpp>
#include <span>
#include <vector>

#include "pelage/data_schema/strands.h"

namespace pelage::hair {

/// Length of a polyline [m].
double arc_length_m(std::span<const glm::vec3> points) noexcept;

/// `count` points (>= 2) at even arc length along the polyline `points` (>= 1 point). The first and last point are
/// those of the input, bit for bit.
std::vector<glm::vec3> resample_polyline(std::span<const glm::vec3> points, int count);

/// Every strand with `vertices_per_strand` (>= 2) vertices. Diameters are interpolated, colours kept.
/// @throws UsageError when vertices_per_strand < 2, or for more than 2^32 - 1 vertices in all
Strands resample(const Strands& strands, int vertices_per_strand);

/// Every strand with as many vertices as segments of at most `spacing_m` (> 0) need, evenly spaced.
/// @throws UsageError when spacing_m is not a positive number, or for more than 2^32 - 1 vertices in all
Strands resample_to_spacing(const Strands& strands, float spacing_m);

}  // namespace pelage::hair
