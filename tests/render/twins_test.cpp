// What shaders compute against what the CPU computes: lobes, the normal of a lone strand, lights, depth maps.
#include <epoxy/gl.h>

#include <cmath>
#include <glm/geometric.hpp>
#include <limits>
#include <random>

#include "pelage/render/shader_inputs.h"
#include "pelage/render/strand_renderer.h"
#include "pelage/shading/azimuth_mean.h"
#include "pelage/shading/head_lighting.h"
#include "pelage/shading/light.h"
#include "pelage/shading/lobes.h"
#include "strands.h"

namespace pelage {
namespace {

class Twins : public test::WithOpenGl {};

/// Mirrors Case and Result of shaders/test_twins.comp.
struct Case {
  glm::vec4 t, n, l, v, at;
};
struct Result {
  glm::vec4 lighting, facing, to_light, irradiance;
};

std::vector<Result> on_gpu(std::span<const Case> cases, const HairMaterial& material, const Light& light,
                           const DepthTexture* map = nullptr, glm::vec2 azimuth = glm::vec2(0)) {
  const Program p("test_twins.comp");
  Buffer in, out;
  DepthMaps maps;
  in.upload(GL_SHADER_STORAGE_BUFFER, cases, GL_STATIC_DRAW);
  out.allocate(GL_SHADER_STORAGE_BUFFER, cases.size() * sizeof(Result), GL_STREAM_READ);
  if (map != nullptr) maps.upload({map, 1});
  glUseProgram(p.id());
  set_material(p, material, {});
  set_lights(p, {&light, 1});
  set_head_material(p);
  glUniform2f(p.at("azimuth"), azimuth.x, azimuth.y);
  maps.bind(p);
  glUniform1i(p.at("use_map"), map != nullptr ? 1 : 0);
  glBindBufferBase(GL_SHADER_STORAGE_BUFFER, 0, in.id());
  glBindBufferBase(GL_SHADER_STORAGE_BUFFER, 1, out.id());
  glDispatchCompute(static_cast<GLuint>((cases.size() + 63) / 64), 1, 1);
  glMemoryBarrier(GL_BUFFER_UPDATE_BARRIER_BIT);
  std::vector<Result> results(cases.size());
  glBindBuffer(GL_SHADER_STORAGE_BUFFER, out.id());
  glGetBufferSubData(GL_SHADER_STORAGE_BUFFER, 0, static_cast<GLsizeiptr>(cases.size() * sizeof(Result)),
                     results.data());
  check_opengl("the twins");
  return results;
}

/// Uniform over the sphere, [0, 1).
struct Random {
  std::mt19937 bits{17};
  double unit() { return double(bits()) / 4294967296.0; }
  glm::vec3 direction() {
    const double z = 2.0 * unit() - 1, phi = 6.283185307179586 * unit(), r = std::sqrt(1 - z * z);
    return glm::normalize(glm::vec3(glm::dvec3(r * std::cos(phi), r * std::sin(phi), z)));
  }
};

/// Unit vectors, t and n across each other; every seventh case has parallel or opposite ones (hard case 19).
std::vector<Case> cases(std::size_t count) {
  Random random;
  std::vector<Case> all;
  for (std::size_t i = 0; i < count; ++i) {
    const glm::vec3 t = i % 11 == 0 ? glm::vec3(0, 1, 0) : random.direction();
    glm::vec3 l = random.direction(), v = random.direction();
    if (i % 7 == 0) l = i % 2 == 0 ? t : -t;
    if (i % 14 == 1) v = l;
    if (i % 14 == 2) v = -l;
    if (i % 14 == 3) v = t;
    if (i % 14 == 4) v = glm::normalize(l - 2.0F * glm::dot(l, t) * t);  // into the highlight
    const glm::vec3 n = glm::normalize(glm::cross(t, std::abs(t.x) < 0.6F ? glm::vec3(1, 0, 0) : glm::vec3(0, 0, 1)));
    const glm::vec3 at = 0.3F * random.direction();
    all.push_back({glm::vec4(t, 0), glm::vec4(n, 0), glm::vec4(l, 0), glm::vec4(v, 0), glm::vec4(at, 0)});
  }
  return all;
}

constexpr float kEps = std::numeric_limits<float>::epsilon();

TEST_F(Twins, GpuLobesEqualCpuLobes) {
  const auto in = cases(4000);
  for (const float exponent : {1.0F, 20.0F, 80.0F, 1000.0F}) {
    HairMaterial m;
    m.primary_exponent = exponent;
    m.secondary_exponent = 0.5F * exponent + 0.5F;
    const auto gpu = on_gpu(in, m, {});
    // Base: 8 eps as in tests/shading, on either side. pow is exp2(e log2(b)) with log2 within 2^-21 near 1 and exp2
    // within 3 ulp [GLSL 4.30 section 4.5.1]: relative ln2 e 2^-21 + 4 eps.
    const float relative = exponent * (16 * kEps + 0.6932F * 0x1p-21F) + 8 * kEps;
    const float tolerance = relative * (m.primary + m.secondary) + 8 * kEps;
    float most = 0;
    for (std::size_t i = 0; i < gpu.size(); ++i) {
      const glm::vec3 cpu =
          hair_lighting(m, {}, glm::vec3(in[i].t), glm::vec3(in[i].n), glm::vec3(in[i].l), glm::vec3(in[i].v));
      for (int c = 0; c < 3; ++c) {
        ASSERT_TRUE(std::isfinite(gpu[i].lighting[c])) << i;
        most = std::max(most, std::abs(gpu[i].lighting[c] - cpu[c]));
      }
      ASSERT_LE(most, tolerance) << "case " << i << ", exponent " << exponent;
    }
    std::printf("exponent %g: largest difference %.2g, tolerance %.2g\n", double(exponent), double(most),
                double(tolerance));
  }
}

TEST_F(Twins, GpuNormalOfALoneStrandEqualsCpu) {
  const auto in = cases(4000);
  const auto gpu = on_gpu(in, {}, {});
  for (std::size_t i = 0; i < gpu.size(); ++i) {
    const glm::vec3 t(in[i].t), v(in[i].v), cpu = facing_normal(t, v);
    // v - (v.t) t has an error of 4 eps, which its length, at least 1e-4, magnifies.
    const float sine = std::max(glm::length(glm::cross(t, v)), 1e-4F);
    ASSERT_LE(glm::length(glm::vec3(gpu[i].facing) - cpu), 8 * kEps / sine + 4 * kEps) << i;
  }
}

TEST_F(Twins, GpuAzimuthEqualsCpu) {
  const auto in = cases(4000);
  const glm::vec2 k = azimuth_coefficients({});
  const auto gpu = on_gpu(in, {}, {}, nullptr, k);
  for (std::size_t i = 0; i < gpu.size(); ++i) {
    const float cpu = azimuth_mean(k, glm::vec3(in[i].t), glm::vec3(in[i].v), glm::vec3(in[i].l));
    // acos of GLSL has no stated precision; Mesa's is within 1e-4 rad. Near the fibre's direction the angle itself
    // is of eps / .02.
    ASSERT_NEAR(gpu[i].to_light.w, cpu, 2e-3F) << i;
  }
  EXPECT_EQ(on_gpu(in, {}, {})[5].to_light.w, 1.0F);  // no coefficients: off
}

TEST_F(Twins, GpuHeadEqualsCpuHead) {
  const auto in = cases(4000);
  const auto gpu = on_gpu(in, {}, {});
  float least = 1, most = 0;
  for (std::size_t i = 0; i < gpu.size(); ++i) {
    const glm::vec3 n(in[i].n), l(in[i].l);
    // A dot product of unit vectors is off by 4 eps; squared and scaled by 1 / 1.5 no more than twice that.
    ASSERT_NEAR(gpu[i].lighting.w, head_direct(n, l), 8 * kEps) << i;
    ASSERT_NEAR(gpu[i].irradiance.w, head_ambient(n), 4 * kEps) << i;
    least = std::min(least, gpu[i].lighting.w), most = std::max(most, gpu[i].lighting.w);
  }
  EXPECT_EQ(least, 0.0F);
  EXPECT_GT(most, 0.95F);
}

TEST_F(Twins, GpuLightsEqualCpuLights) {
  auto in = cases(500);
  in[0].at = {0.1F, 0.2F, 0.3F, 0};          // at the light
  in[1].at = {0.1F, 0.2F, 0.3F + 1e-5F, 0};  // nearer than its irradiance is bounded
  const Light sun{{1, -2, 0.5F}, {}, {1, 0.5F, 0.2F}, 3.0F};
  Light point = sun;
  point.position = glm::vec3(0.1F, 0.2F, 0.3F);
  for (const Light& light : {sun, point}) {
    const auto gpu = on_gpu(in, {}, light);
    for (std::size_t i = 0; i < gpu.size(); ++i) {
      const Arriving cpu = arriving(light, glm::vec3(in[i].at));
      // Lengths and quotients: a few roundings on either side, the square of the distance twice as many.
      ASSERT_LE(glm::length(glm::vec3(gpu[i].to_light) - cpu.to_light), 8 * kEps) << i;
      ASSERT_LE(glm::length(glm::vec3(gpu[i].irradiance) - cpu.irradiance), 16 * kEps * glm::length(cpu.irradiance))
          << i;
    }
  }
}

/// One read of a DepthTexture at cell coordinates, as its comment says, in double.
double read_on_cpu(const DepthTexture& map, glm::dvec3 at) {
  at = glm::clamp(at, glm::dvec3(0), glm::dvec3(map.size - 1));
  const glm::dvec3 low = glm::floor(at), f = at - low;
  double sum = 0;
  for (int corner = 0; corner < 8; ++corner) {
    const glm::ivec3 step{corner & 1, corner >> 1 & 1, corner >> 2};
    const glm::ivec3 cell = glm::min(glm::ivec3(low) + step, map.size - 1);
    double weight = 1;
    for (int k = 0; k < 3; ++k) weight *= step[k] == 1 ? f[k] : 1 - f[k];
    sum += weight * double(map.values[std::size_t((cell.x * map.size.y + cell.y) * map.size.z + cell.z)]);
  }
  return map.transmittance ? sum : std::exp(-sum);
}

double look_up_on_cpu(const DepthTexture& map, const glm::vec3& world) {
  const glm::dvec3 at(glm::dmat4(map.world_to_cell) * glm::dvec4(world, 1.0));
  if (!(map.tap_cells > 0)) return read_on_cpu(map, at);
  double sum = 0;
  for (const double y : {-1.0, 1.0})
    for (const double z : {-1.0, 1.0}) sum += read_on_cpu(map, at + double(map.tap_cells) * glm::dvec3(0, y, z));
  return 0.25 * sum;
}

TEST_F(Twins, GpuLookupInATextureIsWhatTheTextureSays) {
  Random random;
  DepthTexture map;
  map.size = {7, 5, 9};
  // Turned and shifted; cells of 3 cm, so that points 30 cm around lie within, beside, before and behind.
  map.world_to_cell =
      glm::scale(glm::rotate(glm::translate(glm::mat4(1), {3, 2, 4}), 0.7F, {0.3F, 1, 0.2F}), glm::vec3(1 / 0.03F));
  for (int x = 0; x < 7; ++x) {
    for (int k = 0; k < 45; ++k) {
      const float before = x == 0 ? 0.0F : map.values[std::size_t(45 * (x - 1) + k)];
      map.values.push_back(before + 0.15F * float(random.unit()));
    }
  }
  auto in = cases(4000);
  for (std::size_t i = 0; i < in.size(); i += 5) in[i].at *= 0.3F;
  in[0].at = glm::vec4(1e30F, -1e30F, 1e30F, 0);
  in[1].at = glm::inverse(map.world_to_cell) * glm::vec4(6, 4, 8, 1);  // the last cell
  for (const float tap : {0.0F, 0.7F}) {
    for (const bool transmittance : {false, true}) {
      map.tap_cells = tap;
      map.transmittance = transmittance;
      const auto gpu = on_gpu(in, {}, {}, &map);
      double most = 0;
      for (std::size_t i = 0; i < gpu.size(); ++i)
        most = std::max(most, std::abs(double(gpu[i].facing.w) - look_up_on_cpu(map, glm::vec3(in[i].at))));
      std::printf("lookup, taps %g: largest difference %.2g\n", double(tap), most);
      // Cell coordinates up to 20, in float within 20 x 2 eps, times the steepest slopes: .15 per cell along the light,
      // .9 across it in two axes.
      EXPECT_LT(most, 40 * 2 * double(kEps));
    }
  }
}

TEST_F(Twins, GpuShadowEqualsCpuShadow) {
  const Strands strands = test::strand_lock(300);
  Random random;
  std::vector<Case> in(4000);
  std::vector<glm::vec3> points;
  for (Case& c : in) {
    points.push_back(glm::vec3(0.04, 0.26, 0.04) *
                     glm::vec3(random.unit() - 0.5, random.unit() - 0.5, random.unit() - 0.5));
    c.at = glm::vec4(points.back(), 0);
  }
  const auto with = [](int resolution, auto change) {
    ShadowSettings s;
    s.density_map.resolution = resolution;
    change(s.density_map);
    return s;
  };
  using D = DensityMapSettings;
  for (const ShadowSettings& settings :
       {with(16, [](D&) {}), with(128, [](D&) {}), with(64, [](D& d) { d.trilinear_deposit = true; }),
        with(64, [](D& d) { d.interpolate_depth = true; }), with(64, [](D& d) { d.interpolate_depth = false; }),
        with(64, [](D& d) { d.centred_lookup = false; }), with(64, [](D& d) { d.fitted = false; })}) {
    const auto shadow = make_shadow(Method::density_map, settings, strands, 0.6F, Light{});
    const auto map = shadow->depth_texture();
    ASSERT_TRUE(map);
    std::vector<float> cpu(points.size());
    shadow->transmittance(points, cpu);
    const auto gpu = on_gpu(in, {}, {}, &*map);
    double most = 0, shadowed = 0;
    for (std::size_t i = 0; i < gpu.size(); ++i) {
      shadowed += cpu[i] < 0.9F;
      most = std::max(most, std::abs(double(gpu[i].facing.w) - double(cpu[i])));
    }
    std::printf("%d cells: largest difference %.2g, %g of %zu points in shadow\n", settings.density_map.resolution,
                most, shadowed, points.size());
    EXPECT_GT(shadowed, 200);
    // The product of the affine map is up to 128 + 64 cells, in float within 4 eps of that on either side; from cell to
    // cell the transmittance changes by less than one.
    EXPECT_LT(most, 192 * 8 * double(kEps));
  }
}

}  // namespace
}  // namespace pelage
