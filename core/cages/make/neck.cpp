#include "make/neck.hpp"

#include <algorithm>
#include <cmath>

#include "hull/hull.hpp"

namespace cagecast::cages {

namespace {

/// An opening of at least this width, in diagonals, is a neck,
constexpr double kLeastWidth = 0.2;
/// if this share of the head is on one side of it.
constexpr double kBehind = 0.97;
/// A hull belongs to a neck as far as this from its axis and its plane, in radii of the opening.
constexpr double kReach = 1.3;

/// The plane of an opening.
Neck planeOf(const TriangleMesh& head, const Opening& opening) {
  const std::vector<std::uint32_t>& loop = opening.loop;
  const std::size_t n = loop.size();
  Neck neck;
  Vec3 area{0, 0, 0};
  for (std::size_t i = 0; i < n; ++i) {
    const Vec3& p = head.positions[loop[i]];
    neck.middle = neck.middle + 1 / static_cast<double>(n) * p;
    area = area + cross(head.positions[loop[(i + 1) % n]] - head.positions[loop[0]], p - head.positions[loop[0]]);
  }
  neck.normal = length(area) > 0 ? 1 / length(area) * area : Vec3{0, -1, 0};
  // Away from most of the head, also where its triangles are turned inside out.
  std::size_t before = 0;
  for (const Vec3& p : head.positions) before += dot(p - neck.middle, neck.normal) > 0 ? 1 : 0;
  if (2 * before > head.positions.size()) neck.normal = -1 * neck.normal;
  neck.height = -INFINITY;
  for (const std::uint32_t v : loop) neck.height = std::max(neck.height, dot(head.positions[v], neck.normal));
  return neck;
}

/// Whether a head ends at an opening.
bool isNeck(const TriangleMesh& head, const Opening& opening) {
  const Neck neck = planeOf(head, opening);
  const auto behind = std::count_if(head.positions.begin(), head.positions.end(),
                                    [&](const Vec3& p) { return dot(p, neck.normal) <= neck.height; });
  return static_cast<double>(behind) >= kBehind * static_cast<double>(head.positions.size());
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
  std::vector<Opening> openings;
  closeOpenings(head, kLeastWidth * diagonalOf(head), &openings);
  std::vector<Neck> necks;
  const TriangleMesh own = head;
  for (const Opening& opening : openings)
    if (isNeck(own, opening)) necks.push_back(extend(opening, by, head));
  return necks;
}

void openNecks(const TriangleMesh& hull, const std::vector<Neck>& necks, std::vector<double>& field) {
  if (hull.triangles.empty()) return;
  // The field rises from 0 to 1 within about an edge on both sides of the plane.
  const double edge = std::sqrt(2 * length(areaNormal(hull, hull.triangles[0])));
  for (const Neck& neck : necks)
    for (std::size_t v = 0; v < field.size(); ++v) {
      const Vec3 offset = hull.positions[v] - neck.middle;
      const double height = dot(offset, neck.normal);
      if (length(offset) > kReach * neck.radius) continue;
      field[v] = std::max(field[v], std::clamp(0.5 + height / (4 * edge), 0.0, 1.0));
    }
}

}  // namespace cagecast::cages
