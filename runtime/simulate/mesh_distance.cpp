#include "pelage/simulate/mesh_distance.h"

#include <tbb/blocked_range.h>
#include <tbb/parallel_for.h>

#include <algorithm>
#include <cmath>
#include <glm/common.hpp>
#include <glm/geometric.hpp>
#include <glm/vector_relational.hpp>
#include <limits>

#include "pelage/data_schema/errors.h"
#include "pelage/simulate/lane_loops.h"
#include "pelage/simulate/signed_triangles.h"

namespace pelage {
namespace {

using glm::dvec3;
using glm::ivec3;
using glm::vec3;

constexpr double kInfinity = std::numeric_limits<double>::infinity();
constexpr int kBandCells = 2;
constexpr float kPad_m = 0.02F;
constexpr int kPadCells = 3;
constexpr int kBlockBits = 2, kBlock = 1 << kBlockBits;  // cells per side
constexpr float kNowhere_m = 1e6F;
constexpr std::uint32_t kNone = 0xFFFFFFFFU;
constexpr std::size_t kGrain = 512;  // nodes per task

struct GridShape {
  dvec3 origin_m;
  double cell_m;
  ivec3 size;

  std::size_t nodes() const noexcept {
    return static_cast<std::size_t>(size.x) * static_cast<std::size_t>(size.y) * static_cast<std::size_t>(size.z);
  }
  std::size_t index(const ivec3& n) const noexcept {
    return (static_cast<std::size_t>(n.z) * static_cast<std::size_t>(size.y) + static_cast<std::size_t>(n.y)) *
               static_cast<std::size_t>(size.x) +
           static_cast<std::size_t>(n.x);
  }
  ivec3 node(std::size_t i) const noexcept {
    const auto x = static_cast<std::size_t>(size.x), y = static_cast<std::size_t>(size.y);
    return {static_cast<int>(i % x), static_cast<int>(i / x % y), static_cast<int>(i / (x * y))};
  }
  bool holds(const ivec3& n) const noexcept {
    return n.x >= 0 && n.y >= 0 && n.z >= 0 && n.x < size.x && n.y < size.y && n.z < size.z;
  }
  dvec3 place(const ivec3& n) const noexcept { return origin_m + cell_m * dvec3(n); }
};

struct Box {
  dvec3 low{kInfinity}, high{-kInfinity};
};

Box box_of(const SignedTriangles& triangles, std::size_t t) {
  Box box;
  for (std::size_t k = 0; k < 3; ++k) {
    box.low = glm::min(box.low, triangles.corner(t, k));
    box.high = glm::max(box.high, triangles.corner(t, k));
  }
  return box;
}

Box box_of(const SignedTriangles& triangles) {
  Box all;
  for (std::size_t t = 0; t < triangles.size(); ++t) {
    const Box box = box_of(triangles, t);
    all.low = glm::min(all.low, box.low), all.high = glm::max(all.high, box.high);
  }
  return all;
}

/// Nodes around the box, in cells as small as asked for or as the bound on their number allows.
GridShape shape_around(const Box& box, double cell_m) {
  for (;; cell_m *= 1.02) {
    const double pad_m = std::max(static_cast<double>(kPad_m), kPadCells * cell_m);
    const dvec3 cells = glm::ceil((box.high - box.low + 2 * pad_m) / cell_m);
    if ((cells.x + 1) * (cells.y + 1) * (cells.z + 1) <= static_cast<double>(MeshDistance::kMostNodes))
      return {box.low - pad_m, cell_m, ivec3(cells) + 1};
  }
}

/// Builds the field; every step writes nodes from what the step before left, so that threads change no bit.
class FieldBuilder {
 public:
  FieldBuilder(const SignedTriangles& triangles, const GridShape& shape, const Box& box)
      : triangles_(triangles), shape_(shape), box_(box) {
    distance_m_.assign(shape.nodes(), INFINITY);
    nearest_.assign(shape.nodes(), kNone);
    inside_.assign(shape.nodes(), 0);
  }

