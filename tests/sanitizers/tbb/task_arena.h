// Stand-in for oneTBB, see threads.h.
#pragma once

#include "threads.h"

namespace tbb {

class task_arena {
 public:
  explicit task_arena(int threads) : threads_(static_cast<std::size_t>(threads)) {}
  template <class Work>
  auto execute(Work&& work) {
    const Restore restore;
    stand_in::arena = threads_;
    return work();
  }

 private:
  struct Restore {
    std::size_t before = stand_in::arena;
    ~Restore() { stand_in::arena = before; }
  };
  std::size_t threads_;
};

namespace this_task_arena {
inline int max_concurrency() {
  return static_cast<int>(stand_in::threads());
}
}  // namespace this_task_arena

}  // namespace tbb
