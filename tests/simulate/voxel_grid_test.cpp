#include "pelage/simulate/voxel_grid.h"

#include <gtest/gtest.h>
#include <tbb/global_control.h>
#include <tbb/task_arena.h>

#include <array>
#include <bit>
#include <cmath>
#include <cstring>
#include <glm/geometric.hpp>
#include <map>
#include <random>

#include "paper_grid.h"
#include "pelage/data_schema/errors.h"

namespace pelage {
namespace {

constexpr float kCell = 0.01F;

InteractionSettings interaction(float friction, float repulsion, RepulsionKind kind = RepulsionKind::gradient) {
  InteractionSettings s;
  s.cell_m = kCell;
  s.friction_per_s = friction;
  s.repulsion_m_s2 = repulsion;
  s.repulsion = kind;
  return s;
}

WindSettings wind_of(const glm::vec3& velocity, float shelter) {
  WindSettings w;
  w.velocity_m_s = velocity;
  w.shelter = shelter;
  return w;
}

glm::vec3 get(const Lanes3& lanes, std::size_t lane) {
  return {lanes.x[lane], lanes.y[lane], lanes.z[lane]};
}

void put(Lanes3& lanes, std::size_t lane, const glm::vec3& p) {
  lanes.x[lane] = p.x;
  lanes.y[lane] = p.y;
  lanes.z[lane] = p.z;
}

/// Calls visit(strand, i, vertices of the strand, block, lane) for every vertex of every strand.
template <class Visit>
void each_vertex(const StrandBlocks& blocks, Visit&& visit) {
  for (std::size_t s = 0; s < blocks.strands; ++s) {
    const std::size_t b = blocks.block_of[s] / kLanes, k = blocks.block_of[s] % kLanes;
    const auto n = static_cast<std::uint32_t>(blocks.vertices[b].v[k]);
    for (std::uint32_t i = 0; i < n; ++i) visit(s, i, n, b, k);
  }
}

glm::vec3 place(const StrandBlocks& blocks, std::size_t b, std::size_t k, std::uint32_t i) {
  return get(blocks.root[b], k) + get(blocks.position[blocks.first[b] + i], k);
}

/// Strands of 2 to `most` vertices, 8 mm apart, in a ball, moving anyhow.
StrandBlocks random_blocks(std::size_t strands, std::size_t most, float radius_m, unsigned seed) {
  std::mt19937 random(seed);
  std::normal_distribution<float> normal;
  Strands hair;
  for (std::size_t s = 0; s < strands; ++s) {
    glm::vec3 p = radius_m * 0.5F * glm::vec3(normal(random), normal(random), normal(random));
    std::vector<glm::vec3> line{p};
    const std::size_t n = 2 + random() % (most - 1);
    const glm::vec3 d = glm::normalize(glm::vec3(normal(random), normal(random), normal(random)));
    while (line.size() < n)
      line.push_back(line.back() +
                     0.008F * glm::normalize(d + 0.3F * glm::vec3(normal(random), normal(random), normal(random))));
    hair.append(line);
  }
  StrandBlocks blocks = make_blocks(hair, glm::dvec3(0));
  for (Lanes3& v : blocks.velocity)  // padding too: it must not count
    for (std::size_t k = 0; k < kLanes; ++k) put(v, k, {normal(random), normal(random), normal(random)});
  return blocks;
}

/// One strand of two vertices: the root where told, the other far away.
StrandBlocks pair_of_strands(const glm::vec3& a, const glm::vec3& b) {
  Strands hair;
  for (const glm::vec3& p : {a, b}) hair.append(std::vector<glm::vec3>{p + glm::vec3(0.1F, 0, 0), p});
  return make_blocks(hair, glm::dvec3(0));
}

double mass_of(const StrandBlocks& blocks) {
  double mass = 0;
  each_vertex(blocks, [&](std::size_t, std::uint32_t i, std::uint32_t n, std::size_t b, std::size_t k) {
    mass += static_cast<double>(blocks.segment_m[b].v[k]) * (i == 0 || i + 1 == n ? 0.5 : 1.0) * (n > 1);
  });
  return mass;
}

/// What grid_nodes.h says, straightforward, in double, on a map of nodes.
class Reference {
 public:
  using V = glm::dvec3;
  using Index = std::array<int, 3>;
  struct Node {
    double mass = 0;
    V momentum{0};
  };

  Reference(const StrandBlocks& blocks, const InteractionSettings& s, const WindSettings& w, double rest, double h)
      : s_(s), w_(w), rest_(rest), h_(h) {
    each_vertex(blocks, [&](std::size_t, std::uint32_t i, std::uint32_t n, std::size_t b, std::size_t k) {
      const double mass = static_cast<double>(blocks.segment_m[b].v[k]) * (i == 0 || i + 1 == n ? 0.5 : 1.0);
      corners(place(blocks, b, k, i), [&](const Index& at, double weight) {
        nodes_[at].mass += weight * mass;
        nodes_[at].momentum += weight * mass * V(get(blocks.velocity[blocks.first[b] + i], k));
      });
    });
  }

  double density(const Index& at) const {
    const auto found = nodes_.find(at);
    return found == nodes_.end() ? 0 : found->second.mass / std::pow(static_cast<double>(s_.cell_m), 3);
  }

