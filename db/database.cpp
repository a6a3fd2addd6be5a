#include "pelage/db/database.h"

#include <sqlite3.h>

#include <algorithm>
#include <bit>
#include <cmath>
#include <cstring>
#include <nlohmann/json.hpp>
#include <string_view>
#include <system_error>

#include "hrir_schema.h"
#include "pelage/data_schema/errors.h"
#include "pelage/data_schema/output_file.h"
#include "pelage/data_schema/sector.h"

namespace pelage {
namespace {

static_assert(std::endian::native == std::endian::little, "BLOBs are written as they lie in memory");

constexpr int kApplicationId = 0x506C6765;  // 'Plge'
constexpr int kVersion = 1;
constexpr std::uint64_t kRowsPerTransaction = 64;  // 34 KB rows: 2 MB, past the knee of PROTOTYPES section F
constexpr std::size_t kBlobLimit = 1'000'000;
constexpr std::uint64_t kMapBytes = std::uint64_t{1} << 40;  // mmap whatever the file holds

struct Close {
  void operator()(sqlite3* db) const { sqlite3_close(db); }
};
struct Finalize {
  void operator()(sqlite3_stmt* statement) const { sqlite3_finalize(statement); }
};
using Connection = std::unique_ptr<sqlite3, Close>;

/// Which of our typed errors an SQLite failure is.
enum class Blame { input, output };

[[noreturn]] void fail(Blame blame, const std::filesystem::path& file, const std::string& what) {
  if (blame == Blame::input) throw InputError(file.string(), what);
  throw OutputError(file.string(), what);
}

std::string remedy(int code) {
  switch (code & 0xFF) {
    case SQLITE_BUSY:
    case SQLITE_LOCKED:
      return "another bake is writing it: wait for it, or choose another output";
    case SQLITE_FULL:
      return "no space left: free some and run again, the bake resumes";
    case SQLITE_NOTADB:
      return "not an HRIR database (no SQLite file)";
    case SQLITE_CORRUPT:
      return "damaged: bake it again";
    default:
      return "check the path, its permissions and the disk";
  }
}

[[noreturn]] void fail(Blame blame, const std::filesystem::path& file, sqlite3* db, int code) {
  const std::string said = db != nullptr ? sqlite3_errmsg(db) : sqlite3_errstr(code);
  fail(blame, file, said + " (" + remedy(code) + ")");
}

/// A connection with the file and the kind of error that its failures are.
struct Session {
  Connection db;
  std::filesystem::path file;
  Blame blame;

  void check(int code) const {
    if (code != SQLITE_OK && code != SQLITE_ROW && code != SQLITE_DONE) fail(blame, file, db.get(), code);
  }
  void run(std::string_view sql) const {
    check(sqlite3_exec(db.get(), std::string(sql).c_str(), nullptr, nullptr, nullptr));
  }
};

class Statement {
 public:
  Statement(const Session& session, std::string_view sql) : session_(session) {
    sqlite3_stmt* raw = nullptr;
    session.check(sqlite3_prepare_v2(session.db.get(), sql.data(), static_cast<int>(sql.size()), &raw, nullptr));
    statement_.reset(raw);
  }
  bool step() {
    const int code = sqlite3_step(statement_.get());
    session_.check(code);
    return code == SQLITE_ROW;
  }
  void execute() {
    step();
    session_.check(sqlite3_reset(statement_.get()));
  }

  void bind(int i, std::int64_t v) { session_.check(sqlite3_bind_int64(statement_.get(), i, v)); }
  void bind(int i, double v) { session_.check(sqlite3_bind_double(statement_.get(), i, v)); }
  void bind(int i, const std::string& v) {
    session_.check(sqlite3_bind_text(statement_.get(), i, v.data(), static_cast<int>(v.size()), SQLITE_TRANSIENT));
  }
  void bind(int i, const void* bytes, std::size_t size) {  // stays valid until execute() returns
    session_.check(sqlite3_bind_blob64(statement_.get(), i, size == 0 ? "" : bytes, size, SQLITE_STATIC));
  }

