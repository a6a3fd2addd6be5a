// The straightforward versions of paper C's grid, to measure and test against: particles as structures, one after the
// other, on a dense grid (section 3.2.1) or a top-down octree that is rebuilt each step (section 3.2.2). Same formulas
// as pelage::VoxelGrid (mass, per-second rates, bounded repulsion) but for eq. 3.7, which looks six densities up per
// particle where VoxelGrid differentiates at the nodes.
#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <glm/common.hpp>
#include <glm/geometric.hpp>
#include <glm/vec3.hpp>
#include <vector>

namespace paper {

template <class T>
struct Particle {
  glm::vec<3, T> position{0}, velocity{0};
  T mass = 0;
  bool root = false;
};

template <class T>
struct Node {
  T density = 0;
  glm::vec<3, T> velocity{0};
};

template <class T>
struct Step {
  T cell_m = T(0.01), friction = 0, repulsion_m_s = 0, rest_density = 1;
};

template <class T>
struct DenseGrid {
  using V = glm::vec<3, T>;
  glm::ivec3 low{0}, size{0};
  std::vector<Node<T>> nodes;

  void cover(const std::vector<Particle<T>>& particles, T cell_m) {
    V from(INFINITY), to(-INFINITY);
    for (const auto& p : particles) {
      from = glm::min(from, p.position);
      to = glm::max(to, p.position);
    }
    low = glm::ivec3(glm::floor(from / cell_m)) - 1;  // eq. 3.7 looks a cell further
    size = glm::ivec3(glm::floor(to / cell_m)) + 3 - low;
    nodes.assign(std::size_t(size.x) * std::size_t(size.y) * std::size_t(size.z), {});
  }
  Node<T>& at(const glm::ivec3& i) {
    const glm::ivec3 k = i - low;
    return nodes[(std::size_t(k.z) * std::size_t(size.y) + std::size_t(k.y)) * std::size_t(size.x) + std::size_t(k.x)];
  }
  std::size_t bytes() const { return nodes.capacity() * sizeof(Node<T>); }
};

/// Leaves are voxels, each known by its low corner, whose density and velocity it holds.
template <class T>
struct Octree {
  struct Branch {
    std::array<std::int32_t, 8> child{0, 0, 0, 0, 0, 0, 0, 0};
  };
  glm::ivec3 low{0};
  int levels = 0;
  std::vector<Branch> branches;
  std::vector<Node<T>> nodes;  // leaves; 0: what no particle is near

  void cover(const std::vector<Particle<T>>& particles, T cell_m) {
    glm::vec<3, T> from(INFINITY), to(-INFINITY);
    for (const auto& p : particles) {
      from = glm::min(from, p.position);
      to = glm::max(to, p.position);
    }
    low = glm::ivec3(glm::floor(from / cell_m)) - 1;
    const glm::ivec3 size = glm::ivec3(glm::floor(to / cell_m)) + 3 - low;
    levels = 1;
    while ((1 << levels) < std::max({size.x, size.y, size.z})) ++levels;
    branches.assign(1, {});
    nodes.assign(1, {});
  }
  static std::size_t octant(const glm::ivec3& k, int level) {
    return std::size_t((k.x >> level & 1) | (k.y >> level & 1) << 1 | (k.z >> level & 1) << 2);
  }
  Node<T>& make(const glm::ivec3& i) {
    const glm::ivec3 k = i - low;
    std::size_t b = 0;
    for (int level = levels - 1; level > 0; --level) {
      std::int32_t next = branches[b].child[octant(k, level)];
      if (next == 0) {
        next = std::int32_t(branches.size());
        branches[b].child[octant(k, level)] = next;
        branches.emplace_back();
      }
      b = std::size_t(next);
    }
    std::int32_t leaf = branches[b].child[octant(k, 0)];
    if (leaf == 0) {
      leaf = std::int32_t(nodes.size());
      branches[b].child[octant(k, 0)] = leaf;
      nodes.emplace_back();
    }
    return nodes[std::size_t(leaf)];
  }
  const Node<T>& at(const glm::ivec3& i) const {
    const glm::ivec3 k = i - low;
    std::size_t b = 0;
    for (int level = levels - 1; level > 0; --level) {
      const std::int32_t next = branches[b].child[octant(k, level)];
      if (next == 0) return nodes[0];
      b = std::size_t(next);
    }
    return nodes[std::size_t(branches[b].child[octant(k, 0)])];
  }
  std::size_t bytes() const { return branches.capacity() * sizeof(Branch) + nodes.capacity() * sizeof(Node<T>); }
};

template <class T>
Node<T>& node_for(DenseGrid<T>& grid, const glm::ivec3& i) {
  return grid.at(i);
}
template <class T>
Node<T>& node_for(Octree<T>& grid, const glm::ivec3& i) {
  return grid.make(i);
}

/// Largest whole number not above: std::floor is a call on machines that the compiler may not count on.
template <class T>
int cell_of(T u) {
  const int cell = static_cast<int>(u);
  return cell - (u < static_cast<T>(cell));
}

template <class T, class Visit>
void each_corner(const glm::vec<3, T>& u, Visit&& visit) {
  const glm::ivec3 cell(cell_of(u.x), cell_of(u.y), cell_of(u.z));
  const glm::vec<3, T> f = u - glm::vec<3, T>(cell);
  for (int c = 0; c < 8; ++c) {
    const glm::ivec3 d(c & 1, c >> 1 & 1, c >> 2);
    visit(cell + d, (d.x ? f.x : 1 - f.x) * (d.y ? f.y : 1 - f.y) * (d.z ? f.z : 1 - f.z));
  }
}

/// Eqs. 3.2, 3.3.
template <class T, class Grid>
void fill(const std::vector<Particle<T>>& particles, const Step<T>& step, Grid& grid) {
  grid.cover(particles, step.cell_m);
  const T per_m3 = 1 / (step.cell_m * step.cell_m * step.cell_m);
  for (const auto& p : particles) {
    each_corner<T>(p.position / step.cell_m, [&](const glm::ivec3& i, T weight) {
      Node<T>& n = node_for(grid, i);
      n.density += weight * p.mass * per_m3;
      n.velocity += weight * p.mass * per_m3 * p.velocity;
    });
  }
  for (auto& n : grid.nodes)
    if (n.density > 0) n.velocity /= n.density;
}

template <class T, class Grid>
T density(Grid& grid, const glm::vec<3, T>& u) {
  T sum = 0;
  each_corner<T>(u, [&](const glm::ivec3& i, T weight) { sum += weight * grid.at(i).density; });
  return sum;
}

/// Eqs. 3.4, 3.7, 3.5 (corrected and bounded).
template <class T, class Grid>
void affect(std::vector<Particle<T>>& particles, const Step<T>& step, Grid& grid) {
  using V = glm::vec<3, T>;
  for (auto& p : particles) {
    if (p.root) continue;
    const V u = p.position / step.cell_m;
    V around(0);
    each_corner<T>(u, [&](const glm::ivec3& i, T weight) { around += weight * grid.at(i).velocity; });
    p.velocity = (1 - step.friction) * p.velocity + step.friction * around;
    if (!(step.repulsion_m_s > 0)) continue;
    V g;
    for (int a = 0; a < 3; ++a) {
      V r(0);
      r[a] = 1;
      g[a] = (density<T>(grid, u + r) - density<T>(grid, u - r)) / (2 * step.cell_m);
    }
    p.velocity -= step.repulsion_m_s * g / (glm::length(g) + step.rest_density / step.cell_m);
  }
}

}  // namespace paper
