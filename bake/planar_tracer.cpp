#include "pelage/bake/planar_tracer.h"

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <cstdint>
#include <numbers>

#include "pelage/bake/planar_reference.h"
#include "pelage/data_schema/errors.h"
#include "pelage/data_schema/numeric.h"

// Wider vectors where the CPU has them (an AVX-512 clone was no faster over lights and a third slower over rays);
// without contraction and without reductions over lanes every clone gives the same bits. Sanitizers instrument the
// resolvers, which run before their own set-up, so they get one version.
#if defined(__x86_64__) && !defined(__SANITIZE_ADDRESS__) && !defined(__SANITIZE_THREAD__) && !defined(__clang__)
#define PELAGE_SIMD __attribute__((target_clones("avx2", "default")))
#else
#define PELAGE_SIMD
#endif

namespace pelage {
namespace {

constexpr int kMaxRays = 256;    // upper bound of BakeSettings::samples
constexpr int kBatch = 8;        // steps sampled at once
constexpr int kLightBlock = 16;  // light arrays are padded to whole blocks
/// Weight below which a step is not shaded: 256 of them change straight reflectance by < 3e-4 where nothing else is
/// seen.
constexpr float kNegligibleWeight = 1e-11F;

using Float4 = float __attribute__((vector_size(16)));
using PerRay = std::array<float, kMaxRays + 16>;

/// Rays that march together, structure of arrays. Positions in cells: column c0 + k dc, row r0 + k dr at step k.
struct alignas(64) Rays {
  PerRay column, column_step, row, row_step, scale;  // scale: c0 times the length of a step
  PerRay view_s, view_r;
  PerRay tau, opacity;  // results
  int count, steps;
};

/// What a step of each ray adds: weight of the diffuse term times the normal, of the specular term, the reflected view,
/// and the isotropic part.
struct alignas(64) Shades {
  PerRay diffuse_s, diffuse_r, reflected_s, reflected_r, specular, isotropic;
};

struct Lobe {
  float diffuse, specular, flat_sq;  // flat_sq = (kFlatness / sigma)^2
  float early_stop;
};

/// 1 - exp(-x), x >= 0, relative error < 1e-6 also for small x: with -x = k ln2 + y, |y| <= ln2 / 2, it is
/// (1 - 2^k) - 2^k (e^y - 1), whose first term is exactly 0 for k = 0. Reduction and polynomial as in exp_neg.
inline float opacity_of(float x) {
  const float bounded = std::min(x, 87.0F);
  const auto k = static_cast<std::int32_t>(-1.44269504F * bounded - 0.5F);
  const auto kf = static_cast<float>(k);
  const float y = (-bounded - kf * 0.693359375F) + kf * 2.12194440e-4F;
  float p = 1.0F / 720.0F;
  p = p * y + 1.0F / 120.0F;
  p = p * y + 1.0F / 24.0F;
  p = p * y + 1.0F / 6.0F;
  p = p * y + 0.5F;
  p = p * y + 1.0F;
  const float two_k = std::bit_cast<float>((k + 127) << 23);
  return (1 - two_k) - two_k * (p * y);
}

/// -ln x for x in (0, 1], error < 2e-7 (1 + |ln x|): mantissa in [sqrt(1/2), sqrt(2)), ln m = 2 atanh((m-1)/(m+1)).
inline float neg_log(float x) {
  const auto bits = std::bit_cast<std::int32_t>(x);
  const std::int32_t exponent = (bits - 0x3f3504f3) >> 23;
  const float m = std::bit_cast<float>(bits - (exponent << 23));
  const float z = (m - 1) / (m + 1);
  const float z2 = z * z;
  const float atanh = z * (1 + z2 * (1.0F / 3 + z2 * (0.2F + z2 * (1.0F / 7 + z2 * (1.0F / 9)))));
  return -(static_cast<float>(exponent) * 0.693147181F + 2 * atanh);
}

/// max(0, x)^p: `kSquarings` squarings, or any p when that is negative.
template <int kSquarings>
inline __attribute__((always_inline)) float lobe_power(float x, float p) {
  float y = std::max(0.0F, x);
  if constexpr (kSquarings < 0) return exp_neg(p * neg_log(std::max(1e-30F, std::min(1.0F, y))));
  for (int i = 0; i < kSquarings; ++i) y *= y;
  return y;
}

/// Column wrapped into [0, n): cell index and fraction.
inline void wrap_column(float column, float n, float inv_n, std::int32_t& cell, float& fraction) {
  // Any sign; the truncated quotient may be one off by rounding.
  float x = column - n * static_cast<float>(static_cast<std::int32_t>(column * inv_n));
  x = x < 0 ? x + n : x;
  x = x >= n ? x - n : x;
  cell = static_cast<std::int32_t>(x);
  fraction = x - static_cast<float>(cell);
}

/// Bilinear samples of density and gradient at step k of every ray: [ray] nodes.
PELAGE_SIMD void sample_step(const PlanarField::Node* nodes, int size, const Rays& rays, float k,
                             PlanarField::Node* out) {
  std::array<std::int32_t, kMaxRays> index;
  PerRay a, b;
  const float n = static_cast<float>(size), inv_n = 1 / n;
  const std::int32_t stride = size + 1;
  const int count = rays.count;
  for (int i = 0; i < count; ++i) {
    std::int32_t cell;
    wrap_column(rays.column[i] + k * rays.column_step[i], n, inv_n, cell, a[i]);
    // Rows lie in [1/2, size + 1/2]; the bounds only meet rounding.
    const float row = std::min(std::max(rays.row[i] + k * rays.row_step[i], 0.0F), n + 0.999F);
    const auto j = static_cast<std::int32_t>(row);
    b[i] = row - static_cast<float>(j);
    index[i] = j * stride + cell;
  }
  for (int i = 0; i < count; ++i) {
    const auto* at = reinterpret_cast<const Float4*>(nodes + index[i]);
    const Float4 low = at[0] + (at[1] - at[0]) * a[i];
    const Float4 high = at[stride] + (at[stride + 1] - at[stride]) * a[i];
    *reinterpret_cast<Float4*>(out + i) = low + (high - low) * b[i];
  }
}

/// Advances optical depth alone.
PELAGE_SIMD void advance_tau(const PlanarField::Node* at, Rays& rays) {
  for (int i = 0; i < rays.count; ++i) rays.tau[i] += rays.scale[i] * at[i].rho;
}

/// Advances optical depth and opacity, and turns the step's weight into what shading needs.
PELAGE_SIMD void advance(const PlanarField::Node* __restrict at, const Lobe& lobe, Rays& __restrict rays,
                         PerRay& __restrict weight, Shades& __restrict out) {
  constexpr float kTiny = 1e-30F;  // keeps 0/0 from being NaN; far below any gradient that counts
  const int count = rays.count;
  PerRay step_opacity;
  for (int i = 0; i < count; ++i) {
    const float dtau = rays.scale[i] * at[i].rho;
    rays.tau[i] += dtau;
    step_opacity[i] = opacity_of(dtau);
  }
  for (int i = 0; i < count; ++i) {
    const float open = rays.opacity[i] < lobe.early_stop ? 1.0F : 0.0F;
    weight[i] = open * ((1 - rays.opacity[i]) * step_opacity[i]);
    rays.opacity[i] += weight[i];
  }
  for (int i = 0; i < count; ++i) {
    const float rho = at[i].rho, gs = at[i].gradient_s, gr = at[i].gradient_r;
    const float g2 = gs * gs + gr * gr;
    const float share = g2 / (g2 + lobe.flat_sq * (rho * rho) + kTiny);
    const float inv = -1 / std::sqrt(g2 + kTiny);
    const float vs = rays.view_s[i], vr = rays.view_r[i];
    const float facing = (gs * vs + gr * vr) * inv;
    const float mirror = 2 * std::min(0.0F, facing);
    const float ns = gs * inv - mirror * vs, nr = gr * inv - mirror * vr;
    const float twice = 2 * std::abs(facing);
    const float shiny = weight[i] * share;
    out.isotropic[i] = weight[i] - shiny;
    out.specular[i] = shiny * lobe.specular;
    out.diffuse_s[i] = shiny * lobe.diffuse * ns;
    out.diffuse_r[i] = shiny * lobe.diffuse * nr;
    out.reflected_s[i] = twice * ns - vs;
    out.reflected_r[i] = twice * nr - vr;
  }
}

struct Lights {
  const float *s, *r;  // [padded]
  int padded;
  float exponent;
};

/// One step of one ray under all lights: sum[light] += reflectance times weight.
template <int kSquarings>
inline __attribute__((always_inline)) void shade_lights(const Lights& lights, const Shades& shade, int i,
                                                        float* __restrict sum) {
  const float ds = shade.diffuse_s[i], dr = shade.diffuse_r[i], rs = shade.reflected_s[i], rr = shade.reflected_r[i];
  const float specular = shade.specular[i], isotropic = shade.isotropic[i];
  const float* __restrict ls = lights.s;
  const float* __restrict lr = lights.r;
  for (int first = 0; first < lights.padded; first += kLightBlock)
    for (int l = first; l < first + kLightBlock; ++l) {
      const float diffuse = std::max(0.0F, ds * ls[l] + dr * lr[l]);
      sum[l] += (isotropic + diffuse) + specular * lobe_power<kSquarings>(rs * ls[l] + rr * lr[l], lights.exponent);
    }
}

template <int kSquarings>
inline __attribute__((always_inline)) void shade_rays(const Lights& lights, const PerRay& weight, const Shades& shade,
                                                      int count, float* sum) {
  for (int i = 0; i < count; ++i)
    if (weight[i] > kNegligibleWeight) shade_lights<kSquarings>(lights, shade, i, sum + i * lights.padded);
}

PELAGE_SIMD void shade_all(const Lights& lights, int squarings, const PerRay& weight, const Shades& shade, int count,
                           float* sum) {
  switch (squarings) {
    case 2:
      return shade_rays<2>(lights, weight, shade, count, sum);
    case 3:
      return shade_rays<3>(lights, weight, shade, count, sum);
    case 4:
      return shade_rays<4>(lights, weight, shade, count, sum);
    case 5:
      return shade_rays<5>(lights, weight, shade, count, sum);
    case 6:
      return shade_rays<6>(lights, weight, shade, count, sum);
    default:
      return shade_rays<-1>(lights, weight, shade, count, sum);
  }
}

template <int kSquarings>
inline __attribute__((always_inline)) void shade_one_light(const PerRay& ls, const PerRay& lr, float exponent,
                                                           const Shades& shade, int count, PerRay& sum) {
  for (int i = 0; i < count; ++i) {
    const float diffuse = std::max(0.0F, shade.diffuse_s[i] * ls[i] + shade.diffuse_r[i] * lr[i]);
    const float cosine = shade.reflected_s[i] * ls[i] + shade.reflected_r[i] * lr[i];
    sum[i] += (shade.isotropic[i] + diffuse) + shade.specular[i] * lobe_power<kSquarings>(cosine, exponent);
  }
}

/// One step of every ray under its own light.
PELAGE_SIMD void shade_own(const PerRay& ls, const PerRay& lr, int squarings, float exponent, const Shades& shade,
                           int count, PerRay& sum) {
  if (squarings == 3)
    shade_one_light<3>(ls, lr, exponent, shade, count, sum);
  else
    shade_one_light<-1>(ls, lr, exponent, shade, count, sum);
}

/// sum_x weight * in[x] for `width` neighbouring values: out[j] += weight * in[j].
PELAGE_SIMD void add_scaled(const float* __restrict in, float weight, float* __restrict out, int width) {
  for (int j = 0; j < width; ++j) out[j] += weight * in[j];
}

/// Calls `visit` with the samples of each step of all rays. Steps are sampled in batches: reading a sample right after
/// it was written, in wider pieces, would wait for the store.
template <class Visit>
void march(const PlanarField& field, const Rays& rays, PlanarField::Node* at, const Visit& visit) {
  for (int first = 0; first < rays.steps; first += kBatch) {
    const int last = std::min(rays.steps, first + kBatch);
    for (int k = first; k < last; ++k)
      sample_step(field.nodes(), field.size(), rays, static_cast<float>(k), at + (k - first) * rays.count);
    for (int k = first; k < last; ++k) visit(at + (k - first) * rays.count);
  }
}

struct Ray {
  float s;  // entry
  double view_rad;
};

/// Sets up `count` rays; all take as many steps as the longest needs, each of its own length.
template <class RayAt>
void start(Rays& rays, int count, const RayAt& ray_at, int size, const BakeSettings& settings) {
  rays.count = count;
  double longest = 0;
  std::array<double, kMaxRays> length;
  for (int i = 0; i < count; ++i) {
    const Ray ray = ray_at(i);
    double cosine = std::cos(ray.view_rad);
    if (std::abs(cosine) < kGrazingCosine) cosine = 0;
    rays.view_s[i] = static_cast<float>(std::sin(ray.view_rad));
    rays.view_r[i] = static_cast<float>(cosine);
    length[i] = cosine == 0 ? settings.max_path : std::min(1 / std::abs(cosine), settings.max_path);
    longest = std::max(longest, length[i]);
    rays.tau[i] = rays.opacity[i] = 0;
  }
  rays.steps = static_cast<int>(std::ceil(longest * 2 * size - kStepSlack));
  const auto n = static_cast<float>(size);
  for (int i = 0; i < count; ++i) {
    const auto step = static_cast<float>(length[i] / rays.steps);
    rays.scale[i] = static_cast<float>(settings.reference_scale) * step;
    rays.column_step[i] = -rays.view_s[i] * step * n;
    rays.row_step[i] = -rays.view_r[i] * step * n;
    rays.column[i] = ray_at(i).s * n - 0.5F + 0.5F * rays.column_step[i];
    // Row 0 of the nodes is the extrapolated one below the grid.
    rays.row[i] = (rays.view_r[i] >= 0 ? n : 0.0F) + 0.5F + 0.5F * rays.row_step[i];
  }
}

int squarings_of(double exponent) {
  for (int q = 2; q <= 6; ++q)
    if (exponent == std::exp2(q)) return q;
  return -1;
}

}  // namespace

void PlanarField::assign(const DensityGrid& grid) {
  PELAGE_ASSERT(grid.size >= 2);
  size_ = grid.size;
  const auto n = static_cast<std::size_t>(size_);
  empty_ = std::all_of(grid.values.begin(), grid.values.end(), [](double v) { return v == 0; });
  if (empty_) return;
  rows_.resize((n + 4) * n);
  for (std::size_t i = 0; i < n * n; ++i) rows_[2 * n + i] = static_cast<float>(grid.values[i]);
  for (std::size_t s = 0; s < n; ++s) {
    const float low = rows_[2 * n + s], low_slope = low - rows_[3 * n + s];
    const float high = rows_[(n + 1) * n + s], high_slope = high - rows_[n * n + s];
    rows_[n + s] = std::max(0.0F, low + low_slope);
    rows_[s] = std::max(0.0F, low + 2 * low_slope);
    rows_[(n + 2) * n + s] = std::max(0.0F, high + high_slope);
    rows_[(n + 3) * n + s] = std::max(0.0F, high + 2 * high_slope);
  }
  nodes_.resize((n + 2) * (n + 1));
  const float half_n = 0.5F * static_cast<float>(size_);
  for (std::size_t r = 0; r < n + 2; ++r) {
    const float* row = rows_.data() + (r + 1) * n;
    Node* out = nodes_.data() + r * (n + 1);
    for (std::size_t s = 0; s < n; ++s) {
      const float along_s = row[s + 1 == n ? 0 : s + 1] - row[s == 0 ? n - 1 : s - 1];
      out[s] = {row[s], half_n * along_s, half_n * (row[s + n] - (row - n)[s]), 0};
    }
    out[n] = out[0];
  }
}

PlanarTracer::PlanarTracer(const BakeSettings& settings) : settings_(settings) {
  PELAGE_ASSERT(settings.samples >= 1 && settings.samples <= kMaxRays);
  const double mean = mean_phong(settings.phong);
  diffuse_ = static_cast<float>(settings.phong.diffuse / mean);
  specular_ = static_cast<float>(settings.phong.specular / mean);
  squarings_ = squarings_of(settings.phong.exponent);

  const auto padded = static_cast<std::size_t>((settings.lights + kLightBlock - 1) / kLightBlock * kLightBlock);
  light_s_.resize(padded);
  light_r_.resize(padded);
  for (int l = 0; l < settings.lights; ++l) {
    const double angle = 2 * std::numbers::pi * l / settings.lights;
    light_s_[static_cast<std::size_t>(l)] = static_cast<float>(std::sin(angle));
    light_r_[static_cast<std::size_t>(l)] = static_cast<float>(std::cos(angle));
  }

  const double sigma = settings.sigma * settings.smoothing;
  if (sigma <= 0) {
    taps_.push_back({0, 1.0F});
    return;
  }
  std::vector<double> kernel(static_cast<std::size_t>(settings.samples));
  double total = 0;
  for (int d = 0; d < settings.samples; ++d)
    for (int period = -4; period <= 4; ++period) {
      const double x = static_cast<double>(d) / settings.samples + period;
      const double g = std::exp(-0.5 * x * x / (sigma * sigma));
      kernel[static_cast<std::size_t>(d)] += g;
      total += g;
    }
  // Taps below 1e-7 of the sum are below float's rounding.
  for (int d = 0; d < settings.samples; ++d)
    if (const double w = kernel[static_cast<std::size_t>(d)] / total; w > 1e-7)
      taps_.push_back({d, static_cast<float>(w)});
}

float PlanarTracer::straight(float premultiplied, float opacity) const noexcept {
  constexpr auto kEmpty = static_cast<float>(kEmptyOpacity);
  return (premultiplied + kEmpty) / (opacity + kEmpty);
}

void PlanarTracer::smooth(std::span<const float> in, std::span<float> out) const noexcept {
  const int n = static_cast<int>(in.size());
  std::fill(out.begin(), out.end(), 0.0F);
  for (const Tap& tap : taps_) {
    add_scaled(in.data() + tap.offset, tap.weight, out.data(), n - tap.offset);
    add_scaled(in.data(), tap.weight, out.data() + n - tap.offset, tap.offset);
  }
}

HrirRecord PlanarTracer::trace_record(const DensityGrid& grid) const {
  HrirRecord record{{settings_.views, settings_.lights, settings_.samples}, {}, {}};
  record.tau.assign(record.shape.tau_size(), 0.0F);
  record.re.assign(record.shape.re_size(), 1.0F);
  const PlanarField field(grid);
  if (field.empty()) return record;

  const int samples = settings_.samples;
  const auto count = static_cast<std::size_t>(samples);
  const Lights lights{light_s_.data(), light_r_.data(), static_cast<int>(light_s_.size()),
                      static_cast<float>(settings_.phong.exponent)};
  const double flat = kFlatness / settings_.sigma;
  const Lobe lobe{diffuse_, specular_, static_cast<float>(flat * flat), static_cast<float>(settings_.early_stop)};
  const std::size_t row = light_s_.size();
  std::vector<float> sum(count * row), smoothed(count * row);  // [ray][light]
  Rays rays;
  Shades shades;
  PerRay weight, opacity;
  std::array<PlanarField::Node, kBatch * kMaxRays> at;

  for (int v = 0; v < settings_.views; ++v) {
    const double angle = 2 * std::numbers::pi * v / settings_.views;
    const auto ray_at = [&](int i) { return Ray{(static_cast<float>(i) + 0.5F) / static_cast<float>(samples), angle}; };
    start(rays, samples, ray_at, field.size(), settings_);
    std::fill(sum.begin(), sum.end(), 0.0F);
    march(field, rays, at.data(), [&](const PlanarField::Node* step) {
      advance(step, lobe, rays, weight, shades);
      shade_all(lights, squarings_, weight, shades, samples, sum.data());
    });
    smooth({rays.tau.data(), count}, {record.tau.data() + static_cast<std::size_t>(v) * count, count});
    smooth({rays.opacity.data(), count}, {opacity.data(), count});
    std::fill(smoothed.begin(), smoothed.end(), 0.0F);
    for (std::size_t x = 0; x < count; ++x)
      for (const Tap& tap : taps_) {
        const std::size_t from = (x + static_cast<std::size_t>(tap.offset)) % count;
        add_scaled(sum.data() + from * row, tap.weight, smoothed.data() + x * row, static_cast<int>(row));
      }
    const auto view_lights = static_cast<std::size_t>(settings_.lights);
    float* re = record.re.data() + static_cast<std::size_t>(v) * view_lights * count;
    for (std::size_t l = 0; l < view_lights; ++l)
      for (std::size_t x = 0; x < count; ++x) re[l * count + x] = straight(smoothed[x * row + l], opacity[x]);
  }
  return record;
}

void PlanarTracer::trace_rays(const PlanarField& field, const SatfAngles& angles, std::span<float> tau,
                              std::span<float> re) const noexcept {
  const int samples = settings_.samples;
  const auto count = static_cast<std::size_t>(samples);
  PELAGE_ASSERT(tau.size() == count && (re.empty() || re.size() == count));
  if (field.empty()) {
    std::fill(tau.begin(), tau.end(), 0.0F);
    std::fill(re.begin(), re.end(), 1.0F);
    return;
  }
  const double flat = kFlatness / settings_.sigma;
  const Lobe lobe{diffuse_, specular_, static_cast<float>(flat * flat), static_cast<float>(settings_.early_stop)};
  Rays rays;
  Shades shades;
  PerRay weight, light_s, light_r, sum, smoothed, opacity;
  std::array<PlanarField::Node, kBatch * kMaxRays> at;
  const auto at_s = [&](int i) { return (static_cast<float>(i) + 0.5F) / static_cast<float>(samples); };
  const auto lerp = [](float a, float b, float t) { return static_cast<double>(a + (b - a) * t); };
  start(
      rays, samples,
      [&](int i) {
        return Ray{at_s(i), lerp(angles.view_first, angles.view_last, at_s(i))};
      },
      field.size(), settings_);
  for (int i = 0; i < samples && !re.empty(); ++i) {
    const double angle = lerp(angles.light_first, angles.light_last, at_s(i));
    light_s[i] = static_cast<float>(std::sin(angle));
    light_r[i] = static_cast<float>(std::cos(angle));
    sum[i] = 0;
  }
  march(field, rays, at.data(), [&](const PlanarField::Node* step) {
    if (re.empty()) return advance_tau(step, rays);
    advance(step, lobe, rays, weight, shades);
    shade_own(light_s, light_r, squarings_, static_cast<float>(settings_.phong.exponent), shades, samples, sum);
  });
  smooth({rays.tau.data(), count}, tau);
  if (re.empty()) return;
  smooth({rays.opacity.data(), count}, {opacity.data(), count});
  smooth({sum.data(), count}, {smoothed.data(), count});
  for (std::size_t x = 0; x < count; ++x) re[x] = straight(smoothed[x], opacity[x]);
}

}  // namespace pelage
