#include "pelage/satf/self_shadow.h"

#include <tbb/blocked_range.h>
#include <tbb/parallel_for.h>

#include <algorithm>
#include <cmath>
#include <numbers>

#include "pelage/data_schema/numeric.h"
#include "pelage/satf/maps.h"

namespace pelage {
namespace {

constexpr float kTwoPi = 2.0F * std::numbers::pi_v<float>;
/// Half-width in cos(theta) of the blend between the lit and the unlit estimate.
constexpr float kTerminator = 0.25F;
/// Azimuths around the envelope at which the density map is read.
constexpr int kExits = 32;
/// How far outside the envelope: the cluster's own outermost strands lie on it.
constexpr float kExitRadius = 1.05F;

/// Periodic linear lookup at azimuth u.
float around(std::span<const float> values, float u) noexcept {
  const auto n = static_cast<float>(values.size());
  float x = u / kTwoPi * n - 0.5F;
  x -= n * std::floor(x / n);
  const auto i = std::min(static_cast<std::size_t>(x), values.size() - 1);
  const float f = x - static_cast<float>(i);
  return values[i] + f * (values[(i + 1) % values.size()] - values[i]);
}

/// A point (v, 0) and a ray at angle theta from outward: where it meets the circle of radius `to` >= v on its way out.
struct RingHit {
  float path;  // in disk units
  float du;    // change of azimuth [rad]
};
RingHit ring_hit(float v, float cos_t, float sin_t, float to) noexcept {
  const float path = -v * cos_t + std::sqrt(std::max(to * to - v * v * sin_t * sin_t, 0.0F));
  return {path, std::atan2(path * sin_t, v + path * cos_t)};
}

struct RowScratch {
  RingScratch ring;
  std::vector<std::vector<float>> depth;  // [layer][x] seen from the light
  std::vector<float> exits;               // [kExits] optical depth beyond the envelope
};

/// What a ray from the middle of each layer meets, tabulated over its angle theta from outward: the answer depends on
/// nothing else. Linear in between (error below 1e-4 of a turn away from the tangent rays).
class CrossingTable {
 public:
  explicit CrossingTable(const Division& division) : layers_(static_cast<std::size_t>(division.layers)) {
    hits_.resize(layers_ * layers_ * (kAngles + 1));
    for (int from = 0; from < division.layers; ++from) {
      const float v = 0.5F * (layer_radius(division, from) + layer_radius(division, from + 1));
      for (int to = from; to < division.layers; ++to) {
        for (int i = 0; i <= kAngles; ++i) {
          const float theta = kTwoPi * static_cast<float>(i) / kAngles;
          hits_[index(from, to) + static_cast<std::size_t>(i)] =
              ring_hit(v, std::cos(theta), std::sin(theta), layer_radius(division, to + 1));
        }
      }
    }
  }

  /// Position of theta [rad] in the table, for at().
  struct Angle {
    std::size_t i;
    float f;
  };
  static Angle angle(float theta) noexcept {
    float x = theta / kTwoPi;
    x = (x - std::floor(x)) * kAngles;
    const auto i = std::min(static_cast<std::size_t>(x), static_cast<std::size_t>(kAngles - 1));
    return {i, x - static_cast<float>(i)};
  }
  /// From the middle of layer `from` to the outer surface of layer `to` >= from.
  RingHit at(int from, int to, Angle a) const noexcept {
    const RingHit* const h = hits_.data() + index(from, to) + a.i;
    return {h[0].path + a.f * (h[1].path - h[0].path), h[0].du + a.f * (h[1].du - h[0].du)};
  }

