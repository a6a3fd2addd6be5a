// What trades accuracy for time in pictures from a hairstyle's layers: how finely clusters are divided, where records
// come from, how light and depth are followed.
#pragma once

#include <span>

#include "pelage/data_schema/knob.h"

namespace pelage {

std::span<const Knob> satf_knobs();

}  // namespace pelage
