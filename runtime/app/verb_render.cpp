#include <spdlog/spdlog.h>
#include <CLI/CLI.hpp>

#include <cstdio>
#include <nlohmann/json.hpp>
#include <optional>

#include "pelage/app/drawing.h"
#include "pelage/app/explain.h"
#include "pelage/app/framing.h"
#include "pelage/app/picture.h"
#include "pelage/app/picture_budget.h"
#include "pelage/app/scene_options.h"
#include "pelage/app/verbs.h"
#include "pelage/console/json_output.h"
#include "pelage/console/program.h"
#include "pelage/console/verb.h"
#include "pelage/data_schema/errors.h"
#include "pelage/data_schema/output_file.h"
#include "pelage/image/image_file.h"
#include "pelage/render/gl_context.h"

namespace pelage::app {
namespace {

struct RenderOptions {
  std::shared_ptr<SceneOptions> scene;
  std::string out;
  bool stats = false, explain = false;
  BudgetOptions budget;
};

nlohmann::ordered_json stats_of(const Drawing& drawing) {
  nlohmann::ordered_json json;
  for (const Stage& s : drawing.ledger().stages())
    json["stages"].push_back({{"name", s.name}, {"ms", s.milliseconds}, {"bytes", s.bytes}, {"calls", s.calls}});
  json["searches"] = drawing.searches();
  return json;
}

void print_stats(const Drawing& drawing) {
  std::printf("%-12s %10s %12s %7s\n", "stage", "ms", "KiB", "calls");
  for (const Stage& s : drawing.ledger().stages()) {
    std::printf("%-12s %10.2f %12.1f %7llu\n", s.name.c_str(), s.milliseconds, static_cast<double>(s.bytes) / 1024.0,
                static_cast<unsigned long long>(s.calls));
  }
  if (drawing.searches() > 0) std::printf("FLANN queries: %llu\n", static_cast<unsigned long long>(drawing.searches()));
}

/// What was drawn, and with what.
struct Drawn {
  Scene scene;
  Camera camera;
  std::unique_ptr<Drawing> drawing;
  Image image;
  std::optional<Budget> budget;
};

Drawn draw(const Scene& scene) {
  Drawn drawn;
  drawn.scene = scene;
  drawn.drawing = make_drawing(scene);
  drawn.camera = camera_of(scene, *drawn.drawing);
  drawn.image = drawn.drawing->render(scene, drawn.camera);
  return drawn;
}

Drawn draw_within(const console::Verb& verb, const Scene& scene, const Goal& goal) {
  ChosenPicture c =
      choose_picture(scene, goal, verb.count("--method") > 0 ? std::optional(scene.method) : std::nullopt);
  if (!c.budget.choice.met) console::set_exit_code(console::threshold);
  return {std::move(c.scene), c.camera, std::move(c.drawing), std::move(c.image), std::move(c.budget)};
}

void print(const RenderOptions& options, Drawn& drawn) {
  if (console::common().json) {
    nlohmann::ordered_json json = options.stats ? stats_of(*drawn.drawing) : nlohmann::ordered_json::object();
    if (options.explain) json["effects"] = json_of(explain_picture(*drawn.drawing, drawn.scene, drawn.camera));
    if (drawn.budget) json["budget"] = json_of(*drawn.budget);
    if (!json.empty()) console::print_json(json);
    return;
  }
  if (options.stats) print_stats(*drawn.drawing);
  if (options.explain) print_ledger(explain_picture(*drawn.drawing, drawn.scene, drawn.camera));
  if (drawn.budget) print_budget(*drawn.budget);
  std::printf("%s\n", options.out.c_str());
}

void render(const console::Verb& verb, const RenderOptions& options) {
  const std::filesystem::path out = options.out;
  check_picture_name(out);
  check_writable(out);
  const Scene scene = resolve_scene(verb, *options.scene);
  const std::optional<Goal> goal = options.budget.goal();
  std::optional<HeadlessContext> context;
  if (needs_opengl(scene.method) || goal) {
    context.emplace();
    spdlog::debug("OpenGL {}", opengl_description());
  }
  Drawn drawn = goal ? draw_within(verb, scene, *goal) : draw(scene);
  console::throw_if_interrupted();  // an earlier picture stays
  write_picture(std::move(drawn.image), drawn.scene, out);
  print(options, drawn);
}

}  // namespace

void add_render(CLI::App& app) {
  console::Verb* const verb =
      console::add_verb(app, "render", "Render a picture of a scene, a hairstyle or a hair file");
  auto options = std::make_shared<RenderOptions>();
  options->scene = add_scene_options(*verb);
  verb->add_output("-o,--out", options->out,
                   "Picture to write: .png (8-bit sRGB) or .exr (linear, with the configuration)")
      ->required();
  verb->add_flag("--stats", options->stats, "Print time, bytes and calls of each stage");
  verb->add_flag(
      "--explain", options->explain,
      "Print the ledger: each effect, whether it runs and why, its cost, and how far the picture is from one "
      "with it switched over (four pictures more for each)");
  add_budget_options(*verb, options->budget, "a frame in which the hair has moved",
                     "RMSE of linear RGB against the ray-traced truth; chooses the method too, unless --method does");
  console::add_common_options(*verb);
  verb->runs([verb, options] { render(*verb, *options); });
}

}  // namespace pelage::app
