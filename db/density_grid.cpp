#include "pelage/db/density_grid.h"

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <cstdint>
#include <string>

#include "pelage/data_schema/errors.h"

namespace pelage {
namespace {

constexpr int kMaxSize = 128;
constexpr double kSupportSigmas = 6.5;
constexpr double kMinSigmaCells = 0.6;

constexpr std::array<double, 14> kReciprocal = [] {
  std::array<double, 14> r{};
  for (int n = 1; n < 14; ++n) r[static_cast<std::size_t>(n)] = 1.0 / n;
  return r;
}();

/// exp(-x), x >= 0, to 1e-15; its own so that records are the same bits on every CPU (data_schema/numeric.h).
/// Cody-Waite reduction to |y| <= ln2 / 2, Taylor polynomial of degree 13 (remainder 4e-18).
double exp_neg(double x) {
  if (x > 700) return 0;  // below it 2^k stays a normal number
  const double k = std::floor(x * 1.4426950408889634 + 0.5);
  const double y = (k * 6.93147180369123816490e-01 - x) + k * 1.90821492927058770002e-10;
  double p = 1;
  for (int n = 13; n >= 1; --n) p = 1 + p * y * kReciprocal[static_cast<std::size_t>(n)];
  return p * std::bit_cast<double>(static_cast<std::uint64_t>(1023 - static_cast<std::int64_t>(k)) << 52);
}

/// Samples of a unit-mass Gaussian at the cell centres [first, last) that it reaches.
struct Profile {
  int first = 0, last = 0;
  std::array<double, kMaxSize> values;

  double sum() const {
    double total = 0;
    for (int i = first; i < last; ++i) total += values[static_cast<std::size_t>(i)];
    return total;
  }
};

/// Walks outwards from the cell nearest to the centre: each cell costs two products instead of an exponential, and the
/// rounding grows with the square of the distance in cells (< 1e-13 at 64).
class GaussianSampler {
 public:
  GaussianSampler(int size, double sigma)
      : size_(size),
        cell_(1.0 / size),
        sigma_(std::max(sigma, kMinSigmaCells / size)),
        peak_(1 / (sigma_ * 2.5066282746310002)),
        curvature_(exp_neg(cell_ * cell_ / (sigma_ * sigma_))) {
    PELAGE_ASSERT(size >= 2 && size <= kMaxSize && sigma > 0);
  }

  void sample(double centre, Profile& out) const {
    PELAGE_ASSERT(std::isfinite(centre));
    out.first = out.last = 0;
    const double reach = kSupportSigmas * sigma_;
    if (!(centre > -reach && centre < 1 + reach)) return;
    out.first = std::max(0, static_cast<int>(std::ceil((centre - reach) * size_ - 0.5)));
    out.last = std::min(size_, static_cast<int>(std::floor((centre + reach) * size_ - 0.5)) + 1);
    if (out.first >= out.last) return;
    const int nearest = std::clamp(static_cast<int>(std::floor(centre * size_)), out.first, out.last - 1);
    const double x = (nearest + 0.5) * cell_ - centre;
    const double half_inv_var = 0.5 / (sigma_ * sigma_);
    const double middle = peak_ * exp_neg(x * x * half_inv_var);
    out.values[static_cast<std::size_t>(nearest)] = middle;
    // Ratio to the next cell up; down it is curvature / up. Its exponent stays below 6.5 cell / sigma < 11.
    const double exponent = (cell_ + 2 * x) * cell_ * half_inv_var;
    const double up = exponent >= 0 ? exp_neg(exponent) : 1 / exp_neg(-exponent);
    walk(out, nearest, 1, middle, up);
    walk(out, nearest, -1, middle, curvature_ / up);
  }

 private:
  void walk(Profile& out, int from, int step, double value, double ratio) const {
    for (int i = from + step; i >= out.first && i < out.last; i += step) {
      value *= ratio;
      ratio *= curvature_;
      out.values[static_cast<std::size_t>(i)] = value;
    }
  }

