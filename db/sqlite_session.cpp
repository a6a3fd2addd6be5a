#include "pelage/db/sqlite_session.h"

#include <new>

#include "pelage/data_schema/errors.h"

namespace pelage::sqlite {
namespace {

std::string remedy(int code, Blame blame) {
  switch (code & 0xFF) {
    case SQLITE_BUSY:
    case SQLITE_LOCKED:
      return blame == Blame::input ? "a bake is writing it: wait until it ends"
                                   : "another bake is writing it: wait for it, or choose another output";
    case SQLITE_FULL:
      return "no space left: free some and run again, the bake resumes";
    case SQLITE_NOTADB:
      return "not an HRIR database (no SQLite file)";
    case SQLITE_CORRUPT:
      return "damaged: bake it again";
    default:
      return "check the path, its permissions, and that the disk has space";
  }
}

[[noreturn]] void fail(Blame blame, const std::filesystem::path& file, sqlite3* db, int code) {
  if ((code & 0xFF) == SQLITE_NOMEM) throw std::bad_alloc();
  const std::string said = db != nullptr ? sqlite3_errmsg(db) : sqlite3_errstr(code);
  const std::string what = said + " (" + remedy(code, blame) + ")";
  if (blame == Blame::input) throw InputError(file.string(), what);
  throw OutputError(file.string(), what);
}

/// What a file may make SQLite do, far above what ours need: a row is below 1 MB, the schema has one view.
void limit(sqlite3* db) {
  constexpr std::pair<int, int> kLimits[] = {
      {SQLITE_LIMIT_LENGTH, 4'000'000}, {SQLITE_LIMIT_SQL_LENGTH, 100'000},    {SQLITE_LIMIT_COLUMN, 32},
      {SQLITE_LIMIT_EXPR_DEPTH, 32},    {SQLITE_LIMIT_COMPOUND_SELECT, 4},     {SQLITE_LIMIT_VDBE_OP, 25'000},
      {SQLITE_LIMIT_FUNCTION_ARG, 8},   {SQLITE_LIMIT_TRIGGER_DEPTH, 0},       {SQLITE_LIMIT_VARIABLE_NUMBER, 16},
      {SQLITE_LIMIT_WORKER_THREADS, 0}, {SQLITE_LIMIT_LIKE_PATTERN_LENGTH, 64}};
  for (const auto& [which, value] : kLimits) sqlite3_limit(db, which, value);
}

}  // namespace

Session::Session(const std::filesystem::path& file, int flags, Blame blame) : file_(file), blame_(blame) {
  sqlite3* raw = nullptr;
  // Absolute, so that neither "file:..." nor ":memory:" in somebody's file name means anything but a file.
  const bool in_memory = (flags & SQLITE_OPEN_MEMORY) != 0;
  const std::filesystem::path path = in_memory ? file : std::filesystem::absolute(file);
  const int code = sqlite3_open_v2(path.c_str(), &raw, flags | SQLITE_OPEN_EXRESCODE | SQLITE_OPEN_NOMUTEX, nullptr);
  db_.reset(raw);
  if (code != SQLITE_OK) fail(blame, file, raw, code);
  check(sqlite3_db_config(raw, SQLITE_DBCONFIG_DEFENSIVE, 1, nullptr));
  check(sqlite3_db_config(raw, SQLITE_DBCONFIG_TRUSTED_SCHEMA, 0, nullptr));
  check(sqlite3_db_config(raw, SQLITE_DBCONFIG_ENABLE_TRIGGER, 0, nullptr));
  limit(raw);
  run("PRAGMA cell_size_check = ON");
}

void Session::check(int code) const {
  if (code != SQLITE_OK && code != SQLITE_ROW && code != SQLITE_DONE) fail(blame_, file_, db_.get(), code);
}

void Session::run(std::string_view sql) const {
  check(sqlite3_exec(db_.get(), std::string(sql).c_str(), nullptr, nullptr, nullptr));
}

std::int64_t Session::pragma(const std::string& name) const {
  Statement statement(*this, "PRAGMA " + name);
  return statement.step() ? statement.integer(0) : 0;
}

void Session::rollback() const noexcept {
  sqlite3_exec(db_.get(), "ROLLBACK", nullptr, nullptr, nullptr);
}

Statement::Statement(const Session& session, std::string_view sql) : session_(session) {
  sqlite3_stmt* raw = nullptr;
  session.check(sqlite3_prepare_v2(session.db(), sql.data(), static_cast<int>(sql.size()), &raw, nullptr));
  statement_.reset(raw);
}

bool Statement::step() {
  const int code = sqlite3_step(statement_.get());
  session_.check(code);
  return code == SQLITE_ROW;
}

void Statement::execute() {
  step();
  session_.check(sqlite3_reset(statement_.get()));
}

void Statement::bind(int i, const std::string& v) {
  session_.check(sqlite3_bind_text(statement_.get(), i, v.data(), static_cast<int>(v.size()), SQLITE_TRANSIENT));
}

void Statement::bind(int i, const void* bytes, std::size_t size) {
  session_.check(sqlite3_bind_blob64(statement_.get(), i, size == 0 ? "" : bytes, size, SQLITE_STATIC));
}

std::string_view Statement::bytes(int i) {
  const auto* data = static_cast<const char*>(sqlite3_column_blob(statement_.get(), i));
  const auto size = static_cast<std::size_t>(sqlite3_column_bytes(statement_.get(), i));
  if (data != nullptr) return {data, size};
  if (sqlite3_errcode(session_.db()) == SQLITE_NOMEM) throw std::bad_alloc();
  return {};
}

}  // namespace pelage::sqlite
