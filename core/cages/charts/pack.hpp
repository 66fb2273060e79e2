#pragma once

#include <vector>

#include "charts/flatten.hpp"

namespace cagecast::cages {

/// Scales all charts alike and moves them, not turned, into the unit square, as large as they fit.
/// @param gutter  Least distance between charts, and half of it to the border; less if there are thousands of charts.
/// @return false if cancelled.
bool packCharts(double gutter, Ticker& ticker, std::vector<Chart>& charts);

}  // namespace cagecast::cages
