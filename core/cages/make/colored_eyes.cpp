#include <algorithm>
#include <array>
#include <cmath>
#include <utility>

#include "landmarks/landmark_list.hpp"
#include "landmarks/parts.hpp"
#include "make/steps.hpp"
#include "mesh/part_names.hpp"
#include "views/base_color.hpp"

namespace cagecast::cages {

namespace {

// Lengths are distances of the eyes.
/// Cells to a side of what is looked at around an eye, and half of its size.
constexpr std::uint32_t kEyeCells = 45;
constexpr double kEyeReach = 0.45;
/// From how far before an eye's centre it is looked at: behind most hats and hair.
constexpr double kSeenFrom = 0.8;
/// An iris, and how far an eye reaches at most, to the sides and up and down.
constexpr double kIris = 0.1, kEyeWide = 0.42, kEyeHigh = 0.32;
/// Skin is what is seen below an eye, farther down than this.
constexpr double kSkinBelow = 0.3;
/// How far a colour has to differ from skin, in units of CIELAB, and in how much of an iris.
constexpr double kDiffers = 18, kClearIris = 0.6;
/// By how much a hole is larger than the eye.
constexpr double kEyeMargin = 0.05;
/// Layers that are transparent, or are hair and the like, which are looked through, at most.
constexpr int kSeenLayers = 4;

/// What is seen of a model around one of its eyes.
using SeenColors = std::vector<std::optional<Vec3>>;

double alongCells(std::uint32_t cell) { return kEyeReach * ((2.0 * cell + 1) / kEyeCells - 1); }

/// The commonest colour below an eye; nothing if nothing is seen there.
std::optional<Vec3> skinBelow(const SeenColors& colors) {
  std::array<std::vector<double>, 3> axes;
  for (std::uint32_t i = 0; i < colors.size(); ++i)
    if (colors[i] && alongCells(i / kEyeCells) < -kSkinBelow) {
      axes[0].push_back(colors[i]->x);
      axes[1].push_back(colors[i]->y);
      axes[2].push_back(colors[i]->z);
    }
  if (axes[0].empty()) return std::nullopt;
  return Vec3{medianOf(axes[0]), medianOf(axes[1]), medianOf(axes[2])};
}

/// Which cells differ from the skin below an eye.
std::vector<bool> differing(const SeenColors& colors) {
  std::vector<bool> out(colors.size(), false);
  const std::optional<Vec3> skin = skinBelow(colors);
  for (std::size_t i = 0; i < colors.size() && skin; ++i) out[i] = colors[i] && length(*colors[i] - *skin) > kDiffers;
  return out;
}

/// Whether most of an iris at some place has what some cells have.
bool isIrisAt(const std::vector<bool>& has, double x, double y) {
  double all = 0, own = 0;
  for (std::uint32_t i = 0; i < has.size(); ++i) {
    if (std::hypot(alongCells(i % kEyeCells) - x, alongCells(i / kEyeCells) - y) > kIris) continue;
    all += 1;
    own += has[i] ? 1 : 0;
  }
  return own >= kClearIris * all;
}

/// How far aside, away from the nose, and up the irises of both eyes are from where eyes were found: what relief tells
/// is less exact than colours. Nothing if none is near.
std::optional<std::array<double, 2>> irisesNear(const std::vector<bool>& left, const std::vector<bool>& right) {
  constexpr double kShiftStep = 0.04, kFarthestShift = 0.2;
  std::optional<std::array<double, 2>> nearest;
  for (double y = -kFarthestShift; y <= kFarthestShift + kShiftStep / 2; y += kShiftStep)
    for (double x = -kFarthestShift; x <= kFarthestShift + kShiftStep / 2; x += kShiftStep) {
      if (nearest && std::hypot(x, y) >= std::hypot((*nearest)[0], (*nearest)[1])) continue;
      if (std::hypot(x, y) <= kFarthestShift && isIrisAt(left, x, y) && isIrisAt(right, -x, y)) nearest = {x, y};
    }
  return nearest;
}

/// The cells of an eye: what differs from skin and is connected with the iris at a place.
std::vector<bool> eyeCells(const std::vector<bool>& differs, double x, double y) {
  std::vector<bool> isEye(differs.size(), false);
  std::vector<std::uint32_t> open;
  const auto distance = [&](std::uint32_t i, double wide, double high) {
    return std::hypot((alongCells(i % kEyeCells) - x) / wide, (alongCells(i / kEyeCells) - y) / high);
  };
  const auto visit = [&](std::uint32_t i) {
    if (isEye[i] || !differs[i] || distance(i, kEyeWide, kEyeHigh) > 1) return;
    isEye[i] = true;
    open.push_back(i);
  };
  for (std::uint32_t i = 0; i < differs.size(); ++i)
    if (distance(i, kIris, kIris) <= 1) visit(i);
  while (!open.empty()) {
    const std::uint32_t i = open.back();
    open.pop_back();
    if (i % kEyeCells > 0) visit(i - 1);
    if (i % kEyeCells + 1 < kEyeCells) visit(i + 1);
    if (i >= kEyeCells) visit(i - kEyeCells);
    if (i + kEyeCells < differs.size()) visit(i + kEyeCells);
  }
  return isEye;
}

/// Whether each cell is within a distance of a chosen one.
std::vector<bool> widened(const std::vector<bool>& isIn, double by) {
  const auto reach = static_cast<std::int32_t>(std::ceil(by * kEyeCells / (2 * kEyeReach)));
  std::vector<bool> out(isIn.size(), false);
  for (std::uint32_t i = 0; i < isIn.size(); ++i) {
    if (!isIn[i]) continue;
    for (std::int32_t dy = -reach; dy <= reach; ++dy)
      for (std::int32_t dx = -reach; dx <= reach; ++dx) {
        const std::int64_t x = std::int64_t{i % kEyeCells} + dx, y = std::int64_t{i / kEyeCells} + dy;
        if (dx * dx + dy * dy > reach * reach || x < 0 || y < 0 || x >= kEyeCells || y >= kEyeCells) continue;
        out[static_cast<std::size_t>(y * kEyeCells + x)] = true;
      }
  }
  return out;
}

/// The cells of an eye whose mirror is of the other, too: strands of hair and shadows are beside one.
std::vector<bool> commonCells(const std::vector<bool>& eye, const std::vector<bool>& other) {
  const std::vector<bool> near = widened(other, kEyeMargin);
  std::vector<bool> out(eye.size());
  for (std::uint32_t i = 0; i < eye.size(); ++i)
    out[i] = eye[i] && near[i / kEyeCells * kEyeCells + kEyeCells - 1 - i % kEyeCells];
  return out;
}

}  // namespace

std::optional<FaceFrame> faceFrameOf(const std::vector<Landmark>& landmarks) {
  const auto left = placeOf(landmarks, "eye_centre_left"), right = placeOf(landmarks, "eye_centre_right");
  if (!left || !right) return std::nullopt;
  const Vec3 apart = *left - *right, across = unit({apart.x, 0, apart.z});
  if (!(length(across) > 0)) return std::nullopt;
  FaceFrame face;
  face.middle = 0.5 * (*left + *right);
  face.left = across;
  face.front = cross(across, face.up);
  face.size = length(apart);
  return face;
}

ColoredEyes::ColoredEyes(const Model& model, const MarkedMesh& marked, const std::vector<std::uint32_t>& triangleOf,
                         const std::vector<Landmark>& landmarks, const FaceFrame& face)
    : face_(face) {
  if (model.baseColors.empty()) return;
  std::vector<bool> isCoverPart(model.parts.size());
  std::transform(model.parts.begin(), model.parts.end(), isCoverPart.begin(),
                 [](const std::string& part) { return roleOf(part) == Role::cover; });
  const std::vector<bool> isCover = trianglesOf(model.mesh, isCoverPart);
  std::array<std::vector<bool>, 2> found;
  for (const std::size_t side : {std::size_t{0}, std::size_t{1}}) {
    centres_[side] = face.toLocal(*placeOf(landmarks, side == 0 ? "eye_centre_left" : "eye_centre_right"));
    std::vector<SurfaceRay> rays;
    for (std::uint32_t i = 0; i < kEyeCells * kEyeCells; ++i) {
      const Vec3 at = centres_[side] + Vec3{alongCells(i % kEyeCells), alongCells(i / kEyeCells), kSeenFrom};
      rays.push_back(
          {face.middle + face.size * (at.x * face.left + at.y * face.up + at.z * face.front), -1 * face.front});
    }
    SeenColors colors(rays.size());
    std::vector<bool> isDone(rays.size(), false), isPart(rays.size(), false);
    for (int layer = 0; layer < kSeenLayers; ++layer) {
      const std::vector<RayHit> hits = marked.surface->trace(rays);
      for (std::size_t i = 0; i < hits.size(); ++i) {
        if (isDone[i]) continue;
        const std::uint32_t t = hits[i].triangle;
        isDone[i] = !std::isfinite(hits[i].distance) || t >= triangleOf.size();
        if (isDone[i]) continue;
        const Vec3 point = rays[i].origin + hits[i].distance * rays[i].direction;
        const bool isKept = !marked.isKept.empty() && marked.isKept[t], covers = isCover[triangleOf[t]];
        const bool isSettled = isKept || (marked.isMarked[t] && !covers);
        if (!covers && !isSettled) colors[i] = baseColorAt(model, triangleOf[t], point);
        isPart[i] = isSettled;
        isDone[i] = isSettled || colors[i].has_value();
        rays[i].origin = point - 1e-3 * face.size * face.front;
      }
    }
    if (isIrisAt(isPart, 0, 0)) return;
    found[side] = differing(colors);
  }
  const auto shift = irisesNear(found[0], found[1]);
  if (!shift) return;
  const auto [aside, up] = *shift;
  const std::array<std::vector<bool>, 2> eyes{eyeCells(found[0], aside, up), eyeCells(found[1], -aside, up)};
  for (const std::size_t side : {std::size_t{0}, std::size_t{1}})
    cells_[side] = widened(commonCells(eyes[side], eyes[1 - side]), kEyeMargin);
}

bool ColoredEyes::isBefore(const Vec3& p, const Vec3& normal) const {
  if (cells_[0].empty() || !(dot(normal, face_.front) > 0)) return false;
  const Vec3 at = face_.toLocal(p);
  for (const std::size_t side : {std::size_t{0}, std::size_t{1}}) {
    const Vec3 d = at - centres_[side];
    if (std::abs(d.x) >= kEyeReach || std::abs(d.y) >= kEyeReach || std::abs(d.z) > kSeenFrom) continue;
    const auto cell = [](double x) { return static_cast<std::size_t>((x / kEyeReach + 1) / 2 * kEyeCells); };
    if (cells_[side][std::min<std::size_t>(cell(d.y), kEyeCells - 1) * kEyeCells +
                     std::min<std::size_t>(cell(d.x), kEyeCells - 1)])
      return true;
  }
  return false;
}

}  // namespace cagecast::cages
