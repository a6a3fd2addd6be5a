#include "pelage/satf/maps.h"

#include <tbb/blocked_range.h>
#include <tbb/parallel_for.h>

#include <algorithm>
#include <cmath>
#include <glm/common.hpp>
#include <glm/geometric.hpp>
#include <numbers>

#include "pelage/data_schema/numeric.h"

namespace pelage {
namespace {

constexpr float kPi = std::numbers::pi_v<float>;
constexpr float kReRange = 8.0F;

/// One path per CPU; without contraction all give the same bits.
#define PELAGE_CLONES __attribute__((target_clones("avx2", "default")))

/// Adds one sector's record to the ring, weighted by the hat window.
PELAGE_CLONES void splat_record(const float* __restrict tau, const float* __restrict re, int n, float* __restrict depth,
                                float* __restrict weighted) noexcept {
  const float step = 2.0F / static_cast<float>(n);
  for (int x = 0; x < n; ++x) {
    const float w = (1.0F - std::abs(step * (static_cast<float>(x) + 0.5F) - 1.0F)) * tau[x];
    depth[x] += w;
    weighted[x] += w * re[x];
  }
}
PELAGE_CLONES void splat_tau(const float* __restrict tau, int n, float* __restrict depth) noexcept {
  const float step = 2.0F / static_cast<float>(n);
  for (int x = 0; x < n; ++x) depth[x] += (1.0F - std::abs(step * (static_cast<float>(x) + 0.5F) - 1.0F)) * tau[x];
}

/// Straight reflectance from the sums, drawn towards 1, the mean over light angles, where `share` of it is not known.
PELAGE_CLONES void straighten(const float* __restrict tau, const float* __restrict weighted, float share, std::size_t n,
                              float* __restrict re) noexcept {
  for (std::size_t x = 0; x < n; ++x) {
    const float straight = tau[x] > 1e-12F ? weighted[x] / std::max(tau[x], 1e-12F) : 1.0F;
    re[x] = 1.0F + share * (straight - 1.0F);
  }
}

PELAGE_CLONES void depth_to_alpha(float* values, std::size_t n) noexcept {
  for (std::size_t x = 0; x < n; ++x) values[x] = 1.0F - exp_neg(values[x]);
}

inline std::uint32_t quantise(float share, float levels) noexcept {
  return static_cast<std::uint32_t>(static_cast<std::int32_t>(std::min(std::max(share, 0.0F), 1.0F) * levels + 0.5F));
}

PELAGE_CLONES void pack_row(const float* __restrict alpha, const float* __restrict re,
                            const float* __restrict transmittance, std::size_t n, Texel* __restrict out) noexcept {
  for (std::size_t x = 0; x < n; ++x) {
    out[x] = quantise(alpha[x], 1023.0F) | quantise(re[x] * (1.0F / kReRange), 4095.0F) << 10 |
             quantise(transmittance[x], 1023.0F) << 22;
  }
}

/// Folds the padding of a closed ring back: entries [0, pad) belong to the end, [pad + width, ...) to the beginning.
void fold_padding(std::span<float> padded, std::size_t width, std::size_t pad) noexcept {
  for (std::size_t x = 0; x < pad; ++x) padded[pad + width - pad + x] += padded[x];
  for (std::size_t x = 0; x < pad; ++x) padded[pad + x] += padded[pad + width + x];
}

/// Linear in s through the true angles at s = 1/4 and 3/4, between which a sector's window has most of its weight: the
/// chord through s = 0 and 1 overestimates the path of oblique rays by up to 40 %.
SatfAngles sector_angles(const RingShape& ring, int sector, const PlateDirection& d, float light_minus_view) noexcept {
  const float spacing = 2.0F * kPi / static_cast<float>(ring.sectors);
  const float centre = (static_cast<float>(sector) + 0.5F) * spacing;
  const float low = warp_angle(ring, d.phi - centre + 0.5F * spacing);
  const float high = warp_angle(ring, d.phi - centre - 0.5F * spacing);
  const float first = 1.5F * low - 0.5F * high, last = 1.5F * high - 0.5F * low;
  return {first, last, first + light_minus_view, last + light_minus_view};
}

/// Sum over the ring's sectors of the records seen under one direction. Output: `scratch.depth` (tau, at c0) and
/// `scratch.weighted` (tau times re), width entries from index pad.
void sum_ring(const SatfModel& model, const RecordSource& source, std::size_t instance, int layer, int plate,
              const PlateDirection& d, float light_minus_view, bool with_re, RingScratch& scratch) noexcept {
  const RingShape ring = ring_shape(model.division, layer);
  const auto n = static_cast<std::size_t>(model.samples);
  const std::size_t width = static_cast<std::size_t>(ring.sectors) * n / 2;
  const std::size_t pad = n / 4;
  scratch.tau.resize(n);
  scratch.reflectance.resize(n);
  scratch.depth.assign(width + 2 * pad, 0.0F);
  scratch.weighted.assign(width + 2 * pad, 0.0F);
  const std::size_t first = model.track(instance, layer, 0) + static_cast<std::size_t>(plate);
  for (int k = 0; k < ring.sectors; ++k) {
    const std::size_t sector = first + static_cast<std::size_t>(k) * static_cast<std::size_t>(model.layout.rows);
    if (model.sectors.sector(sector).empty()) continue;
    const auto re = with_re ? std::span<float>(scratch.reflectance) : std::span<float>();
    source.evaluate(sector, sector_angles(ring, k, d, light_minus_view), scratch.tau, re);
    // Sector k starts a quarter record before its spacing does: x = X + n/4 - k n/2.
    const std::size_t start = static_cast<std::size_t>(k) * n / 2;
    if (with_re) {
      splat_record(scratch.tau.data(), re.data(), model.samples, scratch.depth.data() + start,
                   scratch.weighted.data() + start);
    } else {
      splat_tau(scratch.tau.data(), model.samples, scratch.depth.data() + start);
    }
  }
  fold_padding(scratch.depth, width, pad);
  if (with_re) fold_padding(scratch.weighted, width, pad);
}

/// Eq. 12 with exp over the alpha-maps at the same (u, t): chi(k) is every outer layer; half of the own layer counts.
float paper_transmittance(const SatfModel& model, const std::vector<std::vector<float>>& alpha, int layer,
                          std::size_t x, float strength) noexcept {
  const auto own = static_cast<std::size_t>(layer);
  const float u = (static_cast<float>(x) + 0.5F) / static_cast<float>(model.layout.widths[own]);
  float sum = 0.5F * alpha[own][x];
  for (std::size_t m = own + 1; m < alpha.size(); ++m) {
    sum += alpha[m][static_cast<std::size_t>(u * static_cast<float>(alpha[m].size()))];
  }
  return exp_neg(strength * sum);
}

struct InstanceScratch {
  RingScratch ring;
  std::vector<std::vector<float>> alpha, re;  // [layer][x]
  std::vector<float> transmittance;           // [x]
};

void build_row(const SatfModel& model, const RecordSource& source, const MapRequest& request,
               std::span<const std::uint16_t> shadows, std::span<Texel> texels, std::size_t instance, int plate,
               InstanceScratch& scratch) {
  const SweptCluster& swept = model.instances[instance].swept;
  const auto row = static_cast<std::size_t>(plate);
  const Frame& frame = swept.frames[row];
  const PlateDirection view =
      plate_direction(frame, swept.cross_sections[row], glm::normalize(request.eye - frame.position));
  const glm::vec3 to_light = towards_light(request.to_light, request.light_place, frame.position);
  const PlateDirection light = plate_direction(frame, swept.cross_sections[row], to_light);
  for (int j = 0; j < model.division.layers; ++j) {
    const auto layer = static_cast<std::size_t>(j);
    auto& alpha = scratch.alpha[layer];
    auto& re = scratch.re[layer];
    alpha.resize(static_cast<std::size_t>(model.layout.widths[layer]));
    re.resize(alpha.size());
    ring_depth(model, source, instance, j, plate, view, light, false, scratch.ring, alpha, re);
    depth_to_alpha(alpha.data(), alpha.size());
  }
  for (int j = 0; j < model.division.layers; ++j) {
    const auto layer = static_cast<std::size_t>(j);
    const std::size_t first = model.layout.texel(instance, j, plate);
    const std::size_t width = scratch.alpha[layer].size();
    scratch.transmittance.assign(width, 1.0F);
    for (std::size_t x = 0; x < width && !shadows.empty(); ++x) {
      scratch.transmittance[x] = static_cast<float>(shadows[first + x]) * (1.0F / 65535.0F);
    }
    for (std::size_t x = 0; x < width && request.settings.self_shadow == SelfShadow::paper; ++x) {
      scratch.transmittance[x] *=
          paper_transmittance(model, scratch.alpha, j, x, request.settings.self_shadow_strength);
    }
    pack_row(scratch.alpha[layer].data(), scratch.re[layer].data(), scratch.transmittance.data(), width,
             texels.data() + first);
  }
}

}  // namespace

Texel pack_texel(const TexelValues& v) noexcept {
  Texel t = 0;
  pack_row(&v.alpha, &v.re, &v.transmittance, 1, &t);
  return t;
}

TexelValues unpack_texel(Texel t) noexcept {
  return {static_cast<float>(t & 1023U) / 1023.0F, static_cast<float>((t >> 10) & 4095U) * (kReRange / 4095.0F),
          static_cast<float>(t >> 22) / 1023.0F};
}

void ring_depth(const SatfModel& model, const RecordSource& source, std::size_t instance, int layer, int plate,
                const PlateDirection& d, const PlateDirection& l, bool curvature, RingScratch& scratch,
                std::span<float> depth, std::span<float> re) noexcept {
  const RingShape ring = ring_shape(model.division, layer);
  const std::size_t pad = static_cast<std::size_t>(model.samples) / 4;
  const float trust = azimuth_weight(d.planar);
  const bool with_re = !re.empty();
  sum_ring(model, source, instance, layer, plate, d, l.plane_angle - d.plane_angle, with_re, scratch);
  // Light along the axis has no azimuth: the mean over light angles, 1. So has a view along the axis.
  if (with_re) {
    straighten(scratch.depth.data() + pad, scratch.weighted.data() + pad, azimuth_weight(l.planar) * trust, re.size(),
               re.data());
  }
  for (std::size_t x = 0; x < depth.size(); ++x) depth[x] = trust * scratch.depth[pad + x];
  if (trust < 1.0F) {
    constexpr int kAround = 8;
    for (int i = 0; i < kAround; ++i) {
      PlateDirection turned = d;
      turned.phi = 2.0F * kPi * static_cast<float>(i) / kAround;
      sum_ring(model, source, instance, layer, plate, turned, 0.0F, false, scratch);
      for (std::size_t x = 0; x < depth.size(); ++x) depth[x] += (1.0F - trust) / kAround * scratch.depth[pad + x];
    }
  }
  scratch.factors.resize(depth.size());
  const std::size_t row = instance * static_cast<std::size_t>(model.layout.rows) + static_cast<std::size_t>(plate);
  const float mass =
      model.mass_per_area[row * static_cast<std::size_t>(model.division.layers) + static_cast<std::size_t>(layer)] /
      source.reference_scale();
  depth_factors(ring, model.rings[static_cast<std::size_t>(layer)], d, mass, model.max_path, curvature,
                scratch.factors);
  if (trust < 1.0F) {
    // The factors depend on the azimuth too: along the axis the mean factor of the ring counts.
    float mean = 0.0F;
    for (const float f : scratch.factors) mean += f / static_cast<float>(scratch.factors.size());
    for (float& f : scratch.factors) f = mean + trust * (f - mean);
  }
  for (std::size_t x = 0; x < depth.size(); ++x) depth[x] *= scratch.factors[x];
}

void build_maps(const SatfModel& model, const RecordSource& source, const MapRequest& request,
                std::span<const std::uint16_t> shadows, std::span<Texel> texels) {
  tbb::parallel_for(tbb::blocked_range<std::size_t>(0, model.instances.size(), 1), [&](const auto& range) {
    InstanceScratch scratch;
    scratch.alpha.resize(static_cast<std::size_t>(model.division.layers));
    scratch.re.resize(scratch.alpha.size());
    for (std::size_t i = range.begin(); i != range.end(); ++i) {
      for (int plate = 0; plate <= model.division.plates; ++plate) {
        build_row(model, source, request, shadows, texels, i, plate, scratch);
      }
    }
  });
}

namespace {

/// alpha, alpha re, alpha re transmittance at texel coordinate x of a row, linear between texel centres.
glm::vec3 sample_row(std::span<const Texel> texels, std::size_t first, int width, float x) noexcept {
  const float base = std::floor(x - 0.5F);
  const auto texel = [&](int i) {
    const TexelValues v = unpack_texel(texels[first + static_cast<std::size_t>(((i % width) + width) % width)]);
    return glm::vec3(v.alpha, v.alpha * v.re, v.alpha * v.re * v.transmittance);
  };
  const auto i = static_cast<int>(base);
  return glm::mix(texel(i), texel(i + 1), x - 0.5F - base);
}

/// Mean drift of an HSV at texel coordinate x, in texels.
float drift_at(const SatfModel& model, std::size_t instance, int layer, int plate, float x) noexcept {
  const int n = sectors_in_layer(model.division, layer);
  const float k =
      x / static_cast<float>(model.layout.widths[static_cast<std::size_t>(layer)]) * static_cast<float>(n) - 0.5F;
  const auto drift = [&](int sector) {
    return model.sectors.drift[model.track(instance, layer, ((sector % n) + n) % n) + static_cast<std::size_t>(plate)];
  };
  const auto k0 = static_cast<int>(std::floor(k));
  return std::lerp(drift(k0), drift(k0 + 1), k - std::floor(k)) * static_cast<float>(model.samples);
}

}  // namespace

std::vector<glm::vec3> plate_views(const SatfModel& model, glm::vec3 eye) {
  std::vector<glm::vec3> views;
  for (const Instance& instance : model.instances) {
    for (std::size_t i = 0; i < instance.swept.frames.size(); ++i) {
      const Frame& frame = instance.swept.frames[i];
      const PlateDirection d =
          plate_direction(frame, instance.swept.cross_sections[i], glm::normalize(eye - frame.position));
      views.emplace_back(d.disk, azimuth_weight(d.planar));
    }
  }
  return views;
}

float curved_alpha(float slab_alpha, const RingShape& ring, float cos_t, float trust, float max_path) noexcept {
  const float exponent = 1.0F + trust * (chord_ratio(ring, cos_t, max_path) - 1.0F);
  return 1.0F - std::pow(1.0F - slab_alpha, exponent);
}

TexelValues sample_map(const SatfModel& model, std::span<const Texel> texels, std::size_t instance, int layer, float x,
                       float at, bool use_drift, std::span<const glm::vec3> views) noexcept {
  const int row = std::clamp(static_cast<int>(std::floor(at)), 0, model.layout.rows - 2);
  const float along = std::clamp(at - static_cast<float>(row), 0.0F, 1.0F);
  const float moved = use_drift ? drift_at(model, instance, layer, row, x) : 0.0F;
  const int width = model.layout.widths[static_cast<std::size_t>(layer)];
  const glm::vec3 here = sample_row(texels, model.layout.texel(instance, layer, row), width, x - moved * along);
  const glm::vec3 next =
      sample_row(texels, model.layout.texel(instance, layer, row + 1), width, x + moved * (1 - along));
  const glm::vec3 mean = glm::mix(here, next, along);
  TexelValues values{mean.x, mean.x > 0 ? mean.y / mean.x : 1.0F, mean.y > 0 ? mean.z / mean.y : 1.0F};
  if (!views.empty()) {
    const std::size_t first = instance * static_cast<std::size_t>(model.layout.rows) + static_cast<std::size_t>(row);
    const glm::vec3 view = glm::mix(views[first], views[first + 1], along);
    const float u = 2.0F * kPi * x / static_cast<float>(width);
    const float cos_t = (view.x * std::cos(u) + view.y * std::sin(u)) / std::max(std::hypot(view.x, view.y), 1e-6F);
    values.alpha = curved_alpha(values.alpha, ring_shape(model.division, layer), cos_t, view.z, model.max_path);
  }
  return values;
}

}  // namespace pelage
