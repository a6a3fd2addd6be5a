// pelage-bake verify: a database against itself, against direct tracing, and against a hairstyle.
#include <fmt/core.h>
#include <CLI/CLI.hpp>

#include <algorithm>
#include <memory>
#include <nlohmann/json.hpp>
#include <optional>
#include <string>

#include "pelage/bake/verbs.h"
#include "pelage/bake/verify.h"
#include "pelage/console/json_output.h"
#include "pelage/console/options.h"
#include "pelage/console/program.h"
#include "pelage/console/verb.h"
#include "pelage/data_schema/errors.h"
#include "pelage/db/coverage.h"

namespace pelage {
namespace {

using Json = nlohmann::ordered_json;

struct Options {
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

/// How near the records are to each other, and to the sectors of a hairstyle.
struct Coverage {
  std::vector<float> spacing, sectors;
};

Json to_json(const std::vector<float>& distances) {
  return {{"median", quantile(distances, 0.5)}, {"p95", quantile(distances, 0.95)}, {"max", quantile(distances, 1)}};
}

void print_coverage(const Coverage& c, const std::string& hairstyle) {
  fmt::print("\nNearest record, in standard deviations per feature:   median    95 %  largest\n");
  const auto line = [](const std::string& name, const std::vector<float>& d) {
    fmt::print("{:52} {:7.3f} {:7.3f} {:8.3f}\n", name, quantile(d, 0.5), quantile(d, 0.95), quantile(d, 1));
  };
  line("  of a record", c.spacing);
  line(fmt::format("  of the {} sectors of {}", c.sectors.size(), hairstyle), c.sectors);
  fmt::print("{:.1f} % of these sectors are farther from any record than 95 % of the records from each other.\n",
             100 * uncovered_share(c.spacing, c.sectors));
}

void print_checks(const DatabaseReader& reader, const RetraceResult& retraced, bool good) {
  fmt::print("{}: schema, SQLite's structure, and all {} records pass: checksums, lengths, ranges, finite values\n",
             reader.file().string(), reader.rows().size());
  fmt::print("{} traced again {} (largest difference {:.2f} of what {} allows)\n", retraced.records,
             good ? "agree" : "DIFFER", std::max(retraced.worst_tau, retraced.worst_re),
             reader.metadata().settings.storage == Storage::u8 ? "8-bit rounding" : "rounding to half");
}

void verify(const Options& o) {
  const DatabaseReader reader(o.database, o.against.empty() ? Accept::unfinished : Accept::finished);
  reader.for_each([](std::uint64_t, const SectorView&) { console::throw_if_interrupted(); });
  const RetraceResult retraced = retrace(reader, o.retraced);
  const bool good = retraced.worst_tau <= 1 && retraced.worst_re <= 1;
  if (!good) console::set_exit_code(console::threshold);
  Json json{
      {"database", o.database}, {"records", reader.rows().size()},           {"retraced", retraced.records},
      {"as_baked", good},       {"worst_tau_in_quanta", retraced.worst_tau}, {"worst_re_in_quanta", retraced.worst_re}};
  const bool as_json = console::common().json;
  if (!as_json) print_checks(reader, retraced, good);
  if (!o.against.empty()) {
    const Hairstyle style = load_hairstyle(o.against);
    const auto bank = std::make_shared<const RecordBank>(reader);
    const Coverage coverage{
        record_spacing(*bank),
        distances_to_records(*bank, used_sector_features(*bank, sectors_of(style.clusters, style.division)))};
    if (!as_json) print_coverage(coverage, o.against);
    console::throw_if_interrupted();
    const auto ladder = accuracy_ladder(bank, style, o.ladder);
    if (!as_json) {
      fmt::print("\nRMSE against direct tracing of {}:\n", o.against);
      print_ladder(ladder);
    }
    json["against"] = o.against;
    json["coverage"] = {{"records", to_json(coverage.spacing)},
                        {"sectors", to_json(coverage.sectors)},
                        {"uncovered_share", uncovered_share(coverage.spacing, coverage.sectors)}};
    json["ladder"] = to_json(ladder);
  }
  if (as_json) console::print_json(json);
}

}  // namespace

void add_verify(CLI::App& app) {
  console::Verb* const verb =
      console::add_verb(app, "verify", "Checks a database against itself, direct tracing and a hairstyle");
  const auto o = std::make_shared<Options>();
  verb->add_input("database", o->database, "HRIR database or shard")->required();
  verb->add_option("--retrace", o->retraced, "records to trace again and compare; exit code 3 when they differ")
      ->check(console::finite(0, 1e6));
  verb->add_input("--against", o->against,
                  "hairstyle file: how well its sectors are covered, and the error of each rung of the accuracy "
                  "ladder on them");
  verb->add_option("--sectors", o->ladder.sectors, "with --against: sectors to compare, about")
      ->check(CLI::Range(1, 1000000));
  verb->add_option("--angle-pairs", o->ladder.angle_pairs, "with --against: (view, light) pairs per sector")
      ->check(CLI::Range(1, 1000));
  console::add_common_options(*verb);
  verb->runs([o] { verify(*o); });
}

}  // namespace pelage
