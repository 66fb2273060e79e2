#include "search/flat_triangles.hpp"

#include <cmath>
#include <cstddef>

#include "search/box.hpp"

namespace cagecast {

void setTriangle(FlatLeaf& leaf, std::uint32_t lane, const Triangle& triangle, const float* centre) noexcept {
  const Vec3 corners[3] = {Vec3::from(triangle.a), Vec3::from(triangle.b), Vec3::from(triangle.c)};
  std::size_t longest = 0;
  double most = 0;
  for (std::size_t i = 0; i < 3; ++i) {
    const Vec3 edge = corners[(i + 1) % 3] - corners[i];
    if (dot(edge, edge) > most) {
      most = dot(edge, edge);
      longest = i;
    }
  }
  const Vec3 a = corners[longest];
  const Vec3 ab = corners[(longest + 1) % 3] - a;
  const Vec3 ac = corners[(longest + 2) % 3] - a;
  const double base = length(ab);
  const Vec3 axisX = 1 / base * ab;
  const Vec3& axisZ = triangle.normal.exact;
  const Vec3 axisY = cross(axisZ, axisX);
  const double footX = dot(ac, axisX);
  const double height = dot(ac, axisY);

  const auto put = [lane](float(&to)[4], double value) { to[lane] = static_cast<float>(value); };
  const auto putAxis = [&put, fromA = Vec3::from(centre) - a](FlatLeaf::Axis& axis, Vec3 direction) {
    put(axis.offset, dot(fromA, direction));
    put(axis.direction[0], direction.x);
    put(axis.direction[1], direction.y);
    put(axis.direction[2], direction.z);
  };
  const auto putEdge = [&](double toFoot, float(&x)[4], float(&y)[4], float(&along)[4]) {
    const double edgeLength = std::sqrt(toFoot * toFoot + height * height);
    put(x, toFoot / edgeLength);
    put(y, height / edgeLength);
    put(along, edgeLength);
  };
  putAxis(leaf.axes[0], axisX);
  putAxis(leaf.axes[1], axisY);
  putAxis(leaf.axes[2], axisZ);
  put(leaf.base, base);
  put(leaf.foot, footX);
  putEdge(footX, leaf.leftX, leaf.leftY, leaf.leftLength);
  putEdge(base - footX, leaf.rightX, leaf.rightY, leaf.rightLength);
}

void clearTriangle(FlatLeaf& leaf, std::uint32_t lane) noexcept {
  for (int i = 0; i < 3; ++i) {
    leaf.axes[i].offset[lane] = Box::kFar;
    for (int k = 0; k < 3; ++k) leaf.axes[i].direction[k][lane] = i == k ? 1.0f : 0.0f;
  }
  leaf.base[lane] = leaf.foot[lane] = 0;
  leaf.leftX[lane] = leaf.leftY[lane] = leaf.leftLength[lane] = 0;
  leaf.rightX[lane] = leaf.rightY[lane] = leaf.rightLength[lane] = 0;
  leaf.cageTriangles[lane] = 0;
}

FlatTriangles<1> triangleOf(const FlatLeaf& leaf, std::uint32_t lane) noexcept {
  FlatTriangles<1> one;
  for (int i = 0; i < 3; ++i) {
    one.axes[i].offset[0] = leaf.axes[i].offset[lane];
    for (int k = 0; k < 3; ++k) one.axes[i].direction[k][0] = leaf.axes[i].direction[k][lane];
  }
  one.leftX[0] = leaf.leftX[lane];
  one.leftY[0] = leaf.leftY[lane];
  one.leftLength[0] = leaf.leftLength[lane];
  one.rightX[0] = leaf.rightX[lane];
  one.rightY[0] = leaf.rightY[lane];
  one.rightLength[0] = leaf.rightLength[lane];
  one.base[0] = leaf.base[lane];
  one.foot[0] = leaf.foot[lane];
  return one;
}

}  // namespace cagecast
