// Which settings of several knobs are worth measuring together: a guess out of each knob alone.
#pragma once

#include <span>
#include <string>
#include <vector>

#include "pelage/tradeoff/tradeoff.h"

namespace pelage {

/// A row of one knob's value on a base.
struct SinglePoint {
  std::string knob;
  std::vector<std::string> settings;  // on top of the base
  double error = 0, ms = 0;
};

/// @param base     the base alone: its error and time
/// @param singles  one knob's value each. Predicted of several: times multiply, what each adds to the squared error
/// adds
/// @param known    points that are measured already: what they dominate is not worth a measurement
/// @param most     so many at most, spread evenly over the predicted front
/// @return settings of two or more knobs, on top of the base, fastest first
std::vector<std::vector<std::string>> worth_combining(const SinglePoint& base, std::span<const SinglePoint> singles,
                                                      std::span<const TradeoffRow> known, std::size_t most);

}  // namespace pelage
