#include "pelage/shading/vertex_colours.h"

#include <tbb/blocked_range.h>
#include <tbb/parallel_for.h>

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <glm/geometric.hpp>

#include "pelage/data_schema/numeric.h"
#include "pelage/shading/light.h"

#define PELAGE_CLONES __attribute__((target_clones("avx512f", "avx2", "default")))

namespace pelage {
namespace {

/// -ln x for x in (0, 1], absolute error < 2e-6 (of a pow to 120: 3e-4 relative, a tenth of an 8-bit step). Mantissa in
/// [sqrt 1/2, sqrt 2), then the series of atanh.
inline float minus_log(float x) noexcept {
  const auto bits = std::bit_cast<std::int32_t>(x);
  const std::int32_t exponent = (bits - 0x3f3504f3) >> 23;
  const auto m = std::bit_cast<float>(bits - (exponent << 23));
  const float s = (m - 1.0F) / (m + 1.0F), s2 = s * s;
  const float series = 2.0F * s * (1.0F + s2 * (1.0F / 3.0F + s2 * (1.0F / 5.0F + s2 * (1.0F / 7.0F))));
  return -series - static_cast<float>(exponent) * 0.693147181F;
}

/// Everything that is the same for all vertices.
struct Constants {
  glm::vec3 ambient, diffuse, specular;
  float exponent;
};

constexpr std::size_t kBlock = 256;

/// Up to kBlock vertices, structure of arrays. Tangent, towards the light, towards the eye (any length).
struct Block {
  std::array<std::array<float, kBlock>, 3> tangent, light, eye;
  std::array<float, kBlock> transmittance;
  std::array<float, kBlock> gain;  // of what arrives, relative to the light at 1 m
};

inline std::uint32_t byte(float v) noexcept {
  const float bounded = v < 1.0F ? v : 1.0F;
  return static_cast<std::uint32_t>(static_cast<std::int32_t>(255.0F * bounded + 0.5F));
}

PELAGE_CLONES void arrange(const ColourRequest& request, glm::vec3 unit_light, const float* __restrict p,
                           const float* __restrict t, const float* __restrict transmittance, std::size_t n,
                           Block& b) noexcept {
  for (std::size_t axis = 0; axis < 3; ++axis) {
    const float from = request.eye[static_cast<int>(axis)], towards = unit_light[static_cast<int>(axis)];
    for (std::size_t i = 0; i < n; ++i) {
      b.tangent[axis][i] = t[3 * i + axis];
      b.eye[axis][i] = from - p[3 * i + axis];
      b.light[axis][i] = towards;
    }
  }
  std::copy_n(transmittance, n, b.transmittance.begin());
  std::fill_n(b.gain.begin(), n, 1.0F);
}

void from_point_light(const Light& light, std::span<const glm::vec3> points, Block& b) noexcept {
  for (std::size_t i = 0; i < points.size(); ++i) {
    const Arriving at = arriving(light, points[i]);
    for (int axis = 0; axis < 3; ++axis) b.light[static_cast<std::size_t>(axis)][i] = at.to_light[axis];
    const float distance = std::max(at.distance_m, kNearestLight_m);
    b.gain[i] /= distance * distance;
  }
}

PELAGE_CLONES void colour(const Constants& k, const Block& b, std::size_t n, std::uint32_t* __restrict out) noexcept {
  const float ar = k.ambient.r, ag = k.ambient.g, ab = k.ambient.b, dr = k.diffuse.r, dg = k.diffuse.g,
              db = k.diffuse.b, sr = k.specular.r, sg = k.specular.g, sb = k.specular.b, exponent = k.exponent;
  for (std::size_t i = 0; i < n; ++i) {
    const float tx = b.tangent[0][i], ty = b.tangent[1][i], tz = b.tangent[2][i];
    const float lx = b.light[0][i], ly = b.light[1][i], lz = b.light[2][i];
    const float ex = b.eye[0][i], ey = b.eye[1][i], ez = b.eye[2][i];
    const float near = 1.0F / std::sqrt(ex * ex + ey * ey + ez * ez + 1e-30F);
    const float tl = tx * lx + ty * ly + tz * lz, te = (tx * ex + ty * ey + tz * ez) * near;
    const float ax = ty * lz - tz * ly, ay = tz * lx - tx * lz, az = tx * ly - ty * lx;
    const float bx = ty * ez - tz * ey, by = tz * ex - tx * ez, bz = tx * ey - ty * ex;
    const float sl = std::sqrt(ax * ax + ay * ay + az * az), se = std::sqrt(bx * bx + by * by + bz * bz) * near;
    float base = sl * se - tl * te;
    base = base > 1e-30F ? base : 1e-30F;
    base = base < 1.0F ? base : 1.0F;
    const float high = exp_neg(exponent * minus_log(base)), gain = b.gain[i], through = b.transmittance[i];
    out[i] = byte(gain * (ar + through * (dr * sl + sr * high))) |
             (byte(gain * (ag + through * (dg * sl + sg * high))) << 8) |
             (byte(gain * (ab + through * (db * sl + sb * high))) << 16) | 0xff000000U;
  }
}

}  // namespace

void vertex_colours(const ColourRequest& request, std::span<const glm::vec3> points,
                    std::span<const glm::vec3> tangents, std::span<const float> transmittance,
                    std::span<std::uint32_t> colours) {
  const HairMaterial& m = request.material;
  const glm::vec3 light = request.light.intensity * request.light.colour;
  const Constants k{m.ambient * light * m.diffuse_colour, m.diffuse * light * m.diffuse_colour,
                    m.primary * light * m.primary_colour, m.primary_exponent};
  const bool point_light = request.light.position.has_value();
  const glm::vec3 unit = point_light ? glm::vec3(0, 1, 0) : glm::normalize(request.light.direction);
  const std::size_t blocks = (points.size() + kBlock - 1) / kBlock;
  tbb::parallel_for(tbb::blocked_range<std::size_t>(0, blocks, 32), [&](const auto& range) {
    Block block{};
    for (std::size_t b = range.begin(); b != range.end(); ++b) {
      const std::size_t i = b * kBlock, n = std::min(kBlock, points.size() - i);
      arrange(request, unit, &points[i].x, &tangents[i].x, &transmittance[i], n, block);
      if (point_light) from_point_light(request.light, points.subspan(i, n), block);
      colour(k, block, n, &colours[i]);
    }
  });
}

}  // namespace pelage
