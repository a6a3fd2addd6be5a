#include <system_error>

#include "pelage/data_schema/errors.h"
#include "pelage/data_schema/output_file.h"
#include "pelage/db/database_format.h"

namespace pelage {
namespace {

using sqlite::Session;
using sqlite::Statement;

constexpr std::uint64_t kRowsPerTransaction = 64;  // 34 KB rows: 2 MB, past the knee of PROTOTYPES section F

/// Rows of the partial file, which continue the range's beginning.
std::uint64_t resume(const Session& session, const DatabaseMetadata& metadata, RowRange range) {
  format::check_kind(session);
  std::vector<double> scales;
  const auto differs = format::difference(format::read_metadata(session, scales), "in the file", metadata, "now");
  if (!differs.empty()) {
    throw InputError(session.file().string(), "an unfinished bake, begun with other settings: " + differs +
                                                  "; use the same, delete it (--no-resume), or choose another output");
  }
  const RowRange rows = format::rows_of(session, metadata);
  if (rows.size() == 0) return range.first;
  Statement count(session, "SELECT count(*) FROM sector");
  count.step();
  if (count.integer(0) != format::as_sqlite(rows.size())) {
    throw InputError(session.file().string(), "rows are missing: delete it and bake again");
  }
  if (rows.first != range.first || rows.end > range.end) {
    throw InputError(session.file().string(), "an unfinished bake of another shard (rows " +
                                                  std::to_string(rows.first) + " to " + std::to_string(rows.end - 1) +
                                                  "); use the same, delete it, or choose another output");
  }
  return rows.end;
}

FeatureScale fit_scale_of_rows(const Session& session, int dimension) {
  std::vector<float> all, row;
  Statement rows(session, "SELECT features FROM sector ORDER BY id");
  while (rows.step()) {
    format::assign(row, rows.bytes(0));
    all.insert(all.end(), row.begin(), row.end());
  }
  return fit_scale(all, dimension);
}

void remove_partial(const std::filesystem::path& partial) noexcept {
  for (const char* suffix : {"", "-wal", "-shm", "-journal"}) {
    std::error_code ignored;  // a leftover is harmless: it resumes to the same bytes
    std::filesystem::remove(partial.string() + suffix, ignored);
  }
}

}  // namespace

void discard_partial(const std::filesystem::path& out) {
  const auto partial = partial_of(out);
  if (!std::filesystem::exists(partial)) return;
  {
    const Session session(partial, SQLITE_OPEN_READWRITE, sqlite::Blame::output);
    const int code = sqlite3_exec(session.db(), "BEGIN EXCLUSIVE; COMMIT", nullptr, nullptr, nullptr);
    if ((code & 0xFF) == SQLITE_BUSY || (code & 0xFF) == SQLITE_LOCKED) session.check(code);  // else: damaged, no loss
  }
  remove_partial(partial);
}

struct DatabaseWriter::State {
  std::filesystem::path out;
  DatabaseMetadata metadata;
  RecordShape shape;
  RowRange range;
  Session session;
  std::unique_ptr<Statement> insert;
  std::uint64_t next = 0, committed = 0;
  bool finished = false;
};

DatabaseWriter::DatabaseWriter(std::filesystem::path out, const DatabaseMetadata& metadata, RowRange range) {
  PELAGE_ASSERT(range.first < range.end && range.end <= metadata.sectors);
  const RecordShape shape = record_shape(metadata.settings);
  check_writable(out);
  const auto partial = partial_of(out);
  state_ = std::make_unique<State>(
      State{std::move(out), metadata, shape, range,
            Session(partial, SQLITE_OPEN_READWRITE | SQLITE_OPEN_CREATE, sqlite::Blame::output), nullptr});
  const Session& session = state_->session;
  session.run("PRAGMA locking_mode = EXCLUSIVE");
  session.run(
      "PRAGMA page_size = 4096; PRAGMA journal_mode = WAL; PRAGMA synchronous = NORMAL; BEGIN IMMEDIATE; COMMIT");
  remove_stale_temporaries(state_->out);  // the lock is ours: they are of bakes that were killed while finishing
  if (session.pragma("schema_version") == 0) format::begin(session, metadata);
  state_->next = state_->committed = resume(session, metadata, range);
  state_->insert = std::make_unique<Statement>(session, "INSERT INTO sector VALUES (?1, ?2, ?3, ?4, ?5, ?6, ?7, ?8)");
}

DatabaseWriter::~DatabaseWriter() {
  try {
    if (state_ && !state_->finished) commit();
  } catch (const std::exception&) {  // a destructor has nobody to tell; the rows are baked again
    state_->session.rollback();
  }
}

std::uint64_t DatabaseWriter::next_row() const noexcept {
  return state_->next;
}

void DatabaseWriter::append(const SectorView& sector) {
  State& s = *state_;
  PELAGE_ASSERT(s.next < s.range.end);
  const std::string why = format::fault(sector, s.shape, s.metadata.settings);
  if (!why.empty()) throw InputError("sector " + std::to_string(s.next), why + "; the record is not stored");
  if (s.next == s.committed) s.session.run("BEGIN");
  Statement& insert = *s.insert;
  insert.bind(1, format::as_sqlite(s.next));
  insert.bind(2, sector.features.data(), sector.features.size_bytes());
  insert.bind(3, sector.crossings.data(), sector.crossings.size_bytes());
  insert.bind(4, sector.tau.bytes.data(), sector.tau.bytes.size());
  insert.bind(5, static_cast<double>(sector.tau.scale));
  insert.bind(6, sector.re.bytes.data(), sector.re.bytes.size());
  insert.bind(7, static_cast<double>(sector.re.scale));
  insert.bind(8, format::as_sqlite(format::checksum(s.next, sector)));
  insert.execute();
  ++s.next;
  if (s.next - s.committed >= kRowsPerTransaction) commit();
}

void DatabaseWriter::commit() {
  if (state_->next == state_->committed) return;
  state_->session.run("COMMIT");
  state_->committed = state_->next;
}

void DatabaseWriter::finish() {
  State& s = *state_;
  PELAGE_ASSERT(s.next == s.range.end);
  commit();
  if (s.range == RowRange{0, s.metadata.sectors}) {
    format::write_scales(s.session, s.metadata, fit_scale_of_rows(s.session, dimension(s.metadata.settings.features)));
  }
  AtomicFile file(s.out);
  {
    Statement vacuum(s.session, "VACUUM INTO ?1");
    vacuum.bind(1, file.temporary().string());
    vacuum.execute();
  }
  file.commit();
  s.finished = true;
  s.insert.reset();
  s.session.close();
  remove_partial(s.session.file());
}

}  // namespace pelage
