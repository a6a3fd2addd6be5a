// Strands: the hair as polylines, root first. Structure of arrays; metres, Y up, right-handed.
#pragma once

#include <cstddef>
#include <cstdint>
#include <glm/vec3.hpp>
#include <span>
#include <vector>

namespace pelage {

struct Strands {
  std::vector<std::uint32_t> offsets{0};  // [strands + 1] first vertex of each strand, then the vertex count
  std::vector<glm::vec3> vertices;        // [vertices] metres, strand after strand, vertex 0 is the root
  std::vector<float> diameters_m;         // [vertices] drawn diameter, or empty: `diameter_m` holds for all
  std::vector<glm::vec3> colours;         // [strands] linear RGB in [0,1], or empty: the material decides
  float diameter_m = 0.0F;                // drawn diameter D; 0: unknown, the default of DESIGN section 3 applies

  std::size_t count() const noexcept { return offsets.size() - 1; }
  std::span<const glm::vec3> strand(std::size_t i) const noexcept {
    return {vertices.data() + offsets[i], vertices.data() + offsets[i + 1]};
  }
  void append(std::span<const glm::vec3> points) {
    vertices.insert(vertices.end(), points.begin(), points.end());
    offsets.push_back(static_cast<std::uint32_t>(vertices.size()));
  }
};

/// Drawn diameter [m] of `strands` drawn strands that stand for a full head of 100,000: 80 um x sqrt(1e5 / strands),
/// at most 400 um, so that the covered area does not depend on how many strands are drawn.
float default_diameter_m(std::size_t strands) noexcept;

/// Opacity `a` of a fibre: the fraction of a crossing ray that it stops, unless the input says otherwise.
inline constexpr float kDefaultOpacity = 0.6F;

}  // namespace pelage
