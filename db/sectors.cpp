#include "pelage/db/sectors.h"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <optional>

namespace pelage {
namespace {

constexpr float kTwoPi = 2.0F * std::numbers::pi_v<float>;

/// Polar disk coordinates, kept inside [core, 1].
struct Polar {
  float v, u;  // u in [0, 2 pi)
};

Polar polar(glm::vec2 disk, const Division& division) {
  const float v = std::clamp(std::sqrt(disk.x * disk.x + disk.y * disk.y), division.core, 1.0F);
  const float u = std::atan2(disk.y, disk.x);
  return {v, u < 0 ? u + kTwoPi : u};
}

/// u - centre wrapped to [-pi, pi), as a sector coordinate s of a ring of n sectors.
float s_of(float u, int sector, int n) {
  const float spacing = kTwoPi / static_cast<float>(n);
  float du = u - (static_cast<float>(sector) + 0.5F) * spacing;
  du -= kTwoPi * std::floor(du / kTwoPi + 0.5F);
  return 0.5F + 0.5F * du / spacing;
}

/// Where every strand crosses every plate: [plate][strand], empty outside the strand's t-range. A strand also stands on
/// the plate before its root: between plates it would otherwise fade in over the HSV of its root and bare the scalp.
std::vector<std::vector<std::optional<Polar>>> crossings_of(const Cluster& cluster, const Division& division) {
  std::vector<std::vector<std::optional<Polar>>> at(static_cast<std::size_t>(division.plates) + 1);
  for (int i = 0; i <= division.plates; ++i) {
    auto& plate = at[static_cast<std::size_t>(i)];
    plate.resize(cluster.strand_count());
    const float t = static_cast<float>(i) / static_cast<float>(division.plates);
    for (const Crossing& c : plate_crossings(cluster, t)) plate[c.strand] = polar(c.disk, division);
  }
  for (std::size_t strand = 0; strand < cluster.strand_count(); ++strand) {
    if (cluster.strand(strand).empty()) continue;
    const DiskPoint root = cluster.strand(strand).front();
    const auto before =
        static_cast<std::size_t>(std::max(0.0F, std::floor(root.t * static_cast<float>(division.plates))));
    if (before + 1 >= at.size() || !at[before + 1][strand] || at[before][strand]) continue;
    at[before][strand] = polar({root.x, root.y}, division);
  }
  return at;
}

}  // namespace

float layer_radius(const Division& division, int surface) noexcept {
  return division.core + (1.0F - division.core) * static_cast<float>(surface) / static_cast<float>(division.layers);
}

int sectors_in_layer(const Division& division, int layer) noexcept {
  const auto middle = [&](int j) { return 0.5F * (layer_radius(division, j) + layer_radius(division, j + 1)); };
  const float share = middle(layer) / middle(division.layers - 1);
  return std::max(3, static_cast<int>(std::lround(share * static_cast<float>(division.sectors))));
}

int tracks_per_cluster(const Division& division) noexcept {
  int n = 0;
  for (int j = 0; j < division.layers; ++j) n += sectors_in_layer(division, j);
  return n;
}

glm::mat2 sector_jacobian(const Division& division, int layer, int sector, const CrossSection& s) noexcept {
  const int n = sectors_in_layer(division, layer);
  const float inner = layer_radius(division, layer);
  const float outer = layer_radius(division, layer + 1);
  const float u = (static_cast<float>(sector) + 0.5F) * kTwoPi / static_cast<float>(n);
  const float width = 0.5F * (inner + outer) * 2.0F * kTwoPi / static_cast<float>(n);
  const glm::vec2 outward{std::cos(u), std::sin(u)};
  const glm::vec2 around{-outward.y, outward.x};
  return {s.apply(width * around), s.apply((outer - inner) * outward)};
}

float sector_angle(const glm::mat2& j, glm::vec2 d) noexcept {
  const float det = j[0].x * j[1].y - j[1].x * j[0].y;
  // J^-1 d up to the positive factor 1 / |det|; the sign of det matters.
  const float sign = det < 0 ? -1.0F : 1.0F;
  const float s = sign * (d.x * j[1].y - d.y * j[1].x);
  const float r = sign * (d.y * j[0].x - d.x * j[0].y);
  return std::atan2(s, r);
}

SectorSet sectors_of(std::span<const Cluster> clusters, const Division& division) {
  SectorSet set;
  set.plates = division.plates;
  const std::size_t plates = static_cast<std::size_t>(division.plates) + 1;
  set.offsets.reserve(clusters.size() * static_cast<std::size_t>(tracks_per_cluster(division)) * plates + 1);
  for (const Cluster& cluster : clusters) {
    const auto at = crossings_of(cluster, division);
    for (int layer = 0; layer < division.layers; ++layer) {
      const int n = sectors_in_layer(division, layer);
      const float inner = layer_radius(division, layer);
      const float height = layer_radius(division, layer + 1) - inner;
      for (int k = 0; k < n; ++k) {
        for (std::size_t i = 0; i < plates; ++i) {
          double drift = 0, weight = 0;
          for (std::size_t strand = 0; strand < at[i].size(); ++strand) {
            const auto& here = at[i][strand];
            if (!here) continue;
            const glm::vec2 p{s_of(here->u, k, n), (here->v - inner) / height};
            if (p.y < -kSectorMargin || p.y > 1 + kSectorMargin) continue;
            if (p.x < -kSectorMargin || p.x > 1 + kSectorMargin) continue;
            set.crossings.push_back(p);
            if (i + 1 >= plates || !at[i + 1][strand]) continue;
            // Strands near the middle of the sector tell most about its drift; near the axis u is ill-defined.
            const float next = s_of(at[i + 1][strand]->u, k, n);
            const auto w = static_cast<double>(std::max(0.0F, 1.0F - std::abs(2.0F * p.x - 1.0F)));
            if (std::abs(next - p.x) > 0.5F) continue;
            drift += w * static_cast<double>(next - p.x);
            weight += w;
          }
          set.offsets.push_back(static_cast<std::uint32_t>(set.crossings.size()));
          set.drift.push_back(weight > 0 ? static_cast<float>(drift / weight) : 0.0F);
        }
      }
    }
  }
  return set;
}

}  // namespace pelage
