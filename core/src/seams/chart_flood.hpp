#pragma once

#include <cstdint>

#include "base/arena.hpp"
#include "cage/uv_charts.hpp"
#include "geometry/closest_point.hpp"
#include "input/cage.hpp"
#include "search/kd_tree.hpp"
#include "search/near_kernel.hpp"
#include "simd/simd.hpp"

namespace cagecast {

/// Finds the place of a point on a triangle of the cage.
void setPlace(const Cage& cage, const Vec3& p, std::uint32_t t, Candidate& out) noexcept;

/// A corner of a target triangle, and its place on the cage.
struct Corner {
  std::uint32_t point;
  std::uint32_t group;    ///< The last one of patches around its place, if `ChartFlood` has any.
  const float* position;  ///< x, y, z.
  Vec3 p;                 ///< The same.
  Candidate at;
  Uv uv;  ///< Of that place.
};

/// A triangle of the cage that might be the nearest of a patch to some points.
struct NearPoints {
  std::uint32_t triangle;
  std::uint32_t points;  ///< Bit i is point i of the patch's group.
};

/// docs/method.md, step 9: what hangs together in the texture with the triangle under a corner, within reach of the
/// corner's place.
struct Patch {
  /// Points whose distances are found at once: the place, and corners that share a triangle with the one whose place it
  /// is.
  static constexpr std::uint32_t kPoints = 8;

  double reach;
  simd::f32x4 limits;      ///< Squared distances: up to lane 0 surely within reach, up to the others perhaps.
  float least[kPoints];    ///< Squared distances of the points, in float.
  Patch* wider;            ///< The next one of its group.
  const NearPoints* near;  ///< What of it might be the nearest to any point; null until it has grown.
  std::uint32_t nearCount;
  std::uint32_t size;  ///< Triangles.
};

/// Finds patches of a cage, many at a time.
///
/// Those around one place, of triangles with few enough other corners, are a group: each begins as the narrower one,
/// and a look at a triangle of the cage tells how far it is from all that they are asked for.
class ChartFlood {
 public:
  /// Of so many triangles at a time: most of them share places.
  static constexpr std::uint32_t kMostTriangles = 256;

  /// Takes what it needs from `arena`; `arena.failed()` tells if that was there.
  ChartFlood(const Cage& cage, const CageTree& tree, const UvCharts& charts, double diagonal, Arena& arena) noexcept;

  /// Forgets all of them.
  void clear() noexcept { patchCount_ = groupCount_ = nextGroup_ = nearCount_ = 0; }

  /// Whether those of another triangle can be added.
  [[nodiscard]] bool hasRoom() const noexcept {
    return patchCount_ + 3 <= kMostPatches && groupCount_ + 3 <= kMostGroups;
  }

  /// Notes the patch around the place of corner k of a triangle.
  /// @param[out] inGroup  Which of its group's points the other two are; of k the place.
  Patch& add(Corner* const (&corners)[3], int k, double reach, std::uint8_t (&inGroup)[3]) noexcept;

  /// Grows what was noted, until there is no more room for what is near. For three patches there always is.
  void grow() noexcept;

 private:
  static constexpr std::uint32_t kPlace = 0;
  /// So many hold one number of each point.
  static constexpr std::uint32_t kVectors = Patch::kPoints / simd::kWide;
  /// What `kMostTriangles` ask for, on most models.
  static constexpr std::uint32_t kMostPatches = 704;
  static constexpr std::uint32_t kMostGroups = 352;
  /// Room for what is near, besides three times the whole cage.
  static constexpr std::uint32_t kRoom = 4096;
  /// Beyond lane 0 of `Patch::limits`, within the others.
  static constexpr unsigned kUnsure = 0b1110;
  static constexpr std::uint32_t kWalks = 2;

  struct Group {
    float positions[3][Patch::kPoints];    ///< By axis, from the middle of the cage.
    std::uint32_t points[Patch::kPoints];  ///< Which of the target these are; first the one whose place it is.
    std::uint32_t count;                   ///< Of points.
    std::uint32_t first;                   ///< The triangle that the place is on.
    Vec3 place;
    Patch* narrowest;
  };
  /// Grows the patches of one group after the other, ring by ring.
  struct Walk {
    const Group* group;
    const Patch* narrower;     ///< The one before; null at first.
    Patch* patch;              ///< Null at the end of the walk.
    std::uint32_t size;        ///< Triangles so far,
    std::uint32_t kept;        ///< with what was kept of those next to the last ring,
    std::uint32_t end;         ///< and, before they are looked at, with all of those.
    std::uint32_t* triangles;  ///< 1 per triangle of the cage.
    float* squares;            ///< Squared distances: `kPoints` per triangle.
    simd::wide least[kVectors];
    std::uint32_t beyondCount;
    std::uint32_t* beyond;  ///< What was looked at and not kept,
    float* beyondSquares;   ///< and how far from the place it is.
    std::uint32_t mark = 0;
    std::uint32_t* seen;      ///< 1 per triangle: the last mark with which it was met.
    std::uint32_t* sideSeen;  ///< 1 per side: the last one with which a round about its edge was made.
  };

  Group& groupWith(Corner* const (&corners)[3], int k, std::uint8_t (&inGroup)[3]) noexcept;
  Group& addGroup(Corner& own) noexcept;
  void setPoint(Group& group, std::uint32_t at, const Corner& corner) const noexcept;
  void begin(Walk& walk) noexcept;
  void look(Walk& walk) noexcept;
  void meet(Walk& walk) noexcept;
  void finish(Walk& walk) noexcept;
  bool findNear(const Walk& walk) noexcept;
  [[nodiscard]] bool isWithinReach(const Walk& walk, std::uint32_t t) const noexcept;

  const Cage& cage_;
  const CageTree& tree_;
  const UvCharts& charts_;
  float fixedSlack_;
  NearTriangle* rows_;  ///< 1 per triangle: all that a look needs in two cache lines, where a leaf has it in six.
  Patch* patches_;
  Group* groups_;
  std::uint32_t patchCount_ = 0, groupCount_ = 0;
  std::uint32_t nextGroup_ = 0;  ///< To grow.
  NearPoints* near_;             ///< Of one patch after the other,
  std::uint32_t room_;           ///< so many at most,
  std::uint32_t nearCount_ = 0;  ///< and so far.
  Walk walks_[kWalks];
};

}  // namespace cagecast
