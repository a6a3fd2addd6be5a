// LDR-FLIP: what a person sees who flips between two pictures.
// [Andersson2020] P. Andersson, J. Nilsson, T. Akenine-Moeller, M. Oskarsson, K. Astroem, M. D. Fairchild: "FLIP: A
// Difference Evaluator for Alternating Images", Proc. ACM Comput. Graph. Interact. Tech. 3(2), 2020; sections there:
//   4.1.1  both pictures in YCxCz, filtered by the eye's contrast sensitivity at this distance, clamped to RGB's cube
//   4.1.2  L*a*b*, a* and b* times 0.01 L* (after Hunt 1952), HyAB distance (Abasi et al. 2020), to the power qc
//   4.1.3  compressed to [0, 1]: up to pc cmax takes pt of it
//   4.2    edges and points of the luminance, by first and second derivatives of a Gaussian
//   4.3    Delta E = Delta E_c ^ (1 - Delta E_f)
// Borders repeat their last pixel. The paper takes 8-bit sRGB; here values are linear floats, clamped to [0, 1], and
// not rounded to 8 bits.
#pragma once

#include <vector>

#include "pelage/image/image.h"

namespace pelage {

/// [Andersson2020 section 6]: 0.7 m in front of a display that is 0.7 m and 3840 pixels wide, at 67.02 pixels per
/// degree: 0.7 * (3840 / 0.7) * pi / 180.
constexpr double kFlipPixelsPerDegree = 3840.0 * 3.14159265358979323846 / 180;

/// Of every pixel, [y][x], in [0, 1]; the same bits for any number of threads. Symmetric.
/// @throws UsageError for pictures of different or no size, InputError where values are not finite
std::vector<float> flip_map(const Image& a, const Image& b, double pixels_per_degree = kFlipPixelsPerDegree);

/// A map of [y][x] in [0, 1] coloured by draw::ramp.
Image ramp_picture(const std::vector<float>& map, int width, int height);

}  // namespace pelage
