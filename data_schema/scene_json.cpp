// Scene and material as JSON (schemas/scene.schema.json, schemas/material.schema.json).
#include <algorithm>
#include <cmath>
#include <glm/geometric.hpp>

#include "pelage/data_schema/bake_settings_fields.h"
#include "pelage/data_schema/errors.h"
#include "pelage/data_schema/json_file.h"
#include "pelage/data_schema/scene.h"
#include "pelage/data_schema/simulation_settings_fields.h"
#include "pelage/data_schema/validate.h"

namespace pelage::json_fields {

template <>
inline constexpr std::array<std::string_view, 3> kNames<SelfShadow>{"none", "paper", "light"};
template <>
inline constexpr std::array<std::string_view, 3> kNames<EffectState>{"auto", "on", "off"};
template <>
inline constexpr std::array<std::string_view, 3> kNames<DrawOrder>{"clusters", "patches", "exact"};
template <>
inline constexpr std::array<std::string_view, 4> kNames<RecordsFrom>{"database", "own-alpha", "direct", "literal-key"};

template <>
inline constexpr std::array<std::string_view, 6> kNames<Method>{"satf",           "density-map", "deep-opacity",
                                                                "opacity-shadow", "unshadowed",  "truth"};
template <>
inline constexpr std::array<std::string_view, 3> kNames<StrandShape>{"lines", "ribbons", "auto"};
template <>
inline constexpr std::array<std::string_view, 3> kNames<StrandOrder>{"exact", "sorted", "weighted"};
template <>
inline constexpr std::array<std::string_view, 2> kNames<StrandLobes>{"kajiya-kay", "scheuermann"};
template <>
inline constexpr std::array<std::string_view, 2> kNames<ShadowAt>{"vertex", "fragment"};
template <>
inline constexpr std::array<std::string_view, 2> kNames<Backdrop>{"plain", "gradient"};

}  // namespace pelage::json_fields

