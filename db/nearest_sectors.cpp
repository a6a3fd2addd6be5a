#include "pelage/db/nearest_sectors.h"

#include <algorithm>
#include <cmath>
#include <flann/flann.hpp>
#include <string>

#include "pelage/data_schema/errors.h"

namespace pelage {
namespace {

using Distance = flann::L2_Simple<float>;

float distance_sq(const float* a, const float* b, std::size_t n) {
  float sum = 0;
  for (std::size_t i = 0; i < n; ++i) sum += (a[i] - b[i]) * (a[i] - b[i]);
  return sum;
}

bool before(const Neighbour& a, const Neighbour& b) {
  return a.distance_sq != b.distance_sq ? a.distance_sq < b.distance_sq : a.record < b.record;
}

}  // namespace

struct NearestSectors::Index {
  std::vector<float> points;
  std::size_t dimensions;
  flann::KDTreeSingleIndex<Distance> tree;

  Index(std::vector<float> p, std::size_t n)
      : points(std::move(p)),
        dimensions(n),
        tree(flann::Matrix<float>(points.data(), points.size() / n, n), flann::KDTreeSingleIndexParams()) {
    tree.buildIndex();
  }
  std::size_t size() const { return points.size() / dimensions; }
};

NearestSectors::NearestSectors(std::vector<float> points, int dimensions) {
  if (dimensions < 1 || points.empty() || points.size() % static_cast<std::size_t>(dimensions) != 0) {
    throw UsageError("a search among " + std::to_string(points.size()) + " numbers as points of " +
                     std::to_string(dimensions) + " dimensions: at least one whole point is needed");
  }
  const auto bad = std::find_if(points.begin(), points.end(), [](float v) { return !std::isfinite(v); });
  if (bad != points.end()) {
    const auto record = (bad - points.begin()) / dimensions;
    throw InputError("record " + std::to_string(record), "a feature is not finite");
  }
  index_ = std::make_unique<Index>(std::move(points), static_cast<std::size_t>(dimensions));
}

NearestSectors::~NearestSectors() = default;
NearestSectors::NearestSectors(NearestSectors&&) noexcept = default;

std::size_t NearestSectors::size() const noexcept {
  return index_->size();
}
int NearestSectors::dimensions() const noexcept {
  return static_cast<int>(index_->dimensions);
}

std::span<const float> NearestSectors::point(std::size_t record) const noexcept {
  return {index_->points.data() + record * index_->dimensions, index_->dimensions};
}

std::vector<Neighbour> NearestSectors::nearest(std::span<const float> query, int k) const {
  PELAGE_ASSERT(query.size() == index_->dimensions && k >= 1);
  const std::size_t wanted = std::min(static_cast<std::size_t>(k), size());
  const std::size_t asked = std::min(wanted + 1, size());  // one more shows a tie at the border
  flann::KNNSimpleResultSet<float> result(asked);
  index_->tree.findNeighbors(result, query.data(), flann::SearchParams(flann::FLANN_CHECKS_UNLIMITED));
  std::vector<std::size_t> ids(asked);
  std::vector<float> distances(asked);
  result.copy(ids.data(), distances.data(), asked, true);
  std::vector<Neighbour> found(asked);
  for (std::size_t i = 0; i < asked; ++i) found[i] = {static_cast<std::uint32_t>(ids[i]), distances[i]};
  std::sort(found.begin(), found.end(), before);
  if (asked > wanted && found[wanted].distance_sq == found[wanted - 1].distance_sq) return nearest_exhaustive(query, k);
  found.resize(wanted);
  return found;
}

std::vector<Neighbour> NearestSectors::nearest_exhaustive(std::span<const float> query, int k) const {
  PELAGE_ASSERT(query.size() == index_->dimensions && k >= 1);
  std::vector<Neighbour> all(size());
  for (std::size_t i = 0; i < size(); ++i) {
    all[i] = {static_cast<std::uint32_t>(i), distance_sq(query.data(), point(i).data(), query.size())};
  }
  const std::size_t wanted = std::min(static_cast<std::size_t>(k), size());
  std::partial_sort(all.begin(), all.begin() + static_cast<std::ptrdiff_t>(wanted), all.end(), before);
  all.resize(wanted);
  return all;
}

}  // namespace pelage
