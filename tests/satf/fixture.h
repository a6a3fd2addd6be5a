// A straight cluster with chosen strands, and what the tests of the maps need around it.
#pragma once

#include <cmath>
#include <glm/geometric.hpp>
#include <memory>
#include <numbers>
#include <vector>

#include "pelage/bake/direct_source.h"
#include "pelage/data_schema/errors.h"
#include "pelage/satf/maps.h"
#include "pelage/satf/self_shadow.h"

namespace pelage::test {

inline constexpr float kPi = std::numbers::pi_v<float>;

/// Straight down from y = 0 to y = -0.2 m with a constant cross-section.
inline Cluster straight_cluster(const CrossSection& s) {
  Cluster c;
  for (int i = 0; i < 4; ++i) c.centre_line.push_back({0, -0.2F * static_cast<float>(i) / 3, 0});
  c.cross_sections.assign(4, s);
  c.first_normal = {1, 0, 0};
  return c;
}

/// A strand from root to tip; `twist` turns it about the axis on its way.
inline void add_strand(Cluster& c, float v, float u, float twist = 0.0F) {
  for (int i = 0; i <= 16; ++i) {
    const float t = static_cast<float>(i) / 16;
    c.strand_points.push_back({t, v * std::cos(u + twist * t), v * std::sin(u + twist * t)});
  }
  c.strand_offsets.push_back(static_cast<std::uint32_t>(c.strand_points.size()));
}

/// Strands spread evenly over the disk between two radii (a golden-angle spiral).
inline void fill_disk(Cluster& c, int strands, float twist = 0.0F, float from = 0.15F, float to = 0.95F) {
  for (int i = 0; i < strands; ++i) {
    const float share = (static_cast<float>(i) + 0.5F) / static_cast<float>(strands);
    add_strand(c, std::sqrt(from * from + share * (to * to - from * from)), 2.39996323F * static_cast<float>(i), twist);
  }
}

inline Hairstyle style_of(Cluster cluster, Division division = {4, 24, 8, 0.1F}) {
  Hairstyle style;
  style.name = "test";
  style.division = division;
  style.diameter_m = 2e-4F;
  style.opacity = 0.6F;
  style.clusters.push_back(std::move(cluster));
  return style;
}

struct Scene {
  BakeSettings bake;
  Hairstyle style;
  DirectSource source{bake};
  SatfModel model;

  explicit Scene(Hairstyle s, const BakeSettings& b = {})
      : bake(b), style(std::move(s)), model(make_model(style, bake, bake.samples)) {
    source.attach(model.sectors);
  }
  /// Optical depth of one ring seen along `towards`.
  std::vector<float> depth(int layer, int plate, glm::vec3 towards, bool curvature = true) const {
    const SweptCluster& swept = model.instances[0].swept;
    const auto row = static_cast<std::size_t>(plate);
    const PlateDirection d = plate_direction(swept.frames[row], swept.cross_sections[row], glm::normalize(towards));
    std::vector<float> out(static_cast<std::size_t>(model.layout.widths[static_cast<std::size_t>(layer)]));
    RingScratch scratch;
    ring_depth(model, source, 0, layer, plate, d, d, curvature, scratch, out, {});
    return out;
  }
  std::vector<Texel> maps(const MapRequest& request) const {
    std::vector<Texel> texels(model.texels());
    build_maps(model, source, request, {}, texels);
    return texels;
  }
};

/// Entry x of a ring at azimuth u, linear and periodic.
inline float at_azimuth(const std::vector<float>& ring, float u) {
  const auto n = static_cast<float>(ring.size());
  float x = u / (2 * kPi) * n - 0.5F;
  x -= n * std::floor(x / n);
  const auto i = static_cast<std::size_t>(x) % ring.size();
  return std::lerp(ring[i], ring[(i + 1) % ring.size()], x - std::floor(x));
}

}  // namespace pelage::test