namespace pelage {

template <class F>
void fields(F&& f, Camera& c) {
  f("eye", c.eye);
  f("target", c.target);
  f("up", c.up);
  f("fov_deg", c.fov_deg);
}

template <class F>
void fields(F&& f, Light& l) {
  f("direction", l.direction);
  f("position", l.position);
  f("colour", l.colour);
  f("intensity", l.intensity);
  f("size_deg", l.size_deg);
}

template <class F>
void fields(F&& f, HairMaterial& m) {
  f("name", m.name);
  f("diffuse_colour", m.diffuse_colour);
  f("primary_colour", m.primary_colour);
  f("secondary_colour", m.secondary_colour);
  f("diffuse", m.diffuse);
  f("primary", m.primary);
  f("secondary", m.secondary);
  f("primary_exponent", m.primary_exponent);
  f("secondary_exponent", m.secondary_exponent);
  f("primary_shift", m.primary_shift);
  f("secondary_shift", m.secondary_shift);
  f("ambient", m.ambient);
  f("variation", m.variation);
}

template <class F>
void fields(F&& f, SatfSettings& s) {
  f("diffuse", s.diffuse);
  f("primary_highlight", s.primary_highlight);
  f("secondary_highlight", s.secondary_highlight);
  f("self_shadow", s.self_shadow);
  f("self_shadow_strength", s.self_shadow_strength);
  f("global_shadow", s.global_shadow);
  f("shadow_resolution", s.shadow_resolution);
  f("fade_ends", s.fade_ends);
  f("drift", s.drift);
  f("curvature", s.curvature);
  f("draw_order", s.draw_order);
  f("records", s.records);
  f("neighbours", s.neighbours);
}

template <class F>
void fields(F&& f, StrandSettings& s) {
  f("shape", s.shape);
  f("order", s.order);
  f("lobes", s.lobes);
  f("shadow_at", s.shadow_at);
  f("smoothing", s.smoothing);
  f("diffuse", s.diffuse);
  f("primary_highlight", s.primary_highlight);
  f("secondary_highlight", s.secondary_highlight);
  f("azimuth", s.azimuth);
}

template <class F>
void fields(F&& f, DensityMapSettings& s) {
  f("resolution", s.resolution);
  f("factor", s.factor);
  f("area", s.area);
  f("split", s.split);
  f("trilinear_deposit", s.trilinear_deposit);
  f("centred_lookup", s.centred_lookup);
  f("interpolate_depth", s.interpolate_depth);
  f("footprint_m", s.footprint_m);
  f("filter", s.filter);
  f("fitted", s.fitted);
  f("extent_m", s.extent_m);
  f("adaptive_slices", s.adaptive_slices);
}

template <class F>
void fields(F&& f, OpacityMapSettings& s) {
  f("resolution", s.resolution);
  f("layers", s.layers);
  f("slices", s.slices);
}

template <class F>
void fields(F&& f, ShadowSettings& s) {
  f("density_map", s.density_map);
  f("opacity_map", s.opacity_map);
}

template <class F>
void fields(F&& f, TruthSettings& s) {
  f("rays", s.rays);
  f("footprint_m", s.footprint_m);
  f("samples", s.samples);
  f("stop_below", s.stop_below);
  f("azimuth", s.azimuth);
}

template <class F>
void fields(F&& f, ImageSettings& i) {
  f("width", i.width);
  f("height", i.height);
  f("supersampling", i.supersampling);
  f("exposure", i.exposure);
  f("background", i.background);
  f("backdrop", i.backdrop);
}

template <class F>
void fields(F&& f, Scene& s) {
  f("hair", s.hair);
  f("head", s.head);
  f("database", s.database);
  f("unit", s.unit);
  f("up", s.up);
  f("curve", s.curve);
  f("diameter_um", s.diameter_um);
  f("opacity", s.opacity);
  f("clusters", s.clusters);
  f("division", s.division);
  f("camera", s.camera);
  f("lights", s.lights);
  f("material", s.material);
  f("method", s.method);
  f("satf", s.satf);
  f("strands", s.strands);
  f("shadow", s.shadow);
  f("truth", s.truth);
  f("image", s.image);
  f("simulation", s.simulation);
  f("effects", s.effects);
  f("bake", s.bake);
}

namespace {

using nlohmann::json;
using nlohmann::ordered_json;

// The keys that are not plain values: an absent camera, "transparent", the name of a material or simulation.
struct SceneReader {
  const json& document;

  template <class T>
  void operator()(const char* key, T& member) const {
    if (const auto found = document.find(key); found != document.end()) read(*found, member);
  }
  void read(const json& j, std::optional<Camera>& camera) const { json_fields::get(j, camera.emplace()); }
  void read(const json& j, HairMaterial& material) const {
    if (j.is_string())
      material = material_preset(j.get<std::string>());
    else
      json_fields::get(j, material);
  }
  void read(const json& j, SimulationSettings& simulation) const {
    const json name = j.is_string() ? j : j.value("name", json());
    if (name.is_string()) simulation = simulation_preset(name.get<std::string>());
    if (j.is_object()) json_fields::get(j, simulation);
  }
  void read(const json& j, ImageSettings& image) const { fields(SceneReader{j}, image); }
  void read(const json& j, std::optional<glm::vec3>& background) const {
    background.reset();
    if (!j.is_string()) json_fields::get(j, background.emplace());
  }
  template <class T>
  void read(const json& j, T& value) const {
    json_fields::get(j, value);
  }
};

struct SceneWriter {
  ordered_json& document;

