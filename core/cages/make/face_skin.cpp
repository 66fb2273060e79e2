#include <algorithm>
#include <cmath>

#include "landmarks/eyes.hpp"
#include "make/steps.hpp"
#include "mesh/part_names.hpp"

namespace cagecast::cages {

namespace {

/// How far a face reaches from the middle between its eyes: to the sides, up, down and back; in distances of the eyes.
constexpr double kAside = 1.3, kUp = 0.9, kDown = 1.7, kBack = 0.9;

/// Whether a part lies over skin, and not beside an eye as lashes do.
bool coversSkin(const std::string& part) {
  return roleOf(part) == Role::cover && !matchesName(part, "*lash*") && !matchesName(part, "*line*");
}

}  // namespace

FaceSkin faceSkinOf(const Model& model, const TriangleMesh& mesh, const std::vector<bool>& isMarked) {
  const Figure figure = readFigure(model);
  std::optional<Eyes> eyes = findHintedEyes(figure, model.hints);
  if (!eyes) eyes = findNamedEyes(figure);
  if (!eyes) eyes = findJointedEyes(figure, figure.rig.joints);
  if (!eyes) return {};
  const double unit = length(eyes->centres[0] - eyes->centres[1]);
  std::vector<bool> isCoverPart(model.parts.size());
  std::transform(model.parts.begin(), model.parts.end(), isCoverPart.begin(), coversSkin);
  const std::vector<bool> covers = trianglesOf(model.mesh, isCoverPart);
  FaceSkin face;
  face.isSkin.resize(isMarked.size());
  face.isCover.resize(isMarked.size());
  std::vector<bool> isOther(isMarked.size(), true);
  for (std::size_t t = 0; t < figure.triangleOf.size(); ++t) {
    const Vec3 d = 1 / unit * (centroid(mesh, mesh.triangles[t]) - eyes->middle());
    const double aside = std::abs(dot(d, eyes->left)), forward = dot(d, eyes->front);
    const bool isNear = aside < kAside && d.y < kUp && d.y > -kDown && forward > -kBack;
    face.isSkin[t] = isNear && !isMarked[t] && dot(areaNormal(mesh, mesh.triangles[t]), eyes->front) > 0;
    face.isCover[t] = isMarked[t] && covers[figure.triangleOf[t]];
    isOther[t] = !face.isCover[t];
  }
  for (std::uint32_t t = 0; t < isOther.size(); ++t)
    if (isOther[t]) face.triangleOf.push_back(t);
  face.others.emplace(subset(mesh, isOther));
  return face;
}

}  // namespace cagecast::cages
