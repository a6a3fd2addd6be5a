// pelage-bake query: one lookup of the SATF, as the runtime makes it, as JSON.
#include <CLI/CLI.hpp>
#include <charconv>
#include <cmath>
#include <memory>
#include <nlohmann/json.hpp>
#include <numbers>
#include <optional>
#include <string>
#include <vector>

#include "pelage/bake/direct_source.h"
#include "pelage/bake/verbs.h"
#include "pelage/console/json_output.h"
#include "pelage/console/options.h"
#include "pelage/console/program.h"
#include "pelage/console/verb.h"
#include "pelage/data_schema/errors.h"
#include "pelage/db/database_source.h"

namespace pelage {
namespace {

using Json = nlohmann::ordered_json;

struct Options {
  std::string database;
  std::optional<std::uint32_t> record;
  std::vector<float> crossings;  // s, r, s, r, ..
  float view_deg = 0, light_deg = 0;
  std::optional<float> scale;
  LookupSettings lookup{1, false, false};
  bool direct = false;
};

/// The sector that is asked for: the strands given, or those of a record.
std::vector<glm::vec2> crossings_of(const Options& o, const RecordBank& bank) {
  std::vector<glm::vec2> crossings;
  if (o.record) {
    if (*o.record >= bank.size()) {
      throw UsageError("record " + std::to_string(*o.record) + ": " + o.database + " has records 0 to " +
                       std::to_string(bank.size() - 1));
    }
    const SectorCrossings strands = bank.crossings(*o.record);
    return {strands.begin(), strands.end()};
  }
  if (o.crossings.size() % 2 != 0) throw UsageError("--strands: give pairs s r; the last r is missing");
  for (std::size_t i = 0; i < o.crossings.size(); i += 2) crossings.emplace_back(o.crossings[i], o.crossings[i + 1]);
  return crossings;
}

/// A track of two equal sectors, the shortest there is.
SectorSet track_of(const std::vector<glm::vec2>& crossings) {
  SectorSet sectors;
  sectors.plates = 1;
  for (int i = 0; i < 2; ++i) {
    sectors.crossings.insert(sectors.crossings.end(), crossings.begin(), crossings.end());
    sectors.offsets.push_back(static_cast<std::uint32_t>(sectors.crossings.size()));
    sectors.drift.push_back(0.0F);
  }
  return sectors;
}

/// The number that a reader of the text means: 0.025, not the float's 0.0250000003725.
double short_of(float value) {
  char digits[32];
  double number = 0;
  std::from_chars(digits, std::to_chars(digits, digits + sizeof digits, value).ptr, number);
  return number;
}
std::vector<double> short_of(const std::vector<float>& values) {
  std::vector<double> numbers;
  for (const float v : values) numbers.push_back(short_of(v));
  return numbers;
}

Json evaluate(const RecordSource& source, const SatfAngles& angles, float scale) {
  const auto n = static_cast<std::size_t>(source.samples());
  std::vector<float> tau(n), re(n), alpha;
  source.evaluate(0, angles, tau, re);
  for (const float t : tau) alpha.push_back(-std::expm1(-t * scale / source.reference_scale()));
  return {{"tau", short_of(tau)}, {"alpha", short_of(alpha)}, {"re", short_of(re)}};
}

void query(const Options& o) {
  if (o.record.has_value() == !o.crossings.empty()) throw UsageError("give either --record or --strands");
  const auto bank = std::make_shared<const RecordBank>(o.database);
  const BakeSettings& settings = bank->metadata().settings;
  const SectorSet sectors = track_of(crossings_of(o, *bank));
  DatabaseSource source(bank, o.lookup);
  source.attach(sectors);
  const float view = o.view_deg * std::numbers::pi_v<float> / 180,
              light = o.light_deg * std::numbers::pi_v<float> / 180;
  const float scale = o.scale.value_or(source.reference_scale());
  std::vector<float> features(static_cast<std::size_t>(dimension(settings.features)));
  density_features(projections(sectors.sector(0), settings.grid, settings.sigma), settings.features, features);
  Json picks = Json::array();
  for (const DatabaseSource::Pick& pick : source.picks(0)) {
    if (pick.weight > 0) picks.push_back({{"record", pick.record}, {"weight", short_of(pick.weight)}});
  }
  Json json{{"database", o.database},
            {"features", short_of(features)},
            {"records", picks},
            {"shift", short_of(source.shift(0))},
            {"view_deg", short_of(o.view_deg)},
            {"light_deg", short_of(o.light_deg)},
            {"scale", short_of(scale)},
            {"reference_scale", short_of(source.reference_scale())}};
  json.update(evaluate(source, {view, view, light, light}, scale));
  if (o.direct) {
    DirectSource direct(settings);
    direct.attach(sectors);
    json["direct"] = evaluate(direct, {view, view, light, light}, scale);
  }
  console::print_json(json);
}

}  // namespace

void add_query(CLI::App& app) {
  console::Verb* const verb =
      console::add_verb(app, "query", "One lookup as JSON: the records found, opacity and reflectance along s");
  const auto o = std::make_shared<Options>();
  verb->add_input("database", o->database, "HRIR database")->required();
  verb->add_option("--record", o->record, "look up the strands of this record");
  verb->add_option("--strands", o->crossings,
                   "look up these strands: pairs s r, sector coordinates, from -0.35 to 1.35 (the sector is 0 to 1)")
      ->check(console::finite(-0.35, 1.35));
  verb->add_option("--view", o->view_deg, "view angle in the plate plane, degrees from outward r towards +s")
      ->check(console::finite(-3600, 3600));
  verb->add_option("--light", o->light_deg, "light angle, the same way")->check(console::finite(-3600, 3600));
  verb->add_option("--scale", o->scale, "optical scale c of alpha (default: the database's reference scale)")
      ->check(console::finite(0, 1e6));
  verb->add_option("--neighbours", o->lookup.neighbours, "records to blend")->check(CLI::Range(1, 8));
  verb->add_flag("--own-alpha", o->lookup.own_alpha, "opacity from the strands, reflectance from the record");
  verb->add_flag("--direct", o->direct, "also trace the strands directly, to compare");
  console::add_common_options(*verb);
  verb->runs([o] { query(*o); });
}

}  // namespace pelage
