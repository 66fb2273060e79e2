#include <algorithm>
#include <tuple>

#include "cagecast/cages.hpp"
#include "fit/steps.hpp"
#include "fit/warp.hpp"
#include "hull/hull.hpp"
#include "landmarks/parts.hpp"
#include "mesh/check_model.hpp"
#include "mesh/foreground.hpp"
#include "mesh/limits.hpp"
#include "mesh/part_names.hpp"
#include "mesh/progress.hpp"
/// The fit: landmarks or bones say where everything belongs, a smooth map carries the cage there, and the hull of the
/// target draws it onto its surface without letting it slide. All in the space of the template, so that how the target
/// is turned and scaled makes no difference.
namespace cagecast::cages {

namespace {

/// Lengths in diagonals of the template's cage.
struct FitSettings {
  double closing;
  std::uint32_t voxels;
  int passes;  ///< Of drawing the cage onto the hull, each from where the last one ended: bodies differ more.
  TightenOptions tighten;
};
constexpr FitSettings kHead{0.022, 80, 1, {.reach = 0.06, .sliding = 0.5, .stiffest = 30, .softest = 1}};
constexpr FitSettings kBody{0.010, 200, 2, {.reach = 0.02, .sliding = 0.05, .stiffest = 30, .softest = 1}};
/// The hull is at least this far off, in diagonals: templates whose landmarks lie on the cage.
constexpr double kMinOffset = 0.003;
/// A fitted cage that is farther than this from the figure's box, in diagonals, is no cage of it.
constexpr double kMaxBeyond = 1;
/// What is farther than this from a cage without bones, in diagonals, has no part in its hull.
constexpr double kHullReach = 0.5;
/// Shares of the time, for progress: about those of heads and figures of 10,000 to 30,000 triangles.
constexpr float kLandmarksEnd = 0.2f, kHullEnd = 0.4f, kTightenEnd = 0.8f, kEyesEnd = 0.9f, kRelaxEnd = 0.92f;

/// What is known of both models.
struct Pairs : LandmarkPairs {
  std::vector<std::optional<Vec3>> found;  ///< Where what was given was found, too; as `to`.
  std::vector<std::uint32_t> places;       ///< In the template's list.

