#include "pelage/satf/knobs.h"

#include <string>
#include <utility>

namespace pelage {
namespace {

using Strings = std::vector<std::string>;

Knob knob(std::string name, std::string what, std::string unit, std::vector<KnobValue> values) {
  return {"satf." + std::move(name), std::move(what), std::move(unit),
          MeasureKind::picture,      {"method=satf"}, std::move(values)};
}

/// As Xu2006 prints it: the values with these labels.
std::vector<KnobValue> printed(std::vector<KnobValue> values, std::initializer_list<const char*> labels) {
  for (KnobValue& value : values)
    for (const char* const label : labels)
      if (value.label == label) value.paper = "Xu2006";
  return values;
}

std::vector<KnobValue> record_sources() {
  std::vector<KnobValue> values = choices("satf.records", {"literal-key", "database", "own-alpha", "direct"});
  values[1].label = "adapted";
  for (KnobValue& value : values) value.settings.push_back("database=");
  values.insert(values.begin() + 1,
                {"generic", values[1].amount, {"satf.records=database", "database=generic"}, 0, {}});
  return printed(std::move(values), {"literal-key"});
}

std::vector<Knob> all_knobs() {
  return {
      knob("records", "Where the values of a sector come from", "", record_sources()),
      knob("clusters", "Clusters that are fitted to a hair file's strands; more follow them closer", "clusters",
           numbers("clusters", {20, 50, 100, 150, 250, 400, 800})),
      // Table 1 of Xu2006: 10 and 15 layers of a single cluster, 51 to 80 of hairstyles.
      knob("layers", "Layers of a cluster from its core outwards", "layers",
           printed(numbers("division.layers", {1, 2, 3, 4, 6, 10, 15}), {"10", "15"})),
      knob("sectors", "Sectors of a cluster's outermost layer", "sectors",
           numbers("division.sectors", {6, 8, 12, 16, 24, 32, 48})),
      knob("plates", "Hair shell volumes along a cluster", "plates",
           numbers("division.plates", {4, 8, 12, 16, 24, 48, 96})),
      // Equation 12 of Xu2006.
      knob("self-shadow", "Shadow within a cluster: none, summed at the same place, along the light's ray", "",
           printed(choices("satf.self_shadow", {"none", "paper", "light"}), {"paper"})),
      knob("neighbours", "Records blended per sector by the distance of their features", "records",
           numbers("satf.neighbours", {1, 2, 4, 8})),
      knob("bake-records", "Records baked of the hairstyle's sectors", "records",
           numbers("bake.sectors", {30, 125, 500, 1000, 2000})),
      // What lies beyond a sector is taken to be like it: only a picture says how far to go on.
      knob("max-path", "Longest march through a sector, where light and view graze it", "heights",
           numbers("bake.max_path", {1, 2, 3, 4, 6, 8, 16})),
      knob("draw-order", "What is sorted by depth", "", choices("satf.draw_order", {"clusters", "patches", "exact"})),
      knob("shadow-resolution", "Cells of the density map for shadows between clusters", "cells",
           numbers("satf.shadow_resolution", {8, 16, 32, 64, 96, 128, 192, 256})),
      // Equation 7 of Xu2006 interpolates records where they are.
      knob("drift", "Records move with the strands' mean drift before they are interpolated", "",
           printed(choices("satf.drift", {"false", "true"}), {"false"})),
      knob("curvature", "The ring's chord instead of a flat slab near silhouettes", "",
           choices("satf.curvature", {"false", "true"})),
      knob("fade-ends", "Open ends of clusters fade", "", choices("satf.fade_ends", {"false", "true"})),
  };
}

}  // namespace

std::span<const Knob> satf_knobs() {
  static const std::vector<Knob> knobs = all_knobs();
  return knobs;
}

}  // namespace pelage
