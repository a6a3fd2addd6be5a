// SatfModel: a hairstyle made ready for re/alpha/s-maps: its instances in the world, its sectors, and where each map
// lies. Built once per hairstyle, placed anew when its clusters move; frames only read it. [Xu2006 sections 3, 6]
#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

#include "pelage/data_schema/bake_settings.h"
#include "pelage/data_schema/hairstyle.h"
#include "pelage/db/record_source.h"
#include "pelage/db/sectors.h"

namespace pelage {

/// One drawn copy of a cluster, in world space.
struct Instance {
  std::uint32_t cluster;
  SweptCluster swept;
};

/// One instance per cluster and transform (rotation, translation, uniform scale; the mean scale counts).
std::vector<Instance> instances_of(const Hairstyle& style);

/// Where texels lie: [instance][layer][plate][x]. A ring of n sectors has n * samples / 2 texels around: texel x at
/// u = 2 pi (x + 1/2) / width. Row i belongs to plate i.
struct MapLayout {
  int rows = 0;                      // plates + 1
  std::vector<int> widths;           // [layer] texels around
  std::vector<std::size_t> offsets;  // [layer] first texel of the layer within an instance
  std::size_t texels_per_instance = 0;

  std::size_t texel(std::size_t instance, int layer, int row) const noexcept {
    const auto j = static_cast<std::size_t>(layer);
    return instance * texels_per_instance + offsets[j] +
           static_cast<std::size_t>(row) * static_cast<std::size_t>(widths[j]);
  }
};

/// cos and sin of u at the texels of one layer.
struct RingTable {
  std::vector<float> cos_u, sin_u;  // [width]
};

struct SatfModel {
  Division division;
  float blocked_width_m = 0;  // a D
  float profile_sigma = 0;    // standard deviation of a strand's profile in a record, in s (Gaussian and smoothing)
  float max_path = 0;         // longest march of a record, in units of a sector's height
  int samples = 0;            // of a record along s; a multiple of 4
  std::vector<Instance> instances;
  std::vector<std::uint32_t> strands_at;  // [cluster][plate] strands that cross the plate
  std::vector<float> mass_per_area;       // [instance][plate][layer] optical mass M of a strand over det S [1/m]
  std::vector<std::uint32_t> track_of;    // [layer] first track of the layer within a cluster, then their number
  SectorSet sectors;                      // tracks [cluster][layer][sector]
  MapLayout layout;
  std::vector<RingTable> rings;  // [layer]

  std::size_t texels() const noexcept { return instances.size() * layout.texels_per_instance; }
  /// First sector of a track's run of plates + 1.
  std::size_t track(std::size_t instance, int layer, int sector) const noexcept;
};

/// @throws InputError when `samples` is not a multiple of 4 or the division is out of range
SatfModel make_model(const Hairstyle& style, const BakeSettings& bake, int samples);

/// What depends on where clusters are, not on what is in them: instances, and their masses if they have grown. For
/// clusters that have moved since make_model() and hold the same strands: sectors and all that was looked up for them
/// stay.
void place_model(const Hairstyle& style, SatfModel& model);

}  // namespace pelage
