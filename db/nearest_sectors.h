// Nearest records in feature space: FLANN's exact single kd-tree with plain L2 [Muja2009]. Measured faster and exact
// against its randomised forest in 3-11 dimensions (DESIGN section 4). Equal distances are ordered by record.
#pragma once

#include <cstdint>
#include <memory>
#include <span>
#include <vector>

namespace pelage {

struct Neighbour {
  std::uint32_t record;
  float distance_sq;  // in scaled features
  bool operator==(const Neighbour&) const = default;
};

class NearestSectors {
 public:
  /// @param points  [record][dimension], finite       @throws UsageError without a point, InputError when not finite
  NearestSectors(std::vector<float> points, int dimensions);
  ~NearestSectors();
  NearestSectors(NearestSectors&&) noexcept;

  std::size_t size() const noexcept;
  int dimensions() const noexcept;
  std::span<const float> point(std::size_t record) const noexcept;

  /// The min(k, size()) nearest, by (distance, record). k >= 1. Thread-safe.
  std::vector<Neighbour> nearest(std::span<const float> query, int k) const;
  /// The same by looking at every point: the test oracle, and the way out of ties.
  std::vector<Neighbour> nearest_exhaustive(std::span<const float> query, int k) const;

 private:
  struct Index;
  std::unique_ptr<Index> index_;
};

}  // namespace pelage
