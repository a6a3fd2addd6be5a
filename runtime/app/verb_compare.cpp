#include <fmt/format.h>
#include <spdlog/spdlog.h>
#include <CLI/CLI.hpp>

#include <algorithm>
#include <cstdio>
#include <optional>

#include "pelage/app/command_line.h"
#include "pelage/app/compare.h"
#include "pelage/app/compare_thresholds.h"
#include "pelage/app/comparison_files.h"
#include "pelage/app/comparison_page.h"
#include "pelage/app/drawing.h"
#include "pelage/app/output_folder.h"
#include "pelage/app/scene_options.h"
#include "pelage/app/simulation_options.h"
#include "pelage/app/text_files.h"
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

/// A picture of default size is no larger: direct records and the truth take their time.
constexpr int kWidth = 640, kHeight = 480;
/// Leaves an RMSE of the truth's own well below that of any method.
constexpr int kSamples = 64;

/// What the methods compared differ in.
constexpr const char* kOfMethods[] = {"--method", "--records", "--self-shadow", "--density-map"};

struct CompareOptions {
  std::shared_ptr<SceneOptions> scene;
  std::shared_ptr<SimulationOptions> simulation;
  std::filesystem::path out;
  std::vector<std::string> methods, thresholds;
  int frames = 0;
  double fps = 30, error_scale = 0.25;
};

/// What the rows differ in is not for the command line, and what moves hair wants frames.
void check_options(const console::Verb& verb) {
  for (const char* const option : kOfMethods)
    if (verb.count(option) > 0)
      throw UsageError(std::string(option) + ": the methods compared differ in it; choose among them with --methods");
  for (const char* const option : {"--preset", "--motion", "--amplitude", "--speed", "--wind", "--settle", "--vertices",
                                   "--wisps", "--solver", "--steps-per-second", "--fps"})
    if (verb.count(option) > 0 && verb.count("--frames") == 0)
      throw UsageError(std::string(option) + " is for hair that moves: give --frames as well");
}

Scene compared_scene(const console::Verb& verb, const CompareOptions& o) {
  Scene scene = resolve_scene(verb, *o.scene);
  scene.simulation = resolve_simulation(verb, *o.simulation, scene);
  if (scene.lights.empty()) throw UsageError("the scene has no light: give one with --light");
  if (verb.count("--samples") == 0) scene.truth.samples = std::max(scene.truth.samples, kSamples);
  if (verb.count("--size") > 0) return scene;
  if (scene.hair == o.scene->input) scene.image.width = kWidth, scene.image.height = kHeight;  // no scene file
  limit_size(scene.image, kWidth, kHeight);
  return scene;
}

/// Not of `render`, or told with the row.
const std::vector<std::string> kNotOfRows{"--out",  "--methods", "--threshold", "--frames",      "--fps",
                                          "--size", "--samples", "--database",  "--error-scale", "--order",
                                          "--jobs", "--json",    "--progress",  "--log-level"};

CompareRequest request_of(const console::Verb& verb, const CompareOptions& o) {
  CompareRequest request;
  request.scene = compared_scene(verb, o);
  request.names_database = !request.scene.database.empty() && verb.count("--database") == 0;
  request.methods = chosen_methods(std::exchange(request.scene.database, ""), o.methods);
  request.folder = o.out;
  request.frames = o.frames;
  request.fps = o.fps;
  request.error_scale = static_cast<float>(o.error_scale);
  (request.scene.method == Method::satf ? request.clusters_order : request.order) = o.scene->order;
  request.command = "pelage compare" + words_of(verb, {"--json", "--progress", "--log-level"});
  request.row_command = std::string(o.frames > 1 ? "pelage simulate" : "pelage render") + words_of(verb, kNotOfRows);
  return request;
}

