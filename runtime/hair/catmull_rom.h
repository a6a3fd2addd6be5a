// Smoothing: strands as Catmull-Rom curves through their vertices [Almeida2014; CatmullRom1974].
//
// Centripetal parameter (knots at the square root of the distance), so that uneven spacing makes neither cusps nor
// loops [YukselSchaeferKeyser2011]; at the ends the curve goes on as if mirrored at its end point. Vertices that
// coincide with the one before, within the rounding of their coordinates, are left out: they have no direction.
#pragma once

#include "pelage/data_schema/strands.h"

namespace pelage::hair {

/// Every segment in `pieces` [1, 32] parts; the vertices themselves stay, bit for bit. Diameters are interpolated,
/// colours kept. 1 piece: the same strands, as they are.
/// @throws UsageError for pieces out of range, or for more than 2^32 - 1 vertices in all
Strands smooth(const Strands& strands, int pieces);

}  // namespace pelage::hair
