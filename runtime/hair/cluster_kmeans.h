// K-means of equally long feature rows [Lloyd 1982], seeded by k-means++ [Arthur and Vassilvitskii 2007] with a
// counter-based generator. The same clusters, bit for bit, for any number of threads: assignments are independent and
// every sum runs over its rows in ascending order.
#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

namespace pelage::hair {

struct Features {
  std::size_t dimensions = 0;
  std::vector<float> values;  // [row][dimension]

  std::size_t rows() const noexcept { return dimensions == 0 ? 0 : values.size() / dimensions; }
  const float* row(std::size_t i) const noexcept { return values.data() + i * dimensions; }
};

struct KMeans {
  Features centres;                   // [cluster][dimension]
  std::vector<std::uint32_t> labels;  // [row] its cluster; no cluster is empty
};

/// At most `clusters` (>= 1) of them: fewer where there are fewer distinct rows. Stops after `iterations` rounds.
KMeans k_means(const Features& features, int clusters, std::uint64_t seed, int iterations);

/// The `count` nearest centres of a row, nearest first (fewer where there are fewer).
std::vector<std::uint32_t> nearest_centres(const Features& centres, const float* row, std::size_t count);

}  // namespace pelage::hair
