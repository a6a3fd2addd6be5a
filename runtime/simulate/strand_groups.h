// Private to this box: k-means [Lloyd 1982] of strands by root, middle and tip, seeded by k-means++ [Arthur and
// Vassilvitskii 2007]. The same groups, bit for bit, for any number of threads: assignments are independent, every sum
// runs over its rows in ascending order.
#pragma once

#include <array>
#include <cstdint>
#include <span>
#include <vector>

#include "pelage/data_schema/strands.h"

namespace pelage {

using StrandFeature = std::array<float, 9>;  // root, middle, tip [m]

StrandFeature strand_feature(std::span<const glm::vec3> strand) noexcept;
float distance2(const StrandFeature& a, const StrandFeature& b) noexcept;

struct StrandGroups {
  std::vector<StrandFeature> centres;
  std::vector<std::uint32_t> label;  // [row] its nearest centre; not every centre need have a row
};

/// At most `groups` (>= 1) of them, fewer where there are fewer distinct rows. Time: rows x groups; centres of many
/// rows come from an even sample of them.
StrandGroups group_strands(std::span<const StrandFeature> rows, int groups);

}  // namespace pelage
