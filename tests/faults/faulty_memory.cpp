#include "faulty_memory.h"

#include <dlfcn.h>
#include <execinfo.h>
#include <sqlite3.h>

#include <array>
#include <atomic>
#include <cstdlib>
#include <cstring>
#include <new>

namespace pelage::faults {
namespace {

std::atomic<long> counted{0}, fail_at{0}, in_use{0};
std::atomic<bool> broken_for_good{false}, json_failed{false};
sqlite3_mem_methods below;

/// Does one of the functions that we are called from have `part` in its (mangled) name?
bool called_from(const char* part) {
  std::array<void*, 24> callers{};
  const int count = backtrace(callers.data(), static_cast<int>(callers.size()));
  for (int i = 0; i < count; ++i) {
    Dl_info info;
    if (dladdr(callers[static_cast<std::size_t>(i)], &info) != 0 && info.dli_sname != nullptr &&
        std::strstr(info.dli_sname, part) != nullptr)
      return true;
  }
  return false;
}

bool fails() {
  const long now = ++counted, k = fail_at;
  if (k <= 0 || (broken_for_good ? now < k : now != k)) return false;
  // nlohmann::json 3.11 allocates in its destructor, which is noexcept: out of memory there ends any program.
  if (called_from("10json_value7destroyE")) return false;
  if (called_from("8nlohmann")) json_failed = true;
  return true;
}

void* take(std::size_t size, std::size_t alignment) {
  if (fails()) return nullptr;
  void* memory = std::aligned_alloc(alignment, (size + alignment) / alignment * alignment);
  if (memory != nullptr) ++in_use;
  return memory;
}

void* take_or_throw(std::size_t size, std::size_t alignment = __STDCPP_DEFAULT_NEW_ALIGNMENT__) {
  void* memory = take(size, alignment);
  if (memory == nullptr) throw std::bad_alloc();
  return memory;
}

void give(void* memory) {
  if (memory != nullptr) --in_use;
  std::free(memory);
}

}  // namespace

void install_memory() {
  sqlite3_config(SQLITE_CONFIG_GETMALLOC, &below);
  sqlite3_mem_methods faulty = below;
  faulty.xMalloc = [](int size) {
    void* memory = fails() ? nullptr : below.xMalloc(size);
    if (memory != nullptr) ++in_use;
    return memory;
  };
  faulty.xRealloc = [](void* memory, int size) { return fails() ? nullptr : below.xRealloc(memory, size); };
  faulty.xFree = [](void* memory) {
    if (memory != nullptr) --in_use;
    below.xFree(memory);
  };
  sqlite3_config(SQLITE_CONFIG_MALLOC, &faulty);
}

void arm_memory(long at, bool stay_broken) {
  fail_at = 0;
  broken_for_good = stay_broken;
  counted = 0;
  json_failed = false;
  fail_at = at;
}

void stop_memory() {
  fail_at = 0;
}

long allocations() {
  return counted;
}
long live() {
  return in_use;
}
bool failed_in_json() {
  return json_failed;
}

}  // namespace pelage::faults

/// For the leak sanitizer: see failed_in_json().
extern "C" const char* __lsan_default_suppressions() {
  return "leak:nlohmann::";
}

using pelage::faults::give;
using pelage::faults::take;
using pelage::faults::take_or_throw;

void* operator new(std::size_t size) {
  return take_or_throw(size);
}
void* operator new[](std::size_t size) {
  return take_or_throw(size);
}
void* operator new(std::size_t size, std::align_val_t alignment) {
  return take_or_throw(size, static_cast<std::size_t>(alignment));
}
void* operator new[](std::size_t size, std::align_val_t alignment) {
  return take_or_throw(size, static_cast<std::size_t>(alignment));
}
void* operator new(std::size_t size, const std::nothrow_t&) noexcept {
  return take(size, __STDCPP_DEFAULT_NEW_ALIGNMENT__);
}
void* operator new[](std::size_t size, const std::nothrow_t&) noexcept {
  return take(size, __STDCPP_DEFAULT_NEW_ALIGNMENT__);
}
void operator delete(void* memory) noexcept {
  give(memory);
}
void operator delete[](void* memory) noexcept {
  give(memory);
}
void operator delete(void* memory, std::size_t) noexcept {
  give(memory);
}
void operator delete[](void* memory, std::size_t) noexcept {
  give(memory);
}
void operator delete(void* memory, std::align_val_t) noexcept {
  give(memory);
}
void operator delete[](void* memory, std::align_val_t) noexcept {
  give(memory);
}
void operator delete(void* memory, std::size_t, std::align_val_t) noexcept {
  give(memory);
}
void operator delete[](void* memory, std::size_t, std::align_val_t) noexcept {
  give(memory);
}
