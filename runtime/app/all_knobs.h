// The knobs of all modules: what `pelage tradeoff` sweeps. A module that is new adds its list here.
#pragma once

#include <string>
#include <vector>

#include "pelage/data_schema/knob.h"

namespace pelage::app {

std::vector<Knob> all_knobs();

/// Those whose name is one of `names`, or begins with one and a point ("density-map"); all for none.
/// @throws UsageError naming the nearest
std::vector<Knob> chosen_knobs(const std::vector<std::string>& names);

}  // namespace pelage::app