  bool is_null(int i) { return sqlite3_column_type(statement_.get(), i) == SQLITE_NULL; }
  std::int64_t integer(int i) { return sqlite3_column_int64(statement_.get(), i); }
  double real(int i) { return sqlite3_column_double(statement_.get(), i); }
  std::string_view bytes(int i) {  // valid until the next step
    const auto* data = static_cast<const char*>(sqlite3_column_blob(statement_.get(), i));
    return {data, static_cast<std::size_t>(sqlite3_column_bytes(statement_.get(), i))};
  }
  std::string text(int i) { return std::string(bytes(i)); }

 private:
  const Session& session_;
  std::unique_ptr<sqlite3_stmt, Finalize> statement_;
};

std::int64_t pragma(const Session& session, const std::string& name) {
  Statement statement(session, "PRAGMA " + name);
  return statement.step() ? statement.integer(0) : 0;
}

Session open(const std::filesystem::path& file, int flags, Blame blame) {
  sqlite3* raw = nullptr;
  const int code = sqlite3_open_v2(file.c_str(), &raw, flags | SQLITE_OPEN_EXRESCODE, nullptr);
  Session session{Connection(raw), file, blame};
  if (code != SQLITE_OK) fail(blame, file, raw, code);
  return session;
}

/// type, name and text of every statement of the schema.
std::string schema_text(const Session& session) {
  std::string all;
  Statement statement(session, "SELECT type, name, sql FROM sqlite_schema ORDER BY type, name");
  while (statement.step()) all += statement.text(0) + ' ' + statement.text(1) + ' ' + statement.text(2) + '\n';
  return all;
}

std::string expected_schema() {
  const Session memory = open(":memory:", SQLITE_OPEN_READWRITE, Blame::output);
  memory.run(embedded::hrir_sql);
  return schema_text(memory);
}

/// Refuses files of another kind or version before a table is read.
void check_kind(const Session& session) {
  const auto id = pragma(session, "application_id");
  if (id != kApplicationId) {
    throw InputError(session.file.string(), "not an HRIR database: application_id " + std::to_string(id) +
                                                ", expected " + std::to_string(kApplicationId) + " ('Plge')");
  }
  const auto version = pragma(session, "user_version");
  if (version != kVersion) {
    throw InputError(session.file.string(), "schema version " + std::to_string(version) + ", this build reads " +
                                                std::to_string(kVersion) + ": bake it again");
  }
  if (schema_text(session) != expected_schema()) {
    throw InputError(session.file.string(), "its tables are not those of schema version 1: bake it again");
  }
}

std::int64_t as_sqlite(std::uint64_t v) {
  return std::bit_cast<std::int64_t>(v);
}

void add_text(Checksum& sum, std::string_view text) {
  sum.add(text.data(), text.size());
}

std::uint64_t checksum(const DatabaseMetadata& m, const std::vector<double>& scales) {
  Checksum sum;
  for (const std::string& text : {to_json(m.settings), m.revision, m.source, m.source_name, m.source_hash}) {
    add_text(sum, text);
  }
  sum.add(&m.sectors, sizeof m.sectors);
  sum.add(scales.data(), scales.size() * sizeof(double));
  return sum.value();
}

std::uint64_t checksum(std::uint64_t id, const StoredSector& s) {
  Checksum sum;
  sum.add(&id, sizeof id);
  sum.add(s.features.data(), s.features.size() * sizeof(float));
  sum.add(s.crossings.data(), s.crossings.size() * sizeof(glm::vec2));
  for (const QuantisedArray* a : {&s.tau, &s.re}) {
    sum.add(&a->scale, sizeof a->scale);
    sum.add(a->bytes.data(), a->bytes.size());
  }
  return sum.value();
}

template <class T>
std::vector<T> array_of(std::string_view bytes) {
  std::vector<T> values(bytes.size() / sizeof(T));
  if (!values.empty()) std::memcpy(values.data(), bytes.data(), values.size() * sizeof(T));
  return values;
}

bool all_finite(const std::vector<float>& values) {
  return std::all_of(values.begin(), values.end(), [](float v) { return std::isfinite(v); });
}

bool all_in_reach(const std::vector<glm::vec2>& crossings) {
  constexpr float kLow = -kSectorMargin - 1e-4F, kHigh = 1 + kSectorMargin + 1e-4F;
  return std::all_of(crossings.begin(), crossings.end(),
                     [](glm::vec2 p) { return p.x >= kLow && p.x <= kHigh && p.y >= kLow && p.y <= kHigh; });
}

bool holds_halves(const QuantisedArray& array) {  // finite and not negative
  for (std::size_t i = 1; i < array.bytes.size(); i += 2) {
    if (array.bytes[i] >= 0x7C) return false;
  }
  return true;
}

/// Why a row is not to be trusted or written; empty: it is fine.
std::string fault(const StoredSector& s, const RecordShape& shape, const BakeSettings& settings) {
  const Storage storage = settings.storage;
  const int features = dimension(settings.features);
  const std::size_t unit = bytes_per_value(storage);
  if (static_cast<int>(s.features.size()) != features) {
    return std::to_string(s.features.size()) + " features, expected " + std::to_string(features);
  }
  if (!all_finite(s.features)) return "a feature is not finite";
  if (!all_in_reach(s.crossings)) return "a strand lies outside the sector's margin, or is not finite";
  if (s.tau.bytes.size() != shape.tau_size() * unit) {
    return "tau holds " + std::to_string(s.tau.bytes.size()) + " bytes, expected " +
           std::to_string(shape.tau_size() * unit);
  }
  if (s.re.bytes.size() != shape.re_size() * unit) {
    return "re holds " + std::to_string(s.re.bytes.size()) + " bytes, expected " +
           std::to_string(shape.re_size() * unit);
  }
  for (const QuantisedArray* a : {&s.tau, &s.re}) {
    if (!(a->scale >= 0 && a->scale <= 1e6F)) return "scale " + std::to_string(a->scale) + " is outside [0, 1e6]";
    if (storage == Storage::half && !holds_halves(*a)) return "a half is negative or not finite";
  }
  return {};
}

DatabaseMetadata read_metadata(const Session& session, std::vector<double>& scales) {
  const std::string where = session.file.string();
  Statement row(session,
                "SELECT settings, revision, source, source_name, source_hash, sectors, feature_scales, checksum "
                "FROM metadata WHERE id = 1");
  if (!row.step()) throw InputError(where, "no metadata: bake it again");
  DatabaseMetadata m;
  m.settings = bake_settings_from_json(row.text(0), where + " (settings)");
  m.revision = row.text(1);
  m.source = row.text(2);
  m.source_name = row.text(3);
  m.source_hash = row.text(4);
  m.sectors = static_cast<std::uint64_t>(row.integer(5));
  if (m.sectors < 1 || m.sectors > static_cast<std::uint64_t>(m.settings.sectors)) {
    throw InputError(where, "metadata says " + std::to_string(m.sectors) + " sectors, the settings " +
                                std::to_string(m.settings.sectors) + ": bake it again");
  }
  scales = array_of<double>(row.bytes(6));
  if (row.integer(7) != as_sqlite(checksum(m, scales))) {
    throw InputError(where, "metadata does not match its checksum: the file is damaged, bake it again");
  }
  return m;
}

/// "seed is 1 in the file, 2 now"; empty: equal.
std::string difference(const DatabaseMetadata& theirs, const DatabaseMetadata& ours) {
  const auto differ = [](const std::string& name, const std::string& a, const std::string& b) {
    return name + " is " + a + " in the file, " + b + " now";
  };
  const auto a = nlohmann::json::parse(to_json(theirs.settings));
  const auto b = nlohmann::json::parse(to_json(ours.settings));
  for (const auto& [key, value] : b.items()) {
    const auto other = a.find(key);
    if (other == a.end() || *other != value)
      return differ(key, other == a.end() ? "absent" : other->dump(), value.dump());
  }
  const std::pair<const char*, std::string DatabaseMetadata::*> texts[] = {
      {"source", &DatabaseMetadata::source},
      {"hairstyle", &DatabaseMetadata::source_name},
      {"hairstyle hash", &DatabaseMetadata::source_hash},
      {"program", &DatabaseMetadata::revision}};
  for (const auto& [name, member] : texts) {
    if (theirs.*member != ours.*member) return differ(name, "'" + theirs.*member + "'", "'" + ours.*member + "'");
  }
  if (theirs.sectors != ours.sectors) {
    return differ("number of sectors", std::to_string(theirs.sectors), std::to_string(ours.sectors));
  }
  return {};
}

std::filesystem::path partial_of(const std::filesystem::path& out) {
  std::filesystem::path partial = out;
  partial += ".partial";
  return partial;
}

void sum_up(const Session& session, const DatabaseMetadata& m, const FeatureScale& scale) {
  std::vector<double> scales = scale.mean;
  scales.insert(scales.end(), scale.inv_sigma.begin(), scale.inv_sigma.end());
  Statement update(session, "UPDATE metadata SET feature_scales = ?1, checksum = ?2 WHERE id = 1");
  update.bind(1, scales.data(), scales.size() * sizeof(double));
  update.bind(2, as_sqlite(checksum(m, scales)));
  update.execute();
}

/// Creates tables and the metadata row, in one transaction: a partial file is either empty or begun.
void begin(const Session& session, const DatabaseMetadata& m) {
  std::string schema(embedded::hrir_sql);
  session.run("BEGIN IMMEDIATE;" + schema);
  Statement insert(session, "INSERT INTO metadata VALUES (1, ?1, ?2, ?3, ?4, ?5, ?6, NULL, ?7)");
  int i = 0;
  for (const std::string& text : {to_json(m.settings), m.revision, m.source, m.source_name, m.source_hash}) {
    insert.bind(++i, text);
  }
  insert.bind(6, as_sqlite(m.sectors));
  insert.bind(7, as_sqlite(checksum(m, {})));
  insert.execute();
  session.run("COMMIT");
}

FeatureScale scale_of(const std::vector<double>& scales, FeatureSet set, const std::filesystem::path& file) {
  const auto n = static_cast<std::ptrdiff_t>(dimension(set));
  const auto good = [&](double v) { return std::isfinite(v); };
  if (static_cast<std::ptrdiff_t>(scales.size()) != 2 * n || !std::all_of(scales.begin(), scales.end(), good)) {
    throw InputError(file.string(), "its feature scales are incomplete or not finite: bake it again");
  }
  return {{scales.begin(), scales.begin() + n}, {scales.begin() + n, scales.end()}};
}

void harden(const Session& session) {
  sqlite3_db_config(session.db.get(), SQLITE_DBCONFIG_DEFENSIVE, 1, nullptr);
  sqlite3_db_config(session.db.get(), SQLITE_DBCONFIG_TRUSTED_SCHEMA, 0, nullptr);
  session.run("PRAGMA cell_size_check = ON");
}

}  // namespace

void Checksum::add(const void* bytes, std::size_t size) noexcept {
  const auto* at = static_cast<const unsigned char*>(bytes);
  std::uint64_t word = 0;
  std::size_t left = size;
  for (; left >= sizeof word; left -= sizeof word, at += sizeof word) {
    std::memcpy(&word, at, sizeof word);
    mix(word);
  }
  word = 0;
  if (left > 0) std::memcpy(&word, at, left);
  mix(word);
  mix(size);
}

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

// ---------------------------------------------------------------------------------------------------------------------

struct DatabaseWriter::State {
  std::filesystem::path out;
  DatabaseMetadata metadata;
  RecordShape shape;
  Session session;
  std::unique_ptr<Statement> insert;
  std::uint64_t rows = 0, committed = 0;
  bool finished = false;
};

DatabaseWriter::DatabaseWriter(std::filesystem::path out, const DatabaseMetadata& metadata) {
  const RecordShape shape = record_shape(metadata.settings);
  check_writable(out);
  const auto partial = partial_of(out);
  state_ =
      std::make_unique<State>(State{std::move(out), metadata, shape,
                                    open(partial, SQLITE_OPEN_READWRITE | SQLITE_OPEN_CREATE, Blame::output), nullptr});
  const Session& session = state_->session;
  session.run("PRAGMA locking_mode = EXCLUSIVE");
  harden(session);
  session.run(
      "PRAGMA page_size = 4096; PRAGMA journal_mode = WAL; PRAGMA synchronous = NORMAL; BEGIN IMMEDIATE; COMMIT");
  if (pragma(session, "schema_version") == 0) {
    begin(session, metadata);
  } else {
    check_kind(session);
    std::vector<double> scales;
    const std::string differs = difference(read_metadata(session, scales), metadata);
    if (!differs.empty()) {
      throw InputError(partial.string(), "an unfinished bake, begun with other settings: " + differs +
                                             "; use the same, delete it, or choose another output");
    }
  }
  Statement count(session, "SELECT count(*), coalesce(max(id) + 1, 0) FROM sector");
  count.step();
  if (count.integer(0) != count.integer(1))
    throw InputError(partial.string(), "rows are missing: delete it and bake again");
  state_->rows = state_->committed = static_cast<std::uint64_t>(count.integer(0));
  state_->insert = std::make_unique<Statement>(session, "INSERT INTO sector VALUES (?1, ?2, ?3, ?4, ?5, ?6, ?7, ?8)");
}

DatabaseWriter::~DatabaseWriter() {
  try {
    if (state_ && !state_->finished) commit();
  } catch (const std::exception&) {  // a destructor has nobody to tell; the rows are baked again
    sqlite3_exec(state_->session.db.get(), "ROLLBACK", nullptr, nullptr, nullptr);
  }
}

std::uint64_t DatabaseWriter::rows() const noexcept {
  return state_->rows;
}

void DatabaseWriter::append(const StoredSector& sector) {
  State& s = *state_;
  const std::string why = fault(sector, s.shape, s.metadata.settings);
  if (!why.empty()) throw InputError("sector " + std::to_string(s.rows), why + "; the record is not stored");
  if (s.rows == s.committed) s.session.run("BEGIN");
  Statement& insert = *s.insert;
  insert.bind(1, as_sqlite(s.rows));
  insert.bind(2, sector.features.data(), sector.features.size() * sizeof(float));
  insert.bind(3, sector.crossings.data(), sector.crossings.size() * sizeof(glm::vec2));
  insert.bind(4, sector.tau.bytes.data(), sector.tau.bytes.size());
  insert.bind(5, static_cast<double>(sector.tau.scale));
  insert.bind(6, sector.re.bytes.data(), sector.re.bytes.size());
  insert.bind(7, static_cast<double>(sector.re.scale));
  insert.bind(8, as_sqlite(checksum(s.rows, sector)));
  insert.execute();
  ++s.rows;
  if (s.rows - s.committed >= kRowsPerTransaction) commit();
}

void DatabaseWriter::commit() {
  if (state_->rows == state_->committed) return;
  state_->session.run("COMMIT");
  state_->committed = state_->rows;
}

std::vector<float> DatabaseWriter::features() {
  std::vector<float> all;
  Statement rows(state_->session, "SELECT features FROM sector ORDER BY id");
  while (rows.step()) {
    const auto row = array_of<float>(rows.bytes(0));
    all.insert(all.end(), row.begin(), row.end());
  }
  return all;
}

void DatabaseWriter::finish(const FeatureScale& scale) {
  State& s = *state_;
  PELAGE_ASSERT(s.rows == s.metadata.sectors);
  commit();
  sum_up(s.session, s.metadata, scale);
  AtomicFile file(s.out);
  {
    Statement vacuum(s.session, "VACUUM INTO ?1");
    vacuum.bind(1, file.temporary().string());
    vacuum.execute();
  }
  file.commit();
  s.finished = true;
  s.insert.reset();
  s.session.db.reset();
  for (const char* suffix : {"", "-wal", "-shm", "-journal"}) {
    std::error_code ignored;  // the result is in place; a leftover is harmless and resumes to the same bytes
    std::filesystem::remove(s.session.file.string() + suffix, ignored);
  }
}

// ---------------------------------------------------------------------------------------------------------------------

struct DatabaseReader::Connection {
  Session session;
};

DatabaseReader::DatabaseReader(std::filesystem::path file) : file_(std::move(file)) {
  std::error_code error;
  if (!std::filesystem::is_regular_file(file_, error)) throw InputError(file_.string(), "no such file");
  connection_ = std::make_unique<Connection>(Connection{open(file_, SQLITE_OPEN_READONLY, Blame::input)});
  const Session& session = connection_->session;
  harden(session);
  session.run("PRAGMA mmap_size = " + std::to_string(kMapBytes));
  check_kind(session);
  std::vector<double> scales;
  metadata_ = read_metadata(session, scales);
  if (scales.empty()) throw InputError(file_.string(), "an unfinished bake: run the same bake again to complete it");
  feature_scale_ = scale_of(scales, metadata_.settings.features, file_);
  shape_ = record_shape(metadata_.settings);
  const std::uint64_t least = metadata_.sectors * shape_.re_size() * bytes_per_value(metadata_.settings.storage);
  const std::uint64_t size = std::filesystem::file_size(file_);
  if (size < least) {
    throw InputError(file_.string(), std::to_string(size) + " bytes cannot hold its " +
                                         std::to_string(metadata_.sectors) + " records: bake it again");
  }
}

DatabaseReader::~DatabaseReader() = default;

void DatabaseReader::for_each(const std::function<void(std::uint64_t, const StoredSector&)>& visit) const {
  Statement row(connection_->session,
                "SELECT id, features, crossings, tau, tau_scale, re, re_scale, checksum FROM sector ORDER BY id");
  std::uint64_t id = 0;
  StoredSector s;
  for (; row.step(); ++id) {
    const auto refuse = [&](const std::string& why) {
      throw InputError(file_.string(), "sector " + std::to_string(id) + ": " + why + ": bake it again");
    };
    if (id >= metadata_.sectors || row.integer(0) != as_sqlite(id)) refuse("rows are missing or too many");
    s.features = array_of<float>(row.bytes(1));
    s.crossings = array_of<glm::vec2>(row.bytes(2));
    s.tau = {static_cast<float>(row.real(4)), array_of<std::uint8_t>(row.bytes(3))};
    s.re = {static_cast<float>(row.real(6)), array_of<std::uint8_t>(row.bytes(5))};
    const std::string why = fault(s, shape_, metadata_.settings);
    if (!why.empty()) refuse(why);
    if (row.integer(7) != as_sqlite(checksum(id, s))) refuse("does not match its checksum, the file is damaged");
    visit(id, s);
  }
  if (id != metadata_.sectors) {
    throw InputError(file_.string(), std::to_string(id) + " of " + std::to_string(metadata_.sectors) +
                                         " records are there: bake it again");
  }
}

}  // namespace pelage
