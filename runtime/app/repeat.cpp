#include "pelage/app/repeat.h"

#include <algorithm>

#include "pelage/app/stopwatch.h"
#include "pelage/console/program.h"

namespace pelage::app {

std::vector<double> repeated_ms(const std::function<void()>& work, const RepeatLimits& limits) {
  work();
  std::vector<double> ms;
  const auto begin = std::chrono::steady_clock::now();
  for (int i = 0; i < limits.most && (i < limits.least || ms_since(begin) < limits.enough_ms); ++i) {
    console::throw_if_interrupted();
    const auto start = std::chrono::steady_clock::now();
    work();
    ms.push_back(ms_since(start));
  }
  return ms;
}

double median_of(std::vector<double> values) {
  if (values.empty()) return 0;
  std::sort(values.begin(), values.end());
  const std::size_t middle = values.size() / 2;
  return values.size() % 2 == 1 ? values[middle] : 0.5 * (values[middle - 1] + values[middle]);
}

}  // namespace pelage::app
