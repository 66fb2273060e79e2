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

// Sums of areas that differ by less than this share may differ only by the order of adding.
constexpr double kSumNoise = 1e-12;

/// Everything that could be true of one yes-or-no question: what is, and what might be if rays were turned a little.
struct Verdict {
  bool is = false, might = false, must = false;
};

// ------------------------------------------------------------------------------------------- 2, 3 Ray tests, 2', 3'
// too

/// A point's ray, with the triangles worth testing it against.
struct Sight {
  Ray ray;
  std::vector<const Triangle*> target, cage;
  bool pokesThrough = false;  // Step 3': it may do without a cage hit.
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
  sight.pokesThrough = options.pokes && place.nearest.distance <= options.pokeThrough * scene.diag &&
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
  Zone zone;
  bool isHidden = false;  // The target occludes the point, and the cage is not over it either; with step 2'.
};

/// Steps 2 and 3 for one ray.
Outcome outcomeOf(const Scene& scene, const Options& options, const Sight& sight, const Ray& ray,
                  const ClosestPoint& place) {
  const double cage = cageDistance(scene, sight, ray, place);
  const double end = options.endOfSelfRay ? cage + options.occlusionReach * scene.diag : kInfinity;
  const bool occluded = std::any_of(sight.target.begin(), sight.target.end(), [&](const Triangle* triangle) {
    const double t = hit(ray, *triangle);
    return t > kSelfHitStart * scene.diag && t <= end;
  });
  if (occluded) return {Zone::occluded, options.endOfSelfRay && cage == kInfinity};
  return {cage < kInfinity || sight.pokesThrough ? Zone::cosmetic : Zone::uncovered};
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
  Verdict hidden;
};

Finding judge(const Scene& scene, const Options& options, const Sight& sight, const ClosestPoint& place) {
  Finding finding;
  const Outcome is = outcomeOf(scene, options, sight, sight.ray, place);
  finding.zone = is.zone;
  finding.nearby = bit(is.zone);
  finding.hidden = {is.isHidden, is.isHidden, is.isHidden};
  if (options.stability)
    for (const Ray& ray : nudged(scene, sight.ray)) {
      const Outcome beside = outcomeOf(scene, options, sight, ray, place);
      finding.nearby |= bit(beside.zone);
      finding.hidden.might = finding.hidden.might || beside.isHidden;
      finding.hidden.must = finding.hidden.must && beside.isHidden;
    }
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
  std::vector<ClosestPoint> places;
  std::vector<Finding> findings;
  std::vector<double> areas;  // A third of each triangle.
  std::vector<std::uint32_t> segments;
  std::vector<std::int32_t> loops;  // The open loop of the cage that the place is on, or -1.
  std::uint32_t segmentCount = 0;
  std::vector<Verdict> passes;   // Per segment.
  std::vector<Verdict> covered;  // Per segment: whether any of it is.
};

// ------------------------------------------------------------------------------------------------------ 4', 5
// Threshold

/// A share of a segment's area, and what is found there.
struct Sample {
  std::uint32_t segment;
  double area;
  Finding finding;
  ClosestPoint place;
};

/// Step 4': whether the triangles of each segment have interior samples: if it is small, and near a hole.
std::vector<bool> haveInteriorSamples(const Scene& scene, const Options& options, const State& state) {
  constexpr std::uint32_t kFewPoints = 32;
  constexpr double kNear = 0.01;
  std::vector<Box> boxes(state.segmentCount);
  std::vector<std::uint32_t> points(state.segmentCount, 0);
  for (std::size_t p = 0; p < state.segments.size(); ++p) {
    // Holes may be as far off as the cage is.
    const double around = options.farLoops ? state.places[p].nearest.distance : 0;
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

/// The samples that areas are summed over: the points, for a third of each of their triangles; with step 4' the big
/// triangles of some segments count by the centroids of their four quarters instead.
std::vector<Sample> findInteriorSamples(const Scene& scene, const Options& options, const State& state) {
  constexpr double kBigTriangle = 0.06;
  std::vector<Sample> samples;
  for (std::size_t p = 0; p < state.segments.size(); ++p)
    samples.push_back({state.segments[p], 0, state.findings[p], state.places[p]});
  std::vector<bool> within(state.segmentCount, false);
  if (options.interiorSamples) within = haveInteriorSamples(scene, options, state);
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
      samples.push_back({segment, triangle.area / 4, judge(scene, options, sight, place), place});
    }
  }
  return samples;
}

