// Charts of the comparison's page as static HTML and SVG.
#pragma once

#include <string>

#include "pelage/app/comparison.h"

namespace pelage::app {

/// Bars of the milliseconds of each method's first picture, by stage, with what a later picture takes beneath.
std::string stage_bars(const Comparison& comparison);
/// FLIP, RMSE and flicker of every frame; nothing of a comparison that is not animated.
std::string frame_curves(const Comparison& comparison);

}  // namespace pelage::app
