// How dark can hair make itself? A bound of the optical depth that any map of hair for one parallel light can hold,
// found without building one. DESIGN section 8: no cell denser than epsilon, no shadow map.
//
// Hair is deposited into square columns along the light, as wide as a cell of the map. A map's own columns may lie
// between these, and may spread what they receive over two cells a side: what one of them holds lies within three by
// three of the columns here. So no map with these cells or larger holds more than the greatest sum over three by three.
#pragma once

#include "pelage/data_schema/scene.h"
#include "pelage/data_schema/strands.h"

namespace pelage {

/// Optical depth of a D len sin(segment, light) of area per cell, summed along the light: an upper bound, >= 0.
/// @param resolution  cells along the longest side of the hair's box
/// @param enough      the search ends at the first sum above it, which is returned: dense hair is recognised at once
/// @throws InputError as make_shadow() does; for a point light, which has no columns: UsageError
float greatest_depth(const Strands& strands, float opacity, const Light& light, int resolution, float enough);

}  // namespace pelage
