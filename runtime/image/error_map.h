// Where two pictures differ: error of linear luminance (Rec. 709: .2126 R + .7152 G + .0722 B) in colours of a fixed
// scale, so that maps of different methods can be laid side by side, with a bar that says which colour is which error.
#pragma once

#include <string>
#include <vector>

#include "pelage/image/image.h"

namespace pelage {

enum class ErrorSign { absolute, with_sign };

/// Height of the bar and its numbers below a map of this width [pixels]; 0 where it is too narrow for them.
int colour_bar_height(int width) noexcept;

/// The map, as large as the pictures, and the bar below it. Absolute: draw::ramp from 0 to `scale`; signed: blue where
/// the picture is darker than the truth by `scale`, white where it is right, red where it is brighter. Beyond the scale
/// colours stay at its end, and the bar's last number has a sign that says so.
/// @param scale  error of linear luminance at the scale's end, > 0
/// @throws UsageError for pictures of different or no size, InputError where values are not finite
Image error_map(const Image& picture, const Image& truth, float scale, ErrorSign sign = ErrorSign::absolute);

/// The map of FLIP with such a bar from 0 to 1.
Image flip_picture(const std::vector<float>& map, int width, int height);

}  // namespace pelage
