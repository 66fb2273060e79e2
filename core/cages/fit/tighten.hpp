#pragma once

#include <functional>
#include <vector>

#include "fit/template_cage.hpp"

namespace cagecast::cages {

struct TightenOptions {
  double reach = 0.1;   ///< Planes farther away than this share of the diagonal do not count; shrinks to a third.
  double sliding = 0;   ///< Resistance to sliding along the surface.
  double stiffest = 0;  ///< Resistance to bending, at first and at last.
  double softest = 0;
};

/// Draws a cage onto the hull of the target, smoothly and with little sliding.
/// @param rest  Positions of the cage to start from; what they are is kept as far as the hull lets them.
/// @param step  Called before each of the iterations, with its share; false cancels.
/// @return The positions; empty if cancelled.
std::vector<Vec3> tighten(const TemplateCage& cage, const std::vector<Vec3>& rest, const TriangleMesh& hull,
                          const TightenOptions& options, const std::function<bool(double)>& step);

}  // namespace cagecast::cages
