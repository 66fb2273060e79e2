#include <algorithm>

#include "landmarks/parts.hpp"
#include "make/steps.hpp"
#include "mesh/part_names.hpp"

namespace cagecast::cages {

namespace {

/// How far beyond a face its skin is painted, too, in distances of the eyes: where hair begins, holes begin behind it.
constexpr double kBehindHairline = 0.4;

/// Whether a part lies over skin, and not beside an eye as lashes do.
bool coversSkin(const std::string& part) {
  return roleOf(part) == Role::cover && !matchesName(part, "*lash*") && !matchesName(part, "*line*");
}

}  // namespace

FaceSkin faceSkinOf(const Model& model, const MarkedMesh& marked, const std::vector<std::uint32_t>& triangleOf,
                    const FaceFrame& frame) {
  const TriangleMesh& mesh = *marked.mesh;
  const std::vector<bool>& isMarked = marked.isMarked;
  std::vector<bool> isCoverPart(model.parts.size());
  std::transform(model.parts.begin(), model.parts.end(), isCoverPart.begin(), coversSkin);
  const std::vector<bool> covers = trianglesOf(model.mesh, isCoverPart);
  FaceSkin face;
  face.isSkin.resize(isMarked.size());
  face.isCover.resize(isMarked.size());
  std::vector<bool> isOther(isMarked.size(), true);
  for (std::size_t t = 0; t < triangleOf.size(); ++t) {
    const bool isNear = frame.reaches(centroid(mesh, mesh.triangles[t]), kBehindHairline);
    face.isSkin[t] = isNear && !isMarked[t] && dot(areaNormal(mesh, mesh.triangles[t]), frame.front) > 0;
    face.isCover[t] = isMarked[t] && covers[triangleOf[t]];
    isOther[t] = !face.isCover[t];
  }
  for (std::uint32_t t = 0; t < isOther.size(); ++t)
    if (isOther[t]) face.triangleOf.push_back(t);
  face.others.emplace(subset(mesh, isOther));
  return face;
}

}  // namespace cagecast::cages
