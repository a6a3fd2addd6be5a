// Pareto fronts and slopes of measured points.
#pragma once

#include <span>
#include <vector>

#include "pelage/tradeoff/tradeoff.h"

namespace pelage {

/// Sets on_front and dominated_by of all rows. A row is dominated where another's median time and error are both no
/// greater and one is less; of equal rows the first stays. Failed rows are neither on the front nor dominate.
void mark_front(std::vector<TradeoffRow>& rows);

/// Of each curve with at least two ordered points that differ: error against its amounts and against median time, by
/// least squares in logarithms. Points whose error is below three error bars are left out: they show the truth's noise.
std::vector<Slope> fit_slopes(std::span<const Curve> curves, std::span<const TradeoffRow> rows);

}  // namespace pelage