/// A sum whose terms are not all certain.
struct Range {
  double is = 0, least = 0, most = 0;
};

/// For each sample the share of its area that counts when it is covered: less than all of it where it lies deeper than
/// what else the cage covers there. Teeth and tongues are seen past the lips, from below; what is to be painted lies
/// about as deep as its neighbours, or above them.
std::vector<Range> depthWeights(const Scene& scene, const std::vector<Sample>& samples) {
  constexpr double kNotDeep = 0.01;  // No depth below this share of the diagonal counts as deep.
  // What is usual about each vertex of the cage: of what is covered in the triangles around it.
  struct Sum {
    double area = 0, depth = 0;
  };
  std::vector<Sum> sums(scene.cageVertices);
  std::vector<std::vector<const Sample*>> unsure(scene.cageVertices);
  const auto corners = [&](const Sample& sample) {
    return scene.cageCorners[static_cast<std::size_t>(sample.place.triangle - scene.cage.triangles().data())];
  };
  for (const Sample& sample : samples) {
    const bool isCovered = sample.finding.zone == Zone::cosmetic;
    for (const std::uint32_t v : corners(sample)) {
      if (isCovered) sums[v].area += sample.area, sums[v].depth += sample.area * sample.place.nearest.distance;
      if (!single(sample.finding.nearby)) unsure[v].push_back(&sample);
    }
  }
  const auto weight = [&](const Sample& sample, Sum sum) {
    const double usual = std::max(sum.area > 0 ? sum.depth / sum.area : 0, kNotDeep * scene.diag);
    const double share = usual / std::max(sample.place.nearest.distance, usual);
    return share * share;
  };
  std::vector<Range> weights;
  for (const Sample& sample : samples) {
    Sum is;
    for (const std::uint32_t v : corners(sample)) is.area += sums[v].area, is.depth += sums[v].depth;
    // Every unsure neighbour that would pull what is usual down, or up, does so.
    Sum low = is, high = is;
    for (const std::uint32_t v : corners(sample))
      for (const Sample* other : unsure[v]) {
        const bool isCovered = other->finding.zone == Zone::cosmetic;
        const bool deeper = other->place.nearest.distance * is.area > is.depth;
        Sum& changed = deeper == isCovered ? low : high;
        const double sign = isCovered ? -1 : 1;
        changed.area = std::max(0.0, changed.area + sign * other->area);
        changed.depth = std::max(0.0, changed.depth + sign * other->area * other->place.nearest.distance);
      }
    const double now = weight(sample, is);
    weights.push_back({now, std::min(now, weight(sample, low)), std::max(now, weight(sample, high))});
  }
  return weights;
}

/// The first of the segments that each is a copy of: as many points, nearly the same area, nearly the same extent.
/// Taken by points, area and number, a segment belongs to the latest of the last few kinds whose first it is like; else
/// it begins one.
std::vector<std::uint32_t> findTwins(const Scene& scene, const State& state, const std::vector<SegmentStats>& stats) {
  constexpr double kSameArea = 0.01, kSameExtent = 0.02;
  constexpr std::size_t kKinds = 8;  // Parts of equal area and another shape may lie between twins; not many do.
  std::vector<Vec> centres(state.segmentCount);
  std::vector<double> extents(state.segmentCount, 0.0);  // Sum of squared distances of the points from their mean.
  for (std::size_t p = 0; p < state.segments.size(); ++p)
    centres[state.segments[p]] = centres[state.segments[p]] + scene.points.positions[p];
  for (std::uint32_t s = 0; s < state.segmentCount; ++s) centres[s] = centres[s] * (1.0 / stats[s].points);
  for (std::size_t p = 0; p < state.segments.size(); ++p) {
    const Vec offset = scene.points.positions[p] - centres[state.segments[p]];
    extents[state.segments[p]] += dot(offset, offset);
  }
  std::vector<std::uint32_t> order(state.segmentCount), twins(state.segmentCount);
  std::iota(order.begin(), order.end(), 0u);
  std::sort(order.begin(), order.end(), [&](std::uint32_t s, std::uint32_t t) {
    return std::tie(stats[s].points, stats[s].area, s) < std::tie(stats[t].points, stats[t].area, t);
  });
  std::vector<std::uint32_t> kinds;  // By their first.
  for (const std::uint32_t s : order) {
    const auto isLike = [&](std::uint32_t first) {
      return stats[s].points == stats[first].points && stats[s].area <= (1 + kSameArea) * stats[first].area &&
             std::abs(extents[s] - extents[first]) <= kSameExtent * extents[first];
    };
    const auto oldest = kinds.rbegin() + static_cast<std::ptrdiff_t>(std::min(kKinds, kinds.size()));
    const auto kind = std::find_if(kinds.rbegin(), oldest, isLike);
    twins[s] = kind == oldest ? s : *kind;
    if (kind == oldest) kinds.push_back(s);
  }
  return twins;
}

