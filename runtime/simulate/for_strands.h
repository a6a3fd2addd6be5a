// Private to this box: work(begin, end) over ranges of strands, in parallel.
#pragma once

#include <tbb/blocked_range.h>
#include <tbb/parallel_for.h>

#include <cstddef>

namespace pelage {

template <class Work>
void for_strands(std::size_t count, const Work& work) {
  constexpr std::size_t kStrandsPerTask = 64;
  tbb::parallel_for(tbb::blocked_range<std::size_t>(0, count, kStrandsPerTask),
                    [&](const tbb::blocked_range<std::size_t>& range) { work(range.begin(), range.end()); });
}

}  // namespace pelage
