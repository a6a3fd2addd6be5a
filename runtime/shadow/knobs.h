// What trades accuracy for time in shadows strand by strand: the density map's cells, with all corrections and with
// each of them off, its footprint and threads, and the layers and pixels of the methods that it is compared with.
#pragma once

#include <span>

#include "pelage/data_schema/knob.h"

namespace pelage {

std::span<const Knob> shadow_knobs();

}  // namespace pelage
