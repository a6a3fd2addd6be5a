// HRIR-DB on disk: one SQLite file, data_schema/hrir.sql, SCHEMA.md "HRIR-DB".
//
// Writing: rows go into `<out>.partial` (WAL, one transaction per batch, in index order), so a bake that was
// interrupted or killed resumes where it stood; finish() copies the rows by VACUUM INTO a temporary file and renames
// it. The finished bytes depend only on the rows, not on threads, batches or interruptions (with one SQLite version).
// A shard is the same file with the rows of one range and no feature scales; merge_shards() puts shards together, to
// the same bytes as one bake of all.
// Reading: read-only, hardened; statements of the file must equal hrir.sql; application_id, version, lengths, ranges,
// finiteness, row count, checksums and feature scales are verified, so a damaged file is refused or reads the same. The
// file is mapped: one that is cut off by somebody else while it is read raises SIGBUS (console/program.h says so).
#pragma once

#include <cstdint>
#include <filesystem>
#include <functional>
#include <glm/vec2.hpp>
#include <memory>
#include <span>
#include <string>
#include <vector>

#include "pelage/data_schema/bake_settings.h"
#include "pelage/data_schema/hrir_record.h"
#include "pelage/db/checksum.h"
#include "pelage/db/features.h"
#include "pelage/db/quantised_record.h"

namespace pelage {

/// Everything that the rows depend on. Two bakes with equal metadata hold equal rows.
struct DatabaseMetadata {
  BakeSettings settings;
  std::string source = "random";  // random | hairstyle
  std::string source_name;        // of the hairstyle
  std::string source_hash;        // hairstyle_hash() or empty
  std::string revision;           // of the program that baked
  std::uint64_t sectors = 0;      // rows; at most settings.sectors (a hairstyle may have fewer)
};

/// The shape that the settings ask for. @throws InputError when one of its BLOBs would reach 1 MB
RecordShape record_shape(const BakeSettings& settings);
/// Version of this program and commit at configure time: "0.1.0+123188c".
std::string program_revision();

/// One row.
struct StoredSector {
  std::vector<float> features;       // unscaled
  std::vector<glm::vec2> crossings;  // (s, r): enough to trace it again
  QuantisedArray tau;                // [view][sample]
  QuantisedArray re;                 // [view][light][sample]
};

/// One row where it lies: in a StoredSector, or in SQLite's buffer until the next row.
struct SectorView {
  std::span<const float> features;
  std::span<const glm::vec2> crossings;
  QuantisedView tau, re;
  SectorView() = default;
  SectorView(const StoredSector& s) : features(s.features), crossings(s.crossings), tau(s.tau), re(s.re) {}
};
StoredSector copy_of(const SectorView& sector);

/// Rows [first, end) of a database.
struct RowRange {
  std::uint64_t first = 0, end = 0;
  std::uint64_t size() const noexcept { return end - first; }
  bool operator==(const RowRange&) const = default;
};
/// Shard i of n, 1-based, of so many rows: as even as possible, in order. @throws UsageError
RowRange shard_of(std::uint64_t rows, int shard, int shards);

class DatabaseWriter {
 public:
  /// Opens `<out>.partial`, new or to resume. @throws InputError when it was begun with other metadata or for other
  /// rows (names what differs) or is no partial database; OutputError when it cannot be written or another bake writes
  /// it.
  DatabaseWriter(std::filesystem::path out, const DatabaseMetadata& metadata)
      : DatabaseWriter(std::move(out), metadata, {0, metadata.sectors}) {}
  /// A shard: only the rows of `range`.
  DatabaseWriter(std::filesystem::path out, const DatabaseMetadata& metadata, RowRange range);
  ~DatabaseWriter();  ///< keeps the partial file; rows appended so far are committed
  DatabaseWriter(const DatabaseWriter&) = delete;
  DatabaseWriter& operator=(const DatabaseWriter&) = delete;

  std::uint64_t next_row() const noexcept;  ///< rows before it, from the range's first, are in the file
  void append(const SectorView& sector);    ///< as row next_row(); committed every few rows
  void commit();
  /// Completes the file under its own name and removes the partial one; all rows of the range are there. A whole
  /// database (not a shard) gets the feature scales that its rows have. @throws OutputError
  void finish();

 private:
  struct State;
  std::unique_ptr<State> state_;
};

/// The partial file of `out`.
std::filesystem::path partial_of(const std::filesystem::path& out);

/// Deletes it, with the rows of the interrupted bake. @throws OutputError when a bake is writing it, InputError when it
/// is no bake
void discard_partial(const std::filesystem::path& out);

enum class Accept { finished, unfinished };

class DatabaseReader {
 public:
  /// @throws InputError: no such file, not a database of this kind, other version, damaged; unfinished, or a shard,
  /// unless these are accepted
  explicit DatabaseReader(std::filesystem::path file, Accept accept = Accept::finished);
  ~DatabaseReader();
  DatabaseReader(const DatabaseReader&) = delete;
  DatabaseReader& operator=(const DatabaseReader&) = delete;

  const std::filesystem::path& file() const noexcept { return file_; }
  const DatabaseMetadata& metadata() const noexcept { return metadata_; }
  const FeatureScale& feature_scale() const noexcept { return feature_scale_; }  ///< empty when unfinished
  const RecordShape& shape() const noexcept { return shape_; }
  RowRange rows() const noexcept { return rows_; }        ///< that are there: all, unless unfinished
  RowRange planned() const noexcept { return planned_; }  ///< that the file is for: all, or a shard's

  using Visit = std::function<void(std::uint64_t id, const SectorView&)>;
  /// Every row in order, verified, after SQLite's quick_check. @throws InputError naming the row
  void for_each(const Visit& visit) const;
  /// Every row, verified, on TBB's threads: `visit` is called for different rows at the same time.
  /// @throws InputError naming a damaged row (the first one)
  void for_each_concurrently(const Visit& visit) const;

 private:
  void check_scales(const std::vector<float>& features) const;
  std::vector<float> room_for_features() const;

  struct Connection;
  std::filesystem::path file_;
  std::unique_ptr<Connection> connection_;
  DatabaseMetadata metadata_;
  FeatureScale feature_scale_;
  RecordShape shape_;
  RowRange rows_, planned_;
};

/// Puts shards together, in any order of `shards`, to the file that one bake of all rows would have written.
/// @param progress  told the rows done; may throw Interrupted, the next call resumes
/// @throws InputError when they differ in settings, source or program (names what differs), overlap, leave rows out or
/// are damaged; OutputError
void merge_shards(const std::vector<std::filesystem::path>& shards, const std::filesystem::path& out,
                  const std::function<void(std::uint64_t done, std::uint64_t total)>& progress);

}  // namespace pelage
