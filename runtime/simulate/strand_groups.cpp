#include "pelage/simulate/strand_groups.h"

#include <algorithm>
#include <cstddef>
#include <limits>

#include "pelage/simulate/for_strands.h"

namespace pelage {
namespace {

constexpr std::size_t kSampledRows = 10'000, kSampledPerGroup = 8;
constexpr int kRounds = 10;

/// In [0, 1), of a counter.
double uniform(std::uint64_t counter) noexcept {
  std::uint64_t z = (counter + 1) * 0x9E3779B97F4A7C15U;  // splitmix64
  z = (z ^ (z >> 30)) * 0xBF58476D1CE4E5B9U;
  z = (z ^ (z >> 27)) * 0x94D049BB133111EBU;
  return static_cast<double>((z ^ (z >> 31)) >> 11) * 0x1p-53;
}

std::vector<StrandFeature> sample_of(std::span<const StrandFeature> rows, std::size_t groups) {
  const std::size_t n = std::min(rows.size(), std::max(kSampledRows, kSampledPerGroup * groups));
  std::vector<StrandFeature> sample(n);
  for (std::size_t i = 0; i < n; ++i) sample[i] = rows[i * rows.size() / n];
  return sample;
}

/// Centres far from each other: each next one drawn by squared distance to those before.
std::vector<StrandFeature> seeds_of(std::span<const StrandFeature> rows, std::size_t groups) {
  std::vector<StrandFeature> centres;
  centres.reserve(groups);
  centres.push_back(rows[0]);
  std::vector<float> nearest(rows.size(), std::numeric_limits<float>::max());
  while (centres.size() < groups) {
    for_strands(rows.size(), [&](std::size_t begin, std::size_t end) {
      for (std::size_t i = begin; i < end; ++i) nearest[i] = std::min(nearest[i], distance2(rows[i], centres.back()));
    });
    double sum = 0;
    for (const float d : nearest) sum += static_cast<double>(d);
    double left = uniform(centres.size()) * sum;
    std::size_t chosen = 0;
    for (std::size_t i = 0; i < rows.size(); ++i) {
      if (!(nearest[i] > 0)) continue;
      chosen = i;
      left -= static_cast<double>(nearest[i]);
      if (left < 0) break;
    }
    if (!(nearest[chosen] > 0)) break;  // all rows are centres
    centres.push_back(rows[chosen]);
  }
  return centres;
}

std::vector<std::uint32_t> labels_of(std::span<const StrandFeature> rows, std::span<const StrandFeature> centres) {
  std::vector<std::uint32_t> label(rows.size());
  for_strands(rows.size(), [&](std::size_t begin, std::size_t end) {
    for (std::size_t i = begin; i < end; ++i) {
      float least = std::numeric_limits<float>::max();
      for (std::size_t c = 0; c < centres.size(); ++c) {
        const float d = distance2(rows[i], centres[c]);
        if (d < least) least = d, label[i] = static_cast<std::uint32_t>(c);
      }
    }
  });
  return label;
}

/// Centres without rows stay where they are.
void move_to_means(std::span<const StrandFeature> rows, std::span<const std::uint32_t> label,
                   std::vector<StrandFeature>& centres) {
  struct Sum {
    std::array<double, 9> of{};
    double rows = 0;
  };
  std::vector<Sum> sums(centres.size());
  for (std::size_t i = 0; i < rows.size(); ++i) {
    Sum& sum = sums[label[i]];
    sum.rows += 1;
    for (std::size_t k = 0; k < 9; ++k) sum.of[k] += static_cast<double>(rows[i][k]);
  }
  for (std::size_t c = 0; c < centres.size(); ++c) {
    if (!(sums[c].rows > 0)) continue;
    for (std::size_t k = 0; k < 9; ++k) centres[c][k] = static_cast<float>(sums[c].of[k] / sums[c].rows);
  }
}

}  // namespace

StrandFeature strand_feature(std::span<const glm::vec3> strand) noexcept {
  const std::size_t last = strand.size() - 1;
  const glm::vec3 root = strand[0], middle = 0.5F * (strand[last / 2] + strand[last - last / 2]), tip = strand[last];
  return {root.x, root.y, root.z, middle.x, middle.y, middle.z, tip.x, tip.y, tip.z};
}

float distance2(const StrandFeature& a, const StrandFeature& b) noexcept {
  float sum = 0;
  for (std::size_t k = 0; k < 9; ++k) sum += (a[k] - b[k]) * (a[k] - b[k]);
  return sum;
}

StrandGroups group_strands(std::span<const StrandFeature> rows, int groups) {
  if (rows.empty()) return {};
  const auto most = static_cast<std::size_t>(std::max(groups, 1));
  const std::vector<StrandFeature> sample = sample_of(rows, most);
  StrandGroups out;
  out.centres = seeds_of(sample, most);
  for (int round = 0; round < kRounds; ++round) {
    out.label = labels_of(sample, out.centres);
    move_to_means(sample, out.label, out.centres);
  }
  out.label = labels_of(rows, out.centres);
  return out;
}

}  // namespace pelage
