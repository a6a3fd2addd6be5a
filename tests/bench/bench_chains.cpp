// Chains without grid: DFTL in blocks of lanes against the straightforward scalar version (array of structures, one
// strand after the other, as [Mueller2012] writes it), and against the bound of memory: 36 bytes of a vertex read and
// written. One core; the least of many runs of each, taken in turns.
#include <benchmark/benchmark.h>
#include <tbb/blocked_range.h>
#include <tbb/parallel_for.h>
#include <tbb/task_arena.h>

#include <chrono>
#include <cmath>
#include <cstdio>
#include <functional>
#include <glm/geometric.hpp>
#include <vector>

#include "../simulate/paper_chain.h"
#include "pelage/simulate/chain_step.h"

namespace pelage {
namespace {

Strands hanging(std::size_t strands, int vertices) {
  Strands hair;
  std::vector<glm::vec3> points;
  for (std::size_t s = 0; s < strands; ++s) {
    const float turn = 2.399963F * static_cast<float>(s),
                radius = 0.1F * std::sqrt(static_cast<float>(s) / static_cast<float>(strands));
    const glm::vec3 root(radius * std::cos(turn), 0, radius * std::sin(turn));
    points.clear();
    for (int i = 0; i < vertices; ++i) {
      const float t = 0.3F * static_cast<float>(i) / static_cast<float>(vertices - 1);
      points.push_back(root + glm::vec3(0.3F * t, -0.95F * t, 0.1F * std::cos(turn) * t));
    }
    hair.append(points);
  }
  return hair;
}

double ms(const std::function<void()>& work) {
  const auto begin = std::chrono::steady_clock::now();
  work();
  return std::chrono::duration<double, std::milli>(std::chrono::steady_clock::now() - begin).count();
}

struct Times {
  double plain = 1e9, one = 1e9, all = 1e9, triad = 1e9;
};

Times measure(std::size_t strands, int vertices) {
  const Strands hair = hanging(strands, vertices);
  std::vector<paper::Strand> plain = paper::strands_of(hair);
  StrandBlocks blocks = make_blocks(hair, glm::dvec3(0));
  std::vector<float> fastest(blocks.count());
  ChainStep step;
  // As many bytes as a step reads and writes: 9 floats of each vertex, both ways.
  std::vector<float> a(blocks.first.back() * 9UL * kLanes, 1.0F);
  Times t;
  for (int run = 0; run < 40; ++run) {
    t.plain = std::min(t.plain, ms([&] { paper::step_chains(plain, 1.0F / 480, 1.0F); }));
    for (int k = 0; k < 8; ++k) {
      t.one = std::min(t.one, ms([&] { step_chains(blocks, 0, blocks.count(), step, fastest); }));
      t.all = std::min(t.all, ms([&] {
                         tbb::parallel_for(tbb::blocked_range<std::size_t>(0, blocks.count(), 16), [&](const auto& r) {
                           step_chains(blocks, r.begin(), r.end(), step, fastest);
                         });
                       }));
      t.triad = std::min(t.triad, ms([&] {
                           for (float& x : a) x = 0.5F * x + 1.0F;
                           benchmark::DoNotOptimize(a.data());
                         }));
    }
  }
  return t;
}

void chains(benchmark::State& state) {
  for (auto unused : state) {
    const auto strands = static_cast<std::size_t>(state.range(0));
    const auto vertices = static_cast<int>(state.range(1));
    const Times t = measure(strands, vertices);
    const double n = static_cast<double>(strands) * vertices;
    state.counters["plain_ns"] = 1e6 * t.plain / n;
    state.counters["blocks_ns"] = 1e6 * t.one / n;
    state.counters["gain"] = t.plain / t.one;
    state.counters["of_memory"] = t.one / t.triad;
    state.counters["two_threads"] = t.one / t.all;
  }
}
BENCHMARK(chains)->Args({3360, 16})->Args({10000, 32})->Iterations(1)->Unit(benchmark::kMillisecond);

}  // namespace
}  // namespace pelage

BENCHMARK_MAIN();
