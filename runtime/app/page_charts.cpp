#include "pelage/app/page_charts.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <map>
#include <vector>

#include "pelage/app/page_text.h"

namespace pelage::app {
namespace {

constexpr std::size_t kStageColours = 8;  // of compare.css: s0 .. s7; what is left shares the last

// Names of all stages, those that take longest first.
std::vector<std::string> stage_order(const Comparison& comparison) {
  std::map<std::string, double> share;
  for (const ComparedMethod& m : comparison.methods) {
    for (const Stage& s : m.stages) {
      if (m.first_ms > 0 && std::isfinite(s.milliseconds)) share[s.name] += s.milliseconds / m.first_ms;
    }
  }
  std::vector<std::string> names;
  for (const auto& [name, sum] : share) names.push_back(name);
  std::stable_sort(names.begin(), names.end(),
                   [&](const std::string& a, const std::string& b) { return share[a] > share[b]; });
  return names;
}

std::size_t colour_of(const std::vector<std::string>& order, const std::string& stage) {
  const auto at = static_cast<std::size_t>(std::find(order.begin(), order.end(), stage) - order.begin());
  return std::min(at, kStageColours - 1);
}

// Where the bars' axis ends: a method that takes far longer than most (the truth) is cut, so that the others show.
double axis_end(const Comparison& comparison) {
  std::vector<double> times;
  for (const ComparedMethod& m : comparison.methods) {
    if (m.failed.empty() && std::isfinite(m.first_ms)) times.push_back(m.first_ms);
  }
  if (times.empty()) return 1;
  std::sort(times.begin(), times.end());
  const double limit = 4 * times[(times.size() - 1) / 2];
  const double end = *std::find_if(times.rbegin(), times.rend(), [&](double t) { return t <= limit; });
  return end > 0 ? end : 1;
}

std::string bar_parts(const ComparedMethod& method, const std::vector<std::string>& order, double end) {
  std::vector<Stage> stages = method.stages;
  std::stable_sort(stages.begin(), stages.end(), [&](const Stage& a, const Stage& b) {
    return std::find(order.begin(), order.end(), a.name) < std::find(order.begin(), order.end(), b.name);
  });
  std::string parts;
  double before = 0;
  for (const Stage& s : stages) {
    const double width = std::isfinite(s.milliseconds) ? std::min(s.milliseconds, end - before) : 0;
    if (!(width > 0)) continue;
    parts += fmt::format(R"(<span class="s{}" style="width:{:.3f}%" title="{} {} ms"></span>)",
                         colour_of(order, s.name), 100 * width / end, html(s.name), milliseconds(s.milliseconds));
    before += width;
  }
  return parts;
}

std::string in_words(const ComparedMethod& method) {
  std::string words;
  for (const Stage& s : method.stages) words += fmt::format("; {} {} ms", html(s.name), milliseconds(s.milliseconds));
  return words;
}

std::string bar_row(const ComparedMethod& m, const std::vector<std::string>& order, double end) {
  if (!m.failed.empty()) return {};
  const bool cut = m.first_ms > 1.0001 * end;
  const double again = std::isfinite(m.again_ms) ? std::clamp(m.again_ms / end, 0.0, 1.0) : 0;
  return fmt::format(
      R"(<div class="bar-row"><div class="bar-name">{}</div><div class="bar-track"><div class="bar{}">{}</div>)"
      R"(<div class="bar-again" style="width:{:.3f}%"></div></div><div class="bar-ms">{} ms<span class="again">, )"
      R"(again {}</span><span class="unseen">{}</span></div></div>)"
      "\n",
      html(m.title), cut ? " cut" : "", bar_parts(m, order, end), 100 * again, milliseconds(m.first_ms),
      milliseconds(m.again_ms), in_words(m));
}

std::string bar_legend(const std::vector<std::string>& order) {
  std::string items;
  for (std::size_t i = 0; i < std::min(order.size(), kStageColours); ++i) {
    const bool rest = i + 1 == kStageColours && order.size() > kStageColours;
    items += fmt::format(R"(<li><span class="swatch s{}"></span>{}</li>)", i, rest ? "other stages" : html(order[i]));
  }
  return R"(<ul class="legend">)" + items +
         R"(<li><span class="swatch swatch-again"></span>again, camera moved a little</li></ul>)";
}

// --- curves -----------------------------------------------------------------------------------------------------

struct Chart {
  const char* title;
  const char* unit;
  double (*value)(const ComparedFrame&);
};

constexpr double kWidth = 960, kHeight = 260, kLeft = 56, kRight = 210, kTop = 12, kBottom = 34;

// Multiples of 1, 2 or 5 x 10^n, at most six of them up to `top`.
double tick_step(double top) {
  const double unit = std::pow(10.0, std::floor(std::log10(top / 6)));
  for (const double m : {1.0, 2.0, 5.0, 10.0}) {
    if (m * unit >= top / 6) return m * unit;
  }
  return unit;
}

struct Curve {
  std::string title;
  std::size_t colour = 0;
  std::vector<double> y;
  double label_y = 0;
};

std::vector<Curve> curves_of(const Comparison& comparison, const Chart& chart) {
  std::vector<Curve> curves;
  std::size_t colour = 0;
  for (std::size_t i = 1; i < comparison.methods.size(); ++i) {
    const ComparedMethod& m = comparison.methods[i];
    if (!m.failed.empty() || m.frames.empty()) continue;
    Curve c{m.title, colour++, {}, 0};
    for (const ComparedFrame& f : m.frames) c.y.push_back(chart.value(f));
    curves.push_back(std::move(c));
  }
  return curves;
}

double greatest(const std::vector<Curve>& curves) {
  double top = 0;
  for (const Curve& c : curves) {
    for (const double y : c.y) top = std::isfinite(y) ? std::max(top, y) : top;
  }
  return top > 0 ? top : 1;
}

// Labels at the curves' ends, moved apart where they would cover each other.
void place_labels(std::vector<Curve>& curves, double top) {
  const double plot = kHeight - kTop - kBottom;
  constexpr double kLine = 15;
  std::vector<Curve*> order;
  for (Curve& c : curves) {
    const double last = std::isfinite(c.y.back()) ? c.y.back() : 0;
    c.label_y = kTop + plot * (1 - last / top);
    order.push_back(&c);
  }
  std::sort(order.begin(), order.end(), [](const Curve* a, const Curve* b) { return a->label_y < b->label_y; });
  double lowest = kTop;
  for (Curve* c : order) lowest = (c->label_y = std::max(c->label_y, lowest)) + kLine;
  double highest = kHeight - 4;
  for (auto c = order.rbegin(); c != order.rend(); ++c) {
    (*c)->label_y = std::min((*c)->label_y, highest);
    highest = (*c)->label_y - kLine;
  }
}

std::string path_of(const Curve& curve, double top) {
  const double step = (kWidth - kLeft - kRight) / static_cast<double>(std::max<std::size_t>(curve.y.size() - 1, 1));
  std::string path;
  bool pen = false;
  for (std::size_t i = 0; i < curve.y.size(); ++i) {
    const bool shown = std::isfinite(curve.y[i]);
    if (shown) {
      path += fmt::format("{}{:.1f} {:.1f}", pen ? "L" : "M", kLeft + step * static_cast<double>(i),
                          kTop + (kHeight - kTop - kBottom) * (1 - curve.y[i] / top));
    }
    pen = shown;
  }
  return path;
}

std::string axes(double top, std::size_t frames, double fps) {
  std::string svg;
  const double step = tick_step(top);
  const int decimals = std::max(0, -static_cast<int>(std::floor(std::log10(step) + 1e-9)));
  for (int i = 0; i * step <= top * 1.0001; ++i) {
    const double y = kTop + (kHeight - kTop - kBottom) * (1 - i * step / top);
    svg += fmt::format(R"(<path class="grid" d="M{} {:.1f}H{}"/><text x="{}" y="{:.1f}" class="end">{}</text>)", kLeft,
                       y, kWidth - kRight, kLeft - 8, y + 4, number(i * step, decimals));
  }
  const double last = static_cast<double>(frames) - 1;
  const double x_step = std::max(1.0, std::ceil(tick_step(std::max(last, 1.0))));
  for (double x = 0; x <= last; x += x_step) {
    svg +=
        fmt::format(R"(<text x="{:.1f}" y="{}" class="mid">{}</text>)",
                    kLeft + (kWidth - kLeft - kRight) * x / std::max(last, 1.0), kHeight - kBottom + 18, number(x, 0));
  }
  return svg + fmt::format(R"(<text x="{}" y="{}" class="mid">frame{}</text>)", (kLeft + kWidth - kRight) / 2,
                           kHeight - 2, fps > 0 ? fmt::format(" (of {} in a second)", number(fps, 0)) : "");
}

std::string chart_svg(const Comparison& comparison, const Chart& chart) {
  std::vector<Curve> curves = curves_of(comparison, chart);
  if (curves.empty()) return {};
  const double top = 1.05 * greatest(curves);
  place_labels(curves, top);
  std::size_t frames = 0;
  for (const Curve& c : curves) frames = std::max(frames, c.y.size());
  std::string svg = axes(top, frames, comparison.fps);
  for (const Curve& c : curves) {
    const std::string dash = c.colour % 12 < 6 ? "" : " dashed";
    svg += fmt::format(R"(<g class="c{}{}"><path class="curve" d="{}"/><text x="{}" y="{:.1f}">{}</text></g>)",
                       c.colour % 6, dash, path_of(c, top), kWidth - kRight + 8, c.label_y + 4, html(c.title));
  }
  return fmt::format(
      R"(<figure class="chart"><figcaption><b>{}</b> {}</figcaption><svg viewBox="0 0 {} {}" role="img" aria-label="{})"
      R"( of every frame, a curve for each method">{}</svg></figure>)"
      "\n",
      chart.title, chart.unit, kWidth, kHeight, chart.title, svg);
}

}  // namespace

std::string stage_bars(const Comparison& comparison) {
  const std::vector<std::string> order = stage_order(comparison);
  const double end = axis_end(comparison);
  std::string rows;
  for (const ComparedMethod& m : comparison.methods) rows += bar_row(m, order, end);
  return bar_legend(order) + "\n<div class=\"bars\">\n" + rows + "</div>\n";
}

std::string frame_curves(const Comparison& comparison) {
  constexpr Chart kCharts[] = {{"FLIP", "mean over the picture", [](const ComparedFrame& f) { return f.error.flip; }},
                               {"RMSE", "linear RGB", [](const ComparedFrame& f) { return f.error.rmse; }},
                               {"Flicker", "RMSE of what changes from frame to frame, none in the first",
                                [](const ComparedFrame& f) { return f.flicker; }}};
  std::string charts;
  for (const Chart& chart : kCharts) charts += chart_svg(comparison, chart);
  return charts;
}

}  // namespace pelage::app