  V push(const Index& at) const {
    const double a = static_cast<double>(s_.repulsion_m_s2), cell = static_cast<double>(s_.cell_m);
    if (s_.repulsion == RepulsionKind::gradient) {
      V g(0);
      for (int i = 0; i < 3; ++i) {
        Index up = at, down = at;
        ++up[static_cast<std::size_t>(i)];
        --down[static_cast<std::size_t>(i)];
        g[i] = (density(up) - density(down)) / (2 * cell);
      }
      return -a * g / (glm::length(g) + rest_ / cell);
    }
    V sum(0);
    for (int c = 0; c < 8; ++c) {
      const glm::ivec3 d(c & 1, c >> 1 & 1, c >> 2);  // of the node within the cell
      double mean = 0;
      for (int q = 0; q < 8; ++q)
        mean += density({at[0] - d.x + (q & 1), at[1] - d.y + (q >> 1 & 1), at[2] - d.z + (q >> 2)}) / 8;
      const double e = std::max((mean - static_cast<double>(s_.overfull) * rest_) / rest_, 0.0);
      sum += e * V(2 * d - 1);
    }
    return a * sum / (glm::length(sum) + 1);
  }

  V after(const glm::vec3& p, const V& velocity) const {
    V add(0);
    double keep = 1;
    corners(p, [&](const Index& at, double weight) {
      const auto found = nodes_.find(at);
      const bool some = found != nodes_.end() && found->second.mass > 0;
      const double f = some ? -std::expm1(-static_cast<double>(s_.friction_per_s) * h_) : 0;
      const double w = glm::length(w_.velocity_m_s) > 0
                           ? -std::expm1(-static_cast<double>(w_.drag_per_s) * h_) *
                                 std::exp(-static_cast<double>(w_.shelter) * density(at) / rest_)
                           : 0;
      const V own = some ? found->second.momentum / found->second.mass : V(0);
      add += weight * ((1 - w) * f * own + w * V(w_.velocity_m_s) + push(at) * h_);
      keep -= weight * (1 - (1 - f) * (1 - w));
    });
    return keep * velocity + add;
  }

 private:
  template <class Visit>
  void corners(const glm::vec3& p, Visit&& visit) const {
    // The cell as the grid sees it, in float; the rest in double.
    const glm::vec3 u = p * (1 / s_.cell_m), low = glm::floor(u);
    const V f = u - low;
    for (int c = 0; c < 8; ++c) {
      const glm::ivec3 d(c & 1, c >> 1 & 1, c >> 2), at = glm::ivec3(low) + d;
      visit(Index{at.x, at.y, at.z}, (d.x ? f.x : 1 - f.x) * (d.y ? f.y : 1 - f.y) * (d.z ? f.z : 1 - f.z));
    }
  }

