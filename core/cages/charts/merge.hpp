#pragma once

#include <cstddef>
#include <vector>

#include "charts/flatten.hpp"

namespace cagecast::cages {

struct MergeOptions {
  double mostEnergy = 0;   ///< Charts are joined if the result has no more.
  std::size_t enough = 1;  ///< Stops at so many charts.
  double leastFill = 0;    ///< Of the box of a chart.
  double longest = 0;      ///< Longest side of the box of a chart.
  Vec3 axis{0, 0, 0};      ///< Charts that face along it are joined with none that do not; 0 if it does not matter.
};

/// Joins neighbouring charts, those with the longest common border first, where the result lies flat well enough.
/// Seams within the charts stay.
/// @param mesh  The whole mesh that the charts are of.
void mergeCharts(const TriangleMesh& mesh, const MergeOptions& options, Ticker& ticker, std::vector<Chart>& charts);

}  // namespace cagecast::cages
