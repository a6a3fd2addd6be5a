// Drawn here and not by a library: every point must be an element with an address in a page that reads without a
// script. gnuplot would be needed wherever the program runs, and a JavaScript library draws nothing without a script.
#include "pelage/app/tradeoff_charts.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <map>
#include <numbers>
#include <optional>
#include <utility>

#include "pelage/app/page_text.h"

namespace pelage::app {
namespace {

constexpr double kWidth = 780, kHeight = 500, kLeft = 74, kRight = 14, kTop = 12, kBottom = 52;
constexpr std::size_t kColours = 7, kShapes = 8;  // of tradeoff.css: k0 .. k6; 56 pairs before one comes again

// --- axes ----------------------------------------------------------------------------------------------------------

struct Axis {
  const char* id;
  const char* button;
  const char* title;
  const char* unit;
  double (*value)(const TradeoffRow&);
};

double mib(std::uint64_t bytes) {
  return static_cast<double>(bytes) / (1024.0 * 1024.0);
}

constexpr std::array<Axis, 3> kAxes{
    {{"ms", "Time", "time, median [ms]", "ms", [](const TradeoffRow& r) { return r.time.median_ms; }},
     {"bytes", "Memory", "memory [MiB]", "MiB", [](const TradeoffRow& r) { return mib(r.bytes); }},
     {"prepare", "Preparation", "preparation, once [ms]", "ms", [](const TradeoffRow& r) { return r.prepare_ms; }}}};

bool has_logarithm(double value) {
  return std::isfinite(value) && value > 0;
}

/// Decimal logarithms from low to high, along pixels.
struct Scale {
  double low = 0, high = 1, from = 0, to = 1;

