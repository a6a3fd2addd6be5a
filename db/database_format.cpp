#include "pelage/db/database_format.h"

#include <algorithm>
#include <bit>
#include <cmath>
#include <nlohmann/json.hpp>

#include "hrir_schema.h"
#include "pelage/data_schema/errors.h"
#include "pelage/data_schema/sector.h"

namespace pelage {
namespace {

static_assert(std::endian::native == std::endian::little, "BLOBs are written as they lie in memory");

constexpr std::size_t kBlobLimit = 1'000'000;

}  // namespace

std::string program_revision() {
  return PELAGE_REVISION;
}

RecordShape record_shape(const BakeSettings& settings) {
  const RecordShape shape{settings.views, settings.lights, settings.samples};
  const std::size_t bytes = shape.re_size() * bytes_per_value(settings.storage);
  if (bytes >= kBlobLimit) {
    throw InputError("bake settings", "views x lights x samples take " + std::to_string(bytes) +
                                          " bytes per record; keep them below " + std::to_string(kBlobLimit));
  }
  return shape;
}

StoredSector copy_of(const SectorView& s) {
  return {{s.features.begin(), s.features.end()},
          {s.crossings.begin(), s.crossings.end()},
          {s.tau.scale, {s.tau.bytes.begin(), s.tau.bytes.end()}},
          {s.re.scale, {s.re.bytes.begin(), s.re.bytes.end()}}};
}

RowRange shard_of(std::uint64_t rows, int shard, int shards) {
  if (shards < 1 || shard < 1 || shard > shards) {
    throw UsageError("shard " + std::to_string(shard) + "/" + std::to_string(shards) +
                     ": give i/n with 1 <= i <= n, e.g. 1/4");
  }
  const auto i = static_cast<std::uint64_t>(shard), n = static_cast<std::uint64_t>(shards);
  if (n > rows) {
    throw UsageError("shard " + std::to_string(shard) + "/" + std::to_string(shards) + ": there are only " +
                     std::to_string(rows) + " records to share out");
  }
  return {rows * (i - 1) / n, rows * i / n};
}

std::filesystem::path partial_of(const std::filesystem::path& out) {
  std::filesystem::path partial = out;
  partial += ".partial";
  return partial;
}

namespace format {
namespace {

using sqlite::Blame;
using sqlite::Session;
using sqlite::Statement;

constexpr int kApplicationId = 0x506C6765;  // 'Plge'
constexpr int kVersion = 2;

/// type, name and text of every statement of the schema.
std::string schema_text(const Session& session) {
  std::string all;
  Statement statement(session, "SELECT type, name, sql FROM sqlite_schema ORDER BY type, name");
  while (statement.step()) all += statement.text(0) + ' ' + statement.text(1) + ' ' + statement.text(2) + '\n';
  return all;
}

std::string schema_of_this_build() {
  const Session memory(":memory:", SQLITE_OPEN_READWRITE | SQLITE_OPEN_MEMORY, Blame::output);
  memory.run(embedded::hrir_sql);
  return schema_text(memory);
}

std::uint64_t checksum(const Stored& stored) {
  const DatabaseMetadata& m = stored.metadata;
  Checksum sum;
  for (const std::string& text : {to_json(m.settings), m.revision, m.source, m.source_name, m.source_hash}) {
    sum.add(text.data(), text.size());
  }
  for (const std::uint64_t number : {m.sectors, stored.planned.first, stored.planned.end}) {
    sum.add(&number, sizeof number);
  }
  sum.add(stored.scales.data(), stored.scales.size() * sizeof(double));
  return sum.value();
}

/// Densities of as many strands as a row can list stay below; NaN fails too.
bool all_features(std::span<const float> values) {
  return std::all_of(values.begin(), values.end(), [](float v) { return std::abs(v) <= 1e6F; });
}

bool all_in_reach(std::span<const glm::vec2> crossings) {
  constexpr float kLow = -kSectorMargin - 1e-4F, kHigh = 1 + kSectorMargin + 1e-4F;
  return std::all_of(crossings.begin(), crossings.end(),
                     [](glm::vec2 p) { return p.x >= kLow && p.x <= kHigh && p.y >= kLow && p.y <= kHigh; });
}

/// Finite and not negative, all of them. Without an early way out, so that it vectorises.
bool holds_halves(std::span<const std::uint8_t> bytes) {
  unsigned bad = 0;
  for (std::size_t i = 0; i + 1 < bytes.size(); i += 2) bad |= static_cast<unsigned>(bytes[i + 1] >= 0x7C);
  return bad == 0;
}

}  // namespace

void begin(const Session& session, const DatabaseMetadata& m, RowRange planned) {
  session.run("BEGIN IMMEDIATE;" + std::string(embedded::hrir_sql));
  Statement insert(session, "INSERT INTO metadata VALUES (1, ?1, ?2, ?3, ?4, ?5, ?6, ?7, ?8, NULL, ?9)");
  int i = 0;
  for (const std::string& text : {to_json(m.settings), m.revision, m.source, m.source_name, m.source_hash}) {
    insert.bind(++i, text);
  }
  for (const std::uint64_t number : {m.sectors, planned.first, planned.end}) insert.bind(++i, as_sqlite(number));
  insert.bind(++i, as_sqlite(checksum({m, planned, {}})));
  insert.execute();
  session.run("COMMIT");
}

void check_kind(const Session& session) {
  const std::string file = session.file().string();
  const auto id = session.pragma("application_id");
  if (id != kApplicationId) {
    throw InputError(file, "not an HRIR database: application_id " + std::to_string(id) + ", expected " +
                               std::to_string(kApplicationId) + " ('Plge')");
  }
  const auto version = session.pragma("user_version");
  if (version != kVersion) {
    throw InputError(file, "schema version " + std::to_string(version) + ", this build reads " +
                               std::to_string(kVersion) + ": bake it again" +
                               (version > kVersion ? ", or read it with the newer program" : ""));
  }
  if (schema_text(session) != schema_of_this_build()) {
    throw InputError(file,
                     "its tables are not those of schema version " + std::to_string(kVersion) + ": bake it again");
  }
}

bool is_bake_or_empty(const Session& session) {
  return session.pragma("application_id") == kApplicationId || session.pragma("schema_version") == 0;
}

Stored read_metadata(const Session& session) {
  const std::string where = session.file().string();
  Statement row(session,
                "SELECT settings, revision, source, source_name, source_hash, sectors, first_row, end_row, "
                "feature_scales, checksum FROM metadata WHERE id = 1");
  if (!row.step()) throw InputError(where, "no metadata: bake it again");
  Stored stored;
  DatabaseMetadata& m = stored.metadata;
  m.settings = bake_settings_from_json(row.text(0), where + " (settings)");
  m.revision = row.text(1);
  m.source = row.text(2);
  m.source_name = row.text(3);
  m.source_hash = row.text(4);
  m.sectors = static_cast<std::uint64_t>(row.integer(5));
  stored.planned = {static_cast<std::uint64_t>(row.integer(6)), static_cast<std::uint64_t>(row.integer(7))};
  if (m.sectors < 1 || m.sectors > static_cast<std::uint64_t>(m.settings.sectors)) {
    throw InputError(where, "metadata says " + std::to_string(m.sectors) + " sectors, the settings " +
                                std::to_string(m.settings.sectors) + ": bake it again");
  }
  assign(stored.scales, row.bytes(8));
  if (row.integer(9) != as_sqlite(checksum(stored))) {
    throw InputError(where, "metadata does not match its checksum: the file is damaged, bake it again");
  }
  if (stored.planned.first >= stored.planned.end || stored.planned.end > m.sectors) {
    throw InputError(where, "is for rows " + text(stored.planned) + " of " + std::to_string(m.sectors) +
                                ", which there are not: bake it again");
  }
  return stored;
}

void write_scales(const Session& session, Stored stored, const FeatureScale& scale) {
  stored.scales = scale.mean;
  stored.scales.insert(stored.scales.end(), scale.inv_sigma.begin(), scale.inv_sigma.end());
  Statement update(session, "UPDATE metadata SET feature_scales = ?1, checksum = ?2 WHERE id = 1");
  update.bind(1, stored.scales.data(), stored.scales.size() * sizeof(double));
  update.bind(2, as_sqlite(checksum(stored)));
  update.execute();
}

FeatureScale scale_of(const std::vector<double>& scales, FeatureSet set, const std::filesystem::path& file) {
  const auto n = static_cast<std::ptrdiff_t>(dimension(set));
  const auto good = [&](double v) { return std::isfinite(v); };
  if (static_cast<std::ptrdiff_t>(scales.size()) != 2 * n || !std::all_of(scales.begin(), scales.end(), good)) {
    throw InputError(file.string(), "its feature scales are incomplete or not finite: bake it again");
  }
  return {{scales.begin(), scales.begin() + n}, {scales.begin() + n, scales.end()}};
}

std::string difference(const DatabaseMetadata& a, const std::string& name_a, const DatabaseMetadata& b,
                       const std::string& name_b) {
  const auto differ = [&](const std::string& what, const std::string& in_a, const std::string& in_b) {
    return what + " is " + in_a + " " + name_a + ", " + in_b + " " + name_b;
  };
  const auto settings_a = nlohmann::json::parse(to_json(a.settings));
  const auto settings_b = nlohmann::json::parse(to_json(b.settings));
  for (const auto& [key, value] : settings_b.items()) {
    if (const auto& other = settings_a.at(key); other != value) return differ(key, other.dump(), value.dump());
  }
  const std::pair<const char*, std::string DatabaseMetadata::*> texts[] = {
      {"source", &DatabaseMetadata::source},
      {"hairstyle", &DatabaseMetadata::source_name},
      {"hairstyle hash", &DatabaseMetadata::source_hash},
      {"program", &DatabaseMetadata::revision}};
  for (const auto& [name, member] : texts) {
    if (a.*member != b.*member) return differ(name, "'" + a.*member + "'", "'" + b.*member + "'");
  }
  if (a.sectors != b.sectors) {
    return differ("number of sectors", std::to_string(a.sectors), std::to_string(b.sectors));
  }
  return {};
}

RowRange rows_of(const Session& session, RowRange planned) {
  Statement row(session,
                "SELECT (SELECT min(id) FROM sector), (SELECT max(id) FROM sector), EXISTS (SELECT 1 FROM sector)");
  row.step();
  if (row.integer(2) == 0) return {planned.first, planned.first};
  const RowRange range{static_cast<std::uint64_t>(row.integer(0)), static_cast<std::uint64_t>(row.integer(1)) + 1};
  if (range.first != planned.first || range.end > planned.end) {
    throw InputError(session.file().string(), "holds rows " + std::to_string(row.integer(0)) + " to " +
                                                  std::to_string(row.integer(1)) + ", but is for rows " +
                                                  text(planned) + ": bake it again");
  }
  return range;
}

std::string fault(const SectorView& s, const RecordShape& shape, const BakeSettings& settings) {
  const Storage storage = settings.storage;
  const int features = dimension(settings.features);
  const std::size_t unit = bytes_per_value(storage);
  if (static_cast<int>(s.features.size()) != features) {
    return std::to_string(s.features.size()) + " features, expected " + std::to_string(features);
  }
  if (!all_features(s.features)) return "a feature is not a number within 1e6";
  if (!all_in_reach(s.crossings)) return "a strand lies outside the sector's margin, or is not finite";
  if (s.tau.bytes.size() != shape.tau_size() * unit) {
    return "tau holds " + std::to_string(s.tau.bytes.size()) + " bytes, expected " +
           std::to_string(shape.tau_size() * unit);
  }
  if (s.re.bytes.size() != shape.re_size() * unit) {
    return "re holds " + std::to_string(s.re.bytes.size()) + " bytes, expected " +
           std::to_string(shape.re_size() * unit);
  }
  for (const QuantisedView* a : {&s.tau, &s.re}) {
    if (!(a->scale >= 0 && a->scale <= 1e6F)) return "scale " + std::to_string(a->scale) + " is outside [0, 1e6]";
    if (storage == Storage::half && !holds_halves(a->bytes)) return "a half is negative or not finite";
  }
  return {};
}

std::uint64_t checksum(std::uint64_t id, const SectorView& s) {
  Checksum sum;
  sum.add(&id, sizeof id);
  sum.add(s.features.data(), s.features.size_bytes());
  sum.add(s.crossings.data(), s.crossings.size_bytes());
  for (const QuantisedView* a : {&s.tau, &s.re}) {
    sum.add(&a->scale, sizeof a->scale);
    sum.add(a->bytes.data(), a->bytes.size());
  }
  return sum.value();
}

}  // namespace format
}  // namespace pelage
