#include "pelage/bake/knobs.h"

#include <string>
#include <utility>

namespace pelage {
namespace {

using Strings = std::vector<std::string>;

constexpr double kNoOrder = std::numeric_limits<double>::quiet_NaN();
const Strings kAdapted{"database=", "satf.records=own-alpha"};
const Strings kGeneric{"database=generic", "satf.records=own-alpha"};

Knob knob(std::string name, std::string what, std::string unit, Strings base, std::vector<KnobValue> values) {
  return {std::move(name), std::move(what), std::move(unit), MeasureKind::records, std::move(base), std::move(values)};
}

std::vector<KnobValue> feature_sets() {
  std::vector<KnobValue> values = choices("bake.features", {"paper3", "moments5", "profile11"});
  values.front().paper = "Xu2006";  // section 5.2: three terms
  return values;
}

/// Views and lights together.
std::vector<KnobValue> angles() {
  std::vector<KnobValue> values = numbers("bake.views", {4, 8, 16, 24, 32, 64});
  for (KnobValue& value : values) value.settings.push_back("bake.lights=" + value.label);
  return values;
}

/// As many views as lights are few: all records of the same size.
std::vector<KnobValue> views_for_lights() {
  std::vector<KnobValue> values = numbers("bake.views", {16, 32, 64, 128, 256});
  for (KnobValue& value : values)
    value.settings.push_back("bake.lights=" + std::to_string(1024 / static_cast<int>(value.amount)));
  return values;
}

/// From what the paper prints to tracing every sector.
std::vector<KnobValue> rungs() {
  return {{"literal-key", kNoOrder, {"database=", "satf.records=literal-key"}, 0, "Xu2006"},
          {"generic", kNoOrder, {"database=generic", "satf.records=database"}, 0, {}},
          {"adapted", kNoOrder, {"database=", "satf.records=database"}, 0, {}},
          {"own-alpha", kNoOrder, {"database=", "satf.records=own-alpha"}, 0, {}},
          {"direct", kNoOrder, {"database=", "satf.records=direct"}, 0, {}}};
}

std::vector<Knob> all_knobs() {
  const std::string records = "Records baked; more leave less to be unlike the sector that is looked up";
  const std::string blended = "Records blended per sector by the distance of their features";
  const std::string search = "What the search describes a sector's density by";
  return {
      knob("bake.from", "Where the values of a sector come from", "", {}, rungs()),
      knob("bake.records", records + ", of the hairstyle's own", "records", kAdapted,
           numbers("bake.sectors", {30, 60, 125, 250, 500, 1000, 2000, 4000})),
      knob("bake.records-generic", records + ", of random sectors", "records", kGeneric,
           numbers("bake.sectors", {30, 60, 125, 250, 500, 1000, 2000, 4000})),
      knob("bake.features", search, "", kAdapted, feature_sets()),
      knob("bake.features-generic", search + ", among random sectors", "", kGeneric, feature_sets()),
      knob("bake.neighbours", blended, "records", kAdapted, numbers("satf.neighbours", {1, 2, 3, 4, 6, 8})),
      knob("bake.neighbours-generic", blended + ", among random sectors", "records", kGeneric,
           numbers("satf.neighbours", {1, 2, 3, 4, 6, 8})),
      knob("bake.angles", "View angles and light angles of a record, as many of each", "angles", kAdapted, angles()),
      knob("bake.views", "View angles of a record on the full circle", "angles", kAdapted,
           numbers("bake.views", {4, 8, 16, 32, 64, 128})),
      knob("bake.lights", "Light angles of a record on the full circle", "angles", kAdapted,
           numbers("bake.lights", {4, 6, 8, 16, 32})),
      knob("bake.views-for-lights", "View angles where views times lights stay 1024: the same bytes", "angles",
           kAdapted, views_for_lights()),
      knob("bake.samples", "Values along s of a record", "samples", kAdapted,
           numbers("bake.samples", {4, 8, 16, 32, 64})),
      knob("bake.grid", "Cells per side of the density that is traced", "cells", kAdapted,
           numbers("bake.grid", {8, 12, 16, 24, 32, 48})),
      knob("bake.storage", "Bytes of a stored value: one or two", "", kAdapted,
           choices("bake.storage", {"u8", "half"})),
  };
}

}  // namespace

std::span<const Knob> bake_knobs() {
  static const std::vector<Knob> knobs = all_knobs();
  return knobs;
}

}  // namespace pelage