/// The sums that step 5 compares.
struct Tally {
  double area = 0, exposed = 0, covered = 0, depthWeighted = 0;
  double segments = 0;  // Of which these are the sums.
  void add(const Tally& other) {
    area += other.area, exposed += other.exposed, covered += other.covered, depthWeighted += other.depthWeighted;
    segments += other.segments;
  }
};

/// The score of a segment, the ratio of actual to required area: it is kept from 1 on.
/// @param allCovered  The covered area of all segments.
double scoreOf(const Options& options, const Tally& tally, double allCovered) {
  const auto times = [](double has, double needs) { return needs > 0 ? has / needs : kInfinity; };
  const double coverage = times(tally.covered, options.threshold * tally.exposed);
  if (options.floor == Floor::none) return coverage;
  if (!(tally.covered > 0)) return 0;
  if (options.floor == Floor::area) return std::min(coverage, times(tally.covered, options.minCovered * tally.area));
  // What is meant to be painted is covered almost wherever it is exposed; an eye or a light in its hole is not.
  const double counted = tally.depthWeighted * (tally.covered / tally.exposed);
  // A part that is mostly hidden passes for what it is of the whole, if where it is exposed it is covered beyond doubt.
  const double ofAll = std::min(times(counted, options.minOfAll * allCovered * tally.segments),
                                times(options.maxUncovered * tally.exposed, tally.exposed - tally.covered));
  const double floor = std::max(times(counted, options.minCovered * tally.area), ofAll);
  return std::min(coverage, floor);
}

