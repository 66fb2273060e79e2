// The only file of the core that handles exceptions: nanoflann and std::vector throw when memory runs out.
#include "input/merge_near.hpp"

// Under a name of its own: a program may have another version, or other flags for it, and linkers mix what headers
// define.
#define nanoflann cagecast_nanoflann
#include <nanoflann.hpp>

#include <algorithm>
#include <cmath>
#include <limits>
#include <new>
#include <vector>

#include "base/union_find.hpp"

namespace cagecast {
namespace {

/// Floats per position.
constexpr std::size_t kStride = 4;

/// The most others that may be near to each point, on average. Real meshes stay far below it, and at it 100,000 points
/// take half a second.
constexpr std::uint64_t kMaxNear = 2000;

/// Points as nanoflann wants to see them.
struct Cloud {
  const float* positions;
  std::size_t count;

  [[nodiscard]] std::size_t kdtree_get_point_count() const { return count; }
  [[nodiscard]] double kdtree_get_pt(std::size_t point, std::size_t axis) const {
    return static_cast<double>(positions[kStride * point + axis]);
  }
  template <typename Box>
  bool kdtree_get_bbox(Box&) const {
    return false;
  }
};

/// In double precision: as floats, differences of coordinates would be rounded, and points that are not equally near
/// would seem to be.
using Tree = nanoflann::KDTreeSingleIndexAdaptor<nanoflann::L2_Simple_Adaptor<double, Cloud>, Cloud, 3, std::uint32_t>;

/// What keeps the points that a search finds. nanoflann wants all of this; `DistanceType` and `sort` from version 1.6
/// on.
class Found {
 public:
  using DistanceType = double;
  [[nodiscard]] std::size_t size() const { return 1; }
  [[nodiscard]] bool full() const { return true; }
  void sort() {}
};

template <typename Result>
void search(const Tree& tree, const float* position, Result& result) {
  const double at[] = {static_cast<double>(position[0]), static_cast<double>(position[1]),
                       static_cast<double>(position[2])};
  tree.findNeighbors(result, at, {});
}

/// Keeps the nearest site, of equally near ones the first. (nanoflann's own set keeps the one it meets first.)
class FirstNearest : public Found {
 public:
  /// Beyond the best by more than rounding, so that its equals are shown too.
  [[nodiscard]] double worstDist() const { return squaredDistance_ * (1 + 1e-12); }
  bool addPoint(double squaredDistance, std::uint32_t site) {
    if (squaredDistance < squaredDistance_ || (squaredDistance == squaredDistance_ && site < site_)) {
      squaredDistance_ = squaredDistance;
      site_ = site;
    }
    return true;
  }
  [[nodiscard]] std::uint32_t site() const { return site_; }

 private:
  double squaredDistance_ = std::numeric_limits<double>::max();
  std::uint32_t site_ = 0;
};

/// Joins all points of a group within a radius of one of them.
class JoinNear : public Found {
 public:
  JoinNear(UnionFind& sets, const std::uint32_t* groups, double squaredRadius, std::uint64_t mostVisits)
      : sets_(sets), groups_(groups), squaredRadius_(squaredRadius), mostVisits_(mostVisits) {}
  void around(std::uint32_t point) { point_ = point; }
  [[nodiscard]] bool isOverLimit() const { return visits_ > mostVisits_; }

  [[nodiscard]] double worstDist() const { return squaredRadius_ * (1 + 1e-12); }
  bool addPoint(double squaredDistance, std::uint32_t other) {
    if (squaredDistance < squaredRadius_ && groups_[other] == groups_[point_]) sets_.join(point_, other);
    return ++visits_ <= mostVisits_;
  }

 private:
  UnionFind& sets_;
  const std::uint32_t* groups_;
  double squaredRadius_;
  std::uint64_t mostVisits_;
  std::uint64_t visits_ = 0;
  std::uint32_t point_ = 0;
};

}  // namespace

Code mergeNear(float* positions, const std::uint32_t* groups, std::uint32_t& count, double radius,
               std::uint32_t* joined) noexcept {
  try {
    const Cloud cloud{positions, count};
    const Tree tree(3, cloud);
    std::vector<std::uint32_t> parents(count);
    UnionFind sets(parents.data(), count);
    JoinNear near(sets, groups, radius * radius, (kMaxNear + 1) * count);  // Each meets itself, too.
    for (std::uint32_t i = 0; i < count; ++i) {
      near.around(i);
      search(tree, positions + kStride * i, near);
      if (near.isOverLimit()) return Code::weldToleranceTooLarge;
    }
    std::uint32_t joinedCount = 0;
    for (std::uint32_t i = 0; i < count; ++i) {
      const std::uint32_t root = sets.find(i);  // Never behind i, so it has its number already.
      const float* from = positions + kStride * i;
      if (root == i) {
        joined[i] = joinedCount++;
        std::copy(from, from + kStride, positions + kStride * joined[i]);
        continue;
      }
      joined[i] = joined[root];
      float* to = positions + kStride * joined[i];
      if (std::lexicographical_compare(from, from + kStride, to, to + kStride)) std::copy(from, from + kStride, to);
    }
    count = joinedCount;
    return Code::ok;
  } catch (...) {  // Of memory alone: nothing else is thrown here.
    return Code::outOfMemory;
  }
}

bool nearestSites(const float* sites, std::uint32_t siteCount, const float* points, std::uint32_t pointCount,
                  std::uint32_t* nearest) noexcept {
  try {
    const Cloud cloud{sites, siteCount};
    const Tree tree(3, cloud);
    for (std::uint32_t i = 0; i < pointCount; ++i) {
      FirstNearest found;
      search(tree, points + kStride * i, found);
      nearest[i] = found.site();
    }
    return true;
  } catch (...) {  // Of memory alone: nothing else is thrown here.
    return false;
  }
}

}  // namespace cagecast
