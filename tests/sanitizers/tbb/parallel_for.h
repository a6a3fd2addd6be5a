// Stand-in for oneTBB, see threads.h.
#pragma once

#include <type_traits>

#include "blocked_range.h"
#include "threads.h"

namespace tbb {

template <class Value, class Body>
void parallel_for(const blocked_range<Value>& range, const Body& body) {
  const std::size_t parts = 4 * stand_in::threads();
  const std::size_t piece = std::max({range.grainsize(), (range.size() + parts - 1) / parts, std::size_t{1}});
  stand_in::run((range.size() + piece - 1) / piece, [&](std::size_t i) {
    const auto at = [&](std::size_t k) {
      return static_cast<Value>(range.begin() + static_cast<Value>(std::min(k * piece, range.size())));
    };
    body(blocked_range<Value>(at(i), at(i + 1), range.grainsize()));
  });
}

template <class Index, class Body>
requires std::is_integral_v<Index>
void parallel_for(Index first, Index last, const Body& body) {
  parallel_for(blocked_range<Index>(first, last), [&](const blocked_range<Index>& part) {
    for (Index i = part.begin(); i < part.end(); ++i) body(i);
  });
}

}  // namespace tbb
