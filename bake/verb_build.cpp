// pelage-bake build: bakes a database, or one shard of it.
#include <fmt/core.h>
#include <CLI/CLI.hpp>

#include <charconv>
#include <filesystem>
#include <map>
#include <memory>
#include <nlohmann/json.hpp>
#include <optional>
#include <string>
#include <vector>

#include "pelage/bake/bake_pipeline.h"
#include "pelage/bake/verbs.h"
#include "pelage/console/json_output.h"
#include "pelage/console/options.h"
#include "pelage/console/program.h"
#include "pelage/console/progress.h"
#include "pelage/console/verb.h"
#include "pelage/data_schema/errors.h"
#include "pelage/data_schema/output_file.h"
#include "pelage/db/database.h"

namespace pelage {
namespace {

const std::map<std::string, FeatureSet> kFeatureSets{
    {"paper3", FeatureSet::paper3}, {"moments5", FeatureSet::moments5}, {"profile11", FeatureSet::profile11}};
const std::map<std::string, Storage> kStorages{{"u8", Storage::u8}, {"half", Storage::half}};

template <class Value>
std::vector<std::string> names_of(const std::map<std::string, Value>& values) {
  std::vector<std::string> names;
  for (const auto& [name, value] : values) names.push_back(name);
  return names;
}

enum class Resume { when_there, must, never };

struct Options {
  std::string from, settings, output;
  std::optional<std::string> shard;
  Resume resume = Resume::when_there;
  std::optional<int> sectors;
  std::optional<std::uint64_t> seed;
  std::optional<std::string> features, storage;
};

/// "2/5".
Shard parse_shard(const std::string& text) {
  Shard shard;
  const char* const end = text.data() + text.size();
  const auto index = std::from_chars(text.data(), end, shard.index);
  const bool slash = index.ec == std::errc{} && index.ptr != end && *index.ptr == '/';
  const auto count = slash ? std::from_chars(index.ptr + 1, end, shard.count) : index;
  if (!slash || count.ec != std::errc{} || count.ptr != end) {
    throw UsageError("shard \"" + text + "\": give i/n with 1 <= i <= n, e.g. 1/4");
  }
  return shard;
}

/// What the interrupted bake was begun with, for --resume.
struct Begun {
  BakeSettings settings;
  RowRange rows;
};
Begun begun(const Options& o) {
  const auto partial = partial_of(o.output);
  if (!std::filesystem::exists(partial)) {
    throw InputError(partial.string(), "there is no interrupted bake to resume: leave --resume out to begin one");
  }
  const DatabaseReader reader(partial, Accept::unfinished);
  const DatabaseMetadata& m = reader.metadata();
  if (m.source == "hairstyle" && o.from.empty()) {
    throw UsageError(partial.string() + " is baked from hairstyle '" + m.source_name + "': give it again with --from");
  }
  return {m.settings, reader.planned()};
}

/// What to bake: the interrupted bake's settings and rows, or the defaults; the settings file and the options on top.
struct Task {
  BakeSettings settings;
  Part part = Shard{};
};
Task resolve(const Options& o) {
  Task task;
  BakeSettings& settings = task.settings;
  if (o.resume == Resume::must) {
    const Begun before = begun(o);
    task = {before.settings, before.rows};
  }
  if (!o.settings.empty()) settings = load_bake_settings(o.settings);
  settings.sectors = o.sectors.value_or(settings.sectors);
  settings.seed = o.seed.value_or(settings.seed);
  if (o.features) settings.features = kFeatureSets.at(*o.features);
  if (o.storage) settings.storage = kStorages.at(*o.storage);
  if (o.shard) task.part = parse_shard(*o.shard);
  return task;
}

BakeResult bake(const Task& task, const Hairstyle* style, const Options& o) {
  std::unique_ptr<console::Progress> progress;
  std::uint64_t done = 0, total = 0;
  try {
    return bake_database(
        task.settings, style, o.output,
        [&](std::uint64_t d, std::uint64_t t) {
          done = d;
          total = t;
          console::throw_if_interrupted();
          if (!progress) progress = std::make_unique<console::Progress>("baking", total, "sectors");
          progress->update(done);
        },
        task.part);
  } catch (const Interrupted&) {
    throw Interrupted(fmt::format("interrupted: {} of {} records are kept in {}; the same command goes on from there",
                                  done, total, partial_of(o.output).string()));
  }
}

void print(const BakeResult& result, const Options& o) {
  const auto bytes = std::filesystem::file_size(o.output);
  if (console::common().json) {
    const nlohmann::ordered_json json = {{"database", o.output},
                                         {"first_record", result.rows.first},
                                         {"records", result.records},
                                         {"resumed", result.resumed},
                                         {"bytes", bytes},
                                         {"seconds", result.seconds}};
    console::print_json(json);
    return;
  }
  fmt::print(
      "{}: {}{} records{}, {:.1f} MB, {:.1f} s\n", o.output,
      result.records == result.of ? ""
                                  : fmt::format("shard of records {} to {}, ", result.rows.first, result.rows.end - 1),
      result.records, result.resumed > 0 ? fmt::format(" ({} of them from the interrupted bake)", result.resumed) : "",
      static_cast<double>(bytes) / 1e6, result.seconds);
}

void build(const Options& o) {
  if (o.shard) parse_shard(*o.shard);  // a mistake shows before anything is touched
  check_writable(o.output);
  if (o.resume == Resume::never) discard_partial(o.output);
  const Task task = resolve(o);
  std::optional<Hairstyle> style;
  if (!o.from.empty()) style = load_hairstyle(o.from);
  print(bake(task, style ? &*style : nullptr, o), o);
}

}  // namespace

void add_build(CLI::App& app) {
  console::Verb* const verb =
      console::add_verb(app, "build", "Bakes a database of random sectors, or of a hairstyle's own");
  const auto o = std::make_shared<Options>();
  verb->add_input("--from", o->from, "hairstyle file: bake its representative sectors instead of random ones");
  verb->add_input("--settings", o->settings, "bake settings (JSON); the options below go before it");
  verb->add_option("--sectors", o->sectors, "records to bake (default 1000)")->check(CLI::Range(1, 1000000));
  verb->add_option("--seed", o->seed, "of the random sectors and of the choice of representatives (default 1)")
      ->check(console::finite(0, static_cast<double>(kLargestSeed)));
  verb->add_option("--features", o->features, "what the search compares (default profile11)")
      ->check(CLI::IsMember(names_of(kFeatureSets)));
  verb->add_option("--storage", o->storage, "of a value: 8 bits or IEEE half (default u8)")
      ->check(CLI::IsMember(names_of(kStorages)));
  verb->add_option("--shard", o->shard,
                   "i/n: bake only the i-th of n parts of the records; `merge` puts them together");
  auto* must = verb->add_flag_callback(
      "--resume", [o] { o->resume = Resume::must; },
      "go on with the interrupted bake of this output, with its settings and shard; an error when there is none "
      "(without this "
      "option it is resumed where there is one)");
  verb->add_flag_callback(
          "--no-resume", [o] { o->resume = Resume::never; }, "begin anew; an interrupted bake's records are deleted")
      ->excludes(must);
  verb->add_output("-o,--output", o->output, "database to write, e.g. hair.hrir; an interrupted bake is resumed",
                   {{".partial"}})
      ->required();
  console::add_common_options(*verb);
  verb->runs([o] { build(*o); });
}

}  // namespace pelage
