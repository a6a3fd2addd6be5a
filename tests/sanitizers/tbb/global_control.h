// Stand-in for oneTBB, see threads.h. The least of the limits that live holds, as there.
#pragma once

#include <cstddef>
#include <iterator>
#include <mutex>
#include <set>

#include "threads.h"

namespace tbb {

class global_control {
 public:
  enum parameter { max_allowed_parallelism };

  global_control(parameter, std::size_t most) : most_(most) {
    const std::lock_guard lock(guard());
    limits().insert(most_);
    stand_in::limit() = *limits().begin();
  }
  ~global_control() {
    const std::lock_guard lock(guard());
    limits().erase(limits().find(most_));
    stand_in::limit() = limits().empty() ? stand_in::kThreads : *limits().begin();
  }
  global_control(const global_control&) = delete;
  global_control& operator=(const global_control&) = delete;
  static std::size_t active_value(parameter) { return stand_in::limit(); }

 private:
  static std::mutex& guard() {
    static std::mutex mutex;
    return mutex;
  }
  static std::multiset<std::size_t>& limits() {
    static std::multiset<std::size_t> all;
    return all;
  }
  std::size_t most_;
};

}  // namespace tbb