  int size_;
  double cell_, sigma_, peak_, curvature_;
};

/// Weights of a tent filter from `from` cells to cell i of `to`: [from], sum 1.
std::vector<double> tent_weights(int from, int to, int i) {
  const double scale = static_cast<double>(from) / to;
  const double width = std::max(1.0, scale);
  const double centre = (i + 0.5) * scale - 0.5;
  std::vector<double> weights(static_cast<std::size_t>(from));
  double total = 0;
  for (int k = 0; k < from; ++k) {
    // Beyond the border the field continues as its outermost cell: centre is kept inside.
    const double distance = std::abs(k - std::clamp(centre, 0.0, from - 1.0));
    total += weights[static_cast<std::size_t>(k)] = std::max(0.0, 1 - distance / width);
  }
  for (double& w : weights) w /= total;
  return weights;
}

void check_field(std::span<const double> field, int rows, int columns) {
  if (rows < 1 || columns < 1 || field.size() != static_cast<std::size_t>(rows) * static_cast<std::size_t>(columns))
    throw InputError("density field", std::to_string(rows) + " x " + std::to_string(columns) + " cells but " +
                                          std::to_string(field.size()) + " values: give one value per cell");
  for (std::size_t i = 0; i < field.size(); ++i)
    if (!(std::isfinite(field[i]) && field[i] >= 0))
      throw InputError("density field", "value " + std::to_string(field[i]) + " at index " + std::to_string(i) +
                                            ": densities are finite and not negative");
}

}  // namespace

void fill_density_grid(SectorCrossings crossings, int size, double sigma, DensityGrid& grid) {
  const auto n = static_cast<std::size_t>(size);
  grid.size = size;
  grid.values.assign(n * n, 0.0);
  const GaussianSampler gaussian(size, sigma);
  Profile s, r;
  for (const glm::vec2& p : crossings) {
    gaussian.sample(static_cast<double>(p.x), s);
    gaussian.sample(static_cast<double>(p.y), r);
    for (int j = r.first; j < r.last; ++j) {
      double* row = grid.values.data() + static_cast<std::size_t>(j) * n;
      const double weight = r.values[static_cast<std::size_t>(j)];
      for (int i = s.first; i < s.last; ++i) row[i] += weight * s.values[static_cast<std::size_t>(i)];
    }
  }
}

DensityGrid density_grid(SectorCrossings crossings, int size, double sigma) {
  DensityGrid grid;
  fill_density_grid(crossings, size, sigma, grid);
  return grid;
}

DensityGrid density_grid(std::span<const double> field, int rows, int columns, int size) {
  check_field(field, rows, columns);
  DensityGrid grid{size, {}};
  grid.values.reserve(static_cast<std::size_t>(size) * static_cast<std::size_t>(size));
  for (int r = 0; r < size; ++r) {
    const std::vector<double> row_weights = tent_weights(rows, size, r);
    for (int s = 0; s < size; ++s) {
      const std::vector<double> column_weights = tent_weights(columns, size, s);
      double value = 0;
      for (std::size_t j = 0; j < row_weights.size(); ++j)
        for (std::size_t i = 0; row_weights[j] > 0 && i < column_weights.size(); ++i)
          value += row_weights[j] * column_weights[i] * field[j * column_weights.size() + i];
      grid.values.push_back(value);
    }
  }
  return grid;
}

Projections projections(const DensityGrid& grid) {
  const auto n = static_cast<std::size_t>(grid.size);
  Projections p{std::vector<double>(n), std::vector<double>(n)};
  for (std::size_t r = 0; r < n; ++r)
    for (std::size_t s = 0; s < n; ++s) {
      p.along_s[s] += grid.values[r * n + s] / static_cast<double>(n);
      p.along_r[r] += grid.values[r * n + s] / static_cast<double>(n);
    }
  return p;
}

Projections projections(SectorCrossings crossings, int size, double sigma) {
  const auto n = static_cast<std::size_t>(size);
  Projections p{std::vector<double>(n), std::vector<double>(n)};
  const GaussianSampler gaussian(size, sigma);
  Profile s, r;
  for (const glm::vec2& crossing : crossings) {
    gaussian.sample(static_cast<double>(crossing.x), s);
    gaussian.sample(static_cast<double>(crossing.y), r);
    const double mean_s = s.sum() / size;
    const double mean_r = r.sum() / size;
    for (int i = s.first; i < s.last; ++i)
      p.along_s[static_cast<std::size_t>(i)] += mean_r * s.values[static_cast<std::size_t>(i)];
    for (int i = r.first; i < r.last; ++i)
      p.along_r[static_cast<std::size_t>(i)] += mean_s * r.values[static_cast<std::size_t>(i)];
  }
  return p;
}

}  // namespace pelage
