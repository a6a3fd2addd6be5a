#include "pelage/satf/model.h"

#include <tbb/parallel_for.h>

#include <algorithm>
#include <cmath>
#include <glm/geometric.hpp>
#include <glm/mat3x3.hpp>
#include <numbers>

#include "pelage/data_schema/errors.h"
#include "pelage/db/optical_scale.h"
#include "pelage/satf/plate_direction.h"

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

/// M / det S of every ring [1/m]: the strand's profile is that of a record, stretched over the ring's sectors.
std::vector<float> masses_of(const SatfModel& model) {
  std::vector<float> masses;
  for (const Instance& instance : model.instances) {
    for (const CrossSection& s : instance.swept.cross_sections) {
      const float area = std::max(s.determinant(), 1e-12F);
      for (int j = 0; j < model.division.layers; ++j) {
        const float sigma_m = model.profile_sigma * ring_shape(model.division, j).width * std::sqrt(area);
        const double mass = gaussian_mass(static_cast<double>(model.blocked_width_m), static_cast<double>(sigma_m));
        masses.push_back(static_cast<float>(mass) / area);
      }
    }
  }
  return masses;
}

bool same_cross_sections(const std::vector<Instance>& a, const std::vector<Instance>& b) {
  const auto same = [](const CrossSection& s, const CrossSection& t) {
    return s.xx == t.xx && s.xy == t.xy && s.yy == t.yy;
  };
  return std::equal(a.begin(), a.end(), b.begin(), b.end(), [&](const Instance& i, const Instance& j) {
    const auto &s = i.swept.cross_sections, &t = j.swept.cross_sections;
    return std::equal(s.begin(), s.end(), t.begin(), t.end(), same);
  });
}

/// As schemas/hairstyle.schema.json bounds them.
void check(const Division& d) {
  if (d.layers >= 1 && d.sectors >= 3 && d.plates >= 1 && d.core >= 0 && d.core < 1) return;
  throw InputError("division", std::to_string(d.layers) + " layers, " + std::to_string(d.sectors) + " sectors, " +
                                   std::to_string(d.plates) + " plates, core " + std::to_string(d.core) +
                                   ": give 1, 3, 1 or more, and a core from 0 to below 1");
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
  std::vector<SweptCluster> swept(style.clusters.size());
  tbb::parallel_for(std::size_t{0}, swept.size(),
                    [&](std::size_t c) { swept[c] = sweep(style.clusters[c], style.division.plates); });
  std::vector<Instance> instances;
  for (std::size_t c = 0; c < style.clusters.size(); ++c) {
    const Cluster& cluster = style.clusters[c];
    const auto id = static_cast<std::uint32_t>(c);
    for (const glm::mat4& m : cluster.transforms) instances.push_back({id, transformed(swept[c], m)});
    if (cluster.transforms.empty()) instances.push_back({id, std::move(swept[c])});
  }
  return instances;
}

std::size_t SatfModel::track(std::size_t instance, int layer, int sector) const noexcept {
  const std::size_t before = track_of[static_cast<std::size_t>(layer)] + static_cast<std::size_t>(sector);
  return (instances[instance].cluster * static_cast<std::size_t>(track_of.back()) + before) *
         static_cast<std::size_t>(division.plates + 1);
}

void place_model(const Hairstyle& style, SatfModel& model) {
  std::vector<Instance> before = instances_of(style);
  before.swap(model.instances);
  if (!same_cross_sections(before, model.instances)) model.mass_per_area = masses_of(model);
}

SatfModel make_model(const Hairstyle& style, const BakeSettings& bake, int samples) {
  if (samples <= 0 || samples % 4 != 0) {
    throw InputError("bake settings", "samples is " + std::to_string(samples) + "; maps need a multiple of 4");
  }
  check(style.division);
  SatfModel model;
  model.division = style.division;
  model.blocked_width_m = style.opacity * style.diameter_m;
  model.profile_sigma = static_cast<float>(bake.sigma * std::sqrt(1.0 + bake.smoothing * bake.smoothing));
  model.max_path = static_cast<float>(bake.max_path);
  model.samples = samples;
  place_model(style, model);
  model.track_of = {0};
  for (int j = 0; j < style.division.layers; ++j) {
    model.track_of.push_back(model.track_of.back() + static_cast<std::uint32_t>(sectors_in_layer(style.division, j)));
  }
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
