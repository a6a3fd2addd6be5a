// How far a picture is from another: the numbers that people report, each with its definition.
#pragma once

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

}  // namespace pelage
