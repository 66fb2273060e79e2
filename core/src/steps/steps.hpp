#pragma once

#include <algorithm>

#include "base/tolerances.hpp"
#include "steps/classify.hpp"
#include "steps/point_data.hpp"
#include "steps/scene.hpp"

namespace cagecast {
using PointResults = PointData;
}
