// Bakes a database: choose sectors, trace each, store in order [Xu2006 section 5; DESIGN section 4]. Each record
// depends only on (settings, index) or (settings, hairstyle, index), so the file is the same bytes for any number of
// threads and however often the bake was interrupted.
#pragma once

#include <cstdint>
#include <filesystem>
#include <functional>
#include <string>
#include <variant>

#include "pelage/data_schema/bake_settings.h"
#include "pelage/data_schema/hairstyle.h"
#include "pelage/db/database.h"

namespace pelage {

struct BakeResult {
  std::uint64_t records = 0;  // in the database or shard
  std::uint64_t of = 0;       // in all shards
  RowRange rows;              // of the database or shard
  std::uint64_t resumed = 0;  // of them, found in a partial file
  double seconds = 0;
};

/// What the records of an adapted bake depend on (division and strands; neither names nor widths): 16 hex digits.
std::string hairstyle_hash(const Hairstyle& style);

/// Shard `index` of `count`, 1-based: only these records are baked, into a file for merge_shards(). 1/1: all.
struct Shard {
  int index = 1, count = 1;
};
/// The records of a bake to make: a shard's, or those that an interrupted bake had begun (DatabaseReader::planned).
using Part = std::variant<Shard, RowRange>;

/// @param style     null: random sectors, else representatives of this hairstyle's non-empty ones
/// @param out       replaced when all is done; until then rows lie in `<out>.partial`, which the next call resumes
/// @param progress  told the rows done, from one thread at a time; may throw Interrupted, the partial file stays then
/// @throws InputError, OutputError [db/database.h]; UsageError for a shard that there is not
BakeResult bake_database(const BakeSettings& settings, const Hairstyle* style, const std::filesystem::path& out,
                         const std::function<void(std::uint64_t done, std::uint64_t total)>& progress,
                         const Part& part = Shard{});

}  // namespace pelage
