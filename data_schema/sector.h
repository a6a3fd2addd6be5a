// Sectors: the cells of a plate [Xu2006 section 3.2-3.3], in sector coordinates (s, r): s around, r outward, [0,1]
// inside.
//
// Neighbouring sectors of a ring overlap by half: sector k of n is centred at u_k = 2 pi (k + 1/2) / n and is
// 4 pi / n wide, s = 1/2 + (u - u_k) n / (4 pi). Maps blend the two sectors that cover a texel with a hat window, so a
// record's wrapped border always has weight 0 and no seam can show (DESIGN section 4: the march wraps in s).
// Layer j spans v in [v_j, v_j+1], v_j = core + (1 - core) j / layers;  r = (v - v_j) / (v_j+1 - v_j).
#pragma once

#include <cstddef>
#include <cstdint>
#include <glm/vec2.hpp>
#include <span>
#include <vector>

namespace pelage {

/// Strand crossings of one sector as (s, r). Those up to kSectorMargin outside [0,1]^2 are listed too: their Gaussians
/// reach in.
using SectorCrossings = std::span<const glm::vec2>;
inline constexpr float kSectorMargin = 0.35F;

/// Sectors of a hairstyle, track after track; a track is one (cluster, layer, sector around) and holds plates + 1
/// consecutive sectors from root to tip.
struct SectorSet {
  int plates = 0;                         // HSVs along a track; a track holds plates + 1 sectors
  std::vector<std::uint32_t> offsets{0};  // [sectors + 1] into crossings
  std::vector<glm::vec2> crossings;       // (s, r)
  std::vector<float> drift;  // [sectors] mean change of s from this sector to the next of its track; last: 0

  std::size_t size() const noexcept { return offsets.size() - 1; }
  std::size_t tracks() const noexcept { return plates == 0 ? 0 : size() / static_cast<std::size_t>(plates + 1); }
  SectorCrossings sector(std::size_t i) const noexcept {
    return {crossings.data() + offsets[i], crossings.data() + offsets[i + 1]};
  }
};

}  // namespace pelage