/// Step 5: whether each segment passes, and could have passed, given what its samples might have found.
void decide(const Scene& scene, const Options& options, const std::vector<Sample>& samples, State& state,
            std::vector<SegmentStats>& stats) {
  // Three times: as it is, and with every sample at its worst and at its best.
  std::vector<Tally> is(state.segmentCount), worst(state.segmentCount), best(state.segmentCount);
  const std::vector<Range> weights =
      options.depthWeighting ? depthWeights(scene, samples) : std::vector<Range>(samples.size(), {1, 1, 1});
  Range all;  // The covered area of all segments.
  for (std::uint32_t s = 0; s < state.segmentCount; ++s) is[s] = worst[s] = best[s] = {stats[s].area, 0, 0, 0, 1};
  for (std::size_t i = 0; i < samples.size(); ++i) {
    const Sample& sample = samples[i];
    const auto count = [&](Tally& tally, Zone zone, double weight) {
      if (zone != Zone::occluded) tally.exposed += sample.area;
      if (zone == Zone::cosmetic) tally.covered += sample.area, tally.depthWeighted += sample.area * weight;
    };
    const auto might = [&](Zone zone) { return (sample.finding.nearby & bit(zone)) != 0; };
    count(is[sample.segment], sample.finding.zone, weights[i].is);
    if (sample.finding.zone == Zone::cosmetic) all.is += sample.area;
    if (sample.finding.nearby == bit(Zone::cosmetic)) all.least += sample.area;
    if (might(Zone::cosmetic)) all.most += sample.area;
    const Zone hidden = might(Zone::occluded) ? Zone::occluded : Zone::cosmetic;
    count(worst[sample.segment], might(Zone::uncovered) ? Zone::uncovered : hidden, weights[i].least);
    const Zone bare = might(Zone::occluded) ? Zone::occluded : Zone::uncovered;
    count(best[sample.segment], might(Zone::cosmetic) ? Zone::cosmetic : bare, weights[i].most);
  }
  for (std::uint32_t s = 0; s < state.segmentCount; ++s) {
    stats[s].exposedArea = is[s].exposed;
    stats[s].coveredArea = is[s].covered;
    stats[s].depthWeightedArea = is[s].depthWeighted;
    stats[s].twinOf = s;
    stats[s].score = scoreOf(options, is[s], all.is);
    state.covered.push_back({is[s].covered > 0, best[s].covered > 0, worst[s].covered > 0});
  }

  // Copies that are in doubt are judged together, so that twins do not fall on either side by accident.
  constexpr double kDoubt = 2;
  std::vector<bool> unsureDoubt(state.segmentCount, false);
  std::vector<std::uint32_t> twins;
  if (options.depthWeighting) {
    twins = findTwins(scene, state, stats);
    for (std::uint32_t s = 0; s < state.segmentCount; ++s) stats[s].twinOf = twins[s];
  }
  if (options.twins && options.depthWeighting && options.floor != Floor::none) {
    const auto inDoubt = [](double score) { return score >= 1 / kDoubt && score < kDoubt; };
    std::vector<Tally> sums(state.segmentCount), worstSums(state.segmentCount), bestSums(state.segmentCount);
    std::vector<bool> doubted(state.segmentCount), unsureSum(state.segmentCount, false);
    for (std::uint32_t s = 0; s < state.segmentCount; ++s) {
      const double least = scoreOf(options, worst[s], all.most), most = scoreOf(options, best[s], all.least);
      doubted[s] = inDoubt(stats[s].score);
      if (inDoubt(least) != doubted[s] || inDoubt(most) != doubted[s]) unsureSum[twins[s]] = unsureDoubt[s] = true;
      if (!doubted[s]) continue;
      sums[twins[s]].add(is[s]);
      worstSums[twins[s]].add(worst[s]);
      bestSums[twins[s]].add(best[s]);
    }
    for (std::uint32_t s = 0; s < state.segmentCount; ++s) {
      if (unsureSum[twins[s]] && twins[s] != s) unsureDoubt[s] = unsureDoubt[s] || doubted[s];
      if (!doubted[s]) continue;
      is[s] = sums[twins[s]];
      worst[s] = worstSums[twins[s]];
      best[s] = bestSums[twins[s]];
      unsureDoubt[s] = unsureDoubt[s] || unsureSum[twins[s]];
    }
  }

  // With a threshold of 0 or 1 a tie is a sum compared with nothing or with itself: exact, whatever the order.
  const bool exact = options.floor == Floor::none && (options.threshold == 0 || options.threshold == 1);
  state.passes.resize(state.segmentCount);
  for (std::uint32_t s = 0; s < state.segmentCount; ++s) {
    stats[s].score = scoreOf(options, is[s], all.is);
    const double least = scoreOf(options, worst[s], all.most), most = scoreOf(options, best[s], all.least);
    const double noise = exact || is[s].exposed == 0 ? 0 : kSumNoise;
    Verdict& pass = state.passes[s];
    pass.is = stats[s].score >= 1;
    pass.might = pass.is || most >= 1 - noise || unsureDoubt[s];
    pass.must = pass.is && least >= 1 + noise && !unsureDoubt[s];
    stats[s].culledBy = pass.is ? CulledBy::none : CulledBy::coverage;
  }
}

