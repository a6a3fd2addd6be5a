// Meshes for tests of the distance field.
#pragma once

#include <cmath>
#include <cstdint>
#include <functional>
#include <glm/geometric.hpp>
#include <map>
#include <utility>

#include "pelage/data_schema/mesh.h"

namespace pelage {

/// Octahedron, divided `levels` times and blown up: directions times radius(direction).
inline Mesh round_mesh(int levels, const std::function<float(glm::vec3)>& radius) {
  Mesh m;
  m.vertices = {{1, 0, 0}, {-1, 0, 0}, {0, 1, 0}, {0, -1, 0}, {0, 0, 1}, {0, 0, -1}};
  m.triangles = {{0, 2, 4}, {2, 1, 4}, {1, 3, 4}, {3, 0, 4}, {2, 0, 5}, {1, 2, 5}, {3, 1, 5}, {0, 3, 5}};
  for (int level = 0; level < levels; ++level) {
    std::map<std::pair<std::uint32_t, std::uint32_t>, std::uint32_t> middles;
    const auto middle = [&](std::uint32_t a, std::uint32_t b) {
      const auto [it, fresh] = middles.try_emplace(std::minmax(a, b), static_cast<std::uint32_t>(m.vertices.size()));
      if (fresh) m.vertices.push_back(glm::normalize(m.vertices[a] + m.vertices[b]));
      return it->second;
    };
    std::vector<glm::uvec3> finer;
    for (const glm::uvec3& t : m.triangles) {
      const std::uint32_t a = middle(t.x, t.y), b = middle(t.y, t.z), c = middle(t.z, t.x);
      for (const glm::uvec3& f : {glm::uvec3(t.x, a, c), {a, t.y, b}, {c, b, t.z}, {a, b, c}}) finer.push_back(f);
    }
    m.triangles = finer;
  }
  for (glm::vec3& v : m.vertices) v *= radius(v);
  return m;
}

inline Mesh sphere_mesh(int levels, float radius_m) {
  return round_mesh(levels, [=](glm::vec3) { return radius_m; });
}

/// A box with corners +-half; every triangle has corners of its own, as many exporters write them.
inline Mesh box_mesh(const glm::vec3& half) {
  Mesh m;
  const auto quad = [&](glm::vec3 a, glm::vec3 b, glm::vec3 c, glm::vec3 d) {
    for (const glm::vec3& v : {a, b, c, a, c, d}) m.vertices.push_back(half * v);
    const auto n = static_cast<std::uint32_t>(m.vertices.size());
    m.triangles.emplace_back(n - 6, n - 5, n - 4);
    m.triangles.emplace_back(n - 3, n - 2, n - 1);
  };
  quad({1, -1, -1}, {1, 1, -1}, {1, 1, 1}, {1, -1, 1});
  quad({-1, -1, 1}, {-1, 1, 1}, {-1, 1, -1}, {-1, -1, -1});
  quad({-1, 1, 1}, {1, 1, 1}, {1, 1, -1}, {-1, 1, -1});
  quad({-1, -1, -1}, {1, -1, -1}, {1, -1, 1}, {-1, -1, 1});
  quad({-1, -1, 1}, {1, -1, 1}, {1, 1, 1}, {-1, 1, 1});
  quad({1, -1, -1}, {-1, -1, -1}, {-1, 1, -1}, {1, 1, -1});
  return m;
}

/// Leaves out the triangles whose centre the rule names.
inline Mesh cut(Mesh m, const std::function<bool(glm::vec3)>& away) {
  std::erase_if(m.triangles, [&](const glm::uvec3& t) {
    return away((m.vertices[t.x] + m.vertices[t.y] + m.vertices[t.z]) / 3.0F);
  });
  return m;
}

}  // namespace pelage