  std::vector<float> run() {
    fill_band();
    spread(known_nodes());
    bound_inside();
    spread(cap_holes());
    tbb::parallel_for(std::size_t{0}, distance_m_.size(), [&](std::size_t i) {
      if (inside_[i] != 0) distance_m_[i] = -distance_m_[i];
    });
    return std::move(distance_m_);
  }

 private:
  // Exact distances near the surface ----------------------------------------------------------------------------------

  struct Range {
    ivec3 low, high;  // nodes, both included
  };
  Range range_of(std::size_t t) const {
    const Box box = box_of(triangles_, t);
    const dvec3 low = (box.low - shape_.origin_m) / shape_.cell_m, high = (box.high - shape_.origin_m) / shape_.cell_m;
    return {glm::max(ivec3(glm::floor(low)) - kBandCells + 1, 0),
            glm::min(ivec3(glm::ceil(high)) + kBandCells - 1, shape_.size - 1)};
  }

  void fill_band() {
    std::vector<std::vector<std::uint32_t>> in_layer(static_cast<std::size_t>(shape_.size.z));
    for (std::uint32_t t = 0; t < triangles_.size(); ++t) {
      const Range r = range_of(t);
      for (int z = r.low.z; z <= r.high.z; ++z) in_layer[static_cast<std::size_t>(z)].push_back(t);
    }
    tbb::parallel_for(0, shape_.size.z, [&](int z) { fill_layer(z, in_layer[static_cast<std::size_t>(z)]); });
  }

  void fill_layer(int z, const std::vector<std::uint32_t>& triangles) {
    for (const std::uint32_t t : triangles) {
      const Range r = range_of(t);
      for (int y = r.low.y; y <= r.high.y; ++y)
        for (int x = r.low.x; x <= r.high.x; ++x) offer({x, y, z}, t);
    }
    const std::size_t begin = shape_.index({0, 0, z}), end = begin + shape_.index({0, 0, 1});
    for (std::size_t i = begin; i < end; ++i)
      if (nearest_[i] != kNone) inside_[i] = triangles_.inside(nearest_[i], shape_.place(shape_.node(i)));
  }

  void offer(const ivec3& n, std::uint32_t t) {
    const std::size_t i = shape_.index(n);
    const auto d = static_cast<float>(triangles_.distance(t, shape_.place(n)));
    if (d >= distance_m_[i] || static_cast<double>(d) > kBandCells * shape_.cell_m) return;
    distance_m_[i] = d;
    nearest_[i] = t;
  }

  // Outwards ----------------------------------------------------------------------------------------------------------

  std::vector<std::size_t> known_nodes() const {
    std::vector<std::size_t> known;
    for (std::size_t i = 0; i < nearest_.size(); ++i)
      if (nearest_[i] != kNone) known.push_back(i);
    return known;
  }

  double distance_to(std::uint32_t source, const dvec3& p) const noexcept {
    return source < triangles_.size() ? triangles_.distance(source, p)
                                      : glm::distance(p, caps_[source - triangles_.size()]);
  }

  struct Offer {
    float distance_m;
    std::uint32_t source = kNone;  // none: nothing better
    std::uint8_t inside;
  };

  /// The best of the neighbours' sources for a node; the side is a neighbour's where there was none.
  Offer best_offer(std::size_t i) const {
    const ivec3 n = shape_.node(i);
    const dvec3 p = shape_.place(n);
    Offer best{distance_m_[i], kNone, inside_[i]};
    std::uint32_t tried[26];
    std::size_t tries = 0;
    for (int k = 0; k < 27; ++k) {
      const ivec3 m = n + ivec3(k % 3 - 1, k / 3 % 3 - 1, k / 9 - 1);
      if (k == 13 || !shape_.holds(m)) continue;
      const std::size_t j = shape_.index(m);
      const std::uint32_t source = nearest_[j];
      if (source == kNone || source == nearest_[i] || std::find(tried, tried + tries, source) != tried + tries)
        continue;
      tried[tries++] = source;
      const auto d = static_cast<float>(distance_to(source, p));
      if (d < best.distance_m) best = {d, source, nearest_[i] == kNone ? inside_[j] : inside_[i]};
    }
    return best;
  }

