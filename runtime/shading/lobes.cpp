#include "pelage/shading/lobes.h"

namespace pelage {

glm::vec3 hair_lighting(const HairMaterial& m, const LobeSwitches& on, const glm::vec3& t, const glm::vec3& n,
                        const glm::vec3& l, const glm::vec3& v) noexcept {
  glm::vec3 sum{0.0F};
  if (on.diffuse) sum += m.diffuse * diffuse_lobe(t, l) * m.diffuse_colour;
  if (on.primary) {
    const glm::vec3 tilted = shifted_tangent(t, n, m.primary_shift);
    sum += m.primary * specular_lobe(tilted, l, v, m.primary_exponent) * m.primary_colour;
  }
  if (on.secondary) {
    const glm::vec3 tilted = shifted_tangent(t, n, -m.secondary_shift);
    sum += m.secondary * specular_lobe(tilted, l, v, m.secondary_exponent) * m.secondary_colour;
  }
  return sum;
}

}  // namespace pelage
