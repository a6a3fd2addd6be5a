// How far a picture is from another: the numbers that people report, each with its definition.
#pragma once

#include <span>

#include "pelage/image/image.h"

namespace pelage {

/// Over all pixels of two pictures of one size, exposed and laid over their background.
struct PictureError {
  double rmse = 0;          // root mean square of the difference of linear RGB
  double bias = 0;          // mean signed difference of linear RGB: picture - truth
  double rel_mse = 0;       // mean of (picture - truth)^2 / (truth^2 + 0.01), linear RGB
  double psnr_db = 0;       // 10 log10(1 / MSE) of sRGB values in [0, 1]; infinite for equal pictures
  double flip = 0;          // mean LDR-FLIP in [0, 1] [Andersson2020]
  double max = 0;           // greatest absolute difference of linear RGB
  double rmse_covered = 0;  // rmse over the pixels that the truth covers at least by half; 0 where there are none
};

/// All of it, the same bits for any number of threads.
/// @param truth_alpha  [y][x] of the truth before it was laid over the background
/// @throws UsageError for pictures of different or no size, InputError naming how many values are not finite
PictureError picture_error(const Image& picture, const Image& truth, std::span<const float> truth_alpha);

/// Alpha of a picture, [y][x].
std::vector<float> alpha_of(const Image& image);

/// RMSE of linear RGB of a picture's change since its last frame against the truth's change: what flickers where the
/// truth stands still, and what stands still where it moves. @throws UsageError for different sizes
double flicker(const Image& picture, const Image& last_picture, const Image& truth, const Image& last_truth);

/// @throws UsageError naming both sizes, or that there are no pixels
void check_same_size(const Image& a, const Image& b);
/// @throws InputError with their number where values are not finite
void check_finite(const Image& image, const char* which);

}  // namespace pelage