  std::vector<std::size_t> neighbours_of(const std::vector<std::size_t>& changed, std::vector<std::uint8_t>& marked) {
    std::vector<std::size_t> found;
    for (const std::size_t i : changed) {
      const ivec3 n = shape_.node(i);
      for (int k = 0; k < 27; ++k) {
        const ivec3 m = n + ivec3(k % 3 - 1, k / 3 % 3 - 1, k / 9 - 1);
        if (k == 13 || !shape_.holds(m)) continue;
        const std::size_t j = shape_.index(m);
        if (marked[j] != 0) continue;
        marked[j] = 1;
        found.push_back(j);
      }
    }
    for (const std::size_t j : found) marked[j] = 0;
    return found;
  }

  /// Carries sources on from the changed nodes until no node finds a nearer one.
  void spread(std::vector<std::size_t> changed) {
    std::vector<std::uint8_t> marked(shape_.nodes());
    std::vector<Offer> offers;
    while (!changed.empty()) {
      const std::vector<std::size_t> near = neighbours_of(changed, marked);
      offers.resize(near.size());
      tbb::parallel_for(tbb::blocked_range<std::size_t>(0, near.size(), kGrain), [&](const auto& range) {
        for (std::size_t k = range.begin(); k < range.end(); ++k) offers[k] = best_offer(near[k]);
      });
      changed.clear();
      for (std::size_t k = 0; k < near.size(); ++k) {
        if (offers[k].source == kNone) continue;
        distance_m_[near[k]] = offers[k].distance_m;
        nearest_[near[k]] = offers[k].source;
        inside_[near[k]] = offers[k].inside;
        changed.push_back(near[k]);
      }
    }
  }

  // Open meshes -------------------------------------------------------------------------------------------------------

  void bound_inside() {
    const dvec3 low = box_.low - kBandCells * shape_.cell_m, high = box_.high + kBandCells * shape_.cell_m;
    tbb::parallel_for(std::size_t{0}, inside_.size(), [&](std::size_t i) {
      const dvec3 p = shape_.place(shape_.node(i));
      if (glm::any(glm::lessThan(p, low)) || glm::any(glm::greaterThan(p, high))) inside_[i] = 0;
    });
  }

  /// Points between neighbours of different sides that are too far from the surface to have it between them.
  std::vector<std::size_t> cap_holes() {
    std::vector<std::size_t> changed;
    const double most_m = 1.001 * shape_.cell_m;
    const std::vector<float> before = distance_m_;
    for (std::size_t i = 0; i < before.size(); ++i) {
      for (int a = 0; a < 3; ++a) {
        ivec3 m = shape_.node(i);
        if (++m[a] >= shape_.size[a]) continue;
        const std::size_t j = shape_.index(m);
        if (inside_[i] == inside_[j] || static_cast<double>(before[i]) + static_cast<double>(before[j]) <= most_m)
          continue;
        const dvec3 p = shape_.place(shape_.node(i)), q = shape_.place(m);
        caps_.push_back(p + static_cast<double>(before[i] / (before[i] + before[j])) * (q - p));
        for (const std::size_t n : {i, j}) changed.push_back(take_cap(n));
      }
    }
    std::sort(changed.begin(), changed.end());
    changed.erase(std::unique(changed.begin(), changed.end()), changed.end());
    return changed;
  }

