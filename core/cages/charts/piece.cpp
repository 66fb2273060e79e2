#include "charts/steps.hpp"

#include <algorithm>
#include <numeric>
#include <utility>

#include "mesh/disjoint_sets.hpp"

namespace cagecast::cages {

Piece wholeOf(const TriangleMesh& mesh) {
  Piece piece;
  piece.mesh = mesh;
  piece.vertexOf.resize(mesh.positions.size());
  std::iota(piece.vertexOf.begin(), piece.vertexOf.end(), 0u);
  piece.triangleOf.resize(mesh.triangles.size());
  std::iota(piece.triangleOf.begin(), piece.triangleOf.end(), 0u);
  return piece;
}

Piece cutOpen(const Piece& piece, const std::vector<bool>& cut) {
  const TriangleMesh& mesh = piece.mesh;
  const std::vector<std::uint32_t> twins = halfEdgeTwins(mesh);
  DisjointSets corners(3 * mesh.triangles.size());
  for (std::size_t h = 0; h < twins.size(); ++h) {
    const std::uint32_t twin = twins[h];
    if (twin == kNone || twin < h || (!cut.empty() && (cut[h] || cut[twin]))) continue;
    corners.join(static_cast<std::uint32_t>(h), static_cast<std::uint32_t>(nextInTriangle(twin)));
    corners.join(static_cast<std::uint32_t>(nextInTriangle(h)), twin);
  }
  Piece out;
  out.triangleOf = piece.triangleOf;
  out.mesh.triangles.resize(mesh.triangles.size());
  std::vector<std::uint32_t> vertexOfCorner(3 * mesh.triangles.size(), kNone);
  for (std::uint32_t corner = 0; corner < vertexOfCorner.size(); ++corner) {
    std::uint32_t& vertex = vertexOfCorner[corners.find(corner)];
    if (vertex == kNone) {
      vertex = static_cast<std::uint32_t>(out.mesh.positions.size());
      out.mesh.positions.push_back(mesh.positions[originOf(mesh, corner)]);
      out.vertexOf.push_back(piece.vertexOf[originOf(mesh, corner)]);
    }
    out.mesh.triangles[corner / 3][corner % 3] = vertex;
  }
  return out;
}

std::vector<Piece> componentsOf(const Piece& piece) {
  const TriangleMesh& mesh = piece.mesh;
  const std::vector<std::uint32_t> twins = halfEdgeTwins(mesh);
  DisjointSets sets(mesh.triangles.size());
  for (std::size_t h = 0; h < twins.size(); ++h)
    if (twins[h] != kNone) sets.join(static_cast<std::uint32_t>(h / 3), twins[h] / 3);
  std::vector<std::uint32_t> pieceOf(mesh.triangles.size(), kNone), newVertex(mesh.positions.size(), kNone);
  std::vector<Piece> pieces;
  for (std::uint32_t t = 0; t < mesh.triangles.size(); ++t) {
    std::uint32_t& number = pieceOf[sets.find(t)];
    if (number == kNone) {
      number = static_cast<std::uint32_t>(pieces.size());
      pieces.emplace_back();
    }
    Piece& out = pieces[number];
    Triangle3 triangle = mesh.triangles[t];
    // A vertex of a piece has one fan of triangles, so it is in one component.
    for (std::uint32_t& v : triangle) {
      if (newVertex[v] == kNone) {
        newVertex[v] = static_cast<std::uint32_t>(out.mesh.positions.size());
        out.mesh.positions.push_back(mesh.positions[v]);
        out.vertexOf.push_back(piece.vertexOf[v]);
      }
      v = newVertex[v];
    }
    out.mesh.triangles.push_back(triangle);
    out.triangleOf.push_back(piece.triangleOf[t]);
  }
  return pieces;
}

std::vector<Piece> piecesOf(const Piece& piece, std::span<const std::uint32_t> regions, std::uint32_t region) {
  return componentsOf(cutOpen(partOf(piece, [&](std::size_t t) { return regions[t] == region; })));
}

std::vector<Piece> splitBy(const Piece& piece, std::span<const std::uint32_t> regions) {
  std::uint32_t count = 0;
  for (const std::uint32_t region : regions) count = std::max(count, region + 1);
  std::vector<Piece> pieces;
  for (std::uint32_t region = 0; region < count; ++region)
    for (Piece& component : piecesOf(piece, regions, region)) pieces.push_back(std::move(component));
  return pieces;
}

std::vector<std::uint32_t> originsOf(const TriangleMesh& mesh, std::span<const std::uint32_t> walk) {
  std::vector<std::uint32_t> vertices;
  for (const std::uint32_t h : walk) vertices.push_back(originOf(mesh, h));
  return vertices;
}

double lengthOf(const TriangleMesh& mesh, std::span<const std::uint32_t> walk) {
  double sum = 0;
  for (const std::uint32_t h : walk) sum += length(mesh.positions[endOf(mesh, h)] - mesh.positions[originOf(mesh, h)]);
  return sum;
}

std::vector<std::vector<std::uint32_t>> loopsOf(const TriangleMesh& mesh, std::span<const std::uint32_t> twins) {
  std::vector<std::uint32_t> open(mesh.positions.size(), kNone);
  for (std::uint32_t h = 0; h < twins.size(); ++h)
    if (twins[h] == kNone) open[originOf(mesh, h)] = h;
  std::vector<bool> done(twins.size());
  std::vector<std::vector<std::uint32_t>> loops;
  for (std::uint32_t h = 0; h < twins.size(); ++h) {
    if (twins[h] != kNone || done[h]) continue;
    std::vector<std::uint32_t> loop;
    for (std::uint32_t at = h; at != kNone && !done[at]; at = open[endOf(mesh, at)]) {
      done[at] = true;
      loop.push_back(at);
    }
    loops.push_back(std::move(loop));
  }
  std::vector<std::pair<double, std::size_t>> order;
  order.reserve(loops.size());
  for (std::size_t i = 0; i < loops.size(); ++i) order.emplace_back(-lengthOf(mesh, loops[i]), i);
  std::sort(order.begin(), order.end());
  std::vector<std::vector<std::uint32_t>> sorted;
  sorted.reserve(loops.size());
  for (const auto& [length, i] : order) sorted.push_back(std::move(loops[i]));
  return sorted;
}

}  // namespace cagecast::cages
