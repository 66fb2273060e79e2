#pragma once

#include <cstdint>

#include "cage/uv_charts.hpp"
#include "geometry/closest_point.hpp"
#include "input/cage.hpp"
#include "search/cage_tree.hpp"
#include "search/flat_triangles.hpp"
#include "simd/simd.hpp"
#include "steps/scene.hpp"

namespace cagecast {

/// A corner of a target triangle, and its closest point on the cage.
struct Corner {
  std::uint32_t point;    ///< In `Points`.
  std::uint32_t group;    ///< The group of `ChartFlood` that was last made around its closest point.
  const float* position;  ///< x, y, z, scaled.
  Vec3 p;                 ///< The same.
  Candidate closest;
  Uv uv;  ///< At the closest point.
};

/// A cage triangle that may be the nearest one of its patch to some points of the patch's group.
struct PatchCandidate {
  std::uint32_t cageTriangle;
  std::uint32_t points;  ///< Bit i: point i of the group.
};

/// docs/method.md, step 12: the cage triangles that a flood over edges shared in UV reaches from a corner's closest
/// point, up to a distance.
struct ChartPatch {
  /// Points whose distances to a cage triangle are found at once: the closest point around which the patch lies, and
  /// target corners that are to be projected onto the patch.
  static constexpr std::uint32_t kPoints = 8;

  double reach;                      ///< Scaled.
  float leastSquared[kPoints];       ///< Squared distances of the points to the patch, in float.
  ChartPatch* wider;                 ///< The next patch of its group, by reach.
  const PatchCandidate* candidates;  ///< Null until the patch has grown.
  std::uint32_t candidateCount;
  std::uint32_t triangleCount;
};

/// Grows patches of the cage by flooding its charts, many at a time.
///
/// The patches around one closest point form groups: the flood of a wider patch goes on where that of the narrower one
/// stopped, and one pass of the kernel over a cage triangle finds its distances to all points of the group.
class ChartFlood {
 public:
  /// Target triangles at a time: most of them share closest points.
  static constexpr std::uint32_t kBatch = 256;

  /// Allocates its working memory; check `scene.arena.failed()` afterwards.
  ChartFlood(const Scene& scene, const UvCharts& charts) noexcept;

  /// Forgets all patches.
  void clear() noexcept { patchCount_ = groupCount_ = grownGroups_ = candidateCount_ = 0; }

  /// Whether the patches of another target triangle can be added.
  [[nodiscard]] bool hasRoom() const noexcept {
    return patchCount_ + 3 <= kMaxPatches && groupCount_ + 3 <= kMaxGroups;
  }

  /// Adds the patch around the closest point of corner k of a target triangle. It has no triangles before `grow`.
  /// @param[out] inGroup  For each corner its number among the points of the group; of k that of the closest point.
  ChartPatch& add(Corner* const (&corners)[3], int k, double reach, std::uint8_t (&inGroup)[3]) noexcept;

  /// Grows the patches in the order in which they were added, until there is no more room for candidates. There is
  /// always room for the patches of one target triangle.
  void grow() noexcept;

 private:
  /// The closest point's number among the points of its group.
  static constexpr std::uint32_t kCentre = 0;
  static constexpr std::uint32_t kVectors = ChartPatch::kPoints / simd::kWidth;
  /// What `kBatch` triangles need on most models.
  static constexpr std::uint32_t kMaxPatches = 704;
  static constexpr std::uint32_t kMaxGroups = 352;
  /// Room for candidates, in addition to three times the whole cage.
  static constexpr std::uint32_t kCandidateRoom = 4096;

  /// Patches around one closest point, for up to `ChartPatch::kPoints` points.
  struct Group {
    float positions[3][ChartPatch::kPoints];    ///< By axis, from the middle of the cage.
    std::uint32_t points[ChartPatch::kPoints];  ///< In `Points`; `kCentre`: the point whose closest point it is.
    std::uint32_t count;                        ///< Of points.
    std::uint32_t cageTriangle;                 ///< That the closest point lies on.
    Vec3 centre;                                ///< The closest point.
    ChartPatch* narrowest;
    /// SIMD vectors that hold one number of each point.
    [[nodiscard]] std::uint32_t vectors() const noexcept { return (count + simd::kWidth - 1) / simd::kWidth; }
  };
  /// A triangle that the flood met and found out of reach.
  struct OutOfReach {
    std::uint32_t cageTriangle;
    float squared;
  };

  Group& groupWith(Corner* const (&corners)[3], int k, std::uint8_t (&inGroup)[3]) noexcept;
  Group& addGroup(Corner& own) noexcept;
  void setPoint(Group& group, std::uint32_t at, const Corner& corner) const noexcept;
  bool growGroup(const Group& group) noexcept;
  void requeueWithin(float limit) noexcept;
  void flood(const Group& group, double reach) noexcept;
  template <typename Visit>
  void visitFans(std::uint32_t cageTriangle, Visit visit) noexcept;
  bool listCandidates(const Group& group, ChartPatch& patch) noexcept;
  [[nodiscard]] double roundingAt(const Group& group, double reach) const noexcept;

  const Cage& cage_;
  const CageTree& tree_;
  const UvCharts& charts_;
  float fixedSlack_;
  FlatTriangles<1>* triangles_;  ///< 1 per cage triangle.
  ChartPatch* patches_;
  Group* groups_;
  std::uint32_t patchCount_ = 0, groupCount_ = 0, grownGroups_ = 0;
  PatchCandidate* candidates_;  ///< Of one patch after the other.
  std::uint32_t candidateRoom_, candidateCount_ = 0;
  // Of the group that is growing:
  std::uint32_t* queue_;  ///< Cage triangles that the flood has met and not yet visited.
  std::uint32_t queueEnd_ = 0;
  std::uint32_t* members_;  ///< Cage triangles of the patch.
  float* squares_;          ///< `kPoints` per member: squared distances.
  std::uint32_t memberCount_ = 0;
  OutOfReach* outside_;
  std::uint32_t outsideCount_ = 0;
  simd::f32x4 least_[kVectors];  ///< Squared distances of the points to the nearest member.
  std::uint32_t mark_ = 0;       ///< The number of this flood.
  std::uint32_t* met_;           ///< 1 per cage triangle: the last flood that met it.
  std::uint32_t* edgeMet_;       ///< 1 per half-edge: the last flood that went around its fan.
};

}  // namespace cagecast
