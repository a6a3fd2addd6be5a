// Private to this box: SQLite with our typed errors, opened hardened against hostile files. With database_*.cpp the
// only user of <sqlite3.h>.
#pragma once

#include <sqlite3.h>

#include <cstdint>
#include <filesystem>
#include <memory>
#include <string>
#include <string_view>

namespace pelage::sqlite {

/// Which of our typed errors a failure is.
enum class Blame { input, output };

/// A connection with the file and the kind of error that its failures are.
class Session {
 public:
  /// Defensive, untrusted schema, checked cells, and limits that our own statements and rows keep by far.
  /// @throws InputError or OutputError
  Session(const std::filesystem::path& file, int flags, Blame blame);

  const std::filesystem::path& file() const noexcept { return file_; }
  sqlite3* db() const noexcept { return db_.get(); }
  void check(int code) const;  ///< @throws for anything but ok, row, done
  void run(std::string_view sql) const;
  std::int64_t pragma(const std::string& name) const;
  void rollback() const noexcept;
  void close() noexcept { db_.reset(); }

 private:
  struct Close {
    void operator()(sqlite3* db) const { sqlite3_close(db); }
  };
  std::unique_ptr<sqlite3, Close> db_;
  std::filesystem::path file_;
  Blame blame_;
};

class Statement {
 public:
  Statement(const Session& session, std::string_view sql);

  bool step();  ///< true: there is a row
  void execute();

  void bind(int i, std::int64_t v) { session_.check(sqlite3_bind_int64(statement_.get(), i, v)); }
  void bind(int i, double v) { session_.check(sqlite3_bind_double(statement_.get(), i, v)); }
  void bind(int i, const std::string& v);
  void bind(int i, const void* bytes, std::size_t size);  ///< they stay valid until execute() returns

  std::int64_t integer(int i) { return sqlite3_column_int64(statement_.get(), i); }
  double real(int i) { return sqlite3_column_double(statement_.get(), i); }
  /// Valid until the next step; a BLOB that fills several pages was put together in SQLite's own buffer.
  /// @throws when there is no memory for that
  std::string_view bytes(int i);
  std::string text(int i) { return std::string(bytes(i)); }

 private:
  struct Finalize {
    void operator()(sqlite3_stmt* statement) const { sqlite3_finalize(statement); }
  };
  const Session& session_;
  std::unique_ptr<sqlite3_stmt, Finalize> statement_;
};

}  // namespace pelage::sqlite
