#pragma once

#include <cstdint>

#include "cagecast/status.hpp"

/// Searches among points, not surfaces: what nanoflann is made for.
namespace cagecast {

/// Joins points of equal group that are nearer to each other than `radius`, chains of them too, and moves them to the
/// position that is smallest in x, then y, then z. Joined points keep the order of their first members.
/// @param[in,out] positions  x, y, z, 0 per point; on return those of the joined points.
/// @param groups             1 per point.
/// @param[in,out] count      The number of points; on return, how many are left.
/// @param[out] joined        The joined point of each point.
/// @return ok; weldToleranceTooLarge if points have more than 2000 others within the radius, on average; outOfMemory.
Code mergeNear(float* positions, const std::uint32_t* groups, std::uint32_t& count, double radius,
               std::uint32_t* joined) noexcept;

/// Finds the nearest of `sites` for each of `points`; of equally near ones the first.
/// @param sites,points  x, y, z, 0 each.
/// @param[out] nearest  1 per point.
/// @return false if memory ran out.
bool nearestSites(const float* sites, std::uint32_t siteCount, const float* points, std::uint32_t pointCount,
                  std::uint32_t* nearest) noexcept;

}  // namespace cagecast
