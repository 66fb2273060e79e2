#include "fit/template_cage.hpp"

#include <algorithm>

#include "mesh/surface.hpp"

namespace cagecast::cages {

namespace {

/// Length of a rim around, at least, in diagonals: necks have 1 to 2, eyes at most 0.4.
constexpr double kMinRim = 0.7;

bool endsWith(const std::string& text, const char* end) {
  const std::string tail = end;
  return text.size() >= tail.size() && text.compare(text.size() - tail.size(), tail.size(), tail) == 0;
}

double median(std::vector<double> values) {
  if (values.empty()) return 0;
  const auto middle = values.begin() + static_cast<std::ptrdiff_t>(values.size() / 2);
  std::nth_element(values.begin(), middle, values.end());
  return *middle;
}

}  // namespace

bool isOnSkin(const std::string& name) { return name.rfind("joint_", 0) != 0 && name.rfind("eye_centre", 0) != 0; }

const Landmark* findLandmark(const std::vector<Landmark>& landmarks, const std::string& name) {
  for (const Landmark& landmark : landmarks)
    if (landmark.name == name) return &landmark;
  return nullptr;
}

int rimOf(const TriangleMesh& mesh, const std::vector<std::vector<std::uint32_t>>& loops, double diagonal) {
  int best = -1;
  double most = kMinRim * diagonal;
  for (std::size_t i = 0; i < loops.size(); ++i) {
    double around = 0;
    for (std::size_t k = 0; k < loops[i].size(); ++k)
      around += length(mesh.positions[loops[i][k]] - mesh.positions[loops[i][(k + 1) % loops[i].size()]]);
    if (around <= most) continue;
    most = around;
    best = static_cast<int>(i);
  }
  return best;
}

Axes axesOf(const std::vector<Landmark>& landmarks) {
  Axes axes;
  Vec3 left{0, 0, 0}, middle{0, 0, 0};
  double pairs = 0;
  for (const Landmark& landmark : landmarks) {
    if (!endsWith(landmark.name, "_left")) continue;
    const Landmark* other = findLandmark(landmarks, landmark.name.substr(0, landmark.name.size() - 5) + "_right");
    if (other == nullptr) continue;
    left = left + (positionOf(landmark) - positionOf(*other));
    middle = middle + 0.5 * (positionOf(landmark) + positionOf(*other));
    ++pairs;
  }
  const Landmark* nose = findLandmark(landmarks, "nose_tip");
  const Landmark* eyeLeft = findLandmark(landmarks, "eye_centre_left");
  const Landmark* eyeRight = findLandmark(landmarks, "eye_centre_right");
  const Landmark* low = findLandmark(landmarks, "chin");
  if (low == nullptr) low = findLandmark(landmarks, "lip_lower");
  if (low == nullptr) low = findLandmark(landmarks, "mouth");
  if (pairs == 0 || !(length(left) > 0) || nose == nullptr || eyeLeft == nullptr || eyeRight == nullptr) return axes;
  axes.left = unit(left);
  axes.middle = 1 / pairs * middle;
  const Vec3 eyes = 0.5 * (positionOf(*eyeLeft) + positionOf(*eyeRight));
  const Vec3 upright = low != nullptr ? eyes - positionOf(*low) : Vec3{0, 1, 0};
  // The chin is below the eyes and about as far back as they are; the nose is further to the front.
  axes.up = unit(upright - dot(upright, axes.left) * axes.left);
  axes.front = cross(axes.left, axes.up);
  axes.known = length(axes.up) > 0;
  return axes;
}

TemplateCage prepareTemplate(const Template& from) {
  TemplateCage out;
  out.mesh = weldExactly(from.cage, &out.vertexOf);
  out.loops = boundaryLoops(out.mesh);
  out.diagonal = diagonalOf(out.mesh);
  out.rim = rimOf(out.mesh, out.loops, out.diagonal);
  std::vector<Vec3> onSkin;
  for (const Landmark& landmark : from.landmarks)
    if (isOnSkin(landmark.name)) onSkin.push_back(positionOf(landmark));
  std::vector<double> distances;
  for (const SurfacePoint& point : Surface(out.mesh).closest(onSkin)) distances.push_back(point.distance);
  out.offset = median(distances);
  out.neighbours = Neighbours(out.mesh);
  return out;
}

}  // namespace cagecast::cages