  /// Leaves some out.
  void drop(const std::vector<bool>& isOut) {
    const auto without = [&](auto& list) {
      std::size_t i = 0;
      std::erase_if(list, [&](const auto&) { return isOut[i++]; });
    };
    without(from);
    without(to);
    without(given);
    without(found);
    without(places);
  }
};

/// Pairs landmarks of a template with given ones, else with found ones.
/// @param[out] unknown  Those of the template that are neither.
Pairs pairLandmarks(const Template& from, const std::vector<Landmark>& given, const std::vector<Landmark>& found,
                    std::vector<std::string>& unknown) {
  Pairs out;
  unknown.clear();
  for (std::uint32_t i = 0; i < from.landmarks.size(); ++i) {
    const Landmark& landmark = from.landmarks[i];
    const Landmark* there = findLandmark(given, landmark.name);
    const bool isGiven = there != nullptr;
    const Landmark* other = findLandmark(found, landmark.name);
    if (!isGiven) there = other;
    if (there == nullptr) {
      unknown.push_back(landmark.name);
      continue;
    }
    out.from.push_back(landmark);
    out.to.push_back(*there);
    out.given.push_back(isGiven);
    out.found.push_back(isGiven && other != nullptr ? std::optional(positionOf(*other)) : std::nullopt);
    out.places.push_back(i);
  }
  return out;
}

/// Where given landmarks say that eyes and mouth are, for the search of the others.
std::vector<Landmark> hintsOf(const std::vector<Landmark>& given) {
  constexpr double kHalfWidth = 0.22;  ///< Of an eye, in distances of both.
  std::vector<Landmark> out;
  const auto left = placeOf(given, "eye_centre_left"), right = placeOf(given, "eye_centre_right");
  if (left && right) {
    const Vec3 half = kHalfWidth * (*left - *right);
    out = {{"eye_inner_left", toPosition(*left - half)},
           {"eye_outer_left", toPosition(*left + half)},
           {"eye_inner_right", toPosition(*right + half)},
           {"eye_outer_right", toPosition(*right - half)}};
  }
  std::vector<Vec3> lips;
  for (const char* name : {"lip_upper", "lip_lower"})
    if (const auto lip = placeOf(given, name)) lips.push_back(*lip);
  if (!lips.empty()) out.push_back({"mouth", toPosition(meanOf(lips))});
  return out;
}

/// Whether both eyes are given, and a face was found elsewhere, or none although more of it is given.
bool areElsewhere(const std::vector<Landmark>& given, const std::vector<Landmark>& found) {
  constexpr double kFar = 0.25;  ///< In distances of the eyes.
  const auto left = placeOf(given, "eye_centre_left"), right = placeOf(given, "eye_centre_right");
  if (!left || !right) return false;
  const auto foundLeft = placeOf(found, "eye_centre_left"), foundRight = placeOf(found, "eye_centre_right");
  if (!foundLeft || !foundRight) return given.size() >= kMinLandmarks;
  return std::max(length(*foundLeft - *left), length(*foundRight - *right)) > kFar * length(*left - *right);
}

void setLandmark(std::vector<Landmark>& list, const Landmark& landmark) {
  std::erase_if(list, [&](const Landmark& other) { return other.name == landmark.name; });
  list.push_back(landmark);
}

/// Whether the triangles of a cage are within a distance of the box around a hull and landmarks.
bool isNear(const TriangleMesh& cage, const TriangleMesh& hull, const std::vector<Landmark>& landmarks,
            double distance) {
  Bounds box = boundsOf(hull);
  for (const Landmark& landmark : landmarks) box.add(positionOf(landmark));
  return std::all_of(cage.triangles.begin(), cage.triangles.end(), [&](const Triangle3& t) {
    return std::all_of(t.begin(), t.end(), [&](std::uint32_t v) { return box.distance(cage.positions[v]) < distance; });
  });
}

/// The same names, those first that say most of where a template belongs.
std::vector<std::string> mostHelpfulFirst(std::vector<std::string> names) {
  static constexpr const char* kFirst[] = {
      "joint_neck",   "joint_hips",  "joint_wrist", "eye_centre_left",    "eye_centre_right", "lip_lower", "chin",
      "bumper_front", "bumper_rear", "roof",        "wheel_front_centre", "nose_tip"};
  auto next = names.begin();
  for (const char* name : kFirst)
    next = std::stable_partition(next, names.end(), [&](const std::string& one) { return one.starts_with(name); });
  return names;
}

class Fit {
 public:
  Fit(const Template& from, const Model& model, const FitOptions& options, const Progress& progress)
      : from_(from), model_(model), options_(options), progress_(progress) {}

