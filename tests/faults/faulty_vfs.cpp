#include "faulty_vfs.h"

#include <sqlite3.h>

#include <csignal>

namespace pelage::faults {
namespace {

Plan current;
long counted = 0;
sqlite3_vfs* below = nullptr;

/// Counts an operation; should it fail?
bool fails() {
  ++counted;
  return current.fail_at > 0 && (current.stay_broken ? counted >= current.fail_at : counted == current.fail_at);
}
int fail(int code) {
  if (current.kind == Kind::killed) raise(SIGKILL);
  return code;
}

/// The real file follows in the same allocation.
struct File {
  sqlite3_file base;
  sqlite3_file* real() { return reinterpret_cast<sqlite3_file*>(this + 1); }
};
sqlite3_file* real(sqlite3_file* file) {
  return reinterpret_cast<File*>(file)->real();
}

int write(sqlite3_file* file, const void* bytes, int size, sqlite3_int64 offset) {
  const auto next = [&](int count) { return real(file)->pMethods->xWrite(real(file), bytes, count, offset); };
  if (!fails()) return next(size);
  if (current.kind == Kind::short_write || current.kind == Kind::killed) next(size / 2);
  return fail(current.kind == Kind::input_output ? SQLITE_IOERR_WRITE : SQLITE_FULL);
}
int sync(sqlite3_file*, int) {  // the tests kill no power
  return fails() ? fail(SQLITE_IOERR_FSYNC) : SQLITE_OK;
}
int truncate(sqlite3_file* file, sqlite3_int64 size) {
  return fails() ? fail(SQLITE_IOERR_TRUNCATE) : real(file)->pMethods->xTruncate(real(file), size);
}

/// Methods that only pass on.
template <auto Method, class... Arguments>
int pass(sqlite3_file* file, Arguments... arguments) {
  return (real(file)->pMethods->*Method)(real(file), arguments...);
}

using M = sqlite3_io_methods;
const M kMethods = {3,
                    pass<&M::xClose>,
                    pass<&M::xRead, void*, int, sqlite3_int64>,
                    write,
                    truncate,
                    sync,
                    pass<&M::xFileSize, sqlite3_int64*>,
                    pass<&M::xLock, int>,
                    pass<&M::xUnlock, int>,
                    pass<&M::xCheckReservedLock, int*>,
                    pass<&M::xFileControl, int, void*>,
                    pass<&M::xSectorSize>,
                    pass<&M::xDeviceCharacteristics>,
                    pass<&M::xShmMap, int, int, int, void volatile**>,
                    pass<&M::xShmLock, int, int, int>,
                    [](sqlite3_file* file) { real(file)->pMethods->xShmBarrier(real(file)); },
                    pass<&M::xShmUnmap, int>,
                    pass<&M::xFetch, sqlite3_int64, int, void**>,
                    pass<&M::xUnfetch, sqlite3_int64, void*>};

int open(sqlite3_vfs*, sqlite3_filename name, sqlite3_file* file, int flags, int* out_flags) {
  file->pMethods = nullptr;
  if (fails()) return fail(SQLITE_CANTOPEN);
  const int code = below->xOpen(below, name, real(file), flags, out_flags);
  if (real(file)->pMethods != nullptr) file->pMethods = &kMethods;
  return code;
}

}  // namespace

void install() {
  static sqlite3_vfs faulty;
  below = sqlite3_vfs_find(nullptr);
  faulty = *below;
  faulty.szOsFile += static_cast<int>(sizeof(File));
  faulty.zName = "faulty";
  faulty.pNext = nullptr;
  faulty.xOpen = open;
  sqlite3_vfs_register(&faulty, 1);
}

void arm(const Plan& plan) {
  current = plan;
  counted = 0;
}

long operations() {
  return counted;
}

}  // namespace pelage::faults
