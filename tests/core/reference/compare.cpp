#include <algorithm>
#include <array>
#include <cmath>
#include <cstdio>

#include "reference/geometry.hpp"
#include "reference/reference.hpp"

namespace cagecast::reference {

Differences compare(const Result& reference, const TransferResult& product, const MeshView& target) {
  constexpr std::size_t kMaxLines = 10;
  constexpr double kUvTolerance = 1e-5, kDistanceTolerance = 1e-6, kAreaTolerance = 1e-9, kMinArea = 1e-11,
                   kScoreTolerance = 1e-6;
  Differences found;
  std::size_t lines = 0;
  const auto report = [&](const char* format, auto... values) {
    if (++lines > kMaxLines) return;
    std::array<char, 256> line{};
    std::snprintf(line.data(), line.size(), format, values...);
    found.details += line.data();
    found.details += '\n';
  };
  const Projection& projection = product.projection;
  const double diag = boxOf(target).diagonal();
  found.vertices = reference.zones.size();
  if (product.zones.zones.size() != found.vertices || projection.uvs.size() != 2 * found.vertices ||
      projection.triangles.size() != found.vertices || projection.distances.size() != found.vertices ||
      projection.segments.size() != found.vertices || projection.segmentStats.size() != reference.segmentStats.size() ||
      product.zones.culledBy.size() != reference.segmentStats.size() ||
      product.zones.cosmeticTriangles.size() != reference.cosmeticTriangles.size() ||
      projection.cornerUvs.size() != reference.cornerUvs.size()) {
    report("the arrays have other lengths: %zu zones of %zu, %zu segments of %zu", product.zones.zones.size(),
           found.vertices, projection.segmentStats.size(), reference.segmentStats.size());
    found.stats = 1;
    return found;
  }
  const auto isOtherUv = [](float gotUv, float expectedUv) {
    const double got = static_cast<double>(gotUv), expected = static_cast<double>(expectedUv);
    return !(std::abs(got - expected) <= kUvTolerance * std::max(1.0, std::abs(expected)));
  };
  std::vector<std::uint8_t> firm = reference.firmAreas;
  for (std::size_t v = 0; v < found.vertices; ++v) {
    if (projection.segments[v] != reference.segments[v]) {
      ++found.segments;
      report("vertex %zu: segment %u, expected %u", v, projection.segments[v], reference.segments[v]);
    }
    if (reference.stable[v] == 0) {
      ++found.unstable;
      firm[reference.segments[v]] = 0;
      continue;
    }
    const float* p = &target.positions[v * 3];
    const auto at = [&] {
      std::array<char, 128> text{};
      std::snprintf(text.data(), text.size(), "vertex %zu at (%.9g, %.9g, %.9g)", v, static_cast<double>(p[0]),
                    static_cast<double>(p[1]), static_cast<double>(p[2]));
      return std::string(text.data());
    };
    if (product.zones.zones[v] != reference.zones[v]) {
      ++found.zones;
      report("%s: zone %u, expected %u", at().c_str(), static_cast<unsigned>(product.zones.zones[v]),
             static_cast<unsigned>(reference.zones[v]));
    }
    if (projection.triangles[v] != reference.triangles[v]) {
      ++found.triangles;
      report("%s: cage triangle %u, expected %u", at().c_str(), projection.triangles[v], reference.triangles[v]);
      continue;  // Another triangle has another UV.
    }
    for (std::size_t k = v * 2; k < v * 2 + 2; ++k) {
      if (!isOtherUv(projection.uvs[k], reference.uvs[k])) continue;
      ++found.uvs;
      report("%s: uv %.9g, expected %.9g", at().c_str(), static_cast<double>(projection.uvs[k]),
             static_cast<double>(reference.uvs[k]));
      break;
    }
    const double expected = static_cast<double>(reference.distances[v]);
    const double got = static_cast<double>(projection.distances[v]);
    if (!(std::abs(got - expected) <= kDistanceTolerance * std::max(diag, expected))) {
      ++found.distances;
      report("%s: distance %.9g, expected %.9g", at().c_str(), got, expected);
    }
  }
  for (std::size_t t = 0; t < reference.cosmeticTriangles.size(); ++t) {
    const auto isStable = [&](std::size_t corner) { return reference.stable[target.indices[3 * t + corner]] != 0; };
    if (!isStable(0) || !isStable(1) || !isStable(2)) continue;
    if (product.zones.cosmeticTriangles[t] == reference.cosmeticTriangles[t]) continue;
    ++found.painted;
    report("triangle %zu: cosmetic %d, expected %d", t, int{product.zones.cosmeticTriangles[t]},
           int{reference.cosmeticTriangles[t]});
  }
  for (std::size_t i = 0; i < reference.cornerUvs.size(); ++i) {
    if (reference.stableCorners[i / 6] == 0 || !isOtherUv(projection.cornerUvs[i], reference.cornerUvs[i])) continue;
    ++found.corners;
    report("triangle %zu, corner %zu: uv %.9g, expected %.9g", i / 6, i % 6 / 2,
           static_cast<double>(projection.cornerUvs[i]), static_cast<double>(reference.cornerUvs[i]));
    i += 5 - i % 6;  // The next triangle.
  }
  // Which segments are small, and which depth is typical, depends on all of them.
  const bool areAllFirm = std::find(firm.begin(), firm.end(), 0) == firm.end();
  for (std::size_t s = 0; s < reference.segmentStats.size(); ++s) {
    const SegmentStats& expected = reference.segmentStats[s];
    const SegmentStats& got = projection.segmentStats[s];
    // Slivers have areas that rounding makes; they are compared with what matters, the size of the target.
    const double slack = kAreaTolerance * expected.area + kMinArea * diag * diag;
    const auto differs = [&](double a, double b) { return !(std::abs(a - b) <= slack); };
    // Scores are ratios of areas; where what is asked is next to nothing they are huge, and rounding shows, and where
    // the areas themselves are next to nothing.
    const double ratioTolerance = std::max(kScoreTolerance, slack / std::max(expected.exposedArea, slack));
    const auto differsAsRatio = [&](double a, double b) {
      const bool areFinite = std::isfinite(a) && std::isfinite(b);
      return a != b && !(areFinite && std::abs(a - b) <= ratioTolerance * std::max({1.0, std::abs(a), std::abs(b)}));
    };
    std::string differing;
    const auto check = [&](const char* name, bool isOther, double gotValue, double expectedValue) {
      if (!isOther) return;
      std::array<char, 96> text{};
      std::snprintf(text.data(), text.size(), " %s %.9g, expected %.9g;", name, gotValue, expectedValue);
      differing += text.data();
    };
    const auto checkArea = [&](const char* name, double a, double b) { check(name, differs(a, b), a, b); };
    check("points", got.points != expected.points, got.points, expected.points);
    checkArea("area", got.area, expected.area);
    if (firm[s] != 0) {
      check("culledBy", got.culledBy != expected.culledBy, static_cast<double>(got.culledBy),
            static_cast<double>(expected.culledBy));
      checkArea("area beyond", got.beyondArea, expected.beyondArea);
      checkArea("exposed area", got.exposedArea, expected.exposedArea);
      checkArea("covered area", got.coveredArea, expected.coveredArea);
      check("depth", differsAsRatio(got.depth, expected.depth), got.depth, expected.depth);
      const auto checkRatio = [&](const char* name, double a, double b) { check(name, differsAsRatio(a, b), a, b); };
      checkRatio("threshold ratio", got.ratios.threshold, expected.ratios.threshold);
      if (areAllFirm) {
        checkRatio("floor ratio", got.ratios.floor, expected.ratios.floor);
        // A depth is measured, and may be next to nothing: it is what the ratio divides by.
        check("depth ratio", differsAsRatio(1 / got.ratios.depth, 1 / expected.ratios.depth), got.ratios.depth,
              expected.ratios.depth);
        checkRatio("hole ratio", got.ratios.hole, expected.ratios.hole);
      }
    }
    if (differing.empty()) continue;
    ++found.stats;
    report("segment %zu:%s", s, differing.c_str());
  }
  return found;
}

}  // namespace cagecast::reference
