// Figures of the papers, drawn anew in one command each, as a sheet of pictures with what was measured under each.
#include <fmt/format.h>
#include <spdlog/spdlog.h>
#include <CLI/CLI.hpp>

#include <functional>
#include <map>

#include "pelage/app/drawing.h"
#include "pelage/app/figure_sheet.h"
#include "pelage/app/figures_of_methods.h"
#include "pelage/app/figures_of_motion.h"
#include "pelage/app/scene_options.h"
#include "pelage/app/shadow_error.h"
#include "pelage/app/verbs.h"
#include "pelage/console/program.h"
#include "pelage/console/progress.h"
#include "pelage/console/verb.h"
#include "pelage/data_schema/errors.h"
#include "pelage/data_schema/output_file.h"
#include "pelage/image/image_file.h"
#include "pelage/render/gl_context.h"

namespace pelage::app {
namespace {

ShadowTruth truth_of(const Scene& scene, const StrandHair& hair) {
  constexpr std::size_t kPoints = 1000;
  console::Progress progress("tracing shadows of " + hair.name, kPoints, "points");
  return shadow_truth(hair.strands, hair.opacity, scene.lights.front(), scene.truth, kPoints, 1,
                      [&](std::uint64_t done, std::uint64_t) {
                        console::throw_if_interrupted();
                        progress.update(done);
                      });
}

std::string measured(const ShadowResult& r) {
  return fmt::format("RMSE {:.3f}, bias {:+.3f}, {:.1f} ms", r.error.rmse, r.error.bias, r.build_ms + r.filter_ms);
}

/// [Bertails2005 Fig. 8] and more: resolutions of the density map, corrected and as printed, beside the truth.
Image resolutions(Scene scene) {
  const Subject s = subject_of(scene, hair::GroomStyle::curly, 10'000);
  const ShadowTruth truth = truth_of(scene, s.hair);
  const std::vector<int> sizes{32, 64, 128, 256};
  Sheet sheet({static_cast<int>(sizes.size()) + 1, 2}, size_of(scene));
  const auto drawing = make_strand_drawing(Method::density_map, s.hair, s.head);
  for (int row = 0; row < 2; ++row) {
    for (std::size_t i = 0; i < sizes.size(); ++i) {
      scene.method = Method::density_map;
      scene.shadow.density_map = row == 0 ? DensityMapSettings{} : DensityMapSettings::printed();
      scene.shadow.density_map.resolution = sizes[i];
      const ShadowRow what{"", "", Method::density_map, scene.shadow};
      const ShadowResult r = measure_shadow(what, s.hair.strands, s.hair.opacity, scene.lights.front(), truth, {5, 5});
      sheet.put({static_cast<int>(i), row}, picture_of(*drawing, scene),
                fmt::format("{}^3 {}", sizes[i], row == 0 ? "corrected" : "as printed"), measured(r));
    }
  }
  scene.method = Method::unshadowed;
  sheet.put({static_cast<int>(sizes.size()), 1}, picture_of(*drawing, scene), "no shadow", "");
  scene.method = Method::truth;
  scene.truth.azimuth = false;
  sheet.put({static_cast<int>(sizes.size()), 0}, picture_of(*make_strand_drawing(Method::truth, s.hair, s.head), scene),
            "ray-traced truth", fmt::format("its own error {:.4f}", truth.standard_error));
  return sheet.image();
}

/// [Bertails2005 Fig. 7]: what self-shadow does.
Image self_shadow(Scene scene) {
  const Subject s = subject_of(scene, hair::GroomStyle::wavy, 15'000);
  Sheet sheet({3, 1}, size_of(scene));
  const auto drawing = make_strand_drawing(Method::density_map, s.hair, s.head);
  scene.method = Method::unshadowed;
  sheet.put({0, 0}, picture_of(*drawing, scene), "no self-shadow", "");
  scene.method = Method::density_map;
  sheet.put({1, 0}, picture_of(*drawing, scene), "density map",
            fmt::format("{}^3", scene.shadow.density_map.resolution));
  scene.method = Method::truth;
  sheet.put({2, 0}, picture_of(*make_strand_drawing(Method::truth, s.hair, s.head), scene), "ray-traced truth",
            fmt::format("{} rays per pixel", scene.truth.samples));
  return sheet.image();
}

/// [Bertails2005 Fig. 5]: the filter hides the grid.
Image filter(Scene scene) {
  const Subject s = subject_of(scene, hair::GroomStyle::straight, 15'000);
  Sheet sheet({3, 1}, size_of(scene));
  const auto drawing = make_strand_drawing(Method::density_map, s.hair, s.head);
  scene.method = Method::density_map;
  for (int i = 0; i < 3; ++i) {
    const int resolution = scene.shadow.density_map.resolution;
    scene.shadow.density_map = i < 2 ? DensityMapSettings::printed() : DensityMapSettings{};
    scene.shadow.density_map.resolution = resolution;
    scene.shadow.density_map.filter = i > 0;
    sheet.put({i, 0}, picture_of(*drawing, scene),
              i == 0   ? "as printed, not filtered"
              : i == 1 ? "as printed, filtered"
                       : "corrected",
              fmt::format("{}^3", resolution));
  }
  return sheet.image();
}

/// [Almeida2014 Fig. 3.9]: Kajiya-Kay and Scheuermann on straight and curly hair.
Image lobes(Scene scene) {
  Sheet sheet({scene.hair.empty() ? 4 : 2, 1}, size_of(scene));
  scene.method = Method::density_map;
  int column = 0;
  for (const StrandLobes lobe : {StrandLobes::kajiya_kay, StrandLobes::scheuermann}) {
    for (const hair::GroomStyle style : {hair::GroomStyle::straight, hair::GroomStyle::curly}) {
      const Subject s = subject_of(scene, style, 10'000);
      scene.strands.lobes = lobe;
      sheet.put({column++, 0}, picture_of(*make_strand_drawing(scene.method, s.hair, s.head), scene),
                lobe == StrandLobes::kajiya_kay ? "Kajiya-Kay" : "Scheuermann",
                !scene.hair.empty()                   ? s.hair.name
                : style == hair::GroomStyle::straight ? "straight"
                                                      : "curly");
      if (!scene.hair.empty()) break;
    }
  }
  return sheet.image();
}

using Figure = std::function<Image(Scene)>;

const std::map<std::string, Figure>& figures() {
  static const std::map<std::string, Figure> all{{"resolutions", resolutions},
                                                 {"self-shadow", self_shadow},
                                                 {"filter", filter},
                                                 {"lobes", lobes},
                                                 {"motion", motion_figure},
                                                 {"presets", presets_figure},
                                                 {"ablations", ablations_figure},
                                                 {"head", head_figure}};
  return all;
}

void draw_figure(const console::Verb& verb, const std::string& name, const SceneOptions& options,
                 const std::string& out) {
  const auto figure = figures().find(name);
  if (figure == figures().end()) {
    throw UsageError("there is no figure '" + name +
                     "': ablations, filter, head, lobes, motion, presets, resolutions or self-shadow");
  }
  check_picture_name(out);
  check_writable(out);
  Scene scene = resolve_scene(verb, options);
  if (scene.lights.empty()) throw UsageError("the scene has no light: give one with --light");
  if (verb.count("--size") == 0) scene.image.width = 420, scene.image.height = 480;
  if (verb.count("--samples") == 0) scene.truth.samples = 36;
  if (scene.hair.empty()) {
    // Light hair, lit from the side: what shadows do shows best. Highlights want hair with a colour, lit from where it
    // is seen.
    const bool highlights = name == "ablations" || name == "head";
    if (verb.count("--material") == 0) scene.material = material_preset(highlights ? "red" : "blond");
    if (verb.count("--light") + verb.count("--point-light") == 0)
      scene.lights[0].direction = highlights ? glm::vec3(0.1F, 0.3F, 1) : glm::vec3(0.8F, 0.7F, 0.2F);
  }
  const HeadlessContext context;
  write_image(figure->second(scene), out, {{"Software", "pelage"}, {"pelage:scene", to_json(scene)}});
  if (!console::common().json) std::printf("%s\n", out.c_str());
}

}  // namespace

void add_figure(CLI::App& app) {
  console::Verb* const verb = console::add_verb(
      app, "figure",
      "Draw a figure of the papers anew: resolutions (Bertails 2005, Fig. 8), self-shadow (Fig. 7), filter (Fig. 5), "
      "lobes (Almeida 2014, Fig. 3.9), ablations and head (Xu 2006, Figs. 4 and 5, with errors against the truth); and "
      "of what `simulate` does: motion, presets");
  auto name = std::make_shared<std::string>();
  verb->add_option("figure", *name, "ablations, filter, head, lobes, motion, presets, resolutions or self-shadow")
      ->required();
  auto options = add_scene_options(*verb);
  verb->get_option("input")->required(false)->description(
      "Scene, hairstyle or hair file; without it a groom of 10,000 or 15,000 strands");
  auto out = std::make_shared<std::string>();
  verb->add_output("-o,--out", *out, "Picture to write: .png or .exr")->required();
  console::add_common_options(*verb);
  verb->runs([verb, name, options, out] { draw_figure(*verb, *name, *options, *out); });
}

}  // namespace pelage::app