  [[nodiscard]] double at_log(double x) const { return from + (to - from) * (x - low) / (high - low); }
  [[nodiscard]] double at(double value) const { return at_log(std::log10(value)); }
  [[nodiscard]] bool holds(double value) const {
    return has_logarithm(value) && std::log10(value) >= low && std::log10(value) <= high;
  }
  /// Of the part of a bar that is on the axis: values of 0 and below lie left of every axis.
  [[nodiscard]] double clipped(double value) const {
    if (!(value > 0)) return from;
    return at_log(std::clamp(std::log10(value), low, high));
  }
};

// Outwards to 1, 2 or 5 x 10^n; to powers of ten where there are many.
double outwards(double logarithm, bool up, bool coarse) {
  const double whole = std::floor(logarithm);
  if (coarse) return up ? std::ceil(logarithm) : whole;
  const std::array<double, 4> steps{0, std::log10(2.0), std::log10(5.0), 1};
  if (up) return whole + *std::find_if(steps.begin(), steps.end(), [&](double s) { return whole + s >= logarithm; });
  return whole + *std::find_if(steps.rbegin(), steps.rend(), [&](double s) { return whole + s <= logarithm; });
}

Scale scale_of(const std::vector<double>& values, double from, double to) {
  const auto [least, greatest] = std::minmax_element(values.begin(), values.end());
  constexpr double kMargin = 0.12;  // decades beyond the outermost points
  const double low = std::log10(*least) - kMargin, high = std::log10(*greatest) + kMargin;
  const bool coarse = high - low > 6;
  return {outwards(low, false, coarse), outwards(high, true, coarse), from, to};
}

struct Tick {
  double logarithm;
  int digit, exponent;
  bool labelled;
};

std::vector<Tick> ticks_of(const Scale& scale) {
  constexpr double kRounding = 1e-9;
  const double decades = scale.high - scale.low;
  const int step = std::max(1, static_cast<int>(std::ceil(decades / 8)));
  std::vector<Tick> ticks;
  for (int e = static_cast<int>(std::floor(scale.low + kRounding)); e <= scale.high + kRounding; ++e) {
    for (int digit = 1; digit <= (decades > 8 ? 1 : 9); ++digit) {
      const double at = e + std::log10(static_cast<double>(digit));
      if (at < scale.low - kRounding || at > scale.high + kRounding) continue;
      const bool between = (digit == 2 || digit == 5) && decades < 3.2;
      ticks.push_back({at, digit, e, (digit == 1 && e % step == 0) || between});
    }
  }
  return ticks;
}

// 0.01 and 200, or with powers of ten where the axis leaves that range.
std::string tick_label(const Tick& tick, const Scale& scale) {
  if (scale.low >= -4.01 && scale.high <= 5.01) {
    return fmt::format("{:.{}f}", tick.digit * std::pow(10.0, tick.exponent), std::max(0, -tick.exponent));
  }
  const std::string factor = tick.digit == 1 ? "" : fmt::format("{}\u2009\u00D7\u2009", tick.digit);
  const std::string sign = tick.exponent < 0 ? "\u2212" : "";
  return fmt::format(R"({}10<tspan class="exponent" dy="-5">{}{}</tspan>)", factor, sign, std::abs(tick.exponent));
}

// As much of a title as there is room for.
std::string shortened(const std::string& text, std::size_t characters) {
  std::string part;
  for (const char c : text) {
    const bool begins = (static_cast<unsigned char>(c) & 0xC0) != 0x80;
    if (begins && characters-- == 0) return html(part) + "\u2026";
    part += c;
  }
  return html(part);
}

std::string error_title(const Diagram& diagram) {
  const std::string name = diagram.error_name.empty() ? "error" : diagram.error_name;
  return diagram.error_unit.empty() ? name : name + " [" + diagram.error_unit + "]";
}

std::string grid(const Diagram& diagram, const Axis& axis, const Scale& x, const Scale& y) {
  std::string lines, labels;
  for (const Tick& tick : ticks_of(x)) {
    const double at = x.at_log(tick.logarithm);
    lines += fmt::format(R"(<path class="{}" d="M{:.1f} {}V{}"/>)", tick.digit == 1 ? "grid" : "grid minor", at, kTop,
                         kHeight - kBottom);
    if (tick.labelled)
      labels += fmt::format(R"(<text x="{:.1f}" y="{}" class="mid">{}</text>)", at, kHeight - kBottom + 18,
                            tick_label(tick, x));
  }
  for (const Tick& tick : ticks_of(y)) {
    const double at = y.at_log(tick.logarithm);
    lines += fmt::format(R"(<path class="{}" d="M{} {:.1f}H{}"/>)", tick.digit == 1 ? "grid" : "grid minor", kLeft, at,
                         kWidth - kRight);
    if (tick.labelled)
      labels += fmt::format(R"(<text x="{}" y="{:.1f}" class="end">{}</text>)", kLeft - 8, at + 4, tick_label(tick, y));
  }
  const double across = (kLeft + kWidth - kRight) / 2, down = (kTop + kHeight - kBottom) / 2;
  return lines + labels +
         fmt::format(R"(<path class="frame" d="M{0} {1}V{2}H{3}"/><text class="mid title" x="{4}" y="{5}">{6}</text>)"
                     R"~(<text class="mid title" transform="translate(15 {7}) rotate(-90)">{8}</text>)~",
                     kLeft, kTop, kHeight - kBottom, kWidth - kRight, across, kHeight - 12, axis.title, down,
                     shortened(error_title(diagram), 60)) +
         fmt::format(R"(<g class="better"><path d="M{0} {1}l-15 15m0 -8v8h8"/><text x="{2}" y="{3}">better</text></g>)",
                     kLeft + 27, kHeight - kBottom - 27, kLeft + 31, kHeight - kBottom - 27);
}

// --- marks ---------------------------------------------------------------------------------------------------------

// A polygon of `corners` around 0; with `inner` below 1, a star.
std::string polygon(int corners, double radius, double turn, double inner = 1) {
  std::string path;
  const int count = inner < 1 ? 2 * corners : corners;
  for (int i = 0; i < count; ++i) {
    const double angle = turn + 2 * std::numbers::pi * i / count, r = i % 2 == 1 && inner < 1 ? inner * radius : radius;
    path += fmt::format("{}{:.1f} {:.1f}", i == 0 ? "M" : "L", r * std::sin(angle), -r * std::cos(angle));
  }
  return path + "Z";
}

std::string circle(double r) {
  return fmt::format("M{0} 0A{1} {1} 0 1 1 {0} 0.01Z", -r, r);
}

// Of about the same area.
std::string shape_of(std::size_t knob) {
  constexpr double kPi = std::numbers::pi;
  switch (knob % kShapes) {
    case 0:
      return circle(4.4);
    case 1:
      return polygon(4, 5.6, kPi / 4);
    case 2:
      return polygon(3, 6.3, 0);
    case 3:
      return polygon(4, 5.9, 0);
    case 4:
      return polygon(3, 6.3, kPi);
    case 5:
      return "M-1.8 -5.6H1.8V-1.8H5.6V1.8H1.8V5.6H-1.8V1.8H-5.6V-1.8H-1.8Z";
    case 6:
      return polygon(4, 7.2, kPi / 4, 0.36);
    default:
      return polygon(5, 5.6, 0);
  }
}

std::string default_star() {
  return polygon(5, 9, 0, 0.45);
}

const char* const kPaperRing = "M-9.5 0A9.5 9.5 0 1 1 -9.5 0.01Z";

// --- points --------------------------------------------------------------------------------------------------------

struct Point {
  const TradeoffRow* row;
  std::size_t knob;
  double value, x, y;  // on the horizontal axis; pixels
  bool on_front;
};

struct Chart {
  const Diagram& diagram;
  const Axis& axis;
  Scale x, y;
  std::vector<Point> points;  // on the axes
  std::vector<const TradeoffRow*> elsewhere;
};

// Least errors as the value grows: the front of an axis other than time, of which rows say it themselves.
void mark_front(std::vector<Point>& points) {
  for (Point& p : points) {
    p.on_front = std::none_of(points.begin(), points.end(), [&](const Point& q) {
      return q.value <= p.value && q.row->error <= p.row->error && (q.value < p.value || q.row->error < p.row->error);
    });
  }
}

Chart chart_of(const Diagram& diagram, const Axis& axis) {
  Chart chart{diagram, axis, {}, {}, {}, {}};
  const std::vector<std::string> knobs = knobs_of(diagram);
  std::vector<double> values, errors;
  for (const TradeoffRow& row : diagram.rows) {
    if (!row.failed.empty()) continue;
    const double value = axis.value(row);
    if (!has_logarithm(value) || !has_logarithm(row.error)) {
      chart.elsewhere.push_back(&row);
      continue;
    }
    const auto knob = static_cast<std::size_t>(std::find(knobs.begin(), knobs.end(), row.knob) - knobs.begin());
    chart.points.push_back({&row, knob, value, 0, 0, row.on_front});
    values.push_back(value);
    errors.push_back(row.error);
  }
  if (chart.points.empty()) return chart;
  chart.x = scale_of(values, kLeft, kWidth - kRight);
  chart.y = scale_of(errors, kHeight - kBottom, kTop);
  for (Point& p : chart.points) p.x = chart.x.at(p.value), p.y = chart.y.at(p.row->error);
  if (&axis != kAxes.data()) mark_front(chart.points);
  return chart;
}

bool is_default(const TradeoffRow& row) {
  return row.knob == "default";
}

// Joins a knob's ordered points in order of amount.
std::string curves_svg(const Chart& chart) {
  std::map<std::size_t, std::vector<const Point*>> curves;
  for (const Point& p : chart.points) {
    if (std::isfinite(p.row->amount) && !is_default(*p.row)) curves[p.knob].push_back(&p);
  }
  std::string svg;
  for (auto& [knob, points] : curves) {
    std::stable_sort(points.begin(), points.end(),
                     [](const Point* a, const Point* b) { return a->row->amount < b->row->amount; });
    std::string path;
    for (const Point* p : points) path += fmt::format("{}{:.1f} {:.1f}", path.empty() ? "M" : "L", p->x, p->y);
    if (points.size() > 1)
      svg += fmt::format(R"(<path class="curve k{}" data-knob="{}" d="{}"/>)", knob % kColours, knob, path);
  }
  return svg;
}

// A line from one end of what is known to the other, with a cap where the end is on the axis.
std::string bar(const Scale& scale, double low, double high, double across, bool vertical) {
  const double from = scale.clipped(low), to = scale.clipped(high);
  if (!std::isfinite(from + to) || std::abs(from - to) < 0.5) return {};
  const auto place = [&](double along, double beside) {
    return vertical ? fmt::format("{:.1f} {:.1f}", across + beside, along)
                    : fmt::format("{:.1f} {:.1f}", along, across + beside);
  };
  std::string path = "M" + place(from, 0) + "L" + place(to, 0);
  for (const auto& [value, end] : {std::pair{low, from}, std::pair{high, to}}) {
    if (scale.holds(value)) path += "M" + place(end, -2.5) + "L" + place(end, 2.5);
  }
  return path;
}

std::string bars_svg(const Chart& chart) {
  std::string svg;
  for (const Point& p : chart.points) {
    const double spread = std::isfinite(p.row->error_bar) ? std::abs(p.row->error_bar) : 0;
    std::string path = bar(chart.y, p.row->error - spread, p.row->error + spread, p.x, true);
    if (&chart.axis == kAxes.data()) path += bar(chart.x, p.row->time.min_ms, p.row->time.max_ms, p.y, false);
    if (path.empty()) continue;
    svg += fmt::format(R"(<path class="bars k{}{}" data-knob="{}" data-of="{}" d="{}"/>)", p.knob % kColours,
                       std::string(p.on_front ? "" : " under") + (is_default(*p.row) ? " default" : ""), p.knob,
                       row_anchor(chart.diagram, *p.row), path);
  }
  return svg;
}

// What the front leaves behind, and its edge: a staircase, as nothing between two points was measured.
std::string front_svg(const Chart& chart) {
  std::vector<const Point*> front;
  for (const Point& p : chart.points) {
    if (p.on_front) front.push_back(&p);
  }
  if (front.empty()) return {};
  std::sort(front.begin(), front.end(),
            [](const Point* a, const Point* b) { return std::pair(a->x, -a->y) < std::pair(b->x, -b->y); });
  std::string path = fmt::format("M{:.1f} {}", front.front()->x, kTop);
  for (const Point* p : front) path += fmt::format("H{:.1f}V{:.1f}", p->x, p->y);
  path += fmt::format("H{}", kWidth - kRight);
  return fmt::format(R"(<path class="behind" d="{0}V{1}Z"/><path class="front" d="{0}"/>)", path, kTop);
}

std::string point_words(const Chart& chart, const Point& p) {
  const TradeoffRow& row = *p.row;
  std::string words =
      fmt::format("{}\nerror {}\n{} ms ({} to {})", row_title(row), error_text(chart.diagram, row),
                  significant(row.time.median_ms), significant(row.time.min_ms), significant(row.time.max_ms));
  if (row.bytes > 0) words += ", " + mib_text(row.bytes);
  if (row.prepare_ms > 0) words += fmt::format("\nprepared in {} ms", significant(row.prepare_ms));
  if (!row.paper.empty()) words += "\nas printed in " + html(row.paper);
  return words + (row.on_front               ? "\non the front of error and time"
                  : row.dominated_by.empty() ? ""
                                             : "\nin error and time dominated by " + html(row.dominated_by));
}

std::string point_svg(const Chart& chart, const Point& p) {
  const TradeoffRow& row = *p.row;
  const std::string mark = is_default(row) ? default_star() : shape_of(p.knob);
  const std::string anchor = row_anchor(chart.diagram, row);
  return fmt::format(
             R"~(<a class="point k{}{}{}" href="#{}" data-row="{}" data-knob="{}" transform="translate({:.1f} {:.1f})">)~",
             p.knob % kColours, p.on_front ? " on-front" : " under", is_default(row) ? " default" : "", anchor, anchor,
             p.knob, p.x, p.y) +
         fmt::format(R"(<title>{}</title><circle class="reach" r="11"/>{}<path class="mark" d="{}"/></a>)",
                     point_words(chart, p),
                     row.paper.empty() ? "" : fmt::format(R"(<path class="ring" d="{}"/>)", kPaperRing), mark) +
         "\n";
}

// Dominated points first, so that the front lies above them, and the program's defaults above all.
std::string points_svg(const Chart& chart) {
  std::vector<const Point*> order;
  for (const Point& p : chart.points) order.push_back(&p);
  const auto rank = [](const Point* p) { return 2 * int{is_default(*p->row)} + int{p->on_front}; };
  std::stable_sort(order.begin(), order.end(), [&](const Point* a, const Point* b) { return rank(a) < rank(b); });
  std::string svg;
  for (const Point* p : order) svg += point_svg(chart, *p);
  return svg;
}

// --- names beside points -------------------------------------------------------------------------------------------

struct Box {
  double left, top, right, bottom;
  [[nodiscard]] bool meets(const Box& b) const {
    return left < b.right && b.left < right && top < b.bottom && b.top < bottom;
  }
};

// The first of eight places around a point where nothing lies, none where all are taken: its own words still say it.
// The front leaves its points up and to the right, so their names begin on the other side.
std::optional<Box> free_place(const Point& p, double width, const std::vector<Box>& taken) {
  using Places = std::array<std::pair<int, int>, 8>;
  constexpr Places kOnFront{{{-1, -1}, {-1, 0}, {-1, 1}, {0, -1}, {1, -1}, {1, 0}, {1, 1}, {0, 1}}};
  constexpr Places kBehind{{{1, 1}, {1, -1}, {1, 0}, {-1, 1}, {-1, 0}, {-1, -1}, {0, 1}, {0, -1}}};
  constexpr double kLine = 13, kAway = 11;
  for (const auto& [right, up] : p.on_front ? kOnFront : kBehind) {
    const double left = right > 0 ? p.x + kAway : right < 0 ? p.x - kAway - width : p.x - width / 2;
    const double top = p.y - kLine / 2 - up * (right == 0 ? kAway + 5 : kAway);
    const Box box{left, top, left + width, top + kLine};
    const bool inside = left > kLeft && box.right < kWidth - kRight && top > kTop && box.bottom < kHeight - kBottom;
    if (inside && std::none_of(taken.begin(), taken.end(), [&](const Box& b) { return box.meets(b); })) return box;
  }
  return std::nullopt;
}

std::string names_svg(const Chart& chart) {
  std::vector<Box> taken{{kLeft, kHeight - kBottom - 40, kLeft + 76, kHeight - kBottom}};  // "better"
  for (const Point& p : chart.points) taken.push_back({p.x - 6, p.y - 6, p.x + 6, p.y + 6});
  std::string svg;
  for (const Point& p : chart.points) {
    const std::string& name = is_default(*p.row) ? "default" : p.row->paper;
    if (name.empty() || name.size() > 40) continue;
    const std::optional<Box> place = free_place(p, 6.4 * static_cast<double>(name.size()), taken);
    if (!place) continue;
    taken.push_back(*place);
    svg += fmt::format(R"(<text class="name" data-knob="{}" x="{:.1f}" y="{:.1f}">{}</text>)", p.knob, place->left,
                       place->bottom - 3, html(name));
  }
  return svg;
}

// --- one chart -----------------------------------------------------------------------------------------------------

std::string chart_svg(const Chart& chart) {
  if (chart.points.empty())
    return R"(<p class="note">No point can be on these axes.</p>)"
           "\n";
  return fmt::format(
             R"(<svg viewBox="0 0 {} {}" role="group" aria-label="{} against {}, both logarithmic: down and left is better">)",
             kWidth, kHeight, html(error_title(chart.diagram)), chart.axis.title) +
         grid(chart.diagram, chart.axis, chart.x, chart.y) + front_svg(chart) + curves_svg(chart) + bars_svg(chart) +
         "\n" + points_svg(chart) + names_svg(chart) + "</svg>\n";
}

std::string value_words(double value) {
  return std::isfinite(value) ? significant(value) : html(number(value, 0));
}

std::string elsewhere_list(const Chart& chart) {
  if (chart.elsewhere.empty()) return {};
  std::string items;
  for (const TradeoffRow* row : chart.elsewhere) {
    const std::string anchor = row_anchor(chart.diagram, *row);
    items += fmt::format(R"(<li><a href="#{0}" data-row="{0}">{1}</a>: error {2}, {3} {4}</li>)"
                         "\n",
                         anchor, row_title(*row), value_words(row->error), value_words(chart.axis.value(*row)),
                         chart.axis.unit);
  }
  return fmt::format(
      "<div class=\"elsewhere\"><p class=\"note\">Not on these axes, which have no place for 0 and for "
      "what is not a finite number above it:</p>\n<ul>\n{}</ul></div>\n",
      items);
}

std::string key_mark(const std::string& inner) {
  return R"(<svg class="key" viewBox="-16 -10 32 20" aria-hidden="true">)" + inner + "</svg>";
}

}  // namespace

std::vector<std::string> knobs_of(const Diagram& diagram) {
  std::vector<std::string> names;
  const auto add = [&](const std::string& name) {
    if (std::find(names.begin(), names.end(), name) == names.end()) names.push_back(name);
  };
  for (const Curve& curve : diagram.curves) add(curve.knob);
  for (const TradeoffRow& row : diagram.rows) add(row.knob);
  return names;
}

std::string row_anchor(const Diagram& diagram, const TradeoffRow& row) {
  return html(diagram.id + "/" + row.id);
}

std::string row_title(const TradeoffRow& row) {
  if (is_default(row)) return "default";
  return html(row.label.empty() ? row.knob : row.knob + " = " + row.label);
}

std::string error_text(const Diagram& diagram, const TradeoffRow& row) {
  const std::string unit = diagram.error_unit.empty() ? "" : "\u00A0" + html(diagram.error_unit);
  const std::string spread = row.error_bar > 0 ? " \u00B1\u00A0" + significant(row.error_bar, 2) : "";
  return value_words(row.error) + spread + unit;
}

std::string ms_text(double ms) {
  return value_words(ms) + "\u00A0ms";
}

std::string mib_text(std::uint64_t bytes) {
  return significant(mib(bytes)) + "\u00A0MiB";
}

std::string axis_choice(int number) {
  std::string choice;
  for (const Axis& axis : kAxes) {
    choice += fmt::format(R"(<label><input type="radio" name="axis-{}" value="{}"{}><span>{}</span></label>)", number,
                          axis.id, &axis == kAxes.data() ? " checked" : "", axis.button);
  }
  return "<fieldset><legend>Horizontal axis</legend>" + choice + "</fieldset>";
}

std::string tradeoff_charts(const Diagram& diagram) {
  std::string charts;
  for (const Axis& axis : kAxes) {
    const Chart chart = chart_of(diagram, axis);
    charts += fmt::format("<div class=\"axis\" data-axis=\"{}\">\n", axis.id) + chart_svg(chart) +
              elsewhere_list(chart) + "</div>\n";
  }
  return charts;
}

std::string tradeoff_legend(const Diagram& diagram) {
  std::string items;
  const std::vector<std::string> knobs = knobs_of(diagram);
  for (std::size_t i = 0; i < knobs.size(); ++i) {
    const auto curve =
        std::find_if(diagram.curves.begin(), diagram.curves.end(), [&](const Curve& c) { return c.knob == knobs[i]; });
    const bool joined = std::any_of(diagram.rows.begin(), diagram.rows.end(), [&](const TradeoffRow& r) {
      return r.knob == knobs[i] && std::isfinite(r.amount) && !is_default(r);
    });
    const std::string mark =
        fmt::format(R"(<path class="mark" d="{}"/>)", knobs[i] == "default" ? default_star() : shape_of(i));
    items +=
        fmt::format("<li class=\"k{}{}\" data-knob=\"{}\" title=\"{}\">{}<span>{}</span></li>\n", i % kColours,
                    knobs[i] == "default" ? " default" : "", i, curve == diagram.curves.end() ? "" : html(curve->what),
                    key_mark((joined ? R"(<path class="curve" d="M-16 0H16"/>)" : "") + mark), html(knobs[i]));
  }
  const auto meaning = [](const char* mark, const char* words) {
    return fmt::format("<li>{}<span>{}</span></li>\n", key_mark(mark), words);
  };
  return "<ul class=\"knobs\">\n" + items + "</ul>\n<ul class=\"meanings\">\n" +
         meaning(R"(<path class="front" d="M-15 -6V4H15"/>)", "front: nothing is better on both axes") +
         meaning(R"(<path class="mark under" d="M-4.4 0A4.4 4.4 0 1 1 -4.4 0.01Z"/>)",
                 "faded: dominated by a point of the front") +
         meaning(R"(<path class="ring" d="M-9.5 0A9.5 9.5 0 1 1 -9.5 0.01Z"/>)", "as a paper prints it") +
         meaning(R"(<path class="bars" d="M0 -8V8M-2.5 -8H2.5M-2.5 8H2.5M-14 0H14M-14 -2.5V2.5M14 -2.5V2.5"/>)",
                 "error \u00B1 error bar; least and greatest time") +
         "</ul>\n";
}

}  // namespace pelage::app
