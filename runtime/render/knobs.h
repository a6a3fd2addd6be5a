// Knobs of drawing strand by strand, and of the picture as a whole: which method, how many samples.
#pragma once

#include <span>

#include "pelage/data_schema/knob.h"

namespace pelage {

std::span<const Knob> picture_knobs();

}  // namespace pelage
