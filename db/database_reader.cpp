#include <tbb/parallel_for.h>
#include <tbb/task_arena.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <exception>
#include <system_error>

#include "pelage/data_schema/errors.h"
#include "pelage/db/database_format.h"

namespace pelage {
namespace {

using sqlite::Session;
using sqlite::Statement;

constexpr std::uint64_t kMapBytes = std::uint64_t{1} << 40;  // mmap whatever the file holds

Session open_to_read(const std::filesystem::path& file) {
  Session session(file, SQLITE_OPEN_READONLY, sqlite::Blame::input);
  session.run("PRAGMA mmap_size = " + std::to_string(kMapBytes));
  return session;
}

std::span<const std::uint8_t> as_bytes(std::string_view blob) {
  return {reinterpret_cast<const std::uint8_t*>(blob.data()), blob.size()};
}

/// What a reader knows of the file besides its rows.
struct Known {
  const std::filesystem::path& file;
  const RecordShape& shape;
  const BakeSettings& settings;
  std::uint64_t first;  // row
};

/// Rows of `range` in order, each verified where SQLite put it together. `all_features`: [row - known.first][dimension]
/// are written too.
void read_rows(const Session& session, const Known& known, RowRange range, std::vector<float>& all_features,
               const DatabaseReader::Visit& visit) {
  Statement row(session,
                "SELECT id, features, crossings, tau, tau_scale, re, re_scale, checksum FROM sector "
                "WHERE id >= ?1 AND id < ?2 ORDER BY id");
  row.bind(1, format::as_sqlite(range.first));
  row.bind(2, format::as_sqlite(range.end));
  std::vector<float> features;
  std::vector<glm::vec2> crossings;
  std::uint64_t id = range.first;
  const auto refuse = [&](const std::string& why) {
    throw InputError(known.file.string(), "sector " + std::to_string(id) + ": " + why + ": bake it again");
  };
  for (; row.step(); ++id) {
    if (row.integer(0) != format::as_sqlite(id)) refuse("rows are missing");
    format::assign(features, row.bytes(1));
    format::assign(crossings, row.bytes(2));
    SectorView s;
    s.features = features;
    s.crossings = crossings;
    s.tau = {static_cast<float>(row.real(4)), as_bytes(row.bytes(3))};
    s.re = {static_cast<float>(row.real(6)), as_bytes(row.bytes(5))};
    const std::string why = format::fault(s, known.shape, known.settings);
    if (!why.empty()) refuse(why);
    if (row.integer(7) != format::as_sqlite(format::checksum(id, s))) {
      refuse("does not match its checksum, the file is damaged");
    }
    std::copy(features.begin(), features.end(), &all_features[(id - known.first) * features.size()]);
    visit(id, s);
  }
  if (id != range.end) refuse("rows are missing");
}

/// SQLite's own look at pages and cells.
void check_structure(const Session& session) {
  Statement check(session, "PRAGMA quick_check(1)");
  if (check.step() && check.bytes(0) == "ok") return;
  throw InputError(session.file().string(), "SQLite's quick_check says: " + check.text(0) + ": bake it again");
}

std::string unfinished(RowRange rows, RowRange planned, const DatabaseMetadata& m) {
  const std::string all = " of " + std::to_string(m.sectors) + " records";
  if (rows == planned) {
    return "is a shard, records " + format::text(rows) + all + ": merge it with the others (pelage-bake merge)";
  }
  return "is unfinished, it holds records " + format::text(rows) + " of its " + format::text(planned) +
         ": run its bake again to complete it (pelage-bake build --resume)";
}

/// Why a file cannot be read at all; empty: it can.
std::string why_unreadable(const std::filesystem::path& file) {
  std::error_code error;
  const auto status = std::filesystem::status(file, error);
  if (!std::filesystem::exists(status)) return "no such file: check the path";
  if (std::filesystem::is_directory(status)) return "is a folder: name a database in it";
  if (!std::filesystem::is_regular_file(status)) return "is no regular file: name a database";
  if (access(file.c_str(), R_OK) != 0) {
    return "cannot be read (" + std::generic_category().message(errno) + "): change its permissions";
  }
  return {};
}

}  // namespace

struct DatabaseReader::Connection {
  Session session;
};

DatabaseReader::DatabaseReader(std::filesystem::path file, Accept accept) : file_(std::move(file)) {
  if (const std::string why = why_unreadable(file_); !why.empty()) throw InputError(file_.string(), why);
  connection_ = std::make_unique<Connection>(Connection{open_to_read(file_)});
  const Session& session = connection_->session;
  format::check_kind(session);
  const format::Stored stored = format::read_metadata(session);
  metadata_ = stored.metadata;
  planned_ = stored.planned;
  shape_ = record_shape(metadata_.settings);
  rows_ = format::rows_of(session, planned_);
  if (stored.scales.empty()) {
    if (accept == Accept::finished) throw InputError(file_.string(), unfinished(rows_, planned_, metadata_));
    return;
  }
  feature_scale_ = format::scale_of(stored.scales, metadata_.settings.features, file_);
  if (rows_ != RowRange{0, metadata_.sectors}) {
    throw InputError(file_.string(), std::to_string(rows_.size()) + " of " + std::to_string(metadata_.sectors) +
                                         " records are there: bake it again");
  }
  const std::uint64_t least = rows_.size() * shape_.re_size() * bytes_per_value(metadata_.settings.storage);
  const std::uint64_t size = std::filesystem::file_size(file_);
  if (size < least && accept == Accept::finished) {
    throw InputError(file_.string(), std::to_string(size) + " bytes cannot hold its " + std::to_string(rows_.size()) +
                                         " records: bake it again");
  }
}

DatabaseReader::~DatabaseReader() = default;

/// The scales are those of the rows: they decide what the search finds, and no range says whether they are sane.
void DatabaseReader::check_scales(const std::vector<float>& features) const {
  if (feature_scale_.mean.empty() || features.empty()) return;
  const FeatureScale ours = fit_scale(features, dimension(metadata_.settings.features));
  if (ours.mean == feature_scale_.mean && ours.inv_sigma == feature_scale_.inv_sigma) return;
  throw InputError(file_.string(), "its feature scales are not those of its records: bake it again");
}

void DatabaseReader::for_each(const Visit& visit) const {
  check_structure(connection_->session);
  std::vector<float> features = room_for_features();
  read_rows(connection_->session, {file_, shape_, metadata_.settings, rows_.first}, rows_, features, visit);
  check_scales(features);
}

void DatabaseReader::for_each_concurrently(const Visit& visit) const {
  const auto threads = static_cast<std::uint64_t>(tbb::this_task_arena::max_concurrency());
  const std::uint64_t parts = std::min(rows_.size(), 2 * threads);
  if (threads == 1 || parts < 2) return for_each(visit);
  std::vector<float> features = room_for_features();
  std::vector<std::exception_ptr> errors(parts + 1);
  const auto work = [&](std::uint64_t part) {
    if (part == 0) return check_structure(connection_->session);
    const Session session = open_to_read(file_);
    if (!format::difference(metadata_, "", format::read_metadata(session).metadata, "").empty()) {
      throw InputError(file_.string(), "was replaced by another database while it was read: open it again");
    }
    const RowRange range{rows_.first + rows_.size() * (part - 1) / parts, rows_.first + rows_.size() * part / parts};
    read_rows(session, {file_, shape_, metadata_.settings, rows_.first}, range, features, visit);
  };
  tbb::parallel_for(std::uint64_t{0}, parts + 1, [&](std::uint64_t part) {
    try {
      work(part);
    } catch (...) {
      errors[part] = std::current_exception();
    }
  });
  for (const std::exception_ptr& error : errors) {  // the same one whatever the threads
    if (error) std::rethrow_exception(error);
  }
  check_scales(features);
}

std::vector<float> DatabaseReader::room_for_features() const {
  return std::vector<float>(rows_.size() * static_cast<std::size_t>(dimension(metadata_.settings.features)));
}

}  // namespace pelage
