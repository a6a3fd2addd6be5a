// Harness of the reader of bone weights.
#include <cmath>
#include <numeric>

#include "harness.h"
#include "pelage/hair/tfx_bone.h"

namespace pelage::fuzz {

void read_tfxbone(std::string_view bytes) {
  const auto bones = accepted([&] { return hair::parse_tfxbone(std::as_bytes(std::span(bytes)), "fuzz.tfxbone"); });
  if (!bones) return;
  for (const hair::StrandBones& strand : bones->strands) {
    for (std::size_t k = 0; k < strand.bones.size(); ++k) {
      require(strand.weights[k] >= 0 && std::isfinite(strand.weights[k]), "weights are numbers >= 0");
      require(strand.weights[k] == 0 || strand.bones[k] < bones->names.size(), "a weight names a bone");
    }
    // Four roundings of values up to 1.
    const float sum = std::accumulate(strand.weights.begin(), strand.weights.end(), 0.0F);
    require(std::abs(sum - 1.0F) < 1e-6F, "weights sum to 1");
  }
  for (const std::size_t strand : bones->repaired) require(strand < bones->strands.size(), "a repair names a strand");
}

}  // namespace pelage::fuzz