  /// The last cap, where it is nearer to the node.
  std::size_t take_cap(std::size_t n) {
    const auto source = static_cast<std::uint32_t>(triangles_.size() + caps_.size() - 1);
    const auto d = static_cast<float>(distance_to(source, shape_.place(shape_.node(n))));
    if (d < distance_m_[n]) distance_m_[n] = d, nearest_[n] = source;
    return n;
  }

  const SignedTriangles& triangles_;
  const GridShape shape_;
  const Box box_;
  std::vector<float> distance_m_;       // [node] to the source
  std::vector<std::uint32_t> nearest_;  // [node] source: a triangle, or triangles + a cap
  std::vector<std::uint8_t> inside_;    // [node]
  std::vector<dvec3> caps_;
};

// Sampling -----------------------------------------------------------------------------------------------------------

struct FieldView {
  const float* values;
  vec3 origin_m;
  float per_m, cell_m;
  ivec3 size;
};

/// Where on an axis: node below, share of the cell, and what lies beyond the box [m].
struct AxisPlace {
  int node;
  float share, beyond_m;
};

[[gnu::always_inline]] inline AxisPlace axis_place(float p, float origin_m, float per_m, float cell_m,
                                                   int nodes) noexcept {
  const float cells = (p - origin_m) * per_m, last = static_cast<float>(nodes - 1);
  const float above = cells > 0.0F ? cells : 0.0F;  // also for NaN
  const float held = above < last ? above : last;
  int node = static_cast<int>(held);
  node = node < nodes - 2 ? node : nodes - 2;
  return {node, held - static_cast<float>(node), (cells - held) * cell_m};
}

struct LaneSample {
  float distance_m, nx, ny, nz;
};

[[gnu::always_inline]] inline LaneSample sample_at(const FieldView& f, float px, float py, float pz) noexcept {
  const AxisPlace x = axis_place(px, f.origin_m.x, f.per_m, f.cell_m, f.size.x);
  const AxisPlace y = axis_place(py, f.origin_m.y, f.per_m, f.cell_m, f.size.y);
  const AxisPlace z = axis_place(pz, f.origin_m.z, f.per_m, f.cell_m, f.size.z);
  const int row = f.size.x, layer = f.size.x * f.size.y;
  const int base = z.node * layer + y.node * row + x.node;
  const float v000 = f.values[base], v001 = f.values[base + 1];
  const float v010 = f.values[base + row], v011 = f.values[base + row + 1];
  const float v100 = f.values[base + layer], v101 = f.values[base + layer + 1];
  const float v110 = f.values[base + layer + row], v111 = f.values[base + layer + row + 1];

  const float e00 = v001 - v000, e01 = v011 - v010, e10 = v101 - v100, e11 = v111 - v110;  // along x
  const float c00 = v000 + x.share * e00, c01 = v010 + x.share * e01, c10 = v100 + x.share * e10,
              c11 = v110 + x.share * e11;
  const float c0 = c00 + y.share * (c01 - c00), c1 = c10 + y.share * (c11 - c10);
  const float e0 = e00 + y.share * (e01 - e00), e1 = e10 + y.share * (e11 - e10);
  const float gx = e0 + z.share * (e1 - e0);
  const float gy = (c01 - c00) + z.share * ((c11 - c10) - (c01 - c00));
  const float gz = c1 - c0;

  const float beyond_sq = x.beyond_m * x.beyond_m + y.beyond_m * y.beyond_m + z.beyond_m * z.beyond_m;
  const float distance = c0 + z.share * (c1 - c0) + std::sqrt(beyond_sq);
  const float length = std::sqrt(gx * gx + gy * gy + gz * gz);
  const bool steep = length > 1e-12F;  // else at a ridge of the field: upwards
  const float per = 1.0F / (steep ? length : 1.0F);
  return {distance, steep ? gx * per : 0.0F, steep ? gy * per : 1.0F, steep ? gz * per : 0.0F};
}

PELAGE_CLONES void sample_lanes(const FieldView f, const Lanes3& points, Lanes& distance, Lanes3& normal) noexcept {
  PELAGE_EACH_LANE
  for (int l = 0; l < kLanes; ++l) {
    const LaneSample s = sample_at(f, points.x[l], points.y[l], points.z[l]);
    distance.v[l] = s.distance_m;
    normal.x[l] = s.nx, normal.y[l] = s.ny, normal.z[l] = s.nz;
  }
}

/// False where no lane's block of cells comes that near.
PELAGE_CLONES bool any_block_within(const FieldView f, const float* blocks, const ivec3 block_size, const float most_m,
                                    const Lanes3& points) noexcept {
  int within = 0;
  for (int l = 0; l < kLanes; ++l) {
    const AxisPlace x = axis_place(points.x[l], f.origin_m.x, f.per_m, f.cell_m, f.size.x);
    const AxisPlace y = axis_place(points.y[l], f.origin_m.y, f.per_m, f.cell_m, f.size.y);
    const AxisPlace z = axis_place(points.z[l], f.origin_m.z, f.per_m, f.cell_m, f.size.z);
    const int block =
        ((z.node >> kBlockBits) * block_size.y + (y.node >> kBlockBits)) * block_size.x + (x.node >> kBlockBits);
    const float beyond_sq = x.beyond_m * x.beyond_m + y.beyond_m * y.beyond_m + z.beyond_m * z.beyond_m;
    within |= blocks[block] + std::sqrt(beyond_sq) <= most_m ? 1 : 0;
  }
  return within != 0;
}

}  // namespace

MeshDistance::MeshDistance(const Mesh& mesh, float cell_m) {
  PELAGE_ASSERT(cell_m > 0);
  const SignedTriangles triangles(mesh);
  if (triangles.size() == 0) return;
  const Box box = box_of(triangles);
  const GridShape shape = shape_around(box, static_cast<double>(cell_m));
  // The field is built at the places that its float grid has.
  origin_m_ = vec3(shape.origin_m);
  cell_m_ = static_cast<float>(shape.cell_m);
  size_ = shape.size;
  values_ = FieldBuilder(triangles, {dvec3(origin_m_), static_cast<double>(cell_m_), size_}, box).run();
  const vec3 end = origin_m_ + cell_m_ * vec3(size_ - 1);
  radius_m_ = glm::length(glm::max(glm::abs(origin_m_), glm::abs(end)));
  find_blocks();
}

void MeshDistance::find_blocks() {
  block_size_ = (size_ - 2) / kBlock + 1;
  for (int z = 0; z < block_size_.z; ++z)
    for (int y = 0; y < block_size_.y; ++y)
      for (int x = 0; x < block_size_.x; ++x) {
        float least = kNowhere_m;
        const ivec3 low = kBlock * ivec3(x, y, z), high = glm::min(low + kBlock, size_ - 1);
        for (int k = low.z; k <= high.z; ++k)
          for (int j = low.y; j <= high.y; ++j)
            for (int i = low.x; i <= high.x; ++i)
              least = std::min(least, values_[static_cast<std::size_t>((k * size_.y + j) * size_.x + i)]);
        nearest_.push_back(least);
      }
}

SurfaceSample MeshDistance::sample(const vec3& p) const noexcept {
  if (empty()) return {kNowhere_m, {0, 1, 0}};
  const LaneSample s = sample_at({values_.data(), origin_m_, 1.0F / cell_m_, cell_m_, size_}, p.x, p.y, p.z);
  return {s.distance_m, {s.nx, s.ny, s.nz}};
}

bool MeshDistance::sample(const Lanes3& points, float reach_m, Lanes& distance, Lanes3& normal) const noexcept {
  if (empty()) return false;
  const FieldView view{values_.data(), origin_m_, 1.0F / cell_m_, cell_m_, size_};
  if (!any_block_within(view, nearest_.data(), block_size_, reach_m, points)) return false;
  sample_lanes(view, points, distance, normal);
  return true;
}

}  // namespace pelage
