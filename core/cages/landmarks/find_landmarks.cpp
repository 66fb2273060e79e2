#include <algorithm>
#include <cmath>
#include <set>

#include "landmarks/head.hpp"
#include "landmarks/rig.hpp"
#include "mesh/check_model.hpp"

namespace cagecast::cages {

namespace {

/// Landmarks of a face that are looked for: the single ones, and those that come in pairs.
constexpr const char* kSingle[] = {"nose_tip", "nasion", "glabella",  "forehead",  "crown", "occiput",
                                   "nape",     "chin",   "lip_upper", "lip_lower", "menton"};
constexpr const char* kPaired[] = {"eye_centre", "eye_inner", "eye_outer",   "ear_top",
                                   "ear_lobe",   "ear_outer", "mouth_corner"};
/// Less sure ones are left out, and asked for.
constexpr double kSure = 0.5;

// Shares of a head's own length, which is about the diagonal of the box around head and neck.
constexpr double kEyeDistance = 0.16;
constexpr double kEyesToCrown = 0.29;
constexpr double kEyesToBack = 0.43;

/// How much of a figure around the eyes belongs to the head, in the head's lengths.
constexpr double kHeadReach = 1.1;

/// The figure's eyes in the space of its head.
Eyes inFrame(const Eyes& eyes, const HeadFrame& frame) {
  Eyes out = eyes;
  for (Vec3& centre : out.centres) centre = frame.toLocal(centre);
  out.radius = eyes.radius / frame.unit;
  return out;
}

double median3(double a, double b, double c) { return std::max(std::min(a, b), std::min(std::max(a, b), c)); }

/// The length of a head, from the distance of its eyes and from where its skin ends above and behind them.
double headLength(const TriangleMesh& skin, const Eyes& eyes, const HeadFrame& guess) {
  const double byEyes = length(eyes.centres[0] - eyes.centres[1]) / kEyeDistance;
  const Surface surface(guess.toLocal(within(skin, guess.origin, kHeadReach * guess.unit)));
  const HeightMap top = look(surface, kTopView, Grid::over(-0.05, 0.05, -0.35, 0, 0.025), 1.5);
  const HeightMap back = look(surface, kBackView, Grid::over(-0.05, 0.05, 0, 0.2, 0.025), 1.5);
  const double high = *std::max_element(top.heights.begin(), top.heights.end());
  const double rear = *std::max_element(back.heights.begin(), back.heights.end());
  const double byCrown = std::isfinite(high) ? high * guess.unit / kEyesToCrown : byEyes;
  const double byBack = std::isfinite(rear) ? rear * guess.unit / kEyesToBack : byEyes;
  return median3(byEyes, byCrown, byBack);
}

/// All landmarks of a head whose eyes are known.
void findFace(const Figure& figure, const Eyes& found, FoundLandmarks& out) {
  Eyes eyes = found;
  HeadFrame frame;
  frame.unit = length(eyes.centres[0] - eyes.centres[1]) / kEyeDistance;
  frame.origin = eyes.middle();
  std::vector<bool> isSkin(figure.roles.size()), isFace(figure.roles.size());
  for (std::size_t t = 0; t < isSkin.size(); ++t) {
    const bool eye = !eyes.triangles.empty() && eyes.triangles[t];
    isSkin[t] = figure.roles[t] == Role::surface && !eye;
    isFace[t] = isSkin[t] || eye;
  }
  const TriangleMesh skin = subset(figure.mesh, isSkin);
  // The eyes' own line is the mirror's first guess.
  MirrorPlane plane;
  plane.left = eyes.left;
  plane.offset = dot(plane.left, frame.origin);
  const TriangleMesh near = within(skin, frame.origin + (-0.15 * frame.unit) * eyes.front, 0.45 * frame.unit);
  const MirrorPlane better = refineMirrorPlane(near, plane);
  if (dot(better.left, plane.left) > 0.97 && std::abs(better.offset - plane.offset) < 0.03 * frame.unit) plane = better;
  frame.left = plane.left;
  frame.front = cross(frame.left, frame.up);
  frame.origin = frame.origin + (plane.offset - dot(plane.left, frame.origin)) * plane.left;
  frame.unit = headLength(skin, eyes, frame);

  TriangleMesh local = frame.toLocal(within(skin, frame.origin, kHeadReach * frame.unit));
  Surface surface(local);
  Head head{frame, std::move(local), std::move(surface), inFrame(eyes, frame)};
  head.add("eye_centre_left", head.eyes->centres[0], eyes.confidence);
  head.add("eye_centre_right", head.eyes->centres[1], eyes.confidence);
  if (!eyes.triangles.empty()) {
    TriangleMesh face{figure.mesh.positions, {}};
    std::vector<bool> isEye;
    for (std::size_t t = 0; t < isFace.size(); ++t) {
      if (!isFace[t]) continue;
      const Triangle3& triangle = figure.mesh.triangles[t];
      if (length(figure.mesh.positions[triangle[0]] - frame.origin) > 0.5 * frame.unit) continue;
      face.triangles.push_back(triangle);
      isEye.push_back(!isSkin[t]);
    }
    findEyeCorners(head, Surface(frame.toLocal(std::move(face))), isEye);
  }
  if (findProfile(head)) {
    findMouthCorners(head);
    findEars(head);
    findSkull(head);
  }
  for (const Spot& spot : head.spots)
    if (spot.confidence >= kSure)
      out.landmarks.push_back(
          {spot.name, toPosition(frame.toModel(spot.position)), static_cast<float>(spot.confidence)});
}

std::vector<std::string> faceLandmarks() {
  std::vector<std::string> out(std::begin(kSingle), std::end(kSingle));
  for (const char* name : kPaired)
    for (const char* side : {"_left", "_right"}) out.push_back(std::string(name) + side);
  return out;
}

}  // namespace

Outcome findLandmarks(const Model& model, const Progress& progress, FoundLandmarks& out) {
  out = {};
  if (Outcome outcome = checkModel(model); !outcome.ok()) return outcome;
  const auto goOn = [&](float share) { return !progress || progress(share, "landmarks"); };
  const Outcome cancelled{Problem::cancelled, "Cancelled."};
  if (!goOn(0)) return cancelled;
  const Figure figure = readFigure(model);
  Rig rig = recogniseRig(model.joints);
  out.rig = rig.name;
  std::optional<Eyes> eyes = findNamedEyes(figure);
  if (!eyes)
    for (const MirrorPlane& plane : findMirrorPlanes(figure.mesh))
      if ((eyes = findLooseEyes(figure, plane))) break;
  if (!goOn(0.4f)) return cancelled;
  if (eyes) findFace(figure, *eyes, out);
  const double share = eyes ? length(eyes->centres[0] - eyes->centres[1]) / diagonalOf(figure.mesh) : 0;
  // A head's eyes are an eighth to a fourth of its diagonal apart, a figure's a thirtieth.
  constexpr double kHeadShare = 0.07;
  out.kind = rig.find("joint_hips") != nullptr ? Kind::body
             : share > kHeadShare              ? Kind::head
             : eyes                            ? Kind::body
                                               : Kind::prop;
  out.landmarks.insert(out.landmarks.end(), rig.joints.begin(), rig.joints.end());
  std::set<std::string> have;
  for (const Landmark& landmark : out.landmarks) have.insert(landmark.name);
  for (const std::string& name : faceLandmarks())
    if (have.find(name) == have.end()) out.missing.push_back(name);
  if (out.kind == Kind::body)
    for (const std::string& name : jointLandmarks())
      if (have.find(name) == have.end()) out.missing.push_back(name);
  return goOn(1) ? Outcome{} : cancelled;
}

}  // namespace cagecast::cages
