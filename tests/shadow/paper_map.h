// The density map exactly as [Bertails2005 sections 2, 3] prints it, written down without a thought for speed: the
// baseline of tests/bench and the oracle of the printed setting. Array of structures, a torus of N^3 cells, modulo for
// every access, the running product of eq. 3, eight exponentials' worth of transmittance read per point. Kept as it is.
#pragma once

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <glm/geometric.hpp>
#include <glm/vec3.hpp>
#include <vector>

namespace pelage::paper {

struct Vertex {
  glm::vec3 position, tangent;
  float transmittance;
  std::uint8_t colour[4];
};

struct Map {
  int n;                                      // NCELLS
  float ds;                                   // metres
  float f_ds;                                 // f ds: optical depth of one count
  glm::vec3 x, y, z;                          // X_map along the travel of light
  std::vector<float> density, transmittance;  // [i][j][k]

  int wrap(float v) const {
    const int i = static_cast<int>(std::floor(v / ds)) % n;
    return i < 0 ? i + n : i;
  }
  std::size_t at(int i, int j, int k) const {
    return (static_cast<std::size_t>(i) * static_cast<std::size_t>(n) + static_cast<std::size_t>(j)) *
               static_cast<std::size_t>(n) +
           static_cast<std::size_t>(k);
  }
  void reset() {
    const std::size_t cells = static_cast<std::size_t>(n) * static_cast<std::size_t>(n) * static_cast<std::size_t>(n);
    density.assign(cells, 0.0F);
    transmittance.assign(cells, 1.0F);
  }
  /// Section 3.1.
  void fill(const std::vector<Vertex>& vertices) {
    for (const Vertex& v : vertices) {
      density[at(wrap(glm::dot(v.position, x)), wrap(glm::dot(v.position, y)), wrap(glm::dot(v.position, z)))] += 1;
    }
  }
  /// Section 3.2, eq. 3. @param first  index i_min, before the modulo, of the slice nearest to the light
  void transmit(int first) {
    for (int j = 0; j < n; ++j) {
      for (int k = 0; k < n; ++k) {
        float previous = 1;
        for (int i = 0; i < n; ++i) {
          const std::size_t cell = at(((first + i) % n + n) % n, j, k);
          if (density[cell] > 0) previous *= std::exp(-density[cell] * f_ds);
          transmittance[cell] = previous;
        }
      }
    }
  }
  /// Section 3.3. The slice before the first has transmittance 1 (the torus would give the last one's).
  float filter(glm::vec3 p, int first) const {
    const float gx = glm::dot(p, x) / ds, gy = glm::dot(p, y) / ds, gz = glm::dot(p, z) / ds;
    const int i = static_cast<int>(std::floor(gx)), j = static_cast<int>(std::floor(gy)),
              k = static_cast<int>(std::floor(gz));
    const float li = gx - static_cast<float>(i), lj = gy - static_cast<float>(j), lk = gz - static_cast<float>(k);
    float sum = 0;
    for (int a = 0; a < 2; ++a) {
      for (int b = 0; b < 2; ++b) {
        for (int c = 0; c < 2; ++c) {
          const float weight = (a ? li : 1 - li) * (b ? lj : 1 - lj) * (c ? lk : 1 - lk);
          const int ii = i - 1 + a;
          if (ii < first) {
            sum += weight;
            continue;
          }
          sum += weight * transmittance[at((ii % n + n) % n, ((j - 1 + b) % n + n) % n, ((k - 1 + c) % n + n) % n)];
        }
      }
    }
    return sum;
  }
};

/// Kajiya-Kay per vertex, eq. of section 3.3: ambient + T (diffuse + specular).
inline void colour(Vertex& v, glm::vec3 to_light, glm::vec3 to_eye, float ambient, float diffuse, float specular,
                   float exponent, glm::vec3 tint) {
  const float sine_light = glm::length(glm::cross(v.tangent, to_light)),
              sine_eye = glm::length(glm::cross(v.tangent, to_eye));
  const float base = sine_light * sine_eye - glm::dot(v.tangent, to_light) * glm::dot(v.tangent, to_eye);
  const float high = specular * std::pow(std::max(base, 0.0F), exponent);
  for (int c = 0; c < 3; ++c) {
    const float lit = ambient * tint[c] + v.transmittance * (diffuse * sine_light * tint[c] + high);
    v.colour[c] = static_cast<std::uint8_t>(255.0F * std::min(lit, 1.0F) + 0.5F);
  }
  v.colour[3] = 255;
}

}  // namespace pelage::paper