  template <class T>
  void operator()(const char* key, T& member) const {
    write(document, key, member);
  }
  static void write(ordered_json& j, const char* key, std::optional<Camera>& camera) {
    if (camera) j[key] = json_fields::put(*camera);
  }
  static void write(ordered_json& j, const char* key, ImageSettings& image) {
    fields(SceneWriter{j[key] = ordered_json::object()}, image);
  }
  static void write(ordered_json& j, const char* key, std::optional<glm::vec3>& background) {
    j[key] = background ? json_fields::put(*background) : ordered_json("transparent");
  }
  template <class T>
  static void write(ordered_json& j, const char* key, T& value) {
    j[key] = json_fields::put(std::as_const(value));
  }
};

void check_camera(const Camera& camera, const std::string& where) {
  const glm::vec3 view = camera.target - camera.eye;
  if (glm::length(view) < 1e-6F) throw InputError(where, "camera: eye and target coincide: move one");
  const float length = glm::length(camera.up);
  if (length < 1e-6F || glm::length(glm::cross(view, camera.up)) < 1e-6F * glm::length(view) * length)
    throw InputError(where, "camera: up is parallel to the view or has no length: choose another");
}

void check(const Scene& scene, const std::string& where) {
  if (scene.camera) check_camera(*scene.camera, where);
  for (std::size_t i = 0; i < scene.lights.size(); ++i)
    if (!scene.lights[i].position && glm::length(scene.lights[i].direction) < 1e-6F)
      throw InputError(where, "lights/" + std::to_string(i) + ": direction has no length");
  const std::size_t capsules = scene.simulation.collision.capsules.size();
  for (const auto& [name, state] : scene.effects)
    if (name.starts_with("capsule-") && std::stoul(name.substr(8)) >= capsules)
      throw InputError(where, "effects/" + name + ": simulation.collision has " + std::to_string(capsules) +
                                  " capsules, counted from 0");
  check(scene.bake, where);
}

/// A path of the scene file, seen from where the program runs.
void resolve_path(std::string& path, const std::filesystem::path& scene_file) {
  if (!path.empty()) path = (scene_file.parent_path() / path).lexically_normal().string();
}

HairMaterial preset(std::string name, glm::vec3 diffuse, glm::vec3 secondary) {
  HairMaterial material;
  material.name = std::move(name);
  material.diffuse_colour = diffuse;
  material.secondary_colour = secondary;
  return material;
}

const std::vector<HairMaterial>& presets() {
  static const std::vector<HairMaterial> all = {preset("black", {0.012F, 0.010F, 0.009F}, {0.06F, 0.045F, 0.035F}),
                                                preset("brown", {0.075F, 0.036F, 0.016F}, {0.22F, 0.10F, 0.04F}),
                                                preset("blond", {0.30F, 0.19F, 0.085F}, {0.55F, 0.36F, 0.16F}),
                                                preset("red", {0.17F, 0.048F, 0.015F}, {0.40F, 0.13F, 0.04F}),
                                                preset("grey", {0.20F, 0.195F, 0.19F}, {0.42F, 0.41F, 0.40F})};
  return all;
}

}  // namespace

Scene scene_from_json(const std::string& text, const std::string& where) {
  const json document = parse_json(text, where);
  validate(document, "scene", where);
  Scene scene;
  fields(SceneReader{document}, scene);
  check(scene, where);
  return scene;
}

Scene load_scene(const std::filesystem::path& file) {
  Scene scene = scene_from_json(read_text(file), file.string());
  for (std::string* path : {&scene.hair, &scene.head}) resolve_path(*path, file);
  if (scene.database != kGenericDatabase) resolve_path(scene.database, file);
  return scene;
}

std::string to_json(const Scene& scene) {
  ordered_json document = {{"version", 1}};
  Scene copy = scene;
  fields(SceneWriter{document}, copy);
  return json_fields::text_of(document);
}

HairMaterial material_preset(const std::string& name) {
  std::vector<std::string> names;
  for (const HairMaterial& material : presets()) {
    if (material.name == name) return material;
    names.push_back(material.name);
  }
  throw UsageError("there is no material \"" + name + "\": the nearest of black, brown, blond, red, grey is \"" +
                   nearest_word(name, names) + "\"");
}

HairMaterial load_material(const std::filesystem::path& file) {
  const json document = parse_json(read_text(file), file.string());
  validate(document, "material", file.string());
  HairMaterial material;
  json_fields::get(document, material);
  return material;
}

}  // namespace pelage
