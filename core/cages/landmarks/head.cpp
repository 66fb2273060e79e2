#include "landmarks/head.hpp"
#include "landmarks/landmark_list.hpp"
#include "mesh/samples.hpp"

#include <algorithm>
#include <cmath>

namespace cagecast::cages {

namespace {

// Shares of a head's own length, which is about the diagonal of the box around head and neck.
constexpr double kEyeDistance = 0.16;
/// Eyes that are no parts with a name may be teeth or buttons: how far apart they may be, in shares of what the head
/// suggests.
constexpr double kNearest = 0.55, kFarthest = 1.7;
/// Eyes with a name may be far apart, as a crab's. The head is at least 1 / kFarthestNamed as long as their distance
/// suggests: that bounds the measuring around an eye, whose steps are shares of that length.
constexpr double kFarthestNamed = 4;
/// Wheels mirror each other, too, but are not in the upper half of a model.
constexpr double kLowestEyes = 0.38;
/// How much of a figure around the eyes belongs to the head, in the head's lengths.
constexpr double kHeadReach = 1.1;

double median3(double a, double b, double c) { return std::max(std::min(a, b), std::min(std::max(a, b), c)); }

/// The length of a head, from the distance of its eyes and from where its skin ends above and behind them.
double headLength(const TriangleMesh& skin, double eyeDistance, const HeadFrame& guess) {
  const double byEyes = eyeDistance / kEyeDistance;
  const Surface surface(guess.toLocal(within(skin, guess.origin, kHeadReach * guess.unit)));
  const HeightMap top = heightMapOf(surface, kTopView, Grid::over(-0.05, 0.05, -0.35, 0, 0.025), 1.5);
  const HeightMap back = heightMapOf(surface, kBackView, Grid::over(-0.05, 0.05, 0, 0.2, 0.025), 1.5);
  const double high = *std::max_element(top.heights.begin(), top.heights.end());
  const double rear = *std::max_element(back.heights.begin(), back.heights.end());
  const double byCrown = std::isfinite(high) ? high * guess.unit / kEyesToCrown : byEyes;
  const double byBack = std::isfinite(rear) ? rear * guess.unit / kEyesToBack : byEyes;
  return std::max(median3(byEyes, byCrown, byBack), byEyes / kFarthestNamed);
}

/// How high the eyes are: 0 at the model's lowest place, 1 at its highest.
double heightShare(const Figure& figure, const Eyes& eyes) {
  const auto [low, high] = std::minmax_element(figure.mesh.positions.begin(), figure.mesh.positions.end(),
                                               [](const Vec3& a, const Vec3& b) { return a.y < b.y; });
  return (eyes.middle().y - low->y) / (high->y - low->y);
}

bool belongsToEye(const Eyes& eyes, std::size_t triangle) {
  return !eyes.triangles.empty() && eyes.triangles[triangle];
}

/// Components that only the front sees: teeth and tongues, which are no part of the skin if the mouth is open.
std::vector<bool> insideMouth(const Figure& figure, const Eyes& eyes) {
  constexpr double kSmall = 0.1;  ///< Share of the figure's triangles.
  constexpr std::size_t kPartSamples = 24;
  const std::vector<TriangleMesh> parts = split(figure.mesh, figure.components, figure.componentCount);
  const Surface surface(figure.mesh);
  const double clear = 1e-4 * diagonalOf(figure.mesh);
  const Vec3 up{0, 1, 0};
  std::vector<bool> out(figure.componentCount);
  for (std::size_t c = 0; c < parts.size(); ++c) {
    const auto size = static_cast<double>(parts[c].triangles.size());
    if (size > kSmall * static_cast<double>(figure.components.size())) continue;
    std::vector<SurfaceRay> rays;
    for (const Vec3& p : spreadPoints(parts[c], kPartSamples))
      for (const Vec3& direction : {eyes.left, -1 * eyes.left, up, -1 * eyes.front})
        rays.push_back({p + clear * direction, direction});
    const std::vector<double> free = surface.distances(rays);
    out[c] = std::none_of(free.begin(), free.end(), [](double distance) { return std::isinf(distance); });
  }
  return out;
}

/// Hints in the space of a head, named by the side that they are on.
std::vector<Spot> localHints(const std::vector<Landmark>& hints, const HeadFrame& frame) {
  std::vector<Spot> out;
  for (const Landmark& hint : hints) {
    const Vec3 place = frame.toLocal(positionOf(hint));
    const bool isLeft = place.x > 0, isCalledLeft = hint.name.ends_with("_left");
    const std::string mirror = mirrorName(hint.name);
    out.push_back({mirror.empty() || isLeft == isCalledLeft ? hint.name : mirror, place, 0.85});
  }
  return out;
}

/// The corners of lids by hints: on the skin, or, where there is none, beside the balls' front halves.
void addHintedEyeCorners(Head& head) {
  constexpr double kBehind = 0.55;  ///< Behind what lids pass over, in radii.
  for (const char* name : {"eye_inner_left", "eye_outer_left", "eye_inner_right", "eye_outer_right"}) {
    const Spot* hint = head.hint(name);
    if (hint == nullptr) continue;
    Vec3 place = hint->position;
    const SurfaceRay ray{{place.x, place.y, 0.6}, {0, 0, -1}};
    const double skin = ray.origin.z - head.surface.distance(ray);
    const bool isSkin = std::abs(skin - place.z) < 2 * head.eyes.radius;
    place.z = isSkin ? skin : place.z - kBehind * head.eyes.radius;
    head.add(name, place, hint->confidence);
  }
}

/// What hints alone say of a mouth.
void addHintedMouth(Head& head) {
  constexpr double kLip = 0.015;  ///< Half the height of both lips.
  const Spot* mouth = head.hint("mouth");
  if (mouth == nullptr) return;
  head.add("lip_upper", mouth->position + Vec3{0, kLip, 0}, mouth->confidence);
  head.add("lip_lower", mouth->position - Vec3{0, kLip, 0}, mouth->confidence);
  for (const char* name : {"mouth_corner_left", "mouth_corner_right"})
    if (const Spot* corner = head.hint(name)) head.add(name, corner->position, corner->confidence);
}

/// Looks for another mouth where a crease on the midline ends at once, as those under a nose and above a chin do: one
/// that has corners.
void preferLongCrease(Head& head) {
  constexpr int kTries = 3;
  const auto hasCorners = [&] { return head.find("mouth_corner_left") != nullptr; };
  if (!head.mouth || head.hint("mouth") != nullptr || hasCorners()) return;
  const std::vector<Spot> spots = head.spots;
  const std::optional<MouthLine> mouth = head.mouth;
  std::vector<double> tried;
  for (int i = 0; i < kTries && head.mouth && !hasCorners(); ++i) {
    tried.push_back(head.mouth->crease);
    std::erase_if(head.spots, [](const Spot& spot) { return !spot.name.starts_with("eye_"); });
    head.mouth.reset();
    (void)findProfile(head, tried);
    findMouthCorners(head);
  }
  if (hasCorners()) return;
  head.spots = spots;
  head.mouth = mouth;
}

}  // namespace

std::optional<Head> makeHead(const Figure& figure, const Eyes& eyes, const std::vector<Landmark>& hints) {
  const double eyeDistance = length(eyes.centres[0] - eyes.centres[1]);
  HeadFrame frame;
  frame.unit = eyeDistance / kEyeDistance;
  frame.origin = eyes.middle();
  const bool loose = figure.componentCount > 1 && figure.componentCount < 1000 && !figure.has(Role::mouth);
  const std::vector<bool> hidden = loose ? insideMouth(figure, eyes) : std::vector<bool>(figure.componentCount);
  std::vector<bool> isSkin(figure.roles.size());
  for (std::size_t t = 0; t < isSkin.size(); ++t)
    isSkin[t] = figure.roles[t] == Role::surface && !belongsToEye(eyes, t) && !hidden[figure.components[t]];
  const TriangleMesh skin = subset(figure.mesh, isSkin);
  // The eyes' own line is the mirror's first guess.
  MirrorPlane plane;
  plane.left = eyes.left;
  plane.offset = dot(plane.left, frame.origin);
  const TriangleMesh near = within(skin, frame.origin + (-0.15 * frame.unit) * eyes.front, 0.45 * frame.unit);
  if (near.empty()) return std::nullopt;
  const MirrorPlane better = refineMirrorPlane(near, plane);
  if (dot(better.left, plane.left) > 0.97 && std::abs(better.offset - plane.offset) < 0.03 * frame.unit) plane = better;
  frame.left = plane.left;
  frame.front = cross(frame.left, frame.up);
  frame.origin = frame.origin + (plane.offset - dot(plane.left, frame.origin)) * plane.left;
  frame.unit = headLength(skin, eyeDistance, frame);
  const double share = eyeDistance / (kEyeDistance * frame.unit);
  const bool isNamed = eyes.isNamed || figure.has(Role::eye);
  if (!isNamed && (share < kNearest || share > kFarthest || heightShare(figure, eyes) < kLowestEyes))
    return std::nullopt;

  TriangleMesh local = frame.toLocal(within(skin, frame.origin, kHeadReach * frame.unit));
  if (local.empty()) return std::nullopt;
  Surface surface(local);
  Eyes inside = eyes;
  for (Vec3& centre : inside.centres) centre = frame.toLocal(centre);
  inside.radius = eyes.radius / frame.unit;
  return Head{frame, std::move(local), std::move(surface), std::move(inside), localHints(hints, frame)};
}

void findHeadLandmarks(const Figure& figure, const Eyes& eyes, Head& head) {
  head.add("eye_centre_left", head.eyes.centres[0], eyes.confidence);
  head.add("eye_centre_right", head.eyes.centres[1], eyes.confidence);
  if (!eyes.triangles.empty()) {
    TriangleMesh face{figure.mesh.positions, {}};
    std::vector<bool> isEye;
    for (std::size_t t = 0; t < figure.roles.size(); ++t) {
      const bool eye = belongsToEye(eyes, t);
      const Triangle3& triangle = figure.mesh.triangles[t];
      if (!eye && figure.roles[t] != Role::surface) continue;
      if (length(figure.mesh.positions[triangle[0]] - head.frame.origin) > 0.5 * head.frame.unit) continue;
      face.triangles.push_back(triangle);
      isEye.push_back(eye);
    }
    if (!face.empty()) findEyeCorners(head, Surface(head.frame.toLocal(std::move(face))), isEye);
  }
  if (head.find("eye_inner_left") == nullptr || head.find("eye_inner_right") == nullptr) {
    std::erase_if(head.spots, [](const Spot& spot) { return !spot.name.starts_with("eye_centre"); });
    addHintedEyeCorners(head);
  }
  if (!findProfile(head)) return addHintedMouth(head);
  // A human face's landmarks mean nothing on a muzzle.
  constexpr double kSnout = 0.2;  ///< Human noses end at 0.1 to 0.14 before the eyes' centres.
  if (const Spot* nose = head.find("nose_tip"); nose != nullptr && nose->position.z > kSnout) {
    std::erase_if(head.spots,
                  [](const Spot& spot) { return spot.name != "nose_tip" && !spot.name.starts_with("eye_centre"); });
    return addHintedMouth(head);
  }
  findMouthCorners(head);
  preferLongCrease(head);
  findEars(head);
  findSkull(head);
}

}  // namespace cagecast::cages
