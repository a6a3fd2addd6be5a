// How much light a strand's Gaussian stops (DESIGN section 3): one extinction for all methods.
#pragma once

namespace pelage {

/// Mass M [m] of a Gaussian profile of optical depth, tau(x) = M / (sqrt(2 pi) sigma) exp(-x^2 / (2 sigma^2)), that
/// blocks the width a D:  integral (1 - exp(-tau(x))) dx = blocked_width. M > blocked_width, because the Gaussian's
/// peak saturates (by 9 % at peak depth .25, 18 % at .5).
/// @param blocked_width_m  a D > 0       @param sigma_m  > 0
/// @return M [m]; relative error < 1e-6 up to a peak depth of 4, where the profile is a poor picture of a fibre anyway:
///         narrower profiles are treated as having that peak, so the result stays finite.
double gaussian_mass(double blocked_width_m, double sigma_m) noexcept;

}  // namespace pelage
