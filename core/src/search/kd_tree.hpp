#pragma once

#include <bit>
#include <cstdint>
#include <limits>

#include "base/arena.hpp"
#include "base/tolerances.hpp"
#include "input/cage.hpp"
#include "input/weld.hpp"
#include "search/leaf_box.hpp"
#include "simd/simd.hpp"

/// The search trees: every node has four children, whose boxes lie side by side so that one SIMD instruction looks at
/// all of them; every leaf has up to four triangles, which lie side by side when it is looked at.
namespace cagecast {

/// A node's child: the index of a node, or a leaf with the high bit set: its first triangle. An unused child is some
/// leaf, in a box that is a point far away.
inline constexpr std::uint32_t kLeafBit = 0x8000'0000u;
inline constexpr std::uint32_t leafOf(std::uint32_t first) { return kLeafBit | first; }
inline constexpr std::uint32_t firstOf(std::uint32_t leaf) { return leaf & ~kLeafBit; }
static_assert(kMaxTriangles < kLeafBit);

/// Four boxes: low[axis][child], high[axis][child]. Each is a little larger than what it holds, by more than the
/// rounding of the kernels that use it, so that no box hides a triangle that its kernel would hit.
struct alignas(16) Node {
  float low[3][4];
  float high[3][4];
  std::uint32_t child[4];
};

/// Triangles for closest points, each in a frame of its own in which it lies flat: origin A at one end of its longest
/// edge, x along that edge to B, z along the normal; so C is above the edge AB, and its foot between A and B.
/// @tparam n  Triangles side by side: 4 for a leaf, or 1.
template <int n>
struct alignas(16) FlatTriangles {
  /// What makes a coordinate of a point that is counted from the middle of the cage.
  struct Axis {
    float offset[n];        ///< Coordinate of the middle of the cage.
    float direction[3][n];  ///< Unit vector.
  };
  Axis axes[3];
  /// The upper edges, AC on the left and BC on the right, each from its end on AB to C; x is counted towards the foot
  /// of C. Unit vectors, and lengths.
  float leftX[n], leftY[n], leftLength[n];
  float rightX[n], rightY[n], rightLength[n];
  float base[n];  ///< B = (base, 0).
  float foot[n];  ///< x of C.
};

/// The triangles of a leaf. Unused lanes are infinitely far away.
struct NearLeaf : FlatTriangles<4> {
  std::uint32_t slot[4];  ///< The place in `Cage::triangles`.
};

/// A tree for rays: boxes, and under them triangles that stay where they are.
struct RayTree {
  const Node* nodes = nullptr;       ///< The root is node 0.
  const float* positions = nullptr;  ///< x, y, z and a fourth float each, scaled.
  /// 3 positions per triangle, leaf by leaf. A ray that comes to a leaf is tried with the four triangles from its first
  /// on, of which the last may be another leaf's: the row has so many more at its end.
  const std::uint32_t* corners = nullptr;
  float reach = 0;  ///< The longest side of the box around all rays and triangles, scaled.
};

/// A tree over the cage's triangles, without gaps: node i of a level holds nodes 4i … 4i + 3 of the next, or such
/// leaves.
struct CageTree {
  /// A level of at most so many nodes is looked at as a whole: quicker than finding the way to it from the root.
  static constexpr std::uint32_t kMostEntries = 16;

  RayTree rays;                    ///< Its nodes go level by level.
  const NearLeaf* near = nullptr;  ///< The triangles of `rays`, four by four.
  const LeafBox* boxes = nullptr;  ///< Of the leaves.
  std::uint32_t leafCount = 0;
  std::uint32_t lastLevel = 0;   ///< The first node whose children are leaves.
  std::uint32_t entry = 0;       ///< The first node of the lowest level with at most `kMostEntries`.
  std::uint32_t entryCount = 0;  ///< Nodes of that level.
  std::uint32_t levelsBelowEntry = 0;
  double extent = 0;     ///< Longest side of its box, scaled.
  float middle[4] = {};  ///< Of its box: x, y, z, 0, scaled. From there on coordinates have few roundings.
};

/// @return false if memory ran out.
bool buildTargetTree(const Points& target, const Units& units, Arena& arena, RayTree& out) noexcept;
bool buildCageTree(const Cage& cage, const Units& units, Arena& arena, CageTree& out) noexcept;

/// Searches the cage's triangles for the nearest to a few points at once.
///
/// Points that are neighbours are near the same triangles: the tree is walked once for all of them, by the box around
/// them, and only its leaves are looked at by each. The walk begins with the limits that two leaves give them, one near
/// each end.
class NearestSearch {
 public:
  static constexpr std::uint32_t kGroup = 16;  ///< Points searched for at once.