  Status run(FittedCage& out) {
    TemplateCage cage = prepareTemplate(from_);
    if (const Status status = pair(cage, out); !status.ok()) return status;
    if (!report(progress_, kLandmarksEnd, "hull")) return kAborted;
    align();
    const FitSettings& settings = bones_.empty() ? kHead : kBody;
    cage.offset = std::max(cage.offset, kMinOffset * cage.diagonal);
    readTarget();
    if (skin_.empty()) return {Code::nothingToPaint, Argument::model};
    const std::vector<Anchor> anchors = anchorsOf(cage);
    if (anchors.empty())
      return {Code::tooFewJoints, Argument::landmarks, static_cast<std::uint32_t>(pairs_.from.size())};
    std::vector<Vec3> positions = start(cage, anchors);
    if (!std::all_of(positions.begin(), positions.end(), isFinite)) return {Code::noFit, Argument::model};
    figure_.holes = faceHoles(cage, positions, pairs_, face_);
    TriangleMesh hull;
    const HullOptions around{settings.closing * cage.diagonal, cage.offset, settings.voxels,
                             meanOf(positionsOf(pairs_.to))};
    if (!makeHull(bones_.empty() ? nearTo(positions, cage) : figure_.mesh, around,
                  partOf(progress_, kLandmarksEnd, kHullEnd), hull))
      return kAborted;
    if (hull.empty()) return {Code::noVolume, Argument::model};
    if (!draw(cage, hull, settings, positions)) return kAborted;
    if (!isNear({positions, cage.mesh.triangles}, hull, pairs_.to, kMaxBeyond * cage.diagonal))
      return {Code::noFit, Argument::model};
    write(cage, positions, out);
    closeEmptyHoles(cage, positions, out);
    if (isHead(from_))
      out.bare = partsBesideHead(model_, skin_, skinOf_, belowRim(cage, positions, skin_, 0), pairs_.to);
    return report(progress_, 1, "done") ? Status{} : kAborted;
  }

 private:
  /// The pairs of points that the cage is moved by, once it is bent by the bones: no two of them at one spot.
  [[nodiscard]] std::vector<Anchor> anchorsOf(const TemplateCage& cage) const {
    const Axes axes = axesOf(from_.landmarks);
    std::vector<Anchor> anchors = landmarkAnchors(pairs_.from, pairs_.to, !bones_.empty());
    for (const Anchor& anchor : jawAnchors(from_.landmarks, pairs_.to)) anchors.push_back(anchor);
    for (const Anchor& anchor : eyeAnchors(pairs_.from, pairs_.to, axes)) anchors.push_back(anchor);
    if (bones_.empty())
      for (const Anchor& anchor : rimAnchors(cage, skin_, axes)) anchors.push_back(anchor);
    std::vector<Anchor> apart;
    for (Anchor anchor : anchors) {
      if (!bones_.empty()) anchor.from = bend(anchor.from, bones_);
      const bool isTwice = std::any_of(apart.begin(), apart.end(), [&](const Anchor& other) {
        return length(other.from - anchor.from) < kOneSpot * cage.diagonal;
      });
      if (!isTwice) apart.push_back(anchor);
    }
    return apart;
  }

  /// Where the cage belongs by landmarks and bones alone.
  [[nodiscard]] std::vector<Vec3> start(const TemplateCage& cage, const std::vector<Anchor>& anchors) const {
    std::vector<Vec3> positions = bones_.empty() ? cage.mesh.positions : bend(cage, bones_);
    const Warp warp(anchors, cage.diagonal);
    for (Vec3& p : positions) p = warp(p);
    return positions;
  }

  /// What of the figure is near a cage and not below its rim: the hull of a head is as fine where there is a body.
  [[nodiscard]] TriangleMesh nearTo(const std::vector<Vec3>& positions, const TemplateCage& cage) const {
    Bounds box;
    for (const Triangle3& t : cage.mesh.triangles)
      for (const std::uint32_t v : t) box.add(positions[v]);
    std::vector<bool> isNear = belowRim(cage, positions, figure_.mesh);
    isNear.flip();
    for (std::size_t t = 0; t < isNear.size(); ++t) {
      const Triangle3& corners = figure_.mesh.triangles[t];
      isNear[t] = isNear[t] && std::any_of(corners.begin(), corners.end(), [&](std::uint32_t v) {
                    return box.distance(figure_.mesh.positions[v]) < kHullReach * cage.diagonal;
                  });
    }
    return subset(figure_.mesh, isNear);
  }

