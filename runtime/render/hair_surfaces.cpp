#include "pelage/render/hair_surfaces.h"

#include <tbb/parallel_for.h>
#include <tbb/parallel_sort.h>

#include <algorithm>
#include <bit>
#include <cmath>
#include <glm/geometric.hpp>
#include <numbers>

#include "pelage/db/sectors.h"

namespace pelage {
namespace {

constexpr float kTwoPi = 2.0F * std::numbers::pi_v<float>;
/// Columns around a ring at least: fewer would show as a polygon.
constexpr int kFewestColumns = 12;

int columns_of(int sectors) noexcept {
  return std::max(sectors, kFewestColumns);
}

/// Centre and outward normal of a quad.
struct Plane {
  glm::vec3 centre{0.0F}, normal{0.0F};
};
Plane plane_of(const std::vector<SurfaceVertex>& vertices, std::uint32_t first, std::uint32_t stride) {
  Plane plane;
  glm::vec3 outward{0.0F};
  for (const std::uint32_t corner : {0U, 1U, stride, stride + 1U}) {
    plane.centre += 0.25F * vertices[first + corner].position;
    outward += vertices[first + corner].normal;
  }
  const auto at = [&](std::uint32_t corner) { return vertices[first + corner].position; };
  plane.normal = glm::cross(at(stride + 1U) - at(0), at(stride) - at(1));
  if (glm::dot(plane.normal, outward) < 0.0F) plane.normal = -plane.normal;
  return plane;
}

/// One surface of a layer: (plates + 1) x (columns + 1) vertices, the last column repeats the first.
/// The polygon lies as much outside the circle as inside, so that silhouettes are where the circle has them.
void add_surface(const SatfModel& model, std::size_t instance, int layer, float radius, std::uint32_t mark,
                 std::vector<SurfaceVertex>& out) {
  const SweptCluster& swept = model.instances[instance].swept;
  const int columns = columns_of(sectors_in_layer(model.division, layer));
  const auto width = static_cast<float>(model.layout.widths[static_cast<std::size_t>(layer)]);
  const int last = swept.plates();
  const float grown = radius / std::sqrt(std::cos(kTwoPi / 2.0F / static_cast<float>(columns)));
  std::vector<glm::vec2> ring;
  for (int c = 0; c <= columns; ++c) {
    const float share = static_cast<float>(c) / static_cast<float>(columns);
    ring.push_back(grown * glm::vec2(std::cos(kTwoPi * share), std::sin(kTwoPi * share)));
  }
  for (int i = 0; i <= last; ++i) {
    for (int c = 0; c <= columns; ++c) {
      const float share = static_cast<float>(c) / static_cast<float>(columns);
      const glm::vec2 disk = ring[static_cast<std::size_t>(c)];
      const Frame& frame = swept.frames[static_cast<std::size_t>(i)];
      SurfaceVertex v{};
      v.position = swept.point(i, disk);
      v.tangent = swept.point(std::min(i + 1, last), disk) - swept.point(std::max(i - 1, 0), disk);
      // Where cross-sections overlap (radius > 1 / curvature) the surface runs backwards: the strands do not.
      if (!(glm::dot(v.tangent, frame.tangent) > 1e-3F * glm::length(v.tangent))) v.tangent = frame.tangent;
      // Normal of an ellipse S(cos, sin): S^-1 (cos, sin), made perpendicular to the strand.
      const CrossSection& s = swept.cross_sections[static_cast<std::size_t>(i)];
      const glm::vec2 n = s.solve(disk);
      const glm::vec3 outward = n.x * frame.normal + n.y * frame.binormal;
      const glm::vec3 t = glm::normalize(v.tangent);
      v.normal = glm::normalize(outward - glm::dot(outward, t) * t);
      v.map_at = {share * width, static_cast<float>(i)};
      v.map_id = static_cast<std::uint32_t>(instance * static_cast<std::size_t>(model.division.layers) +
                                            static_cast<std::size_t>(layer)) |
                 mark;
      v.azimuth = disk / grown;
      out.push_back(v);
    }
  }
}

/// Does any of the sectors that cover this column hold a strand, on plate i or i + 1?
bool has_hair(const SatfModel& model, std::size_t instance, int layer, int column, int columns, int plate) {
  const int n = sectors_in_layer(model.division, layer);
  const int first = (column * n) / columns - 1;
  const int last = ((column + 1) * n + columns - 1) / columns;
  for (int k = first; k <= last; ++k) {
    const std::size_t track = model.track(instance, layer, (k % n + n) % n);
    for (int i = plate; i <= plate + 1; ++i) {
      if (!model.sectors.sector(track + static_cast<std::size_t>(i)).empty()) return true;
    }
  }
  return false;
}

void add_layer(const SatfModel& model, std::size_t instance, int layer, HairSurfaces& out) {
  const int columns = columns_of(sectors_in_layer(model.division, layer));
  const auto stride = static_cast<std::uint32_t>(columns + 1);
  const auto outer = static_cast<std::uint32_t>(out.vertices.size());
  add_surface(model, instance, layer, layer_radius(model.division, layer + 1), 0, out.vertices);
  const auto inner = static_cast<std::uint32_t>(out.vertices.size());
  add_surface(model, instance, layer, layer_radius(model.division, layer), kInnerSurface, out.vertices);
  for (int i = 0; i < model.division.plates; ++i) {
    for (int c = 0; c < columns; ++c) {
      if (!has_hair(model, instance, layer, c, columns, i)) continue;
      const std::uint32_t offset = static_cast<std::uint32_t>(i) * stride + static_cast<std::uint32_t>(c);
      const Plane near = plane_of(out.vertices, outer + offset, stride),
                  far = plane_of(out.vertices, inner + offset, stride);
      const Patch p{outer + offset, inner + offset, stride,     out.vertices[outer].map_id,
                    near.centre,    near.normal,    far.centre, far.normal};
      out.patches.push_back(p);
    }
  }
}

bool draws_outer(const Patch& p, glm::vec3 eye) noexcept {
  return glm::dot(p.outer_normal, eye - p.outer_centre) >= 0.0F;
}
bool draws_inner(const Patch& p, glm::vec3 eye) noexcept {
  return glm::dot(p.inner_normal, eye - p.inner_centre) < 0.0F;
}

/// Monotone in the float, for sorting as integers.
std::uint32_t sortable(float f) noexcept {
  const auto bits = std::bit_cast<std::uint32_t>(f);
  return (bits & 0x80000000U) != 0U ? ~bits : bits | 0x80000000U;
}

/// Sort key of a quad, ascending = drawn first.
std::uint64_t key_of(const HairSurfaces& surfaces, const Division& division, DrawOrder order, glm::vec3 eye,
                     const Patch& p, bool outer) {
  if (order == DrawOrder::exact) return 0;
  if (order == DrawOrder::patches) {
    const glm::vec3 d = (outer ? p.outer_centre : p.inner_centre) - eye;
    return static_cast<std::uint64_t>(~sortable(glm::dot(d, d))) << 32;
  }
  // Clusters far to near; in each, far side outer to inner, then near side inner to outer (exact for a convex cluster).
  const auto layers = static_cast<std::uint32_t>(division.layers);
  const std::uint32_t instance = p.instance_layer / layers, layer = p.instance_layer % layers;
  const glm::vec3 d = surfaces.instance_centres[instance] - eye;
  const std::uint32_t within = outer ? layers + layer : layers - 1 - layer;
  return static_cast<std::uint64_t>(~sortable(glm::dot(d, d))) << 32 | static_cast<std::uint64_t>(within) << 24;
}

}  // namespace

HairSurfaces make_surfaces(const SatfModel& model) {
  std::vector<HairSurfaces> parts(model.instances.size());
  tbb::parallel_for(std::size_t{0}, parts.size(), [&](std::size_t i) {
    for (int layer = 0; layer < model.division.layers; ++layer) add_layer(model, i, layer, parts[i]);
    glm::vec3 sum{0.0F};
    for (const Frame& f : model.instances[i].swept.frames) sum += f.position;
    parts[i].instance_centres.push_back(sum / static_cast<float>(model.instances[i].swept.frames.size()));
  });
  HairSurfaces out;
  std::size_t vertices = 0, patches = 0;
  for (const HairSurfaces& part : parts) vertices += part.vertices.size(), patches += part.patches.size();
  out.vertices.reserve(vertices);
  out.patches.reserve(patches);
  for (HairSurfaces& part : parts) {
    const auto first = static_cast<std::uint32_t>(out.vertices.size());
    for (Patch& p : part.patches) p.outer += first, p.inner += first;
    out.vertices.insert(out.vertices.end(), part.vertices.begin(), part.vertices.end());
    out.patches.insert(out.patches.end(), part.patches.begin(), part.patches.end());
    out.instance_centres.push_back(part.instance_centres[0]);
    part = {};
  }
  return out;
}

std::vector<std::uint32_t> ordered_indices(const HairSurfaces& surfaces, const Division& division, DrawOrder order,
                                           glm::vec3 eye) {
  struct Item {
    std::uint64_t key;
    std::uint32_t first, next_plate;  // vertex, and stride to the next plate
    bool operator<(const Item& o) const noexcept { return key != o.key ? key < o.key : first < o.first; }
  };
  std::vector<Item> items;
  items.reserve(surfaces.patches.size() + surfaces.patches.size() / 8);
  for (const Patch& p : surfaces.patches) {
    if (draws_outer(p, eye)) items.push_back({key_of(surfaces, division, order, eye, p, true), p.outer, p.next_plate});
    if (draws_inner(p, eye)) items.push_back({key_of(surfaces, division, order, eye, p, false), p.inner, p.next_plate});
  }
  if (order != DrawOrder::exact) tbb::parallel_sort(items.begin(), items.end());
  std::vector<std::uint32_t> indices;
  indices.reserve(6 * items.size());
  for (const Item& item : items) {
    const std::uint32_t a = item.first, b = a + 1, c = a + item.next_plate, d = c + 1;
    indices.insert(indices.end(), {a, b, d, a, d, c});
  }
  return indices;
}

}  // namespace pelage
