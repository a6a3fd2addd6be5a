#include "pelage/image/noisy_error.h"

#include <algorithm>
#include <cmath>

#include "pelage/data_schema/errors.h"

namespace pelage {

NoisyError noisy_rmse(std::span<const float> picture, std::span<const float> half_a, std::span<const float> half_b,
                      Pixels pixels) {
  if (picture.empty() || picture.size() % 4 != 0 || half_a.size() != picture.size() || half_b.size() != picture.size())
    throw UsageError("noisy_rmse: a picture and two halves of one size are needed, of at least one pixel");
  const std::size_t n = picture.size() / 4;
  double sum = 0, squares = 0, noise = 0;
  for (std::size_t i = 0; i < picture.size(); i += 4) {
    double product = 0, along = 0;  // of the pixel's channels
    for (std::size_t c = 0; c < 3; ++c) {
      const double x = static_cast<double>(picture[i + c]), a = static_cast<double>(half_a[i + c]),
                   b = static_cast<double>(half_b[i + c]);
      product += (x - a) * (x - b) / 3;
      // With m the halves' mean and d their difference, the variance of (x - a)(x - b) is the mean of (x - m)^2 d^2.
      along += (x - 0.5 * (a + b)) * (a - b) / 3;
    }
    sum += product;
    squares += product * product;
    noise += along * along;
  }
  const auto count = static_cast<double>(n);
  const double mean = sum / count;
  const double of_sample = std::max(squares / count - mean * mean, 0.0) / count;
  const double deviation = std::sqrt(pixels == Pixels::sample ? of_sample : noise / (count * count));
  const double square = std::max(mean, 0.0);
  return {std::sqrt(square), std::sqrt(square + deviation) - std::sqrt(square)};
}

}  // namespace pelage
