#include "pelage/data_schema/strands.h"

#include <algorithm>
#include <cmath>

namespace pelage {

float default_diameter_m(std::size_t strands) noexcept {
  const double n = static_cast<double>(std::max<std::size_t>(strands, 1));
  return static_cast<float>(std::min(80e-6 * std::sqrt(100'000.0 / n), 400e-6));
}

}  // namespace pelage