  /// Takes what it needs from `arena`; `arena.failed()` tells if that was there.
  /// @param diagonal  Of the target, scaled.
  NearestSearch(const CageTree& tree, double diagonal, Arena& arena) noexcept;

  /// From now on finds triangles as well that are farther than the nearest by up to `more`.
  /// @param distance  Some distance to the cage, greater than 0: the nearer to that of what is searched for, the fewer
  /// are found.
  void widen(double more, double distance) noexcept;

  /// Searches for `count` ≤ `kGroup` points that are near each other.
  /// @param positions  As in `Points`; `candidates` may look at them again.
  void search(const float* positions, std::uint32_t count) noexcept;

  /// The triangles that could be the nearest to point i of the last search by the tie rule: all whose distance is
  /// within `kTieDistance` of the least, and some that rounding cannot tell from them.
  /// @param[out] found  Room for every triangle of the cage.
  /// @return How many were found: at least 1.
  std::uint32_t candidates(std::uint32_t i, std::uint32_t* found) noexcept;
  /// The same where there is but one, as most often: quicker.
  /// @return That triangle; `kSeveral` if there are more.
  [[nodiscard]] std::uint32_t onlyCandidate(std::uint32_t i) const noexcept;
  static constexpr std::uint32_t kSeveral = UINT32_MAX;

 private:
  /// One more than the leaves to remember of a point; if more come close, `candidates` looks again.
  static constexpr std::uint32_t kRoom = 8;

  /// Leaves that are near enough to a box, level by level.
  /// @return How many.
  std::uint32_t listLeaves(const simd::f32x4 (&low)[3], const simd::f32x4 (&high)[3], simd::f32x4 limit,
                           std::uint32_t*& leaves) const noexcept;
  /// Some leaf whose box is near a point: at each node the nearest child.
  [[nodiscard]] std::uint32_t leafNear(simd::f32x4 point) const noexcept;
  /// Searches those of some leaves whose boxes are near enough to a point, for those points.
  void searchLeaves(const std::uint32_t* leaves, std::uint32_t leafCount) noexcept;
  /// Searches a leaf for some points of the group, a bit each.
  void searchLeaf(std::uint32_t leaf, unsigned members) noexcept;

  const CageTree& tree_;
  double slack_;      ///< The s of `kRelativeSlack`.
  float growth_;      ///< 1 + r,
  float fixedSlack_;  ///< and s² · (1 + 1/r).
  std::uint32_t lastLeaf_ = 0;
  const float* positions_ = nullptr;           ///< Of the last search.
  alignas(16) float points_[kGroup][4];        ///< x, y, z, 0 each, from the middle of the cage.
  alignas(16) float columns_[3][kGroup] = {};  ///< The same, by axis; any, where points are fewer.
  alignas(16) float limits_[kGroup];           ///< Squared distance within which a triangle is of interest.
  std::uint32_t* list_;                        ///< Room for all leaves, and four more.
  std::uint32_t* otherList_;
  std::uint32_t nearCount_[kGroup];  ///< From `kRoom` on some may be written over.
  // Of each point's leaves that had triangles within the limit, as it was then:
  float squaredDistances_[kRoom][kGroup];  ///< that of the nearest of these triangles,
  std::uint32_t lanes_[kRoom][kGroup];     ///< which they were, a bit each, below the leaf's index.
};

/// Four triangles for rays.
struct RayLeaf;

/// A ray: r(t) = position + rest + t · direction.
struct Ray {
  float position[3];
  float rest[3];  ///< What the exact origin has beyond `position`.
  const RayDirection* direction;
  double end = std::numeric_limits<double>::infinity();  ///< Hits beyond it do not count.

