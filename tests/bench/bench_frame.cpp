// Whole frames of moving hair, without the draw: simulation, density map, its filter, colours, by stage. Beside them
// what the papers report: A Table 2 (P4 3 GHz, 134 wisps of three guides): 3,350 strands, 100K segments in 160 ms, with
// head collisions 286 ms; C chapter 4: 500 strands of 10 vertices at 3.8 frames/s, drawn. And a whole internal step,
// chains and grid, against the straightforward versions of both.
#include <benchmark/benchmark.h>
#include <tbb/task_arena.h>

#include <chrono>
#include <cmath>
#include <cstdio>
#include <functional>
#include <glm/geometric.hpp>
#include <vector>

#include "../simulate/paper_chain.h"
#include "../simulate/paper_grid.h"
#include "pelage/hair/groom.h"
#include "pelage/hair/head.h"
#include "pelage/shading/vertex_colours.h"
#include "pelage/shadow/density_map.h"
#include "pelage/simulate/chain_step.h"
#include "pelage/simulate/head_motion.h"
#include "pelage/simulate/moving_hair.h"
#include "pelage/simulate/voxel_grid.h"

namespace {

using namespace pelage;

constexpr int kFrames = 30;
constexpr double kFps = 30;

double ms(const std::function<void()>& work) {
  const auto begin = std::chrono::steady_clock::now();
  work();
  return std::chrono::duration<double, std::milli>(std::chrono::steady_clock::now() - begin).count();
}

Strands groom(hair::GroomStyle style, std::uint32_t strands, int vertices) {
  hair::GroomSettings s;
  s.style = style;
  s.strands = strands;
  s.vertices = vertices;
  Strands hair = hair::groom(s);
  hair.diameter_m = default_diameter_m(strands);
  return hair;
}

struct Frame {
  double chains = 0, grid = 0, strands = 0, fill = 0, transmittance = 0, filter = 0, colour = 0;
  double all() const { return chains + grid + strands + fill + transmittance + filter + colour; }
};

std::vector<glm::vec3> tangents_of(const Strands& hair) {
  std::vector<glm::vec3> t(hair.vertices.size());
  for (std::size_t s = 0; s < hair.count(); ++s)
    for (std::uint32_t v = hair.offsets[s]; v < hair.offsets[s + 1]; ++v) {
      const std::uint32_t next = std::min(v + 1, hair.offsets[s + 1] - 1);
      const glm::vec3 d = hair.vertices[next] - hair.vertices[next - 1];
      t[v] = d / std::max(glm::length(d), 1e-9F);
    }
  return t;
}

/// Mean of the frames of a shake.
Frame frames_of(const Strands& groomed, const Mesh& head, const SimulationSettings& settings) {
  MovingHair hair(groomed, head, settings);
  MotionSettings motion;
  DensityMap map{DensityMapSettings{}};
  ColourRequest request;
  std::vector<float> transmittance;
  std::vector<std::uint32_t> colours;
  Frame sum;
  for (int k = 1; k <= kFrames; ++k) {
    const SimulationFacts before = hair.simulation().facts();
    hair.advance(1 / kFps, head_pose(motion, hair.pivot(), k / kFps));
    sum.chains += hair.simulation().facts().chain_ms - before.chain_ms;
    sum.grid += hair.simulation().facts().grid_ms - before.grid_ms;
    const Strands& strands = hair.hair();
    sum.strands += hair.hair_ms();
    map.build(strands, kDefaultOpacity, request.light);
    sum.fill += map.times().fill_ms;
    sum.transmittance += map.times().transmittance_ms;
    transmittance.resize(strands.vertices.size());
    colours.resize(strands.vertices.size());
    sum.filter += ms([&] { map.transmittance(strands.vertices, transmittance); });
    sum.colour += ms([&] { vertex_colours(request, strands.vertices, tangents_of(strands), transmittance, colours); });
  }
  for (double* const part :
       {&sum.chains, &sum.grid, &sum.strands, &sum.fill, &sum.transmittance, &sum.filter, &sum.colour})
    *part /= kFrames;
  return sum;
}

void row(const char* name, const Frame& f) {
  std::printf("%-52s %7.2f %7.2f %7.2f %6.2f %6.2f %6.2f %6.2f  %7.2f ms  %6.1f frames/s\n", name, f.chains, f.grid,
              f.strands, f.fill, f.transmittance, f.filter, f.colour, f.all(), 1000 / f.all());
}

void frames() {
  std::printf("%-52s %7s %7s %7s %6s %6s %6s %6s\n", "frames of 1/30 s, 16 internal steps (ms)", "chains", "grid",
              "strands", "fill", "transm", "filter", "colour");
  const Mesh head = hair::parametric_head({});
  SimulationSettings loose = simulation_preset("loose");
  loose.vertices = 31;
  loose.detail = false;
  SimulationSettings wisps = simulation_preset("loose");
  wisps.wisps = 134;
  SimulationSettings curly = simulation_preset("curly");
  curly.wisps = 134;
  curly.shape.curl.subdivision = 2;
  const Strands straight = groom(hair::GroomStyle::straight, 3350, 31);
  row("3,350 strands, 100K segments, every vertex", frames_of(straight, {}, loose));
  row("  and outside the head", frames_of(straight, head, loose));
  row("  134 wisps (A: 160 ms)", frames_of(straight, {}, wisps));
  row("  134 wisps, outside the head (A: 286 ms)", frames_of(straight, head, wisps));
  row("  134 wisps, curled, 200K segments", frames_of(straight, head, curly));
  SimulationSettings c = loose;
  c.vertices = 10;
  row("500 strands of 10 vertices (C: 263 ms, drawn)", frames_of(groom(hair::GroomStyle::straight, 500, 10), {}, c));
}

/// One internal step of chains and grid, one thread, against the straightforward versions.
void step_against_papers(std::uint32_t strands, int vertices) {
  SimulationSettings s;
  s.vertices = vertices;
  const Strands lines = centre_lines(groom(hair::GroomStyle::straight, strands, vertices), vertices);
  StrandBlocks blocks = make_blocks(lines, glm::dvec3(0));
  VoxelGrid grid(s.interaction, s.wind);
  grid.set_rest_density(blocks);
  ChainStep chain;
  std::vector<float> fastest(blocks.count());
  std::vector<paper::Strand> plain = paper::strands_of(lines);
  std::vector<paper::Particle<float>> particles;
  for (const paper::Strand& strand : plain)
    for (const paper::ChainParticle& p : strand.particles) particles.push_back({p.x, p.v, strand.length, false});
  paper::DenseGrid<float> dense;
  paper::Step<float> step;
  step.cell_m = s.interaction.cell_m;
  step.friction = 1 - std::exp(-s.interaction.friction_per_s / 480);
  step.repulsion_m_s = s.interaction.repulsion_m_s2 / 480;
  step.rest_density = grid.rest_density();
  double ours = 1e9, two = 1e9, theirs = 1e9;
  const auto our_step = [&] {
    step_chains(blocks, 0, blocks.count(), chain, fastest);
    grid.build(blocks, GridStep{});
    grid.apply(blocks, GridStep{});
  };
  constexpr int kSteps = 16;  // of a frame, which is looked through once
  Simulation simulation(lines, {}, s);
  for (int run = 0; run < 30; ++run) {
    tbb::task_arena(1).execute([&] { ours = std::min(ours, ms(our_step)); });
    const RigidPose still{simulation.pivot(), glm::dquat(1.0, 0.0, 0.0, 0.0)};
    two = std::min(two, ms([&] { simulation.advance(kSteps / 480.0, still); }) / kSteps);
    if (run < 5)
      theirs = std::min(theirs, ms([&] {
                          paper::step_chains(plain, 1.0F / 480, 1.0F);
                          paper::fill(particles, step, dense);
                          paper::affect(particles, step, dense);
                        }));
  }
  const auto n = static_cast<double>(particles.size());
  std::printf(
      "internal step with grid, %u x %d: straightforward %.1f ns per vertex, ours %.2f: %.1f x; two threads %.2f x\n",
      strands, vertices, 1e6 * theirs / n, 1e6 * ours / n, theirs / ours, ours / two);
}

void report(benchmark::State& state) {
  for (auto unused : state) {
    step_against_papers(3360, 16);
    step_against_papers(10000, 32);
    frames();
  }
}
BENCHMARK(report)->Iterations(1)->Unit(benchmark::kMillisecond);

}  // namespace

BENCHMARK_MAIN();
