// What a comparison must keep to, for other people's CI.
#pragma once

#include <span>
#include <string>
#include <vector>

#include "pelage/app/compare_methods.h"
#include "pelage/app/comparison.h"

namespace pelage::app {

struct Threshold {
  std::string method;  // empty: all but the truth
  std::string metric;  // rmse, bias (absolute), rel-mse, psnr-db (at least), flip, max, ms, flicker
  double limit = 0;
};

/// "METRIC=VALUE" or "METHOD:METRIC=VALUE". @throws UsageError with the nearest name
Threshold parse_threshold(const std::string& text, std::span<const CompareMethod> methods, bool animated);

/// A sentence for each that does not hold, of an animation in its worst frame. A method that failed holds none.
std::vector<std::string> violations(const Comparison& comparison, std::span<const Threshold> thresholds);

}  // namespace pelage::app
