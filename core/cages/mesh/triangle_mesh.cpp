#include "mesh/triangle_mesh.hpp"

#include <algorithm>
#include <cstring>
#include <map>
#include <unordered_map>

#include "mesh/bounds.hpp"
#include "mesh/disjoint_sets.hpp"

namespace cagecast::cages {

namespace {

/// Drops vertices that no triangle uses; the others keep their order.
void dropUnused(TriangleMesh& mesh) {
  std::vector<std::uint32_t> newVertex(mesh.positions.size(), 0);
  for (const Triangle3& t : mesh.triangles)
    for (const std::uint32_t v : t) newVertex[v] = 1;
  std::uint32_t count = 0;
  for (std::size_t v = 0; v < newVertex.size(); ++v) {
    if (newVertex[v] == 0) continue;
    mesh.positions[count] = mesh.positions[v];
    newVertex[v] = count++;
  }
  mesh.positions.resize(count);
  for (Triangle3& t : mesh.triangles)
    for (std::uint32_t& v : t) v = newVertex[v];
}

/// The number of a vertex in another mesh, which gets it if it does not have it yet.
/// @param[in,out] newVertex  Per vertex of `from`; `kNone` for those that are not in `to`.
std::uint32_t keepVertex(const TriangleMesh& from, std::uint32_t vertex, std::vector<std::uint32_t>& newVertex,
                         TriangleMesh& to) {
  if (newVertex[vertex] == kNone) {
    newVertex[vertex] = static_cast<std::uint32_t>(to.positions.size());
    to.positions.push_back(from.positions[vertex]);
  }
  return newVertex[vertex];
}

}  // namespace

TriangleMesh weldExactly(const MeshView& mesh, std::vector<std::uint32_t>* vertexOf,
                         std::vector<std::uint32_t>* triangleOf) {
  struct Hash {
    std::size_t operator()(const std::array<float, 3>& p) const noexcept {
      std::uint32_t bits[3];
      std::memcpy(bits, p.data(), sizeof bits);
      std::size_t hash = bits[0];
      hash = hash * 0x9E3779B1u + bits[1];
      return hash * 0x9E3779B1u + bits[2];
    }
  };
  TriangleMesh out;
  const std::size_t count = mesh.positions.size() / 3;
  std::vector<std::uint32_t> newVertex(count);
  std::unordered_map<std::array<float, 3>, std::uint32_t, Hash> seen;
  seen.reserve(count);
  for (std::size_t v = 0; v < count; ++v) {
    std::array<float, 3> p;
    for (std::size_t k = 0; k < 3; ++k) p[k] = mesh.positions[3 * v + k] + 0.0f;  // -0 becomes 0.
    const auto [found, isNew] = seen.try_emplace(p, static_cast<std::uint32_t>(out.positions.size()));
    if (isNew) out.positions.push_back(Vec3::from(p.data()));
    newVertex[v] = found->second;
  }
  for (std::size_t t = 0; t < mesh.indices.size() / 3; ++t) {
    const Triangle3 triangle = {newVertex[mesh.indices[3 * t]], newVertex[mesh.indices[3 * t + 1]],
                                newVertex[mesh.indices[3 * t + 2]]};
    if (!(length(areaNormal(out, triangle)) > 0)) continue;
    out.triangles.push_back(triangle);
    if (triangleOf != nullptr) triangleOf->push_back(static_cast<std::uint32_t>(t));
  }
  if (vertexOf == nullptr)
    dropUnused(out);
  else
    *vertexOf = std::move(newVertex);
  return out;
}

TriangleMesh subset(const TriangleMesh& mesh, const std::vector<bool>& keepTriangle) {
  TriangleMesh out;
  std::vector<std::uint32_t> newVertex(mesh.positions.size(), kNone);
  for (std::size_t t = 0; t < mesh.triangles.size(); ++t) {
    if (!keepTriangle[t]) continue;
    Triangle3 triangle = mesh.triangles[t];
    for (std::uint32_t& v : triangle) v = keepVertex(mesh, v, newVertex, out);
    out.triangles.push_back(triangle);
  }
  return out;
}

std::vector<std::uint32_t> connectedPieces(const TriangleMesh& mesh, std::uint32_t& count) {
  DisjointSets sets(mesh.triangles.size());
  std::vector<std::uint32_t> firstAt(mesh.positions.size(), kNone);  // The first triangle at each vertex.
  for (std::uint32_t t = 0; t < mesh.triangles.size(); ++t)
    for (const std::uint32_t v : mesh.triangles[t]) {
      if (firstAt[v] == kNone) firstAt[v] = t;
      sets.join(t, firstAt[v]);
    }
  return sets.numbers(count);
}

std::vector<TriangleMesh> split(const TriangleMesh& mesh, const std::vector<std::uint32_t>& pieces,
                                std::uint32_t count) {
  std::vector<TriangleMesh> out(count);
  std::vector<std::uint32_t> newVertex(mesh.positions.size(), kNone);  // A vertex is in one piece.
  for (std::size_t t = 0; t < pieces.size(); ++t) {
    if (pieces[t] == kNone) continue;
    TriangleMesh& piece = out[pieces[t]];
    Triangle3 triangle = mesh.triangles[t];
    for (std::uint32_t& v : triangle) v = keepVertex(mesh, v, newVertex, piece);
    piece.triangles.push_back(triangle);
  }
  return out;
}

double areaOf(const TriangleMesh& mesh) {
  double area = 0;
  for (const Triangle3& t : mesh.triangles) area += areaOf(mesh, t);
  return area;
}

double diagonalOf(const TriangleMesh& mesh) { return boundsOf(mesh).diagonal(); }

double distanceToSegment(const Vec3& p, const Vec3& a, const Vec3& b) {
  const Vec3 edge = b - a;
  const double square = dot(edge, edge);
  const double share = square > 0 ? std::clamp(dot(p - a, edge) / square, 0.0, 1.0) : 0;
  return length(p - (a + share * edge));
}

double medianOf(std::vector<double> values) {
  if (values.empty()) return 0;
  const auto middle = values.begin() + static_cast<std::ptrdiff_t>(values.size() / 2);
  std::nth_element(values.begin(), middle, values.end());
  return *middle;
}

Vec3 meanOf(std::span<const Vec3> points) {
  Vec3 sum{0, 0, 0};
  for (const Vec3& p : points) sum = sum + p;
  return 1 / static_cast<double>(points.size()) * sum;
}

Vec3 middleOf(const TriangleMesh& mesh, const std::vector<std::uint32_t>& vertices) {
  Vec3 sum{0, 0, 0};
  for (const std::uint32_t v : vertices) sum = sum + mesh.positions[v];
  return 1 / static_cast<double>(vertices.size()) * sum;
}

std::vector<Vec3> vertexNormals(const TriangleMesh& mesh) {
  std::vector<Vec3> normals(mesh.positions.size(), Vec3{0, 0, 0});
  for (const Triangle3& t : mesh.triangles) {
    const Vec3 n = areaNormal(mesh, t);
    for (const std::uint32_t v : t) normals[v] = normals[v] + n;
  }
  for (Vec3& n : normals) n = unit(n);
  return normals;
}

std::vector<std::vector<std::uint32_t>> boundaryLoops(const TriangleMesh& mesh) {
  std::vector<std::pair<std::uint32_t, std::uint32_t>> edges;
  edges.reserve(3 * mesh.triangles.size());
  for (const Triangle3& t : mesh.triangles)
    for (std::size_t i = 0; i < 3; ++i) edges.emplace_back(t[i], t[(i + 1) % 3]);
  std::sort(edges.begin(), edges.end());
  edges.erase(std::unique(edges.begin(), edges.end()), edges.end());
  std::multimap<std::uint32_t, std::uint32_t> next;
  for (const auto& [from, to] : edges)
    if (!std::binary_search(edges.begin(), edges.end(), std::pair(to, from))) next.emplace(from, to);
  std::vector<std::vector<std::uint32_t>> loops;
  while (!next.empty()) {
    std::vector<std::uint32_t> loop;
    const std::uint32_t start = next.begin()->first;
    for (auto edge = next.begin(); edge != next.end(); edge = next.find(loop.back())) {
      if (loop.empty()) loop.push_back(start);
      const std::uint32_t to = edge->second;
      next.erase(edge);
      if (to == start) break;
      loop.push_back(to);
    }
    loops.push_back(std::move(loop));
  }
  return loops;
}

}  // namespace cagecast::cages
