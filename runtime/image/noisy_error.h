// Error of a picture against a truth that is noisy itself: two independent estimates a and b of it are at hand. The
// mean of (x - a)(x - b) has none of the truth's noise in it, where the mean of (x - (a + b) / 2)^2 has half of one's.
#pragma once

#include <span>

namespace pelage {

struct NoisyError {
  double rmse = 0;            // linear RGB; 0 where noise hides it
  double standard_error = 0;  // of rmse
};

/// What the pixels stand for: themselves, or a larger picture that they were drawn from at random. The standard error
/// has the noise of both halves; of a sample, also that of the drawing.
enum class Pixels { all, sample };

/// @param picture, half_a, half_b  [n][4] RGBA of which A is not looked at, exposed and laid over one background
/// @throws UsageError for different lengths or none
NoisyError noisy_rmse(std::span<const float> picture, std::span<const float> half_a, std::span<const float> half_b,
                      Pixels pixels);

}  // namespace pelage
