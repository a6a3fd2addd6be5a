// Sectors of a hairstyle: which strands cross which sector, where, and how sector coordinates map to the plate plane.
// [Xu2006 sections 3.2, 3.3]; layout and overlap of sectors: data_schema/sector.h.
#pragma once

#include <glm/mat2x2.hpp>
#include <glm/vec2.hpp>
#include <span>
#include <vector>

#include "pelage/data_schema/hairstyle.h"
#include "pelage/data_schema/sector.h"

namespace pelage {

/// Sectors around layer j: `division.sectors` in the outermost layer, fewer further in so that sectors keep their
/// aspect; at least 3.
int sectors_in_layer(const Division& division, int layer) noexcept;

/// Radius v of the inner (layer) and outer (layer + 1) surface of a layer: core + (1 - core) layer / layers.
float layer_radius(const Division& division, int surface) noexcept;

/// Tracks of one cluster: sum of sectors_in_layer over its layers.
int tracks_per_cluster(const Division& division) noexcept;

/// Jacobian d(plate plane)/d(s, r) [m] at the middle of sector k of a layer, for a plate with cross-section S.
/// Columns: d/ds, d/dr. The determinant is negative (s, r is left-handed about the tangent).
glm::mat2 sector_jacobian(const Division& division, int layer, int sector, const CrossSection& s) noexcept;

/// Direction angle [rad] from outward r, positive towards +s, of a plate-plane direction d in sector coordinates:
/// atan2 of J^-1 d.
float sector_angle(const glm::mat2& jacobian, glm::vec2 d) noexcept;

/// All sectors of the clusters, tracks ordered [cluster][layer][sector]. Crossings beyond the envelope (v > 1) and in
/// the core are moved to its border, so that no strand is lost.
SectorSet sectors_of(std::span<const Cluster> clusters, const Division& division);

}  // namespace pelage