  /// Whether known landmarks leave open where the cage belongs, or where the lower half of a head's face is.
  [[nodiscard]] bool isTooLittle(const std::vector<Landmark>& known) const {
    static constexpr const char* kLowerFace[] = {"chin", "lip_upper", "lip_lower", "mouth_corner_left"};
    const auto isKnown = [&](const char* name) { return placeOf(known, name).has_value(); };
    return known.size() < kMinLandmarks || (isHead(from_) && isKnown("eye_centre_left") &&
                                            std::none_of(std::begin(kLowerFace), std::end(kLowerFace), isKnown));
  }

  /// Pairs the landmarks of the template with those that were given, are found, or, where these are too few, guessed.
  [[nodiscard]] Status pair(const TemplateCage& cage, FittedCage& out) {
    const std::vector<Landmark>& given = options_.landmarks;
    for (std::uint32_t i = 0; i < given.size(); ++i)
      if (findLandmark(from_.landmarks, given[i].name) == nullptr)
        return {Code::unknownLandmark, Argument::landmarks, i};
    FoundLandmarks found;
    const bool allGiven = std::all_of(from_.landmarks.begin(), from_.landmarks.end(), [&](const Landmark& landmark) {
      return findLandmark(given, landmark.name) != nullptr;
    });
    if (!allGiven) {
      const Progress finding = partOf(progress_, 0, kLandmarksEnd);
      if (const Status status = findLandmarks(model_, finding, found); !status.ok()) return status;
      Model hinted = model_;
      for (const Landmark& hint : hintsOf(given)) setLandmark(hinted.hints, hint);
      // Again, where a person has the face.
      if (areElsewhere(given, found.landmarks))
        if (const Status status = findLandmarks(hinted, finding, found); !status.ok()) return status;
    }
    if (found.areSeveralHeads && given.size() < kMinLandmarks) return {Code::noFit, Argument::model};
    pairs_ = pairLandmarks(from_, given, found.landmarks, out.missing);
    Status status = checkJoints(pairs_.to, boundsOf(model_.mesh));
    std::vector<bool> outvoted(pairs_.from.size());
    if (status.ok()) status = checkAgreement(pairs_.from, pairs_.to, pairs_.given, cage.diagonal, outvoted);
    if (!status.ok() && status.code != Code::smallSkeleton) status.at = pairs_.places[status.at];
    if (status.ok()) pairs_.drop(outvoted);
    if (status.ok() && isTooLittle(pairs_.to)) {
      out.guessed = mostHelpfulFirst(out.missing);
      for (Landmark& guess : guessLandmarks(from_, cage, model_, pairs_.to))
        found.landmarks.push_back(std::move(guess));
      pairs_ = pairLandmarks(from_, given, found.landmarks, out.missing);
      // A guess that puts several on one spot has nothing to go by.
      if (!checkLandmarkList(pairs_.to, Argument::model, boundsOf(model_.mesh)).ok())
        return {Code::noFit, Argument::model};
    }
    out.landmarks = pairs_.to;
    return status;
  }

  /// Brings the target's landmarks into the template's space, and finds the bones.
  void align() {
    map_ = fitSimilarity(positionsOf(pairs_.from), positionsOf(pairs_.to));
    for (Landmark& landmark : pairs_.to) landmark.position = toPosition(map_.inverse(positionOf(landmark)));
    face_ = faceOf(pairs_.from, pairs_.to, axesOf(from_.landmarks),
                   unit(map_.inverse({0, 1, 0}) - map_.inverse({0, 0, 0})));
    for (std::optional<Vec3>& found : pairs_.found)
      if (found) found = map_.inverse(*found);
    pairs_.drop(contradicted(pairs_.given, pairs_.found, face_, pairs_.to));
    bones_ = bonesOf(pairs_.from, pairs_.to);
  }

  /// Reports the steps of something that takes the time from one share to another.
  [[nodiscard]] StepCallback stepsOf(float from, float to, const char* stage) const {
    return [this, from, to, stage](double share) { return report(progress_, from + share * (to - from), stage); };
  }

