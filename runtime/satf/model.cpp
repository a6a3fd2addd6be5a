#include "pelage/satf/model.h"

#include <cmath>
#include <glm/geometric.hpp>
#include <glm/mat3x3.hpp>
#include <numbers>

#include "pelage/data_schema/errors.h"

namespace pelage {
namespace {

/// The swept cluster moved by a similarity transform.
SweptCluster transformed(const SweptCluster& swept, const glm::mat4& m) {
  const glm::mat3 linear{m};
  const float scale = std::cbrt(std::abs(glm::determinant(linear)));
  SweptCluster out = swept;
  out.length_m *= scale;
  for (Frame& f : out.frames) {
    f.position = glm::vec3(m * glm::vec4(f.position, 1.0F));
    f.tangent = glm::normalize(linear * f.tangent);
    const glm::vec3 n = linear * f.normal;
    f.normal = glm::normalize(n - glm::dot(n, f.tangent) * f.tangent);
    f.binormal = glm::cross(f.tangent, f.normal);
    f.curvature_per_m /= scale;
  }
  for (CrossSection& s : out.cross_sections) s = {s.xx * scale, s.xy * scale, s.yy * scale};
  return out;
}

MapLayout layout_of(const Division& division, int samples) {
  MapLayout layout;
  layout.rows = division.plates + 1;
  for (int j = 0; j < division.layers; ++j) {
    layout.widths.push_back(sectors_in_layer(division, j) * samples / 2);
    layout.offsets.push_back(layout.texels_per_instance);
    layout.texels_per_instance +=
        static_cast<std::size_t>(layout.widths.back()) * static_cast<std::size_t>(layout.rows);
  }
  return layout;
}

RingTable ring_table(int width) {
  RingTable ring;
  for (int x = 0; x < width; ++x) {
    const double u = 2.0 * std::numbers::pi * (x + 0.5) / width;
    ring.cos_u.push_back(static_cast<float>(std::cos(u)));
    ring.sin_u.push_back(static_cast<float>(std::sin(u)));
  }
  return ring;
}

}  // namespace

std::vector<Instance> instances_of(const Hairstyle& style) {
  std::vector<Instance> instances;
  for (std::size_t c = 0; c < style.clusters.size(); ++c) {
    const Cluster& cluster = style.clusters[c];
    SweptCluster swept = sweep(cluster, style.division.plates);
    const auto id = static_cast<std::uint32_t>(c);
    for (const glm::mat4& m : cluster.transforms) instances.push_back({id, transformed(swept, m)});
    if (cluster.transforms.empty()) instances.push_back({id, std::move(swept)});
  }
  return instances;
}

std::size_t SatfModel::track(std::size_t instance, int layer, int sector) const noexcept {
  int before = sector;
  for (int j = 0; j < layer; ++j) before += sectors_in_layer(division, j);
  const auto tracks = static_cast<std::size_t>(tracks_per_cluster(division));
  return (instances[instance].cluster * tracks + static_cast<std::size_t>(before)) *
         static_cast<std::size_t>(division.plates + 1);
}

SatfModel make_model(const Hairstyle& style, const BakeSettings& bake, int samples) {
  if (samples <= 0 || samples % 4 != 0) {
    throw InputError("bake settings", "samples is " + std::to_string(samples) + "; maps need a multiple of 4");
  }
  SatfModel model;
  model.division = style.division;
  model.blocked_width_m = style.opacity * style.diameter_m;
  model.profile_sigma = static_cast<float>(bake.sigma * std::sqrt(1.0 + bake.smoothing * bake.smoothing));
  model.max_path = static_cast<float>(bake.max_path);
  model.samples = samples;
  model.instances = instances_of(style);
  model.sectors = sectors_of(style.clusters, style.division);
  model.layout = layout_of(style.division, samples);
  for (const int width : model.layout.widths) model.rings.push_back(ring_table(width));
  for (const Cluster& cluster : style.clusters) {
    for (int i = 0; i <= style.division.plates; ++i) {
      const float t = static_cast<float>(i) / static_cast<float>(style.division.plates);
      model.strands_at.push_back(static_cast<std::uint32_t>(plate_crossings(cluster, t).size()));
    }
  }
  return model;
}

}  // namespace pelage