  void startAt(const float* from, const float* restOfIt) noexcept {
    for (int axis = 0; axis < 3; ++axis) {
      position[axis] = from[axis];
      rest[axis] = restOfIt[axis];
    }
  }
  [[nodiscard]] double origin(std::uint32_t axis) const noexcept {
    return static_cast<double>(position[axis]) + static_cast<double>(rest[axis]);
  }
};

/// What filters look at of a ray.
struct alignas(16) RoughRay {
  float inverse[3];      ///< 1 / component of the direction, of at most 1e20.
  float end;             ///< Not before the ray's end; less than anything once there is no more to find.
  float offset[3];       ///< For boxes: −origin · inverse.
  float shearX, shearY;  ///< `RayDirection::Rough`.
  float scaleZ;
  float origin[3];     ///< For leaves: z, x, y of it, as `axis` has them.
  std::uint32_t axis;  ///< Which axis of space serves as z.
};

/// Finds which rays hit a triangle at a distance greater than `from` and up to their end, from either side. Watertight:
/// a ray through an edge or a corner that triangles share hits at least one of them. A triangle that holds the origin
/// as a corner is hit at distance 0, exactly; one that holds the whole ray in its plane is not hit.
///
/// Many rays go through the tree together: each node is read once for all rays that enter it, which are then listed for
/// its children. They should come in an order in which neighbours are neighbours in space.
class HitSearch {
 public:
  /// Rays that go together: enough to share nodes, few enough for their lists to stay in the cache.
  static constexpr std::uint32_t kMostRays = 1792;

  /// Takes what it needs from `arena`; `arena.failed()` tells if that was there.
  /// @param from  Scaled.
  HitSearch(const RayTree& tree, double from, Arena& arena) noexcept;

  /// What is asked about a ray.
  enum class Find : std::uint8_t {
    any,      ///< Whether it hits anything.
    nearest,  ///< And at what distance the first: that becomes the ray's end.
  };

  /// @param rays      Up to `kMostRays`.
  /// @param[out] hit  1 per ray.
  void search(Ray* rays, std::uint32_t count, bool* hit, Find find = Find::any) noexcept;

 private:
  /// Room for lists, of all levels: enough but for odd trees. Where it ends, rays go in smaller parties.
  static constexpr std::size_t kListRoom = std::size_t{8} * kMostRays;
  /// From so many rays on, a list is worth being moved.
  static constexpr std::uint32_t kLong = 256;
  /// What is left of it for rays that go alone, four lists with room for two at each level: a tree is not that deep.
  static constexpr std::ptrdiff_t kLastRoom = 8 * 64;

  void enter(const Node& node, std::uint16_t* rays, std::uint32_t count, std::uint16_t* free) noexcept;
  void testBoxes(const Node& node, std::uint16_t* rays, std::uint32_t count, std::uint16_t* lists,
                 std::uint32_t (&counts)[4]) const noexcept;
  void testLeaf(const Node& node, int child, std::uint16_t* rays, std::uint32_t count) noexcept;
  void decide(const RayLeaf& leaf, const std::uint16_t* rays, std::uint32_t count) noexcept;

  const RayTree& tree_;
  double from_;
  float boxFrom_;         ///< The same for boxes.
  float loose_;           ///< Hits beyond this are worth deciding in double,
  float strict_;          ///< and beyond this they count for sure.
  float zero_;            ///< 0 if a hit at distance 0 is none, else no number.
  RoughRay* rough_;       ///< 1 per ray.
  std::uint16_t* lists_;  ///< `kListRoom`.
  Ray* rays_ = nullptr;
  bool* hit_ = nullptr;
  Find find_ = Find::any;
};

}  // namespace cagecast
