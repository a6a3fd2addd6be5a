// Program `pelage-bake`: builds, describes and verifies HRIR databases. Numbers and JSON only: it links no OpenGL and
// no OpenImageIO, so that it runs on farm nodes.
#include <fmt/core.h>

#include <algorithm>
#include <filesystem>
#include <functional>
#include <iostream>
#include <map>
#include <memory>
#include <nlohmann/json.hpp>
#include <optional>
#include <string>

#include "pelage/bake/bake_pipeline.h"
#include "pelage/bake/verify.h"
#include "pelage/console/options.h"
#include "pelage/console/program.h"
#include "pelage/console/progress.h"
#include "pelage/db/database.h"

namespace pelage {
namespace {

using Json = nlohmann::ordered_json;

const std::map<std::string, FeatureSet> kFeatureSets{
    {"paper3", FeatureSet::paper3}, {"moments5", FeatureSet::moments5}, {"profile11", FeatureSet::profile11}};
const std::map<std::string, Storage> kStorages{{"u8", Storage::u8}, {"half", Storage::half}};

void print(const Json& json) {
  std::cout << json.dump(2) << '\n';
}

// --- build -----------------------------------------------------------------------------------------------------------

struct BuildOptions {
  std::string from, settings, output;
  std::optional<int> sectors;
  std::optional<std::uint64_t> seed;
  std::optional<FeatureSet> features;
  std::optional<Storage> storage;
};

/// The settings file's values, or the defaults, with the options on top.
BakeSettings resolve(const BuildOptions& o) {
  BakeSettings settings = o.settings.empty() ? BakeSettings{} : load_bake_settings(o.settings);
  settings.sectors = o.sectors.value_or(settings.sectors);
  settings.seed = o.seed.value_or(settings.seed);
  settings.features = o.features.value_or(settings.features);
  settings.storage = o.storage.value_or(settings.storage);
  return settings;
}

void build(const BuildOptions& o) {
  const BakeSettings settings = resolve(o);
  std::optional<Hairstyle> style;
  if (!o.from.empty()) style = load_hairstyle(o.from);
  std::unique_ptr<console::Progress> progress;
  const BakeResult result =
      bake_database(settings, style ? &*style : nullptr, o.output, [&](std::uint64_t done, std::uint64_t total) {
        console::throw_if_interrupted();
        if (!progress) progress = std::make_unique<console::Progress>("baking", total, "sectors");
        progress->update(done);
      });
  progress.reset();
  const auto bytes = std::filesystem::file_size(o.output);
  if (console::common().json) {
    print({{"database", o.output},
           {"records", result.records},
           {"resumed", result.resumed},
           {"bytes", bytes},
           {"seconds", result.seconds}});
    return;
  }
  fmt::print("{}: {} records{}, {:.1f} MB, {:.1f} s\n", o.output, result.records,
             result.resumed > 0 ? fmt::format(" ({} of them from the interrupted bake)", result.resumed) : "",
             static_cast<double>(bytes) / 1e6, result.seconds);
}

void add_build(CLI::App& app) {
  CLI::App* verb = app.add_subcommand("build", "Bakes a database of random sectors, or of a hairstyle's own");
  const auto o = std::make_shared<BuildOptions>();
  verb->add_option("--from", o->from, "hairstyle file: bake its representative sectors instead of random ones");
  verb->add_option("--settings", o->settings, "bake settings (JSON); the options below go before it");
  verb->add_option("--sectors", o->sectors, "records to bake (default 2000)")->check(CLI::Range(1, 1000000));
  verb->add_option("--seed", o->seed, "of the random sectors and of the choice of representatives (default 1)")
      ->check(console::finite(0, static_cast<double>(kLargestSeed)));
  verb->add_option("--features", o->features, "what the search compares (default profile11)")
      ->transform(CLI::CheckedTransformer(kFeatureSets));
  verb->add_option("--storage", o->storage, "of a value: 8 bits or IEEE half (default u8)")
      ->transform(CLI::CheckedTransformer(kStorages));
  verb->add_option("-o,--output", o->output, "database to write, e.g. hair.hrir; an interrupted bake is resumed")
      ->required();
  console::add_common_options(*verb);
  verb->callback([o] { build(*o); });
}

// --- info ------------------------------------------------------------------------------------------------------------

struct Coverage {
  std::uint64_t strands = 0;
  std::size_t least = SIZE_MAX, most = 0;  // strands of a record
  float largest_tau = 0;
};

Coverage coverage_of(const DatabaseReader& reader) {
  Coverage c;
  const Storage storage = reader.metadata().settings.storage;
  reader.for_each([&](std::uint64_t, const StoredSector& s) {
    const std::vector<float> tau = dequantise(s.tau, storage);
    c.strands += s.crossings.size();
    c.least = std::min(c.least, s.crossings.size());
    c.most = std::max(c.most, s.crossings.size());
    c.largest_tau = std::max(c.largest_tau, *std::max_element(tau.begin(), tau.end()));
  });
  return c;
}

void info(const std::string& file) {
  const DatabaseReader reader(file);
  const DatabaseMetadata& m = reader.metadata();
  const Coverage c = coverage_of(reader);
  const auto bytes = std::filesystem::file_size(file);
  const double mean = static_cast<double>(c.strands) / static_cast<double>(m.sectors);
  if (console::common().json) {
    print({{"database", file},
           {"records", m.sectors},
           {"bytes", bytes},
           {"source", m.source},
           {"source_name", m.source_name},
           {"source_hash", m.source_hash},
           {"revision", m.revision},
           {"settings", Json::parse(to_json(m.settings))},
           {"strands_per_record", {{"least", c.least}, {"mean", mean}, {"most", c.most}}},
           {"largest_tau", c.largest_tau},
           {"feature_mean", reader.feature_scale().mean},
           {"feature_inverse_sigma", reader.feature_scale().inv_sigma}});
    return;
  }
  const RecordShape& shape = reader.shape();
  fmt::print("{}: {} records of {} views x {} lights x {} samples, {:.1f} MB\n", file, m.sectors, shape.views,
             shape.lights, shape.samples, static_cast<double>(bytes) / 1e6);
  fmt::print("source: {}\n", m.source == "random"
                                 ? std::string("random sectors, seed ") + std::to_string(m.settings.seed)
                                 : m.source + " '" + m.source_name + "' " + m.source_hash);
  fmt::print("baked by: {}\nstrands per record: {} to {}, mean {:.1f}\nlargest optical depth (at c0 = {}): {:.3g}\n",
             m.revision, c.least, c.most, mean, m.settings.reference_scale, c.largest_tau);
  fmt::print("settings: {}\n", to_json(m.settings));
}

void add_info(CLI::App& app) {
  CLI::App* verb = app.add_subcommand("info", "Says what a database holds and how it was baked");
  const auto file = std::make_shared<std::string>();
  verb->add_option("database", *file, "HRIR database")->required();
  console::add_common_options(*verb);
  verb->callback([file] { info(*file); });
}

// --- verify ----------------------------------------------------------------------------------------------------------

struct VerifyOptions {
  std::string database, against;
  std::uint64_t retraced = 8;
  LadderSettings ladder;
};

void print_ladder(const std::vector<LadderRung>& ladder) {
  fmt::print("{:38} {:>9} {:>9} {:>9} {:>9} {:>10} {:>10}\n", "", "radiance", "bias", "alpha", "seam", "attach ms",
             "ns/sample");
  for (const LadderRung& r : ladder) {
    fmt::print("{:38} {:9.4f} {:+9.4f} {:9.4f} {:9.4f} {:10.1f} {:10.2f}\n", r.name, r.radiance_rmse, r.radiance_bias,
               r.alpha_rmse, r.seam, r.attach_ms, r.evaluate_ns);
  }
}

Json to_json(const std::vector<LadderRung>& ladder) {
  Json rows = Json::array();
  for (const LadderRung& r : ladder) {
    rows.push_back({{"name", r.name},
                    {"radiance_rmse", r.radiance_rmse},
                    {"radiance_bias", r.radiance_bias},
                    {"alpha_rmse", r.alpha_rmse},
                    {"seam", r.seam},
                    {"attach_ms", r.attach_ms},
                    {"evaluate_ns_per_sample", r.evaluate_ns}});
  }
  return rows;
}

void verify(const VerifyOptions& o) {
  const DatabaseReader reader(o.database);
  const RetraceResult retraced = retrace(reader, o.retraced);
  const bool good = retraced.worst_tau <= 1 && retraced.worst_re <= 1;
  if (!good) console::set_exit_code(console::threshold);
  std::vector<LadderRung> ladder;
  if (!o.against.empty()) {
    const Hairstyle style = load_hairstyle(o.against);
    ladder = accuracy_ladder(std::make_shared<const RecordBank>(reader), style, o.ladder);
  }
  if (console::common().json) {
    Json json{{"database", o.database},
              {"records", reader.metadata().sectors},
              {"retraced", retraced.records},
              {"as_baked", good},
              {"worst_tau_in_quanta", retraced.worst_tau},
              {"worst_re_in_quanta", retraced.worst_re}};
    if (!o.against.empty()) json["ladder"] = {{"against", o.against}, {"rungs", to_json(ladder)}};
    print(json);
    return;
  }
  fmt::print(
      "{}: all {} records pass their checksums; {} traced again {} (largest difference {:.2f} of what {} allows)\n",
      o.database, reader.metadata().sectors, retraced.records, good ? "agree" : "DIFFER",
      std::max(retraced.worst_tau, retraced.worst_re),
      reader.metadata().settings.storage == Storage::u8 ? "8-bit rounding" : "rounding to half");
  if (o.against.empty()) return;
  fmt::print("\nRMSE against direct tracing of {}:\n", o.against);
  print_ladder(ladder);
}

void add_verify(CLI::App& app) {
  CLI::App* verb = app.add_subcommand("verify", "Checks a database against itself and against direct tracing");
  const auto o = std::make_shared<VerifyOptions>();
  verb->add_option("database", o->database, "HRIR database")->required();
  verb->add_option("--retrace", o->retraced, "records to trace again");
  verb->add_option("--against", o->against, "hairstyle file: error of each rung of the accuracy ladder on its sectors");
  verb->add_option("--sectors", o->ladder.sectors, "with --against: sectors to compare, about")
      ->check(CLI::Range(1, 1000000));
  verb->add_option("--angle-pairs", o->ladder.angle_pairs, "with --against: (view, light) pairs per sector")
      ->check(CLI::Range(1, 1000));
  console::add_common_options(*verb);
  verb->callback([o] { verify(*o); });
}

}  // namespace
}  // namespace pelage

int main(int argc, char** argv) {
  CLI::App app{"pelage-bake precomputes how small cross-sections of hair look.", "pelage-bake"};
  pelage::add_build(app);
  pelage::add_info(app);
  pelage::add_verify(app);
  return pelage::console::run_program(app, argc, argv);
}
