#include "clip/enclosed_search.hpp"

#include <algorithm>
#include <utility>

namespace cagecast {

bool EnclosedSearch::find(const List<Piece>& pieces, TrianglePoint& point) noexcept {
  const NearbyTriangles nearby = triangle_.nearby();
  const std::size_t mark = triangle_.classifier.mark();
  parts_.truncate(0);
  for (std::uint32_t i = 0; i < pieces.size(); ++i) {
    const TrianglePoint(&corners)[3] = pieces[i].corners;
    addPart(pieces[i], {{corners[0], corners[1], corners[2]}, i, nearby});
  }
  bool isFound = false;
  const std::size_t own = kOwnParts * pieces.size();
  for (std::size_t next = 0; next < parts_.size() && !isFound && !failed() && !triangle_.failed(); ++next) {
    if (next >= own && left_ == 0) break;
    if (next >= own) --left_;
    const Part part = parts_[next];
    const Piece& piece = pieces[part.piece];
    TrianglePoint t[6] = {part.corners[0], part.corners[1], part.corners[2]};
    triangle_.addMidpoints(t, part.nearby);
    for (int k = 3; k < 6 && !isFound; ++k) {
      isFound = t[k].sample.region != piece.region && triangle_.isWellInside(t[k].p, piece.corners);
      if (isFound) point = t[k];
    }
    for (const auto& [a, b, c] : kQuarters) addPart(piece, {{t[a], t[b], t[c]}, part.piece, part.nearby});
  }
  triangle_.classifier.rewind(mark);
  return isFound;
}

/// Queues a part, unless its core surely lies in the piece's region. The core is the area of the part that lies well
/// inside the piece. Only the core counts, of the part and of its quarters, so only triangles near it stay listed.
void EnclosedSearch::addPart(const Piece& piece, Part part) noexcept {
  if (longestEdge(part.corners) <= triangle_.tolerances.feature) return;
  Vec3 corners[kMaxCorners];
  const std::uint32_t count = clipToCore(piece, part, corners);
  if (count == 0) return;
  BorderClassifier& classifier = triangle_.classifier;
  const Hull core(corners, count);
  const std::size_t mark = classifier.mark();
  part.nearby = classifier.narrow(part.nearby, core);
  if (classifier.isSurelyIn(piece.region, part.nearby, core)) {
    classifier.rewind(mark);
  } else {
    parts_.add(part);
  }
}

/// Clips a part of a piece to what is well inside the piece.
/// @return The number of corners; 0 if nothing is left.
std::uint32_t EnclosedSearch::clipToCore(const Piece& piece, const Part& part,
                                         Vec3 (&core)[kMaxCorners]) const noexcept {
  std::uint32_t count = 3;
  for (int k = 0; k < 3; ++k) core[k] = part.corners[k].p;
  for (int k = 0; k < 3; ++k) {
    Vec3 before[kMaxCorners];
    std::copy(core, core + count, before);
    const std::uint32_t beforeCount = std::exchange(count, 0);
    double depths[kMaxCorners];
    for (std::uint32_t i = 0; i < beforeCount; ++i) depths[i] = triangle_.depthInside(before[i], piece.corners, k) - 1;
    for (std::uint32_t i = 0; i < beforeCount; ++i) {
      const std::uint32_t next = (i + 1) % beforeCount;
      const Vec3 p = before[i], q = before[next];
      const double depthOfP = depths[i], depthOfQ = depths[next];
      if (depthOfP > 0) core[count++] = p;
      if ((depthOfP > 0) != (depthOfQ > 0)) core[count++] = p + depthOfP / (depthOfP - depthOfQ) * (q - p);
    }
  }
  return count;
}

}  // namespace cagecast
