// pelage-bake info: what a database holds and how it was baked.
#include <fmt/core.h>
#include <CLI/CLI.hpp>

#include <algorithm>
#include <filesystem>
#include <memory>
#include <nlohmann/json.hpp>
#include <string>

#include "pelage/bake/verbs.h"
#include "pelage/console/json_output.h"
#include "pelage/console/program.h"
#include "pelage/console/verb.h"
#include "pelage/db/database.h"

namespace pelage {
namespace {

struct Contents {
  std::uint64_t strands = 0;
  std::size_t least = SIZE_MAX, most = 0;  // strands of a record
  float largest_tau = 0;
};

Contents contents_of(const DatabaseReader& reader) {
  Contents c;
  const Storage storage = reader.metadata().settings.storage;
  reader.for_each([&](std::uint64_t, const SectorView& s) {
    console::throw_if_interrupted();
    const std::vector<float> tau = dequantise(s.tau, storage);
    c.strands += s.crossings.size();
    c.least = std::min(c.least, s.crossings.size());
    c.most = std::max(c.most, s.crossings.size());
    c.largest_tau = std::max(c.largest_tau, *std::max_element(tau.begin(), tau.end()));
  });
  if (c.most == 0) c.least = 0;
  return c;
}

void print_json(const DatabaseReader& reader, const Contents& c, double mean) {
  const DatabaseMetadata& m = reader.metadata();
  const bool finished = !reader.feature_scale().mean.empty();
  const nlohmann::ordered_json json = {{"database", reader.file().string()},
                                       {"finished", finished},
                                       {"records", m.sectors},
                                       {"first_record", reader.rows().first},
                                       {"records_here", reader.rows().size()},
                                       {"records_planned", reader.planned().size()},
                                       {"bytes", std::filesystem::file_size(reader.file())},
                                       {"source", m.source},
                                       {"source_name", m.source_name},
                                       {"source_hash", m.source_hash},
                                       {"revision", m.revision},
                                       {"settings", nlohmann::ordered_json::parse(to_json(m.settings))},
                                       {"strands_per_record", {{"least", c.least}, {"mean", mean}, {"most", c.most}}},
                                       {"largest_tau", c.largest_tau},
                                       {"feature_mean", reader.feature_scale().mean},
                                       {"feature_inverse_sigma", reader.feature_scale().inv_sigma}};
  console::print_json(json);
}

void info(const std::string& file) {
  const DatabaseReader reader(file, Accept::unfinished);
  const DatabaseMetadata& m = reader.metadata();
  const Contents c = contents_of(reader);
  const RowRange rows = reader.rows();
  const double mean = static_cast<double>(c.strands) / static_cast<double>(std::max<std::uint64_t>(rows.size(), 1));
  if (console::common().json) return print_json(reader, c, mean);
  const RecordShape& shape = reader.shape();
  fmt::print("{}: {} records of {} views x {} lights x {} samples, {:.1f} MB\n", file, rows.size(), shape.views,
             shape.lights, shape.samples, static_cast<double>(std::filesystem::file_size(file)) / 1e6);
  if (reader.feature_scale().mean.empty()) {
    const auto text = [](RowRange r) { return r.size() == 0 ? "none" : fmt::format("{} to {}", r.first, r.end - 1); };
    fmt::print("{}: records {} of {}\n", rows == reader.planned() ? "shard" : "unfinished", text(rows),
               rows == reader.planned() ? fmt::format("{}", m.sectors) : text(reader.planned()));
  }
  fmt::print("source: {}\n", m.source == "random"
                                 ? std::string("random sectors, seed ") + std::to_string(m.settings.seed)
                                 : m.source + " '" + m.source_name + "' " + m.source_hash);
  fmt::print("baked by: {}\nstrands per record: {} to {}, mean {:.1f}\nlargest optical depth (at c0 = {}): {:.3g}\n",
             m.revision, c.least, c.most, mean, m.settings.reference_scale, c.largest_tau);
  fmt::print("settings: {}\n", to_json(m.settings));
}

}  // namespace

void add_info(CLI::App& app) {
  console::Verb* const verb = console::add_verb(
      app, "info", "Says what a database or shard holds and how it was baked (`pelage info` draws it)");
  const auto file = std::make_shared<std::string>();
  verb->add_input("database", *file, "HRIR database")->required();
  console::add_common_options(*verb);
  verb->runs([file] { info(*file); });
}

}  // namespace pelage
