#include "pelage/console/options.h"

#include <CLI/CLI.hpp>
#include <charconv>
#include <cmath>
#include <string>

#include <spdlog/fmt/fmt.h>

namespace pelage::console {
namespace {

/// "a number in [0, 1]"; a bound at the end of double's range is not worth naming.
std::string range_text(double min, double max) {
  constexpr double kMost = std::numeric_limits<double>::max();
  if (min > -kMost && max < kMost) return fmt::format("a number in [{}, {}]", min, max);
  if (min > -kMost) return fmt::format("a number of {} or more", min);
  if (max < kMost) return fmt::format("a number of {} or less", max);
  return "a finite number";
}

/// Why `text` is no finite number in [min, max], or empty.
std::string why_not(const std::string& text, double min, double max) {
  double value = 0;
  const char* first = text.c_str() + (text.starts_with('+') && !text.starts_with("+-") ? 1 : 0);
  const char* last = text.c_str() + text.size();
  const auto [end, error] = std::from_chars(first, last, value);
  const std::string allowed = ": give " + range_text(min, max);
  if (error == std::errc::result_out_of_range) return text + " is too large or too small to be held" + allowed;
  if (error != std::errc() || end != last) return "'" + text + "' is not a number" + allowed;
  if (!std::isfinite(value)) return text + " is not finite" + allowed;
  if (value < min || value > max) return text + " is out of range" + allowed;
  return {};
}

}  // namespace

CLI::Validator finite(double min, double max) {
  return CLI::Validator([min, max](std::string& text) { return why_not(text, min, max); }, "", "finite");
}

}  // namespace pelage::console
