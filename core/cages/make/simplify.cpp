#include "make/simplify.hpp"

#include <meshoptimizer.h>

#include <algorithm>
#include <cmath>
#include <numbers>

namespace cagecast::cages {

namespace {

constexpr double kLeastLocks = 5;
constexpr double kMostLocks = 12;

double areaOf(const TriangleMesh& mesh) {
  double area = 0;
  for (const Triangle3& t : mesh.triangles) area += length(areaNormal(mesh, t)) / 2;
  return area;
}

/// Locks vertices of a loop at equal distances, about as far apart as the edges of the result will be long.
void lockLoop(const TriangleMesh& mesh, const std::vector<std::uint32_t>& loop, double edge,
              std::vector<unsigned char>& locks) {
  std::vector<double> along(loop.size() + 1, 0);
  for (std::size_t i = 0; i < loop.size(); ++i) {
    const Vec3& next = mesh.positions[loop[(i + 1) % loop.size()]];
    along[i + 1] = along[i] + length(next - mesh.positions[loop[i]]);
  }
  const double count = std::clamp(std::round(along.back() / edge), kLeastLocks, kMostLocks);
  std::size_t i = 0;
  for (double k = 0; k < count; ++k) {
    const double at = k / count * along.back();
    while (i + 1 < loop.size() && along[i + 1] <= at) ++i;
    locks[loop[i]] = 1;
  }
}

}  // namespace

TriangleMesh simplify(const TriangleMesh& mesh, std::uint32_t triangles) {
  std::vector<unsigned char> locks(mesh.positions.size(), 0);
  // Of an equilateral triangle of the mean area.
  const double edge = std::sqrt(4 / std::numbers::sqrt3 * areaOf(mesh) / triangles);
  for (const auto& loop : boundaryLoops(mesh)) lockLoop(mesh, loop, edge, locks);
  std::vector<float> positions;
  positions.reserve(3 * mesh.positions.size());
  for (const Vec3& p : mesh.positions)
    for (const double x : {p.x, p.y, p.z}) positions.push_back(static_cast<float>(x));
  std::vector<unsigned> indices;
  indices.reserve(3 * mesh.triangles.size());
  for (const Triangle3& t : mesh.triangles) indices.insert(indices.end(), t.begin(), t.end());
  std::vector<unsigned> result(indices.size());
  constexpr float kAnyError = 1;  // The count decides.
  const std::size_t count = meshopt_simplifyWithAttributes(
      result.data(), indices.data(), indices.size(), positions.data(), mesh.positions.size(), 3 * sizeof(float),
      nullptr, 0, nullptr, 0, locks.data(), std::size_t{3} * triangles, kAnyError, 0, nullptr);
  TriangleMesh out;
  out.positions = mesh.positions;
  for (std::size_t i = 0; i + 2 < count; i += 3) out.triangles.push_back({result[i], result[i + 1], result[i + 2]});
  return subset(out, std::vector<bool>(out.triangles.size(), true));
}

}  // namespace cagecast::cages