 private:
  static constexpr int kAngles = 512;
  std::size_t index(int from, int to) const noexcept {
    return (static_cast<std::size_t>(from) * layers_ + static_cast<std::size_t>(to)) * (kAngles + 1);
  }
  std::size_t layers_;
  std::vector<RingHit> hits_;  // [from][to][angle]
};

void exit_depths(const SatfModel& model, const DensityMap* others, std::size_t instance, int plate,
                 std::span<float> out) {
  for (std::size_t i = 0; i < out.size(); ++i) {
    const float u = kTwoPi * (static_cast<float>(i) + 0.5F) / static_cast<float>(out.size());
    const glm::vec2 disk = kExitRadius * glm::vec2(std::cos(u), std::sin(u));
    out[i] = others == nullptr ? 0.0F : others->optical_depth(model.instances[instance].swept.point(plate, disk));
  }
}

/// Mean extinction of the plate [1/m], as an oblique ray in the plane sees lengthwise strands.
float mean_extinction(const SatfModel& model, std::size_t instance, int plate) noexcept {
  const Instance& of = model.instances[instance];
  const auto row = static_cast<std::size_t>(plate);
  const auto strands = model.strands_at[of.cluster * static_cast<std::size_t>(model.layout.rows) + row];
  const float area = std::numbers::pi_v<float> * std::max(of.swept.cross_sections[row].determinant(), 1e-12F);
  return model.blocked_width_m * static_cast<float>(strands) / area;
}

void shadow_row(const SatfModel& model, const RecordSource& source, const ShadowRequest& request,
                const CrossingTable& table, std::size_t instance, int plate, RowScratch& scratch,
                std::span<std::uint16_t> shadows) {
  const SweptCluster& swept = model.instances[instance].swept;
  const auto row = static_cast<std::size_t>(plate);
  const glm::vec3 to_light = towards_light(request.to_light, request.light_place, swept.frames[row].position);
  const PlateDirection light = plate_direction(swept.frames[row], swept.cross_sections[row], to_light);
  const float extinction = mean_extinction(model, instance, plate);
  exit_depths(model, request.others, instance, plate, scratch.exits);
  for (std::size_t j = 0; request.self_shadow && j < scratch.depth.size(); ++j) {
    scratch.depth[j].resize(static_cast<std::size_t>(model.layout.widths[j]));
    ring_depth(model, source, instance, static_cast<int>(j), plate, light, light, request.curvature, scratch.ring,
               scratch.depth[j], {});
  }
  for (int j = 0; j < model.division.layers; ++j) {
    const std::size_t first = model.layout.texel(instance, j, plate);
    const auto width = static_cast<std::size_t>(model.layout.widths[static_cast<std::size_t>(j)]);
    for (std::size_t x = 0; x < width; ++x) {
      const float u = kTwoPi * (static_cast<float>(x) + 0.5F) / static_cast<float>(width);
      const CrossingTable::Angle theta = CrossingTable::angle(light.phi - u);
      const RingHit exit = table.at(j, model.division.layers - 1, theta);
      float depth = around(scratch.exits, u + exit.du);
      if (request.self_shadow) {
        float lit = 0.5F * around(scratch.depth[static_cast<std::size_t>(j)], u + table.at(j, j, theta).du);
        for (int m = j + 1; m < model.division.layers; ++m) {
          lit += around(scratch.depth[static_cast<std::size_t>(m)], u + table.at(j, m, theta).du);
        }
        const float unlit = extinction * exit.path / light.stretch;
        const float share = std::clamp(0.5F + 0.5F * std::cos(light.phi - u) / kTerminator, 0.0F, 1.0F);
        depth += share * lit + (1.0F - share) * unlit;
      }
      shadows[first + x] = static_cast<std::uint16_t>(exp_neg(depth) * 65535.0F + 0.5F);
    }
  }
}

}  // namespace

void build_shadows(const SatfModel& model, const RecordSource& source, const ShadowRequest& request,
                   std::span<std::uint16_t> shadows) {
  const CrossingTable table(model.division);
  tbb::parallel_for(tbb::blocked_range<std::size_t>(0, model.instances.size(), 1), [&](const auto& range) {
    RowScratch scratch;
    scratch.depth.resize(static_cast<std::size_t>(model.division.layers));
    scratch.exits.resize(kExits);
    for (std::size_t i = range.begin(); i != range.end(); ++i) {
      for (int plate = 0; plate <= model.division.plates; ++plate) {
        shadow_row(model, source, request, table, i, plate, scratch, shadows);
      }
    }
  });
}

Strands hair_strands(const Hairstyle& style, const SatfModel& model) {
  Strands strands;
  strands.diameter_m = style.diameter_m;
  for (const Instance& instance : model.instances) {
    const Cluster& cluster = style.clusters[instance.cluster];
    std::vector<std::vector<glm::vec3>> open(cluster.strand_count());  // points of strands that go on
    const auto end = [&](std::vector<glm::vec3>& points) {
      if (points.size() > 1) strands.append(points);
      points.clear();
    };
    for (int i = 0; i <= style.division.plates; ++i) {
      const float t = static_cast<float>(i) / static_cast<float>(style.division.plates);
      std::vector<bool> crosses(open.size(), false);
      for (const Crossing& c : plate_crossings(cluster, t)) {
        if (crosses[c.strand]) open[c.strand].pop_back();  // back and forth within a plate: its last crossing
        crosses[c.strand] = true;
        open[c.strand].push_back(instance.swept.point(i, c.disk));
      }
      for (std::size_t s = 0; s < open.size(); ++s) {
        if (!crosses[s]) end(open[s]);
      }
    }
    for (auto& points : open) end(points);
  }
  return strands;
}

}  // namespace pelage
