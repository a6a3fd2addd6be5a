// HRIR-DB on disk: one SQLite file, data_schema/hrir.sql, SCHEMA.md "HRIR-DB". The only user of <sqlite3.h>.
//
// Writing: rows go into `<out>.partial` (WAL, one transaction per batch, in index order), so a bake that was
// interrupted or killed resumes where it stood; finish() copies the rows by VACUUM INTO a temporary file and renames
// it. The finished bytes depend only on the rows, not on threads, batches or interruptions (with one SQLite version).
// Reading: read-only, defensive; statements of the file must equal hrir.sql; application_id, version, lengths, ranges,
// finiteness, row count and checksums are verified, so a damaged file is refused or reads the same.
#pragma once

#include <cstdint>
#include <filesystem>
#include <functional>
#include <glm/vec2.hpp>
#include <memory>
#include <string>
#include <vector>

#include "pelage/data_schema/bake_settings.h"
#include "pelage/data_schema/hrir_record.h"
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

/// 64-bit FNV-1a over little-endian 64-bit words, the tail zero-padded, then the length. Each step is a bijection of
/// the state, so a change within one word is always seen.
class Checksum {
 public:
  void add(const void* bytes, std::size_t size) noexcept;
  std::uint64_t value() const noexcept { return state_; }

 private:
  void mix(std::uint64_t word) noexcept { state_ = (state_ ^ word) * 0x100000001B3ULL; }
  std::uint64_t state_ = 0xCBF29CE484222325ULL;
};

class DatabaseWriter {
 public:
  /// Opens `<out>.partial`, new or to resume. @throws InputError when it was begun with other metadata (names what
  /// differs) or is no partial database; OutputError when it cannot be written or another bake writes it.
  DatabaseWriter(std::filesystem::path out, const DatabaseMetadata& metadata);
  ~DatabaseWriter();  ///< keeps the partial file; rows appended so far are committed
  DatabaseWriter(const DatabaseWriter&) = delete;
  DatabaseWriter& operator=(const DatabaseWriter&) = delete;

  std::uint64_t rows() const noexcept;      ///< rows 0 .. rows()-1 are in the file
  void append(const StoredSector& sector);  ///< as row rows(); committed every few rows
  void commit();
  /// Features of all rows, [row][feature].
  std::vector<float> features();
  /// Completes the file under its own name and removes the partial one. @throws OutputError
  void finish(const FeatureScale& scale);

 private:
  struct State;
  std::unique_ptr<State> state_;
};

class DatabaseReader {
 public:
  /// @throws InputError: no such file, not a database of this kind, other version, unfinished, damaged
  explicit DatabaseReader(std::filesystem::path file);
  ~DatabaseReader();
  DatabaseReader(const DatabaseReader&) = delete;
  DatabaseReader& operator=(const DatabaseReader&) = delete;

  const std::filesystem::path& file() const noexcept { return file_; }
  const DatabaseMetadata& metadata() const noexcept { return metadata_; }
  const FeatureScale& feature_scale() const noexcept { return feature_scale_; }
  const RecordShape& shape() const noexcept { return shape_; }

  /// Every row in order, verified. @throws InputError naming the row
  void for_each(const std::function<void(std::uint64_t id, const StoredSector&)>& visit) const;

 private:
  struct Connection;
  std::filesystem::path file_;
  std::unique_ptr<Connection> connection_;
  DatabaseMetadata metadata_;
  FeatureScale feature_scale_;
  RecordShape shape_;
};

}  // namespace pelage
