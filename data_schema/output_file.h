// Output files: checked before the work starts, and written whole or not at all.
#pragma once

#include <filesystem>
#include <span>
#include <string>
#include <string_view>

namespace pelage {

/// Could `file` be written? Call it before the work, so that an hour of it is not lost to a typing error.
/// @throws OutputError (missing folder, is a folder, not a regular file, not writable) with the remedy
void check_writable(const std::filesystem::path& file);

/// A file that somebody named, and what they named it as: "the input", "--head", "the scene's hair".
struct NamedFile {
  std::string as;
  std::filesystem::path path;
};

/// A file that will be written.
struct Output {
  std::string as;
  std::filesystem::path path;
  /// Where given, `path` is a folder, and written are the files whose path in it matches this regular expression.
  std::string names;
  std::string remedy = "name another file";
};

/// Refuses outputs that would write over an input or over each other, however the paths are spelled: relative, by
/// symbolic or hard link. Call it before the work. Inputs that are not there are passed over: their reader says so.
/// @throws UsageError with both spellings and the remedy
void check_apart(std::span<const Output> outputs, std::span<const NamedFile> inputs);

/// Removes what writers of `file` that were killed left beside it. For a caller who knows that nobody else writes it.
void remove_stale_temporaries(const std::filesystem::path& file) noexcept;

/// A file written to a temporary and renamed on commit(): readers see the earlier file or the whole new one. The
/// temporary has a folder of its own beside the file, so that what a library leaves next to it (SQLite's journal after
/// a failed write) goes with it. Without commit() (an exception, Ctrl-C) the earlier file stays as it was.
class AtomicFile {
 public:
  /// Creates the empty temporary. A symbolic link is followed. @throws OutputError as check_writable
  explicit AtomicFile(const std::filesystem::path& file);
  ~AtomicFile();
  AtomicFile(const AtomicFile&) = delete;
  AtomicFile& operator=(const AtomicFile&) = delete;

  /// What to write to, by whatever library; same name, same file system.
  const std::filesystem::path& temporary() const noexcept { return temporary_; }
  /// Replaces the temporary's content. @throws OutputError, e.g. disk full
  void write(std::string_view bytes);
  /// Renames the temporary to the file. @throws OutputError
  void commit();

 private:
  void clear() noexcept;

  std::filesystem::path file_, folder_, temporary_;
};

}  // namespace pelage
