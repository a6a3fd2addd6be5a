// What trades accuracy for time in the simulation.
#pragma once

#include <span>

#include "pelage/data_schema/knob.h"

namespace pelage {

std::span<const Knob> simulation_knobs();

}  // namespace pelage
