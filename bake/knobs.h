// What trades accuracy for time and bytes in records and their lookup: how many, how fine in angle and along s, what
// the search goes by, how values are stored, and the rungs from one literal search to direct tracing.
#pragma once

#include <span>

#include "pelage/data_schema/knob.h"

namespace pelage {

std::span<const Knob> bake_knobs();

}  // namespace pelage
