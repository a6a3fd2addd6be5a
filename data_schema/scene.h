// Scene: what `pelage render` and `pelage view` draw, and how. Every field has a default that gives a sensible picture
// of a bare hair file. File format: schemas/scene.schema.json.
#pragma once

#include <array>
#include <filesystem>
#include <glm/vec3.hpp>
#include <glm/vec4.hpp>
#include <map>
#include <optional>
#include <string>
#include <vector>

#include "pelage/data_schema/bake_settings.h"
#include "pelage/data_schema/hairstyle.h"
#include "pelage/data_schema/simulation_settings.h"
#include "pelage/data_schema/strand_settings.h"

namespace pelage {

struct Camera {
  glm::vec3 eye{0, 0, 1};     // metres
  glm::vec3 target{0, 0, 0};  // metres
  glm::vec3 up{0, 1, 0};
  float fov_deg = 30;  // vertical field of view, (0, 170)
  bool operator==(const Camera&) const = default;
};

/// Directional light, or, where `position` is set, a point light: its irradiance falls off as (1 m / distance)^2.
struct Light {
  glm::vec3 direction{0.4F, 0.7F, 0.6F};  // towards the light, any length > 0; of no meaning for a point light
  std::optional<glm::vec3> position;      // metres
  glm::vec3 colour{1.0F};                 // linear RGB
  float intensity = 1.0F;                 // >= 0; irradiance, of a point light at 1 m
  float size_deg = 0.0F;  // across a directional light's disc, [0, 90]; shadows of hair on the head are as soft as that
  bool operator==(const Light&) const = default;
};

/// Hair material [Xu2006 eqs. 8-11; Scheuermann2004]. Colours are linear RGB.
struct HairMaterial {
  std::string name = "brown";
  glm::vec3 diffuse_colour{0.075F, 0.036F, 0.016F};  // phi^dif
  glm::vec3 primary_colour{1.0F};                    // phi^speI: the light's colour, so white
  glm::vec3 secondary_colour{0.22F, 0.10F, 0.04F};   // phi^speII: the hair's colour
  float diffuse = 1.0F;                              // kappa^dif >= 0
  float primary = 0.16F;                             // kappa^speI >= 0
  float secondary = 0.40F;                           // kappa^speII >= 0
  float primary_exponent = 120;                      // kappa^h of the primary highlight, [1, 10000]
  float secondary_exponent = 24;                     // of the secondary
  float primary_shift = 0.12F;                       // tangent_shift towards the tip (s of eq. 10), [0, 1]
  float secondary_shift = 0.20F;                     // towards the root (s of eq. 11), [0, 1]
  float ambient = 0.15F;   // unshadowed share of the diffuse colour [Bertails2005 section 3.3]
  float variation = 0.0F;  // of the hair's colours from strand to strand, [0, 1]: strand_tint.h
  bool operator==(const HairMaterial&) const = default;
};

enum class SelfShadow { none, paper, light };       // eq. 12 with exp | the light's ray through the outer layers
enum class DrawOrder { clusters, patches, exact };  // DESIGN section 5
/// Rungs of the accuracy ladder, DESIGN section 4. literal_key: features and both angles in one search [Xu2006].
enum class RecordsFrom { database, own_alpha, direct, literal_key };

/// Settings of the SATF runtime. Each effect can be switched off.
struct SatfSettings {
  bool diffuse = true, primary_highlight = true, secondary_highlight = true;
  SelfShadow self_shadow = SelfShadow::light;
  float self_shadow_strength = 1.0F;  // kappa^shadow of eq. 12, >= 0
  bool global_shadow = true;          // shadows between clusters (light-oriented density map)
  int shadow_resolution = 96;         // cells along the longest side of the map, [8, 512]
  bool fade_ends = true;              // open cluster ends fade
  bool drift = true;                  // move records by the HSV's mean drift before interpolating (DESIGN section 5)
  bool curvature = true;              // chord of the ring instead of a flat slab near silhouettes
  DrawOrder draw_order = DrawOrder::patches;
  RecordsFrom records = RecordsFrom::own_alpha;
  int neighbours = 4;  // records blended per sector, [1, 8]
  bool operator==(const SatfSettings&) const = default;
};

/// What draws the picture. All but satf draw strand by strand.
enum class Method { satf, density_map, deep_opacity, opacity_shadow, unshadowed, truth };

enum class Backdrop { plain, gradient };  // the background's colour everywhere | fading to the corners: image/tone.h

struct ImageSettings {
  int width = 1280, height = 720;                          // pixels, [1, 16384]
  int supersampling = 2;                                   // samples per pixel and side, [1, 8]
  float exposure = 1.0F;                                   // linear gain before the sRGB curve, > 0
  std::optional<glm::vec3> background = glm::vec3(0.85F);  // linear RGB; none: transparent
  Backdrop backdrop = Backdrop::plain;                     // of a background that is not transparent
  bool operator==(const ImageSettings&) const = default;
};

/// What a scene asks of an effect. automatic: run where the scene calls for it, skipped within a stated bound
/// (runtime/effects, DESIGN section 8); on: run whatever it may matter; off: as if its setting were zero.
enum class EffectState { automatic, on, off };
/// By the effect's name (schemas/scene.schema.json); those not named are automatic.
using EffectStates = std::map<std::string, EffectState>;

/// As a scene's database: random sectors, baked with the scene's settings and cached.
inline constexpr const char* kGenericDatabase = "generic";

struct Scene {
  std::string hair;        // hair file or hairstyle file, relative to the scene file
  std::string head;        // OBJ or empty
  std::string database;    // or empty: an adapted one is baked and cached; kGenericDatabase: one for any hair is
  std::string unit = "m";  // of hair and head: m, cm, mm, in
  std::string up = "y";    // of hair and head: x, y, z
  std::string curve = "polyline";  // what the hair file's vertices are: polyline, bspline
  float diameter_um = 0;           // of a hair file's fibres; 0: the file's, or the default for their number
  float opacity = 0;               // of a hair file's fibres, [0, 1]; 0: the file's, or kDefaultOpacity
  std::optional<Camera> camera;    // none: framed
  std::vector<Light> lights{Light{}};
  HairMaterial material;
  Method method = Method::density_map;
  SatfSettings satf;
  StrandSettings strands;
  ShadowSettings shadow;
  TruthSettings truth;
  ImageSettings image;
  SimulationSettings simulation = simulation_preset("hold-shape");
  EffectStates effects;
  BakeSettings bake;
  int clusters = 150;  // when hair is strands: clusters to fit, [1, 10000]
  Division division;   // when hair is strands
};

/// Reads and validates a scene. Relative paths are resolved against the scene file's folder. @throws InputError
Scene load_scene(const std::filesystem::path& file);
/// Canonical JSON of the resolved scene (written into EXR headers).
std::string to_json(const Scene& scene);
/// The same of a text; paths stay as they are written. @throws InputError
Scene scene_from_json(const std::string& text, const std::string& where);
/// Named materials: black, brown, blond, red, grey. @throws UsageError naming the known ones
HairMaterial material_preset(const std::string& name);
/// A material file (schemas/material.schema.json). @throws InputError
HairMaterial load_material(const std::filesystem::path& file);

}  // namespace pelage
