#pragma once

#include <cstddef>
#include <cstdint>

#include "base/arena.hpp"
#include "search/ray.hpp"
#include "search/ray_leaf.hpp"
#include "search/ray_tree.hpp"
#include "search/segment_hits.hpp"

namespace cagecast {

/// Finds which rays hit a triangle, from either side, at a distance greater than `from` and up to their end.
/// Watertight: a ray through an edge or a corner that triangles share hits at least one of them. A triangle that has
/// the origin as a corner is hit at distance 0, exactly. A triangle whose plane contains the ray is not hit.
///
/// Many rays are traced together: each node is read once for all rays that enter it. They are traced fastest in an
/// order in which neighbours are close in space.
class RaySearch {
 public:
  /// The most rays to trace together: enough to share nodes, few enough for their lists to stay in the cache.
  static constexpr std::uint32_t kMaxRays = 1792;

  /// Allocates its working memory; check `arena.failed()` afterwards.
  /// @param from  Scaled; may be negative.
  RaySearch(const RayTree& tree, double from, Arena& arena) noexcept;

  enum class Find : std::uint8_t {
    any,      ///< Whether a ray hits anything.
    nearest,  ///< The distance of its first hit as well, which becomes the ray's end.
    all,      ///< All segments of the target that it hits, unless it hits its own.
  };

  /// If the work runs out (`Arena::spend`), what is found is incomplete.
  /// @param rays         At most `kMaxRays`.
  /// @param[out] hit     1 per ray.
  /// @param[out] hitsAt  If not null, with `Find::any`: 1 per ray that hits anything, a corner of what it hits.
  void search(Ray* rays, std::uint32_t count, bool* hit, Find find = Find::any,
              std::uint32_t* hitsAt = nullptr) noexcept;
  /// Finds which segments rays hit.
  /// @param[in,out] hits  `own` is read; the rest is overwritten.
  /// @param[out] hit      1 per ray: whether it hits its own segment. What else it hits is incomplete then.
  void search(Ray* rays, std::uint32_t count, bool* hit, SegmentHits& hits) noexcept;

 private:
  /// Entries for the lists of all levels: enough for usual trees. Where they run out, rays are traced in smaller
  /// groups.
  static constexpr std::size_t kListRoom = std::size_t{8} * kMaxRays;
  /// The entries kept for single rays: at each level four lists of two entries. No tree is deeper than 64 levels.
  static constexpr std::ptrdiff_t kLastRoom = 8 * 64;
  /// Lists of at least this length are moved together.
  static constexpr std::uint32_t kLong = 256;

  void visit(const Node& node, std::uint16_t* rays, std::uint32_t count, std::uint16_t* free) noexcept;
  void testBoxes(const Node& node, std::uint16_t* rays, std::uint32_t count, std::uint16_t* lists,
                 std::uint32_t (&counts)[4]) const noexcept;
  void testLeaf(const Node& node, int child, std::uint16_t* rays, std::uint32_t count) noexcept;
  void decide(const RayLeaf& leaf, std::uint32_t first, const std::uint16_t* rays, std::uint32_t count) noexcept;
  void listSegments(const RayLeaf& leaf, std::uint32_t first, const std::uint16_t* rays, std::uint32_t count) noexcept;

  const RayTree& tree_;
  Arena& arena_;            ///< Counts the work.
  std::uint64_t work_ = 0;  ///< Of this search.
  double from_;
  float boxFrom_;         ///< `from` for the tests of boxes.
  HitLimits limits_;      ///< `from` for the tests of triangles.
  FloatRay* floatRays_;   ///< 1 per ray.
  std::uint16_t* lists_;  ///< `kListRoom`.
  Ray* rays_ = nullptr;
  bool* hit_ = nullptr;
  Find find_ = Find::any;
  std::uint32_t* hitsAt_ = nullptr;
  SegmentHits* hits_ = nullptr;
};

}  // namespace cagecast
