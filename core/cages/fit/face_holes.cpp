#include <algorithm>
#include <optional>

#include "fit/steps.hpp"

/// Where the holes of a face belong by its landmarks alone: what a hull or a beard says bends the rest.
namespace cagecast::cages {

namespace {

/// Parts of a face that hardly move against each other, by the beginnings of their landmarks' names.
constexpr const char* kFace[] = {"eye_", "nose_tip", "nasion", "glabella", "lip_", "mouth_corner", "chin"};

/// The landmarks at each of three holes.
std::vector<std::string> landmarksAt(std::size_t hole) {
  if (hole == 2) return {"lip_upper", "lip_lower", "mouth_corner_left", "mouth_corner_right"};
  const std::string side = hole == 0 ? "left" : "right";
  return {"eye_centre_" + side, "eye_inner_" + side, "eye_outer_" + side};
}

/// Axes whose pitch is that of a direction, if this is about their own: few landmarks say little about it.
Axes upright(Axes axes, const Vec3& up) {
  constexpr double kAbout = 0.8;  ///< The cosine of 37 degrees.
  const Vec3 better = unit(up - dot(up, axes.left) * axes.left);
  if (dot(better, axes.up) < kAbout) return axes;
  axes.up = better;
  axes.front = cross(axes.left, better);
  return axes;
}

}  // namespace

bool isOfFace(const std::string& name) {
  return std::any_of(std::begin(kFace), std::end(kFace), [&](const char* begin) { return name.starts_with(begin); });
}

Face faceOf(const std::vector<Landmark>& from, const std::vector<Landmark>& to, const Axes& axes, const Vec3& up) {
  Face face;
  std::vector<Vec3> a, b;
  bool isDeep = false;  // Whether landmarks before and behind the eyes say how the head is pitched.
  for (std::size_t i = 0; i < from.size(); ++i) {
    const std::string& name = from[i].name;
    isDeep = isDeep || name.starts_with("ear_") || name == "occiput" || name == "nape";
    if (!isOfFace(name)) continue;
    a.push_back(positionOf(from[i]));
    b.push_back(positionOf(to[i]));
  }
  face.known = axes.known && a.size() >= 3;
  if (!face.known) return face;
  face.map = fitSimilarity(a, b);
  face.own = upright(axes, {0, 1, 0});
  face.there.left = unit(face.map.turned(face.own.left));
  face.there.up = unit(face.map.turned(face.own.up));
  face.there.front = cross(face.there.left, face.there.up);
  if (!isDeep) face.there = upright(face.there, up);
  return face;
}

std::vector<bool> contradicted(const std::vector<bool>& given, const std::vector<std::optional<Vec3>>& found,
                               const Face& face, const std::vector<Landmark>& to) {
  constexpr double kFar = 0.1;  ///< In distances of the eyes.
  std::vector<bool> out(to.size());
  const auto left = placeOf(to, "eye_centre_left"), right = placeOf(to, "eye_centre_right");
  if (!face.known || !left || !right) return out;
  for (std::size_t hole = 0; hole < 3; ++hole) {
    const std::vector<std::string> names = landmarksAt(hole);
    bool isElsewhere = false;
    std::vector<std::size_t> others;
    for (std::size_t i = 0; i < to.size(); ++i) {
      if (std::find(names.begin(), names.end(), to[i].name) == names.end()) continue;
      if (!given[i]) others.push_back(i);
      const double off = found[i] ? length(face.fromFront(positionOf(to[i]) - *found[i])) : 0;
      isElsewhere = isElsewhere || off > kFar * length(*left - *right);
    }
    for (const std::size_t i : others) out[i] = isElsewhere;
  }
  return out;
}

int holeAt(const TemplateCage& cage, const Vec3& centre, const Vec3& other) {
  constexpr double kNear = 0.8;  ///< At most, as a share of the distance of both.
  int best = -1;
  double least = kNear * length(centre - other);
  for (std::size_t i = 0; i < cage.loops.size(); ++i) {
    if (static_cast<int>(i) == cage.rim) continue;
    const Vec3 middle = middleOf(cage.mesh, cage.loops[i]);
    const double distance = length(middle - centre);
    if (distance >= least || distance >= length(middle - other)) continue;
    least = distance;
    best = static_cast<int>(i);
  }
  return best;
}

std::vector<FaceHole> faceHoles(const TemplateCage& cage, const std::vector<Vec3>& start, const LandmarkPairs& pairs,
                                const Face& face) {
  const auto& [from, to, given] = pairs;
  std::vector<FaceHole> out;
  const auto eyes = eyePairs(from, to);
  if (!face.known || eyes.empty()) return out;
  for (std::size_t hole = 0; hole < 3; ++hole) {
    std::vector<std::size_t> known;
    bool isGiven = false;
    for (const std::string& name : landmarksAt(hole))
      for (std::size_t i = 0; i < from.size(); ++i)
        if (from[i].name == name) {
          known.push_back(i);
          isGiven = isGiven || given[i];
        }
    // The centre of an eye is deep inside: both corners say more.
    if (hole < 2 && known.size() == 3) known.erase(known.begin());
    if (known.empty()) continue;
    std::vector<Vec3> own, there;
    for (const std::size_t i : known) {
      own.push_back(positionOf(from[i]));
      there.push_back(positionOf(to[i]));
    }
    const Vec3 middle = meanOf(own);
    const Vec3 other = hole == 2 ? 0.5 * (eyes[0].from + eyes[1].from) : eyes[1 - hole].from;
    const int loop = holeAt(cage, middle, other);
    if (loop < 0) continue;
    const std::vector<std::uint32_t>& border = cage.loops[static_cast<std::size_t>(loop)];
    const Vec3 place =
        isGiven ? meanOf(there) + face.carried(middleOf(cage.mesh, border) - middle) : middleOf({start, {}}, border);
    out.push_back({border, place, isGiven, hole == 2});
  }
  return out;
}

Vec3 missOf(const FaceHole& hole, const Face& face, const std::vector<Vec3>& positions) {
  return face.fromFront(hole.place - middleOf({positions, {}}, hole.loop));
}

}  // namespace cagecast::cages
