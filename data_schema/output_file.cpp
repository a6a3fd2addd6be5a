#include "pelage/data_schema/output_file.h"

#include <dirent.h>
#include <fcntl.h>
#include <sys/stat.h>
#include <unistd.h>

#include <atomic>
#include <cerrno>
#include <cstdio>
#include <memory>
#include <new>
#include <optional>
#include <regex>
#include <string>
#include <string_view>
#include <system_error>

#include "pelage/data_schema/errors.h"

namespace pelage {
namespace fs = std::filesystem;
namespace {

std::string reason(int error) {
  return std::generic_category().message(error);
}

fs::path folder_of(const fs::path& file) {
  return file.has_parent_path() ? file.parent_path() : fs::path(".");
}

/// The file that a chain of symbolic links ends at, there or not; none where the chain has no end.
std::optional<fs::path> end_of_links(const fs::path& file) {
  std::error_code none;
  fs::path target = file;
  for (int links = 0; fs::is_symlink(target, none); ++links) {
    if (links == 40) return {};
    const fs::path next = fs::read_symlink(target, none);
    target = next.is_absolute() ? next : folder_of(target) / next;
  }
  return target;
}

/// The same, so that renaming makes that file and does not replace the link. @throws OutputError
fs::path follow(const fs::path& file) {
  if (const std::optional<fs::path> target = end_of_links(file)) return *target;
  throw OutputError(file.string(), "is a link that leads to itself: name another file");
}

/// One name for every spelling of a path, whether the file is there or not; hard links have several.
fs::path resolved(const fs::path& path) {
  std::error_code error;
  const fs::path absolute = fs::absolute(end_of_links(path).value_or(path), error);
  const fs::path canonical = fs::weakly_canonical(absolute, error);
  return error ? absolute.lexically_normal() : canonical;
}

/// By device and inode where both are there, so that hard links count, else by name.
bool is_same_file(const fs::path& a, const fs::path& b) {
  std::error_code none;
  return fs::equivalent(a, b, none) || resolved(a) == resolved(b);
}

/// Where in the folder the file lies, or empty.
fs::path place_in(const fs::path& folder, const fs::path& file) {
  const fs::path place = resolved(file).lexically_relative(resolved(folder));
  return place.empty() || *place.begin() == ".." || place == "." ? fs::path() : place;
}

/// What of the output would write over `file`: the output itself, or a file in its folder.
std::optional<fs::path> written_over(const Output& output, const fs::path& file) {
  if (is_same_file(output.path, file)) return output.path;
  if (output.names.empty()) return {};
  const std::regex names(output.names);
  const fs::path place = place_in(output.path, file);
  if (!place.empty() && std::regex_match(place.string(), names)) return output.path / place;
  std::error_code none;
  for (const fs::directory_entry& entry : fs::directory_iterator(output.path, none))
    if (std::regex_match(entry.path().filename().string(), names) && is_same_file(entry.path(), file))
      return entry.path();
  return {};
}

/// Does one of two outputs write over the other?
bool clash(const Output& a, const Output& b) {
  if (!a.names.empty() && !b.names.empty()) return a.names == b.names && is_same_file(a.path, b.path);
  return a.names.empty() ? written_over(b, a.path).has_value() : written_over(a, b.path).has_value();
}

[[noreturn]] void refuse(const Output& output, const fs::path& written, const std::string& as, const fs::path& path) {
  const std::string spelling = written == path ? "" : " (" + path.string() + ")";
  throw UsageError(written.string() + ": " + output.as + " would write over " + as + spelling + ": " + output.remedy);
}

/// Hidden, beside the file: `.name.<process>-<count>.part`.
constexpr std::string_view kTemporaryEnd = ".part";
std::string temporary_begin(const fs::path& file) {
  return "." + file.filename().string() + ".";
}
fs::path temporary_folder(const fs::path& file) {
  static std::atomic<unsigned> counter{0};
  const std::string unique = std::to_string(getpid()) + "-" + std::to_string(counter++);
  return folder_of(file) / (temporary_begin(file) + unique + std::string(kTemporaryEnd));
}

struct CloseFolder {
  void operator()(DIR* folder) const noexcept { closedir(folder); }
};
using Folder = std::unique_ptr<DIR, CloseFolder>;

/// A folder that holds files only, with them; `name` relative to the folder `at`. Allocates nothing of its own
/// (std::filesystem ends the program when it runs out of memory inside a folder).
void remove_folder(int at, const char* name) noexcept {
  const int descriptor = openat(at, name, O_RDONLY | O_DIRECTORY | O_NOFOLLOW | O_CLOEXEC);
  const Folder folder(descriptor < 0 ? nullptr : fdopendir(descriptor));
  if (!folder && descriptor >= 0) close(descriptor);
  while (const dirent* const entry = folder ? readdir(folder.get()) : nullptr) unlinkat(descriptor, entry->d_name, 0);
  unlinkat(at, name, AT_REMOVEDIR);
}

/// Waits until a file or folder is on the disk. Returns 0 or the error.
int try_flush(const fs::path& path) noexcept {
  const int descriptor = open(path.c_str(), O_RDONLY | O_CLOEXEC);
  const bool good = descriptor >= 0 && (fsync(descriptor) == 0 || errno == EINVAL);  // EINVAL: nothing to wait for
  const int error = good ? 0 : errno;
  if (descriptor >= 0) close(descriptor);
  return error;
}

}  // namespace

void check_writable(const fs::path& file) {
  std::error_code none;
  if (file.empty()) throw OutputError("output", "the path is empty: name a file");
  const fs::path target = follow(file), folder = folder_of(target);
  const fs::file_status status = fs::status(target, none);
  if (fs::is_directory(status) || !target.has_filename())
    throw OutputError(file.string(), "is a folder: name a file in it");
  if (fs::exists(status) && !fs::is_regular_file(status))
    throw OutputError(file.string(), "is a device or a pipe: name a regular file");
  if (!fs::is_directory(folder, none))
    throw OutputError(file.string(), "there is no folder " + folder.string() + ": create it first");
  if (fs::exists(status) && access(target.c_str(), W_OK) != 0)
    throw OutputError(file.string(), "is not writable (" + reason(errno) + "): change its permissions or name another");
  if (access(folder.c_str(), W_OK | X_OK) != 0)
    throw OutputError(file.string(), "its folder is not writable (" + reason(errno) + "): choose another folder");
}

void check_apart(std::span<const Output> outputs, std::span<const NamedFile> inputs) {
  std::error_code none;
  for (std::size_t i = 0; i < outputs.size(); ++i) {
    for (const NamedFile& input : inputs) {
      if (!fs::exists(input.path, none)) continue;
      if (const auto written = written_over(outputs[i], input.path)) refuse(outputs[i], *written, input.as, input.path);
    }
    for (const Output& earlier : outputs.first(i))
      if (clash(earlier, outputs[i])) refuse(outputs[i], outputs[i].path, earlier.as, earlier.path);
  }
}

void remove_stale_temporaries(const fs::path& file) noexcept {
  try {
    const fs::path target = follow(file);
    const std::string begin = temporary_begin(target);
    const Folder folder(opendir(folder_of(target).c_str()));
    while (const dirent* const entry = folder ? readdir(folder.get()) : nullptr) {
      const std::string_view name = entry->d_name;
      if (!name.starts_with(begin) || !name.ends_with(kTemporaryEnd)) continue;
      const auto middle = name.substr(begin.size(), name.size() - begin.size() - kTemporaryEnd.size());
      if (middle.find_first_not_of("0123456789-") == std::string_view::npos) {
        remove_folder(dirfd(folder.get()), entry->d_name);
      }
    }
  } catch (const std::exception&) {  // out of memory, or a link to itself: they stay until the next time
  }
}

AtomicFile::AtomicFile(const fs::path& file)
    : file_(follow(file)), folder_(temporary_folder(file_)), temporary_(folder_ / file_.filename()) {
  check_writable(file);
  if (mkdir(folder_.c_str(), 0777) != 0)
    throw OutputError(file.string(), "cannot create a folder beside it: " + reason(errno));
  const int descriptor = open(temporary_.c_str(), O_CREAT | O_EXCL | O_WRONLY | O_CLOEXEC, 0666);
  if (descriptor < 0) {
    const int error = errno;
    clear();
    throw OutputError(file.string(), "cannot create a file beside it: " + reason(error));
  }
  close(descriptor);
}

AtomicFile::~AtomicFile() {
  clear();
}

/// The file, and what SQLite may have left beside it.
void AtomicFile::clear() noexcept {
  unlink(temporary_.c_str());
  if (rmdir(folder_.c_str()) == 0 || errno == ENOENT) return;
  remove_folder(AT_FDCWD, folder_.c_str());
}

void AtomicFile::write(std::string_view bytes) {
  const std::unique_ptr<std::FILE, int (*)(std::FILE*)> out(std::fopen(temporary_.c_str(), "wbe"), &std::fclose);
  const bool good =
      out && std::fwrite(bytes.data(), 1, bytes.size(), out.get()) == bytes.size() && std::fflush(out.get()) == 0;
  if (!good) throw OutputError(file_.string(), "cannot write: " + reason(errno));
}

void AtomicFile::commit() {
  // Before the rename: after a power cut the name must not stand for an empty file.
  if (const int failed = try_flush(temporary_)) throw OutputError(file_.string(), "cannot write: " + reason(failed));
  std::error_code error;
  fs::rename(temporary_, file_, error);
  if (error) throw OutputError(file_.string(), "cannot rename the finished file: " + error.message());
  try_flush(folder_of(file_));
  clear();
}

}  // namespace pelage
