#include "pelage/hair/mesh_roots.h"

#include <algorithm>
#include <cmath>
#include <glm/glm.hpp>
#include <string>
#include <unordered_map>

#include "pelage/data_schema/errors.h"
#include "pelage/hair/random.h"

namespace pelage::hair {
namespace {

using glm::vec3;

// Shares of the head's height; those of the parametric head.
constexpr float kCentreBelowCrown = 0.42F;
constexpr float kSlabFrom = 0.10F, kSlabTo = 0.45F;  // below the crown: skull and forehead, above the nose's tip
constexpr float kReach = 0.75F;                      // from the centre; what is farther is no scalp

constexpr float kClear_m = 0.010F;   // above a root there is nothing
constexpr float kClearShare = 0.4F;  // of that as distance: what hair on a convex surface has at the least
constexpr std::uint32_t kDartsPerRoot = 24, kFewestDarts = 4096;
constexpr std::uint32_t kDartStream = 21;
constexpr float kFirstRadius = 0.95F, kShrink = 0.93F;  // of the spacing of a regular lattice, and at each pass

/// Darts on the triangles near the skull, as many per area everywhere.
class Darts {
 public:
  Darts(const Mesh& mesh, const Skull& skull, std::uint64_t seed) : mesh_(mesh), random_(seed) {
    const float reach = kReach * skull.height_m;
    for (std::uint32_t t = 0; t < mesh.triangles.size(); ++t) {
      const vec3 a = corner(t, 0), b = corner(t, 1), c = corner(t, 2);
      const vec3 middle = (a + b + c) / 3.0F;
      const float size = std::max({glm::distance(middle, a), glm::distance(middle, b), glm::distance(middle, c)});
      if (glm::distance(middle, skull.centre_m) - size > reach) continue;
      triangles_.push_back(t);
      area_m2_ += 0.5 * static_cast<double>(glm::length(glm::cross(b - a, c - a)));
      area_up_to_m2_.push_back(area_m2_);
    }
  }

  double area_m2() const noexcept { return area_m2_; }

  Root at(std::uint32_t index) const {
    const std::array<float, 4> u = random_.uniform(kDartStream, index);
    const double area = (static_cast<double>(u[0]) + static_cast<double>(u[3]) * 0x1p-24) * area_m2_;
    const auto k = std::upper_bound(area_up_to_m2_.begin(), area_up_to_m2_.end(), area) - area_up_to_m2_.begin();
    const std::uint32_t t = triangles_[std::min(static_cast<std::size_t>(k), triangles_.size() - 1)];
    const float root = std::sqrt(u[1]), wb = root * (1 - u[2]), wc = root * u[2], wa = 1 - wb - wc;
    const glm::uvec3& i = mesh_.triangles[t];
    const vec3 flat = glm::cross(corner(t, 1) - corner(t, 0), corner(t, 2) - corner(t, 0));
    const vec3 smooth = wa * mesh_.normals[i.x] + wb * mesh_.normals[i.y] + wc * mesh_.normals[i.z];
    const vec3 normal = glm::length(smooth) > 0.1F ? smooth : flat;
    return {wa * corner(t, 0) + wb * corner(t, 1) + wc * corner(t, 2), glm::normalize(normal)};
  }

 private:
  vec3 corner(std::uint32_t t, int k) const { return mesh_.vertices[mesh_.triangles[t][k]]; }

  const Mesh& mesh_;
  CounterRandom random_;
  std::vector<std::uint32_t> triangles_;
  std::vector<double> area_up_to_m2_;
  double area_m2_ = 0;
};

/// Roots by cells of the side `cell_m`, to find those near a point.
class RootCells {
 public:
  explicit RootCells(float cell_m) : cell_m_(cell_m) {}

  bool any_within(const vec3& p, float radius_m) const {
    const glm::ivec3 c = cell_of(p);
    for (int k = 0; k < 27; ++k) {
      const auto found = cells_.find(key(c + glm::ivec3(k % 3 - 1, k / 3 % 3 - 1, k / 9 - 1)));
      if (found == cells_.end()) continue;
      for (const vec3& q : found->second)
        if (glm::distance(p, q) < radius_m) return true;
    }
    return false;
  }
  void add(const vec3& p) { cells_[key(cell_of(p))].push_back(p); }

 private:
  glm::ivec3 cell_of(const vec3& p) const { return glm::ivec3(glm::floor(p / cell_m_)); }
  static std::uint64_t key(const glm::ivec3& c) {
    const auto bits = [](int v) { return static_cast<std::uint64_t>(static_cast<std::uint32_t>(v) & 0x1FFFFFU); };
    return bits(c.x) | bits(c.y) << 21 | bits(c.z) << 42;
  }

