// Wall time since a moment.
#pragma once

#include <chrono>

namespace pelage::app {

inline double ms_since(std::chrono::steady_clock::time_point begin) {
  return std::chrono::duration<double, std::milli>(std::chrono::steady_clock::now() - begin).count();
}

}  // namespace pelage::app
