#include "pelage/app/scene_options.h"

#include <CLI/CLI.hpp>
#include <algorithm>
#include <cmath>
#include <filesystem>
#include <fstream>
#include <glm/common.hpp>
#include <map>
#include <nlohmann/json.hpp>
#include <sstream>
#include <tuple>

#include "pelage/app/choose.h"
#include "pelage/console/options.h"
#include "pelage/console/verb.h"
#include "pelage/data_schema/errors.h"
#include "pelage/data_schema/lighting.h"
#include "pelage/data_schema/scene_values.h"
#include "pelage/data_schema/validate.h"
#include "pelage/effects/effect.h"
#include "pelage/render/renderer.h"

namespace pelage::app {
namespace {

constexpr float kMost = 1e6F;  // of a number of a light or camera; as in schemas/scene.schema.json

std::vector<float> numbers(const std::string& text, const std::string& option, std::size_t fewest, std::size_t most) {
  std::vector<float> values;
  std::istringstream in(text);
  for (std::string part; std::getline(in, part, ',');) {
    std::size_t used = 0;
    float value = NAN;
    try {
      value = std::stof(part, &used);
    } catch (const std::exception&) {
      used = 0;
    }
    if (used == 0 || used != part.size() || !std::isfinite(value)) {
      throw UsageError(option + ": '" + part + "' in '" + text + "' is not a finite number");
    }
    if (std::abs(value) > kMost) {
      throw UsageError(option + ": '" + part + "' in '" + text + "' is beyond 1000000, the most that a scene holds");
    }
    values.push_back(value);
  }
  if (values.size() < fewest || values.size() > most) {
    throw UsageError(option + ": '" + text + "' has " + std::to_string(values.size()) + " numbers; give " +
                     std::to_string(fewest) + (most > fewest ? " to " + std::to_string(most) : "") +
                     ", separated by commas");
  }
  return values;
}

/// "1280x720"
void parse_size(const std::string& text, ImageSettings& image) {
  const std::size_t x = text.find('x');
  int used_w = 0, used_h = 0;
  const bool good = x != std::string::npos && std::sscanf(text.c_str(), "%d%n", &image.width, &used_w) == 1 &&
                    static_cast<std::size_t>(used_w) == x &&
                    std::sscanf(text.c_str() + x + 1, "%d%n", &image.height, &used_h) == 1 &&
                    x + 1 + static_cast<std::size_t>(used_h) == text.size();
  if (!good || image.width < 1 || image.height < 1 || image.width > 16384 || image.height > 16384) {
    throw UsageError("--size: '" + text + "' is not WIDTHxHEIGHT with 1 to 16384 pixels each, e.g. 1280x720");
  }
}

Camera parse_camera(const std::string& text) {
  const auto v = numbers(text, "--camera", 6, 7);
  Camera camera;
  camera.eye = {v[0], v[1], v[2]};
  camera.target = {v[3], v[4], v[5]};
  if (v.size() == 7) camera.fov_deg = v[6];
  if (camera.eye == camera.target) throw UsageError("--camera: eye and target are the same point");
  if (!(camera.fov_deg > 0 && camera.fov_deg < 170))
    throw UsageError("--camera: the field of view must lie between 0 and 170 degrees");
  return camera;
}

/// "x,y,z[,intensity]": a direction for --light, a place for --point-light.
Light parse_light(const std::string& text, const std::string& option) {
  const auto v = numbers(text, option, 3, 4);
  Light light;
  if (option == "--point-light")
    light.position = {v[0], v[1], v[2]};
  else
    light.direction = {v[0], v[1], v[2]};
  if (v.size() == 4) light.intensity = v[3];
  if (light.direction == glm::vec3(0.0F))
    throw UsageError("--light: the direction is zero; give one towards the light, e.g. 0.4,0.7,0.6");
  if (light.intensity < 0) throw UsageError(option + ": the intensity is negative");
  return light;
}

/// A direction of any length, of a length whose square is a float.
void lengthen(Light& light) {
  const glm::vec3 size = glm::abs(light.direction);
  const float longest = std::max({size.x, size.y, size.z});
  if (longest > 0 && longest < 1e-9F) light.direction /= longest;
}

glm::vec3 srgb_colour(const std::string& text) {
  unsigned rgb = 0;
  int used = 0;
  if (text.size() != 7 || text[0] != '#' || std::sscanf(text.c_str() + 1, "%6x%n", &rgb, &used) != 1 || used != 6) {
    throw UsageError("--background: '" + text + "' is neither 'transparent' nor a colour like #d8dce0");
  }
  const auto linear = [](unsigned byte) {
    const float x = static_cast<float>(byte & 255U) / 255.0F;
    return x <= 0.04045F ? x / 12.92F : std::pow((x + 0.055F) / 1.055F, 2.4F);
  };
  return {linear(rgb >> 16), linear(rgb >> 8), linear(rgb)};
}

/// What --on, --off, --auto name. "all" is every one; a name beside it wins. @throws UsageError naming the nearest,
/// or for one that is asked to be two things
void set_effects(const SceneOptions& o, Scene& scene) {
  const std::vector<std::string> known = effect_names(scene);
  const std::tuple<const char*, EffectState, const std::vector<std::string>&> options[] = {
      {"--auto", EffectState::automatic, o.effects_auto},
      {"--on", EffectState::on, o.effects_on},
      {"--off", EffectState::off, o.effects_off}};
  for (const auto& [option, state, names] : options) {
    if (std::find(names.begin(), names.end(), "all") == names.end()) continue;
    for (const std::string& each : known) scene.effects[each] = state;
  }
  std::map<std::string, std::string> asked_by;
  for (const auto& [option, state, names] : options) {
    for (const std::string& name : names) {
      if (const auto first = asked_by.emplace(name, option).first; first->second != option)
        throw UsageError(name + " is named by " + first->second + " and " + option + ": give one of them");
      if (name == "all") continue;
      if (std::find(known.begin(), known.end(), name) == known.end())
        throw UsageError(std::string(option) + ": there is no effect '" + name + "'; the nearest is '" +
                         nearest_word(name, known) + "'");
      scene.effects[name] = state;
    }
  }
}

/// What only strand by strand methods have.
void set_strand_options(const CLI::App& verb, const SceneOptions& o, Scene& scene) {
  const auto given = [&](const char* name) { return verb.count(name) > 0; };
  if (given("--density-map")) {
    scene.shadow.density_map =
        choose<DensityMapSettings>({{"corrected", DensityMapSettings{}}, {"printed", DensityMapSettings::printed()}},
                                   o.density_map, "--density-map");
  }
  if (given("--shadow-resolution"))
    scene.shadow.density_map.resolution = scene.shadow.opacity_map.resolution = o.shadow_resolution;
  if (given("--shape")) {
    scene.strands.shape = choose<StrandShape>(
        {{"lines", StrandShape::lines}, {"ribbons", StrandShape::ribbons}, {"auto", StrandShape::automatic}}, o.shape,
        "--shape");
  }
  if (given("--lobes")) {
    scene.strands.lobes = choose<StrandLobes>(
        {{"kajiya-kay", StrandLobes::kajiya_kay}, {"scheuermann", StrandLobes::scheuermann}}, o.lobes, "--lobes");
  }
  if (given("--shadow-at")) {
    scene.strands.shadow_at =
        choose<ShadowAt>({{"vertex", ShadowAt::vertex}, {"fragment", ShadowAt::fragment}}, o.shadow_at, "--shadow-at");
  }
  if (given("--azimuth")) scene.strands.azimuth = o.azimuth;
  if (given("--smoothing")) scene.strands.smoothing = o.smoothing;
  if (given("--samples")) scene.truth.samples = o.samples;
}

void set_lighting_option(const CLI::App& verb, const std::string& name, Scene& scene) {
  for (const char* const option : {"--light", "--point-light"}) {
    if (verb.count(option) == 0) continue;
    throw UsageError("--lighting and " + std::string(option) +
                     " both say where light comes from: give one of them, or change single lights with --set "
                     "lights.0.intensity=2");
  }
  set_lighting(scene,
               choose<Lighting>({{"paper", Lighting::paper}, {"portrait", Lighting::portrait}}, name, "--lighting"));
}

void set_order(const std::string& order, Scene& scene) {
  if (scene.method == Method::satf) {
    scene.satf.draw_order = choose<DrawOrder>(
        {{"patches", DrawOrder::patches}, {"clusters", DrawOrder::clusters}, {"exact", DrawOrder::exact}}, order,
        "--order");
  } else {
    scene.strands.order = choose<StrandOrder>(
        {{"exact", StrandOrder::exact}, {"sorted", StrandOrder::sorted}, {"weighted", StrandOrder::weighted}}, order,
        "--order");
  }
}

/// A scene file is JSON with a "hair" key; a hairstyle file has a list of clusters instead.
bool is_scene_file(const std::filesystem::path& file) {
  if (file.extension() != ".json") return false;
  std::ifstream in(file);
  if (!in) throw InputError(file.string(), "cannot be read");
  const auto json = nlohmann::json::parse(in, nullptr, false);
  return json.is_object() && !(json.contains("clusters") && json["clusters"].is_array());
}

/// Is the input made of clusters, or does an option speak of nothing else?
bool asks_for_satf(const CLI::App& verb, const SceneOptions& o) {
  constexpr const char* kOfSatf[] = {"--database", "--records", "--neighbours", "--bake-sectors", "--clusters",
                                     "--layers",   "--sectors", "--plates",     "--self-shadow"};
  return std::filesystem::path(o.input).extension() == ".json" || o.order == "patches" || o.order == "clusters" ||
         std::any_of(std::begin(kOfSatf), std::end(kOfSatf),
                     [&](const char* option) { return verb.count(option) > 0; });
}

void check_input(const std::filesystem::path& file) {
  if (!std::filesystem::exists(file)) throw InputError(file.string(), "no such file");
  if (std::filesystem::is_directory(file))
    throw InputError(file.string(), "is a folder; give a scene, hairstyle or hair file");
}

/// What a hairstyle file has decided already cannot be asked for again.
void check_hairstyle_options(const CLI::App& verb, const Scene& scene) {
  if (std::filesystem::path(scene.hair).extension() != ".json") return;
  for (const char* const option : {"--clusters", "--layers", "--sectors", "--plates", "--diameter-um", "--opacity"}) {
    if (verb.count(option) == 0) continue;
    throw UsageError(std::string(option) + " is for hair files; " + scene.hair +
                     " is a hairstyle: change it there, or run `pelage cluster` with " + option);
  }
}

}  // namespace

std::shared_ptr<SceneOptions> add_scene_options(console::Verb& verb) {
  auto o = std::make_shared<SceneOptions>();
  verb.add_input("input", o->input,
                 "Scene file (.json), hairstyle file (.json) or hair file (any that `pelage info` reads)")
      ->required();
  verb.add_input("--head", o->head, "Head or body under the hair (OBJ, same unit and axes as the hair)");
  verb.add_option("--unit", o->unit, "Unit of hair and head: m, cm, mm, in [m]");
  verb.add_option("--up", o->up, "Axis that points up in hair and head: x, y, z [y]");
  verb.add_option("--curve", o->curve, "What a hair file's vertices are: polyline, bspline [polyline]");
  verb.add_option("--diameter-um", o->diameter_um, "Drawn diameter of a hair file's fibres [the file's, or by number]")
      ->check(console::finite(0.1, 10'000));
  verb.add_option("--opacity", o->opacity,
                  "Share of a crossing ray that a fibre of a hair file stops [the file's, or 0.6]")
      ->check(console::finite(0.001, 1));
  verb.add_input("--material", o->material, "black, brown, blond, red, grey, or a material file [brown]");
  verb.add_option(
          "--colour-variation", o->colour_variation,
          "How much colours vary from strand to strand, 0 to 1; the mean stays. satf draws clusters, which have "
          "the mean [0]")
      ->check(console::finite(0, 1));
  verb.add_option("--camera", o->camera,
                  "Eye and target in metres, field of view in degrees: x,y,z,x,y,z[,fov] [framed]");
  verb.add_option("--light", o->lights,
                  "Direction towards a light and its intensity: x,y,z[,i]; up to 4 [0.4,0.7,0.6,1]");
  verb.add_option("--point-light", o->point_lights,
                  "Position of a point light in metres and its irradiance at 1 m: x,y,z[,i]");
  verb.add_option(
      "--lighting", o->lighting,
      "paper: the one light of the papers; portrait: key, fill and rim light, soft shadows on the head and a "
      "grey backdrop, for the framed camera. In place of a scene file's lights and background; lights of "
      "your own do not go with it, a --background does [paper]");
  verb.add_option(
      "--method", o->method,
      "What draws: satf; strand by strand, shadowed by density-map, deep-opacity, opacity-shadow or "
      "unshadowed; truth: ray-traced [density-map; satf for a hairstyle file, or where an option is of satf alone]");
  verb.add_option("--exposure", o->exposure, "Gain before the sRGB curve")
      ->capture_default_str()
      ->check(console::finite(1e-6, 1e6));
  verb.add_option("--background", o->background, "transparent, or a colour like #d8dce0 [#ededed]");
  verb.add_option("--size", o->size, "Pixels, WIDTHxHEIGHT [1280x720]");
  verb.add_option("--supersampling", o->supersampling, "Samples per pixel and side, 1 to 8")
      ->capture_default_str()
      ->check(CLI::Range(1, 8));
  verb.add_input("--database", o->database,
                 "HRIR database, or generic: one for any hair is baked and cached [one adapted to the hair is]");
  verb.add_option(
      "--records", o->records,
      "database; own-alpha: opacity from the hair itself, reflectance from the database; direct: trace every "
      "sector, literal-key: one search over features and both angles (slow, to compare) [own-alpha]");
  verb.add_option("--neighbours", o->neighbours, "Records blended per sector, 1 to 8")
      ->capture_default_str()
      ->check(CLI::Range(1, 8));
  verb.add_option("--bake-sectors", o->bake_sectors, "Records of the adapted database, 1 to 1000000 [1000]")
      ->check(CLI::Range(1, 1000000));
  verb.add_option("--clusters", o->clusters, "Clusters fitted to a hair file, 1 to 10000")
      ->capture_default_str()
      ->check(CLI::Range(1, 10000));
  verb.add_option("--layers", o->layers, "Layers of a cluster, 1 to 32 [3]")->check(CLI::Range(1, 32));
  verb.add_option("--sectors", o->sectors, "Sectors of the outermost layer, 3 to 256 [24]")->check(CLI::Range(3, 256));
  verb.add_option("--plates", o->plates, "HSVs along a cluster, 2 to 512 [24]")->check(CLI::Range(2, 512));
  verb.add_option("--self-shadow", o->self_shadow, "light: along the light's ray; paper: eq. 12; none [light]");
  verb.add_option(
      "--order", o->order,
      "Drawing order. satf: patches, clusters, exact (per pixel) [patches]; strands: sorted, exact, weighted [sorted]");
  verb.add_option("--density-map", o->density_map, "The density map as the paper printed it, or corrected [corrected]");
  verb.add_option("--shadow-resolution", o->shadow_resolution,
                  "Cells of the density map along its longest side, or pixels of an opacity map [128, 256]")
      ->check(CLI::Range(1, 1024));
  verb.add_option("--shape", o->shape,
                  "Strands as camera-facing ribbons, lines one sample wide, or auto: lines while even the nearest "
                  "fibre is thinner than a sample [auto]");
  verb.add_option("--lobes", o->lobes,
                  "Highlights of strands: scheuermann (two, shifted), kajiya-kay (one) [scheuermann]");
  verb.add_flag(
      "--azimuth,!--no-azimuth", o->azimuth,
      "Strands reflect around themselves as the truth's do: brighter towards the light, dark against it [on]");
  verb.add_option("--shadow-at", o->shadow_at, "Where strands look their shadow up: vertex, fragment [vertex]");
  verb.add_option("--smoothing", o->smoothing, "Catmull-Rom pieces per segment of a strand")
      ->capture_default_str()
      ->check(CLI::Range(1, 32));
  verb.add_option("--samples", o->samples, "Rays per pixel of the truth")
      ->capture_default_str()
      ->check(CLI::Range(1, 65536));
  verb.add_option(
          "--off", o->effects_off,
          "Effects to leave out, as if their settings were zero; all: every one; `pelage render --explain` names them")
      ->delimiter(',');
  verb.add_option("--on", o->effects_on, "Effects to run even where the scene does not call for them; all: every one")
      ->delimiter(',');
  verb.add_option("--auto", o->effects_auto, "Effects to run where the scene calls for them, as is the rule")
      ->delimiter(',');
  verb.add_option("--set", o->values,
                  "PLACE=VALUE: any value of a scene file, e.g. shadow.density_map.resolution=64; may be repeated, "
                  "wins over the other options")
      ->allow_extra_args(false);
  return o;
}

Scene resolve_scene(const console::Verb& verb, const SceneOptions& o) {
  const auto given = [&](const char* name) { return verb.count(name) > 0; };
  Scene scene;
  if (given("input")) check_input(o.input);
  if (is_scene_file(o.input)) {
    scene = load_scene(o.input);
  } else {
    scene.hair = o.input;
    if (asks_for_satf(verb, o)) scene.method = Method::satf;
  }
  if (given("--head")) scene.head = o.head;
  if (given("--database")) scene.database = o.database;
  if (given("--unit")) scene.unit = o.unit;
  if (given("--up")) scene.up = o.up;
  if (given("--material")) {
    scene.material = std::filesystem::path(o.material).extension() == ".json" ? load_material(o.material)
                                                                              : material_preset(o.material);
  }
  if (given("--camera")) scene.camera = parse_camera(o.camera);
  if (given("--curve")) scene.curve = o.curve;
  if (given("--diameter-um")) scene.diameter_um = o.diameter_um;
  if (given("--opacity")) scene.opacity = o.opacity;
  if (given("--method")) {
    scene.method = choose<Method>({{"satf", Method::satf},
                                   {"density-map", Method::density_map},
                                   {"deep-opacity", Method::deep_opacity},
                                   {"opacity-shadow", Method::opacity_shadow},
                                   {"unshadowed", Method::unshadowed},
                                   {"truth", Method::truth}},
                                  o.method, "--method");
  }
  if (given("--colour-variation")) scene.material.variation = o.colour_variation;
  if (given("--lighting")) set_lighting_option(verb, o.lighting, scene);
  if (given("--light") || given("--point-light")) {
    scene.lights.clear();
    for (const std::string& text : o.lights) scene.lights.push_back(parse_light(text, "--light"));
    for (const std::string& text : o.point_lights) scene.lights.push_back(parse_light(text, "--point-light"));
  }
  if (given("--exposure")) scene.image.exposure = o.exposure;
  if (given("--background")) {
    scene.image.background =
        o.background == "transparent" ? std::nullopt : std::optional<glm::vec3>(srgb_colour(o.background));
  }
  if (given("--size")) parse_size(o.size, scene.image);
  if (given("--supersampling")) scene.image.supersampling = o.supersampling;
  if (given("--records")) {
    scene.satf.records = choose<RecordsFrom>({{"database", RecordsFrom::database},
                                              {"direct", RecordsFrom::direct},
                                              {"own-alpha", RecordsFrom::own_alpha},
                                              {"literal-key", RecordsFrom::literal_key}},
                                             o.records, "--records");
  }
  if (given("--neighbours")) scene.satf.neighbours = o.neighbours;
  if (given("--bake-sectors")) scene.bake.sectors = o.bake_sectors;
  if (given("--clusters")) scene.clusters = o.clusters;
  if (given("--layers")) scene.division.layers = o.layers;
  if (given("--sectors")) scene.division.sectors = o.sectors;
  if (given("--plates")) scene.division.plates = o.plates;
  if (given("--self-shadow")) {
    scene.satf.self_shadow =
        choose<SelfShadow>({{"light", SelfShadow::light}, {"paper", SelfShadow::paper}, {"none", SelfShadow::none}},
                           o.self_shadow, "--self-shadow");
  }
  set_strand_options(verb, o, scene);
  if (given("--order")) set_order(o.order, scene);
  set_effects(o, scene);
  check_hairstyle_options(verb, scene);
  scene = with_values(scene, o.values);
  verb.check_files(
      {{"the scene's hair", scene.hair}, {"the scene's head", scene.head}, {"the scene's database", scene.database}});
  for (Light& light : scene.lights) lengthen(light);
  if (scene.lights.size() > kMaxLights) {
    throw UsageError("the scene has " + std::to_string(scene.lights.size()) + " lights; at most " +
                     std::to_string(kMaxLights) + " are drawn");
  }
  return scene;
}

void limit_size(ImageSettings& image, int width, int height) noexcept {
  const double shrink =
      std::max({1.0, static_cast<double>(image.width) / width, static_cast<double>(image.height) / height});
  image.width = std::max(1, static_cast<int>(image.width / shrink + 0.5));
  image.height = std::max(1, static_cast<int>(image.height / shrink + 0.5));
}

}  // namespace pelage::app
