// The density map against the paper's straightforward version (tests/shadow/paper_map.h) and against the time that the
// bytes it has to touch take. One process; ratios are what counts.
//
// Bound: with 16-bit cells in the occupied box (b of them) and p points, reset writes 2 b, fill reads 12 p and touches
// a cell per point (4 p), adding up reads and writes the cells (4 b), the filter reads 12 p of points and tangents
// each, eight cells (16 p) and writes a colour (4 p); at the bandwidth that this process measures on 4 MiB.
#include <benchmark/benchmark.h>
#include <tbb/task_arena.h>

#include <chrono>
#include <cstdio>
#include <cstring>
#include <numeric>
#include <random>

#include "../shadow/paper_map.h"
#include "pelage/shading/vertex_colours.h"
#include "pelage/shadow/density_map.h"

namespace {

using namespace pelage;
using Clock = std::chrono::steady_clock;

/// Strands from a scalp of 9 cm radius, 25 to 30 cm long, in locks; `curl_m` > 0: helices.
Strands hair_of(std::size_t strands, std::size_t points, float curl_m) {
  std::mt19937 random(11);
  std::normal_distribution<float> normal;
  std::uniform_real_distribution<float> uniform(0, 1);
  Strands s;
  s.diameter_m = 8e-5F * std::sqrt(1e5F / static_cast<float>(strands));
  glm::vec3 lock{0, 1, 0};
  for (std::size_t i = 0; i < strands; ++i) {
    if (i % 25 == 0) {
      lock = glm::normalize(glm::vec3(normal(random), std::abs(normal(random)) + 0.1F, normal(random)));
    }
    const glm::vec3 root =
        0.09F * glm::normalize(lock + 0.06F * glm::vec3(normal(random), normal(random), normal(random)));
    const glm::vec3 out = glm::normalize(root);
    const float length = 0.20F + 0.03F * uniform(random), phase = 6.28F * uniform(random);
    std::vector<glm::vec3> line;
    for (std::size_t k = 0; k < points; ++k) {
      const float t = static_cast<float>(k) / static_cast<float>(points - 1), along = t * length;
      glm::vec3 p = root + out * (0.10F * (1 - std::exp(-3.0F * t))) + glm::vec3(0, -1, 0) * (along * t);
      p += curl_m * std::min(4 * t, 1.0F) * glm::vec3(std::cos(90 * along + phase), 0, std::sin(90 * along + phase));
      line.push_back(p + 0.002F * std::sin(20 * along + phase) * glm::vec3(out.z, 0, -out.x));
    }
    s.append(line);
  }
  return s;
}

std::vector<glm::vec3> tangents_of(const Strands& s) {
  std::vector<glm::vec3> tangents;
  for (std::size_t i = 0; i < s.count(); ++i) {
    const auto p = s.strand(i);
    for (std::size_t k = 0; k < p.size(); ++k)
      tangents.push_back(glm::normalize(p[std::min(k + 1, p.size() - 1)] - p[k > 0 ? k - 1 : 0]));
  }
  return tangents;
}

/// Width of the map: 128^3 cells of 5 mm hold this hair however it moves.
constexpr float kExtent_m = 0.64F;

const Light& light() {
  static const Light l;
  return l;
}

/// Of this thread: what other programs do to a shared machine stays out.
double cpu_ms() {
  timespec t{};
  clock_gettime(CLOCK_THREAD_CPUTIME_ID, &t);
  return 1e3 * static_cast<double>(t.tv_sec) + 1e-6 * static_cast<double>(t.tv_nsec);
}

template <class Run>
double milliseconds(int repeats, Run&& run) {
  std::vector<double> all;
  for (int i = 0; i < repeats; ++i) {
    const double start = cpu_ms();
    run();
    all.push_back(cpu_ms() - start);
  }
  return *std::min_element(all.begin(), all.end());
}

/// Bytes per millisecond, read and written, on a working set of 4 MiB.
double bandwidth() {
  std::vector<std::uint32_t> a(1 << 19, 1), b(1 << 19, 2);
  const double ms = milliseconds(101, [&] {
    for (std::size_t i = 0; i < a.size(); ++i) a[i] += b[i];
    benchmark::DoNotOptimize(a.data());
  });
  return 3.0 * 4.0 * static_cast<double>(a.size()) / ms;
}

struct Whole {
  double fill = 0, accumulate = 0, filter = 0, colour = 0;
  double all() const { return fill + accumulate + filter + colour; }
};

struct Case {
  Strands strands;
  std::vector<glm::vec3> tangents;
  std::vector<float> transmittance;
  std::vector<std::uint32_t> colours;
  ColourRequest request;
  explicit Case(Strands s) : strands(std::move(s)), tangents(tangents_of(strands)) {
    transmittance.resize(strands.vertices.size());
    colours.resize(strands.vertices.size());
    request.light = light();
    request.eye = {0, 0, 1};
  }
  Whole run(DensityMap& map) {
    Whole w;
    map.build(strands, 0.6F, light());
    w.fill = map.times().fill_ms;
    w.accumulate = map.times().transmittance_ms;
    const auto a = Clock::now();
    map.transmittance(strands.vertices, transmittance);
    const auto b = Clock::now();
    vertex_colours(request, strands.vertices, tangents, transmittance, colours);
    const auto c = Clock::now();
    w.filter = std::chrono::duration<double, std::milli>(b - a).count();
    w.colour = std::chrono::duration<double, std::milli>(c - b).count();
    return w;
  }
  /// Of each stage the least of all runs: on a machine that others use, the one that says what the stage takes.
  Whole least(DensityMap& map, int repeats) {
    Whole best = run(map);
    for (int i = 0; i < repeats; ++i) {
      const Whole w = run(map);
      best = {std::min(best.fill, w.fill), std::min(best.accumulate, w.accumulate), std::min(best.filter, w.filter),
              std::min(best.colour, w.colour)};
    }
    return best;
  }
};

double straightforward(const Case& c, int resolution, float extent) {
  std::vector<paper::Vertex> vertices;
  for (std::size_t i = 0; i < c.tangents.size(); ++i) vertices.push_back({c.strands.vertices[i], c.tangents[i], 0, {}});
  const glm::mat3 axes = light_axes(light().direction);
  paper::Map naive{resolution, extent / static_cast<float>(resolution), 0.01F, axes[0], axes[1], axes[2], {}, {}};
  float first = 1e30F;
  for (const auto& v : vertices) first = std::min(first, glm::dot(v.position, axes[0]));
  const int slice = static_cast<int>(std::floor(first / naive.ds));
  const glm::vec3 to_light = glm::normalize(light().direction);
  naive.reset();
  return milliseconds(7, [&] {
    naive.reset();
    naive.fill(vertices);
    naive.transmit(slice);
    for (paper::Vertex& v : vertices) {
      v.transmittance = naive.filter(v.position, slice);
      paper::colour(v, to_light, glm::normalize(glm::vec3(0, 0, 1) - v.position), 0.15F, 1, 0.16F, 120,
                    {0.2F, 0.1F, 0.05F});
    }
    benchmark::DoNotOptimize(vertices.data());
  });
}

void row(const char* name, const Whole& w) {
  std::printf("%-34s %8.3f %8.3f %8.3f %8.3f %9.3f", name, w.fill, w.accumulate, w.filter, w.colour, w.all());
}

void report() {
  const double bytes_per_ms = bandwidth();
  std::printf("bandwidth on 4 MiB: %.1f GB/s\n%-34s %8s %8s %8s %8s %9s ms\n", bytes_per_ms / 1e6, "", "fill", "accum.",
              "filter", "colour", "sum");
  Case smooth(hair_of(3350, 30, 0)), curly(hair_of(3350, 60, 0.006F)), big(hair_of(37300, 30, 0));
  Whole hundred;

  for (const auto& [name, c] :
       {std::pair<const char*, Case*>{"smooth 100K", &smooth}, {"curly 200K", &curly}, {"1.12M", &big}}) {
    const int repeats = c == &big ? 15 : 51;
    DensityMapSettings printed = DensityMapSettings::printed();
    printed.extent_m = kExtent_m;
    DensityMap paper(printed), corrected(DensityMapSettings{});
    DensityMapSettings same;
    same.extent_m = printed.extent_m;  // the same cells as the printed one
    DensityMap corrected_same(same);
    Whole a, b, s;
    tbb::task_arena(1).execute([&] {
      a = c->least(paper, repeats);
      s = c->least(corrected_same, repeats);
      b = c->least(corrected, repeats);
    });
    const Whole a2 = c->least(paper, repeats), s2 = c->least(corrected_same, repeats);
    const double points = static_cast<double>(c->strands.vertices.size()),
                 cells = static_cast<double>(paper.bytes()) / 4;
    const double bound = (6 * cells + points * (12 + 4 + 12 + 12 + 16 + 4)) / bytes_per_ms;
    std::printf("-- %s: %.0f points, map %.2f m wide, %.2f M cells occupied, bound %.3f ms\n", name, points,
                static_cast<double>(printed.extent_m), cells / 1e6, bound);
    row("printed, 128^3, 1 thread", a);
    std::printf("  %.1fx bound\n", a.all() / bound);
    row("corrected, same cells, 1 thread", s);
    std::printf("  %.2fx printed\n", s.all() / a.all());
    row("corrected, fitted, 1 thread", b);
    std::printf("  %.2fx printed\n", b.all() / a.all());
    row("printed, 2 threads", a2);
    std::printf("  %.2fx faster\n", a.all() / a2.all());
    row("corrected, same cells, 2 threads", s2);
    std::printf("  %.2fx faster\n", s.all() / s2.all());
    if (c == &smooth) {
      hundred = a;
      const double naive = straightforward(*c, 128, printed.extent_m);
      std::printf("%-34s %44.3f  %.1fx printed\n", "straightforward", naive, naive / a.all());
    }
    if (c == &big) std::printf("1.12M / 100K: %.1fx\n", a.all() / hundred.all());
  }
}

void BM_PrintedBuild(benchmark::State& state) {
  const Strands hair = hair_of(3350, 30, 0);
  DensityMapSettings printed = DensityMapSettings::printed();
  printed.extent_m = kExtent_m;
  DensityMap map(printed);
  for (auto _ : state) map.build(hair, 0.6F, light());
}
BENCHMARK(BM_PrintedBuild)->Unit(benchmark::kMillisecond);

}  // namespace

int main(int argc, char** argv) {
  benchmark::Initialize(&argc, argv);
  report();
  benchmark::RunSpecifiedBenchmarks();
}
