#include "pelage/data_schema/output_file.h"

#include <fcntl.h>
#include <sys/stat.h>
#include <unistd.h>

#include <atomic>
#include <cerrno>
#include <cstdio>
#include <memory>
#include <new>
#include <string>
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

/// The file that a chain of symbolic links ends at, so that renaming replaces that and not the link.
fs::path follow(const fs::path& file) {
  std::error_code none;
  return fs::is_symlink(file, none) ? fs::weakly_canonical(file, none) : file;
}

/// Hidden, beside the file.
fs::path temporary_folder(const fs::path& file) {
  static std::atomic<unsigned> counter{0};
  const std::string unique = "." + std::to_string(getpid()) + "-" + std::to_string(counter++);
  return folder_of(file) / ("." + file.filename().string() + unique + ".part");
}

/// Waits until the temporary is on the disk. @throws OutputError naming `file`
void flush(const fs::path& temporary, const fs::path& file) {
  const int descriptor = open(temporary.c_str(), O_RDONLY | O_CLOEXEC);
  const bool good = descriptor >= 0 && (fsync(descriptor) == 0 || errno == EINVAL);  // EINVAL: nothing to wait for
  const int error = errno;
  if (descriptor >= 0) close(descriptor);
  if (!good) throw OutputError(file.string(), "cannot write: " + reason(error));
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

/// Where only our own file is in the folder, without allocating: out of memory leaves nothing behind either.
void AtomicFile::clear() noexcept {
  unlink(temporary_.c_str());
  if (rmdir(folder_.c_str()) == 0 || errno == ENOENT) return;
  try {
    std::error_code none;
    fs::remove_all(folder_, none);
  } catch (const std::bad_alloc&) {
  }
}

void AtomicFile::write(std::string_view bytes) {
  const std::unique_ptr<std::FILE, int (*)(std::FILE*)> out(std::fopen(temporary_.c_str(), "wbe"), &std::fclose);
  const bool good =
      out && std::fwrite(bytes.data(), 1, bytes.size(), out.get()) == bytes.size() && std::fflush(out.get()) == 0;
  if (!good) throw OutputError(file_.string(), "cannot write: " + reason(errno));
}

void AtomicFile::commit() {
  flush(temporary_, file_);  // before the rename: after a power cut the name must not stand for an empty file
  std::error_code error;
  fs::rename(temporary_, file_, error);
  if (error) throw OutputError(file_.string(), "cannot rename the finished file: " + error.message());
  clear();
}

}  // namespace pelage