// ------------------------------------------------------------------------------------------------------- 6 Second look

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
std::vector<Outlook> outlooks(const Scene& scene, const Options& options, const State& state, std::vector<bool>& firm) {
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
    if (cancelled || (options.exposedSide && nearby == occluded)) continue;
    const std::uint32_t s = state.segments[p];
    const double agrees = state.areas[p] * dot(result[p].normal, state.places[p].triangle->normal);
    most[s] += state.areas[p];
    if (!options.exposedSide || state.findings[p].zone != Zone::occluded) agreement[s] += agrees;
    if (options.exposedSide && (nearby & occluded) != 0) unsure[s] += std::abs(agrees);
  }
  for (std::uint32_t s = 0; s < state.segmentCount; ++s)
    firm.push_back(most[s] == 0 || std::abs(agreement[s]) > unsure[s] + kSumNoise * most[s]);
  for (std::size_t p = 0; p < result.size(); ++p) {
    const bool cancelled = dot(result[p].normal, result[p].normal) == 0;
    if (!cancelled && agreement[state.segments[p]] < 0) result[p].normal = result[p].normal * -1;
    if (cancelled && options.bothSides && length(turned[p]) > kCancelled * weights[p])
      result[p] = {unit(turned[p]), true};
  }
  return result;
}

/// Whether enough rays from a point, in twelve directions about its normal, come to the cage past the target.
Verdict isSeen(const Scene& scene, const Options& options, Vec p, Vec normal) {
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
      const auto hits = [&](const std::vector<const Triangle*>& triangles, double start) {
        return std::any_of(triangles.begin(), triangles.end(),
                           [&](const Triangle* t) { return hit(turned, *t) > start * scene.diag; });
      };
      return !hits(target, kSelfHitStart) && hits(cage, kCageHitStart);
    };
    const bool is = isGood(ray);
    bool any = is, all = is;
    if (options.stability)
      for (const Ray& turned : nudged(scene, ray)) {
        const bool other = isGood(turned);
        any = any || other;
        all = all && other;
      }
    good += is, might += any, must += all;
    if (!options.stability && good >= kEnough) break;
  }
  return {good >= kEnough, might >= kEnough, must >= kEnough};
}

Verdict isSeen(const Scene& scene, const Options& options, Vec p, const Outlook& outlook) {
  Verdict seen = isSeen(scene, options, p, outlook.normal);
  if (!outlook.twoSided) return seen;
  const Verdict behind = isSeen(scene, options, p, outlook.normal * -1);
  return {seen.is || behind.is, seen.might || behind.might, seen.must || behind.must};
}

