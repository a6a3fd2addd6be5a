// pelage-bake merge: puts the shards of a bake together.
#include <fmt/core.h>
#include <CLI/CLI.hpp>

#include <filesystem>
#include <memory>
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "pelage/bake/verbs.h"
#include "pelage/console/json_output.h"
#include "pelage/console/program.h"
#include "pelage/console/progress.h"
#include "pelage/console/verb.h"
#include "pelage/db/database.h"

namespace pelage {
namespace {

struct Options {
  std::vector<std::filesystem::path> shards;
  std::string output;
};

void merge(const Options& o) {
  std::unique_ptr<console::Progress> progress;
  std::uint64_t records = 0;
  merge_shards(o.shards, o.output, [&](std::uint64_t done, std::uint64_t total) {
    console::throw_if_interrupted();
    if (!progress) progress = std::make_unique<console::Progress>("merging", total, "sectors");
    progress->update(records = done);
  });
  progress.reset();
  const auto bytes = std::filesystem::file_size(o.output);
  if (console::common().json) {
    const nlohmann::ordered_json json = {
        {"database", o.output}, {"shards", o.shards.size()}, {"records", records}, {"bytes", bytes}};
    console::print_json(json);
    return;
  }
  fmt::print("{}: {} records of {} shards, {:.1f} MB\n", o.output, records, o.shards.size(),
             static_cast<double>(bytes) / 1e6);
}

}  // namespace

void add_merge(CLI::App& app) {
  console::Verb* const verb = console::add_verb(
      app, "merge",
      "Puts shards together, to the same bytes as one bake of all; they must agree in all that was baked");
  const auto o = std::make_shared<Options>();
  verb->add_input("shards", o->shards, "all shards of a bake (build --shard), in any order")->required();
  verb->add_output("-o,--output", o->output, "database to write", {{".partial"}})->required();
  console::add_common_options(*verb);
  verb->runs([o] { merge(*o); });
}

}  // namespace pelage
