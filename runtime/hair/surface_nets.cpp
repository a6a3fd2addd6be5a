#include "pelage/hair/surface_nets.h"

#include <array>
#include <cstdint>
#include <vector>

namespace pelage::hair {
namespace {

constexpr std::uint32_t kNone = ~0U;

class Nets {
 public:
  Nets(const Grid& grid, const std::function<float(glm::vec3)>& field) : grid_(grid) {
    for_each({0, 0, 0}, grid.size, [&](glm::ivec3 i) { values_.push_back(field(grid.point(i))); });
    cell_vertex_.assign(values_.size(), kNone);
  }

  Mesh run() {
    for_each({0, 0, 0}, grid_.size - 1, [&](glm::ivec3 cell) { place_vertex(cell); });
    for (int axis = 0; axis < 3; ++axis) {
      glm::ivec3 from(1);
      from[axis] = 0;
      for_each(from, grid_.size - 1, [&](glm::ivec3 i) { join_around_edge(i, axis); });
    }
    return std::move(mesh_);
  }

 private:
  template <class F>
  static void for_each(glm::ivec3 from, glm::ivec3 to, F visit) {
    for (int z = from.z; z < to.z; ++z) {
      for (int y = from.y; y < to.y; ++y) {
        for (int x = from.x; x < to.x; ++x) visit({x, y, z});
      }
    }
  }

  std::size_t index(glm::ivec3 i) const {
    return static_cast<std::size_t>((i.z * grid_.size.y + i.y) * grid_.size.x + i.x);
  }
  float value(glm::ivec3 i) const { return values_[index(i)]; }

  static glm::ivec3 corner(int c) { return {c & 1, (c >> 1) & 1, c >> 2}; }

  /// At the mean of the points where the surface crosses the cell's edges.
  void place_vertex(glm::ivec3 cell) {
    glm::vec3 sum(0.0F);
    int crossings = 0;
    for (int a = 0; a < 8; ++a) {
      for (int bit = 1; bit < 8; bit <<= 1) {
        if ((a & bit) != 0) continue;
        const glm::ivec3 p = cell + corner(a), q = cell + corner(a | bit);
        const float fp = value(p), fq = value(q);
        if ((fp < 0) == (fq < 0)) continue;
        sum += glm::vec3(p) + fp / (fp - fq) * glm::vec3(q - p);
        ++crossings;
      }
    }
    if (crossings == 0) return;
    cell_vertex_[index(cell)] = static_cast<std::uint32_t>(mesh_.vertices.size());
    mesh_.vertices.push_back(grid_.origin_m + grid_.cell_m * sum / static_cast<float>(crossings));
  }

  /// A quad of the four cells around a crossed edge, facing the positive side.
  void join_around_edge(glm::ivec3 i, int axis) {
    glm::ivec3 step(0), u(0), v(0);
    step[axis] = 1;
    u[(axis + 1) % 3] = 1;
    v[(axis + 2) % 3] = 1;
    const float from = value(i), to = value(i + step);
    if ((from < 0) == (to < 0)) return;
    const std::array<std::uint32_t, 4> quad = {cell_vertex_[index(i - u - v)], cell_vertex_[index(i - v)],
                                               cell_vertex_[index(i)], cell_vertex_[index(i - u)]};
    const std::size_t second = from < 0 ? 1 : 3, fourth = 4 - second;
    mesh_.triangles.emplace_back(quad[0], quad[second], quad[2]);
    mesh_.triangles.emplace_back(quad[0], quad[2], quad[fourth]);
  }

  const Grid& grid_;
  std::vector<float> values_;
  std::vector<std::uint32_t> cell_vertex_;
  Mesh mesh_;
};

}  // namespace

Mesh surface_nets(const Grid& grid, const std::function<float(glm::vec3)>& field) {
  return Nets(grid, field).run();
}

}  // namespace pelage::hair
