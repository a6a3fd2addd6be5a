// Repeated timing of one piece of work: warm, until it has been seen often enough.
#pragma once

#include <chrono>
#include <functional>
#include <vector>

namespace pelage::app {

struct RepeatLimits {
  int least = 3, most = 15;
  double enough_ms = 1000;  // no more repetitions after so long, once `least` are done
};

/// Milliseconds of each run of `work`; the first call of all is not timed. @throws what `work` throws, Interrupted
std::vector<double> repeated_ms(const std::function<void()>& work, const RepeatLimits& limits = RepeatLimits{});

/// The value in the middle; of an even number the mean of both. 0 of none.
double median_of(std::vector<double> values);

}  // namespace pelage::app
