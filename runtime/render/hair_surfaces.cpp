#include "pelage/render/hair_surfaces.h"

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

/// One surface of a layer: (plates + 1) x (columns + 1) vertices, the last column repeats the first.
void add_surface(const SatfModel& model, std::size_t instance, int layer, float radius,
                 std::vector<SurfaceVertex>& out) {
  const SweptCluster& swept = model.instances[instance].swept;
  const int columns = columns_of(sectors_in_layer(model.division, layer));
  const auto width = static_cast<float>(model.layout.widths[static_cast<std::size_t>(layer)]);
  const int last = swept.plates();
  for (int i = 0; i <= last; ++i) {
    for (int c = 0; c <= columns; ++c) {
      const float share = static_cast<float>(c) / static_cast<float>(columns);
      const glm::vec2 disk = radius * glm::vec2(std::cos(kTwoPi * share), std::sin(kTwoPi * share));
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
                                            static_cast<std::size_t>(layer));
      v.azimuth = disk / radius;
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
  add_surface(model, instance, layer, layer_radius(model.division, layer + 1), out.vertices);
  const auto inner = static_cast<std::uint32_t>(out.vertices.size());
  add_surface(model, instance, layer, layer_radius(model.division, layer), out.vertices);
  for (int i = 0; i < model.division.plates; ++i) {
    for (int c = 0; c < columns; ++c) {
      if (!has_hair(model, instance, layer, c, columns, i)) continue;
      const std::uint32_t offset = static_cast<std::uint32_t>(i) * stride + static_cast<std::uint32_t>(c);
      Patch p{outer + offset, inner + offset, stride, out.vertices[outer].map_id, {}, {}, {}};
      glm::vec3 normal{0.0F};
      for (const std::uint32_t corner : {0U, 1U, stride, stride + 1U}) {
        p.centre += 0.25F * out.vertices[p.outer + corner].position;
        p.inner_centre += 0.25F * out.vertices[p.inner + corner].position;
        normal += out.vertices[p.outer + corner].normal;
      }
      p.normal = glm::length(normal) > 0.0F ? glm::normalize(normal) : glm::vec3(0, 0, 1);
      out.patches.push_back(p);
    }
  }
}

bool faces(const Patch& p, glm::vec3 eye) noexcept {
  return glm::dot(p.normal, eye - p.centre) >= 0.0F;
}

/// Monotone in the float, for sorting as integers.
std::uint32_t sortable(float f) noexcept {
  const auto bits = std::bit_cast<std::uint32_t>(f);
  return (bits & 0x80000000U) != 0U ? ~bits : bits | 0x80000000U;
}

/// Sort key of a patch, ascending = drawn first.
std::uint64_t key_of(const HairSurfaces& surfaces, const Division& division, DrawOrder order, glm::vec3 eye,
                     const Patch& p) {
  const bool front = faces(p, eye);
  if (order == DrawOrder::patches) {
    const glm::vec3 d = (front ? p.centre : p.inner_centre) - eye;
    return static_cast<std::uint64_t>(~sortable(glm::dot(d, d))) << 32;
  }
  // Clusters far to near; in each, far side outer to inner, then near side inner to outer (exact for a convex cluster).
  const auto layers = static_cast<std::uint32_t>(division.layers);
  const std::uint32_t instance = p.instance_layer / layers, layer = p.instance_layer % layers;
  const glm::vec3 d = surfaces.instance_centres[instance] - eye;
  const std::uint32_t within = front ? layers + layer : layers - 1 - layer;
  return static_cast<std::uint64_t>(~sortable(glm::dot(d, d))) << 32 | static_cast<std::uint64_t>(within) << 24;
}

}  // namespace

HairSurfaces make_surfaces(const SatfModel& model) {
  HairSurfaces out;
  for (std::size_t i = 0; i < model.instances.size(); ++i) {
    for (int layer = 0; layer < model.division.layers; ++layer) add_layer(model, i, layer, out);
    glm::vec3 sum{0.0F};
    for (const Frame& f : model.instances[i].swept.frames) sum += f.position;
    out.instance_centres.push_back(sum / static_cast<float>(model.instances[i].swept.frames.size()));
  }
  return out;
}

std::vector<std::uint32_t> ordered_indices(const HairSurfaces& surfaces, const Division& division, DrawOrder order,
                                           glm::vec3 eye) {
  struct Item {
    std::uint64_t key;
    std::uint32_t patch;
    bool operator<(const Item& o) const noexcept { return key != o.key ? key < o.key : patch < o.patch; }
  };
  std::vector<Item> items(surfaces.patches.size());
  for (std::size_t i = 0; i < items.size(); ++i) {
    const std::uint64_t key =
        order == DrawOrder::exact ? 0 : key_of(surfaces, division, order, eye, surfaces.patches[i]);
    items[i] = {key, static_cast<std::uint32_t>(i)};
  }
  if (order != DrawOrder::exact) tbb::parallel_sort(items.begin(), items.end());
  std::vector<std::uint32_t> indices;
  indices.reserve(6 * items.size());
  for (const Item& item : items) {
    const Patch& p = surfaces.patches[item.patch];
    const std::uint32_t a = faces(p, eye) ? p.outer : p.inner;
    const std::uint32_t b = a + 1, c = a + p.next_plate, d = c + 1;
    indices.insert(indices.end(), {a, b, d, a, d, c});
  }
  return indices;
}

}  // namespace pelage
