// Vectorised colours of vertices against lobes.h, written out.
#include "pelage/shading/vertex_colours.h"

#include <gtest/gtest.h>

#include <cmath>
#include <cstdlib>
#include <random>

#include "pelage/shading/light.h"
#include "pelage/shading/lobes.h"

namespace pelage {
namespace {

TEST(VertexColours, AreTheLobesRoundedToEightBits) {
  std::mt19937 random(3);
  std::normal_distribution<float> normal;
  std::uniform_real_distribution<float> uniform(0, 1);
  std::vector<glm::vec3> points, tangents;
  std::vector<float> transmittance;
  for (int i = 0; i < 5000; ++i) {
    points.push_back(0.2F * glm::vec3(normal(random), normal(random), normal(random)));
    tangents.push_back(glm::normalize(glm::vec3(normal(random), normal(random), normal(random))));
    transmittance.push_back(uniform(random));
  }
  ColourRequest request;
  request.material = material_preset("blond");
  request.light.intensity = 0.8F;
  for (const float exponent : {1.0F, 24.0F, 120.0F, 1000.0F}) {
    for (const bool point_light : {false, true}) {
      request.material.primary_exponent = exponent;
      request.light.position = point_light ? std::optional<glm::vec3>({0.3F, 1.0F, 0.4F}) : std::nullopt;
      // t parallel to l (hard case 19), and along the view.
      tangents[0] = arriving(request.light, points[0]).to_light;
      tangents[1] = glm::normalize(request.eye - points[1]);
      std::vector<std::uint32_t> colours(points.size());
      vertex_colours(request, points, tangents, transmittance, colours);
      for (std::size_t i = 0; i < points.size(); ++i) {
        const Arriving at = arriving(request.light, points[i]);
        const glm::vec3 v = glm::normalize(request.eye - points[i]);
        const HairMaterial& m = request.material;
        const glm::vec3 expected =
            m.ambient * at.irradiance * m.diffuse_colour +
            transmittance[i] * at.irradiance *
                (m.diffuse * diffuse_lobe(tangents[i], at.to_light) * m.diffuse_colour +
                 m.primary * specular_lobe(tangents[i], at.to_light, v, m.primary_exponent) * m.primary_colour);
        for (int c = 0; c < 3; ++c) {
          const int byte = static_cast<int>((colours[i] >> (8 * c)) & 255U);
          ASSERT_LE(std::abs(byte - static_cast<int>(255 * std::min(expected[c], 1.0F) + 0.5F)), 1)
              << i << " exponent " << exponent << " point light " << point_light;
        }
        ASSERT_EQ(colours[i] >> 24, 255U);
      }
    }
  }
}

TEST(VertexColours, ALightAtAVertexIsBright) {
  ColourRequest request;
  request.light.position = glm::vec3(0.1F, 0.2F, 0.3F);
  const std::vector<glm::vec3> points{*request.light.position}, tangents{{1, 0, 0}};
  const std::vector<float> transmittance{1.0F};
  std::vector<std::uint32_t> colours(1);
  vertex_colours(request, points, tangents, transmittance, colours);
  EXPECT_EQ(colours[0], 0xffffffffU);
}

}  // namespace
}  // namespace pelage
