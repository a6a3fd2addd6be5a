#include <algorithm>
#include <memory>
#include <system_error>

#include "pelage/data_schema/errors.h"
#include "pelage/db/database_format.h"

namespace pelage {
namespace {

using Shard = std::unique_ptr<DatabaseReader>;

/// Opened, and all of one bake.
std::vector<Shard> open_shards(const std::vector<std::filesystem::path>& files) {
  std::vector<Shard> shards;
  for (const auto& file : files) {
    shards.push_back(std::make_unique<DatabaseReader>(file, Accept::unfinished));
    const DatabaseReader &first = *shards.front(), &last = *shards.back();
    const auto differs = format::difference(first.metadata(), "in " + first.file().string(), last.metadata(),
                                            "in " + last.file().string());
    if (!differs.empty()) throw InputError(file.string(), "is of another bake: " + differs);
  }
  return shards;
}

/// Sorted by row, without gap or overlap.
void put_in_order(std::vector<Shard>& shards) {
  std::sort(shards.begin(), shards.end(),
            [](const Shard& a, const Shard& b) { return a->rows().first < b->rows().first; });
  std::uint64_t next = 0;
  const auto refuse_gap = [&](std::uint64_t end) {
    throw InputError(shards.front()->file().string(), "the records " + format::text({next, end}) +
                                                          " are in none of the shards: bake them, or complete the "
                                                          "shard that should hold them, and name all shards");
  };
  for (std::size_t i = 0; i < shards.size(); ++i) {
    const RowRange rows = shards[i]->rows();
    if (rows != shards[i]->planned()) {
      throw InputError(shards[i]->file().string(), "is unfinished: it holds the records " + format::text(rows) +
                                                       " of " + format::text(shards[i]->planned()) +
                                                       ": complete its bake first");
    }
    if (rows.first < next) {
      throw InputError(shards[i]->file().string(),
                       "the records " + format::text({rows.first, std::min(rows.end, next)}) + " are also in " +
                           shards[i - 1]->file().string() + ": name each shard once");
    }
    if (rows.first > next) refuse_gap(rows.first);
    next = rows.end;
  }
  if (next < shards.front()->metadata().sectors) refuse_gap(shards.front()->metadata().sectors);
}

}  // namespace

void merge_shards(const std::vector<std::filesystem::path>& files, const std::filesystem::path& out,
                  const std::function<void(std::uint64_t, std::uint64_t)>& progress) {
  if (files.empty()) throw UsageError("no shard to merge: name at least one");
  for (const auto& file : files) {
    std::error_code none;
    if (std::filesystem::equivalent(file, out, none)) {
      throw UsageError(out.string() + ": is one of the shards, which stay as they are: name another output");
    }
  }
  std::vector<Shard> shards = open_shards(files);
  put_in_order(shards);
  const DatabaseMetadata& metadata = shards.front()->metadata();
  DatabaseWriter writer(out, metadata);
  for (const Shard& shard : shards) {
    if (shard->rows().end <= writer.next_row()) continue;  // of an interrupted merge
    shard->for_each([&](std::uint64_t id, const SectorView& sector) {
      if (id < writer.next_row()) return;
      writer.append(sector);
      if (progress) progress(id + 1, metadata.sectors);
    });
  }
  writer.finish();
}

}  // namespace pelage
