#include "reference/reference.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <functional>
#include <limits>
#include <map>
#include <memory>
#include <numbers>
#include <numeric>
#include <optional>
#include <set>
#include <tuple>

#include "reference/scene.hpp"

namespace cagecast::reference {
namespace {

// Tolerances of the method, as shares of the diagonal of the target's bounding box.
constexpr double kSelfHitStart = 1e-5;   // A self hit nearer than this is the surface the point lies on.
constexpr double kCageHitStart = -1e-5;  // A point this far outside the cage still counts as covered by it.

// To how many sides a ray is turned: a ray that touches a corner hits it from a narrow wedge of them only.
constexpr int kNudges = 16;

// How far a ray that is turned is moved as well: a point on an edge of the cage is on either side of it.
constexpr double kAside = 1e-7;

// Some rays are turned and moved by this share of both only, which is still far more than rounding: the others would
// pass a very narrow triangle by.
constexpr double kSmallShare = 1e-5;

// Distances of the library are floats.
constexpr double kDepthNoise = 1e-6;

// Sums of areas that differ by less than this share may differ only by the order of adding.
constexpr double kSumNoise = 1e-12;

/// The possible answers to a question: with the rays as they are, and with rays turned a little.
struct Verdict {
  bool is = false, might = false, must = false;
};
constexpr Verdict kSurely{true, true, true};

Verdict operator&&(const Verdict& a, const Verdict& b) { return {a.is && b.is, a.might && b.might, a.must && b.must}; }
Verdict operator!(const Verdict& a) { return {!a.is, !a.must, !a.might}; }
Verdict operator||(const Verdict& a, const Verdict& b) { return {a.is || b.is, a.might || b.might, a.must || b.must}; }

// -------------------- 4 Segments

/// The segment of each point, numbered by the first point. Points and vertices come in the same order.
using Segments = std::vector<std::uint32_t>;
Segments findSegments(const Scene& scene, std::uint32_t& count) {
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

/// The segment of a triangle of the target.
std::uint32_t segmentOf(const Scene& scene, const Segments& segments, const Triangle& triangle) {
  return segments[scene.corners[static_cast<std::size_t>(&triangle - scene.target.triangles().data())][0]];
}

// -------------------- 2, 3, 6 Rays

/// A point's ray, with the triangles worth testing it against.
struct Sight {
  Ray ray;
  std::vector<const Triangle*> target, cage;
  bool pokesThrough = false;  // Step 6: it may do without a cage hit.
};

/// @param own  Whether a triangle (by its number among the usable ones) is the point's own, which its ray leaves.
template <typename Own>
Sight look(const Scene& scene, const Options& options, Vec p, const ClosestPoint& place, Own own) {
  Sight sight;
  sight.ray = {p, place.triangle->normal};
  const double behind = -2 * kCageHitStart * scene.diag;
  for (const Triangle* t : scene.target.along(sight.ray, behind))
    if (!own(static_cast<std::size_t>(t - scene.target.triangles().data()))) sight.target.push_back(t);
  sight.cage = scene.cage.along(sight.ray, behind);
  sight.pokesThrough = options.pokeThrough > 0 &&
                       place.nearest.distance <= static_cast<double>(options.pokeThrough) * scene.diag &&
                       dot(p - place.position(), place.triangle->normal) > 0 && loopAt(scene, place) < 0;
  return sight;
}

/// How far along the ray the cage is; infinity if the ray does not come to it.
double cageDistance(const Scene& scene, const Sight& sight, const Ray& ray, const ClosestPoint& place) {
  const double height = planeDistance(*place.triangle, ray.origin);
  // A ray that was moved aside may start beyond an edge.
  const bool isMoved = &ray != &sight.ray;
  if (place.inside() && height <= 0 && !isMoved) return -height;
  double least = kInfinity;
  for (const Triangle* triangle : sight.cage) {
    const double t = hit(ray, *triangle);
    if (t > kCageHitStart * scene.diag) least = std::min(least, t);
  }
  return least == kInfinity ? least : std::max(0.0, least);
}

/// What one ray tells.
struct Outcome {
  Zone zone = Zone::cosmetic;
  bool isUnderCage = false;
  std::set<std::uint32_t> hiders;  // The segments that it hits, within reach.
  bool operator==(const Outcome&) const = default;
};

/// Steps 2 and 3 for one ray.
Outcome outcomeOf(const Scene& scene, const Segments& segments, const Options& options, const Sight& sight,
                  const Ray& ray, const ClosestPoint& place) {
  const double cage = cageDistance(scene, sight, ray, place);
  const auto reach = static_cast<double>(options.occlusionReach);
  const double end = std::isfinite(reach) ? cage + reach * scene.diag : kInfinity;
  std::set<std::uint32_t> hiders;
  for (const Triangle* triangle : sight.target) {
    const double t = hit(ray, *triangle);
    if (t > kSelfHitStart * scene.diag && t <= end) hiders.insert(segmentOf(scene, segments, *triangle));
  }
  if (!hiders.empty()) return {Zone::occluded, cage < kInfinity, hiders};
  return {cage < kInfinity || sight.pokesThrough ? Zone::cosmetic : Zone::uncovered, cage < kInfinity, {}};
}

unsigned bit(Zone zone) { return 1u << static_cast<unsigned>(zone); }
bool single(unsigned zones) { return (zones & (zones - 1)) == 0; }

/// The rays beside a ray, sixteen of them farther away than the other four.
std::vector<Ray> nudged(const Scene& scene, const Ray& ray) {
  std::vector<Ray> rays;
  const Vec n = ray.direction;
  const Vec u = unit(cross(n, std::abs(n.x) < 0.9 ? Vec{1, 0, 0} : Vec{0, 1, 0}));
  const Vec v = cross(n, u);
  const auto turn = [&](double share, int sides) {
    for (int k = 0; k < sides; ++k) {
      const double angle = 2 * std::numbers::pi * k / sides;
      const Vec side = (u * std::cos(angle) + v * std::sin(angle)) * share;
      rays.push_back({ray.origin + side * (kAside * scene.diag), n + side * kRayNudge});
    }
  };
  turn(1, kNudges);
  turn(kSmallShare, kNudges / 4);
  return rays;
}

/// What steps 2 and 3 say of a place on the target: the zone, and (as bits) those it might be if the ray were turned.
struct Finding {
  Zone zone = Zone::cosmetic;
  unsigned nearby = bit(Zone::cosmetic);
  Verdict hidden;  // With a finite reach: the target occludes it, and the cage is not over it either.
  std::vector<Outcome> outcomes{Outcome{}};  // What is, and then what might be if the ray were turned.
};

Finding judge(const Scene& scene, const Segments& segments, const Options& options, const Sight& sight,
              const ClosestPoint& place) {
  Finding finding;
  std::vector<Outcome>& outcomes = finding.outcomes;
  outcomes = {outcomeOf(scene, segments, options, sight, sight.ray, place)};
  if (options.findsStability)
    for (const Ray& ray : nudged(scene, sight.ray)) {
      const Outcome beside = outcomeOf(scene, segments, options, sight, ray, place);
      if (std::find(outcomes.begin(), outcomes.end(), beside) == outcomes.end()) outcomes.push_back(beside);
    }
  finding.zone = outcomes[0].zone;
  finding.nearby = 0;
  finding.hidden = {false, false, true};
  for (const Outcome& outcome : outcomes) {
    finding.nearby |= bit(outcome.zone);
    const bool isHidden =
        outcome.zone == Zone::occluded && !outcome.isUnderCage && std::isfinite(options.occlusionReach);
    if (&outcome == &outcomes[0]) finding.hidden.is = isHidden;
    finding.hidden.might = finding.hidden.might || isHidden;
    finding.hidden.must = finding.hidden.must && isHidden;
  }
  return finding;
}

/// A sum whose terms are not all certain.
struct Range {
  double is = 0, least = 0, most = 0;
};

/// Everything that is known of the points, and of their segments.
struct State {
  std::vector<ClosestPoint> places;
  std::vector<Finding> findings;
  std::vector<double> areas;  // A third of each triangle.
  std::vector<std::uint32_t> segments;
  std::vector<std::int32_t> loops;  // The open loop of the cage that the place is on, or -1.
  std::uint32_t segmentCount = 0;
  std::vector<Verdict> passes;   // Per segment.
  std::vector<Verdict> covered;  // Per segment: whether any of it is.
  std::vector<Verdict> outer;    // Per loop: whether it is an outer border of the cage.
  std::vector<Verdict> beyond;   // Per point: whether it lies beyond one.
  Range deepest;                 // How deep, in diagonals, what is to be painted may lie.
  std::vector<Verdict> inPose;   // Per point: whether it is occluded at rest and seen in a pose,
  std::vector<Verdict> bare;     // or nothing at all lies over it there.
};

/// Whether a point is surely or perhaps so, given whether each of its outcomes is.
template <typename IsSo>
Verdict overOutcomes(const Finding& finding, IsSo isSo) {
  Verdict result{isSo(finding.outcomes[0]), false, true};
  for (const Outcome& outcome : finding.outcomes) {
    result.might = result.might || isSo(outcome);
    result.must = result.must && isSo(outcome);
  }
  return result;
}

// -------------------- 10 Outer borders

/// An overhang this near to its limit, in diagonals, may as well be on its other side.
constexpr double kUnsureOverhang = 1e-7;

/// How far a point lies sideways from its place on the cage, against what hardly counts at the loop there.
struct Overhang {
  double is, slight;
  Overhang(const Scene& scene, Vec p, const ClosestPoint& place, std::int32_t loop) {
    constexpr double kOverhang = 0.005, kOverhangOfLoop = 0.05;
    const Vec n = place.triangle->normal, offset = p - place.position();
    is = length(offset - n * dot(offset, n));
    const Box& box = scene.loops.loops[static_cast<std::size_t>(loop)].box;
    slight = std::min(kOverhang * scene.diag, kOverhangOfLoop * box.diagonal());
  }
};

/// Whether a place on the target lies sideways from an outer border.
Verdict isBesideBorder(const Scene& scene, const State& state, Vec p, const ClosestPoint& place, std::int32_t loop) {
  if (loop < 0) return {};
  const Overhang overhang(scene, p, place, loop);
  const double unsure = kUnsureOverhang * scene.diag;
  return state.outer[static_cast<std::size_t>(loop)] &&
         Verdict{overhang.is > overhang.slight, overhang.is + unsure > overhang.slight,
                 overhang.is - unsure > overhang.slight};
}

/// Finds the loops that have much of the target on their outer side, past the cage.
void findOuterBorders(const Scene& scene, State& state) {
  constexpr double kMuch = 3, kUnsureSide = 1e-9;
  struct Plane {
    Vec centre, area;
    double perimeter = 0;
  };
  std::vector<Plane> planes(scene.loops.loops.size());
  const auto eachEdge = [&](auto call) {
    for (std::size_t t = 0; t < scene.loops.loopOfEdge.size(); ++t)
      for (std::size_t k = 0; k < 3; ++k) {
        const std::int32_t loop = scene.loops.loopOfEdge[t][k];
        const auto& corners = scene.cage.triangles()[t].corners;
        if (loop >= 0) call(planes[static_cast<std::size_t>(loop)], corners[k], corners[(k + 1) % 3]);
      }
  };
  eachEdge([](Plane& plane, Vec a, Vec b) {
    plane.centre = plane.centre + (a + b) * (length(b - a) / 2);
    plane.perimeter += length(b - a);
  });
  for (Plane& plane : planes) plane.centre = plane.centre * (1 / plane.perimeter);
  eachEdge(
      [](Plane& plane, Vec a, Vec b) { plane.area = plane.area - cross(a - plane.centre, b - plane.centre) * 0.5; });
  std::vector<Range> beyond(planes.size());
  for (std::size_t p = 0; p < state.loops.size(); ++p) {
    if (state.loops[p] < 0) continue;
    const auto loop = static_cast<std::size_t>(state.loops[p]);
    const double side = dot(scene.points.positions[p] - planes[loop].centre, planes[loop].area);
    const double unsure = kUnsureSide * scene.diag * length(planes[loop].area);
    const Verdict isOut = overOutcomes(state.findings[p], [](const Outcome& o) { return !o.isUnderCage; }) &&
                          Verdict{side > 0, side > -unsure, side > unsure};
    beyond[loop].is += isOut.is ? state.areas[p] : 0;
    beyond[loop].least += isOut.must ? state.areas[p] : 0;
    beyond[loop].most += isOut.might ? state.areas[p] : 0;
  }
  for (std::size_t l = 0; l < planes.size(); ++l) {
    const double much = kMuch * length(planes[l].area);
    state.outer.push_back(
        {beyond[l].is > much, beyond[l].most > much * (1 - kSumNoise), beyond[l].least > much * (1 + kSumNoise)});
  }
}

/// Finds what lies beyond the outer borders of the cage: beside them, and what is joined to that outside the cage.
void findBeyond(const Scene& scene, State& state) {
  const std::size_t count = scene.points.count();
  std::vector<Verdict> beside, isOut;
  for (std::size_t p = 0; p < count; ++p) {
    beside.push_back(isBesideBorder(scene, state, scene.points.positions[p], state.places[p], state.loops[p]));
    const Verdict misses =
        overOutcomes(state.findings[p], [](const Outcome& o) { return !o.isUnderCage && o.zone != Zone::cosmetic; });
    isOut.push_back(state.loops[p] < 0 ? misses : beside[p]);
  }
  Verdict isAny;  // Whether the cage has any outer border.
  for (const Verdict& outer : state.outer) isAny = isAny || outer;
  for (const auto how : {&Verdict::is, &Verdict::might, &Verdict::must}) {
    Sets sets(count);
    for (const auto& corners : scene.corners)
      for (std::size_t c = 0; c < 3; ++c)
        if (isOut[corners[c]].*how && isOut[corners[(c + 1) % 3]].*how) sets.join(corners[c], corners[(c + 1) % 3]);
    // Nothing else is joined to it, or any of it is beside a border.
    std::vector<bool> isBeyond(count, isAny.*how);
    for (const auto& corners : scene.corners)
      if (std::any_of(corners.begin(), corners.end(), [&](std::uint32_t p) { return !(isOut[p].*how); }))
        for (const std::uint32_t p : corners) isBeyond[sets.find(p)] = false;
    for (std::uint32_t p = 0; p < count; ++p)
      if (beside[p].*how) isBeyond[sets.find(p)] = true;
    for (std::uint32_t p = 0; p < count; ++p) state.beyond[p].*how = isOut[p].*how && isBeyond[sets.find(p)];
  }
  for (std::size_t p = 0; p < count; ++p) {
    Finding& finding = state.findings[p];
    if (!state.beyond[p].might) continue;
    if (state.beyond[p].must) finding.outcomes.clear(), finding.nearby = 0, finding.hidden = {};
    const Outcome beyond{Zone::uncovered, false, {}};
    finding.outcomes.insert(state.beyond[p].is ? finding.outcomes.begin() : finding.outcomes.end(), beyond);
    finding.zone = finding.outcomes[0].zone;
    finding.nearby |= bit(Zone::uncovered);
  }
}

// -------------------- 7 Interior samples

/// A share of a segment's area, and what is found there.
struct Sample {
  std::uint32_t segment;
  double area;
  Finding finding;
  ClosestPoint place;
  Verdict beyond;
};

/// Step 7: whether the triangles of each segment have interior samples: if it is small, and near a hole.
std::vector<bool> haveInteriorSamples(const Scene& scene, const State& state) {
  constexpr std::uint32_t kFewPoints = 32;
  constexpr double kNear = 0.01;
  std::vector<Box> boxes(state.segmentCount);
  std::vector<std::uint32_t> points(state.segmentCount, 0);
  for (std::size_t p = 0; p < state.segments.size(); ++p) {
    // Holes may be as far off as the cage is.
    const double around = state.places[p].nearest.distance;
    for (const double side : {-around, around})
      boxes[state.segments[p]].add(scene.points.positions[p] + Vec{side, side, side});
    ++points[state.segments[p]];
  }
  std::vector<bool> result;
  for (std::uint32_t s = 0; s < state.segmentCount; ++s)
    result.push_back(points[s] < kFewPoints &&
                     std::any_of(scene.loops.loops.begin(), scene.loops.loops.end(),
                                 [&](const Loop& loop) { return boxes[s].meets(loop.box, kNear * scene.diag); }));
  return result;
}

/// The samples that areas are summed over: the points, for a third of each of their triangles; with step 7 the big
/// triangles of some segments count by the centroids of their four quarters instead.
std::vector<Sample> findInteriorSamples(const Scene& scene, const Options& options, const State& state) {
  constexpr double kBigTriangle = 0.06;
  std::vector<Sample> samples;
  for (std::size_t p = 0; p < state.segments.size(); ++p)
    samples.push_back({state.segments[p], 0, state.findings[p], state.places[p], state.beyond[p]});
  std::vector<bool> within(state.segmentCount, false);
  if (options.steps.interiorSamples) within = haveInteriorSamples(scene, state);
  for (std::size_t t = 0; t < scene.corners.size(); ++t) {
    const Triangle& triangle = scene.target.triangles()[t];
    const auto& [a, b, c] = triangle.corners;
    const std::uint32_t segment = state.segments[scene.corners[t][0]];
    const double longest = std::max({length(b - a), length(c - b), length(a - c)});
    if (!within[segment] || longest < kBigTriangle * scene.diag) {
      for (const std::uint32_t p : scene.corners[t]) samples[p].area += triangle.area / 3;
      continue;
    }
    for (const Vec& centroid : {(a * 4 + b + c) * (1.0 / 6), (b * 4 + a + c) * (1.0 / 6), (c * 4 + a + b) * (1.0 / 6),
                                (a + b + c) * (1.0 / 3)}) {
      const ClosestPoint place = project(scene, centroid);
      const Sight sight = look(scene, options, centroid, place, [&](std::size_t other) { return other == t; });
      const Verdict beyond =
          state.outer.empty() ? Verdict{} : isBesideBorder(scene, state, centroid, place, loopAt(scene, place));
      samples.push_back(
          {segment, triangle.area / 4, judge(scene, state.segments, options, sight, place), place, beyond});
    }
  }
  return samples;
}

// -------------------- 5, 8, 10 Rules on segments

/// The sums over a segment's samples that its rules compare, with every sample at what it is, or at its worst, or at
/// its best.
struct Tally {
  double exposed = 0, covered = 0;
};

/// Everything that the rules on a segment compare.
struct Sums {
  Range area;  // That is not beyond an outer border.
  Tally is, worst, best;
  Range covered, depth;  // Of covered samples: area, and area times depth in diagonals.
  Range hole;            // The greatest ratio of what lies in a hole to what may.
};

/// What lies in a hole of each segment, as a share of what may: U + H against a quarter of E + H.
void judgeContents(const State& state, std::vector<Sums>& sums) {
  constexpr double kMaxInHole = 0.25;
  // What of each segment is uncovered at each hole, and what is hidden.
  struct Share {
    Range bare, hidden;
  };
  std::map<std::pair<std::int32_t, std::uint32_t>, Share> shares;
  for (std::size_t p = 0; p < state.loops.size(); ++p) {
    if (state.loops[p] < 0) continue;
    auto& [bare, hidden] = shares[{state.loops[p], state.segments[p]}];
    const Finding& finding = state.findings[p];
    const Verdict& beyond = state.beyond[p];
    if (finding.zone == Zone::uncovered && !beyond.is) bare.is += state.areas[p];
    if (finding.nearby == bit(Zone::uncovered) && !beyond.might) bare.least += state.areas[p];
    if ((finding.nearby & bit(Zone::uncovered)) != 0 && !beyond.must) bare.most += state.areas[p];
    if (finding.hidden.is && !beyond.is) hidden.is += state.areas[p];
    if (finding.hidden.must && !beyond.might) hidden.least += state.areas[p];
    if (finding.hidden.might) hidden.most += state.areas[p];
  }
  for (const auto& [where, share] : shares) {
    Sums& sum = sums[where.second];
    const auto judge = [&](double& most, double bare, double hidden, double exposed, double covered) {
      const double counted = covered > 0 ? hidden : 0;  // Where nothing is covered, nothing counts as hidden.
      const double allowed = kMaxInHole * (exposed + counted);
      if (bare + counted > 0) most = std::max(most, (bare + counted) / allowed);
    };
    judge(sum.hole.is, share.bare.is, share.hidden.is, sum.is.exposed, sum.covered.is);
    judge(sum.hole.least, share.bare.least, share.hidden.least, std::max(sum.worst.exposed, sum.best.exposed),
          sum.covered.least);
    judge(sum.hole.most, share.bare.most, share.hidden.most, std::min(sum.worst.exposed, sum.best.exposed),
          sum.covered.most);
  }
}

/// A segment is small if its covered area is less than this share of that of all segments.
constexpr double kSmall = 0.01;

/// The ratios of what a segment has to what its rules ask of it.
/// @param depth         Its mean depth; 0 if nothing of it is covered.
/// @param allowedDepth  What a small segment may have.
/// @param hole          What lies in a hole, against what may.
Ratios ratiosOf(const Options& options, const Tally& tally, double area, bool isSmall, double depth,
                double allowedDepth, double hole) {
  constexpr double kMaxUncovered = 0.25;
  const auto times = [](double has, double needs) { return needs > 0 ? has / needs : kInfinity; };
  Ratios ratios;
  ratios.threshold = times(tally.covered, static_cast<double>(options.threshold) * tally.exposed);
  if (isSmall) ratios.hole = times(1, hole);
  if (!options.steps.floor) return ratios;
  ratios.floor = 0;
  if (!(tally.covered > 0)) return ratios;
  ratios.floor = times(tally.covered * (tally.covered / tally.exposed), static_cast<double>(options.minCovered) * area);
  if (isSmall) {
    ratios.depth = times(allowedDepth, depth);
  } else {
    ratios.floor = std::max(ratios.floor, times(kMaxUncovered * tally.exposed, tally.exposed - tally.covered));
  }
  return ratios;
}

/// Steps 5 and 8, and what step 10 says of segments: whether each passes, and could have passed, given what its samples
/// might have found.
void decide(const Scene& scene, const Options& options, const std::vector<Sample>& samples, State& state,
            Result& result) {
  constexpr double kMaxDeeper = 0.015;
  std::vector<Sums> sums(state.segmentCount);
  Range covered, depth;  // Of all segments.
  for (std::uint32_t s = 0; s < state.segmentCount; ++s) {
    const double area = result.segmentStats[s].area;
    sums[s].area = {area, area, area};
  }
  for (const Sample& sample : samples) {
    Sums& sum = sums[sample.segment];
    const auto count = [&](Tally& tally, Zone zone) {
      if (zone != Zone::occluded) tally.exposed += sample.area;
      if (zone == Zone::cosmetic) tally.covered += sample.area;
    };
    const auto might = [&](Zone zone) { return (sample.finding.nearby & bit(zone)) != 0; };
    if (!single(sample.finding.nearby) || sample.beyond.might != sample.beyond.must)
      result.firmAreas[sample.segment] = 0;
    if (sample.beyond.is) sum.area.is -= sample.area, result.segmentStats[sample.segment].beyondArea += sample.area;
    if (sample.beyond.might) sum.area.least -= sample.area;
    if (sample.beyond.must) {
      sum.area.most -= sample.area;
      continue;
    }
    if (!sample.beyond.is) count(sum.is, sample.finding.zone);
    const Zone hidden = might(Zone::occluded) ? Zone::occluded : Zone::cosmetic;
    count(sum.worst, might(Zone::uncovered) ? Zone::uncovered : hidden);
    const Zone bare = might(Zone::occluded) ? Zone::occluded : Zone::uncovered;
    if (might(Zone::cosmetic) || !sample.beyond.might) count(sum.best, might(Zone::cosmetic) ? Zone::cosmetic : bare);
    const double deep = sample.area * std::min(1.0, sample.place.nearest.distance / scene.diag);
    const auto cover = [&](double Range::*which) {
      for (Range* range : {&sum.covered, &covered}) range->*which += sample.area;
      for (Range* range : {&sum.depth, &depth}) range->*which += deep;
    };
    if (sample.finding.zone == Zone::cosmetic) cover(&Range::is);
    if (sample.finding.nearby == bit(Zone::cosmetic)) cover(&Range::least);
    if (might(Zone::cosmetic)) cover(&Range::most);
  }
  if (options.steps.holes) judgeContents(state, sums);

  const auto over = [](double a, double b) { return b > 0 ? a / b : a > 0 ? kInfinity : 0; };
  state.deepest = {over(depth.is, covered.is) + kMaxDeeper, over(depth.least, covered.most) + kMaxDeeper,
                   over(depth.most, covered.least) + kMaxDeeper};
  // With a threshold of 0 or 1 a tie is a sum compared with nothing or with itself: exact, whatever the order.
  const bool exact = !options.steps.floor && (options.threshold == 0 || options.threshold == 1);
  for (std::uint32_t s = 0; s < state.segmentCount; ++s) {
    const Sums& sum = sums[s];
    const double noise = exact || sum.is.exposed == 0 ? 0 : kSumNoise;
    const bool isSmall = sum.covered.is < kSmall * covered.is;
    const bool mightBeSmall = sum.covered.least < kSmall * covered.most * (1 + noise);
    const bool mustBeSmall = sum.covered.most < kSmall * covered.least * (1 - noise);
    SegmentStats& stats = result.segmentStats[s];
    stats.exposedArea = sum.is.exposed;
    stats.coveredArea = sum.is.covered;
    stats.depth = over(sum.depth.is, sum.covered.is);
    stats.ratios = ratiosOf(options, sum.is, sum.area.is, isSmall, stats.depth, state.deepest.is, sum.hole.is);
    const double worst =
        ratiosOf(options, sum.worst, sum.area.most, mightBeSmall,
                 over(sum.depth.most, sum.covered.least) * (1 + kDepthNoise), state.deepest.least, sum.hole.most)
            .least();
    const double best =
        ratiosOf(options, sum.best, sum.area.least, mustBeSmall,
                 over(sum.depth.least, sum.covered.most) * (1 - kDepthNoise), state.deepest.most, sum.hole.least)
            .least();
    const bool passes = stats.ratios.least() >= 1;
    state.passes.push_back({passes, passes || best >= 1 - noise, passes && worst >= 1 + noise});
    state.covered.push_back({sum.is.covered > 0, sum.best.covered > 0, sum.worst.covered > 0});
    const double others = std::min({stats.ratios.threshold, stats.ratios.floor, stats.ratios.depth});
    stats.culledBy = passes ? CulledBy::none : others < 1 ? CulledBy::coverage : CulledBy::hole;
    if (mightBeSmall != mustBeSmall) result.firmAreas[s] = 0;
  }
}

// -------------------- 9 Recheck

/// Which way a point looks.
struct Outlook {
  Vec normal;             // Unit; zero if it has none.
  bool twoSided = false;  // The other way as well.
};

/// Each point's normal: of its triangles, weighted by area, turned so that the segment's mostly agree with the cage.
///
/// Where they cancel out, because every triangle has a copy in reverse winding, the point looks to both sides: along
/// the sum of the normals, each turned to the side of the largest triangle (the first of equals), and against it.
/// @param firm  Receives for each segment whether that turn is certain.
std::vector<Outlook> outlooks(const Scene& scene, const State& state, std::vector<bool>& firm) {
  constexpr double kCancelled = 1e-6;  // Of the areas summed up: less than this is nothing.
  const std::vector<Triangle>& triangles = scene.target.triangles();
  std::vector<Vec> sums(scene.points.count()), turned(scene.points.count());
  std::vector<double> weights(scene.points.count(), 0.0);
  std::vector<const Triangle*> largest(scene.points.count(), nullptr);
  for (std::size_t t = 0; t < scene.corners.size(); ++t)
    for (const std::uint32_t p : scene.corners[t]) {
      sums[p] = sums[p] + triangles[t].normal * triangles[t].area;
      weights[p] += triangles[t].area;
      if (largest[p] == nullptr || triangles[t].area > largest[p]->area * (1 + kSumNoise)) largest[p] = &triangles[t];
    }
  for (std::size_t t = 0; t < scene.corners.size(); ++t)
    for (const std::uint32_t p : scene.corners[t]) {
      const double side = dot(triangles[t].normal, largest[p]->normal) < 0 ? -1 : 1;
      turned[p] = turned[p] + triangles[t].normal * (triangles[t].area * side);
    }
  std::vector<Outlook> result(scene.points.count());
  std::vector<double> agreement(state.segmentCount, 0.0), most(state.segmentCount, 0.0),
      unsure(state.segmentCount, 0.0);
  for (std::size_t p = 0; p < result.size(); ++p) {
    if (length(sums[p]) > kCancelled * weights[p]) result[p].normal = unit(sums[p]);
    const bool cancelled = dot(result[p].normal, result[p].normal) == 0;
    const unsigned occluded = bit(Zone::occluded), nearby = state.findings[p].nearby;
    if (cancelled || nearby == occluded) continue;
    const std::uint32_t s = state.segments[p];
    const double agrees = state.areas[p] * dot(result[p].normal, state.places[p].triangle->normal);
    most[s] += state.areas[p];
    if (state.findings[p].zone != Zone::occluded) agreement[s] += agrees;
    if ((nearby & occluded) != 0) unsure[s] += std::abs(agrees);
  }
  for (std::uint32_t s = 0; s < state.segmentCount; ++s)
    firm.push_back(most[s] == 0 || std::abs(agreement[s]) > unsure[s] + kSumNoise * most[s]);
  for (std::size_t p = 0; p < result.size(); ++p) {
    const bool cancelled = dot(result[p].normal, result[p].normal) == 0;
    if (!cancelled && agreement[state.segments[p]] < 0) result[p].normal = result[p].normal * -1;
    if (cancelled && length(turned[p]) > kCancelled * weights[p]) result[p] = {unit(turned[p]), true};
  }
  return result;
}

/// Whether a triangle of the target is in the way of rays.
using InTheWay = std::function<Verdict(const Triangle&)>;

/// Whether enough rays from a point, in twelve directions about its normal, come to the cage past the target.
Verdict isSeen(const Scene& scene, const Options& options, Vec p, Vec normal, const InTheWay& inTheWay) {
  constexpr int kDirections = 12, kEnough = 2;
  constexpr double kGoldenAngle = 2.399963229728653, kLift = 1e-4;
  if (dot(normal, normal) == 0) return {};
  const Vec t1 = unit(cross(normal, std::abs(normal.x) < 0.9 ? Vec{1, 0, 0} : Vec{0, 1, 0}));
  const Vec t2 = cross(normal, t1);
  const double behind = -2 * kCageHitStart * scene.diag;
  int good = 0, might = 0, must = 0;
  for (int k = 0; k < kDirections; ++k) {
    const double z = 1 - (k + 0.5) / kDirections, aside = std::sqrt(1 - z * z);
    const double azimuth = k * kGoldenAngle;
    const Ray ray{p + normal * (kLift * scene.diag),
                  normal * z + (t1 * std::cos(azimuth) + t2 * std::sin(azimuth)) * aside};
    const auto target = scene.target.along(ray, behind), cage = scene.cage.along(ray, behind);
    const auto isGood = [&](const Ray& turned) {
      const auto isHit = [&](double start) {
        return [&, start](const Triangle* t) { return hit(turned, *t) > start * scene.diag; };
      };
      if (std::none_of(cage.begin(), cage.end(), isHit(kCageHitStart))) return Verdict{};
      Verdict passes = kSurely;
      for (const Triangle* t : target) {
        if (!isHit(kSelfHitStart)(t)) continue;
        passes = passes && !inTheWay(*t);
      }
      return passes;
    };
    Verdict is = isGood(ray);
    if (options.findsStability)
      for (const Ray& turned : nudged(scene, ray)) {
        const Verdict other = isGood(turned);
        is.might = is.might || other.might;
        is.must = is.must && other.must;
      }
    good += is.is, might += is.might, must += is.must;
    if (!options.findsStability && good >= kEnough) break;
  }
  return {good >= kEnough, might >= kEnough, must >= kEnough};
}

/// Whether other segments alone hide a point, given one of its outcomes.
bool isHiddenByOthers(const Outcome& outcome, std::uint32_t segment) {
  return outcome.zone == Zone::occluded && outcome.hiders.count(segment) == 0;
}

/// Step 9: whether a point lies no deeper than what is to be painted.
/// @param deeper  By how much more it may, in diagonals.
Verdict isShallow(const Scene& scene, const State& state, std::size_t p, double deeper = 0) {
  const double depth = state.places[p].nearest.distance / scene.diag;
  return {depth <= state.deepest.is + deeper, depth * (1 - kDepthNoise) <= state.deepest.most + deeper,
          depth * (1 + kDepthNoise) <= state.deepest.least + deeper};
}

/// Step 9: whether what hides a point, other segments alone, is culled.
/// @param underHole  Whether step 10 recovers it where it is uncovered.
Verdict isFree(const State& state, const Finding& finding, std::uint32_t segment, const Verdict& underHole) {
  Verdict result{false, false, true};
  for (const Outcome& outcome : finding.outcomes) {
    if (outcome.zone != Zone::occluded) continue;
    Verdict free = isHiddenByOthers(outcome, segment) ? state.covered[segment] : Verdict{};
    for (const std::uint32_t s : outcome.hiders) free = free && !state.passes[s];
    if (!outcome.isUnderCage) free = free && underHole;
    if (&outcome == &finding.outcomes[0]) result.is = free.is;
    result.might = result.might || free.might;
    result.must = result.must && free.must;
  }
  return result;
}

/// Step 13: whether a point that is seen in a pose would be painted if nothing hid it.
Verdict isUnderCage(const Finding& finding, const Verdict& underHole) {
  Verdict result{false, false, true};
  for (const Outcome& outcome : finding.outcomes) {
    if (outcome.zone != Zone::occluded) continue;
    const Verdict is = outcome.isUnderCage ? kSurely : underHole;
    if (&outcome == &finding.outcomes[0]) result.is = is.is;
    result.might = result.might || is.might;
    result.must = result.must && is.must;
  }
  return result;
}

/// Step 9: the occluded points of passing, covered segments that are seen from elsewhere.
class Recheck {
 public:
  Recheck(const Scene& scene, const Options& options, const State& state)
      : scene_(scene),
        options_(options),
        state_(state),
        outlooks_(outlooks(scene, state, firm_)),
        neighbours_(scene.points.count()) {
    for (const auto& corners : scene.corners)
      for (std::size_t c = 0; c < 3; ++c) {
        neighbours_[corners[c]].push_back(corners[(c + 1) % 3]);
        neighbours_[corners[c]].push_back(corners[(c + 2) % 3]);
      }
  }

  /// Begins at what is not occluded; a recovered point brings its neighbours in, a rejected one does not.
  std::vector<Verdict> recovered() {
    Seen seen(scene_.points.count());
    const auto isOccluded = [&](std::uint32_t p) {
      return overOutcomes(state_.findings[p], [](const Outcome& o) { return o.zone == Zone::occluded; });
    };
    const auto isOpen = [&](std::uint32_t p) { return !isOccluded(p); };
    const auto isSeenBy = [&](std::uint32_t p) { return isSeen(seen, p, [](const Triangle&) { return kSurely; }); };
    std::vector<Verdict> result(scene_.points.count());
    for (const How how : kHows)
      for (const std::uint32_t p : spread(how, isOpen, isSeenBy)) result[p].*how = true;
    return result;
  }

  /// The same, once more, of points that their own segment hides, past all segments that are not painted. Points bring
  /// their neighbours in if they would be seen without any other segment.
  /// @param recovered  The points that are recovered without.
  std::vector<Verdict> recoveredPastOthers(const std::vector<Verdict>& recovered) {
    Seen clear(scene_.points.count()), seen(scene_.points.count());
    const auto isTested = [&](std::uint32_t p) {
      const Verdict isHidden = overOutcomes(state_.findings[p], [&](const Outcome& o) {
        return o.zone == Zone::occluded && !isHiddenByOthers(o, state_.segments[p]);
      });
      return isHidden && !recovered[p] && isShallow(scene_, state_, p);
    };
    const auto isOpen = [&](std::uint32_t p) { return !isTested(p); };
    const auto isClear = [&](std::uint32_t p) {
      const Verdict tested = outlooks_[p].twoSided ? Verdict{} : isTested(p);
      if (!tested.might) return tested;
      return tested && isSeen(clear, p, [&](const Triangle& t) {
               return segmentOf(scene_, state_.segments, t) == state_.segments[p] ? kSurely : Verdict{};
             });
    };
    const auto isSeenBy = [&](std::uint32_t p) {
      return isSeen(seen, p, [&](const Triangle& t) {
        const std::uint32_t s = segmentOf(scene_, state_.segments, t);
        return s == state_.segments[p] ? kSurely : state_.passes[s];
      });
    };
    std::vector<Verdict> result(scene_.points.count());
    for (const How how : kHows)
      for (const std::uint32_t p : spread(how, isOpen, isClear)) result[p].*how = isSeenBy(p).*how;
    return result;
  }

 private:
  using How = bool Verdict::*;
  static constexpr How kHows[] = {&Verdict::is, &Verdict::might, &Verdict::must};
  using Seen = std::vector<std::optional<Verdict>>;

  Verdict isSeen(Seen& known, std::uint32_t p, const InTheWay& inTheWay) const {
    if (!known[p]) {
      const auto& [normal, twoSided] = outlooks_[p];
      const Vec position = scene_.points.positions[p];
      const auto look = [&](Vec along) { return reference::isSeen(scene_, options_, position, along, inTheWay); };
      known[p] = look(normal);
      if (twoSided) known[p] = *known[p] || look(normal * -1);
      if (!firm_[state_.segments[p]] && !twoSided) known[p]->might = true, known[p]->must = false;
    }
    return *known[p];
  }

  /// The occluded points that are recovered, as it is, as it might or as it must be.
  template <typename IsOpen, typename IsSeenBy>
  std::vector<std::uint32_t> spread(How how, IsOpen isOpen, IsSeenBy isSeenBy) const {
    std::vector<std::uint32_t> open, result;
    std::vector<bool> isRecovered(scene_.points.count(), false);
    for (std::uint32_t p = 0; p < scene_.points.count(); ++p)
      if (isOpen(p).*how) open.push_back(p);
    while (!open.empty()) {
      const std::uint32_t from = open.back();
      open.pop_back();
      for (const std::uint32_t p : neighbours_[from]) {
        const std::uint32_t s = state_.segments[p];
        if ((state_.findings[p].nearby & bit(Zone::occluded)) == 0 || isRecovered[p]) continue;
        if (how == &Verdict::is && state_.findings[p].zone != Zone::occluded) continue;
        if (!(state_.passes[s].*how) || !(state_.covered[s].*how)) continue;
        if (!(isSeenBy(p).*how)) continue;
        isRecovered[p] = true;
        result.push_back(p);
        open.push_back(p);
      }
    }
    return result;
  }

  const Scene& scene_;
  const Options& options_;
  const State& state_;
  std::vector<bool> firm_;
  std::vector<Outlook> outlooks_;
  std::vector<std::vector<std::uint32_t>> neighbours_;
};

// -------------------- 13 Motion

/// The target in a pose.
class Pose {
 public:
  /// @param segments  Of the vertices at rest.
  Pose(const MeshView& cage, const MeshView& posed, const Options& options, const Scene& rest, const State& state)
      : options_(options), state_(state), scene_(makeScene(cage, posed)) {
    scene_.diag = rest.diag;
    const std::size_t count = scene_.points.count();
    at_.findings.resize(count), at_.places.resize(count), at_.segments.resize(count), at_.areas.resize(count);
    at_.segmentCount = state.segmentCount;
    for (std::size_t v = scene_.points.ofVertex.size(); v-- > 0;) {
      const std::uint32_t q = scene_.points.ofVertex[v], p = rest.points.ofVertex[v];
      at_.findings[q] = state.findings[p], at_.places[q] = state.places[p], at_.segments[q] = state.segments[p];
    }
    for (std::size_t t = 0; t < scene_.corners.size(); ++t)
      for (const std::uint32_t q : scene_.corners[t]) at_.areas[q] += scene_.target.triangles()[t].area / 3;
    outlooks_ = outlooks(scene_, at_, firm_);
    known_.resize(count);
  }

  struct Look {
    Verdict seen, bare;
  };
  const Look& at(std::uint32_t vertex) {
    std::optional<Look>& known = known_[scene_.points.ofVertex[vertex]];
    if (!known) known = look(scene_.points.ofVertex[vertex]);
    return *known;
  }

 private:
  [[nodiscard]] Look look(std::uint32_t q) const {
    const std::uint32_t own = at_.segments[q];
    const Ray normal{scene_.points.positions[q], at_.places[q].triangle->normal};
    const auto target = scene_.target.along(normal, -2 * kCageHitStart * scene_.diag);
    std::optional<Look> around;
    const auto lookAlong = [&](const Ray& ray) {
      std::set<std::uint32_t> hiders;
      for (const Triangle* t : target) {
        const auto& corners = scene_.corners[static_cast<std::size_t>(t - scene_.target.triangles().data())];
        if (std::find(corners.begin(), corners.end(), q) != corners.end()) continue;
        if (hit(ray, *t) > kSelfHitStart * scene_.diag) hiders.insert(segmentOf(scene_, at_.segments, *t));
      }
      if (hiders.count(own) > 0) {
        if (!around) around = lookAround(q);
        return *around;
      }
      Verdict free = kSurely;
      for (const std::uint32_t s : hiders) free = free && !state_.passes[s];
      return Look{free, hiders.empty() ? kSurely : Verdict{}};
    };
    Look result = lookAlong(normal);
    if (!options_.findsStability) return result;
    for (const Ray& ray : nudged(scene_, normal)) {
      const Look beside = lookAlong(ray);
      for (const auto which : {&Look::seen, &Look::bare}) {
        (result.*which).might = (result.*which).might || (beside.*which).might;
        (result.*which).must = (result.*which).must && (beside.*which).must;
      }
    }
    return result;
  }

  /// Twelve other rays, as in step 9.
  [[nodiscard]] Look lookAround(std::uint32_t q) const {
    const Outlook& outlook = outlooks_[q];
    const std::uint32_t own = at_.segments[q];
    if (outlook.twoSided) return {};
    const auto seen = [&](const InTheWay& inTheWay) {
      Verdict is = isSeen(scene_, options_, scene_.points.positions[q], outlook.normal, inTheWay);
      if (!firm_[own]) is.might = true, is.must = false;
      return is;
    };
    return {seen([&](const Triangle& t) {
              const std::uint32_t s = segmentOf(scene_, at_.segments, t);
              return s == own ? kSurely : state_.passes[s];
            }),
            seen([](const Triangle&) { return kSurely; })};
  }

  const Options& options_;
  const State& state_;
  Scene scene_;
  State at_;  // Of the pose: areas; all else is as at rest.
  std::vector<bool> firm_;
  std::vector<Outlook> outlooks_;
  std::vector<std::optional<Look>> known_;
};

/// Finds what is occluded at rest and comes into view in poses, near what these move.
void findMotion(const MeshView& cage, const MeshView& target, const Options& options, const Scene& rest, State& state) {
  constexpr double kMoves = 1e-4, kMaxDeeper = 0.05, kMaxDeeperAtRest = 0.015;
  std::vector<std::uint32_t> segments;
  for (const std::uint32_t p : rest.points.ofVertex) segments.push_back(state.segments[p]);
  for (std::size_t first = 0; first < target.poses.size(); first += target.positions.size()) {
    const MeshView posed{target.poses.subspan(first, target.positions.size()), target.indices, {}, segments};
    Box moved;
    for (std::uint32_t v = 0; v < segments.size(); ++v) {
      if (!(length(vertex(posed, v) - vertex(target, v)) > kMoves * rest.diag)) continue;
      moved.add(vertex(target, v));
      moved.add(vertex(posed, v));
    }
    if (!(moved.low.x <= moved.high.x)) continue;
    Pose pose(cage, posed, options, rest, state);
    const double deeper = kMaxDeeper * moved.diagonal() / rest.diag - kMaxDeeperAtRest;
    for (std::uint32_t v = 0; v < segments.size(); ++v) {
      const std::uint32_t p = rest.points.ofVertex[v];
      if (!moved.contains(rest.points.positions[p])) continue;
      const Verdict isOccluded =
          overOutcomes(state.findings[p], [](const Outcome& o) { return o.zone == Zone::occluded; });
      const Verdict isShallow = reference::isShallow(rest, state, p, deeper);
      const Verdict mayGain = isOccluded && state.covered[segments[v]] && isShallow;
      const Verdict mayExplain = options.steps.holes && state.loops[p] >= 0 ? isOccluded : Verdict{};
      if (!mayGain.might && !mayExplain.might) continue;
      const Pose::Look& look = pose.at(v);
      state.inPose[p] = state.inPose[p] || (mayGain && look.seen);
      state.bare[p] = state.bare[p] || (mayExplain && look.bare);
    }
  }
}

// -------------------- 10 Holes

/// What is known of a hole of the cage, an open loop.
struct Hole {
  Range uncovered;    // Area of passing segments there that the cage does not cover.
  Verdict explained;  // It is meant for what fails there.
};

std::vector<Hole> judgeHoles(const Scene& scene, const State& state) {
  constexpr double kExplaining = 0.02;
  std::vector<Hole> holes(scene.loops.loops.size());
  std::vector<Range> failing(holes.size());
  for (std::size_t p = 0; p < state.loops.size(); ++p) {
    if (state.loops[p] < 0) continue;
    const auto loop = static_cast<std::size_t>(state.loops[p]);
    const Verdict& pass = state.passes[state.segments[p]];
    const Verdict counts = !state.beyond[p];
    const Finding& finding = state.findings[p];
    const double area = state.areas[p];
    const auto add = [&](Range& range, const Verdict& isPart) {
      const Verdict isAdded = isPart && counts;
      range.is += isAdded.is ? area : 0;
      range.least += isAdded.must ? area : 0;
      range.most += isAdded.might ? area : 0;
    };
    const auto isFound = [&](Zone zone) {
      return Verdict{finding.zone == zone, (finding.nearby & bit(zone)) != 0, finding.nearby == bit(zone)};
    };
    add(failing[loop], !pass && (!isFound(Zone::occluded) || state.bare[p]));
    add(holes[loop].uncovered, pass && isFound(Zone::uncovered));
  }
  for (std::size_t l = 0; l < holes.size(); ++l) {
    const auto explains = [](double some, double all) { return some > 0 && some >= kExplaining * all; };
    const Range& uncovered = holes[l].uncovered;
    holes[l].explained = {explains(failing[l].is, uncovered.is),
                          explains(failing[l].most, uncovered.least * (1 - kSumNoise)),
                          explains(failing[l].least, uncovered.most * (1 + kSumNoise))};
  }
  return holes;
}

/// Step 10: the uncovered points whose hole is not meant for them: those that lie under the cage, hardly beside it, or
/// beside a hole that something else explains.
std::vector<Verdict> underHoles(const Scene& scene, const State& state) {
  constexpr double kExplainedOverhang = 0.03;
  const std::vector<Hole> holes = judgeHoles(scene, state);
  std::vector<Verdict> result;
  for (std::size_t p = 0; p < state.loops.size(); ++p) {
    if (state.loops[p] < 0) {
      result.push_back({true, true, true});
      continue;
    }
    const auto loop = static_cast<std::size_t>(state.loops[p]);
    const Overhang overhang(scene, scene.points.positions[p], state.places[p], state.loops[p]);
    const auto allowed = [&](double h, bool isExplained) {
      return h <= overhang.slight || (isExplained && h <= kExplainedOverhang * scene.diag);
    };
    const double unsure = kUnsureOverhang * scene.diag;
    result.push_back({allowed(overhang.is, holes[loop].explained.is),
                      allowed(overhang.is - unsure, holes[loop].explained.might),
                      allowed(overhang.is + unsure, holes[loop].explained.must)});
  }
  return result;
}

/// The zones (as bits) that a point might end up in, given one of those it might have been found in.
unsigned outcomes(Zone found, const Verdict& passes, const Verdict& seen, const Verdict& underHole) {
  unsigned zones = 0;
  if (!passes.must) zones |= bit(found == Zone::cosmetic ? Zone::culled : found);
  if (!passes.might) return zones;
  const Verdict& recovered = found == Zone::occluded ? seen : found == Zone::uncovered ? underHole : kSurely;
  if (recovered.might) zones |= bit(Zone::cosmetic);
  if (!recovered.must) zones |= bit(found);
  return zones;
}

// -------------------- The baseline

/// The classical baseline: the nearest vertex of the cage, the lowest of equally near ones; nothing is filtered. A
/// vertex of no triangle, or only of degenerate ones, is not part of the cage; of the triangles at a vertex the first
/// stands for it.
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

// -------------------- Steps 1 to 3

/// A scene with what steps 1 to 3 find in it. They take most of the time and depend on few of the options, so that
/// tests of many options on one scene take them once.
class LastScene {
 public:
  LastScene(const MeshView& cage, const MeshView& target, const Options& options)
      : scene(makeScene(cage, target, static_cast<double>(options.weldTolerance))), key_(keyOf(cage, target, options)) {
    std::uint32_t count = 0;
    segments_ = findSegments(scene, count);
  }
  LastScene(const LastScene&) = delete;  // Places point into the scene.
  LastScene& operator=(const LastScene&) = delete;

  [[nodiscard]] bool is(const MeshView& cage, const MeshView& target, const Options& options) const {
    return key_ == keyOf(cage, target, options);
  }

  /// Step 1, for each point.
  const std::vector<ClosestPoint>& places() {
    if (places_.empty())
      for (const Vec& position : scene.points.positions) places_.push_back(project(scene, position));
    return places_;
  }

  /// The open loop of the cage that each point's place is on, or -1.
  const std::vector<std::int32_t>& loops() {
    if (loops_.empty())
      for (const ClosestPoint& place : places()) loops_.push_back(loopAt(scene, place));
    return loops_;
  }

  /// Steps 2 and 3, for each point.
  const std::vector<Finding>& findings(const Options& options) {
    std::vector<Finding>& found = findings_[{options.occlusionReach, options.pokeThrough, options.findsStability}];
    for (std::size_t p = found.size(); p < scene.points.count(); ++p) {
      const ClosestPoint& place = places()[p];
      const Sight sight = look(scene, options, scene.points.positions[p], place, [&](std::size_t t) {
        return std::find(scene.corners[t].begin(), scene.corners[t].end(), p) != scene.corners[t].end();
      });
      found.push_back(judge(scene, segments_, options, sight, place));
    }
    return found;
  }

  const Scene scene;

 private:
  /// Everything that `makeScene` reads.
  using Key = std::tuple<std::vector<float>, std::vector<std::uint32_t>, std::vector<float>, std::vector<std::uint32_t>,
                         std::vector<std::uint32_t>, float>;
  static Key keyOf(const MeshView& cage, const MeshView& target, const Options& options) {
    return {{cage.positions.begin(), cage.positions.end()},     {cage.indices.begin(), cage.indices.end()},
            {target.positions.begin(), target.positions.end()}, {target.indices.begin(), target.indices.end()},
            {target.groups.begin(), target.groups.end()},       options.weldTolerance};
  }

  const Key key_;
  Segments segments_;
  std::vector<ClosestPoint> places_;
  std::vector<std::int32_t> loops_;
  std::map<std::tuple<float, float, bool>, std::vector<Finding>> findings_;
};

LastScene& lastScene(const MeshView& cage, const MeshView& target, const Options& options) {
  static std::unique_ptr<LastScene> last;
  if (!last || !last->is(cage, target, options)) last = std::make_unique<LastScene>(cage, target, options);
  return *last;
}

}  // namespace

Result transfer(const MeshView& cage, const MeshView& target, const Options& options) {
  const bool filtered = options.steps.projection == ProjectionMode::nearestPoint;
  LastScene& last = lastScene(cage, target, options);
  const Scene& scene = last.scene;
  const std::size_t pointCount = scene.points.count(), vertexCount = target.positions.size() / 3;

  State state;
  state.places.resize(pointCount);
  state.findings.resize(pointCount);
  state.loops.assign(pointCount, -1);
  state.beyond.resize(pointCount);
  if (filtered) {
    state.places = last.places();
    state.findings = last.findings(options);
    state.loops = last.loops();
  }

  Result result;
  state.segments = findSegments(scene, state.segmentCount);
  state.areas.assign(pointCount, 0.0);
  for (std::size_t t = 0; t < scene.corners.size(); ++t)
    for (const std::uint32_t p : scene.corners[t]) state.areas[p] += scene.target.triangles()[t].area / 3;
  if (filtered && options.steps.holes) {
    findOuterBorders(scene, state);
    findBeyond(scene, state);
  }
  result.segmentStats.resize(state.segmentCount);
  result.firmAreas.assign(state.segmentCount, 1);
  for (std::size_t p = 0; p < pointCount; ++p) {
    ++result.segmentStats[state.segments[p]].points;
    result.segmentStats[state.segments[p]].area += state.areas[p];
  }
  if (filtered) {
    const std::vector<Sample> samples = findInteriorSamples(scene, options, state);
    decide(scene, options, samples, state, result);
  } else {
    double all = 0;
    for (const SegmentStats& stats : result.segmentStats) all += stats.area;
    for (SegmentStats& stats : result.segmentStats) {
      stats.exposedArea = stats.coveredArea = stats.area;
      stats.ratios = ratiosOf(options, {stats.area, stats.area}, stats.area, stats.area < kSmall * all, 0, 0, 0);
      const bool passes = stats.ratios.least() >= 1;
      stats.culledBy = passes ? CulledBy::none : CulledBy::coverage;
      state.passes.push_back({passes, passes, passes});
    }
  }
  state.inPose.resize(pointCount), state.bare.resize(pointCount);
  if (filtered && options.steps.recheck && options.motion) findMotion(cage, target, options, scene, state);
  std::vector<Verdict> seen(pointCount), underHole(pointCount);
  if (filtered && options.steps.holes) underHole = underHoles(scene, state);
  if (filtered && options.steps.recheck) {
    Recheck recheck(scene, options, state);
    seen = recheck.recovered();
    const std::vector<Verdict> past = recheck.recoveredPastOthers(seen);
    for (std::size_t p = 0; p < pointCount; ++p)
      seen[p] = seen[p] || past[p] ||
                (isShallow(scene, state, p) && isFree(state, state.findings[p], state.segments[p], underHole[p])) ||
                (state.inPose[p] && isUnderCage(state.findings[p], underHole[p]));
  }

  for (std::size_t p = 0; p < pointCount; ++p) {
    seen[p] = seen[p] && !state.beyond[p];
    underHole[p] = underHole[p] && !state.beyond[p];
  }

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
    result.stable.push_back(!options.findsStability || ends == bit(zone) ? 1 : 0);
    if (!filtered) continue;
    result.triangles[v] = state.places[p].triangle->index;
    result.distances[v] = static_cast<float>(state.places[p].nearest.distance);
    const auto uv = uvAt(cage, state.places[p]);
    for (std::size_t k = 0; k < 2; ++k) result.uvs[v * 2 + k] = static_cast<float>(uv[k]);
  }
  if (!filtered) nearestVertex(cage, scene, result);

  // Step 11: the depth buffer hides what is occluded of a triangle.
  for (std::size_t t = 0; t < target.indices.size(); t += 3) {
    std::array<int, 4> corners{};
    for (std::size_t c = 0; c < 3; ++c) ++corners[static_cast<std::size_t>(result.zones[target.indices[t + c]])];
    const auto [cosmetic, occluded, uncovered, culled] = corners;
    const bool painted = options.steps.partialTriangles ? cosmetic > 0 && uncovered == 0 && culled == 0 : cosmetic == 3;
    result.cosmeticTriangles.push_back(painted ? 1 : 0);
  }
  if (filtered && options.seams == Seams::corner)
    result.cornerUvs = cornerUvs(cage, target, scene, state.places, result.uvs, result.stableCorners);
  return result;
}

}  // namespace cagecast::reference