  /// What draws the holes of a face to their places; how deep they are, the hull says.
  [[nodiscard]] std::vector<PlaneTerm> holdsOf(const std::vector<Vec3>& positions) const {
    constexpr double kStrength = 10;
    std::vector<PlaneTerm> holds;
    for (const FaceHole& hole : figure_.holes) {
      const Vec3 miss = missOf(hole, face_, positions);
      for (const std::uint32_t v : hole.loop)
        for (const Vec3& direction : {face_.there.left, face_.there.up})
          holds.push_back({{v, v, v}, {1, 0, 0}, positions[v] + miss, direction, kStrength});
    }
    return holds;
  }

  /// Draws the cage onto the hull, and pushes it out until the target is inside. @return false if cancelled.
  [[nodiscard]] bool draw(const TemplateCage& cage, const TriangleMesh& hull, const FitSettings& settings,
                          std::vector<Vec3>& positions) const {
    for (int pass = 0; pass < settings.passes; ++pass) {
      const float each = (kTightenEnd - kHullEnd) / static_cast<float>(settings.passes);
      const float from = kHullEnd + static_cast<float>(pass) * each;
      const std::vector<Vec3> free(positions.size(), Vec3{0, 0, 0});
      if (pass > 0 && !relax(cage, free, stepsOf(from, from, "fit"), positions)) return false;
      const std::vector<PlaneTerm> holds = holdsOf(positions);
      TightenOptions options = settings.tighten;
      options.holds = holds;
      positions = tighten(cage, positions, hull, options, stepsOf(from, from + each, "fit"));
      if (positions.empty()) return false;
    }
    std::vector<Vec3> tracks;
    return fitEyeHoles(cage, figure_, stepsOf(kTightenEnd, kEyesEnd, "fit"), tracks, positions) &&
           relax(cage, tracks, stepsOf(kEyesEnd, kRelaxEnd, "fit"), positions) &&
           pushOut(cage, {skin_, hull}, tracks, stepsOf(kRelaxEnd, 1, "push out"), positions);
  }

  /// Writes the cage in the target's space.
  void write(const TemplateCage& cage, const std::vector<Vec3>& positions, FittedCage& out) const {
    out.positions.clear();
    for (const std::uint32_t v : cage.vertexOf) append(out.positions, map_(positions[v]));
    out.uvs.assign(from_.cage.uvs.begin(), from_.cage.uvs.end());
    out.indices.assign(from_.cage.indices.begin(), from_.cage.indices.end());
    out.kind = from_.kind;
  }

  /// Closes the holes of a face that have nothing behind them.
  void closeEmptyHoles(const TemplateCage& cage, const std::vector<Vec3>& positions, FittedCage& out) const {
    const LandmarkPairs own{from_.landmarks, from_.landmarks, std::vector<bool>(from_.landmarks.size())};
    const Face face = faceOf(own.from, own.to, axesOf(own.from), {0, 1, 0});
    const std::vector<FaceHole> holes = faceHoles(cage, cage.mesh.positions, own, face);
    const std::vector<bool> isEmpty = emptyHoles(holes, {model_, whole_, map_}, positions);
    for (std::size_t i = 0; i < isEmpty.size(); ++i) {
      if (!isEmpty[i]) continue;
      const std::vector<std::uint32_t>& loop = holes[i].loop;
      std::vector<std::uint32_t> corners;  // Of the given cage.
      std::vector<Flat> uvs;
      for (const std::uint32_t v : loop) {
        const auto first = std::find(cage.vertexOf.begin(), cage.vertexOf.end(), v);
        const auto corner = static_cast<std::uint32_t>(first - cage.vertexOf.begin());
        const bool isOnSeam = std::find(first + 1, cage.vertexOf.end(), v) != cage.vertexOf.end();
        if (isOnSeam) break;
        corners.push_back(corner);
        uvs.push_back({static_cast<double>(out.uvs[2 * std::size_t{corner}]),
                       static_cast<double>(out.uvs[2 * std::size_t{corner} + 1])});
      }
      if (corners.size() < loop.size()) continue;
      const std::vector<Triangle3> lid = lidOf(uvs);
      for (const Triangle3& t : lid)
        for (const std::uint32_t k : t) out.indices.push_back(corners[k]);
      if (!lid.empty()) out.closed.insert(out.closed.end(), corners.begin(), corners.end());
    }
  }

