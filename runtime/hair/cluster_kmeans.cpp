#include "pelage/hair/cluster_kmeans.h"

#include <Random123/philox.h>
#include <tbb/blocked_range.h>
#include <tbb/parallel_for.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <numeric>

namespace pelage::hair {
namespace {

/// Uniform in [0, 1), 32 bits: a function of seed and step alone.
double uniform(std::uint64_t seed, std::uint32_t step) {
  r123::Philox4x32 generator;
  const r123::Philox4x32::ctr_type counter{{step, 0, 0, 0}};
  const r123::Philox4x32::key_type key{{static_cast<std::uint32_t>(seed), static_cast<std::uint32_t>(seed >> 32)}};
  return generator(counter, key)[0] * 0x1p-32;
}

float distance_squared(const float* a, const float* b, std::size_t n) {
  float sum = 0;
  for (std::size_t i = 0; i < n; ++i) sum += (a[i] - b[i]) * (a[i] - b[i]);
  return sum;
}

/// Calls `body(i)` for every row on all threads.
template <class Body>
void for_rows(std::size_t rows, const Body& body) {
  tbb::parallel_for(tbb::blocked_range<std::size_t>(0, rows, 256), [&](const tbb::blocked_range<std::size_t>& range) {
    for (std::size_t i = range.begin(); i < range.end(); ++i) body(i);
  });
}

/// Index at which the running sum of `weights` passes `share` of the total; the last positive one at the latest.
std::size_t pick(const std::vector<float>& weights, double share) {
  double total = 0;
  for (const float w : weights) total += static_cast<double>(w);
  double sum = 0;
  std::size_t last = 0;
  for (std::size_t i = 0; i < weights.size(); ++i) {
    if (!(weights[i] > 0)) continue;
    last = i;
    sum += static_cast<double>(weights[i]);
    if (sum > share * total) break;
  }
  return last;
}

/// k-means++: each next centre is a row drawn with probability proportional to its squared distance from those before.
Features seed_centres(const Features& features, int clusters, std::uint64_t seed) {
  const std::size_t dims = features.dimensions;
  std::vector<float> distance(features.rows(), 1.0F);
  Features centres{dims, {}};
  for (int k = 0; k < clusters; ++k) {
    const float* centre = features.row(pick(distance, uniform(seed, static_cast<std::uint32_t>(k))));
    centres.values.insert(centres.values.end(), centre, centre + dims);
    for_rows(features.rows(), [&](std::size_t i) {
      const float d = distance_squared(features.row(i), centre, dims);
      distance[i] = k == 0 ? d : std::min(distance[i], d);
    });
  }
  return centres;
}

/// [dimension][cluster]: the search for the nearest centre runs along clusters, a loop that vectorises.
std::vector<float> transposed(const Features& centres) {
  std::vector<float> out(centres.values.size());
  for (std::size_t k = 0; k < centres.rows(); ++k) {
    for (std::size_t d = 0; d < centres.dimensions; ++d) out[d * centres.rows() + k] = centres.row(k)[d];
  }
  return out;
}

void assign(const Features& features, const Features& centres, std::vector<std::uint32_t>& labels) {
  const std::vector<float> by_dimension = transposed(centres);
  const std::size_t n = centres.rows();
  tbb::parallel_for(tbb::blocked_range<std::size_t>(0, features.rows(), 64),
                    [&](const tbb::blocked_range<std::size_t>& range) {
                      std::vector<float> distance(n);
                      for (std::size_t i = range.begin(); i < range.end(); ++i) {
                        std::fill(distance.begin(), distance.end(), 0.0F);
                        for (std::size_t d = 0; d < features.dimensions; ++d) {
                          const float x = features.row(i)[d];
                          const float* c = by_dimension.data() + d * n;
                          for (std::size_t k = 0; k < n; ++k) distance[k] += (x - c[k]) * (x - c[k]);
                        }
                        const auto nearest = std::min_element(distance.begin(), distance.end());
                        labels[i] = static_cast<std::uint32_t>(nearest - distance.begin());
                      }
                    });
}

/// Mean of each cluster's rows; an empty cluster keeps its centre.
void update_centres(const Features& features, const std::vector<std::uint32_t>& labels, Features& centres) {
  const std::size_t dims = features.dimensions;
  std::vector<double> sums(centres.values.size(), 0.0);
  std::vector<std::size_t> members(centres.rows(), 0);
  for (std::size_t i = 0; i < features.rows(); ++i) {
    ++members[labels[i]];
    for (std::size_t d = 0; d < dims; ++d) sums[labels[i] * dims + d] += static_cast<double>(features.row(i)[d]);
  }
  for (std::size_t k = 0; k < centres.rows(); ++k) {
    for (std::size_t d = 0; d < dims && members[k] > 0; ++d) {
      centres.values[k * dims + d] = static_cast<float>(sums[k * dims + d] / static_cast<double>(members[k]));
    }
  }
}

void drop_empty(KMeans& result) {
  constexpr std::uint32_t kEmpty = std::numeric_limits<std::uint32_t>::max();
  const std::size_t dims = result.centres.dimensions;
  std::vector<std::uint32_t> renamed(result.centres.rows(), kEmpty);
  for (const std::uint32_t label : result.labels) renamed[label] = 0;
  std::uint32_t next = 0;
  for (std::size_t k = 0; k < renamed.size(); ++k) {
    if (renamed[k] == kEmpty) continue;
    std::copy_n(result.centres.row(k), dims, result.centres.values.data() + next * dims);
    renamed[k] = next++;
  }
  result.centres.values.resize(next * dims);
  for (std::uint32_t& label : result.labels) label = renamed[label];
}

}  // namespace

KMeans k_means(const Features& features, int clusters, std::uint64_t seed, int iterations) {
  KMeans result{seed_centres(features, clusters, seed), std::vector<std::uint32_t>(features.rows(), 0)};
  assign(features, result.centres, result.labels);
  for (int i = 0; i < iterations; ++i) {
    update_centres(features, result.labels, result.centres);
    const std::vector<std::uint32_t> before = result.labels;
    assign(features, result.centres, result.labels);
    if (before == result.labels) break;
  }
  drop_empty(result);
  return result;
}

std::vector<std::uint32_t> nearest_centres(const Features& centres, const float* row, std::size_t count) {
  std::vector<float> distance(centres.rows());
  for (std::size_t k = 0; k < distance.size(); ++k) {
    distance[k] = distance_squared(centres.row(k), row, centres.dimensions);
  }
  std::vector<std::uint32_t> order(distance.size());
  std::iota(order.begin(), order.end(), 0U);
  count = std::min(count, order.size());
  std::partial_sort(
      order.begin(), order.begin() + static_cast<std::ptrdiff_t>(count), order.end(),
      [&](std::uint32_t a, std::uint32_t b) { return distance[a] != distance[b] ? distance[a] < distance[b] : a < b; });
  order.resize(count);
  return order;
}

}  // namespace pelage::hair