void print_table(const Comparison& c) {
  const bool animated = c.fps > 0;
  std::printf("%s, %d x %d; truth: %d rays per pixel, its own error: RMSE %.5f, FLIP %.4f\n", c.name.c_str(), c.width,
              c.height, c.truth_samples, c.truth_noise.rmse, c.truth_noise.flip);
  if (animated)
    std::printf("%zu frames, flicker of the truth's noise %.5f\n", c.methods[0].frames.size(), c.flicker_noise);
  std::printf("%-20s %8s %9s %8s %7s %7s %7s %9s %9s %8s%s\n", "method", "RMSE", "bias", "relMSE", "PSNR", "FLIP",
              "max", "first ms", "again ms", "MiB", animated ? "  flicker" : "");
  for (const ComparedMethod& m : c.methods) {
    if (!m.failed.empty()) {
      std::printf("%-20s failed: %s\n", m.id.c_str(), m.failed.c_str());
      continue;
    }
    const PictureError& e = m.error;
    std::printf("%-20s %8.5f %+9.5f %8.4f %7.2f %7.4f %7.3f %9.1f %9.1f %8.1f", m.id.c_str(), e.rmse, e.bias, e.rel_mse,
                e.psnr_db, e.flip, e.max, m.first_ms, m.again_ms, static_cast<double>(m.bytes) / 1048576);
    std::printf(animated ? "  %.5f\n" : "\n", m.flicker);
  }
}

void run(const console::Verb& verb, const CompareOptions& o) {
  check_options(verb);
  const CompareRequest request = request_of(verb, o);
  std::vector<Threshold> thresholds;
  for (const std::string& text : o.thresholds)
    thresholds.push_back(parse_threshold(text, request.methods, request.frames > 1));
  make_folder(o.out, "comparison.json");
  std::optional<HeadlessContext> context;
  if (request.methods.size() > 1) context.emplace();  // all but the truth
  const Comparison comparison = compare(request);
  write_comparison(comparison, o.out);
  write_text(comparison_page(comparison, o.out), o.out / "index.html");
  if (console::common().json)
    console::print_json(comparison_json(comparison));
  else
    print_table(comparison);
  for (const std::string& sentence : violations(comparison, thresholds)) {
    spdlog::error("{}", sentence);
    console::set_exit_code(console::threshold);
  }
  if (!console::common().json) std::printf("%s\n", (o.out / "index.html").c_str());
}

}  // namespace

void add_compare(CLI::App& app) {
  console::Verb* const verb = console::add_verb(
      app, "compare",
      "Draw a scene with every method and measure each against the ray-traced truth: error, time, bytes");
  auto o = std::make_shared<CompareOptions>();
  o->scene = add_scene_options(*verb);
  for (const char* const option : kOfMethods) verb->get_option(option)->group("");  // not in --help: refused
  verb->get_option("--size")->description("Pixels, WIDTHxHEIGHT [the scene's, within 640x480]");
  verb->get_option("--samples")
      ->description(
          "Rays per pixel of the truth, half of them for its noise [64, or the "
          "scene's where that is more]");
  verb->get_option("--database")->description("Generic records for satf-generic [random sectors, baked and cached]");
  verb->add_output_folder("-o,--out", o->out,
                          "Folder for index.html, comparison.json, comparison.csv and pictures; made if there is none",
                          {{R"(index\.html|comparison(-frames)?\.(csv|json)|.*\.(png|exr))", ""}})
      ->required();
  verb->add_option("--methods", o->methods, "Only these, e.g. satf-adapted,density-map; the truth is always there")
      ->delimiter(',');
  verb->add_option(
      "--threshold", o->thresholds,
      "METRIC=VALUE or METHOD:METRIC=VALUE, may be repeated: exit with 3 where it is exceeded; rmse, bias, "
      "rel-mse, psnr-db (at least), flip, max, ms, flicker");
  verb->add_option("--error-scale", o->error_scale, "Error of linear luminance at the end of the error maps' scale")
      ->capture_default_str()
      ->check(console::finite(1e-6, 1e6));
  verb->add_option("--frames", o->frames, "Simulate so many frames and compare each, with flicker")
      ->check(CLI::Range(2, 100000));
  verb->add_option("--fps", o->fps, "Frames per second")->capture_default_str()->check(console::finite(1, 1000));
  o->simulation = add_simulation_options(*verb);
  console::add_common_options(*verb);
  verb->runs([verb, o] { run(*verb, *o); });
}

}  // namespace pelage::app
