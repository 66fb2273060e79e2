#include <algorithm>
#include <cmath>
#include <numeric>

#include "landmarks/head.hpp"
#include "mesh/bounds.hpp"

namespace cagecast::cages {

namespace {

// Lengths are shares of the frame's unit, which is about the diagonal of head and neck.
constexpr double kProfileStep = 0.002;
constexpr double kFine = 0.003;    ///< Blur that keeps lips apart.
constexpr double kMedium = 0.006;  ///< For nose and chin.
constexpr double kFold = 0.012;    ///< Half the width of the folds above and below the lips.

/// The profile as it is being read from the nose downward and upward.
struct Profile {
  const Curve& sharp;
  Curve fine, medium;
  double tilt = 0;  ///< Of the face's front, upward; radians.

  /// How steeply the curve turns upward, relative to the face: 0 faces front, negative faces downward; radians.
  [[nodiscard]] double facing(const Curve& curve, double y, double reach) const {
    return std::atan(-curve.slope(y, reach)) - tilt;
  }
  [[nodiscard]] Vec3 point(double y) const { return {0, y, fine.at(y)}; }
  /// How far a place stands out in the face's own direction.
  [[nodiscard]] double height(const Curve& curve, double y) const {
    return std::cos(tilt) * curve.at(y) + std::sin(tilt) * y;
  }
};

/// From the eyes' height down to where the profile falls back: the front extreme is the tip of the nose.
std::optional<double> noseTip(const Profile& profile) {
  constexpr double kTop = -0.02, kBottom = -0.25;
  constexpr double kFall = 0.012;  ///< By so much the profile falls back under a nose.
  double best = kTop;
  const auto height = [&](double y) { return profile.height(profile.medium, y); };
  for (double y = kTop; y > kBottom; y -= kProfileStep) {
    if (!std::isfinite(height(y))) break;
    if (height(y) > height(best)) best = y;
    if (height(y) < height(best) - kFall) return best;
  }
  return std::nullopt;
}

/// The foremost place between the eyes and a mouth that is known; nothing if the face is flat there.
std::optional<double> noseTipAbove(const Profile& profile, double mouth) {
  constexpr double kLowest = 0.85;  ///< Of the mouth's height: upper lips may be farther in front.
  constexpr double kFlat = 1e-4;    ///< Less is how numbers are rounded.
  const double low = kLowest * mouth;
  const auto tip = profile.medium.highest(low, 0, profile.tilt);
  const auto height = [&](double y) { return profile.height(profile.medium, y); };
  if (!tip || !(*tip > low + 2 * kProfileStep && *tip < -2 * kProfileStep)) return std::nullopt;
  return height(*tip) - std::max(height(low), height(0)) < kFlat ? std::nullopt : tip;
}

/// The hollow between brow and nose; the farthest behind the line from one to the other if there is no hollow.
double nasion(const Profile& profile, double nose, double& confidence) {
  constexpr double kHigh = 0.055, kLow = -0.05;
  const double low = std::max(kLow, nose + 0.03);
  const auto deepest = profile.fine.greatest(low, kHigh, [&](double y) { return -profile.fine.at(y); });
  if (deepest && *deepest > low + 2 * kProfileStep && *deepest < kHigh - 2 * kProfileStep) {
    confidence = 0.85;
    return *deepest;
  }
  const double top = 0.08;
  const Vec3 a = profile.point(top), b = profile.point(nose);
  confidence = 0.55;
  return profile.fine
      .greatest(low, kHigh,
                [&](double y) { return b.z + (a.z - b.z) * (y - nose) / (top - nose) - profile.fine.at(y); })
      .value_or(0);
}

/// The foremost place between the eyebrows, above the nasion.
std::optional<double> glabella(const Profile& profile, double nasionY, double& confidence) {
  constexpr double kReach = 0.12;
  const auto height = [&](double y) { return profile.height(profile.medium, y); };
  double best = nasionY;
  for (double y = nasionY; y < nasionY + kReach; y += kProfileStep) {
    if (height(y) > height(best)) best = y;
    if (height(y) < height(best) - 0.001) break;
  }
  if (best < nasionY + 0.025) return std::nullopt;
  confidence = best < nasionY + kReach - 0.02 ? 0.65 : 0.4;
  return best;
}

/// The first fold of a range, from its top down: of those under the nose and the lower lip, the next may be sharper.
/// Without any, the hollowest place of the upper half.
double firstFold(const Profile& profile, double top, double bottom) {
  constexpr double kMin = 0.0025;  ///< How hollow a fold is.
  const auto hollow = [&](double y) { return profile.fine.hollow(y, kFold); };
  for (double y = top; y > bottom; y -= kProfileStep)
    if (hollow(y) > kMin && hollow(y) >= hollow(y + kProfileStep) && hollow(y) > hollow(y - kProfileStep)) return y;
  return profile.fine.greatest(0.5 * (top + bottom), top, hollow).value_or(0.5 * (top + bottom));
}

/// The first sharp crease of a range below the fold under the nose; the fold above the chin may be deeper, but is
/// wider.
/// @param others  Heights of creases that are no mouth.
std::optional<MouthLine> mouth(const Profile& profile, double subnasale, const Range& range,
                               const std::vector<double>& others = {}) {
  constexpr double kHalfCrease = 0.006;  ///< Half its width.
  constexpr double kMin = 0.0012;        ///< Its depth.
  constexpr double kOpen = 0.02;         ///< Deeper ones are gaps.
  constexpr double kSame = 0.015;        ///< Creases that are closer together are one.
  const auto depth = [&](double y) {
    if (std::any_of(others.begin(), others.end(), [&](double other) { return std::abs(other - y) < kSame; }))
      return 0.0;
    const double value = profile.sharp.hollow(y, kHalfCrease);
    return std::isnan(value) || value > kOpen ? kOpen : value;
  };
  double deepest = 0;
  for (double y = range.high; y > range.low; y -= kProfileStep) deepest = std::max(deepest, depth(y));
  MouthLine out;
  const double enough = std::max(kMin, 0.4 * deepest);
  for (double y = range.high; y > range.low; y -= kProfileStep) {
    if (depth(y) > out.depth) out = {y, y, y, depth(y)};
    if (out.depth > enough && depth(y) < 0.5 * out.depth) break;
  }
  if (out.depth < enough) return std::nullopt;
  // The gap ends where the profile comes out to the level of the lips again, as seen along the face's own front.
  const auto height = [&](double y) {
    return std::isfinite(profile.sharp.at(y)) ? profile.height(profile.sharp, y) : -1.0;
  };
  const double reach = out.depth < kOpen ? 0.03 : 0.09;
  double above = -1, below = -1;
  for (double d = kProfileStep; d <= reach; d += kProfileStep) {
    if (out.top + d < subnasale) above = std::max(above, height(out.top + d));
    below = std::max(below, height(out.bottom - d));
  }
  const double level = 0.5 * out.depth;
  const double end = out.bottom - reach;
  while (out.top < subnasale && height(out.top) < above - level) out.top += kProfileStep;
  while (out.bottom > end && height(out.bottom) < below - level) out.bottom -= kProfileStep;
  return out;
}

/// Puts lips where hints say that they are, at the depth of the profile.
void useHintedLips(Head& head, const Profile& profile) {
  for (Spot& spot : head.spots)
    if (const Spot* hint = spot.name.starts_with("lip_") ? head.hint(spot.name) : nullptr)
      if (const Vec3 place = profile.point(hint->position.y); std::isfinite(place.z)) spot.position = place;
}

constexpr double kClearCrease = 0.003;  ///< Between closed lips.

/// Lips, and the place below the lower lip where the chin begins.
double lips(Head& head, const Profile& profile, double subnasale, const MouthLine& gap) {
  const double clear = gap.depth > kClearCrease ? 0.85 : 0.6;
  if (const auto upper = profile.fine.highest(gap.top - 0.002, std::min(gap.top + 0.03, subnasale), profile.tilt))
    head.add("lip_upper", profile.point(*upper), clear);
  const double lipTop = gap.bottom;
  const auto front = profile.fine.highest(lipTop - 0.035, lipTop + 0.002, profile.tilt);
  const double lip = front.value_or(lipTop);
  const double foldY = firstFold(profile, lip - 0.012, lip - 0.06);
  // The lower lip's red ends where it has turned under, or where it turns most.
  constexpr double kTurned = -0.6;  ///< Radians.
  const auto turn = [&](double y) { return profile.facing(profile.fine, y, 0.004); };
  const double from = lip - 0.008;
  double edge = profile.fine.greatest(foldY, from, [&](double y) { return -turn(y); }).value_or(foldY);
  for (double y = from; y > edge; y -= kProfileStep)
    if (turn(y) < kTurned && turn(y - kProfileStep) < kTurned) edge = y;
  head.add("lip_lower", profile.point(edge), clear - 0.1);
  if (gap.depth <= kClearCrease) useHintedLips(head, profile);
  return foldY;
}

/// The front of the chin: where the profile begins to turn under.
double chin(const Profile& profile, double fold) {
  constexpr double kTurned = -0.38;  ///< Radians: beyond a chin's front, before its underside.
  constexpr double kReach = 0.1;
  for (double y = fold - 0.006; y > fold - kReach; y -= kProfileStep)
    if (profile.facing(profile.medium, y, 0.008) < kTurned && profile.facing(profile.medium, y - 0.01, 0.008) < kTurned)
      return y;
  return profile.medium.highest(fold - 0.05, fold, profile.tilt).value_or(fold - 0.03);
}

/// On the underside of the chin, as far behind its front as most jaws are deep there.
std::optional<Vec3> menton(const Head& head, const Vec3& chin, double noseToChin) {
  constexpr double kDepth = 0.6;  ///< Of the height from nose to chin.
  const double wanted = kDepth * noseToChin;
  const Grid grid = Grid::over(-kProfileStep, kProfileStep, chin.z - 0.2, chin.z + 0.02, kProfileStep);
  const HeightMap map = heightMapOf(head.surface, kBottomView, grid, -(chin.y - 0.11));
  const Curve under = Curve::along(map).blurred(kMedium);
  for (double z = chin.z; z > chin.z - 0.18; z -= kProfileStep) {
    const double y = -under.at(z);
    if (!std::isfinite(y) || y > chin.y + 0.01) continue;
    if (std::hypot(y - chin.y, z - chin.z) >= wanted) return Vec3{0, y, z};
  }
  return std::nullopt;
}

/// Finds nose, root of the nose and brow, and how the face is tilted.
/// @param mouth  Its height, if it is known.
/// @return the height of the nose's tip.
std::optional<double> findNose(Head& head, Profile& profile, const std::optional<double>& mouth) {
  const auto tip = [&] { return mouth ? noseTipAbove(profile, *mouth) : noseTip(profile); };
  auto nose = tip();
  if (!nose) return nose;
  double nasionTrust = 0;
  double nasionY = nasion(profile, *nose, nasionTrust);
  // The front of the face is across the line from nasion to chin. Its own direction finds the nose's tip again.
  for (int round = 0; round < 2; ++round) {
    const auto low = mouth ? profile.medium.highest(*mouth - 0.09, *mouth - 0.04, profile.tilt)
                           : profile.medium.highest(*nose - 0.2, *nose - 0.13, profile.tilt);
    if (!low) break;
    const Vec3 a = profile.point(nasionY), b = profile.point(*low);
    constexpr double kMaxTilt = 0.45;
    const double tilt = std::atan2(b.z - a.z, a.y - b.y);
    if (std::abs(tilt) > kMaxTilt) break;
    profile.tilt = tilt;
    if (const auto again = tip()) nose = again;
    nasionY = nasion(profile, *nose, nasionTrust);
  }
  head.add("nose_tip", profile.point(*nose), 0.9);
  head.add("nasion", profile.point(nasionY), nasionTrust);
  double trust = 0;
  if (const auto brow = glabella(profile, nasionY, trust)) head.add("glabella", profile.point(*brow), trust);
  return nose;
}

}  // namespace

bool findProfile(Head& head, const std::vector<double>& notMouths) {
  constexpr double kNear = 0.01, kFar = 0.13;            ///< Of a mouth, below the fold under the nose.
  constexpr double kKnown = 0.012;                       ///< A mouth that is known is at most this far off.
  constexpr double kMinMouth = -0.04, kMaxMouth = -0.4;  ///< Its height: other hints mean nothing.
  const Grid grid = Grid::over(-2 * kProfileStep, 2 * kProfileStep, -0.5, 0.32, kProfileStep);
  const Curve sharp = Curve::along(heightMapOf(head.surface, kFrontView, grid, 0.6));
  Profile profile{sharp, sharp.blurred(kFine), sharp.blurred(kMedium)};
  std::optional<double> known;
  if (const Spot* hint = head.hint("mouth"))
    if (hint->position.y < kMinMouth && hint->position.y > kMaxMouth) known = hint->position.y;
  const auto nose = findNose(head, profile, known);
  if (!nose && !known) return false;
  double subnasale = nose ? firstFold(profile, *nose - 0.012, *nose - 0.07) : 0;
  if (known) {
    const double lowest = nose ? std::midpoint(*nose, *known) : 0.75 * *known;
    subnasale = nose ? std::max(subnasale, lowest) : lowest;
    const Range about{*known - kKnown, *known + kKnown};
    head.mouth = mouth(profile, subnasale, about).value_or(MouthLine{*known, *known, *known, 0});
  } else {
    head.mouth = mouth(profile, subnasale, {subnasale - kFar, subnasale - kNear}, notMouths);
  }
  if (!head.mouth) return true;
  const double fold = lips(head, profile, subnasale, *head.mouth);
  const double chinY = chin(profile, fold);
  const Vec3 at = profile.point(chinY);
  if (!std::isfinite(at.z)) return true;
  head.add("chin", at, 0.7);
  if (!nose) return true;
  if (const auto bottom = menton(head, at, *nose - chinY)) head.add("menton", *bottom, 0.55);
  return true;
}

}  // namespace cagecast::cages