/// Step 6: the occluded points of passing, covered segments that are seen from elsewhere. Begins at the loop of what is
/// occluded; a recovered point brings its neighbours in, a rejected one does not.
std::vector<Verdict> recheck(const Scene& scene, const Options& options, const State& state) {
  const std::size_t count = scene.points.count();
  std::vector<bool> firm;
  const std::vector<Outlook> outlook = outlooks(scene, options, state, firm);
  std::vector<std::vector<std::uint32_t>> neighbours(count);
  for (const auto& corners : scene.corners)
    for (std::size_t c = 0; c < 3; ++c) {
      neighbours[corners[c]].push_back(corners[(c + 1) % 3]);
      neighbours[corners[c]].push_back(corners[(c + 2) % 3]);
    }
  std::vector<Verdict> seen(count), result(count);
  std::vector<bool> known(count, false);
  const auto isSeenFrom = [&](std::uint32_t p) {
    if (!known[p]) seen[p] = isSeen(scene, options, scene.points.positions[p], outlook[p]);
    known[p] = true;
    if (!firm[state.segments[p]] && !outlook[p].twoSided) seen[p].might = true, seen[p].must = false;
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
        const std::uint32_t s = state.segments[p];
        if (!isOccluded(state.findings[p]) || result[p].*how) continue;
        if (!(state.passes[s].*how) || !(state.covered[s].*how)) continue;
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
    const Finding& finding = state.findings[p];
    const double area = state.areas[p];
    if (!pass.is && finding.zone != Zone::occluded) failing[loop].is += area;
    if (!pass.might && (finding.nearby & bit(Zone::occluded)) == 0) failing[loop].least += area;
    if (!pass.must && (finding.nearby & ~bit(Zone::occluded)) != 0) failing[loop].most += area;
    Range& uncovered = holes[loop].uncovered;
    if (pass.is && finding.zone == Zone::uncovered) uncovered.is += area;
    if (pass.must && finding.nearby == bit(Zone::uncovered)) uncovered.least += area;
    if (pass.might && (finding.nearby & bit(Zone::uncovered)) != 0) uncovered.most += area;
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

/// Step 5": a hole may be meant for small parts: they do not pass if nothing else explains the hole, and it bares much
/// of them, or if much of them lies hidden under it.
void cullHoleContents(const Scene& scene, const std::vector<Sample>& samples, State& state, Result& result) {
  constexpr double kBare = 0.15, kMuchOfHole = 0.25, kHidden = 0.25, kSmall = 0.02;
  std::vector<Range> exposed(state.segmentCount), covered(state.segmentCount);
  Range all;  // The covered area of all segments.
  for (const Sample& sample : samples) {
    const auto add = [&](Range& sum, unsigned zones) {
      if ((bit(sample.finding.zone) & zones) != 0) sum.is += sample.area;
      if ((sample.finding.nearby & ~zones) == 0) sum.least += sample.area;
      if ((sample.finding.nearby & zones) != 0) sum.most += sample.area;
    };
    add(exposed[sample.segment], bit(Zone::cosmetic) | bit(Zone::uncovered));
    add(covered[sample.segment], bit(Zone::cosmetic));
    add(all, bit(Zone::cosmetic));
  }
  // What of each segment is uncovered at each hole, and what is hidden.
  struct Share {
    Range bare, hidden;
  };
  std::map<std::pair<std::size_t, std::uint32_t>, Share> shares;
  for (std::size_t p = 0; p < state.loops.size(); ++p) {
    if (state.loops[p] < 0) continue;
    auto& [bare, hidden] = shares[{static_cast<std::size_t>(state.loops[p]), state.segments[p]}];
    const Finding& finding = state.findings[p];
    if (finding.zone == Zone::uncovered) bare.is += state.areas[p];
    if (finding.nearby == bit(Zone::uncovered)) bare.least += state.areas[p];
    if ((finding.nearby & bit(Zone::uncovered)) != 0) bare.most += state.areas[p];
    if (finding.hidden.is) hidden.is += state.areas[p];
    if (finding.hidden.must) hidden.least += state.areas[p];
    if (finding.hidden.might) hidden.most += state.areas[p];
  }
  const std::vector<Hole> holes = judgeHoles(scene, state);
  std::vector<Verdict> fails(state.segmentCount);
  const double more = 1 + kSumNoise, less = 1 - kSumNoise;
  for (const auto& [where, share] : shares) {
    const auto& [loop, s] = where;
    const auto& [uncovered, explained] = holes[loop];
    const auto isMeant = [](double bare, double hidden, double itsExposed, double itsCovered, bool isExplained,
                            double allBare, double allCovered) {
      return itsCovered < kSmall * allCovered &&
             (hidden > kHidden * (itsExposed + hidden) ||
              (!isExplained && bare > kBare * itsExposed && bare >= kMuchOfHole * allBare));
    };
    // Where nothing of it is covered, nothing of it counts as hidden.
    const auto& [bare, found] = share;
    const Range hidden{covered[s].is > 0 ? found.is : 0, covered[s].least > 0 ? found.least : 0,
                       covered[s].most > 0 ? found.most : 0};
    Verdict& fail = fails[s];
    fail.is = fail.is || isMeant(bare.is, hidden.is, exposed[s].is, covered[s].is, explained.is, uncovered.is, all.is);
    fail.might =
        fail.might || isMeant(bare.most * more, hidden.most * more, exposed[s].least * less, covered[s].least * less,
                              explained.must, uncovered.least * less, all.most * more);
    fail.must = fail.must || isMeant(bare.least * less, hidden.least * less, exposed[s].most * more,
                                     covered[s].most * more, explained.might, uncovered.most * more, all.least * less);
  }
  for (std::uint32_t s = 0; s < state.segmentCount; ++s) {
    Verdict& pass = state.passes[s];
    if (fails[s].might != fails[s].must && pass.might) result.firmAreas[s] = 0;
    pass = {pass.is && !fails[s].is, pass.might && !fails[s].must, pass.must && !fails[s].might};
    CulledBy& culledBy = result.segmentStats[s].culledBy;
    if (culledBy == CulledBy::none && !pass.is) culledBy = CulledBy::hole;
  }
}

/// Step 7: the uncovered points whose hole is not meant for them: those that lie under the cage, hardly beside it, or
/// beside a hole that something else explains.
std::vector<Verdict> underHoles(const Scene& scene, const State& state) {
  constexpr double kOverhang = 0.005, kOverhangOfLoop = 0.05, kExplainedOverhang = 0.03;
  constexpr double kUnsure = 1e-7;  // An overhang this near to its limit may as well be on its other side.
  const std::vector<Hole> holes = judgeHoles(scene, state);
  std::vector<Verdict> result;
  for (std::size_t p = 0; p < state.loops.size(); ++p) {
    if (state.loops[p] < 0) {
      result.push_back({true, true, true});
      continue;
    }
    const auto loop = static_cast<std::size_t>(state.loops[p]);
    const Vec n = state.places[p].triangle->normal, offset = scene.points.positions[p] - state.places[p].position();
    const double overhang = length(offset - n * dot(offset, n));
    const double little = std::min(kOverhang * scene.diag, kOverhangOfLoop * scene.loops.loops[loop].box.diagonal());
    const auto allowed = [&](double h, bool isExplained) {
      return h <= little || (isExplained && h <= kExplainedOverhang * scene.diag);
    };
    const double unsure = kUnsure * scene.diag;
    result.push_back({allowed(overhang, holes[loop].explained.is),
                      allowed(overhang - unsure, holes[loop].explained.might),
                      allowed(overhang + unsure, holes[loop].explained.must)});
  }
  return result;
}

/// The zones (as bits) that a point might end up in, given one of those it might have been found in.
unsigned outcomes(Zone found, const Verdict& passes, const Verdict& seen, const Verdict& underHole) {
  unsigned zones = 0;
  if (!passes.must) zones |= bit(found == Zone::cosmetic ? Zone::culled : found);
  if (!passes.might) return zones;
  const Verdict always{true, true, true};
  const Verdict& recovered = found == Zone::occluded ? seen : found == Zone::uncovered ? underHole : always;
  if (recovered.might) zones |= bit(Zone::cosmetic);
  if (!recovered.must) zones |= bit(found);
  return zones;
}

// --------------------------------------------------------------------------------------------------------- The
// baseline

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

// ---------------------------------------------------------------------------------------------------------- Steps 1 to
// 3

/// A scene with what steps 1 to 3 find in it. They take most of the time and depend on few of the options, so that
/// tests of many options on one scene take them once.
class LastScene {
 public:
  LastScene(const MeshView& cage, const MeshView& target, const Options& options)
      : scene(makeScene(cage, target, options)), key_(keyOf(cage, target, options)) {}
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
    std::vector<Finding>& found = findings_[{options.endOfSelfRay, options.occlusionReach, options.pokes,
                                             options.pokeThrough, options.stability}];
    for (std::size_t p = found.size(); p < scene.points.count(); ++p) {
      const ClosestPoint& place = places()[p];
      const Sight sight = look(scene, options, scene.points.positions[p], place, [&](std::size_t t) {
        return std::find(scene.corners[t].begin(), scene.corners[t].end(), p) != scene.corners[t].end();
      });
      found.push_back(judge(scene, options, sight, place));
    }
    return found;
  }

  const Scene scene;

 private:
  /// Everything that `makeScene` reads.
  using Key = std::tuple<std::vector<float>, std::vector<std::uint32_t>, std::vector<float>, std::vector<std::uint32_t>,
                         std::vector<std::uint32_t>, double, bool>;
  static Key keyOf(const MeshView& cage, const MeshView& target, const Options& options) {
    return {{cage.positions.begin(), cage.positions.end()},
            {cage.indices.begin(), cage.indices.end()},
            {target.positions.begin(), target.positions.end()},
            {target.indices.begin(), target.indices.end()},
            {target.groups.begin(), target.groups.end()},
            options.weldTolerance,
            options.groups};
  }

  const Key key_;
  std::vector<ClosestPoint> places_;
  std::vector<std::int32_t> loops_;
  std::map<std::tuple<bool, double, bool, double, bool>, std::vector<Finding>> findings_;
};

LastScene& lastScene(const MeshView& cage, const MeshView& target, const Options& options) {
  static std::unique_ptr<LastScene> last;
  if (!last || !last->is(cage, target, options)) last = std::make_unique<LastScene>(cage, target, options);
  return *last;
}

}  // namespace