  float cell_m_;
  std::unordered_map<std::uint64_t, std::vector<vec3>> cells_;
};

bool can_grow(const Root& root, const Skull& skull, const DistanceField& field) {
  return std::isfinite(root.normal.x) && skull.grows_at(root.position_m) &&
         glm::dot(root.normal, root.position_m - skull.centre_m) > 0 &&
         field(root.position_m + kClear_m * root.normal).distance_m > kClearShare * kClear_m;
}

std::vector<Root> darts_on_scalp(const Darts& darts, const Skull& skull, const DistanceField& field,
                                 std::uint32_t count) {
  const std::uint32_t thrown = std::max(kFewestDarts, kDartsPerRoot * count);
  std::vector<Root> hits;
  for (std::uint32_t i = 0; i < thrown; ++i) {
    const Root root = darts.at(i);
    if (can_grow(root, skull, field)) hits.push_back(root);
  }
  return hits;
}

}  // namespace

vec3 parse_face(std::string_view name) {
  if (name == "+z") return {0, 0, 1};
  if (name == "-z") return {0, 0, -1};
  if (name == "+x") return {1, 0, 0};
  if (name == "-x") return {-1, 0, 0};
  throw UsageError("face \"" + std::string(name) + "\": give +z, -z, +x or -x");
}

vec3 Skull::to_own_axes(const vec3& d) const noexcept {
  const vec3 left = glm::cross(vec3(0, 1, 0), face);
  return {glm::dot(d, left), d.y, glm::dot(d, face)};
}

bool Skull::grows_at(const vec3& p) const noexcept {
  const vec3 away = p - centre_m;
  const float distance = glm::length(away);
  if (!(distance > 0) || distance > kReach * height_m) return false;
  const vec3 d = to_own_axes(away / distance);
  return d.y > hairline_sine(d);
}

Skull find_skull(const Mesh& mesh, float height_m, const vec3& face) {
  if (!(height_m > 0 && height_m <= 100))
    throw UsageError("head height " + std::to_string(height_m) + ": give up to 100 m");
  vec3 low(INFINITY), high(-INFINITY);
  for (const vec3& v : mesh.vertices) low = glm::min(low, v), high = glm::max(high, v);
  const float crown = high.y;
  if (!(crown - low.y >= 0.5F * height_m))
    throw UsageError("the mesh is " + std::to_string(crown - low.y) + " m high, the head " + std::to_string(height_m) +
                     " m: give the mesh's --unit or --up, or --head-height");
  vec3 slab_low(INFINITY), slab_high(-INFINITY);
  for (const vec3& v : mesh.vertices) {
    if (v.y > crown - kSlabFrom * height_m || v.y < crown - kSlabTo * height_m) continue;
    slab_low = glm::min(slab_low, v), slab_high = glm::max(slab_high, v);
  }
  const vec3 middle = slab_low.x <= slab_high.x ? 0.5F * (slab_low + slab_high) : 0.5F * (low + high);
  return {{middle.x, crown - kCentreBelowCrown * height_m, middle.z}, height_m, face};
}

std::vector<Root> mesh_roots(const Mesh& mesh, const Skull& skull, const DistanceField& field, std::uint32_t count,
                             std::uint64_t seed) {
  PELAGE_ASSERT(mesh.normals.size() == mesh.vertices.size());
  const Darts darts(mesh, skull, seed);
  const std::vector<Root> hits = darts.area_m2() > 0 ? darts_on_scalp(darts, skull, field, count) : std::vector<Root>{};
  if (hits.size() < count)
    throw InputError("head", "only " + std::to_string(hits.size()) + " of the " + std::to_string(count) +
                                 " roots find a scalp around the skull's centre: its face must look along --face");
  const double thrown = std::max(kFewestDarts, kDartsPerRoot * count);
  const double scalp_m2 = darts.area_m2() * static_cast<double>(hits.size()) / thrown;
  // Hexagons of the area that each root has; no radius above their spacing fits `count` roots.
  const auto spacing_m = static_cast<float>(std::sqrt(1.1547 * scalp_m2 / count));

  std::vector<Root> roots;
  RootCells cells(spacing_m);
  std::vector<bool> taken(hits.size(), false);
  for (float radius_m = kFirstRadius * spacing_m; roots.size() < count; radius_m *= kShrink) {
    if (radius_m < 1e-3F * spacing_m) radius_m = 0;  // fewer places than roots: they share them
    for (std::size_t k = 0; k < hits.size() && roots.size() < count; ++k) {
      if (taken[k] || (radius_m > 0 && cells.any_within(hits[k].position_m, radius_m))) continue;
      taken[k] = true;
      roots.push_back(hits[k]);
      cells.add(hits[k].position_m);
    }
  }
  return roots;
}

}  // namespace pelage::hair
