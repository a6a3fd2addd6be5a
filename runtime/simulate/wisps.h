// Wisps: about a hundred, three simulated guides each, and the strands between them interpolated [Bertails2005 section
// 4.1].
//
// A strand's carrier is the weighted mean of its wisp's guides, taken at the same shares of their lengths and moved to
// the strand's own root; what the strand is more than that at rest rides on the carrier's frames, and its segments then
// get their lengths back, from the root on: roots stay on the scalp, lengths are kept however guides part. Guides are
// carried along as they are.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <glm/ext/quaternion_double.hpp>
#include <span>
#include <vector>

#include "pelage/data_schema/strands.h"
#include "pelage/simulate/riders.h"

namespace pelage {

/// Guides of a strand, as indices into Wisps::guides(), and their weights: >= 0, sum 1. A guide has itself alone.
struct Guidance {
  std::array<std::uint32_t, 3> guide{};
  std::array<float, 3> weight{};
};

class Wisps {
 public:
  Wisps() = default;
  /// Groups centre lines at rest by root and shape and picks three guides of each group: the strands nearest to the
  /// centres of its three parts; of a group of fewer than three strands all. Strands without vertices have no guides.
  /// @throws UsageError for wisps < 1, InputError for a line that is not finite
  Wisps(const Strands& lines, int wisps);

  /// The guides' lines at rest, to be simulated.
  const Strands& guides() const noexcept { return guides_; }
  std::span<const Guidance> guidance() const noexcept { return guidance_; }

  /// Lines of all strands from those of the guides: `out` is laid out as the lines that the wisps were made of. A line
  /// at rest is given back to rounding when the guides are at rest.
  void interpolate(const Strands& guides, const glm::dquat& turn, Strands& out) const;

 private:
  void carrier(const Strands& guides, std::size_t strand, const glm::vec3& to_root, std::span<glm::vec3> line) const;

  Strands guides_;
  std::vector<Guidance> guidance_;  // [strands]
  Riders riders_;                   // strands on their carriers, vertex by vertex
  std::vector<glm::vec3> to_root_;  // [strands] from the mean of the guides' roots, head's axes
  std::vector<float> segment_m_;    // [vertices] from the vertex before
};

}  // namespace pelage
