// Private to this box: progress told by one thread at a time.
#pragma once

#include <cstdint>
#include <functional>
#include <mutex>

namespace pelage {

class ProgressCounter {
 public:
  ProgressCounter(const std::function<void(std::uint64_t, std::uint64_t)>& tell, std::uint64_t total)
      : tell_(tell), total_(total) {}
  /// Throws what the listener throws.
  void add(std::uint64_t n) {
    if (!tell_) return;
    const std::lock_guard lock(mutex_);
    done_ += n;
    tell_(done_, total_);
  }

 private:
  const std::function<void(std::uint64_t, std::uint64_t)>& tell_;
  std::uint64_t total_, done_ = 0;
  std::mutex mutex_;
};

}  // namespace pelage
