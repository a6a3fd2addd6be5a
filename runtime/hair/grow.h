// Strands of a chosen length on a head mesh [Almeida2014 section 4]: straight out of the skin, then bent down by
// gravity and combed off the face, always outside of the mesh. A sane start for the simulation, not a style.
#pragma once

#include <cstdint>
#include <vector>

#include "pelage/data_schema/strands.h"
#include "pelage/hair/mesh_roots.h"

namespace pelage::hair {

struct GrowSettings {
  float length_m = 0.25F;  // [0.005, 2]; strands differ by up to 5 % from it
  int vertices = 16;       // per strand, [2, 1000], evenly spaced
  std::uint64_t seed = 1;
};

/// One strand for each root; the same for any number of threads. Roots lie on the mesh, all other vertices outside.
/// @throws UsageError for settings out of range
Strands grow(const std::vector<Root>& roots, const Skull& skull, const DistanceField& field,
             const GrowSettings& settings);

}  // namespace pelage::hair
