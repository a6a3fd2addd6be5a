#include <fmt/format.h>
#include <spdlog/spdlog.h>
#include <CLI/CLI.hpp>

#include <algorithm>
#include <cstdio>
#include <optional>

#include "pelage/app/all_knobs.h"
#include "pelage/app/command_line.h"
#include "pelage/app/output_folder.h"
#include "pelage/app/prepare.h"
#include "pelage/app/scene_options.h"
#include "pelage/app/simulation_options.h"
#include "pelage/app/sweep.h"
#include "pelage/app/text_files.h"
#include "pelage/app/tradeoff_files.h"
#include "pelage/app/tradeoff_page.h"
#include "pelage/app/verbs.h"
#include "pelage/console/json_output.h"
#include "pelage/console/options.h"
#include "pelage/console/program.h"
#include "pelage/console/verb.h"
#include "pelage/data_schema/errors.h"
#include "pelage/data_schema/output_file.h"
#include "pelage/render/gl_context.h"

namespace pelage::app {
namespace {

/// A picture of default size is no larger.
constexpr int kWidth = 320, kHeight = 240, kQuickWidth = 200, kQuickHeight = 150;

/// Bytes of databases that a sweep keeps for its next points.
constexpr std::uintmax_t kMostCached = 1U << 30U;

struct TradeoffOptions {
  std::shared_ptr<SceneOptions> scene;
  std::shared_ptr<SimulationOptions> simulation;
  std::filesystem::path out;
  std::vector<std::string> only;
  bool quick = false, list = false, no_combine = false;
  std::uint64_t seed = 1;
};

const std::vector<std::string> kNotOfRows{"--out",  "--only",     "--quick",     "--list", "--no-combine",
                                          "--seed", "--progress", "--log-level", "--json", "--jobs"};

Scene swept_scene(const console::Verb& verb, const TradeoffOptions& o) {
  Scene scene = resolve_scene(verb, *o.scene);
  scene.simulation = resolve_simulation(verb, *o.simulation, scene);
  if (scene.lights.empty()) throw UsageError("the scene has no light: give one with --light");
  if (verb.count("--size") > 0) return scene;
  const int width = o.quick ? kQuickWidth : kWidth, height = o.quick ? kQuickHeight : kHeight;
  if (scene.hair == o.scene->input) scene.image.width = width, scene.image.height = height;  // no scene file
  limit_size(scene.image, width, height);
  return scene;
}

SweepRequest request_of(const console::Verb& verb, const TradeoffOptions& o) {
  SweepRequest request;
  request.measure = {swept_scene(verb, o), o.quick, o.seed};
  request.knobs = chosen_knobs(o.only);
  request.folder = o.out;
  request.name = std::filesystem::path(request.measure.scene.hair).stem().string();
  request.command = "pelage tradeoff" + words_of(verb, {"--json", "--progress", "--log-level"});
  request.row_words = words_of(verb, kNotOfRows).substr(1);
  if (verb.count("--size") == 0)
    request.row_words +=
        fmt::format(" --size {}x{}", request.measure.scene.image.width, request.measure.scene.image.height);
  request.combine = !o.no_combine;
  request.make_measure = make_measure;
  return request;
}

void print_knobs() {
  for (const Knob& knob : all_knobs()) {
    std::string values;
    for (const KnobValue& v : knob.values) values += (values.empty() ? "" : ", ") + v.label;
    std::printf("%-28s %s\n%-28s %s%s%s\n", knob.name.c_str(), knob.what.c_str(), "", values.c_str(),
                knob.unit.empty() ? "" : " ", knob.unit.c_str());
  }
}

void print_diagram(const Diagram& d) {
  const std::string unit = d.error_unit.empty() ? "" : " [" + d.error_unit + "]";
  std::printf("\n%s: %zu points; the front, fastest first\n", d.title.c_str(), d.rows.size());
  std::printf("%-40s %10s %12s %10s  %s\n", "point", "ms", (d.error_name + unit).c_str(), "+-", "settings");
  std::vector<const TradeoffRow*> front;
  for (const TradeoffRow& row : d.rows)
    if (row.on_front) front.push_back(&row);
  std::sort(front.begin(), front.end(),
            [](const TradeoffRow* a, const TradeoffRow* b) { return a->time.median_ms < b->time.median_ms; });
  for (const TradeoffRow* const row : front)
    std::printf("%-40s %10.2f %12.5g %10.2g  %s\n", row->id.c_str(), row->time.median_ms, row->error, row->error_bar,
                fmt::format("{}", fmt::join(row->settings, " ")).c_str());
  for (const TradeoffRow& row : d.rows)
    if (row.id == "default" && !row.on_front && row.failed.empty())
      std::printf("%-40s %10.2f %12.5g %10.2g  not on the front: %s is better\n", row.id.c_str(), row.time.median_ms,
                  row.error, row.error_bar, row.dominated_by.c_str());
  for (const Slope& s : d.slopes)
    std::printf("slope of %s against %s: %.2f +- %.2f (%d points)\n", s.knob.c_str(), s.against.c_str(), s.slope,
                s.standard_error, s.points);
  for (const TradeoffRow& row : d.rows)
    if (!row.failed.empty()) std::printf("failed: %s: %s\n", row.id.c_str(), row.failed.c_str());
}

/// None where no point draws, or none can be had: then points that need it fail and say why.
std::unique_ptr<HeadlessContext> context_for(const std::vector<Knob>& knobs) {
  const bool draws = std::any_of(knobs.begin(), knobs.end(), [](const Knob& k) {
    return k.measure == MeasureKind::picture || k.measure == MeasureKind::motion;
  });
  if (!draws) return {};
  try {
    return std::make_unique<HeadlessContext>();
  } catch (const std::exception& error) {
    spdlog::warn("{}; points that draw with it are left out", error.what());
    return {};
  }
}

void run(const console::Verb& verb, const TradeoffOptions& o) {
  if (o.list) {
    print_knobs();
    return;
  }
  if (o.scene->input.empty()) throw UsageError("input is required: a scene, hairstyle or hair file");
  if (o.out.empty()) throw UsageError("--out is required: a folder for index.html, tradeoff.json and tradeoff.csv");
  SweepRequest request = request_of(verb, o);
  make_folder(o.out, "tradeoff.json");
  make_folder(o.out / "points", "a.json");
  const std::unique_ptr<HeadlessContext> context = context_for(request.knobs);
  const TemporaryCache cache(o.out / "cache", kMostCached);
  request.after_point = [&] { cache.trim(); };
  const Tradeoff tradeoff = sweep(request);
  write_tradeoff(tradeoff, o.out);
  write_text(tradeoff_page(tradeoff, o.out), o.out / "index.html");
  if (console::common().json) {
    console::print_json(tradeoff_json(tradeoff));
    return;
  }
  for (const Diagram& diagram : tradeoff.diagrams) print_diagram(diagram);
  std::printf("\n%s\n", (o.out / "index.html").c_str());
}

}  // namespace

void add_tradeoff(CLI::App& app) {
  console::Verb* const verb = console::add_verb(
      app, "tradeoff",
      "Sweep every knob and show what accuracy costs in time: error against an independent truth, ms, bytes");
  auto o = std::make_shared<TradeoffOptions>();
  o->scene = add_scene_options(*verb);
  verb->get_option("input")->required(false);
  verb->get_option("--size")->description(
      "Pixels of pictures, WIDTHxHEIGHT [the scene's, within 320x240; with --quick, 200x150]");
  verb->add_output_folder(
      "-o,--out", o->out,
      "Folder for index.html, tradeoff.json, tradeoff.csv and points; made if there is none. A sweep that "
      "was interrupted goes on from the points there",
      {{R"(index\.html|tradeoff\.(csv|json))", ""}, {".*", "points"}, {".*", "cache"}});
  verb->add_option("--only", o->only, "Only these knobs, e.g. density-map.cells,strands (all of strands); see --list")
      ->delimiter(',');
  verb->add_flag("--quick", o->quick, "Fewer values, smaller pictures, a coarser truth: minutes");
  verb->add_flag("--no-combine", o->no_combine, "One knob at a time; no points of several");
  verb->add_flag("--list", o->list, "Print the knobs with their values, and nothing else");
  verb->add_option("--seed", o->seed, "Which rays and points the truth has")
      ->check(console::finite(0, static_cast<double>(kLargestSeed)))
      ->capture_default_str();
  o->simulation = add_simulation_options(*verb);
  console::add_common_options(*verb);
  verb->runs([verb, o] { run(*verb, *o); });
}

}  // namespace pelage::app
