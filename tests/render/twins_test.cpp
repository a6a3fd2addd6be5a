// The GPU's lobes against the CPU's.
#include <cmath>
#include <glm/geometric.hpp>
#include <limits>
#include <random>

#include "fixture.h"
#include "pelage/shading/lobes.h"

namespace pelage {
namespace {

class Twins : public test::WithOpenGl {};

/// Unit vectors, t and n across each other; every seventh case has parallel or opposite ones.
std::vector<glm::vec4> cases(std::size_t count) {
  std::mt19937 random(17);
  const auto direction = [&] {
    const double z = 2.0 * double(random()) / 4294967295.0 - 1,
                 phi = 6.283185307179586 * double(random()) / 4294967295.0;
    const double r = std::sqrt(1 - z * z);
    return glm::normalize(glm::vec3(glm::dvec3(r * std::cos(phi), r * std::sin(phi), z)));
  };
  std::vector<glm::vec4> all;
  for (std::size_t i = 0; i < count; ++i) {
    const glm::vec3 t = i % 11 == 0 ? glm::vec3(0, 1, 0) : direction();
    glm::vec3 l = direction(), v = direction();
    if (i % 7 == 0) l = i % 2 == 0 ? t : -t;
    if (i % 14 == 1) v = l;
    if (i % 14 == 2) v = -l;
    if (i % 14 == 3) v = t;
    if (i % 14 == 4) v = glm::normalize(l - 2.0F * glm::dot(l, t) * t);  // into the highlight
    const glm::vec3 n = glm::normalize(glm::cross(t, std::abs(t.x) < 0.6F ? glm::vec3(1, 0, 0) : glm::vec3(0, 0, 1)));
    for (const glm::vec3& x : {t, n, l, v}) all.emplace_back(x, 0.0F);
  }
  return all;
}

TEST_F(Twins, GpuLobesEqualCpuLobes) {
  constexpr float kEps = std::numeric_limits<float>::epsilon();
  Renderer renderer;
  const auto in = cases(4000);
  for (const float exponent : {1.0F, 20.0F, 80.0F, 1000.0F}) {
    HairMaterial m;
    m.primary_exponent = exponent;
    m.secondary_exponent = 0.5F * exponent + 0.5F;
    const auto gpu = renderer.lobes_on_gpu(m, in);
    ASSERT_EQ(gpu.size(), in.size() / 4);
    // Base: 8 eps as in tests/shading, on either side. pow is exp2(e log2(b)) with log2 within 2^-21 near 1 and exp2
    // within 3 ulp [GLSL 4.30 section 4.5.1]: relative ln2 e 2^-21 + 4 eps.
    const float relative = exponent * (16 * kEps + 0.6932F * 0x1p-21F) + 8 * kEps;
    const float tolerance = relative * (m.primary + m.secondary) + 8 * kEps;
    float most = 0;
    for (std::size_t i = 0; i < gpu.size(); ++i) {
      const auto vec = [&](std::size_t k) { return glm::vec3(in[4 * i + k]); };
      const glm::vec3 cpu = hair_lighting(m, {}, vec(0), vec(1), vec(2), vec(3));
      for (int c = 0; c < 3; ++c) {
        ASSERT_TRUE(std::isfinite(gpu[i][c])) << i;
        most = std::max(most, std::abs(gpu[i][c] - cpu[c]));
      }
      ASSERT_LE(most, tolerance) << "case " << i << ", exponent " << exponent;
    }
    std::printf("exponent %g: largest difference %.2g, tolerance %.2g\n", double(exponent), double(most),
                double(tolerance));
  }
}

}  // namespace
}  // namespace pelage
