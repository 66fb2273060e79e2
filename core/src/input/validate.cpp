#include "input/validate.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

#include "simd/simd.hpp"

namespace cagecast {
namespace {

/// Farthest a coordinate may be from the origin, in diagonals of the target. Its fourth power fits a float. A target
/// this far away is a single point to a float.
constexpr float kMaxProportion = 1e8f;
/// Greatest coordinate: distances between any two positions still fit a float.
constexpr float kMaxCoordinate = 0x1p125f;
/// Rays may begin between floats. Their origins are rounded relative to the distance from the origin of coordinates, so
/// half of that distance counts as the scene's size if it is larger.
constexpr float kSizePerDistance = 0.5f;

struct Bounds {
  float low[4];  ///< x, y, z; the fourth is of no use.
  float high[4];

  [[nodiscard]] double diagonal() const {
    double sum = 0;
    for (int k = 0; k < 3; ++k) {
      const double side = static_cast<double>(high[k]) - static_cast<double>(low[k]);
      sum += side * side;
    }
    return std::sqrt(sum);
  }
};

/// The ranges of four rows of numbers, and whether all of these are finite.
struct Rows {
  simd::f32x4 low = simd::splat(std::numeric_limits<float>::infinity());
  simd::f32x4 high = simd::splat(-std::numeric_limits<float>::infinity());
  simd::f32x4 sum = simd::splat(0);  ///< Of x · 0, which is 0 for a finite x and NaN otherwise.

