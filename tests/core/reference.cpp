#include "reference.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <functional>
#include <limits>
#include <numbers>

#include "reference_scene.hpp"

namespace cagecast::reference {
namespace {

// Tolerances of the method, as shares of the diagonal of the target's bounding box.
constexpr double kSelfHitStart = 1e-5;  // A self hit nearer than this is the surface the point lies on.
constexpr double kCageHitStart = -1e-5; // A point this far outside the cage still counts as covered by it.

// To how many sides a ray is turned: a ray that touches a corner hits it from a narrow wedge of them only.
constexpr int kNudges = 16;

// Sums of areas that differ by less than this share may differ only by the order of adding.
constexpr double kSumNoise = 1e-12;

/// Everything that could be true of one yes-or-no question: what is, and what might be if rays were turned a little.
struct Verdict {
  bool is = false, might = false, must = false;
};

// ------------------------------------------------------------------------------------------- 2, 3 Ray tests, 2', 3' too

/// A point's ray, with the triangles worth testing it against.
struct Sight {
  Ray ray;
  std::vector<const Triangle*> target, cage;
  bool pokesThrough = false;  // Step 3': it may do without a cage hit.
};

/// @param own  Whether a triangle (by its number among the usable ones) is the point's own, which its ray leaves.
template <typename Own>
Sight look(const Scene& scene, const Options& options, Vec p, const Place& place, Own own) {
  Sight sight;
  sight.ray = {p, place.triangle->normal};
  const double behind = -2 * kCageHitStart * scene.diag;
  for (const Triangle* t : scene.target.along(sight.ray, behind))
    if (!own(static_cast<std::size_t>(t - scene.target.triangles().data()))) sight.target.push_back(t);
  sight.cage = scene.cage.along(sight.ray, behind);
  sight.pokesThrough = options.pokes && place.nearest.distance <= options.pokeThrough * scene.diag &&
                       dot(p - place.position(), place.triangle->normal) > 0 && loopAt(scene, place) < 0;
  return sight;
}

/// How far along the ray the cage is; infinity if the ray does not come to it.
double cageDistance(const Scene& scene, const Sight& sight, const Ray& ray, const Place& place) {
  const double height = planeDistance(*place.triangle, ray.origin);
  if (place.inside() && height <= 0) return -height;
  double least = kInfinity;
  for (const Triangle* triangle : sight.cage) {
    const double t = hit(ray, *triangle);
    if (t > kCageHitStart * scene.diag) least = std::min(least, t);
  }
  return least == kInfinity ? least : std::max(0.0, least);
}

/// Steps 2 and 3 for one ray.
Zone zoneOf(const Scene& scene, const Options& options, const Sight& sight, const Ray& ray, const Place& place) {
  const double cage = cageDistance(scene, sight, ray, place);
  const double end = options.endOfSelfRay ? cage + options.occlusionReach * scene.diag : kInfinity;
  const bool occluded = std::any_of(sight.target.begin(), sight.target.end(), [&](const Triangle* triangle) {
    const double t = hit(ray, *triangle);
    return t > kSelfHitStart * scene.diag && t <= end;
  });
  if (occluded) return Zone::occluded;
  return cage < kInfinity || sight.pokesThrough ? Zone::cosmetic : Zone::uncovered;
}

unsigned bit(Zone zone) { return 1u << static_cast<unsigned>(zone); }
bool single(unsigned zones) { return (zones & (zones - 1)) == 0; }

/// The rays beside a ray.
std::vector<Ray> nudged(const Ray& ray) {
  std::vector<Ray> rays;
  const Vec n = ray.direction;
  const Vec u = unit(cross(n, std::abs(n.x) < 0.9 ? Vec{1, 0, 0} : Vec{0, 1, 0}));
  const Vec v = cross(n, u);
  for (int k = 0; k < kNudges; ++k) {
    const double angle = 2 * std::numbers::pi * k / kNudges;
    rays.push_back({ray.origin, n + (u * std::cos(angle) + v * std::sin(angle)) * kRayNudge});
  }
  return rays;
}

/// What steps 2 and 3 say of a place on the target: the zone, and (as bits) those it might be if the ray were turned.
struct Finding {
  Zone zone = Zone::cosmetic;
  unsigned nearby = bit(Zone::cosmetic);
};

Finding judge(const Scene& scene, const Options& options, const Sight& sight, const Place& place) {
  Finding finding;
  finding.zone = zoneOf(scene, options, sight, sight.ray, place);
  finding.nearby = bit(finding.zone);
  if (options.stability)
    for (const Ray& ray : nudged(sight.ray)) finding.nearby |= bit(zoneOf(scene, options, sight, ray, place));
  return finding;
}

// ---------------------------------------------------------------------------------------------------------- 4 Segments

/// The segment of each point, numbered by the first point. Points and vertices come in the same order.
std::vector<std::uint32_t> findSegments(const Scene& scene, std::uint32_t& count) {
  Sets sets(scene.points.count());
  for (const auto& [a, b, c] : scene.corners) {
    sets.join(a, b);
    sets.join(b, c);
  }
  std::vector<std::uint32_t> segments(scene.points.count());
  count = 0;
  for (std::uint32_t p = 0; p < segments.size(); ++p) {
    const std::uint32_t first = sets.find(p);
    segments[p] = first == p ? count++ : segments[first];
  }
  return segments;
}

/// Everything that is known of the points, and of their segments.
struct State {
  std::vector<Place> places;
  std::vector<Finding> findings;
  std::vector<double> areas;  // A third of each triangle.
  std::vector<std::uint32_t> segments;
  std::vector<std::int32_t> loops;  // The open loop of the cage that the place is on, or -1.
  std::uint32_t segmentCount = 0;
  std::vector<Verdict> passes;  // Per segment.
};

// ------------------------------------------------------------------------------------------------------ 4', 5 Threshold

/// A share of a segment's area, and what is found there.
struct Voter {
  std::uint32_t segment;
  double area;
  Finding finding;
};

/// Step 4': whether the triangles of each segment may vote from within: if it is small, and near a hole.
std::vector<bool> mayVoteFromWithin(const Scene& scene, const State& state) {
  constexpr std::uint32_t kFewPoints = 32;
  constexpr double kNear = 0.01;
  std::vector<Box> boxes(state.segmentCount);
  std::vector<std::uint32_t> points(state.segmentCount, 0);
  for (std::size_t p = 0; p < state.segments.size(); ++p) {
    boxes[state.segments[p]].add(scene.points.positions[p]);
    ++points[state.segments[p]];
  }
  std::vector<bool> result;
  for (std::uint32_t s = 0; s < state.segmentCount; ++s)
    result.push_back(points[s] < kFewPoints &&
                     std::any_of(scene.rims.loops.begin(), scene.rims.loops.end(),
                                 [&](const Loop& loop) { return boxes[s].meets(loop.box, kNear * scene.diag); }));
  return result;
}

/// Who votes over the segments: the points, for a third of each of their triangles; with step 4' the big triangles of
/// some segments from the centroids of their four quarters instead.
std::vector<Voter> findVoters(const Scene& scene, const Options& options, const State& state) {
  constexpr double kBigTriangle = 0.06;
  std::vector<Voter> voters;
  for (std::size_t p = 0; p < state.segments.size(); ++p) voters.push_back({state.segments[p], 0, state.findings[p]});
  const std::vector<bool> within = options.votes ? mayVoteFromWithin(scene, state) : std::vector<bool>(state.segmentCount);
  for (std::size_t t = 0; t < scene.corners.size(); ++t) {
    const Triangle& triangle = scene.target.triangles()[t];
    const auto& [a, b, c] = triangle.corners;
    const std::uint32_t segment = state.segments[scene.corners[t][0]];
    const double longest = std::max({length(b - a), length(c - b), length(a - c)});
    if (!within[segment] || longest < kBigTriangle * scene.diag) {
      for (const std::uint32_t p : scene.corners[t]) voters[p].area += triangle.area / 3;
      continue;
    }
    for (const Vec& centroid : {(a * 4 + b + c) * (1.0 / 6), (b * 4 + a + c) * (1.0 / 6), (c * 4 + a + b) * (1.0 / 6),
                                (a + b + c) * (1.0 / 3)}) {
      const Place place = project(scene, centroid);
      const Sight sight = look(scene, options, centroid, place, [&](std::size_t other) { return other == t; });
      voters.push_back({segment, triangle.area / 4, judge(scene, options, sight, place)});
    }
  }
  return voters;
}

/// A sum whose terms are not all certain.
struct Range {
  double is = 0, least = 0, most = 0;
};

/// Step 5: whether each segment passes, and could have passed, given what its voters might have found.
void decide(const Options& options, const std::vector<Voter>& voters, State& state, std::vector<SegmentStats>& stats) {
  std::vector<Range> covered(state.segmentCount), margins(state.segmentCount);  // C, and C - threshold * E.
  std::vector<bool> unsure(state.segmentCount, false);
  for (const Voter& voter : voters) {
    SegmentStats& segment = stats[voter.segment];
    if (voter.finding.zone != Zone::occluded) segment.exposedArea += voter.area;
    if (voter.finding.zone == Zone::cosmetic) segment.coveredArea += voter.area;
    double low = kInfinity, high = -kInfinity;
    const auto might = [&](Zone zone, double value) {
      if ((voter.finding.nearby & bit(zone)) == 0) return;
      low = std::min(low, value);
      high = std::max(high, value);
    };
    might(Zone::occluded, 0);
    might(Zone::uncovered, -options.threshold * voter.area);
    might(Zone::cosmetic, (1 - options.threshold) * voter.area);
    margins[voter.segment].least += low;
    margins[voter.segment].most += high;
    if ((voter.finding.nearby & bit(Zone::cosmetic)) != 0) covered[voter.segment].most += voter.area;
    if (voter.finding.nearby == bit(Zone::cosmetic)) covered[voter.segment].least += voter.area;
    if (!single(voter.finding.nearby)) unsure[voter.segment] = true;
  }
  state.passes.resize(state.segmentCount);
  for (std::uint32_t s = 0; s < state.segmentCount; ++s) {
    const double area = stats[s].area, floor = options.minCovered * area;
    covered[s].is = stats[s].coveredArea;
    // With a threshold of 0 or 1 a tie is a sum compared with nothing or with itself: exact, whatever the order.
    const bool exact = options.threshold == 0 || options.threshold == 1;
    const double noise = kSumNoise * area, sumNoise = exact ? 0 : noise;
    const auto aboveFloor = [&](double c, double slack) { return !options.floor || (c >= floor + slack && c > 0); };
    Verdict& pass = state.passes[s];
    pass.is = !(covered[s].is < options.threshold * stats[s].exposedArea) && aboveFloor(covered[s].is, 0);
    if (!unsure[s]) margins[s].least = margins[s].most = covered[s].is - options.threshold * stats[s].exposedArea;
    const bool nothing = stats[s].exposedArea == 0 && !unsure[s];  // 0 >= 0, without noise.
    pass.might = pass.is || (margins[s].most >= -sumNoise && aboveFloor(covered[s].most, -noise));
    pass.must = pass.is && (nothing || margins[s].least >= sumNoise) && aboveFloor(covered[s].least, noise);
    stats[s].culled = !pass.is;
  }
}

// ------------------------------------------------------------------------------------------------------- 6 Second look

/// Each point's normal: of its triangles, weighted by area, turned so that the segment's mostly agree with the cage. Zero
/// where the triangles cancel out.
/// @param firm  Receives for each segment whether that turn is certain.
std::vector<Vec> pointNormals(const Scene& scene, const State& state, std::vector<bool>& firm) {
  constexpr double kCancelled = 1e-6;  // Of the areas summed up: less than this is nothing.
  std::vector<Vec> normals(scene.points.count());
  std::vector<double> weights(scene.points.count(), 0.0);
  for (std::size_t t = 0; t < scene.corners.size(); ++t) {
    const Triangle& triangle = scene.target.triangles()[t];
    for (const std::uint32_t p : scene.corners[t]) {
      normals[p] = normals[p] + triangle.normal * triangle.area;
      weights[p] += triangle.area;
    }
  }
  std::vector<double> agreement(state.segmentCount, 0.0), most(state.segmentCount, 0.0);
  for (std::size_t p = 0; p < normals.size(); ++p) {
    normals[p] = length(normals[p]) <= kCancelled * weights[p] ? Vec{} : unit(normals[p]);
    agreement[state.segments[p]] += state.areas[p] * dot(normals[p], state.places[p].triangle->normal);
    most[state.segments[p]] += state.areas[p];
  }
  for (std::uint32_t s = 0; s < state.segmentCount; ++s)
    firm.push_back(agreement[s] == 0 || std::abs(agreement[s]) > kSumNoise * most[s]);
  for (std::size_t p = 0; p < normals.size(); ++p)
    if (agreement[state.segments[p]] < 0) normals[p] = normals[p] * -1;
  return normals;
}

/// Whether enough rays from a point, in twelve directions about its normal, come to the cage past the target.
Verdict isSeen(const Scene& scene, const Options& options, Vec p, Vec normal) {
  constexpr int kDirections = 12, kEnough = 2;
  constexpr double kGoldenAngle = 2.399963229728653, kLift = 1e-4;
  if (dot(normal, normal) == 0) return {};
  const Vec t1 = unit(cross(normal, std::abs(normal.x) < 0.9 ? Vec{1, 0, 0} : Vec{0, 1, 0}));
  const Vec t2 = cross(normal, t1);
  int good = 0, might = 0, must = 0;
  for (int k = 0; k < kDirections; ++k) {
    const double z = 1 - (k + 0.5) / kDirections, aside = std::sqrt(1 - z * z);
    const double azimuth = k * kGoldenAngle;
    const Ray ray{p + normal * (kLift * scene.diag),
                  normal * z + (t1 * std::cos(azimuth) + t2 * std::sin(azimuth)) * aside};
    const double behind = -2 * kCageHitStart * scene.diag;
    const auto target = scene.target.along(ray, behind), cage = scene.cage.along(ray, behind);
    const auto isGood = [&](const Ray& turned) {
      const auto hits = [&](const std::vector<const Triangle*>& triangles, double start) {
        return std::any_of(triangles.begin(), triangles.end(),
                           [&](const Triangle* t) { return hit(turned, *t) > start * scene.diag; });
      };
      return !hits(target, kSelfHitStart) && hits(cage, kCageHitStart);
    };
    const bool is = isGood(ray);
    bool any = is, all = is;
    if (options.stability)
      for (const Ray& turned : nudged(ray)) {
        const bool other = isGood(turned);
        any = any || other;
        all = all && other;
      }
    good += is, might += any, must += all;
    if (!options.stability && good >= kEnough) break;
  }
  return {good >= kEnough, might >= kEnough, must >= kEnough};
}

/// Step 6: the occluded points of passing segments that are seen from elsewhere. Begins at the rim of what is occluded; a
/// restored point brings its neighbours in, a rejected one does not.
std::vector<Verdict> secondLook(const Scene& scene, const Options& options, const State& state) {
  const std::size_t count = scene.points.count();
  std::vector<bool> firm;
  const std::vector<Vec> normals = pointNormals(scene, state, firm);
  std::vector<std::vector<std::uint32_t>> neighbours(count);
  for (const auto& corners : scene.corners)
    for (std::size_t c = 0; c < 3; ++c) {
      neighbours[corners[c]].push_back(corners[(c + 1) % 3]);
      neighbours[corners[c]].push_back(corners[(c + 2) % 3]);
    }
  std::vector<Verdict> seen(count), result(count);
  std::vector<bool> known(count, false);
  const auto isSeenFrom = [&](std::uint32_t p) {
    if (!known[p]) seen[p] = isSeen(scene, options, scene.points.positions[p], normals[p]);
    known[p] = true;
    if (!firm[state.segments[p]]) seen[p].might = true, seen[p].must = false;
    return seen[p];
  };
  // Once as it is, and once each as it might and as it must be.
  const auto spread = [&](bool Verdict::*how, auto isOccluded, auto isOpen) {
    std::vector<std::uint32_t> open;
    for (std::uint32_t p = 0; p < count; ++p)
      if (isOpen(state.findings[p])) open.push_back(p);
    while (!open.empty()) {
      const std::uint32_t from = open.back();
      open.pop_back();
      for (const std::uint32_t p : neighbours[from]) {
        if (!isOccluded(state.findings[p]) || result[p].*how || !(state.passes[state.segments[p]].*how)) continue;
        if (!(isSeenFrom(p).*how)) continue;
        result[p].*how = true;
        open.push_back(p);
      }
    }
  };
  const auto isOccluded = [](const Finding& f) { return f.zone == Zone::occluded; };
  const auto mightBeOccluded = [](const Finding& f) { return (f.nearby & bit(Zone::occluded)) != 0; };
  const auto mightBeOpen = [](const Finding& f) { return (f.nearby & ~bit(Zone::occluded)) != 0; };
  spread(&Verdict::is, isOccluded, std::not_fn(isOccluded));
  spread(&Verdict::might, mightBeOccluded, mightBeOpen);
  spread(&Verdict::must, mightBeOccluded, std::not_fn(mightBeOccluded));
  return result;
}

// ------------------------------------------------------------------------------------------------------------- 7 Holes

/// Step 7: the uncovered points whose hole is not meant for them: those that lie under the cage, hardly beside it, or
/// beside a hole that something else explains.
std::vector<Verdict> underHoles(const Scene& scene, const State& state) {
  constexpr double kOverhang = 0.005, kOverhangOfLoop = 0.05, kExplainedOverhang = 0.03, kExplaining = 0.02;
  constexpr double kUnsure = 1e-7;  // An overhang this near to its limit may as well be on its other side.
  const std::size_t loopCount = scene.rims.loops.size();
  std::vector<Range> failing(loopCount), uncovered(loopCount);
  for (std::size_t p = 0; p < state.loops.size(); ++p) {
    if (state.loops[p] < 0) continue;
    const auto loop = static_cast<std::size_t>(state.loops[p]);
    const Verdict& pass = state.passes[state.segments[p]];
    const Finding& finding = state.findings[p];
    const double area = state.areas[p];
    if (!pass.is && finding.zone != Zone::occluded) failing[loop].is += area;
    if (!pass.might && (finding.nearby & bit(Zone::occluded)) == 0) failing[loop].least += area;
    if (!pass.must && (finding.nearby & ~bit(Zone::occluded)) != 0) failing[loop].most += area;
    if (pass.is && finding.zone == Zone::uncovered) uncovered[loop].is += area;
    if (pass.must && finding.nearby == bit(Zone::uncovered)) uncovered[loop].least += area;
    if (pass.might && (finding.nearby & bit(Zone::uncovered)) != 0) uncovered[loop].most += area;
  }
  std::vector<Verdict> explained;
  for (std::size_t l = 0; l < loopCount; ++l) {
    const auto explains = [](double some, double all) { return some > 0 && some >= kExplaining * all; };
    explained.push_back({explains(failing[l].is, uncovered[l].is),
                         explains(failing[l].most, uncovered[l].least * (1 - kSumNoise)),
                         explains(failing[l].least, uncovered[l].most * (1 + kSumNoise))});
  }
  std::vector<Verdict> result;
  for (std::size_t p = 0; p < state.loops.size(); ++p) {
    if (state.loops[p] < 0) {
      result.push_back({true, true, true});
      continue;
    }
    const auto loop = static_cast<std::size_t>(state.loops[p]);
    const Vec n = state.places[p].triangle->normal, offset = scene.points.positions[p] - state.places[p].position();
    const double overhang = length(offset - n * dot(offset, n));
    const double little = std::min(kOverhang * scene.diag, kOverhangOfLoop * scene.rims.loops[loop].box.diagonal());
    const auto allowed = [&](double h, bool isExplained) {
      return h <= little || (isExplained && h <= kExplainedOverhang * scene.diag);
    };
    const double unsure = kUnsure * scene.diag;
    result.push_back({allowed(overhang, explained[loop].is), allowed(overhang - unsure, explained[loop].might),
                      allowed(overhang + unsure, explained[loop].must)});
  }
  return result;
}

/// The zones (as bits) that a point might end up in, given one of those it might have been found in.
unsigned outcomes(Zone found, const Verdict& passes, const Verdict& seen, const Verdict& underHole) {
  unsigned zones = 0;
  if (!passes.must) zones |= bit(found == Zone::cosmetic ? Zone::culled : found);
  if (!passes.might) return zones;
  const Verdict always{true, true, true};
  const Verdict& restored = found == Zone::occluded ? seen : found == Zone::uncovered ? underHole : always;
  if (restored.might) zones |= bit(Zone::cosmetic);
  if (!restored.must) zones |= bit(found);
  return zones;
}

// --------------------------------------------------------------------------------------------------------- The baseline

/// The classical baseline: the nearest vertex of the cage, the lowest of equally near ones; nothing is filtered. A vertex
/// of no triangle, or only of degenerate ones, is not part of the cage; of the triangles at a vertex the first stands
/// for it.
void nearestVertex(const MeshView& cage, const Scene& scene, Result& result) {
  constexpr std::uint32_t kNone = std::numeric_limits<std::uint32_t>::max();
  std::vector<std::uint32_t> triangleAt(cage.positions.size() / 3, kNone);
  for (const Triangle& triangle : scene.cage.triangles())
    for (std::size_t c = 0; c < 3; ++c) {
      std::uint32_t& first = triangleAt[cage.indices[std::size_t{triangle.index} * 3 + c]];
      first = std::min(first, triangle.index);
    }
  for (std::size_t v = 0; v < result.zones.size(); ++v) {
    const Vec p = scene.points.positions[scene.points.ofVertex[v]];
    std::uint32_t best = kNone;
    double least = kInfinity;
    for (std::uint32_t w = 0; w < triangleAt.size(); ++w) {
      const Vec offset = p - vertex(cage, w);
      if (triangleAt[w] != kNone && dot(offset, offset) < least) least = dot(offset, offset), best = w;
    }
    result.triangles[v] = triangleAt[best];
    result.distances[v] = static_cast<float>(std::sqrt(least));
    for (std::size_t k = 0; k < 2; ++k) result.uvs[v * 2 + k] = cage.uvs[std::size_t{best} * 2 + k];
  }
}

}  // namespace

Options Options::paper() { return {}; }

Options Options::standard() {
  Options options;
  options.endOfSelfRay = options.pokes = options.votes = options.floor = true;
  options.secondLook = options.holes = options.partialTriangles = options.seams = true;
  return options;
}

Result transfer(const MeshView& cage, const MeshView& target, const Options& options) {
  const Scene scene = makeScene(cage, target, options);
  const std::size_t pointCount = scene.points.count(), vertexCount = target.positions.size() / 3;
  const bool filtered = options.projection == ProjectionMode::nearestPoint;

  State state;
  state.places.resize(pointCount);
  state.findings.resize(pointCount);
  state.loops.assign(pointCount, -1);
  for (std::uint32_t p = 0; filtered && p < pointCount; ++p) {
    const Vec position = scene.points.positions[p];
    state.places[p] = project(scene, position);
    const Sight sight = look(scene, options, position, state.places[p], [&](std::size_t t) {
      return std::find(scene.corners[t].begin(), scene.corners[t].end(), p) != scene.corners[t].end();
    });
    state.findings[p] = judge(scene, options, sight, state.places[p]);
    state.loops[p] = loopAt(scene, state.places[p]);
  }

  Result result;
  state.segments = findSegments(scene, state.segmentCount);
  state.areas.assign(pointCount, 0.0);
  for (std::size_t t = 0; t < scene.corners.size(); ++t)
    for (const std::uint32_t p : scene.corners[t]) state.areas[p] += scene.target.triangles()[t].area / 3;
  result.segmentStats.resize(state.segmentCount);
  result.firmAreas.assign(state.segmentCount, 1);
  for (std::size_t p = 0; p < pointCount; ++p) {
    ++result.segmentStats[state.segments[p]].points;
    result.segmentStats[state.segments[p]].area += state.areas[p];
  }
  if (filtered) {
    const std::vector<Voter> voters = findVoters(scene, options, state);
    for (const Voter& voter : voters)
      if (!single(voter.finding.nearby)) result.firmAreas[voter.segment] = 0;
    decide(options, voters, state, result.segmentStats);
  } else {
    state.passes.assign(state.segmentCount, {true, true, true});
    for (SegmentStats& stats : result.segmentStats) stats.exposedArea = stats.coveredArea = stats.area;
  }
  std::vector<Verdict> seen(pointCount), underHole(pointCount);
  if (filtered && options.secondLook) seen = secondLook(scene, options, state);
  if (filtered && options.holes) underHole = underHoles(scene, state);

  result.uvs.resize(vertexCount * 2);
  result.triangles.resize(vertexCount);
  result.distances.resize(vertexCount);
  for (std::uint32_t v = 0; v < vertexCount; ++v) {
    const std::uint32_t p = scene.points.ofVertex[v], segment = state.segments[p];
    const Finding& finding = state.findings[p];
    Zone zone = finding.zone;
    if (!state.passes[segment].is) {
      if (zone == Zone::cosmetic) zone = Zone::culled;
    } else if ((zone == Zone::occluded && seen[p].is) || (zone == Zone::uncovered && underHole[p].is)) {
      zone = Zone::cosmetic;
    }
    unsigned ends = 0;
    for (const Zone found : {Zone::cosmetic, Zone::occluded, Zone::uncovered})
      if ((finding.nearby & bit(found)) != 0) ends |= outcomes(found, state.passes[segment], seen[p], underHole[p]);
    result.zones.push_back(zone);
    result.segments.push_back(segment);
    result.stable.push_back(!options.stability || ends == bit(zone) ? 1 : 0);
    if (!filtered) continue;
    result.triangles[v] = state.places[p].triangle->index;
    result.distances[v] = static_cast<float>(state.places[p].nearest.distance);
    const auto uv = uvAt(cage, state.places[p]);
    for (std::size_t k = 0; k < 2; ++k) result.uvs[v * 2 + k] = static_cast<float>(uv[k]);
  }
  if (!filtered) nearestVertex(cage, scene, result);

  // Step 8: the depth buffer hides what is occluded of a triangle.
  for (std::size_t t = 0; t < target.indices.size(); t += 3) {
    std::array<int, 4> corners{};
    for (std::size_t c = 0; c < 3; ++c) ++corners[static_cast<std::size_t>(result.zones[target.indices[t + c]])];
    const auto [cosmetic, occluded, uncovered, culled] = corners;
    const bool painted = options.partialTriangles ? cosmetic > 0 && uncovered == 0 && culled == 0 : cosmetic == 3;
    result.cosmeticTriangles.push_back(painted ? 1 : 0);
  }
  if (filtered && options.seams)
    result.cornerUvs = cornerUvs(cage, target, scene, state.places, result.uvs, result.stableCorners);
  return result;
}

Result transfer(const MeshView& cage, const MeshView& target, const TransferOptions& library) {
  Options options = Options::paper();
  options.projection = library.projection;
  options.threshold = static_cast<double>(library.threshold);
  options.weldTolerance = static_cast<double>(library.weldTolerance);
  options.endOfSelfRay = std::isfinite(library.occlusionReach);
  options.occlusionReach = static_cast<double>(library.occlusionReach);
  options.pokes = library.pokeThrough > 0;
  options.pokeThrough = static_cast<double>(library.pokeThrough);
  options.votes = library.votes;
  options.floor = library.minCovered > 0;
  options.minCovered = static_cast<double>(library.minCovered);
  options.secondLook = library.secondLook;
  options.holes = library.holes;
  options.partialTriangles = library.partialTriangles;
  options.seams = library.seams == Seams::corner;
  return transfer(cage, target, options);
}

}  // namespace cagecast::reference
