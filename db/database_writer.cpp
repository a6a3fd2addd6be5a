#include <unistd.h>

#include <new>

#include "pelage/data_schema/errors.h"
#include "pelage/data_schema/output_file.h"
#include "pelage/db/database_format.h"

namespace pelage {
namespace {

using sqlite::Session;
using sqlite::Statement;

constexpr std::uint64_t kRowsPerTransaction = 64;  // 34 KB rows: 2 MB, past the knee of PROTOTYPES section F

/// Rows of the partial file, which continue the range's beginning.
std::uint64_t resume(const Session& session, const format::Stored& ours) {
  format::check_kind(session);
  const format::Stored theirs = format::read_metadata(session);
  std::string differs = format::difference(theirs.metadata, "in the file", ours.metadata, "now");
  if (differs.empty() && theirs.planned != ours.planned) {
    differs = "the part of the " + std::to_string(ours.metadata.sectors) + " records is " +
              format::text(theirs.planned) + " in the file, " + format::text(ours.planned) + " now (--shard)";
  }
  if (!differs.empty()) {
    throw InputError(session.file().string(), "an unfinished bake, begun with other settings: " + differs +
                                                  "; use the same (--resume does), delete it (--no-resume), or choose "
                                                  "another output");
  }
  const RowRange rows = format::rows_of(session, ours.planned);
  Statement count(session, "SELECT count(*) FROM sector");
  count.step();
  if (count.integer(0) != format::as_sqlite(rows.size())) {
    throw InputError(session.file().string(), "rows are missing: delete it and bake again");
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

/// Locked for this connection alone until it closes; what a killed bake left in the WAL is recovered.
constexpr const char* kLock = "PRAGMA locking_mode = EXCLUSIVE; BEGIN IMMEDIATE; COMMIT";

/// Takes the name away first, while the lock is ours: whoever waits for the lock finds that the file has gone and
/// begins another (open_locked).
void remove_locked(Session& session) noexcept {
  // No WAL any more, which closing would remove by its name, though another bake's by then.
  const int code = sqlite3_exec(session.db(), "PRAGMA journal_mode = DELETE", nullptr, nullptr, nullptr);
  unlink(session.file().c_str());
  session.close();
  if (code == SQLITE_OK) return;
  try {
    for (const char* suffix : {"-wal", "-shm", "-journal"}) unlink((session.file().string() + suffix).c_str());
  } catch (const std::bad_alloc&) {  // a leftover is harmless
  }
}

Session open_locked(const std::filesystem::path& partial) {
  for (int attempt = 0; attempt < 100; ++attempt) {
    Session session(partial, SQLITE_OPEN_READWRITE | SQLITE_OPEN_CREATE, sqlite::Blame::output);
    session.run("PRAGMA page_size = 4096");
    session.run(kLock);
    if (std::filesystem::exists(partial)) return session;
  }
  throw OutputError(partial.string(), "is removed again and again: choose another output");
}

}  // namespace

void discard_partial(const std::filesystem::path& out) {
  const auto partial = partial_of(out);
  if (!std::filesystem::exists(partial)) return;
  Session session(partial, SQLITE_OPEN_READWRITE, sqlite::Blame::output);
  const int code = sqlite3_exec(session.db(), kLock, nullptr, nullptr, nullptr);
  if ((code & 0xFF) == SQLITE_BUSY || (code & 0xFF) == SQLITE_LOCKED) session.check(code);
  if (code != SQLITE_OK || !format::is_bake_or_empty(session)) {
    throw InputError(partial.string(), "is no interrupted bake, or too damaged to tell: move it away yourself");
  }
  remove_locked(session);
}

struct DatabaseWriter::State {
  std::filesystem::path out;
  format::Stored stored;
  RecordShape shape;
  Session session;
  std::unique_ptr<Statement> insert;
  std::uint64_t next = 0, committed = 0;
  bool finished = false;
};

DatabaseWriter::DatabaseWriter(std::filesystem::path out, const DatabaseMetadata& metadata, RowRange range) {
  PELAGE_ASSERT(range.first < range.end && range.end <= metadata.sectors);
  const RecordShape shape = record_shape(metadata.settings);
  check_writable(out);
  Session locked = open_locked(partial_of(out));  // before the aggregate: GCC 12 destroys parts of one twice on a throw
  state_ = std::make_unique<State>(State{std::move(out), {metadata, range, {}}, shape, std::move(locked), nullptr});
  const Session& session = state_->session;
  session.run("PRAGMA journal_mode = WAL; PRAGMA synchronous = NORMAL");
  remove_stale_temporaries(state_->out);  // the lock is ours: they are of bakes that were killed while finishing
  if (session.pragma("schema_version") == 0) format::begin(session, metadata, range);
  state_->next = state_->committed = resume(session, state_->stored);
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
  PELAGE_ASSERT(s.next < s.stored.planned.end);
  const std::string why = format::fault(sector, s.shape, s.stored.metadata.settings);
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
  const DatabaseMetadata& metadata = s.stored.metadata;
  PELAGE_ASSERT(s.next == s.stored.planned.end);
  commit();
  if (s.stored.planned == RowRange{0, metadata.sectors}) {
    format::write_scales(s.session, s.stored, fit_scale_of_rows(s.session, dimension(metadata.settings.features)));
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
  remove_locked(s.session);
}

}  // namespace pelage
