// Private to this box: what the writer and the readers of HRIR-DB agree on. Metadata row, row checks, checksums.
#pragma once

#include <cstring>
#include <string>
#include <string_view>
#include <vector>

#include "pelage/db/database.h"
#include "pelage/db/sqlite_session.h"

namespace pelage::format {

/// The metadata row.
struct Stored {
  DatabaseMetadata metadata;
  RowRange planned;            // rows that the file is for
  std::vector<double> scales;  // means and inverse deviations of the features; empty when unfinished
};

/// Creates tables and the metadata row, in one transaction: a partial file is either empty or begun.
void begin(const sqlite::Session& session, const DatabaseMetadata& metadata, RowRange planned);

/// Refuses files of another kind, version or schema before a table of ours is read.
void check_kind(const sqlite::Session& session);

/// What may be thrown away as an interrupted bake: ours, or a file without anything in it.
bool is_bake_or_empty(const sqlite::Session& session);

/// Its checksum verified. @throws InputError
Stored read_metadata(const sqlite::Session& session);
void write_scales(const sqlite::Session& session, Stored stored, const FeatureScale& scale);
FeatureScale scale_of(const std::vector<double>& scales, FeatureSet set, const std::filesystem::path& file);

/// "seed is 1 in a.hrir, 2 in b.hrir"; empty: equal.
std::string difference(const DatabaseMetadata& a, const std::string& name_a, const DatabaseMetadata& b,
                       const std::string& name_b);

/// From the first row to the last that is there, from planned.first on; whether all between are there shows when they
/// are read. @throws InputError for rows that the file is not for
RowRange rows_of(const sqlite::Session& session, RowRange planned);

/// Why a row is not to be trusted or written; empty: it is fine.
std::string fault(const SectorView& sector, const RecordShape& shape, const BakeSettings& settings);
std::uint64_t checksum(std::uint64_t id, const SectorView& sector);

inline std::string text(RowRange rows) {
  return rows.size() == 0 ? "none" : std::to_string(rows.first) + " to " + std::to_string(rows.end - 1);
}

inline std::int64_t as_sqlite(std::uint64_t v) {
  return static_cast<std::int64_t>(v);
}

/// A copy, aligned; a rest shorter than T is left out.
template <class T>
void assign(std::vector<T>& values, std::string_view bytes) {
  values.resize(bytes.size() / sizeof(T));
  if (!values.empty()) std::memcpy(values.data(), bytes.data(), values.size() * sizeof(T));
}

}  // namespace pelage::format
