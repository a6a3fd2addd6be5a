#include "pelage/tradeoff/front.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <map>
#include <numeric>
#include <string>

namespace pelage {
namespace {

/// Below so many error bars an error says more of the truth's noise than of the point.
constexpr double kClear = 3;

struct Line {
  double slope = 0, standard_error = 0;
};

/// y = a + slope x by least squares. @param x, y  at least two, not all x equal
Line fit_line(const std::vector<double>& x, const std::vector<double>& y) {
  const auto n = static_cast<double>(x.size());
  const double mean_x = std::accumulate(x.begin(), x.end(), 0.0) / n;
  const double mean_y = std::accumulate(y.begin(), y.end(), 0.0) / n;
  double xx = 0, xy = 0, residual = 0;
  for (std::size_t i = 0; i < x.size(); ++i) {
    xx += (x[i] - mean_x) * (x[i] - mean_x);
    xy += (x[i] - mean_x) * (y[i] - mean_y);
  }
  Line line{xy / xx, std::numeric_limits<double>::quiet_NaN()};
  for (std::size_t i = 0; i < x.size(); ++i) {
    const double r = y[i] - mean_y - line.slope * (x[i] - mean_x);
    residual += r * r;
  }
  if (x.size() > 2) line.standard_error = std::sqrt(residual / (n - 2) / xx);
  return line;
}

/// No line through points that do not differ, or whose errors are noise.
void fit(const Curve& curve, std::span<const TradeoffRow> rows, const std::string& against,
         double (*place)(const TradeoffRow&), std::vector<Slope>& slopes) {
  std::vector<double> x, y;
  for (const TradeoffRow& row : rows) {
    const double at = place(row);
    if (row.knob != curve.knob || !row.failed.empty() || !std::isfinite(row.amount)) continue;
    if (!(at > 0 && std::isfinite(at) && row.error > kClear * row.error_bar && std::isfinite(row.error))) continue;
    x.push_back(std::log(at));
    y.push_back(std::log(row.error));
  }
  if (x.size() < 2) return;
  const auto [least, most] = std::minmax_element(x.begin(), x.end());
  if (*most - *least < 1e-6) return;
  const Line line = fit_line(x, y);
  slopes.push_back({curve.knob, against, line.slope, line.standard_error, static_cast<int>(x.size())});
}

double amount_of(const TradeoffRow& row) {
  return row.amount;
}
double time_of(const TradeoffRow& row) {
  return row.time.median_ms;
}

}  // namespace

void mark_front(std::vector<TradeoffRow>& rows) {
  std::vector<std::size_t> order;
  for (std::size_t i = 0; i < rows.size(); ++i) {
    rows[i].on_front = false;
    rows[i].dominated_by.clear();
    if (rows[i].failed.empty()) order.push_back(i);
  }
  // Fastest first; of equally fast ones the most accurate.
  std::stable_sort(order.begin(), order.end(), [&](std::size_t a, std::size_t b) {
    const TradeoffRow &p = rows[a], &q = rows[b];
    return p.time.median_ms != q.time.median_ms ? p.time.median_ms < q.time.median_ms : p.error < q.error;
  });
  std::size_t best = rows.size();
  for (const std::size_t i : order) {
    if (best == rows.size() || rows[i].error < rows[best].error) {
      rows[i].on_front = true;
      best = i;
    } else {
      rows[i].dominated_by = rows[best].id;
    }
  }
}

std::vector<Slope> fit_slopes(std::span<const Curve> curves, std::span<const TradeoffRow> rows) {
  std::vector<Slope> slopes;
  for (const Curve& curve : curves) {
    fit(curve, rows, curve.unit.empty() ? "amount" : curve.unit, amount_of, slopes);
    fit(curve, rows, "ms", time_of, slopes);
  }
  return slopes;
}

}  // namespace pelage
