// Stands in for the parts of oneTBB that this project uses, in builds with the thread sanitizer only (preset tsan puts
// this folder before the system's). Debian's libtbb is not instrumented: the sanitizer does not see it hand work from
// thread to thread, and would report every body that reads what its caller wrote. Here plain std::thread does that,
// which it does see.
//
// The same calls run the same bodies, by up to four threads at a time whatever the machine, so that data shared without
// order is found on two cores too. Not the same: nested loops run on the thread that meets them, and ranges are cut
// evenly.
#pragma once

#include <algorithm>
#include <atomic>
#include <cstddef>
#include <exception>
#include <mutex>
#include <thread>
#include <vector>

namespace tbb {
namespace stand_in {

inline constexpr std::size_t kThreads = 4;

inline std::atomic<std::size_t>& limit() {
  static std::atomic<std::size_t> most{kThreads};
  return most;
}

/// 0: the arena does not limit.
inline thread_local std::size_t arena = 0;
inline thread_local bool inside = false;

inline std::size_t threads() {
  return arena > 0 ? std::min(arena, limit().load()) : limit().load();
}

/// Runs task(0) to task(count - 1), each once: task i on thread i modulo the number of threads, so that all have a
/// share however short it is, and nothing orders one body before another. The first exception is thrown when all have
/// ended.
template <class Task>
void run(std::size_t count, const Task& task) {
  const std::size_t workers = inside ? 1 : std::min(threads(), count);
  if (workers < 2) {
    for (std::size_t i = 0; i < count; ++i) task(i);
    return;
  }
  std::mutex guard;
  std::exception_ptr error;
  const auto work = [&](std::size_t worker) {
    const bool was_inside = inside;
    inside = true;
    try {
      for (std::size_t i = worker; i < count; i += workers) task(i);
    } catch (...) {
      const std::lock_guard lock(guard);
      if (!error) error = std::current_exception();
    }
    inside = was_inside;
  };
  std::vector<std::thread> others;
  for (std::size_t k = 1; k < workers; ++k) others.emplace_back(work, k);
  work(0);
  for (std::thread& thread : others) thread.join();
  if (error) std::rethrow_exception(error);
}

}  // namespace stand_in
}  // namespace tbb
