#include "pelage/render/knobs.h"

namespace pelage {
namespace {

using Settings = std::vector<std::string>;

constexpr double kNoOrder = std::numeric_limits<double>::quiet_NaN();

/// Strands at their own optimum: the corrected map, light around fibres.
const Settings kStrands{"method=density-map", "strands.azimuth=true", "strands.order=sorted", "strands.shape=auto"};

Settings with(Settings base, std::initializer_list<const char*> more) {
  base.insert(base.end(), more.begin(), more.end());
  return base;
}

std::vector<KnobValue> methods() {
  return {{"satf", kNoOrder, {"method=satf"}, 0, {}},
          {"density-map", kNoOrder, {"method=density-map", "strands.azimuth=true"}, 0, {}},
          {"density-map-mean", kNoOrder, {"method=density-map", "strands.azimuth=false"}, 0, {}},
          {"density-map-printed",
           kNoOrder,
           {"method=density-map", "strands.azimuth=false", "shadow.density_map.area=false",
            "shadow.density_map.split=false", "shadow.density_map.trilinear_deposit=false",
            "shadow.density_map.centred_lookup=false", "shadow.density_map.fitted=false",
            "shadow.density_map.footprint_m=0"},
           0,
           "Bertails2005"},
          {"deep-opacity", kNoOrder, {"method=deep-opacity", "strands.azimuth=true"}, 0, {}},
          {"opacity-shadow", kNoOrder, {"method=opacity-shadow", "strands.azimuth=true"}, 0, {}},
          {"unshadowed", kNoOrder, {"method=unshadowed", "strands.azimuth=true"}, 0, {}},
          {"kajiya-kay", kNoOrder, {"method=density-map", "strands.lobes=kajiya-kay"}, 0, {}}};
}

std::vector<KnobValue> threads() {
  std::vector<KnobValue> values;
  for (const int n : {1, 2, 4, 8, 16}) values.push_back({std::to_string(n), static_cast<double>(n), {}, n, {}});
  return values;
}

/// What settles time and error of strands, at once: order, shape, samples per pixel, cells.
std::vector<KnobValue> together() {
  std::vector<KnobValue> values;
  const auto add = [&](const std::string& order, const std::string& shape, int samples, int cells) {
    values.push_back(
        {order + "-" + shape + "-" + std::to_string(samples) + "-" + std::to_string(cells),
         kNoOrder,
         {"strands.order=" + order, "strands.shape=" + shape, "image.supersampling=" + std::to_string(samples),
          "shadow.density_map.resolution=" + std::to_string(cells)},
         0,
         {}});
  };
  for (const char* const order : {"sorted", "exact"})
    for (const char* const shape : {"ribbons", "lines"})
      for (const int samples : {1, 2, 3, 4})
        for (const int cells : {128, 256}) add(order, shape, samples, cells);
  add("sorted", "ribbons", 1, 64);
  add("sorted", "lines", 6, 256);
  add("weighted", "ribbons", 1, 128);
  return values;
}

std::vector<Knob> make() {
  const MeasureKind picture = MeasureKind::picture;
  return {{"picture.method",
           "What draws; strand by strand with light around fibres, unless it says otherwise.",
           "",
           picture,
           {},
           methods()},
          {"truth.samples",
           "Rays per pixel of the ray-traced picture: noise, and nothing else.",
           "rays",
           picture,
           {"method=truth"},
           numbers("truth.samples", {1, 2, 4, 8, 16, 32, 64, 128})},
          {"strands.supersampling", "Samples per pixel and side: the edges of thin strands.", "samples", picture,
           kStrands, numbers("image.supersampling", {1, 2, 3, 4, 6, 8})},
          {"strands.order", "How strands in front of each other are put in order.", "", picture, kStrands,
           choices("strands.order", {"exact", "sorted", "weighted"})},
          {"strands.exact", "Samples per pixel and side, lists per pixel.", "samples", picture,
           with(kStrands, {"strands.order=exact"}), numbers("image.supersampling", {1, 2, 3, 4, 6})},
          {"strands.weighted", "Samples per pixel and side, order-independent mean.", "samples", picture,
           with(kStrands, {"strands.order=weighted"}), numbers("image.supersampling", {1, 2, 3, 4, 6})},
          {"strands.lines", "Samples per pixel and side, lines one sample wide.", "samples", picture,
           with(kStrands, {"strands.shape=lines"}), numbers("image.supersampling", {1, 2, 3, 4, 6})},
          {"strands.ribbons", "Samples per pixel and side, ribbons as wide as the fibre.", "samples", picture,
           with(kStrands, {"strands.shape=ribbons"}), numbers("image.supersampling", {1, 2, 3, 4, 6})},
          {"strands.smoothing", "Catmull-Rom pieces per segment: the error of chords is of order 2.", "pieces",
           MeasureKind::curve, kStrands, numbers("strands.smoothing", {1, 2, 3, 4, 6, 8})},
          {"strands.shadow-at", "Where transmittance is looked up.", "", picture, kStrands,
           choices("strands.shadow_at", {"vertex", "fragment"})},
          {"strands.cells", "Cells of the density map along its longest side, seen in the picture.", "cells", picture,
           kStrands, numbers("shadow.density_map.resolution", {16, 32, 64, 128, 256})},
          {"strands.highlights",
           "What of the light is drawn.",
           "",
           picture,
           kStrands,
           {{"both", kNoOrder, {}, 0, {}},
            {"primary", kNoOrder, {"strands.secondary_highlight=false"}, 0, {}},
            {"secondary", kNoOrder, {"strands.primary_highlight=false"}, 0, {}},
            {"none", kNoOrder, {"strands.primary_highlight=false", "strands.secondary_highlight=false"}, 0, {}}}},
          {"picture.together", "Order, shape, samples per pixel and side, cells of the map, at once.", "", picture,
           kStrands, together()},
          {"picture.threads",
           "Threads of all that is not OpenGL's; the picture is the same.",
           "threads",
           picture,
           {"method=truth", "truth.samples=4"},
           threads()}};
}

}  // namespace

std::span<const Knob> picture_knobs() {
  static const std::vector<Knob> knobs = make();
  return knobs;
}

}  // namespace pelage
