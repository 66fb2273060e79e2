#include <algorithm>
#include <numeric>
#include <set>

#include "landmarks/head.hpp"
#include "landmarks/landmark_list.hpp"
#include "landmarks/painted_face.hpp"
#include "mesh/bounds.hpp"
#include "mesh/check_model.hpp"
#include "mesh/foreground.hpp"
#include "mesh/part_names.hpp"
#include "mesh/progress.hpp"

namespace cagecast::cages {

namespace {

/// Landmarks of a face that are looked for: the single ones, and those that come in pairs.
constexpr const char* kSingle[] = {"nose_tip", "nasion", "glabella",  "forehead",  "crown", "occiput",
                                   "nape",     "chin",   "lip_upper", "lip_lower", "menton"};
constexpr const char* kPaired[] = {"eye_centre", "eye_inner", "eye_outer",   "ear_top",
                                   "ear_lobe",   "ear_outer", "mouth_corner"};
/// Less sure ones are left out, and asked for.
constexpr double kSure = 0.5;

/// Whether eyes are where others are, seen from the front.
bool areAt(const Eyes& eyes, const Eyes& others) {
  constexpr double kSameEye = 0.25;  ///< Of the distance of the eyes.
  const double apart = length(others.centres[0] - others.centres[1]);
  const auto off = [&](std::size_t i) { return length(cross(eyes.centres[i] - others.centres[i], others.front)); };
  return std::max(off(0), off(1)) < kSameEye * apart;
}

/// The planes that may mirror a head: where bones tell left from right, one.
std::vector<MirrorPlane> planesOf(const Figure& figure) {
  const std::optional<Vec3> left = leftOf(figure.rig.joints);
  if (!left) return findMirrorPlanes(figure.mesh);
  const auto [low, high] = rangeOf(figure.mesh.positions, *left);
  MirrorPlane plane = refineMirrorPlane(figure.mesh, {*left, std::midpoint(low, high)});
  if (dot(plane.left, *left) < 0) plane = {-1 * plane.left, -plane.offset, plane.residual};
  return {plane};
}

/// The share of the search that is done when a head is found, but not yet its landmarks.
constexpr float kHeadMade = 0.6f;

/// Hints of a model, and others of what it has no hint of.
std::vector<Landmark> joined(std::vector<Landmark> hints, const std::vector<Landmark>& others) {
  for (const Landmark& other : others)
    if (findLandmark(hints, other.name) == nullptr) hints.push_back(other);
  return hints;
}

/// Whether shape says too little of where the mouth of a head is.
bool isMouthUnsure(const Head& head) {
  constexpr double kClear = 0.8;
  const Spot* lip = head.find("lip_upper");
  return head.hint("mouth") == nullptr &&
         (lip == nullptr || lip->confidence < kClear || head.find("mouth_corner_left") == nullptr);
}

/// Finds the landmarks of a head; if its mouth is not clear by shape, where it is painted.
void findLandmarksOf(const Figure& figure, const Model& model, const Eyes& eyes, std::optional<Head>& head) {
  findHeadLandmarks(figure, eyes, *head);
  if (!isMouthUnsure(*head)) return;
  const std::vector<Landmark> mouth = findPaintedMouth(figure, model, *head);
  std::optional<Head> better = mouth.empty() ? std::nullopt : makeHead(figure, eyes, joined(model.hints, mouth));
  if (!better) return;
  findHeadLandmarks(figure, eyes, *better);
  head = std::move(better);
}

/// Finds a figure's head: around the first eyes, named, loose, painted or fused with the skin, that are as far apart as
/// eyes are. Hints and joints say where to look first.
/// @param figure  Or its head. @param model  That it was read from.
/// @param goOn  Gets shares from 0 to 1 on the way.
/// @param[out] areSeveral  Whether there are several heads beside each other; then none is looked for.
/// @return false if `goOn` cancelled it.
bool findHead(const Figure& figure, const Model& model, const auto& goOn, std::optional<Head>& head, bool& areSeveral) {
  std::optional<Eyes> hinted = findHintedEyes(figure, model.hints);
  bool isCancelled = false;
  /// @return whether the search has ended.
  const auto makeHeadOf = [&](std::optional<Eyes> eyes, const std::vector<Landmark>& painted = {}) {
    if (!eyes) return false;
    areSeveral = eyes->areOfSeveralHeads;
    if (areSeveral) return true;
    if (hinted && !areAt(*eyes, *hinted)) return false;
    eyes->isNamed = eyes->isNamed || hinted;
    head = makeHead(figure, *eyes, joined(model.hints, painted));
    if (!head) return false;
    isCancelled = !goOn(kHeadMade);
    if (!isCancelled) findLandmarksOf(figure, model, *eyes, head);
    return true;
  };
  if (!goOn(0.1f)) return false;
  if (makeHeadOf(findNamedEyes(figure))) return !isCancelled;
  const auto makeHeadAtHint = [&] {
    if (!hinted) return false;
    const MirrorPlane plane{hinted->left, dot(hinted->left, hinted->middle())};
    if (makeHeadOf(findLooseEyes(figure, plane)) || makeHeadOf(hinted)) return true;
    hinted.reset();  // No head is there.
    return makeHeadOf(findNamedEyes(figure));
  };
  if (makeHeadAtHint()) return !isCancelled;
  hinted = findJointedEyes(figure, figure.rig.joints);
  if (makeHeadAtHint()) return !isCancelled;
  const std::vector<MirrorPlane> planes = planesOf(figure);
  float share = 0.2f;
  const float step = (kHeadMade - share) / static_cast<float>(3 * planes.size());
  const auto next = [&] {
    isCancelled = isCancelled || !goOn(share);
    share += step;
    return !isCancelled;
  };
  // A face that may be painted comes before eyes that are not clear.
  const double clear = model.baseColors.empty() ? 0 : 0.8;
  std::vector<std::optional<Eyes>> loose;
  for (const MirrorPlane& plane : planes) {
    if (!next()) return false;
    loose.push_back(findLooseEyes(figure, plane));
    if (loose.back() && loose.back()->confidence > clear && makeHeadOf(loose.back())) return !isCancelled;
  }
  std::optional<PaintedFace> painted;
  for (const MirrorPlane& plane : planes) {
    if (!next()) return false;
    std::optional<PaintedFace> face = findPaintedFace(figure, model, plane);
    if (face && (!painted || face->score > painted->score)) painted = std::move(face);
  }
  if (painted && makeHeadOf(painted->eyes, painted->landmarks)) return !isCancelled;
  for (const std::optional<Eyes>& eyes : loose)
    if (makeHeadOf(eyes)) return !isCancelled;
  for (const MirrorPlane& plane : planes) {
    if (!next()) return false;
    if (makeHeadOf(findFusedEyes(figure, plane))) return !isCancelled;
  }
  return true;
}

std::vector<std::string> faceLandmarks() {
  std::vector<std::string> out(std::begin(kSingle), std::end(kSingle));
  for (const char* name : kPaired)
    for (const char* side : {"_left", "_right"}) out.push_back(std::string(name) + side);
  return out;
}

Status find(const Model& given, const Progress& progress, FoundLandmarks& out) {
  out = {};
  if (const Status status = checkModel(given); !status.ok()) return status;
  const Foreground foreground(given);
  const Model& model = foreground.model();
  const auto goOn = [&](float share) { return report(progress, share, "landmarks"); };
  if (!goOn(0)) return kAborted;
  const Figure figure = readFigure(model);
  const Rig& rig = figure.rig;
  out.rig = rig.name;
  std::optional<Head> head;
  const auto goOnFinding = [&](float share) { return goOn(0.9f * share); };
  // The front of a vehicle looks like a face.
  const bool mayHaveFace = rig.known() || figure.has(Role::eye) || !isVehicle(model.parts);
  if (mayHaveFace && !findHead(headOf(figure, model), model, goOnFinding, head, out.areSeveralHeads)) return kAborted;
  if (!goOn(0.9f)) return kAborted;
  if (head)
    for (const Spot& spot : head->spots)
      if (spot.confidence >= kSure)
        out.landmarks.push_back(
            {spot.name, toPosition(head->frame.toModel(spot.position)), static_cast<float>(spot.confidence)});
  // A bust is twice as large as its head, a figure four times.
  constexpr double kFigure = 3;
  const bool body = rig.known() || (head && diagonalOf(figure.mesh) > kFigure * head->frame.unit);
  out.kind = body ? Kind::body : head ? Kind::head : Kind::prop;
  out.landmarks.insert(out.landmarks.end(), rig.joints.begin(), rig.joints.end());
  std::set<std::string> have;
  for (const Landmark& landmark : out.landmarks) have.insert(landmark.name);
  for (const std::string& name : faceLandmarks())
    if (have.find(name) == have.end()) out.missing.push_back(name);
  if (out.kind == Kind::body)
    for (const std::string& name : jointLandmarks())
      if (have.find(name) == have.end()) out.missing.push_back(name);
  return goOn(1) ? Status{} : kAborted;
}

}  // namespace

Status findLandmarks(const Model& model, const Progress& progress, FoundLandmarks& out) {
  return guarded([&] { return find(model, progress, out); });
}

}  // namespace cagecast::cages
