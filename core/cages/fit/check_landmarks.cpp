#include "fit/steps.hpp"

#include <algorithm>
#include <cmath>

#include "mesh/limits.hpp"

namespace cagecast::cages {

namespace {

/// A landmark of a model is at most this far outside its box, in diagonals.
constexpr double kMaxOutside = 0.2;
/// The farthest is a mistake if the residual without it is at most this share of that of all. Several are if it is at
/// most this share without them: shapes may differ, such as an animal's head from a person's.
constexpr double kRestOfOne = 0.5, kRestOfSeveral = 0.25;
/// Nothing fits if the residual of all is more than this share of the diagonal.
constexpr double kMaxApart = 0.2;
/// Two that are off by more than this share of the diagonal together may have been exchanged.
constexpr double kClearlyOff = 0.05;

Status fault(Code code, Argument argument, std::size_t at, double value = 0) {
  return {code, argument, static_cast<std::uint32_t>(at), Option::none, static_cast<float>(value)};
}

/// The first given landmark that has changed places with its mirror image, seen from the others; `kNone` if there is
/// none. Without other pairs nothing says which side is which, and a figure with joints may have crossed its arms.
std::size_t exchangedPair(const std::vector<Landmark>& from, const std::vector<Landmark>& to,
                          const std::vector<bool>& given, double diagonal) {
  std::vector<std::size_t> mirror(from.size());
  std::size_t sides = 0;
  for (std::size_t i = 0; i < from.size(); ++i) {
    if (isJoint(from[i].name)) return kNone;
    const std::string name = mirrorName(from[i].name);
    mirror[i] = i;
    for (std::size_t j = 0; j < from.size(); ++j)
      if (from[j].name == name) mirror[i] = j;
    if (mirror[i] != i) ++sides;
  }
  if (sides < 4) return kNone;
  for (std::size_t i = 0; i < from.size(); ++i) {
    const std::size_t j = mirror[i];
    if (j == i || !given[i]) continue;
    std::vector<Vec3> a, b;
    for (std::size_t k = 0; k < from.size(); ++k) {
      if (k == i || k == j) continue;
      a.push_back(positionOf(from[k]));
      b.push_back(positionOf(to[k]));
    }
    if (a.size() < 3) continue;
    const Similarity map = fitSimilarity(a, b);
    const Vec3 one = map.inverse(positionOf(to[i])), other = map.inverse(positionOf(to[j]));
    const double straight = length(one - positionOf(from[i])) + length(other - positionOf(from[j]));
    const double crossed = length(one - positionOf(from[j])) + length(other - positionOf(from[i]));
    if (straight > kClearlyOff * diagonal && crossed < 0.5 * straight) return i;
  }
  return kNone;
}

/// How far points are from where others are mapped to, on average.
double residual(const std::vector<Vec3>& from, const std::vector<Vec3>& to) {
  const Similarity map = fitSimilarity(from, to);
  double sum = 0;
  for (std::size_t i = 0; i < from.size(); ++i) sum += length(map.inverse(to[i]) - from[i]);
  return sum / static_cast<double>(from.size());
}

/// Some pairs of landmarks that are no joints.
struct SkinPairs {
  std::vector<std::size_t> places;  ///< In the lists of landmarks.
  std::vector<Vec3> from, to;
};

/// @param counts  Whether each counts; empty for all.
SkinPairs skinPairs(const std::vector<Landmark>& from, const std::vector<Landmark>& to,
                    const std::vector<bool>& counts = {}) {
  SkinPairs out;
  for (std::size_t i = 0; i < from.size(); ++i) {
    if (isJoint(from[i].name) || (!counts.empty() && !counts[i])) continue;
    out.places.push_back(i);
    out.from.push_back(positionOf(from[i]));
    out.to.push_back(positionOf(to[i]));
  }
  return out;
}

/// The first landmark that has a mirror image if left and right seem to be swapped in all of them, because the other
/// names would fit much better; `kNone` otherwise.
std::size_t swappedSides(const SkinPairs& pairs, const std::vector<Landmark>& to, double asGiven, double diagonal) {
  std::vector<Vec3> swapped;
  std::size_t first = kNone;
  for (std::size_t k = 0; k < pairs.places.size(); ++k) {
    const auto other = placeOf(to, mirrorName(to[pairs.places[k]].name));
    if (other && first == kNone) first = pairs.places[k];
    swapped.push_back(other.value_or(pairs.to[k]));
  }
  return first != kNone && asGiven > 0.02 * diagonal && residual(pairs.from, swapped) < 0.5 * asGiven ? first : kNone;
}

/// A point that is not where the others put it.
struct Suspect {
  std::size_t index;
  double off;   ///< How far it is off.
  double rest;  ///< The residual without it and those before it.
};

/// Leaves out the point that is farthest from where the others put it, again and again, until none is off by more than
/// `most`.
/// @return what it has left out.
std::vector<Suspect> leaveOut(std::vector<Vec3> from, std::vector<Vec3> to, double most) {
  std::vector<Suspect> suspects;
  std::vector<std::size_t> left(from.size());
  for (std::size_t i = 0; i < left.size(); ++i) left[i] = i;
  const auto without = [](auto list, std::size_t i) {
    list.erase(list.begin() + static_cast<std::ptrdiff_t>(i));
    return list;
  };
  while (left.size() > 3) {
    std::size_t worst = 0;
    double farthest = 0;
    for (std::size_t i = 0; i < left.size(); ++i) {
      const double off = length(fitSimilarity(without(from, i), without(to, i)).inverse(to[i]) - from[i]);
      if (off <= farthest) continue;
      farthest = off;
      worst = i;
    }
    if (!(farthest > most)) break;
    from = without(from, worst);
    to = without(to, worst);
    suspects.push_back({left[worst], farthest, residual(from, to)});
    left = without(left, worst);
  }
  return suspects;
}

/// The points that are not where the others put them, if these agree much better without them.
std::vector<Suspect> mistakesIn(const SkinPairs& pairs, double diagonal) {
  std::vector<Suspect> suspects = leaveOut(pairs.from, pairs.to, kMaxLandmarkOff * diagonal);
  if (suspects.empty()) return suspects;
  const double all = residual(pairs.from, pairs.to);
  if (suspects.back().rest < kRestOfSeveral * all || all > kMaxApart * diagonal) return suspects;
  suspects.resize(suspects.front().rest < kRestOfOne * all ? 1 : 0);
  return suspects;
}

}  // namespace

Status checkLandmarkList(const std::vector<Landmark>& landmarks, Argument argument, const Bounds& box) {
  if (landmarks.size() > kMaxLandmarks) return fault(Code::tooManyLandmarks, argument, landmarks.size());
  const double size = box.diagonal();
  for (std::size_t i = 0; i < landmarks.size(); ++i) {
    const Landmark& a = landmarks[i];
    const double outside = box.distance(positionOf(a)) / size;
    if (!std::isfinite(outside)) return fault(Code::nonFiniteLandmark, argument, i);
    if (outside > kMaxOutside) return fault(Code::landmarkOutside, argument, i, outside);
    for (std::size_t j = 0; j < i; ++j) {
      const Landmark& b = landmarks[j];
      if (a.name == b.name) return fault(Code::landmarkTwice, argument, i);
      // Joints of a rig may coincide.
      if (!isJoint(a.name) && !isJoint(b.name) && length(positionOf(a) - positionOf(b)) < kOneSpot * size)
        return fault(Code::landmarksOnOneSpot, argument, i);
    }
  }
  return {};
}

Status checkJoints(const std::vector<Landmark>& landmarks, const Bounds& box) {
  std::size_t count = 0;
  Bounds joints;
  for (std::size_t i = 0; i < landmarks.size(); ++i) {
    if (!isJoint(landmarks[i].name)) continue;
    ++count;
    joints.add(positionOf(landmarks[i]));
    const double outside = box.distance(positionOf(landmarks[i])) / box.diagonal();
    if (outside > kMaxJointOutside) return fault(Code::jointOutside, Argument::model, i, outside);
  }
  const double reach = joints.diagonal() / box.diagonal();
  return count > kMinBones && reach < kMinSkeleton ? fault(Code::smallSkeleton, Argument::model, count, reach)
                                                   : Status{};
}

Status checkAgreement(const std::vector<Landmark>& from, const std::vector<Landmark>& to,
                      const std::vector<bool>& given, double diagonal, std::vector<bool>& outvoted) {
  outvoted.assign(from.size(), false);
  const SkinPairs pairs = skinPairs(from, to), own = skinPairs(from, to, given);
  if (pairs.places.size() < 3 || own.places.empty()) return {};
  const double asGiven = residual(pairs.from, pairs.to);
  for (const std::size_t i : {swappedSides(pairs, to, asGiven, diagonal), exchangedPair(from, to, given, diagonal)})
    if (i != kNone) return fault(Code::wrongSide, Argument::landmarks, i);
  const auto isGiven = [&](const Suspect& suspect) { return given[pairs.places[suspect.index]]; };
  const std::vector<Suspect> suspects = mistakesIn(pairs, diagonal), ownSuspects = mistakesIn(own, diagonal);
  if (std::none_of(suspects.begin(), suspects.end(), isGiven)) return {};
  // What was found has no vote against what a person gives.
  if (!ownSuspects.empty())
    return fault(Code::landmarkAway, Argument::landmarks, own.places[ownSuspects.front().index],
                 ownSuspects.front().off / diagonal);
  if (own.places.size() < 3) return {};
  const Similarity map = fitSimilarity(own.from, own.to);
  for (std::size_t k = 0; k < pairs.places.size(); ++k)
    outvoted[pairs.places[k]] =
        !given[pairs.places[k]] && length(map.inverse(pairs.to[k]) - pairs.from[k]) > kMaxLandmarkOff * diagonal;
  return {};
}

}  // namespace cagecast::cages