  void take(simd::f32x4 x) {
    low = simd::min(low, x);
    high = simd::max(high, x);
    sum = sum + x * simd::splat(0);
  }
  [[nodiscard]] bool areFinite() const { return simd::bits(sum <= simd::splat(0)) == 15; }
};

bool areFinite(std::span<const float> values) {
  Rows rows;
  std::size_t i = 0;
  for (; i + simd::kWidth <= values.size(); i += simd::kWidth) rows.take(simd::load(&values[i]));
  for (; i < values.size(); ++i) rows.take(simd::splat(values[i]));
  return rows.areFinite();
}

/// The place of the first value that is not finite; there must be one.
std::size_t firstNonFinite(std::span<const float> values) {
  std::size_t i = 0;
  while (std::isfinite(values[i])) ++i;
  return i;
}

/// Finds the box around positions.
/// @return false if any is not finite.
bool bound(std::span<const float> positions, Bounds& box) {
  // Four vertices fill three vectors; after them, axes lie in the same lanes again.
  Rows rows[3];
  const float* p = positions.data();
  const float* const end = p + positions.size();
  for (; end - p >= 12; p += 12) {
    for (int j = 0; j < 3; ++j) rows[j].take(simd::load(p + 4 * j));
  }
  for (; p != end; p += 3) rows[0].take(simd::of(p[0], p[1], p[2], p[0]));
  float lows[12];
  float highs[12];
  for (int j = 0; j < 3; ++j) {
    simd::store(lows + 4 * j, rows[j].low);
    simd::store(highs + 4 * j, rows[j].high);
  }
  simd::f32x4 low = simd::load3(lows);
  simd::f32x4 high = simd::load3(highs);
  for (int i = 3; i < 12; i += 3) {
    low = simd::min(low, simd::load3(lows + i));
    high = simd::max(high, simd::load3(highs + i));
  }
  simd::store(box.low, low);
  simd::store(box.high, high);
  rows[0].sum = rows[0].sum + rows[1].sum + rows[2].sum;
  return rows[0].areFinite();
}

std::uint32_t highestOf(std::span<const std::uint32_t> indices) {
  std::uint32_t most = 0;
  for (const std::uint32_t index : indices) most = std::max(most, index);
  return most;
}

/// The place of the first index that is too large; the number of indices if none is.
std::size_t firstStray(std::span<const std::uint32_t> indices, std::size_t limit) {
  if (highestOf(indices) < limit) return indices.size();
  const auto isStray = [=](std::uint32_t index) { return index >= limit; };
  return static_cast<std::size_t>(std::find_if(indices.begin(), indices.end(), isStray) - indices.begin());
}

Status checkMesh(const MeshView& mesh, Argument argument, Bounds& box) {
  const auto fault = [argument](Code code, std::size_t at = 0) {
    return Status{code, argument, static_cast<std::uint32_t>(std::min<std::size_t>(at, UINT32_MAX))};
  };
  if (mesh.positions.empty()) return fault(Code::emptyMesh);
  if (mesh.positions.size() % 3 != 0) return fault(Code::positionsNotTriples, mesh.positions.size());
  const std::size_t vertices = mesh.positions.size() / 3;
  if (mesh.indices.empty()) return fault(Code::emptyMesh);
  if (mesh.indices.size() % 3 != 0) return fault(Code::indicesNotTriples, mesh.indices.size());
  if (vertices > kMaxVertices) return fault(Code::tooLarge, vertices);
  if (mesh.indices.size() / 3 > kMaxTriangles) return fault(Code::tooLarge, mesh.indices.size() / 3);
  if (!mesh.uvs.empty() && mesh.uvs.size() != 2 * vertices) return fault(Code::uvCountMismatch, mesh.uvs.size());
  if (argument == Argument::cage && mesh.uvs.empty()) return fault(Code::missingUvs);
  if (!mesh.groups.empty() && mesh.groups.size() != vertices)
    return fault(Code::groupCountMismatch, mesh.groups.size());

  if (!bound(mesh.positions, box)) return fault(Code::nonFinitePosition, firstNonFinite(mesh.positions));
  if (!areFinite(mesh.uvs)) return fault(Code::nonFiniteUv, firstNonFinite(mesh.uvs));
  const std::size_t stray = firstStray(mesh.indices, vertices);
  return stray < mesh.indices.size() ? fault(Code::indexOutOfRange, stray) : Status{};
}

/// The place of the first coordinate that is farther from the origin than a limit; there must be one.
std::size_t firstTooLarge(std::span<const float> positions, double limit) {
  std::size_t i = 0;
  while (std::abs(static_cast<double>(positions[i])) <= limit) ++i;
  return i;
}

/// Checks the poses of a target.
/// @param limit  The greatest coordinate.
/// @param box    Around the positions; grows to contain those of the poses.
Status checkPoses(const MeshView& target, double limit, Bounds& box) {
  if (target.poses.empty()) return {};
  const auto fault = [](Code code, std::size_t at) {
    return Status{code, Argument::target, static_cast<std::uint32_t>(std::min<std::size_t>(at, UINT32_MAX))};
  };
  if (target.poses.size() % target.positions.size() != 0) return fault(Code::poseCountMismatch, target.poses.size());
  Bounds posed;
  if (!bound(target.poses, posed)) return fault(Code::badPose, firstNonFinite(target.poses));
  for (int k = 0; k < 3; ++k) {
    if (static_cast<double>(std::max(-posed.low[k], posed.high[k])) > limit)
      return fault(Code::badPose, firstTooLarge(target.poses, limit));
    box.low[k] = std::min(box.low[k], posed.low[k]);
    box.high[k] = std::max(box.high[k], posed.high[k]);
  }
  return {};
}

/// Whether each vertex has 0 or a whole record with existing segments.
bool areRecords(const Hiders& hiders, std::size_t vertexCount, std::size_t segmentCount) {
  const auto& [ofVertex, records] = hiders;
  if (!ofVertex.empty() && ofVertex.size() != vertexCount) return false;
  const auto isRecord = [&records = records, segmentCount](std::size_t at) {
    if (records.size() < 3 || at > records.size() - 3 || records[at] >= at) return false;
    std::uint32_t rays = records[at + 2];
    for (at += 3; rays > 0 && at < records.size(); --rays) {
      const std::size_t count = records[at++];
      if (count > records.size() - at) return false;
      if (firstStray(records.subspan(at, count), segmentCount) < count) return false;
      at += count;
    }
    return rays == 0;
  };
  std::size_t last = 0;
  return std::all_of(ofVertex.begin(), ofVertex.end(), [&, &records = records](std::size_t at) {
    if (at == last) return true;
    for (last = at; at != 0; at = records[at]) {
      if (!isRecord(at)) return false;
    }
    return true;
  });
}

}  // namespace

Status checkArrays(const MeshView& mesh, Argument argument) noexcept {
  Bounds box;
  return checkMesh(mesh, argument, box);
}

Status checkProjection(const ProjectionView& projection, std::span<const std::uint32_t> indices) noexcept {
  const auto fault = [](Code code, std::size_t at) {
    return Status{code, Argument::target, static_cast<std::uint32_t>(at)};
  };
  const auto& [visibility, segments, stats, recovery, shares, hiders] = projection;
  const Status mismatch = fault(Code::resultMismatch, visibility.size());
  if (indices.size() % 3 != 0) return fault(Code::indicesNotTriples, indices.size());
  if (segments.size() != visibility.size()) return mismatch;
  const std::size_t stray = firstStray(indices, visibility.size());
  if (stray < indices.size()) return fault(Code::indexOutOfRange, stray);
  const std::size_t segmentCount = stats.size();
  // A cage has fewer holes than triangles.
  const auto isShare = [=](const HoleShare& of) { return of.segment < segmentCount && of.hole < kMaxTriangles; };
  const bool isWhole = firstStray(segments, segmentCount) == segments.size() &&
                       (recovery.empty() || recovery.size() == visibility.size()) &&
                       areRecords(hiders, visibility.size(), segmentCount) &&
                       std::all_of(shares.begin(), shares.end(), isShare) &&
                       std::is_sorted(shares.begin(), shares.end(),
                                      [](const HoleShare& a, const HoleShare& b) { return a.hole < b.hole; });
  return isWhole ? Status{} : mismatch;
}

Status checkMeshes(const MeshView& cage, const MeshView& target, Units& units) noexcept {
  Bounds cageBox;
  Bounds targetBox;
  if (const Status status = checkMesh(cage, Argument::cage, cageBox); !status.ok()) return status;
  if (const Status status = checkMesh(target, Argument::target, targetBox); !status.ok()) return status;
  // A target that is a single point has no size; then the cage's serves.
  const double size = targetBox.diagonal() > 0 ? targetBox.diagonal() : cageBox.diagonal();
  int exponent = 0;
  if (size > 0) std::frexp(size, &exponent);
  const double scale = std::ldexp(1.0, std::clamp(1 - exponent, -126, 127));
  const double limit = std::min(static_cast<double>(kMaxProportion) / scale, static_cast<double>(kMaxCoordinate));
  const Bounds restBox = targetBox;
  if (const Status status = checkPoses(target, limit, targetBox); !status.ok()) return status;
  float sceneSize = 0;
  for (int k = 0; k < 3; ++k) {
    const auto scaled = [scale](float x) { return static_cast<float>(static_cast<double>(x) * scale); };
    for (const bool ofCage : {true, false}) {
      const Bounds& box = ofCage ? cageBox : targetBox;
      if (static_cast<double>(std::max(-box.low[k], box.high[k])) <= limit) continue;
      const std::size_t at = firstTooLarge((ofCage ? cage : target).positions, limit);
      return {Code::tooLarge, ofCage ? Argument::cage : Argument::target, static_cast<std::uint32_t>(at)};
    }
    units.low[k] = scaled(restBox.low[k]);
    units.high[k] = scaled(restBox.high[k]);
    const float low = std::min(scaled(targetBox.low[k]), scaled(cageBox.low[k]));
    const float high = std::max(scaled(targetBox.high[k]), scaled(cageBox.high[k]));
    sceneSize = std::max({sceneSize, high - low, high * kSizePerDistance, -low * kSizePerDistance});
  }
  units.scale = static_cast<float>(scale);
  units.diagonal = restBox.diagonal() * scale;
  units.sceneSize = sceneSize;
  return {};
}

}  // namespace cagecast
