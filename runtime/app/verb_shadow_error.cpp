#include <fmt/format.h>
#include <spdlog/spdlog.h>
#include <tbb/global_control.h>
#include <CLI/CLI.hpp>

#include <cstdio>
#include <nlohmann/json.hpp>
#include <sstream>

#include "pelage/app/prepare.h"
#include "pelage/app/scene_options.h"
#include "pelage/app/shadow_error.h"
#include "pelage/app/verbs.h"
#include "pelage/console/json_output.h"
#include "pelage/console/options.h"
#include "pelage/console/program.h"
#include "pelage/console/progress.h"
#include "pelage/console/verb.h"
#include "pelage/data_schema/bake_settings.h"
#include "pelage/data_schema/errors.h"
#include "pelage/db/database.h"

namespace pelage::app {
namespace {

using nlohmann::ordered_json;

struct Options {
  std::shared_ptr<SceneOptions> scene;
  std::vector<int> resolutions{32, 64, 128, 256};
  int points = 1000, rays = 8192, repeats = 5;
  double footprint_mm = 2;
  std::uint64_t seed = 1;
};

void print_header(const StrandHair& hair, const ShadowTruth& truth, const TruthSettings& settings) {
  std::printf(
      "%s: %zu strands, %zu vertices. Truth at %zu vertices: %d rays each within %.2g mm, mean T %.3f, s.d. %.3f, its "
      "own error %.4f (RMS)\n",
      hair.name.c_str(), hair.strands.count(), hair.strands.vertices.size(), truth.points.size(), settings.rays,
      1e3 * static_cast<double>(settings.footprint_m), truth.mean, truth.deviation, truth.standard_error);
  std::printf("%-31s %-17s %7s %8s %7s %7s %9s %8s %8s %8s\n", "method", "resolution", "RMSE", "bias", "p99", "max",
              "build ms", "read ms", "+-", "MiB");
}

void print_row(const ShadowRow& row, const ShadowResult& r) {
  std::printf("%-31s %-17s %7.4f %+8.4f %7.3f %7.3f %9.2f %8.2f %8.2f %8.2f\n", row.method.c_str(), row.setting.c_str(),
              r.error.rmse, r.error.bias, r.error.p99, r.error.max, r.build_ms, r.filter_ms, r.spread_ms,
              static_cast<double>(r.bytes) / 1048576.0);
  std::fflush(stdout);
}

ordered_json json_of(const ShadowRow& row, const ShadowResult& r) {
  return {{"method", row.method},     {"resolution", row.setting}, {"rmse", r.error.rmse},
          {"bias", r.error.bias},     {"p99", r.error.p99},        {"max", r.error.max},
          {"build_ms", r.build_ms},   {"fill_ms", r.fill_ms},      {"transmittance_ms", r.transmittance_ms},
          {"filter_ms", r.filter_ms}, {"spread_ms", r.spread_ms},  {"bytes", r.bytes}};
}

/// T without a shadow method worth the name: everywhere the mean of the truth.
ShadowResult constant_mean(const ShadowTruth& truth) {
  ShadowResult r;
  r.error = shadow_error(std::vector<float>(truth.points.size(), static_cast<float>(truth.mean)), truth.estimates);
  return r;
}

void measure(const console::Verb& verb, const Options& o) {
  Scene scene = resolve_scene(verb, *o.scene);
  if (scene.lights.empty()) throw UsageError("the scene has no light: give one with --light");
  if (scene.lights.size() > 1) spdlog::info("the scene has {} lights; the first one is measured", scene.lights.size());
  if (verb.count("--rays") > 0) scene.truth.rays = o.rays;
  if (verb.count("--footprint-mm") > 0) scene.truth.footprint_m = static_cast<float>(1e-3 * o.footprint_mm);
  const Light& light = scene.lights.front();
  const StrandHair hair = prepare_strands(scene);
  if (hair.strands.vertices.empty()) throw InputError(scene.hair, "has no strands to measure");
  ShadowTruth truth;
  {
    console::Progress progress("tracing shadows of " + hair.name, static_cast<std::uint64_t>(o.points), "points");
    truth = shadow_truth(hair.strands, hair.opacity, light, scene.truth, static_cast<std::size_t>(o.points), o.seed,
                         [&](std::uint64_t done, std::uint64_t) {
                           console::throw_if_interrupted();
                           progress.update(done);
                         });
  }
  const bool json = console::common().json;
  ordered_json document{{"hair", hair.name},
                        {"strands", hair.strands.count()},
                        {"vertices", hair.strands.vertices.size()},
                        {"seed", o.seed},
                        {"revision", program_revision()},
                        {"threads", tbb::global_control::active_value(tbb::global_control::max_allowed_parallelism)},
                        {"truth",
                         {{"points", truth.points.size()},
                          {"rays", scene.truth.rays},
                          {"footprint_m", scene.truth.footprint_m},
                          {"mean", truth.mean},
                          {"deviation", truth.deviation},
                          {"standard_error", truth.standard_error}}}};
  if (!json) print_header(hair, truth, scene.truth);
  const auto tell = [&](const ShadowRow& row, const ShadowResult& result) {
    if (json)
      document["rows"].push_back(json_of(row, result));
    else
      print_row(row, result);
  };
  tell({"the truth's mean everywhere", "", Method::unshadowed, {}}, constant_mean(truth));
  for (const ShadowRow& row : shadow_rows(scene.shadow, o.resolutions)) {
    if (light.position && (row.how == Method::deep_opacity || row.how == Method::opacity_shadow)) continue;
    console::throw_if_interrupted();
    tell(row, measure_shadow(row, hair.strands, hair.opacity, light, truth, {o.repeats, o.repeats}));
  }
  if (json) console::print_json(document);
}

}  // namespace

void add_shadow_error(CLI::App& app) {
  console::Verb* const verb =
      console::add_verb(app, "shadow-error",
                        "Measure every shadow method against ray-traced truth at vertices of a groom, with its time");
  auto options = std::make_shared<Options>();
  options->scene = add_scene_options(*verb);
  verb->add_option("--resolutions", options->resolutions, "Cells along the longest side of the density map")
      ->delimiter(',')
      ->capture_default_str()
      ->check(CLI::Range(1, 1024));
  verb->add_option("--points", options->points, "Vertices at which the truth is traced")
      ->capture_default_str()
      ->check(CLI::Range(1, 10'000'000));
  verb->add_option("--rays", options->rays, "Rays per point; a claim below .05 wants 8000")
      ->capture_default_str()
      ->check(CLI::Range(1, 1'000'000));
  verb->add_option(
          "--footprint-mm", options->footprint_mm,
          "Radius over which the truth is averaged [mm], at least 4 strand spacings; the maps' own is in the scene")
      ->capture_default_str()
      ->check(console::finite(0, 1000));
  verb->add_option("--repeats", options->repeats, "Times that each map is built; medians are shown")
      ->capture_default_str()
      ->check(CLI::Range(1, 1000));
  verb->add_option("--seed", options->seed, "Which vertices and rays")
      ->check(console::finite(0, static_cast<double>(kLargestSeed)))
      ->capture_default_str();
  console::add_common_options(*verb);
  verb->runs([verb, options] { measure(*verb, *options); });
}

}  // namespace pelage::app