Options Options::paper() { return {}; }

Options Options::standard() {
  Options options;
  options.endOfSelfRay = options.pokes = options.interiorSamples = options.farLoops = true;
  options.floor = Floor::depth;
  options.depthWeighting = options.twins = options.holeContents = true;
  options.recheck = options.bothSides = options.exposedSide = true;
  options.holes = options.partialTriangles = options.seams = true;
  return options;
}

Options Options::earlier() {
  Options options = standard();
  options.floor = Floor::area;
  options.depthWeighting = options.twins = options.holeContents = false;
  options.bothSides = options.farLoops = options.exposedSide = false;
  return options;
}

Result transfer(const MeshView& cage, const MeshView& target, const Options& options) {
  const bool filtered = options.projection == ProjectionMode::nearestPoint;
  LastScene& last = lastScene(cage, target, options);
  const Scene& scene = last.scene;
  const std::size_t pointCount = scene.points.count(), vertexCount = target.positions.size() / 3;

  State state;
  state.places.resize(pointCount);
  state.findings.resize(pointCount);
  state.loops.assign(pointCount, -1);
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
  result.segmentStats.resize(state.segmentCount);
  result.firmAreas.assign(state.segmentCount, 1);
  for (std::size_t p = 0; p < pointCount; ++p) {
    ++result.segmentStats[state.segments[p]].points;
    result.segmentStats[state.segments[p]].area += state.areas[p];
  }
  if (filtered) {
    const std::vector<Sample> samples = findInteriorSamples(scene, options, state);
    for (const Sample& sample : samples)
      if (!single(sample.finding.nearby)) result.firmAreas[sample.segment] = 0;
    decide(scene, options, samples, state, result.segmentStats);
    if (options.holes && options.holeContents) cullHoleContents(scene, samples, state, result);
  } else {
    state.passes.assign(state.segmentCount, {true, true, true});
    double all = 0;
    for (const SegmentStats& stats : result.segmentStats) all += stats.area;
    for (std::uint32_t s = 0; s < state.segmentCount; ++s) {
      SegmentStats& stats = result.segmentStats[s];
      stats.exposedArea = stats.coveredArea = stats.depthWeightedArea = stats.area;
      stats.twinOf = s;
      stats.score = scoreOf(options, {stats.area, stats.area, stats.area, stats.area, 1}, all);
    }
  }
  std::vector<Verdict> seen(pointCount), underHole(pointCount);
  if (filtered && options.recheck) seen = recheck(scene, options, state);
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
  options.projection = library.steps.projection;
  options.threshold = static_cast<double>(library.threshold);
  options.weldTolerance = static_cast<double>(library.weldTolerance);
  options.endOfSelfRay = std::isfinite(library.occlusionReach);
  options.occlusionReach = static_cast<double>(library.occlusionReach);
  options.pokes = library.pokeThrough > 0;
  options.pokeThrough = static_cast<double>(library.pokeThrough);
  options.interiorSamples = library.steps.interiorSamples;
  options.farLoops = library.steps.farLoops;
  options.floor = library.steps.floor;
  options.minCovered = static_cast<double>(library.minCovered);
  options.minOfAll = static_cast<double>(library.steps.minOfAll);
  options.maxUncovered = static_cast<double>(library.steps.maxUncovered);
  options.depthWeighting = library.steps.depthWeighting;
  options.twins = library.steps.twins;
  options.holeContents = library.steps.holeContents;
  options.recheck = library.steps.recheck;
  options.bothSides = library.steps.bothSides;
  options.exposedSide = library.steps.exposedSide;
  options.holes = library.steps.holes;
  options.partialTriangles = library.steps.partialTriangles;
  options.seams = library.seams == Seams::corner;
  return transfer(cage, target, options);
}

}  // namespace cagecast::reference
