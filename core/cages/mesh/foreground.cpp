#include "mesh/foreground.hpp"

#include <algorithm>
#include <array>

#include "mesh/bounds.hpp"
#include "mesh/triangle_mesh.hpp"

namespace cagecast::cages {

namespace {

/// How thick a ground or backdrop is at most, as a share of what stands before it, and by how much more it extends to
/// the sides.
constexpr double kThick = 0.1, kBeyond = 1.15;

std::array<double, 3> listed(const Vec3& v) { return {v.x, v.y, v.z}; }

/// Whether a piece is flat, and large beside the whole.
bool isSheet(const Bounds& box, double whole) {
  const auto size = listed(box.size());
  return *std::min_element(size.begin(), size.end()) <= kThick * box.diagonal() && 2 * box.diagonal() > whole;
}

/// Whether a piece is a ground under, or a wall beside, what the others are: flat, outside, wider, and not above their
/// foot.
bool isBackdrop(const Bounds& box, const Bounds& others) {
  const auto size = listed(box.size()), otherSize = listed(others.size());
  const auto low = listed(box.low), high = listed(box.high);
  const auto otherLow = listed(others.low), otherHigh = listed(others.high);
  for (std::size_t axis = 0; axis < 3; ++axis) {
    const double thick = kThick * otherSize[axis];
    const bool isOutside = high[axis] <= otherLow[axis] + thick || (axis != 1 && low[axis] >= otherHigh[axis] - thick);
    const bool isStanding = axis == 1 || low[1] <= otherLow[1] + kThick * otherSize[1];
    bool is = size[axis] <= thick && isOutside && isStanding;
    for (std::size_t k = 0; k < 3; ++k) is = is && (k == axis || size[k] > kBeyond * otherSize[k]);
    if (is) return true;
  }
  return false;
}

Bounds both(Bounds a, const Bounds& b) {
  if (!b.empty()) {
    a.add(b.low);
    a.add(b.high);
  }
  return a;
}

/// Whether each triangle is of no backdrop.
std::vector<bool> withoutBackdrop(const TriangleMesh& mesh) {
  std::uint32_t count = 0;
  const std::vector<std::uint32_t> pieces = connectedPieces(mesh, count);
  std::vector<Bounds> boxes(count);
  for (std::size_t t = 0; t < pieces.size(); ++t)
    for (const std::uint32_t v : mesh.triangles[t]) boxes[pieces[t]].add(mesh.positions[v]);
  const double whole = diagonalOf(mesh);
  Bounds others;
  for (const Bounds& box : boxes)
    if (!isSheet(box, whole)) others = both(others, box);
  std::vector<bool> keep(count, true);
  for (std::size_t i = 0; i < count; ++i)
    keep[i] = others.empty() || !isSheet(boxes[i], whole) || !isBackdrop(boxes[i], others);
  std::vector<bool> out(pieces.size());
  for (std::size_t t = 0; t < pieces.size(); ++t) out[t] = keep[pieces[t]];
  return out;
}

}  // namespace

Foreground::Foreground(const Model& model) : model_(model) {
  std::vector<std::uint32_t> triangleOf;
  const TriangleMesh mesh = weldExactly(model.mesh, nullptr, &triangleOf);
  const std::vector<bool> keep = withoutBackdrop(mesh);
  if (std::find(keep.begin(), keep.end(), false) == keep.end()) return;
  for (std::size_t t = 0; t < keep.size(); ++t) {
    if (!keep[t]) continue;
    const std::size_t first = 3 * std::size_t{triangleOf[t]};
    for (std::size_t k = 0; k < 3; ++k) indices_.push_back(model.mesh.indices[first + k]);
    if (!model.marks.empty()) marks_.push_back(model.marks[triangleOf[t]]);
  }
  model_.mesh.indices = indices_;
  model_.marks = marks_;
}

}  // namespace cagecast::cages
