#include "pelage/app/compare_methods.h"

#include <algorithm>

#include "pelage/app/prepare.h"
#include "pelage/data_schema/errors.h"
#include "pelage/data_schema/validate.h"

namespace pelage::app {
namespace {

using Options = std::vector<std::string>;

/// SATF with adapted records and shadow along the light, whatever the scene says: the rows differ in one thing each.
Options satf(Scene& scene, RecordsFrom records, SelfShadow shadow) {
  scene.method = Method::satf;
  scene.satf.records = records;
  scene.satf.self_shadow = shadow;
  return {"--method",
          "satf",
          "--records",
          records == RecordsFrom::direct      ? "direct"
          : records == RecordsFrom::own_alpha ? "own-alpha"
                                              : "database",
          "--self-shadow",
          shadow == SelfShadow::light   ? "light"
          : shadow == SelfShadow::paper ? "paper"
                                        : "none"};
}

CompareMethod satf_row(std::string id, std::string title, std::string what, RecordsFrom records, SelfShadow shadow) {
  return {std::move(id), std::move(title), std::move(what),
          [records, shadow](Scene& scene) { return satf(scene, records, shadow); }};
}

CompareMethod generic_row(const std::string& database) {
  const std::string what = database.empty() ? "Records of random sectors, baked for any hair with the scene's settings."
                                            : "Records of the given database, " + database + ".";
  return {"satf-generic", database.empty() ? "SATF, generic records" : "SATF, given records", what,
          [database](Scene& scene) {
            scene.database = database.empty() ? prepare_generic_database(scene).string() : database;
            Options options = satf(scene, RecordsFrom::database, SelfShadow::light);
            options.insert(options.end(), {"--database", scene.database});
            return options;
          }};
}

CompareMethod strand_row(std::string id, std::string title, std::string what, Method method) {
  const std::string name = id;
  return {std::move(id), std::move(title), std::move(what), [method, name](Scene& scene) {
            scene.method = method;
            return Options{"--method", name};
          }};
}

Options printed(Scene& scene) {
  scene.method = Method::density_map;
  const int resolution = scene.shadow.density_map.resolution;
  scene.shadow.density_map = DensityMapSettings::printed();
  scene.shadow.density_map.resolution = resolution;
  scene.strands.azimuth = false;
  return {"--method",    "density-map", "--density-map", "printed", "--shadow-resolution", std::to_string(resolution),
          "--no-azimuth"};
}

}  // namespace

std::vector<CompareMethod> known_methods(const std::string& database) {
  return {
      {"truth", "Ray-traced truth",
       "Every crossing of every fibre, one scattering, shadow rays fibre by fibre; the mean of two pictures of "
       "independent rays. Light goes around a fibre by its true normal, unless the scene's truth.azimuth is false; "
       "strand methods have its mean over their width. Its error maps show its noise: one of both "
       "pictures against their mean.",
       [](Scene& scene) {
         scene.method = Method::truth;
         return Options{"--method", "truth", "--samples", std::to_string(scene.truth.samples)};
       }},
      satf_row("satf-direct", "SATF, direct records", "Every sector traced for every view and light: no database.",
               RecordsFrom::direct, SelfShadow::light),
      satf_row("satf-adapted", "SATF, adapted records",
               "Records baked from this hair; self-shadow along the light's ray.", RecordsFrom::database,
               SelfShadow::light),
      satf_row("satf-own-alpha", "SATF, own alpha",
               "Opacity from each sector's own strands, reflectance from the adapted records.", RecordsFrom::own_alpha,
               SelfShadow::light),
      generic_row(database),
      satf_row("satf-paper-shadow", "SATF, self-shadow as printed",
               "Adapted records; self-shadow by the paper's eq. 12, which knows no direction of light.",
               RecordsFrom::database, SelfShadow::paper),
      satf_row("satf-no-self-shadow", "SATF without self-shadow", "Adapted records; clusters shadow one another only.",
               RecordsFrom::database, SelfShadow::none),
      strand_row(
          "density-map", "Density map",
          "Strands as ribbons, shadowed by the light-oriented density map with the scene's settings. What `pelage "
          "render` does by default.",
          Method::density_map),
      {"density-map-mean", "Density map, mean over light",
       "The same with the reflectance around a fibre replaced by its mean over all directions of light: darker where "
       "the light comes from behind the viewer, and what strand methods without a model of it have.",
       [](Scene& scene) {
         scene.method = Method::density_map;
         scene.strands.azimuth = false;
         return Options{"--method", "density-map", "--no-azimuth"};
       }},
      {"density-map-printed", "Density map, as printed",
       "The same as the paper prints it: vertices counted, nearest cell, box of constant size.", printed},
      strand_row("deep-opacity", "Deep opacity maps", "Strands as ribbons; layers behind each pixel's first hair.",
                 Method::deep_opacity),
      strand_row("opacity-shadow", "Opacity shadow maps", "Strands as ribbons; slices evenly through the box.",
                 Method::opacity_shadow),
      strand_row("unshadowed", "No shadow", "Strands as ribbons, lit as if alone.", Method::unshadowed)};
}

std::vector<CompareMethod> chosen_methods(const std::string& database, std::span<const std::string> ids) {
  std::vector<CompareMethod> methods = known_methods(database);
  if (ids.empty()) return methods;
  std::vector<std::string> known;
  for (const CompareMethod& m : methods) known.push_back(m.id);
  for (const std::string& id : ids)
    if (std::find(known.begin(), known.end(), id) == known.end())
      throw UsageError("--methods: there is no method '" + id + "'; the nearest is " + nearest_word(id, known));
  std::erase_if(methods, [&](const CompareMethod& m) {
    return m.id != "truth" && std::find(ids.begin(), ids.end(), m.id) == ids.end();
  });
  return methods;
}

}  // namespace pelage::app
