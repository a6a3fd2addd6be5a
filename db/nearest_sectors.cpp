#include "pelage/db/nearest_sectors.h"

#include <algorithm>
#include <cmath>
#include <compare>
#include <flann/flann.hpp>
#include <numeric>
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

/// Points that are equal stand once in the tree, with their records in order: a tie among them needs no search, and
/// many equal ones cost no more than one.
struct NearestSectors::Index {
  std::vector<float> points;  // [record][dimension]
  std::size_t dimensions;
  std::vector<std::uint32_t> members;   // records, equal points together, in order of record
  std::vector<std::uint32_t> first_of;  // [different point + 1] into members
  std::vector<float> different;         // [different point][dimension]
  std::unique_ptr<flann::KDTreeSingleIndex<Distance>> tree;

  Index(std::vector<float> p, std::size_t n) : points(std::move(p)), dimensions(n) {
    gather_equal_points();
    tree = std::make_unique<flann::KDTreeSingleIndex<Distance>>(
        flann::Matrix<float>(different.data(), different.size() / n, n), flann::KDTreeSingleIndexParams());
    tree->buildIndex();
  }
  std::size_t size() const { return points.size() / dimensions; }
  std::size_t different_points() const { return first_of.size() - 1; }
  const float* point(std::size_t record) const { return points.data() + record * dimensions; }

 private:
  void gather_equal_points() {
    members.resize(size());
    std::iota(members.begin(), members.end(), 0U);
    const auto compare = [&](std::uint32_t a, std::uint32_t b) {
      return std::lexicographical_compare_three_way(point(a), point(a) + dimensions, point(b), point(b) + dimensions);
    };
    std::sort(members.begin(), members.end(), [&](std::uint32_t a, std::uint32_t b) {
      const auto order = compare(a, b);
      return order != 0 ? order < 0 : a < b;
    });
    for (std::size_t i = 0; i < members.size(); ++i) {
      if (i > 0 && compare(members[i - 1], members[i]) == 0) continue;
      first_of.push_back(static_cast<std::uint32_t>(i));
      different.insert(different.end(), point(members[i]), point(members[i]) + dimensions);
    }
    first_of.push_back(static_cast<std::uint32_t>(members.size()));
  }
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
  return {index_->point(record), index_->dimensions};
}

std::vector<Neighbour> NearestSectors::nearest(std::span<const float> query, int k) const {
  PELAGE_ASSERT(query.size() == index_->dimensions && k >= 1);
  const std::size_t wanted = std::min(static_cast<std::size_t>(k), size());
  const std::size_t all = index_->different_points();
  std::vector<std::size_t> ids;
  std::vector<float> distances;
  // As many different points as records are wanted suffice; more are asked for until a farther one ends the ties.
  for (std::size_t asked = std::min(wanted + 1, all);; asked = std::min(2 * asked, all)) {
    flann::KNNSimpleResultSet<float> result(asked);
    index_->tree->findNeighbors(result, query.data(), flann::SearchParams(flann::FLANN_CHECKS_UNLIMITED));
    if (result.size() < asked) return nearest_exhaustive(query, k);  // a distance beyond float
    ids.resize(asked);
    distances.resize(asked);
    result.copy(ids.data(), distances.data(), asked, true);
    if (asked == all || distances[asked - 1] > distances[std::min(wanted, asked) - 1]) break;
  }
  std::vector<Neighbour> found;
  for (std::size_t i = 0; i < ids.size(); ++i) {
    const std::uint32_t first = index_->first_of[ids[i]], end = index_->first_of[ids[i] + 1];
    const auto used = static_cast<std::uint32_t>(std::min<std::size_t>(end - first, wanted));
    for (std::uint32_t m = first; m < first + used; ++m) found.push_back({index_->members[m], distances[i]});
  }
  std::sort(found.begin(), found.end(), before);
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
