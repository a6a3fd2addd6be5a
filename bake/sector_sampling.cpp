#include "pelage/bake/sector_sampling.h"

#include <Random123/philox.h>
#include <tbb/parallel_for.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <numbers>

#include "pelage/data_schema/errors.h"
#include "pelage/data_schema/sector.h"

namespace pelage {
namespace {

/// Counter-based random numbers: the n-th number depends on (seed, stream, n) only.
class Random {
 public:
  Random(std::uint64_t seed, std::uint64_t stream)
      : key_{{static_cast<std::uint32_t>(seed), static_cast<std::uint32_t>(seed >> 32)}},
        counter_{{static_cast<std::uint32_t>(stream), static_cast<std::uint32_t>(stream >> 32), 0, 0}} {}

  /// Uniform in [0, 1), 32 bits.
  double uniform() {
    if (used_ == 4) {
      block_ = r123::Philox4x32()(counter_, key_);
      ++counter_[2];
      used_ = 0;
    }
    return block_[used_++] * 0x1p-32;
  }
  double uniform(double low, double high) { return low + (high - low) * uniform(); }
  /// Standard normal by Box-Muller.
  double normal() {
    const double radius = std::sqrt(-2 * std::log(1 - uniform()));
    return radius * std::cos(2 * std::numbers::pi * uniform());
  }

 private:
  r123::Philox4x32::key_type key_;
  r123::Philox4x32::ctr_type counter_, block_{};
  unsigned used_ = 4;
};

enum class Arrangement { uniform, clumped, layered };

struct Plan {
  Arrangement arrangement = Arrangement::uniform;
  std::vector<glm::dvec2> clumps;  // centres
  double spread = 0;               // standard deviation
  double band = 0;                 // mean r
};

Plan draw_plan(Random& random) {
  Plan plan;
  plan.arrangement = static_cast<Arrangement>(static_cast<int>(3 * random.uniform()));
  plan.spread = random.uniform(0.05, 0.2);
  plan.band = random.uniform();
  const int clumps = 1 + static_cast<int>(4 * random.uniform());
  for (int i = 0; i < clumps; ++i) {
    const double s = random.uniform();
    plan.clumps.emplace_back(s, random.uniform());
  }
  return plan;
}

/// Into [0, 1) by reflection at its ends: a strand drawn beyond the border stays near it.
double reflect(double x) {
  const double folded = std::abs(x - 2 * std::floor((x + 1) / 2));
  return std::min(folded, 1 - 0x1p-24);
}

glm::dvec2 draw_inside(const Plan& plan, Random& random) {
  if (plan.arrangement == Arrangement::uniform) {
    const double s = random.uniform();
    return {s, random.uniform()};
  }
  if (plan.arrangement == Arrangement::layered) {
    const double s = random.uniform();
    return {s, reflect(plan.band + plan.spread * random.normal())};
  }
  const auto clump = static_cast<std::size_t>(random.uniform() * static_cast<double>(plan.clumps.size()));
  const double s = plan.clumps[clump].x + plan.spread * random.normal();
  return {s - std::floor(s), reflect(plan.clumps[clump].y + plan.spread * random.normal())};
}

/// Lists a strand and its copies of the torus that reach in.
void add(glm::dvec2 p, std::vector<glm::vec2>& out) {
  const double margin = static_cast<double>(kSectorMargin);
  for (const int turn : {0, 1, -1}) {
    const double s = p.x + turn;
    if (s >= -margin && s <= 1 + margin) out.emplace_back(s, p.y);
  }
}

constexpr std::size_t kMaxRows = 32768;
constexpr int kLloydSteps = 4;

/// Rows in [dimension][row] order, so that distances to one centre vectorise over rows.
struct Rows {
  std::size_t count = 0;
  std::size_t dimension = 0;
  std::vector<std::uint32_t> index;  // [row] into the input
  std::vector<float> values;

