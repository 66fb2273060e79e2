#include "fit/steps.hpp"

#include "mesh/surface.hpp"

namespace cagecast::cages {

namespace {

/// Length of a rim around, at least, in diagonals: necks have 1 to 2, eyes at most 0.4.
constexpr double kMinRim = 0.7;
/// Area within a rim, at most, as a share of the mesh's: necks have less than 0.15, the outlines of face masks more
/// than 0.5.
constexpr double kMaxWithin = 0.3;

/// Twice the area of a flat figure within a loop; of its shadow on the plane where it is largest if it is not flat.
double areaWithin(const TriangleMesh& mesh, const std::vector<std::uint32_t>& loop) {
  Vec3 area{0, 0, 0};
  const Vec3 first = mesh.positions[loop.front()];
  for (std::size_t k = 0; k + 1 < loop.size(); ++k)
    area = area + cross(mesh.positions[loop[k]] - first, mesh.positions[loop[k + 1]] - first);
  return length(area);
}

}  // namespace

bool isOnSkin(const std::string& name) { return !isJoint(name) && !name.starts_with("eye_centre"); }

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
  if (best < 0) return best;
  double area = 0;
  for (const Triangle3& t : mesh.triangles)
    area += length(cross(mesh.positions[t[1]] - mesh.positions[t[0]], mesh.positions[t[2]] - mesh.positions[t[0]]));
  return areaWithin(mesh, loops[static_cast<std::size_t>(best)]) < kMaxWithin * area ? best : -1;
}

Axes axesOf(const std::vector<Landmark>& landmarks) {
  Axes axes;
  Vec3 left{0, 0, 0}, middle{0, 0, 0};
  double pairs = 0;
  for (const Landmark& landmark : landmarks) {
    const auto other = placeOf(landmarks, mirrorName(landmark.name));
    if (!landmark.name.ends_with("_left") || !other) continue;
    left = left + (positionOf(landmark) - *other);
    middle = middle + 0.5 * (positionOf(landmark) + *other);
    ++pairs;
  }
  const auto at = [&](const char* name) { return placeOf(landmarks, name); };
  const auto eyeLeft = at("eye_centre_left"), eyeRight = at("eye_centre_right");
  if (pairs == 0 || !(length(left) > 0) || !at("nose_tip") || !eyeLeft || !eyeRight) return axes;
  axes.left = unit(left);
  axes.middle = 1 / pairs * middle;
  Vec3 upright{0, 1, 0};
  for (const char* low : {"mouth", "lip_lower", "chin"})
    if (at(low)) upright = 0.5 * (*eyeLeft + *eyeRight) - *at(low);
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
  out.offset = medianOf(distances);
  out.neighbours = Neighbours(out.mesh);
  return out;
}

}  // namespace cagecast::cages
