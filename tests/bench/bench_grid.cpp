// The voxel grid against paper C's straightforward versions (tests/simulate/paper_grid.h): a dense grid and a top-down
// octree, and against the time that the bytes it has to touch take. One process; ratios are what counts.
//
// Bound: build reads positions and velocities of a vertex (24 p), its 8 nodes of 16 bytes (128 p) and writes them (128
// p); apply reads positions and velocities, reads 128 p of nodes and writes velocities (12 p); rows are written, read
// and written again (deposit 144, values 128, fields 144 bytes each); at the bandwidth measured on 1 MiB.
#include <benchmark/benchmark.h>
#include <tbb/global_control.h>
#include <tbb/task_arena.h>

#include <cstdio>
#include <ctime>
#include <random>
#include <string>

#include "../simulate/paper_grid.h"
#include "pelage/simulate/voxel_grid.h"

namespace {

using namespace pelage;

/// Strands from a scalp of 9 cm radius, 20 to 23 cm along, in locks of 25.
Strands hair_of(std::size_t strands, std::size_t points) {
  std::mt19937 random(11);
  std::normal_distribution<float> normal;
  std::uniform_real_distribution<float> uniform(0, 1);
  Strands s;
  glm::vec3 lock{0, 1, 0};
  for (std::size_t i = 0; i < strands; ++i) {
    if (i % 25 == 0) lock = glm::normalize(glm::vec3(normal(random), std::abs(normal(random)) + 0.1F, normal(random)));
    const glm::vec3 root =
        0.09F * glm::normalize(lock + 0.06F * glm::vec3(normal(random), normal(random), normal(random)));
    const glm::vec3 out = glm::normalize(root);
    const float length = 0.20F + 0.03F * uniform(random), phase = 6.28F * uniform(random);
    std::vector<glm::vec3> line;
    for (std::size_t k = 0; k < points; ++k) {
      const float t = static_cast<float>(k) / static_cast<float>(points - 1), along = t * length;
      const glm::vec3 p = root + out * (0.10F * (1 - std::exp(-3.0F * t))) + glm::vec3(0, -1, 0) * (along * t);
      line.push_back(p + 0.002F * std::sin(20 * along + phase) * glm::vec3(out.z, 0, -out.x));
    }
    s.append(line);
  }
  return s;
}

StrandBlocks moving_blocks(std::size_t strands, std::size_t points) {
  StrandBlocks blocks = make_blocks(hair_of(strands, points), glm::dvec3(0));
  std::mt19937 random(5);
  std::uniform_real_distribution<float> uniform(-1, 1);
  for (Lanes3& v : blocks.velocity)
    for (int k = 0; k < kLanes; ++k) {
      v.x[k] = uniform(random);
      v.y[k] = uniform(random);
      v.z[k] = uniform(random);
    }
  return blocks;
}

std::vector<paper::Particle<float>> particles_of(const StrandBlocks& blocks) {
  std::vector<paper::Particle<float>> particles;
  for (std::size_t s = 0; s < blocks.strands; ++s) {
    const std::size_t b = blocks.block_of[s] / kLanes, k = blocks.block_of[s] % kLanes;
    const auto n = static_cast<std::uint32_t>(blocks.vertices[b].v[k]);
    for (std::uint32_t i = 0; i < n; ++i) {
      const Lanes3 &p = blocks.position[blocks.first[b] + i], &v = blocks.velocity[blocks.first[b] + i];
      paper::Particle<float> q;
      q.position = {blocks.root[b].x[k] + p.x[k], blocks.root[b].y[k] + p.y[k], blocks.root[b].z[k] + p.z[k]};
      q.velocity = {v.x[k], v.y[k], v.z[k]};
      q.mass = blocks.segment_m[b].v[k] * (i == 0 || i + 1 == n ? 0.5F : 1.0F);
      q.root = i == 0;
      particles.push_back(q);
    }
  }
  return particles;
}

/// Of this thread, so that what other programs do to a shared machine stays out; of the wall for several threads.
double seconds(bool wall = false) {
  timespec t{};
  clock_gettime(wall ? CLOCK_MONOTONIC : CLOCK_THREAD_CPUTIME_ID, &t);
  return static_cast<double>(t.tv_sec) + 1e-9 * static_cast<double>(t.tv_nsec);
}

/// Least of many runs: on a machine that others use, the one that says what it takes.
template <class Run>
double least_s(int repeats, Run&& run) {
  double best = 1e30;
  for (int i = 0; i < repeats; ++i) {
    const double start = seconds();
    run();
    best = std::min(best, seconds() - start);
  }
  return best;
}

double bytes_per_s() {
  std::vector<std::uint32_t> a(1 << 17, 1), b(1 << 17, 2);
  const double s = least_s(301, [&] {
    for (std::size_t i = 0; i < a.size(); ++i) a[i] += b[i];
    benchmark::DoNotOptimize(a.data());
  });
  return 3.0 * 4.0 * static_cast<double>(a.size()) / s;
}

struct Times {
  double build_s = 0, apply_s = 0;
  double all() const { return build_s + apply_s; }
};

InteractionSettings with_cell(float cell_m) {
  InteractionSettings interaction;
  interaction.cell_m = cell_m;
  return interaction;
}

/// Of a step: strands that have moved on by half a cell each time, so that rows come and go.
Times sparse(VoxelGrid& grid, StrandBlocks& blocks, int repeats, bool wall) {
  GridStep step;
  Times best{1e30, 1e30};
  for (int i = 0; i < repeats; ++i) {
    for (Lanes3& root : blocks.root)
      for (float& x : root.x) x += i % 2 == 0 ? 0.005F : -0.005F;
    const double a = seconds(wall);
    grid.build(blocks, step);
    const double b = seconds(wall);
    grid.apply(blocks, step);
    const double c = seconds(wall);
    best = {std::min(best.build_s, b - a), std::min(best.apply_s, c - b)};
  }
  return best;
}

template <class Grid>
Times straightforward(std::vector<paper::Particle<float>> particles, float cell_m, float rest_density, Grid& grid,
                      int repeats) {
  const InteractionSettings interaction;
  paper::Step<float> step;
  step.cell_m = cell_m;
  step.friction = 1 - std::exp(-interaction.friction_per_s / 480);
  step.repulsion_m_s = interaction.repulsion_m_s2 / 480;
  step.rest_density = rest_density;
  const double build = least_s(repeats, [&] { paper::fill(particles, step, grid); });
  const double apply = least_s(repeats, [&] { paper::affect(particles, step, grid); });
  return {build, apply};
}

void row(const char* name, const Times& t, double vertices, std::size_t bytes, const char* beside, double ratio) {
  std::printf("  %-32s build %8.2f  apply %8.2f  both %8.2f ns/vertex  %8.2f MiB  %6.2f x %s\n", name,
              1e9 * t.build_s / vertices, 1e9 * t.apply_s / vertices, 1e9 * t.all() / vertices,
              static_cast<double>(bytes) / 1048576, ratio, beside);
}

void compare(std::size_t strands, std::size_t points, float cell_m, double bandwidth) {
  StrandBlocks blocks = moving_blocks(strands, points);
  const auto particles = particles_of(blocks);
  const auto vertices = static_cast<double>(particles.size());
  const int repeats = vertices > 2e5 ? 31 : 101;
  VoxelGrid grid(with_cell(cell_m), {});
  grid.set_rest_density(blocks);
  Times one;
  tbb::task_arena(1).execute([&] { one = sparse(grid, blocks, repeats, false); });
  Times one_wall, two;
  tbb::task_arena(1).execute([&] { one_wall = sparse(grid, blocks, 3 * repeats, true); });
  tbb::task_arena(2).execute([&] { two = sparse(grid, blocks, 3 * repeats, true); });
  paper::DenseGrid<float> dense;
  const Times by_paper = straightforward(particles, cell_m, grid.rest_density(), dense, 5);
  paper::Octree<float> octree;
  const Times by_octree = straightforward(particles, cell_m, grid.rest_density(), octree, 3);
  const auto rows = static_cast<double>(grid.rows());
  const double bound = (vertices * (24 + 256 + 24 + 128 + 12) + rows * 2 * (144 + 128 + 144)) / bandwidth;
  std::printf("%zu strands x %zu, cells of %.0f mm: %zu rows, %zu nodes with hair, bound %.2f ns/vertex\n", strands,
              points, 1e3 * static_cast<double>(cell_m), grid.rows(), grid.used_nodes(), 1e9 * bound / vertices);
  row("sparse, 1 thread", one, vertices, grid.bytes(), "faster than the paper's", by_paper.all() / one.all());
  row("sparse, 2 threads", two, vertices, grid.bytes(), "faster than one, wall", one_wall.all() / two.all());
  row("paper's, dense", by_paper, vertices, dense.bytes(), "the sparse one's memory",
      static_cast<double>(dense.bytes()) / static_cast<double>(grid.bytes()));
  row("paper's, octree", by_octree, vertices, octree.bytes(), "the sparse one's memory",
      static_cast<double>(octree.bytes()) / static_cast<double>(grid.bytes()));
}

void scaling() {
  std::printf("1K to 100K strands x 16, one thread:");
  std::vector<double> x, y;
  for (const std::size_t strands : {1000U, 3000U, 10000U, 30000U, 100000U}) {
    StrandBlocks blocks = moving_blocks(strands, 16);
    VoxelGrid grid({}, {});
    grid.set_rest_density(blocks);
    Times t;
    tbb::task_arena(1).execute([&] { t = sparse(grid, blocks, strands > 20000 ? 11 : 31, false); });
    x.push_back(std::log(static_cast<double>(strands)));
    y.push_back(std::log(t.all()));
    std::printf("  %zu: %.2f ns", strands, 1e9 * t.all() / static_cast<double>(16 * strands));
  }
  double mx = 0, my = 0, xy = 0, xx = 0;
  const auto n = static_cast<double>(x.size());
  for (std::size_t i = 0; i < x.size(); ++i) {
    mx += x[i] / n;
    my += y[i] / n;
  }
  for (std::size_t i = 0; i < x.size(); ++i) {
    xy += (x[i] - mx) * (y[i] - my);
    xx += (x[i] - mx) * (x[i] - mx);
  }
  std::printf(" per vertex; time grows as strands^%.2f\n", xy / xx);
}

void report() {
  const double bandwidth = bytes_per_s();
  std::printf("bandwidth on 1 MiB: %.1f GB/s\n", bandwidth / 1e9);
  for (const float cell_m : {0.01F, 0.003F}) {
    compare(3360, 16, cell_m, bandwidth);
    compare(10000, 32, cell_m, bandwidth);
  }
  scaling();
}

void BM_GridStep(benchmark::State& state) {
  StrandBlocks blocks = moving_blocks(3360, 16);
  VoxelGrid grid({}, {});
  const GridStep step;
  for (auto _ : state) {
    grid.build(blocks, step);
    grid.apply(blocks, step);
  }
}
BENCHMARK(BM_GridStep)->Unit(benchmark::kMillisecond);

}  // namespace

int main(int argc, char** argv) {
  benchmark::Initialize(&argc, argv);
  report();
  benchmark::RunSpecifiedBenchmarks();
}
