// Effects and passes of a picture; their stages are those of StrandFrame and SatfFrame.
#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <glm/common.hpp>
#include <glm/geometric.hpp>
#include <glm/trigonometric.hpp>

#include "pelage/data_schema/lighting.h"
#include "pelage/data_schema/strand_tint.h"
#include "pelage/effects/effect.h"
#include "pelage/effects/measures.h"
#include "pelage/shadow/depth_bound.h"

namespace pelage {
namespace {

/// Reflectance maps hold values up to this (satf/maps.h), the others have a mean of 1.
constexpr float kMostReflectance = 8;
/// Most of the mean over a fibre's width of what goes around it: pi^2 / 4 where all is diffuse, less where not.
constexpr float kMostAround = 2.47F;

float greatest(glm::vec3 v) noexcept {
  return std::max({v.x, v.y, v.z});
}

Extent hair_extent(const HairFacts& hair) {
  if (hair.strands != nullptr) return extent_of(hair.strands->vertices);
  Extent box;
  if (hair.style == nullptr) return box;
  for (const Cluster& c : hair.style->clusters) {
    if (!c.transforms.empty()) return {};
    const Extent part = extent_of(c);
    box.low = glm::min(box.low, part.low), box.high = glm::max(box.high, part.high);
  }
  return box;
}

/// Irradiance of all lights at the hair, times the greatest of their colours; infinite where a point light is in it.
float brightest(const Scene& scene, const HairFacts& hair) {
  float sum = 0;
  for (const Light& light : scene.lights) {
    const float power = light.intensity * greatest(light.colour);
    if (!light.position) {
      sum += power;
      continue;
    }
    const Extent box = hair_extent(hair);
    const float distance_m = box.empty() ? 0.0F : box.distance_m(*light.position);
    sum += power == 0 ? 0.0F : power / (distance_m * distance_m);
  }
  return sum;
}

std::string unlit(const Scene& scene) {
  for (const Light& light : scene.lights)
    if (light.intensity > 0 && greatest(light.colour) > 0) return "";
  return "the scene has no light";
}

/// Of a term that adds `strength` per unit of light.
Verdict judge_term(const Scene& scene, const HairFacts& hair, float strength) {
  if (scene.method == Method::truth) return {true, "the truth leaves nothing out"};
  const float gain = scene.method == Method::satf ? kMostReflectance : scene.strands.azimuth ? kMostAround : 1.0F;
  const float most = gain * strength * brightest(scene, hair) * scene.image.exposure;
  if (most > kUnseen) return {true, fmt::format("adds up to {:.2g} to a colour", most)};
  return {false, fmt::format("adds at most {:.2g} to a colour, {:.2g} cannot be seen", most, kUnseen)};
}

/// The greatest colour of any strand: its own in place of the material's, and what varies.
float colour_of(const HairFacts& hair, const HairMaterial& material, const glm::vec3& colour) {
  float most = greatest(colour);
  if (hair.strands != nullptr)
    for (const glm::vec3& c : hair.strands->colours) most = std::max(most, greatest(c));
  if (hair.style != nullptr)
    for (const Cluster& c : hair.style->clusters) most = std::max(most, greatest(c.colour));
  return (1 + kMostTint * material.variation) * most;
}

struct Lobe {
  const char* name;
  const char* key;  // in satf and in strands
  float HairMaterial::*coefficient;
  bool StrandSettings::*strands;
  bool SatfSettings::*satf;
  float (*colour)(const HairMaterial&, const HairFacts&);
};

const Lobe kLobes[] = {
    {"diffuse", "diffuse", &HairMaterial::diffuse, &StrandSettings::diffuse, &SatfSettings::diffuse,
     [](const HairMaterial& m, const HairFacts& hair) { return colour_of(hair, m, m.diffuse_colour); }},
    {"primary-highlight", "primary_highlight", &HairMaterial::primary, &StrandSettings::primary_highlight,
     &SatfSettings::primary_highlight,
     [](const HairMaterial& m, const HairFacts&) { return greatest(m.primary_colour); }},
    {"secondary-highlight", "secondary_highlight", &HairMaterial::secondary, &StrandSettings::secondary_highlight,
     &SatfSettings::secondary_highlight,
     [](const HairMaterial& m, const HairFacts& hair) { return colour_of(hair, m, m.secondary_colour); }}};

Effect lobe_effect(const Lobe& lobe) {
  Effect e;
  e.name = lobe.name;
  e.needs = {"geometry"};
  e.uses = {"transmittance", "reflectance", "alpha"};
  e.provides = {kResult};
  e.idle = [lobe](const Scene& s, const HairFacts&) -> std::string {
    const bool on = s.method == Method::satf ? s.satf.*lobe.satf : s.strands.*lobe.strands;
    if (!on) return fmt::format("{}.{} is off", s.method == Method::satf ? "satf" : "strands", lobe.key);
    if (s.material.*lobe.coefficient == 0) return "the material has none";
    if (lobe.coefficient == &HairMaterial::secondary && s.method != Method::satf &&
        s.strands.lobes == StrandLobes::kajiya_kay)
      return "Kajiya-Kay's hair has one highlight";
    return unlit(s);
  };
  e.called_for = [lobe](const Scene& s, const HairFacts& hair) {
    return judge_term(s, hair, s.material.*lobe.coefficient * lobe.colour(s.material, hair));
  };
  e.leave_out = [lobe](Scene& s) { s.satf.*lobe.satf = s.strands.*lobe.strands = false; };
  return e;
}

Effect ambient_effect() {
  Effect e;
  e.name = "ambient";
  e.needs = {"geometry"};
  e.uses = {"alpha"};
  e.provides = {kResult};
  e.idle = [](const Scene& s, const HairFacts&) {
    return s.material.ambient == 0 ? std::string("the material has none") : unlit(s);
  };
  e.called_for = [](const Scene& s, const HairFacts& hair) {
    return judge_term(s, hair, s.material.ambient * colour_of(hair, s.material, s.material.diffuse_colour));
  };
  e.leave_out = [](Scene& s) { s.material.ambient = 0; };
  return e;
}

Effect pass(std::string name, std::vector<std::string> provides, std::vector<std::string> stages,
            std::vector<std::string> uses = {}) {
  Effect e;
  e.name = std::move(name);
  e.pass = true;
  e.uses = std::move(uses);
  e.provides = std::move(provides);
  e.stages = std::move(stages);
  return e;
}

/// Puts the picture together, whatever it shows.
Effect drawing(std::vector<std::string> uses, std::vector<std::string> stages) {
  Effect e = pass("draw", {kResult}, std::move(stages), std::move(uses));
  e.needs = {"geometry"};
  e.called_for = [](const Scene&, const HairFacts&) { return Verdict{true, "every picture"}; };
  return e;
}

/// The head takes the shadow of the hair.
Effect head() {
  Effect e = pass("head", {kResult}, {"head shadow"}, {"transmittance"});
  e.idle = [](const Scene&, const HairFacts& hair) {
    return hair.head == nullptr || hair.head->triangles.empty() ? "there is no head" : "";
  };
  e.called_for = [](const Scene&, const HairFacts&) { return Verdict{true, "drawn with the hair, in its shadow"}; };
  return e;
}

/// Cells across the light of the method's map.
int resolution_of(const Scene& scene) {
  return scene.method == Method::density_map ? scene.shadow.density_map.resolution
                                             : scene.shadow.opacity_map.resolution;
}

/// T lies in [exp(-depth), 1].
Verdict judge_shadow(const Scene& scene, const HairFacts& hair) {
  if (hair.strands == nullptr) return {};
  const DensityMapSettings& map = scene.shadow.density_map;
  if (scene.method == Method::density_map && !map.area)
    return {true, "vertices are counted, which has no bound: a vertex may darken its whole cell"};
  if (scene.strands.smoothing > 1) return {true, "no bound is known for smoothed strands"};
  const float factor = scene.method == Method::density_map ? map.factor : 1.0F;
  if (factor == 0) return {false, "shadow.density_map.factor is zero: no light is stopped"};
  for (const Light& light : scene.lights) {
    if (light.intensity == 0) continue;
    if (light.position) return {true, "no bound is known for point lights"};
    if (has_size(light)) return {true, "no bound is known for lights of some size"};
    const float depth =
        factor * greatest_depth(*hair.strands, hair.opacity, light, resolution_of(scene), kUnseenShare / factor);
    if (depth > kUnseenShare)
      return {true, fmt::format("hair may stop more than {:.2g} % of the light", 100 * kUnseenShare)};
  }
  return {false, fmt::format("hair stops less than {:.2g} % of the light anywhere", 100 * kUnseenShare)};
}

Effect strand_shadow() {
  Effect e;
  e.name = "self-shadow";
  e.needs = {"shadow map", "geometry"};
  e.uses = {"interpolated cells"};
  e.provides = {"transmittance"};
  e.stages = {"filter"};
  e.idle = [](const Scene& s, const HairFacts&) {
    return s.method == Method::unshadowed ? std::string("method unshadowed has none") : unlit(s);
  };
  e.called_for = judge_shadow;
  e.leave_out = [](Scene& s) { s.method = Method::unshadowed; };
  return e;
}

Effect shadow_filter() {
  Effect e;
  e.name = "shadow-filter";
  e.provides = {"interpolated cells"};
  e.idle = [](const Scene& s, const HairFacts&) -> std::string {
    if (s.method != Method::density_map) return "only density maps can do without";
    return s.shadow.density_map.filter ? "" : "shadow.density_map.filter is off";
  };
  e.called_for = [](const Scene&, const HairFacts&) { return Verdict{true, "the map's cells would show"}; };
  e.leave_out = [](Scene& s) { s.shadow.density_map.filter = false; };
  return e;
}

/// Size of a sample at the nearest hair [m], seen from the scene's camera; 0: not known, or the camera is in the hair.
float sample_m(const Scene& scene, const HairFacts& hair) {
  if (!scene.camera) return 0;
  const float slope = 2 * std::tan(glm::radians(0.5F * scene.camera->fov_deg)) /
                      static_cast<float>(scene.image.height * scene.image.supersampling);
  return slope * hair_extent(hair).distance_m(scene.camera->eye);
}

Effect smoothing() {
  Effect e;
  e.name = "smoothing";
  e.provides = {"curves"};
  e.stages = {"smooth"};
  e.idle = [](const Scene& s, const HairFacts&) {
    return s.strands.smoothing > 1 ? "" : "strands.smoothing is 1: straight segments";
  };
  e.called_for = [](const Scene& s, const HairFacts& hair) -> Verdict {
    if (s.method == Method::truth) return {true, "the truth leaves nothing out"};
    if (hair.strands == nullptr) return {};
    const float off_m = curve_deviation_m(*hair.strands), sample = sample_m(s, hair);
    if (!(sample > 0)) return {true, fmt::format("curves leave the segments by up to {:.2g} mm", 1e3F * off_m)};
    const std::string by = fmt::format("curves leave the segments by at most {:.2g} of a sample", off_m / sample);
    return {off_m > kUnseenSample * sample, by};
  };
  e.leave_out = [](Scene& s) { s.strands.smoothing = 1; };
  return e;
}

/// [Xu2006 section 7, feature I]: how hair changes with the directions of view and light around it.
Effect azimuth() {
  Effect e;
  e.name = "azimuth";
  e.provides = {"reflectance"};
  e.idle = [](const Scene& s, const HairFacts&) -> std::string {
    if (s.method == Method::truth) return s.truth.azimuth ? "" : "truth.azimuth is off";
    return s.strands.azimuth ? "" : "strands.azimuth is off: its mean over light angles";
  };
  e.called_for = [](const Scene&, const HairFacts&) {
    return Verdict{true, "without it hair is as bright from behind as from the front"};
  };
  e.leave_out = [](Scene& s) { s.strands.azimuth = s.truth.azimuth = false; };
  return e;
}

std::vector<Effect> of_strands() {
  std::vector<Effect> all{smoothing()};
  all.push_back(pass("geometry", {"geometry"}, {"tangents", "upload"}, {"curves"}));
  all.push_back(shadow_filter());
  all.push_back(pass("shadow-map", {"shadow map"}, {"fill", "transmittance"}, {"curves"}));
  all.push_back(strand_shadow());
  all.push_back(azimuth());
  for (const Lobe& lobe : kLobes) all.push_back(lobe_effect(lobe));
  all.push_back(ambient_effect());
  all.push_back(head());
  all.push_back(drawing({}, {"order", "draw", "read"}));
  return all;
}

/// What is traced whatever is asked: methods are compared with hair in its own shadow.
Effect true_shadow() {
  Effect e = pass("self-shadow", {"transmittance", kResult}, {});
  e.needs = {"geometry"};
  e.called_for = [](const Scene&, const HairFacts&) {
    return Verdict{true, "the truth keeps its shadows, whatever is asked of the methods"};
  };
  return e;
}

std::vector<Effect> of_truth() {
  std::vector<Effect> all{smoothing(), pass("geometry", {"geometry"}, {"hierarchy"}, {"curves"}), true_shadow(),
                          azimuth()};
  for (const Lobe& lobe : kLobes) all.push_back(lobe_effect(lobe));
  all.push_back(ambient_effect());
  all.push_back(drawing({}, {"trace"}));
  return all;
}

Effect cluster_shadow(SelfShadow kind) {
  Effect e;
  e.name = "self-shadow";
  if (kind == SelfShadow::light) e.needs = {"s-maps"};  // eq. 12 works on the maps
  e.provides = {"transmittance"};
  e.idle = [](const Scene& s, const HairFacts&) -> std::string {
    if (s.satf.self_shadow == SelfShadow::none) return "satf.self_shadow is none";
    if (s.satf.self_shadow == SelfShadow::paper && s.satf.self_shadow_strength == 0)
      return "satf.self_shadow_strength is zero";
    return unlit(s);
  };
  e.called_for = [](const Scene&, const HairFacts&) {
    return Verdict{true, "layers darken what lies under them; no bound is cheaper than the maps"};
  };
  e.leave_out = [](Scene& s) { s.satf.self_shadow = SelfShadow::none; };
  return e;
}

std::size_t instances(const Hairstyle& style) {
  std::size_t n = 0;
  for (const Cluster& c : style.clusters) n += std::max<std::size_t>(c.transforms.size(), 1);
  return n;
}

Verdict judge_global_shadow(const Scene& scene, const HairFacts& hair) {
  if (hair.style == nullptr) return {};
  const std::size_t n = instances(*hair.style);
  if (n > 1) return {true, fmt::format("{} clusters may shade each other", n)};
  if (hair.head != nullptr && !hair.head->triangles.empty()) return {true, "the head lies in the shadow of the hair"};
  for (const Cluster& cluster : hair.style->clusters) {
    if (!cluster.transforms.empty()) return {true, "the cluster is placed by a matrix; its folds are not looked for"};
    for (const Light& light : scene.lights) {
      if (light.position || may_shade_itself(sweep(cluster, hair.style->division.plates), light.direction))
        return {true, "the only cluster may shade itself: it bends, folds, or the light runs along it"};
    }
  }
  return {false, "light that leaves the only cluster meets no hair again"};
}

Effect global_shadow() {
  Effect e;
  e.name = "global-shadow";
  e.needs = {"global shadow map", "s-maps"};
  e.provides = {"transmittance"};
  e.idle = [](const Scene& s, const HairFacts&) {
    return s.satf.global_shadow ? unlit(s) : std::string("satf.global_shadow is off");
  };
  e.called_for = judge_global_shadow;
  e.leave_out = [](Scene& s) { s.satf.global_shadow = false; };
  return e;
}

Effect satf_switch(const char* name, const char* key, bool SatfSettings::*setting, const char* why) {
  Effect e;
  e.name = name;
  e.provides = {"alpha"};
  e.idle = [setting, key](const Scene& s, const HairFacts&) {
    return s.satf.*setting ? "" : fmt::format("satf.{} is off", key);
  };
  e.called_for = [why](const Scene&, const HairFacts&) { return Verdict{true, why}; };
  e.leave_out = [setting](Scene& s) { s.satf.*setting = false; };
  return e;
}

std::vector<Effect> of_satf(const SatfSettings& satf) {
  std::vector<Effect> all;
  all.push_back(pass("geometry", {"geometry"}, {"sectors", "index", "surfaces"}));
  all.push_back(satf_switch("drift", "drift", &SatfSettings::drift, "without it strands that drift are rows of beads"));
  all.push_back(satf_switch("curvature", "curvature", &SatfSettings::curvature, "without it silhouettes are too thin"));
  all.push_back(
      satf_switch("fade-ends", "fade_ends", &SatfSettings::fade_ends, "without it clusters end as cut tubes"));
  all.push_back(pass("global-shadow-map", {"global shadow map"}, {"shadow map"}));
  all.push_back(pass("s-maps", {"s-maps"}, {"s-maps"}));
  all.push_back(cluster_shadow(satf.self_shadow));
  all.push_back(global_shadow());
  for (const Lobe& lobe : kLobes) all.push_back(lobe_effect(lobe));
  all.push_back(ambient_effect());
  all.push_back(head());
  all.push_back(drawing({"alpha"}, {"maps", "upload", "order", "draw", "read"}));
  return all;
}

}  // namespace

std::vector<Effect> picture_effects(const Scene& scene) {
  if (scene.method == Method::satf) return of_satf(scene.satf);
  return scene.method == Method::truth ? of_truth() : of_strands();
}

}  // namespace pelage
