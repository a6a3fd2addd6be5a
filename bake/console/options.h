// Validators that the programs' options share.
#pragma once

#include <CLI/CLI.hpp>
#include <limits>

namespace pelage::console {

/// A finite number in [min, max]; NaN, infinity, overflow and trailing text are refused with a sentence. Checks each
/// value of a list on its own.
CLI::Validator finite(double min = -std::numeric_limits<double>::max(),
                      double max = std::numeric_limits<double>::max());

}  // namespace pelage::console
