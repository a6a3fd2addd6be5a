// Work-precision charts of the page of `pelage tradeoff` as static SVG: every point is a link to its row.
#pragma once

#include <string>
#include <vector>

#include "pelage/tradeoff/tradeoff.h"

namespace pelage::app {

/// Names of a diagram's knobs: curves first, then what only rows name.
std::vector<std::string> knobs_of(const Diagram& diagram);

/// Id of a row's element in the page, escaped.
std::string row_anchor(const Diagram& diagram, const TradeoffRow& row);
/// "density-map.cells = 128", escaped; "default" of the program's own settings.
std::string row_title(const TradeoffRow& row);
/// "0.0123 ± 0.0004 mm"
std::string error_text(const Diagram& diagram, const TradeoffRow& row);
/// "12.3 ms"
std::string ms_text(double ms);
std::string mib_text(std::uint64_t bytes);

/// The chart against each horizontal axis (time, memory, preparation), what cannot be on its axes beneath it, and the
/// choice of axis. `number` tells the page's diagrams apart.
std::string axis_choice(int number);
std::string tradeoff_charts(const Diagram& diagram);
/// An entry for each knob, and what marks and lines mean.
std::string tradeoff_legend(const Diagram& diagram);

}  // namespace pelage::app
