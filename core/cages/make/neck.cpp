#include "make/steps.hpp"

#include <algorithm>
#include <cmath>

#include "hull/hull.hpp"
#include "mesh/bounds.hpp"

namespace cagecast::cages {

namespace {

/// An opening is a neck if all of these hold: it is at least this wide, in diagonals;
constexpr double kMinWidth = 0.2;
/// at least this share of the head is on one side of it;
constexpr double kBehind = 0.97;
/// and its own piece reaches at least this far to that side, in widths of the opening: a sheet, such as a strand of
/// hair or a visor, does not.
constexpr double kMinDepth = 0.1;
/// The hull is opened as far as this from the middle of a neck, in radii of the opening.
constexpr double kOpenedRadius = 1.3;

/// The normal of the area that a loop encloses, on either side.
Vec3 normalOf(const TriangleMesh& head, const std::vector<std::uint32_t>& loop) {
  Vec3 area{0, 0, 0};
  const Vec3& first = head.positions[loop[0]];
  for (std::size_t i = 0; i < loop.size(); ++i)
    area = area + cross(head.positions[loop[(i + 1) % loop.size()]] - first, head.positions[loop[i]] - first);
  return length(area) > 0 ? unit(area) : Vec3{0, -1, 0};
}

/// The plane of an opening.
Neck planeOf(const TriangleMesh& head, const Opening& opening) {
  const std::vector<std::uint32_t>& loop = opening.loop;
  Neck neck;
  neck.middle = middleOf(head, loop);
  neck.normal = normalOf(head, loop);
  // Away from most of the head, also where its triangles are turned inside out.
  std::size_t before = 0;
  for (const Vec3& p : head.positions) before += dot(p - neck.middle, neck.normal) > 0 ? 1 : 0;
  if (2 * before > head.positions.size()) neck.normal = -1 * neck.normal;
  neck.height = -INFINITY;
  for (const std::uint32_t v : loop) neck.height = std::max(neck.height, dot(head.positions[v], neck.normal));
  return neck;
}

/// The connected pieces of a mesh, and the piece of each vertex.
struct Pieces {
  std::vector<TriangleMesh> meshes;
  std::vector<std::uint32_t> of;

  explicit Pieces(const TriangleMesh& mesh) : of(mesh.positions.size(), 0) {
    std::uint32_t count = 0;
    const std::vector<std::uint32_t> pieces = connectedPieces(mesh, count);
    meshes = split(mesh, pieces, count);
    for (std::size_t t = 0; t < pieces.size(); ++t)
      for (const std::uint32_t v : mesh.triangles[t]) of[v] = pieces[t];
  }
};

/// Whether a head ends at an opening.
bool isNeck(const TriangleMesh& head, const Pieces& pieces, const Opening& opening) {
  // A model may have thousands of sheets: their own vertices tell them, without a look at the whole head.
  const Vec3 normal = normalOf(head, opening.loop);
  Range border;
  for (const std::uint32_t v : opening.loop) border.add(dot(head.positions[v], normal));
  const Range own = rangeOf(pieces.meshes[pieces.of[opening.loop[0]]].positions, normal);
  const double below = border.low - own.low, above = own.high - border.high;
  const double leastDepth = kMinDepth * opening.width;
  if (below < leastDepth && above < leastDepth) return false;
  const Neck neck = planeOf(head, opening);
  const double depth = dot(neck.normal, normal) > 0 ? below : above;
  const auto behind = std::count_if(head.positions.begin(), head.positions.end(),
                                    [&](const Vec3& p) { return dot(p, neck.normal) <= neck.height; });
  return depth >= leastDepth && static_cast<double>(behind) >= kBehind * static_cast<double>(head.positions.size());
}

Neck extend(const Opening& opening, double by, TriangleMesh& head) {
  const std::vector<std::uint32_t>& loop = opening.loop;
  const auto n = static_cast<std::uint32_t>(loop.size());
  Neck neck = planeOf(head, opening);
  neck.height += by;
  const auto onPlane = [&](const Vec3& p) { return p + (neck.height - dot(p, neck.normal)) * neck.normal; };
  neck.middle = onPlane(neck.middle);
  const auto first = static_cast<std::uint32_t>(head.positions.size());
  for (const std::uint32_t v : loop) {
    const Vec3 p = onPlane(head.positions[v]);
    neck.radius = std::max(neck.radius, length(p - neck.middle));
    head.positions.push_back(p);
  }
  for (std::uint32_t i = 0; i < n; ++i) {
    const std::uint32_t j = (i + 1) % n;
    head.triangles.push_back({loop[j], loop[i], first + i});
    head.triangles.push_back({loop[j], first + i, first + j});
  }
  return neck;
}

}  // namespace

std::vector<Neck> extendNecks(double by, TriangleMesh& head) {
  std::vector<Neck> necks;
  const TriangleMesh own = head;
  const Pieces pieces(own);
  for (const Opening& opening : findOpenings(own, kMinWidth * diagonalOf(own)))
    if (isNeck(own, pieces, opening)) necks.push_back(extend(opening, by, head));
  return necks;
}

void openNecks(const TriangleMesh& hull, const std::vector<Neck>& necks, std::vector<double>& field) {
  if (hull.triangles.empty()) return;
  // The field rises from 0 to 1 between two edges above and two edges below the plane, about.
  const double edge = std::sqrt(2 * length(areaNormal(hull, hull.triangles[0])));
  for (const Neck& neck : necks)
    for (std::size_t v = 0; v < field.size(); ++v) {
      const Vec3 offset = hull.positions[v] - neck.middle;
      const double height = dot(offset, neck.normal);
      if (length(offset) > kOpenedRadius * neck.radius) continue;
      field[v] = std::max(field[v], std::clamp(0.5 + height / (4 * edge), 0.0, 1.0));
    }
}

}  // namespace cagecast::cages
