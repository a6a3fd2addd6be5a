// Writes a page of `pelage tradeoff` from made-up results, for tradeoff_page_test.py: <folder>/index.html, with the
// same as tradeoff.json and tradeoff.csv. Every picture is of one colour: red 8 x the row's number, green 200, blue 60.
#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <filesystem>
#include <limits>

#include "pelage/app/text_files.h"
#include "pelage/app/tradeoff_files.h"
#include "pelage/app/tradeoff_page.h"
#include "pelage/image/image_file.h"
#include "pelage/image/tone.h"
#include "pelage/tradeoff/front.h"

namespace {

using namespace pelage;

constexpr const char* kHostile = "</script><img src=x onerror=\"document.title='ran'\"> & 'hair' {{scene}} \xFF";
constexpr double kNan = std::numeric_limits<double>::quiet_NaN();
constexpr double kInfinity = std::numeric_limits<double>::infinity();

Origin origin() {
  return {"0123456789abcdef", 7, "abc1234", "A processor, 3 GHz", 2};
}

// In [0, 1), the same on every machine.
double scatter(int n) {
  const double x = std::sin(12.9898 * n) * 43758.5453;
  return x - std::floor(x);
}

TradeoffRow row(const std::string& knob, const std::string& label, double amount, double error, double ms) {
  TradeoffRow r;
  r.id = knob + "-" + label;
  r.knob = knob;
  r.label = label;
  r.amount = amount;
  r.settings = {fmt::format("{}={}", knob, label), "shadow.method=\"density-map\""};
  r.command = fmt::format("pelage render 'hair <1>.json' --set {}={}", knob, label);
  r.origin = origin();
  r.error = error;
  r.error_bar = 0.06 * error;
  r.others = {{"bias", -error / 3}, {"p99 & more", 4 * error}};
  r.time = {0.93 * ms, ms, 1.15 * ms, 9};
  r.prepare_ms = 20 * ms;
  r.bytes = static_cast<std::uint64_t>(6e5 * ms);
  return r;
}

// A knob of known order: error ~ amount^order, time ~ amount^cost, neither quite.
void add_curve(Diagram& d, const std::string& knob, const std::string& unit, int points, double error, double order,
               double ms, double cost) {
  d.curves.push_back({knob, "What " + knob + " does; finer values buy less error.", unit});
  for (int i = 0; i < points; ++i) {
    const double amount = std::pow(2.0, i + 2);
    const int n = static_cast<int>(d.rows.size()) + 100 * static_cast<int>(d.id.size());
    d.rows.push_back(row(knob, fmt::format("{}", amount), amount,
                         error * std::pow(amount, -order) * (1 + 0.25 * scatter(n)),
                         ms * std::pow(amount, cost) * (1 + 0.2 * scatter(n + 1))));
  }
}

void add_default(Diagram& d, double error, double ms) {
  TradeoffRow r = row("default", "", kNan, error, ms);
  r.id = "default";
  r.settings.clear();
  d.rows.push_back(r);
}

// Bytes and preparation have orders of their own.
void vary_costs(Diagram& d) {
  for (std::size_t i = 0; i < d.rows.size(); ++i) {
    d.rows[i].bytes = static_cast<std::uint64_t>(4e6 * std::pow(30 * scatter(static_cast<int>(3 * i)), 1.5) + 1e5);
    d.rows[i].prepare_ms = i % 5 == 0 ? 0 : 3000 * scatter(static_cast<int>(7 * i + 1)) + 2;
  }
}

void finish(Diagram& d) {
  mark_front(d.rows);
  d.slopes = fit_slopes(d.curves, d.rows);
}

// As a full sweep of shadows looks, with a knob and texts that mean harm.
Diagram shadows() {
  Diagram d;
  d.id = "transmittance";
  d.title = "Shadows: transmittance at vertices";
  d.error_name = "RMSE of T";
  d.time_name = "map built and read at all vertices";
  d.truth = "Ray casting against every segment, 4096 rays a vertex: standard error 0.0004.";
  add_curve(d, "density-map.cells", "cells", 8, 0.9, 0.6, 0.08, 0.9);
  add_curve(d, "density-map.filter", "taps", 6, 0.25, 0.35, 1.7, 0.35);
  add_curve(d, "density-map.slices", "slices", 6, 0.4, 0.5, 2.2, 0.45);
  std::reverse(d.rows.end() - 6, d.rows.end());  // rows come in any order
  add_curve(d, "deep-opacity.layers", "layers", 7, 0.5, 0.4, 0.3, 0.6);
  add_curve(d, "opacity-shadow.maps", "maps", 6, 1.2, 0.7, 1.0, 0.8);
  add_default(d, 0.045, 4.1);
  for (const char* word : {"printed", "corrected", "none"}) {
    const int n = static_cast<int>(d.rows.size());
    d.rows.push_back(row("shadow.method", word, kNan, 0.05 + 0.5 * scatter(n), 0.6 + 6 * scatter(n + 4)));
  }
  d.curves.push_back({"shadow.method", "Which method.", ""});
  d.rows.push_back(row("combined", "cells 64, 4 taps", kNan, 0.021, 5.5));
  d.rows.back().id = "combined-1";
  TradeoffRow harm = row(kHostile, kHostile, kNan, 0.3, 30);
  harm.id = "harm";
  harm.command = harm.paper = kHostile;
  harm.settings = {kHostile};
  harm.others = {{kHostile, 1}};
  harm.origin.cpu = kHostile;
  d.rows.push_back(harm);
  vary_costs(d);
  finish(d);
  d.rows[4].paper = "Bertails2005";
  d.rows[23].paper = "Yuksel2008";
  d.rows[24].paper = "Mertens2004";
  d.rows[25].paper = "Sintorn2008";
  TradeoffRow failed = row("density-map.cells", "4096", 4096, 0, 0);
  failed.failed = "not enough memory: 256 GiB <needed> & 'asked for'";
  d.rows.push_back(failed);
  failed.id = "harm-failed";
  failed.failed = kHostile;
  d.rows.push_back(failed);
  return d;
}

void add_pictures(Diagram& d, const std::filesystem::path& folder) {
  for (std::size_t i = 0; i < d.rows.size(); ++i) {
    if (!d.rows[i].failed.empty() || i % 6 == 5) continue;
    Image image(96, 64);
    for (int k = 0; k < 96 * 64; ++k) {
      float* p = image.pixel(k % 96, k / 96);
      p[0] = srgb_decode(static_cast<float>(8 * (i % 32)) / 255);
      p[1] = srgb_decode(200.0F / 255);
      p[2] = srgb_decode(60.0F / 255);
      p[3] = 1;
    }
    d.rows[i].picture = fmt::format("{}-{}.png", d.id, i);
    write_image(image, folder / d.rows[i].picture, {});
  }
}

// Twenty knobs.
Diagram many() {
  Diagram d;
  d.id = "picture";
  d.title = "Whole pictures against the path tracer";
  d.error_name = "FLIP";
  d.time_name = "one frame, everything built";
  d.truth = "Path traced with 4096 samples a pixel; its own FLIP, half against half, is 0.002.";
  for (int i = 0; i < 20; ++i)
    add_curve(d, fmt::format("knob-{:02}.setting", i), "units", 3, 0.2 + 0.3 * scatter(i), 0.2 + 0.5 * scatter(i + 50),
              3 + 40 * scatter(i + 90), 0.15 + 0.5 * scatter(i + 130));
  add_default(d, 0.08, 33);
  finish(d);
  return d;
}

Diagram extremes() {
  Diagram d;
  d.id = "extremes";
  d.title = std::string("Extremes ") + kHostile;
  d.error_name = std::string("distance ") + kHostile;
  d.error_unit = "mm";
  d.time_name = kHostile;
  d.truth = kHostile;
  add_curve(d, "step", "ms", 6, 1e3, 6, 1e-3, 4);
  d.rows[5].error = 3e-12;
  d.rows[4].time = {0, 5e7, kInfinity, 3};
  d.rows[3].error_bar = 1e9;
  d.rows[2].error_bar = kNan;
  const std::pair<const char*, std::pair<double, double>> odd[] = {{"no-error", {0, 3}},
                                                                   {"no-time", {0.1, 0}},
                                                                   {"undefined", {kNan, 2}},
                                                                   {"endless", {0.2, kInfinity}},
                                                                   {"below", {-1, 2}}};
  for (const auto& [label, figures] : odd) d.rows.push_back(row("odd", label, kNan, figures.first, figures.second));
  d.rows.back().error_bar = 0;
  finish(d);
  d.rows[1].origin.revision = "older00";
  return d;
}

Diagram single() {
  Diagram d;
  d.id = "single";
  d.title = "One point";
  d.error_name = "period error";
  add_default(d, 0.02, 12);
  d.rows[0].bytes = 0;
  finish(d);
  return d;
}

Diagram empty() {
  Diagram d;
  d.id = "empty";
  d.title = "Nothing measured";
  return d;
}

}  // namespace

int main(int count, char** arguments) {
  if (count != 2) return std::fputs("tradeoff_sample FOLDER\n", stderr), 2;
  const std::filesystem::path folder = arguments[1];
  std::filesystem::create_directories(folder);
  Tradeoff t;
  t.name = kHostile;
  t.command = fmt::format("pelage tradeoff '{}' -o out", kHostile);
  t.scene = "{\n  \"hair\": \"</script><b>hair\"\n}";
  t.origin = origin();
  t.quick = true;
  t.diagrams = {shadows(), many(), extremes(), single(), empty()};
  add_pictures(t.diagrams[0], folder);
  app::write_tradeoff(t, folder);
  app::write_text(app::tradeoff_page(t, folder), folder / "index.html");
}