  /// Reads the target in the space of the template.
  void readTarget() {
    whole_ = readFigure(model_);
    const Figure& parts = whole_;
    TriangleMesh& mesh = whole_.mesh;
    for (Vec3& p : mesh.positions) p = map_.inverse(p);
    const std::vector<bool> isExcluded = excludedTriangles(model_, options_.parts);
    std::vector<bool> isSkin(mesh.triangles.size()), isFigure(mesh.triangles.size()), isCover(mesh.triangles.size());
    figure_ = {};
    figure_.componentCount = parts.componentCount;
    figure_.eyes = eyePairs(pairs_.from, pairs_.to);
    figure_.face = face_;
    for (std::size_t t = 0; t < mesh.triangles.size(); ++t) {
      const bool isEye = parts.roles[t] == Role::eye;
      isSkin[t] = !isExcluded[parts.triangleOf[t]];
      isFigure[t] = isSkin[t] || isEye;
      isCover[t] = !isFigure[t];
      if (isCover[t]) {
        figure_.coverComponents.push_back(parts.components[t]);
        continue;
      }
      figure_.isEye.push_back(isEye);
      figure_.components.push_back(parts.components[t]);
    }
    skin_ = subset(mesh, isSkin);
    skinOf_.clear();
    for (std::size_t t = 0; t < isSkin.size(); ++t)
      if (isSkin[t]) skinOf_.push_back(parts.triangleOf[t]);
    figure_.mesh = subset(mesh, isFigure);
    figure_.covers = subset(mesh, isCover);
  }

  const Template& from_;
  const Model& model_;
  const FitOptions& options_;
  const Progress& progress_;
  Pairs pairs_;
  Similarity map_;  ///< From the template's space to the target's.
  Face face_;
  std::vector<Bone> bones_;            ///< None for heads.
  TriangleMesh skin_;                  ///< The target without excluded parts, in the template's space.
  std::vector<std::uint32_t> skinOf_;  ///< Per triangle of it: the model's.
  Figure whole_;                       ///< All of the target, in the template's space.
  EyedFigure figure_;                  ///< Eyes fill their sockets.
};

}  // namespace

Status fitCage(const Template& from, const Model& model, const FitOptions& options, const Progress& progress,
               FittedCage& out) {
  return guarded([&] {
    if (const Status status = checkMesh(from.cage, Argument::from); !status.ok()) return status;
    if (from.cage.uvs.empty()) return Status{Code::missingUvs, Argument::from};
    if (const Status status = checkModel(model); !status.ok()) return status;
    const auto count = static_cast<std::uint32_t>(from.landmarks.size());
    if (count < kMinLandmarks) return Status{Code::tooFewLandmarks, Argument::from, count};
    for (const auto& [argument, list, box] :
         {std::tuple{Argument::from, &from.landmarks, boundsOf(from.cage)},
          std::tuple{Argument::landmarks, &options.landmarks, boundsOf(model.mesh)}})
      if (const Status status = checkLandmarkList(*list, argument, box); !status.ok()) return status;
    if (const Status status = checkParts(model, options.parts); !status.ok()) return status;
    const WithoutParts rest(model, options.parts.ignore);
    if (const Status status = checkModel(rest.model()); !status.ok()) return status;
    FittedCage fitted;  // `out` may own the template.
    const Foreground foreground(rest.model());
    const Status status = Fit(from, foreground.model(), options, progress).run(fitted);
    out = std::move(fitted);
    return status;
  });
}

}  // namespace cagecast::cages