  InteractionSettings s_;
  WindSettings w_;
  double rest_, h_;
  std::map<Index, Node> nodes_;
};

/// Greatest difference between the grid and the reference over all vertices, relative to the fastest.
double difference(StrandBlocks blocks, const InteractionSettings& s, const WindSettings& w) {
  GridStep step;
  step.step_s = 1.0 / 60;
  VoxelGrid grid(s, w);
  grid.set_rest_density(blocks);
  const Reference reference(blocks, s, w, static_cast<double>(grid.rest_density()), step.step_s);
  const StrandBlocks before = blocks;
  grid.build(blocks, step);
  grid.apply(blocks, step);
  double worst = 0, fastest = 0;
  each_vertex(blocks, [&](std::size_t, std::uint32_t i, std::uint32_t, std::size_t b, std::size_t k) {
    const std::size_t v = blocks.first[b] + i;
    const glm::dvec3 was = get(before.velocity[v], k), now = get(blocks.velocity[v], k);
    const glm::dvec3 should = i == 0 ? was : reference.after(place(blocks, b, k, i), was);
    worst = std::max(worst, glm::length(now - should));
    fastest = std::max(fastest, glm::length(was));
  });
  return worst / fastest;
}

TEST(VoxelGrid, DoesWhatTheStraightforwardVersionDoes) {
  // Sums of about 30 floats, divided: 1e-5.
  WindSettings still, wind = wind_of({3, 0.5F, -1}, 1);
  wind.gust = 0;
  for (const unsigned seed : {1U, 2U, 3U}) {
    const StrandBlocks blocks = random_blocks(300, 19, 0.08F, seed);
    EXPECT_LT(difference(blocks, interaction(40, 0), still), 1e-5);
    EXPECT_LT(difference(blocks, interaction(0, 50), still), 1e-5);
    EXPECT_LT(difference(blocks, interaction(0, 50, RepulsionKind::overfull), still), 1e-5);
    EXPECT_LT(difference(blocks, interaction(0, 0), wind), 1e-5);
    EXPECT_LT(difference(blocks, interaction(40, 50), wind), 1e-5);
    EXPECT_LT(difference(blocks, interaction(40, 50, RepulsionKind::overfull), wind), 1e-5);
  }
}

TEST(VoxelGrid, TakesFrictionAsThePapersDenseGridDoes) {
  StrandBlocks blocks = random_blocks(500, 16, 0.1F, 7);
  std::vector<paper::Particle<double>> particles;
  each_vertex(blocks, [&](std::size_t, std::uint32_t i, std::uint32_t n, std::size_t b, std::size_t k) {
    const double mass = static_cast<double>(blocks.segment_m[b].v[k]) * (i == 0 || i + 1 == n ? 0.5 : 1.0);
    particles.push_back({place(blocks, b, k, i), get(blocks.velocity[blocks.first[b] + i], k), mass, i == 0});
  });
  GridStep step;
  paper::Step<double> same;
  same.cell_m = static_cast<double>(kCell);
  same.friction = -std::expm1(-30 * step.step_s);
  paper::DenseGrid<double> dense;
  paper::Octree<double> octree;
  auto by_octree = particles;
  paper::fill(particles, same, dense);
  paper::affect(particles, same, dense);
  paper::fill(by_octree, same, octree);
  paper::affect(by_octree, same, octree);
  VoxelGrid grid(interaction(30, 0), {});
  grid.build(blocks, step);
  grid.apply(blocks, step);
  std::size_t at = 0;
  double worst = 0;
  each_vertex(blocks, [&](std::size_t, std::uint32_t i, std::uint32_t, std::size_t b, std::size_t k) {
    EXPECT_EQ(particles[at].velocity, by_octree[at].velocity);
    const glm::dvec3 now = get(blocks.velocity[blocks.first[b] + i], k);
    worst = std::max(worst, glm::length(now - particles[at++].velocity));
  });
  EXPECT_LT(worst, 1e-5);
}

TEST(VoxelGrid, GivesTheSameBitsForAnyNumberOfThreads) {
  WindSettings wind = wind_of({2, 0, 1}, 1);
  const StrandBlocks start = random_blocks(20000, 24, 0.12F, 3);  // many runs
  std::vector<Lanes3> first;
  for (const int threads : {1, 2, 3, 8}) {
    tbb::global_control allow(tbb::global_control::max_allowed_parallelism, static_cast<std::size_t>(threads));
    StrandBlocks blocks = start;
    VoxelGrid grid(interaction(40, 5), wind);
    tbb::task_arena(threads).execute([&] {
      for (int i = 0; i < 2; ++i) {
        grid.build(blocks, {});
        grid.apply(blocks, {});
      }
    });
    if (first.empty()) first = blocks.velocity;
    EXPECT_EQ(std::memcmp(first.data(), blocks.velocity.data(), first.size() * sizeof(Lanes3)), 0) << threads;
  }
}

TEST(VoxelGrid, AnswersDoNotDependOnHairFarAway) {
  // Rows and runs differ, cells do not.
  StrandBlocks a = random_blocks(200, 12, 0.05F, 4);
  Strands hair, more;
  each_vertex(a, [&](std::size_t, std::uint32_t i, std::uint32_t n, std::size_t b, std::size_t k) {
    if (i > 0) return;
    std::vector<glm::vec3> line;
    for (std::uint32_t j = 0; j < n; ++j) line.push_back(place(a, b, k, j));
    hair.append(line);
    more.append(line);
  });
  more.append(std::vector<glm::vec3>{{0.9F, 0.9F, 0.9F}, {0.91F, 0.9F, 0.9F}});
  VoxelGrid one(interaction(4, 1), {}), two(interaction(4, 1), {});
  one.build(make_blocks(hair, glm::dvec3(0)), {});
  two.build(make_blocks(more, glm::dvec3(0)), {});
  // Strands are in another order: another order of sums.
  for (const glm::vec3& p : hair.vertices) EXPECT_NEAR(one.density(p), two.density(p), 1e-5F * one.density(p));
}

TEST(VoxelGrid, AnswersDoNotDependOnTheStepsBefore) {
  // Rows and box are kept from step to step; hair that falls and spreads leaves them and finds new ones.
  StrandBlocks blocks = random_blocks(3000, 20, 0.08F, 6);
  const StrandBlocks other = random_blocks(3100, 20, 0.05F, 8);
  const WindSettings wind = wind_of({2, 0, 1}, 1);
  VoxelGrid kept(interaction(40, 5), wind);
  kept.set_rest_density(other);
  std::size_t rows = 0;
  for (int i = 0; i < 150; ++i) {
    for (Lanes3& root : blocks.root)
      for (std::size_t k = 0; k < kLanes; ++k) {
        root.y[k] -= 0.003F * static_cast<float>(k % 3);
        root.x[k] *= 1.004F;
      }
    StrandBlocks a = blocks, b = blocks;
    kept.build(a, {});
    kept.apply(a, {});
    rows = kept.rows();
    if (i % 10 != 0) continue;
    VoxelGrid fresh(interaction(40, 5), wind);
    fresh.set_rest_density(other);
    fresh.build(b, {});
    fresh.apply(b, {});
    ASSERT_EQ(std::memcmp(a.velocity.data(), b.velocity.data(), a.velocity.size() * sizeof(Lanes3)), 0) << i;
    ASSERT_EQ(kept.used_nodes(), fresh.used_nodes());
    EXPECT_LT(rows, 4 * fresh.rows()) << i;  // those left behind go
  }
}

TEST(VoxelGrid, FindsRowsThatBeginAndDropsThoseThatHairHasLeft) {
  const auto with_third_at = [](float x) {
    Strands hair;
    for (const glm::vec3& p : {glm::vec3(0), glm::vec3(0.3F), glm::vec3(x, 0.105F, 0.105F)})
      hair.append(std::vector<glm::vec3>{p, p + glm::vec3(0, 0.001F, 0)});
    return make_blocks(hair, glm::dvec3(0));
  };
  VoxelGrid kept(interaction(4, 1), {});
  kept.build(with_third_at(0.065F), {});
  // From cell 6 of 8 to cell 7: no row of vertices is new, but the first node of the next one is.
  kept.build(with_third_at(0.075F), {});
  VoxelGrid fresh(interaction(4, 1), {});
  fresh.build(with_third_at(0.075F), {});
  EXPECT_GT(kept.density({0.0799F, 0.105F, 0.105F}), 0);
  EXPECT_EQ(kept.density({0.0799F, 0.105F, 0.105F}), fresh.density({0.0799F, 0.105F, 0.105F}));
  EXPECT_EQ(kept.density({0.0801F, 0.105F, 0.105F}), fresh.density({0.0801F, 0.105F, 0.105F}));

  const StrandBlocks moved = with_third_at(0.245F);
  for (int i = 0; i < 64; ++i) kept.build(moved, {});
  VoxelGrid again(interaction(4, 1), {});
  again.build(moved, {});
  EXPECT_EQ(kept.rows(), again.rows());
}

TEST(VoxelGrid, SharesOneVertexOutByTrilinearWeights) {
  const glm::vec3 p = kCell * glm::vec3(3.25F, -2.5F, 7.125F);
  StrandBlocks blocks = pair_of_strands(p, p + glm::vec3(0, 0.5F, 0));
  VoxelGrid grid(interaction(4, 0), {});
  grid.build(blocks, {});
  const float mass = 0.05F, per_m3 = 1e6F;
  for (int c = 0; c < 8; ++c) {
    const glm::ivec3 d(c & 1, c >> 1 & 1, c >> 2);
    const glm::vec3 node = kCell * glm::vec3(3 + d.x, -3 + d.y, 7 + d.z);
    const float weight = (d.x ? 0.25F : 0.75F) * 0.5F * (d.z ? 0.125F : 0.875F);
    EXPECT_NEAR(grid.density(node), weight * mass * per_m3, 2e-6F * mass * per_m3) << c;
  }
}

TEST(VoxelGrid, BringsTwoVerticesOfOppositeVelocityToRest) {
  const glm::vec3 p = kCell * glm::vec3(0.3F, 0.4F, 0.6F);
  StrandBlocks blocks = pair_of_strands(p, p);
  for (std::size_t k = 0; k < 2; ++k) put(blocks.velocity[1], k, {k == 0 ? 2.0F : -2.0F, 0, 0});
  GridStep step;
  VoxelGrid grid(interaction(10, 0), {});
  grid.build(blocks, step);
  grid.apply(blocks, step);
  const float left = static_cast<float>(2 * std::exp(-10 * step.step_s));
  EXPECT_NEAR(get(blocks.velocity[1], 0).x, left, 1e-6F);
  EXPECT_NEAR(get(blocks.velocity[1], 1).x, -left, 1e-6F);
}

TEST(VoxelGrid, KeepsMassAndMomentum) {
  const StrandBlocks blocks = random_blocks(700, 30, 0.1F, 9);
  VoxelGrid grid(interaction(4, 0), {});
  grid.build(blocks, {});
  double mass = 0;
  glm::dvec3 momentum(0), given(0);
  for (int z = -80; z < 80; ++z)
    for (int y = -80; y < 80; ++y)
      for (int x = -80; x < 80; ++x) {
        const glm::vec3 node = kCell * glm::vec3(glm::ivec3(x, y, z));
        const glm::vec3 inside = node + 1e-4F * kCell;  // a density at the node itself may round to the cell before
        const double m = static_cast<double>(grid.density(inside));
        mass += m * 1e-6;
        momentum += 1e-6 * m * glm::dvec3(grid.velocity(inside));
      }
  each_vertex(blocks, [&](std::size_t, std::uint32_t i, std::uint32_t n, std::size_t b, std::size_t k) {
    given += static_cast<double>(blocks.segment_m[b].v[k]) * (i == 0 || i + 1 == n ? 0.5 : 1.0) *
             glm::dvec3(get(blocks.velocity[blocks.first[b] + i], k));
  });
  EXPECT_NEAR(mass, mass_of(blocks), 1e-5 * mass_of(blocks));
  EXPECT_LT(glm::length(momentum - given), 2e-3 * mass_of(blocks));  // off the nodes by 1e-4 of a cell
}

TEST(VoxelGrid, WeightsAddUpOnFacesAndAtZeros) {  // HARD_CASES 20
  for (const float at : {0.0F, -0.0F, 1e-38F, -1e-38F, kCell, -kCell, 4 * kCell, -4 * kCell,
                         std::nextafter(kCell, 0.0F), std::nextafter(-4 * kCell, 0.0F), 0.123456F}) {
    for (int axis = 0; axis < 3; ++axis) {
      glm::vec3 p(0.0043F);
      p[axis] = at;
      StrandBlocks blocks = pair_of_strands(p, p + glm::vec3(0.5F));
      put(blocks.velocity[1], 0, {3, 3, 3});
      VoxelGrid grid(interaction(1000, 0), {});
      GridStep step;
      step.step_s = 0.5;  // c = 1: the vertex takes what it gave
      grid.build(blocks, step);
      EXPECT_EQ(grid.strays(), 0U);
      grid.apply(blocks, step);
      for (const float v : {blocks.velocity[1].x[0], blocks.velocity[1].y[0], blocks.velocity[1].z[0]})
        EXPECT_NEAR(v, 3, 3 * 4 * 1.2e-7F) << at;
    }
  }
}

TEST(VoxelGrid, WeightsAreNotNegativeOnFacesAndAtZeros) {  // HARD_CASES 20
  for (const float at : {0.0F, -0.0F, 1e-38F, -1e-38F, kCell, -kCell, 3 * kCell, std::nextafter(kCell, 0.0F),
                         std::nextafter(-kCell, 0.0F), std::nextafter(-kCell, -1.0F)}) {
    const StrandBlocks blocks = pair_of_strands(glm::vec3(at), glm::vec3(at));
    VoxelGrid grid(interaction(4, 0), {});
    grid.build(blocks, {});
    const double mass = 0.1, per_m3 = 1e6;  // two ends of strands of .1 m
    double sum = 0;
    for (int c = 0; c < 6 * 6 * 6; ++c) {
      const glm::vec3 node =
          kCell * (glm::round(glm::vec3(at) / kCell) + glm::vec3(c % 6 - 2, c / 6 % 6 - 2, c / 36 - 2));
      const float there = grid.density(node);
      ASSERT_GE(there, 0.0F) << at << ", node " << node.x << ' ' << node.y << ' ' << node.z;
      sum += static_cast<double>(there);
    }
    EXPECT_NEAR(sum, mass * per_m3, 4e-6 * mass * per_m3) << at;  // nodes in float, as they are asked for
  }
}

/// Hair on a lattice of `per_cell`^3 vertices per cell that fills [-cells, cells)^3 cells evenly.
StrandBlocks even_hair(int cells, int per_cell) {
  Strands hair;
  const float d = kCell / static_cast<float>(per_cell);
  const int n = cells * per_cell;
  for (int z = -n; z < n; ++z)
    for (int y = -n; y < n; ++y) {
      std::vector<glm::vec3> line;
      for (int x = -n; x < n; ++x) line.push_back(d * (glm::vec3(glm::ivec3(x, y, z)) + 0.5F));
      hair.append(line);
    }
  return make_blocks(hair, glm::dvec3(0));
}

TEST(VoxelGrid, DoesNotRepelWhereHairIsEven) {  // HARD_CASES 21
  for (const RepulsionKind kind : {RepulsionKind::gradient, RepulsionKind::overfull}) {
    StrandBlocks blocks = even_hair(6, 2);
    InteractionSettings s = interaction(0, 10, kind);
    s.overfull = 0.5F;
    VoxelGrid grid(s, {});
    grid.build(blocks, {});
    grid.apply(blocks, {});
    float inside = 0, border = 0;
    each_vertex(blocks, [&](std::size_t, std::uint32_t i, std::uint32_t, std::size_t b, std::size_t k) {
      const glm::vec3 p = glm::abs(place(blocks, b, k, i)) / kCell;
      const float v = glm::length(get(blocks.velocity[blocks.first[b] + i], k));
      if (std::max({p.x, p.y, p.z}) < 3) inside = std::max(inside, v);
      border = std::max(border, v);
    });
    EXPECT_LT(inside, 1e-5F * 10 / 480);
    EXPECT_GT(border, 0.1F * 10 / 480);
    EXPECT_LE(border, 1.0001F * 10 / 480);
  }
}

TEST(VoxelGrid, RepelsOutwardsFromABall) {
  for (const RepulsionKind kind : {RepulsionKind::gradient, RepulsionKind::overfull}) {
    StrandBlocks blocks = random_blocks(4000, 12, 0.04F, 21);
    for (Lanes3& v : blocks.velocity) v = {};
    InteractionSettings s = interaction(0, 10, kind);
    s.overfull = 1;
    VoxelGrid grid(s, {});
    grid.build(blocks, {});
    grid.apply(blocks, {});
    int out = 0, in = 0;
    double outward = 0;
    each_vertex(blocks, [&](std::size_t, std::uint32_t i, std::uint32_t, std::size_t b, std::size_t k) {
      const glm::vec3 p = place(blocks, b, k, i), v = get(blocks.velocity[blocks.first[b] + i], k);
      EXPECT_TRUE(std::isfinite(v.x + v.y + v.z));
      EXPECT_LE(glm::length(v), 1.0001F * 10 / 480);
      if (i == 0 || glm::length(p) < 0.02F || glm::length(p) > 0.06F || glm::length(v) < 1e-6F) return;
      (glm::dot(p, v) > 0 ? out : in) += 1;
      outward += static_cast<double>(glm::dot(p, v));
    });
    EXPECT_GT(outward, 0);
    EXPECT_GT(out, 4 * in);
  }
}

TEST(VoxelGrid, PushesOutOfAnOverfullCellAndNotAtItsCentre) {  // HARD_CASES 8
  Strands hair;
  std::vector<glm::vec3> places;
  for (int i = 0; i < 40; ++i) places.push_back(kCell * glm::vec3(0.5F));
  places.push_back(kCell * glm::vec3(0.9F, 0.5F, 0.5F));
  places.push_back(kCell * glm::vec3(0.5F, 0.2F, 0.5F));
  for (std::size_t s = 0; s < places.size(); ++s)  // the last two weigh next to nothing
    hair.append(std::vector<glm::vec3>{places[s] + glm::vec3(s < 40 ? 1 : 1e-5F, 0, 0), places[s]});
  StrandBlocks blocks = make_blocks(hair, glm::dvec3(0));
  VoxelGrid grid(interaction(0, 10, RepulsionKind::overfull), {});
  grid.set_rest_density(random_blocks(200, 12, 0.05F, 4));
  grid.build(blocks, {});
  grid.apply(blocks, {});
  const auto velocity = [&](std::size_t strand) {
    const std::uint32_t at = blocks.block_of[strand];
    return get(blocks.velocity[blocks.first[at / kLanes] + 1], at % kLanes);
  };
  EXPECT_LT(glm::length(velocity(0)), 1e-6F);
  EXPECT_GT(velocity(40).x, 1e-3F);
  EXPECT_NEAR(velocity(40).y, 0, 1e-6F);
  EXPECT_LT(velocity(41).y, -1e-3F);
}

/// Velocity of a vertex among hair at rest and in wind after 1/8 s of steps.
std::array<float, 3> after_steps(int per_s) {
  StrandBlocks blocks = even_hair(3, 1);
  InteractionSettings s = interaction(6, 2);
  VoxelGrid grid(s, [] {
    WindSettings w = wind_of({0, 4, 0}, 0.5F);
    w.gust = 0;
    return w;
  }());
  grid.set_rest_density(blocks);
  GridStep step;
  step.step_s = 1.0 / per_s;
  std::size_t block = 0, lane = 0;
  float nearest = 1;
  each_vertex(blocks, [&](std::size_t, std::uint32_t i, std::uint32_t, std::size_t b, std::size_t k) {
    const float d = glm::length(place(blocks, b, k, i) - glm::vec3(0.025F, 0.005F, 0.005F));
    if (i == 5 && d < nearest) {
      nearest = d;
      block = b;
      lane = k;
    }
  });
  float v = 5;
  for (int i = 0; i < per_s / 8; ++i) {
    for (Lanes3& all : blocks.velocity) all = {};
    Lanes3& one = blocks.velocity[blocks.first[block] + 5];
    one.x[lane] = v;
    one.y[lane] = 0;
    grid.build(blocks, step);
    grid.apply(blocks, step);
    v = one.x[lane];
  }
  const Lanes3& one = blocks.velocity[blocks.first[block] + 5];
  return {v, one.y[lane] * static_cast<float>(per_s), one.z[lane]};
}

TEST(VoxelGrid, DecaysAlikeAtAnyInternalStep) {  // HARD_CASES 22
  // Friction and wind add up exactly; repulsion and the vertex's own share of V leave O(h (6 + 3) / 2) = 2 %.
  const std::array<float, 3> fine = after_steps(960);
  for (const int per_s : {240, 480}) {
    const std::array<float, 3> coarse = after_steps(per_s);
    EXPECT_NEAR(coarse[0], fine[0], 0.02F * std::abs(fine[0])) << per_s;
    EXPECT_NEAR(coarse[1], fine[1], 0.03F * std::abs(fine[1])) << per_s;
  }
  EXPECT_LT(fine[0], 4.5F);
  EXPECT_GT(fine[1], 0.5F);
}

TEST(VoxelGrid, RepulsionIsPerSecond) {  // HARD_CASES 22
  for (const RepulsionKind kind : {RepulsionKind::gradient, RepulsionKind::overfull}) {
    const auto pushed = [&](int per_s) {
      StrandBlocks blocks = random_blocks(1000, 12, 0.04F, 21);
      for (Lanes3& v : blocks.velocity) v = {};
      InteractionSettings s = interaction(0, 10, kind);
      s.overfull = 1;
      VoxelGrid grid(s, {});
      GridStep step;
      step.step_s = 1.0 / per_s;
      for (int i = 0; i < per_s / 16; ++i) {
        grid.build(blocks, step);
        grid.apply(blocks, step);
      }
      std::vector<glm::vec3> velocities;
      each_vertex(blocks, [&](std::size_t, std::uint32_t i, std::uint32_t, std::size_t b, std::size_t k) {
        velocities.push_back(get(blocks.velocity[blocks.first[b] + i], k));
      });
      return velocities;
    };
    const std::vector<glm::vec3> fine = pushed(960);
    float most = 0;
    for (const glm::vec3& v : fine) most = std::max(most, glm::length(v));
    EXPECT_GT(most, 0.3F * 10 / 16);
    for (const int per_s : {240, 480}) {
      const std::vector<glm::vec3> coarse = pushed(per_s);
      for (std::size_t v = 0; v < fine.size(); ++v) ASSERT_LT(glm::distance(coarse[v], fine[v]), 1e-4F * most) << per_s;
    }
  }
}

TEST(VoxelGrid, DoesNothingWithNothingToDo) {
  StrandBlocks blocks = random_blocks(50, 12, 0.05F, 4);
  const StrandBlocks before = blocks;
  VoxelGrid grid(interaction(0, 0), {});
  EXPECT_TRUE(grid.idle());
  grid.build(blocks, {});
  grid.apply(blocks, {});
  EXPECT_EQ(grid.bytes(), 0U);
  EXPECT_EQ(std::memcmp(before.velocity.data(), blocks.velocity.data(), before.velocity.size() * sizeof(Lanes3)), 0);
  EXPECT_FALSE(VoxelGrid(interaction(1, 0), {}).idle());
  EXPECT_FALSE(VoxelGrid(interaction(0, 1), {}).idle());
  EXPECT_FALSE(VoxelGrid(interaction(0, 0), wind_of({1, 0, 0}, 0)).idle());
  WindSettings no_drag = wind_of({1, 0, 0}, 0);
  no_drag.drag_per_s = 0;
  EXPECT_TRUE(VoxelGrid(interaction(0, 0), no_drag).idle());
}

TEST(VoxelGrid, LeavesRootsSleepersAndPaddingAlone) {
  StrandBlocks blocks = random_blocks(100, 9, 0.05F, 4);
  const StrandBlocks before = blocks;
  std::vector<std::uint8_t> awake(blocks.count(), 1);
  awake[2] = 0;
  GridStep step;
  step.awake = awake;
  VoxelGrid grid(interaction(40, 10), wind_of({5, 0, 0}, 1));
  grid.build(blocks, step);
  grid.apply(blocks, step);
  std::size_t changed = 0;
  for (std::size_t b = 0; b < blocks.count(); ++b)
    for (std::uint32_t v = blocks.first[b]; v < blocks.first[b + 1]; ++v)
      for (std::size_t k = 0; k < kLanes; ++k) {
        const auto i = static_cast<float>(v - blocks.first[b]);
        const bool may = b != 2 && i > 0 && i < blocks.vertices[b].v[k];
        const bool did = get(blocks.velocity[v], k) != get(before.velocity[v], k);
        EXPECT_LE(did, may) << b << ' ' << v << ' ' << k;
        changed += did;
      }
  EXPECT_GT(changed, 300U);
}

TEST(VoxelGrid, TakesNoHair) {
  StrandBlocks none = make_blocks({}, glm::dvec3(0));
  VoxelGrid grid(interaction(4, 1), wind_of({1, 0, 0}, 1));
  grid.set_rest_density(none);
  grid.build(none, {});
  grid.apply(none, {});
  EXPECT_EQ(grid.density({0, 0, 0}), 0);
  EXPECT_EQ(grid.rows(), 0U);

  Strands roots_only;
  roots_only.append(std::vector<glm::vec3>{{0, 0, 0}});
  StrandBlocks single = make_blocks(roots_only, glm::dvec3(0));
  grid.build(single, {});
  grid.apply(single, {});
  EXPECT_EQ(grid.density({0, 0, 0}), 0);
}

TEST(VoxelGrid, SkipsWhatIsNotFiniteAndWhatIsFar) {  // HARD_CASES 28
  const StrandBlocks sound = random_blocks(400, 12, 0.05F, 4);
  VoxelGrid alone(interaction(4, 1), wind_of({1, 0, 0}, 1));
  alone.build(sound, {});
  std::size_t bytes = alone.bytes();
  for (const float bad : {NAN, INFINITY, -INFINITY, 1e30F, -1e30F, 3e9F, 1e5F, 3000.0F, -50.0F}) {
    StrandBlocks blocks = sound;
    blocks.position[3].y[5] = bad;
    blocks.root[4].x[2] = bad;
    VoxelGrid grid(interaction(4, 1), wind_of({1, 0, 0}, 1));
    grid.set_rest_density(sound);
    grid.build(blocks, {});
    grid.apply(blocks, {});
    EXPECT_LT(grid.bytes(), bytes + (40U << 20)) << bad;
    EXPECT_GT(grid.strays(), 1U) << bad;
    EXPECT_LT(grid.strays(), 16U) << bad;
    EXPECT_GT(grid.density({0, 0, 0}), 0) << bad;
    for (std::size_t b = 0; b < blocks.count(); ++b)
      for (std::uint32_t v = blocks.first[b]; v < blocks.first[b + 1]; ++v)
        for (std::size_t k = 0; k < kLanes; ++k)
          ASSERT_TRUE(std::isfinite(glm::length(get(blocks.velocity[v], k)))) << bad;
  }
}

TEST(VoxelGrid, BlowsOnAStrayToo) {
  StrandBlocks blocks = random_blocks(40, 5, 0.05F, 4);
  for (Lanes3& v : blocks.velocity) v = {};
  blocks.root[1].x[3] = 5000;
  VoxelGrid grid(interaction(4, 0), wind_of({2, 0, 0}, 1));
  grid.build(blocks, {});
  grid.apply(blocks, {});
  EXPECT_GT(grid.strays(), 0U);
  EXPECT_GT(blocks.velocity[blocks.first[1] + 1].x[3], 2 * 0.9F * 0.5F * 3 / 480);
}

TEST(VoxelGrid, RefusesACellOfNoSize) {
  for (const float cell : {0.0F, -1.0F, NAN, INFINITY}) {
    InteractionSettings s;
    s.cell_m = cell;
    EXPECT_THROW(VoxelGrid(s, {}), UsageError) << cell;
  }
}

TEST(VoxelGrid, WakesSleepersNextToMovingHairOnly) {
  Strands hair;
  for (int s = 0; s < 4 * kLanes; ++s) {  // four clumps, a block each; only clumps 0 and 1 touch
    const int clump = s / kLanes;
    const glm::vec3 at(clump < 2 ? 0.0F : static_cast<float>(clump), 0.001F * static_cast<float>(s % kLanes), 0);
    hair.append(std::vector<glm::vec3>{at, at + glm::vec3(0, 0, 0.01F)});
  }
  StrandBlocks blocks = make_blocks(hair, glm::dvec3(0));
  std::array<std::size_t, 4> block{};  // one of each clump; Morton order may mix the two that touch
  for (std::size_t c = 0; c < 4; ++c) block[c] = blocks.block_of[c * kLanes] / kLanes;
  const std::size_t moving = block[0];
  for (std::size_t k = 0; k < kLanes; ++k) put(blocks.velocity[blocks.first[moving] + 1], k, {0, 0.5F, 0});
  std::vector<std::uint8_t> awake(blocks.count(), 0), stirred(blocks.count(), 0);
  awake[moving] = 1;
  GridStep step;
  step.awake = awake;
  VoxelGrid grid(interaction(4, 1), {});
  grid.build(blocks, step);
  grid.wake(blocks, step, stirred, 0.01F);
  std::size_t woken = 0;
  for (const std::uint8_t s : stirred) woken += s;
  EXPECT_EQ(woken, 1U);  // the other block of the two that touch
  EXPECT_EQ(stirred[block[2]], 0);
  EXPECT_EQ(stirred[block[3]], 0);
  EXPECT_EQ(stirred[moving], 0);
  std::fill(stirred.begin(), stirred.end(), std::uint8_t{0});
  grid.wake(blocks, step, stirred, 0.6F);
  for (const std::uint8_t s : stirred) EXPECT_EQ(s, 0);
}

TEST(VoxelGrid, SheltersFromTheWindByDensity) {
  StrandBlocks blocks = even_hair(5, 2);
  WindSettings wind = wind_of({10, 0, 0}, 1);
  wind.gust = 0;
  VoxelGrid grid(interaction(0, 0), wind);
  grid.set_rest_density(blocks);
  GridStep step;
  grid.build(blocks, step);
  grid.apply(blocks, step);
  const float free = 10 * static_cast<float>(-std::expm1(-3 * step.step_s));
  float least = 1e9F, most = 0;
  each_vertex(blocks, [&](std::size_t, std::uint32_t i, std::uint32_t, std::size_t b, std::size_t k) {
    if (i == 0) return;
    const float v = blocks.velocity[blocks.first[b] + i].x[k];
    least = std::min(least, v);
    most = std::max(most, v);
  });
  const float inside = grid.density({0, 0, 0}) / grid.rest_density();  // 1 but for the many vertices near the border
  EXPECT_NEAR(inside, 1, 0.1F);
  EXPECT_NEAR(least, free * std::exp(-inside), 1e-4F * free);
  EXPECT_GT(most, free * std::exp(-0.7F));
  EXPECT_LT(most, free);

  wind.shelter = 0;
  StrandBlocks open = even_hair(5, 2);
  VoxelGrid without(interaction(0, 0), wind), with(interaction(1e-6F, 0), wind);
  without.build(open, step);
  EXPECT_EQ(without.bytes(), 0U);
  without.apply(open, step);
  EXPECT_FLOAT_EQ(open.velocity[1].x[0], free);
  StrandBlocks same = even_hair(5, 2);
  with.build(same, step);
  with.apply(same, step);
  EXPECT_NEAR(same.velocity[1].x[0], free, 1e-6F);
}

TEST(Wind, RisesAndFallsAroundItsMeanWithinItsBounds) {
  WindSettings settings = wind_of({3, 0, 4}, 0);
  settings.gust = 0.6F;
  Wind wind(settings);
  double sum = 0, sum_sq = 0;
  float least = 1e9F, most = 0;
  const int n = 20000;
  for (int i = 0; i < n; ++i) {
    wind.set(0.037 * i, {0.1 * (i % 7), 1000.0 + 0.013 * i, -2.0});
    const glm::vec3 v = wind.at({0.01F * static_cast<float>(i % 50), 0, 0});
    EXPECT_NEAR(v.x * 4, v.z * 3, 1e-5F);
    const float speed = glm::length(v);
    least = std::min(least, speed);
    most = std::max(most, speed);
    sum += static_cast<double>(speed);
    sum_sq += static_cast<double>(speed) * static_cast<double>(speed);
  }
  EXPECT_GE(least, 5 * (1 - 0.6F) - 1e-4F);
  EXPECT_LE(most, 5 * (1 + 0.6F) + 1e-4F);
  EXPECT_NEAR(sum / n, 5, 0.05);
  // Four waves of shares .4 .3 .2 .1: variance (.16 + .09 + .04 + .01) / 2 of (5 x 0.6)^2.
  EXPECT_NEAR(std::sqrt(sum_sq / n - sum / n * sum / n), 5 * 0.6 * std::sqrt(0.15), 0.05);
}

TEST(Wind, IsSmoothInTimeAndSpace) {
  WindSettings settings = wind_of({5, 0, 0}, 0);
  Wind wind(settings);
  // |dg/dt| <= 2 pi sum share x turns per s < 2 pi 1.2 / gust_s; likewise along a metre.
  const float per_s = 5 * settings.gust * 6.2832F * 1.2F / settings.gust_s;
  const float per_m = 5 * settings.gust * 6.2832F * 1.1F / settings.gust_m;
  float before = 0;
  for (int i = 0; i < 5000; ++i) {
    wind.set(1e-3 * i, glm::dvec3(0.3, 0.1, 0.2));
    const float here = wind.at({0.05F, 0, 0}).x;
    if (i > 0) {
      EXPECT_LE(std::abs(here - before), 1e-3F * per_s + 2e-5F);
    }
    EXPECT_LE(std::abs(wind.at({0.051F, 0, 0}).x - here), 1e-3F * per_m + 2e-5F);
    before = here;
  }
}

TEST(Wind, StandsInTheWorldHoweverTheHeadMoves) {
  Wind wind(wind_of({5, 1, 0}, 0));
  wind.set(2.5, {0, 0, 0});
  const glm::vec3 at = wind.at({0.25F, 0.5F, -0.125F});
  wind.set(2.5, {0.25, 0.5, -0.125});
  EXPECT_NEAR(glm::distance(wind.at({0, 0, 0}), at), 0, 1e-5F);
  wind.set(2.5, {1e6, -1e6, 1e6});
  const glm::vec3 far = wind.at({0.25F, 0.5F, -0.125F});
  wind.set(2.5, {1e6 + 0.25, -1e6 + 0.5, 1e6 - 0.125});
  EXPECT_NEAR(glm::distance(wind.at({0, 0, 0}), far), 0, 1e-5F);
}

}  // namespace
}  // namespace pelage
