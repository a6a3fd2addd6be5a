// Stand-in for oneTBB, see threads.h. Sorts on one thread.
#pragma once

#include <algorithm>
#include <utility>

namespace tbb {

template <class... Arguments>
void parallel_sort(Arguments&&... arguments) {
  std::sort(std::forward<Arguments>(arguments)...);
}

}  // namespace tbb
