#include "pelage/shadow/knobs.h"

#include <string>
#include <utility>

namespace pelage {
namespace {

using Strings = std::vector<std::string>;

const std::string kMap = "shadow.density_map.";
const std::string kCells = kMap + "resolution";

Knob knob(std::string name, std::string what, std::string unit, Strings base, std::vector<KnobValue> values) {
  return {std::move(name), std::move(what),  std::move(unit), MeasureKind::transmittance,
          std::move(base), std::move(values)};
}

void printed_by(const std::string& paper, std::vector<KnobValue>& values, std::initializer_list<double> amounts) {
  for (const double amount : amounts)
    for (KnobValue& value : values)
      if (value.amount == amount) value.paper = paper;
}

/// The map's cells with one setting changed: each variant stands at an optimum of its own.
Knob cells_with(const std::string& name, const std::string& what, const std::string& setting) {
  return knob("density-map." + name, "Cells along the longest side of the density map, " + what, "cells",
              {"method=density-map", kMap + setting}, numbers(kCells, {16, 32, 64, 128, 256}));
}

/// [Bertails2005] as printed; its Figure 8 compares 32 to 256 cells.
Knob printed_map() {
  Strings base{"method=density-map"};
  for (const char* const off : {"area", "split", "trilinear_deposit", "centred_lookup", "fitted"})
    base.push_back(kMap + off + "=false");
  base.push_back(kMap + "footprint_m=0");
  std::vector<KnobValue> values = numbers(kCells, {16, 32, 64, 128, 256});
  printed_by("Bertails2005", values, {32, 64, 128, 256});
  return knob("density-map.printed", "Cells of the map as its paper prints it, without any correction", "cells",
              std::move(base), std::move(values));
}

Knob footprint() {
  std::vector<KnobValue> values =
      numbers(kMap + "footprint_m", {0, 0.00025, 0.0005, 0.001, 0.0015, 0.002, 0.003, 0.004, 0.008});
  values.front().label = "off";
  values.front().amount = std::numeric_limits<double>::quiet_NaN();
  return knob("density-map.footprint", "Radius over which a map of 256 cells is averaged where it is read", "m",
              {"method=density-map", kCells + "=256"}, std::move(values));
}

Knob threads() {
  std::vector<KnobValue> values;
  for (const int count : {1, 2}) values.push_back({std::to_string(count), static_cast<double>(count), {}, count, {}});
  return knob("density-map.threads", "Threads that fill, accumulate and read the map; the result is the same",
              "threads", {"method=density-map"}, std::move(values));
}

/// [YukselKeyser2008]: three layers, which with the depth fill one texture.
Knob deep_layers() {
  std::vector<KnobValue> values = numbers("shadow.opacity_map.layers", {1, 2, 3, 5, 7, 10, 15, 31, 63});
  printed_by("Yuksel2008", values, {3});
  return knob("deep-opacity.layers", "Layers behind the first hair of each pixel; more reach deeper in finer steps",
              "layers", {"method=deep-opacity"}, std::move(values));
}

/// [YukselKeyser2008, Figure 1] shows opacity shadow maps with 16 and with 128 layers.
Knob opacity_slices() {
  std::vector<KnobValue> values = numbers("shadow.opacity_map.slices", {8, 16, 32, 64, 128, 256, 512});
  printed_by("Yuksel2008", values, {16, 128});
  return knob("opacity-shadow.slices", "Slices through the hair along the light; more leave fewer bands", "slices",
              {"method=opacity-shadow"}, std::move(values));
}

Knob pixels(const std::string& method) {
  return knob(method + ".resolution", "Pixels along the longer side of the light's picture; more are finer shadows",
              "pixels", {"method=" + method}, numbers("shadow.opacity_map.resolution", {32, 64, 128, 256, 512, 1024}));
}

std::vector<Knob> all_knobs() {
  return {
      knob("shadow.method", "What shadows hair strand by strand, each at the scene's settings; one without any", "", {},
           choices("method", {"unshadowed", "opacity-shadow", "deep-opacity", "density-map"})),
      knob("density-map.cells", "Cells along the longest side of the density map; more are finer shadows", "cells",
           {"method=density-map"}, numbers(kCells, {16, 24, 32, 48, 64, 96, 128, 192, 256, 384})),
      printed_map(),
      cells_with("cells-counted", "vertices counted instead of areas deposited", "area=false"),
      cells_with("cells-unsplit", "segments whole instead of cut to half cells", "split=false"),
      cells_with("cells-trilinear-deposit", "deposits into eight cells instead of the nearest",
                 "trilinear_deposit=true"),
      cells_with("cells-corner-lookup", "values at the cells' far corners", "centred_lookup=false"),
      cells_with("cells-depth", "depth interpolated instead of transmittance", "interpolate_depth=true"),
      cells_with("cells-nearest-read", "the nearest cell's value instead of the filter's", "filter=false"),
      cells_with("cells-not-fitted", "of constant size instead of around the hair", "fitted=false"),
      cells_with("cells-adaptive", "slices of equal content instead of equal thickness", "adaptive_slices=true"),
      cells_with("cells-no-footprint", "read at points instead of over the footprint", "footprint_m=0"),
      footprint(),
      threads(),
      deep_layers(),
      pixels("deep-opacity"),
      opacity_slices(),
      pixels("opacity-shadow"),
  };
}

}  // namespace

std::span<const Knob> shadow_knobs() {
  static const std::vector<Knob> knobs = all_knobs();
  return knobs;
}

}  // namespace pelage