  float at(std::size_t row, std::size_t d) const { return values[d * count + row]; }
};

Rows pick_rows(std::span<const float> features, std::size_t dimension) {
  Rows rows;
  const std::size_t n = features.size() / dimension;
  rows.count = std::min(n, kMaxRows);
  rows.dimension = dimension;
  rows.values.resize(rows.count * dimension);
  for (std::size_t i = 0; i < rows.count; ++i) {
    const std::size_t from = i * n / rows.count;
    rows.index.push_back(static_cast<std::uint32_t>(from));
    for (std::size_t d = 0; d < dimension; ++d) rows.values[d * rows.count + i] = features[from * dimension + d];
  }
  return rows;
}

struct Nearest {
  std::vector<float> distance_sq;     // [row] to the nearest centre so far
  std::vector<std::uint32_t> centre;  // [row]
};

constexpr std::size_t kBlock = 512;

/// Tells rows [first, last) about one more centre.
__attribute__((noinline)) void visit(const Rows& rows, const float* centre, std::uint32_t id, std::size_t first,
                                     std::size_t last, Nearest& nearest) {
  std::array<float, kBlock> sum{};
  for (std::size_t d = 0; d < rows.dimension; ++d) {
    const float* column = rows.values.data() + d * rows.count + first;
    for (std::size_t i = 0; i < last - first; ++i) {
      const float x = column[i] - centre[d];
      sum[i] += x * x;
    }
  }
  float* best = nearest.distance_sq.data() + first;
  std::uint32_t* owner = nearest.centre.data() + first;
  for (std::size_t i = 0; i < last - first; ++i) {
    owner[i] = sum[i] < best[i] ? id : owner[i];
    best[i] = std::min(best[i], sum[i]);
  }
}

/// Nearest of the centres [first, last), on top of what is known; rows in parallel.
void assign(const Rows& rows, const std::vector<float>& centres, std::size_t first, std::size_t last,
            Nearest& nearest) {
  const std::size_t blocks = (rows.count + kBlock - 1) / kBlock;
  tbb::parallel_for(std::size_t{0}, blocks, [&](std::size_t b) {
    for (std::size_t c = first; c < last; ++c)
      visit(rows, centres.data() + c * rows.dimension, static_cast<std::uint32_t>(c), b * kBlock,
            std::min(rows.count, (b + 1) * kBlock), nearest);
  });
}

Nearest unknown(const Rows& rows) {
  return {std::vector<float>(rows.count, std::numeric_limits<float>::max()), std::vector<std::uint32_t>(rows.count)};
}

/// Row drawn with probability proportional to its squared distance; rows.count when all distances are 0.
std::size_t draw_far(const Nearest& nearest, Random& random) {
  double total = 0;
  for (const float d : nearest.distance_sq) total += static_cast<double>(d);
  if (total <= 0) return nearest.distance_sq.size();
  double left = random.uniform() * total;
  std::size_t last = 0;
  for (std::size_t i = 0; i < nearest.distance_sq.size(); ++i) {
    if (nearest.distance_sq[i] <= 0) continue;
    last = i;
    left -= static_cast<double>(nearest.distance_sq[i]);
    if (left < 0) break;
  }
  return last;
}

/// k-means++ [Arthur2007]: each centre is a row drawn by its squared distance to the centres before it.
std::vector<float> seed_centres(const Rows& rows, std::size_t count, Random& random) {
  std::vector<float> centres;
  Nearest nearest = unknown(rows);
  auto row = static_cast<std::size_t>(random.uniform() * static_cast<double>(rows.count));
  for (std::size_t c = 0; c < count && row < rows.count; ++c) {
    for (std::size_t d = 0; d < rows.dimension; ++d) centres.push_back(rows.at(row, d));
    assign(rows, centres, c, c + 1, nearest);
    row = draw_far(nearest, random);
  }
  return centres;
}

/// Moves every centre to the mean of its rows; serial, so that sums have one order.
void move_centres(const Rows& rows, const Nearest& nearest, std::vector<float>& centres) {
  std::vector<double> sum(centres.size());
  std::vector<std::uint32_t> members(centres.size() / rows.dimension);
  for (std::size_t i = 0; i < rows.count; ++i) ++members[nearest.centre[i]];
  for (std::size_t d = 0; d < rows.dimension; ++d)
    for (std::size_t i = 0; i < rows.count; ++i)
      sum[nearest.centre[i] * rows.dimension + d] += static_cast<double>(rows.at(i, d));
  for (std::size_t j = 0; j < centres.size(); ++j)
    if (const auto n = members[j / rows.dimension]; n > 0) centres[j] = static_cast<float>(sum[j] / n);
}

}  // namespace

std::vector<glm::vec2> random_sector(const BakeSettings& settings, std::uint64_t index) {
  Random random(settings.seed, index);
  const int inside = static_cast<int>(std::exp(random.uniform() * std::log(settings.max_strands + 1)));
  const Plan plan = draw_plan(random);
  const double margin = static_cast<double>(kSectorMargin);
  std::vector<glm::vec2> out;
  for (int i = 0; i < inside; ++i) {
    const glm::dvec2 p = draw_inside(plan, random);
    add(p, out);
    if (random.uniform() >= 2 * margin) continue;
    // A strand of the neighbouring layer, beyond one of the two borders.
    const double beyond = random.uniform(-margin, margin);
    add({draw_inside(plan, random).x, beyond < 0 ? beyond : 1 + beyond}, out);
  }
  return out;
}

std::vector<std::uint32_t> representatives(std::span<const float> scaled_features, int dimension, int count,
                                           std::uint64_t seed) {
  const auto width = static_cast<std::size_t>(dimension);
  PELAGE_ASSERT(width > 0 && count > 0 && scaled_features.size() % width == 0);
  if (scaled_features.empty()) return {};
  const Rows rows = pick_rows(scaled_features, width);
  Random random(seed, 0x5e1ec7);
  std::vector<float> centres = seed_centres(rows, static_cast<std::size_t>(count), random);
  const std::size_t found = centres.size() / width;
  Nearest nearest = unknown(rows);
  assign(rows, centres, 0, found, nearest);
  for (int step = 0; step < kLloydSteps; ++step) {
    move_centres(rows, nearest, centres);
    nearest = unknown(rows);
    assign(rows, centres, 0, found, nearest);
  }
  std::vector<std::size_t> best(found, rows.count);
  for (std::size_t i = 0; i < rows.count; ++i) {
    std::size_t& member = best[nearest.centre[i]];
    if (member == rows.count || nearest.distance_sq[i] < nearest.distance_sq[member]) member = i;
  }
  std::vector<std::uint32_t> chosen;
  for (const std::size_t i : best)
    if (i < rows.count) chosen.push_back(rows.index[i]);
  std::sort(chosen.begin(), chosen.end());
  return chosen;
}

}  // namespace pelage
