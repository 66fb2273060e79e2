#include "hull/steps.hpp"
#include "mesh/progress.hpp"

#include <algorithm>
#include <array>

namespace cagecast::cages {

namespace {

/// Vertices keep this share of an edge away from its ends, so that no triangle is a sliver.
constexpr double kFromEnds = 0.1;

/// Corner c of a cell is at (c & 1, c >> 1 & 1, c >> 2). Edge e runs along axis e / 4 from corner `kEdgeFrom[e]`.
constexpr std::array<std::uint8_t, 12> kEdgeFrom = {0, 2, 4, 6, 0, 1, 4, 5, 0, 1, 2, 3};

constexpr unsigned edgeTo(unsigned e) { return kEdgeFrom[e] + (1u << (e / 4)); }

unsigned edgeBetween(unsigned c, unsigned d) {
  for (unsigned e = 0; e < 12; ++e)
    if ((kEdgeFrom[e] == c && edgeTo(e) == d) || (kEdgeFrom[e] == d && edgeTo(e) == c)) return e;
  return 12;
}

/// Whether two edges of a cell lie on a common face: a diagonal between them could be one of the neighbour, too.
bool shareFace(unsigned e, unsigned f) {
  for (unsigned axis = 0; axis < 3; ++axis)
    for (unsigned side = 0; side < 2; ++side) {
      const auto on = [&](unsigned corner) { return (corner >> axis & 1) == side; };
      if (on(kEdgeFrom[e]) && on(edgeTo(e)) && on(kEdgeFrom[f]) && on(edgeTo(f))) return true;
    }
  return false;
}

/// The polygons of a cell, by the signs of its corners. Each is a cycle of edges; `apex` is where its fan of triangles
/// starts, or -1 if it needs a vertex in the middle.
struct CellPolygon {
  std::array<std::uint8_t, 12> edges{};
  std::uint8_t count = 0;
  std::int8_t apex = -1;
};
using CellPolygons = std::vector<CellPolygon>;

int findApex(const CellPolygon& polygon) {
  const unsigned n = polygon.count;
  for (unsigned apex = 0; apex < n; ++apex) {
    bool good = true;
    for (unsigned i = 2; i + 1 < n && good; ++i) good = !shareFace(polygon.edges[apex], polygon.edges[(apex + i) % n]);
    if (good) return static_cast<int>(apex);
  }
  return -1;
}

CellPolygons polygonsOf(unsigned signs) {
  // On each face, walk around it as seen from outside. The surface enters it where the walk goes from negative to
  // positive, and leaves at the next change: so positive corners are kept apart.
  std::array<std::uint8_t, 12> next;
  next.fill(12);
  for (unsigned axis = 0; axis < 3; ++axis)
    for (unsigned side = 0; side < 2; ++side) {
      const unsigned u = 1u << (axis + 1) % 3, v = 1u << (axis + 2) % 3, base = side << axis;
      std::array<unsigned, 4> walk = {base, base | u, base | u | v, base | v};  // Counter-clockwise seen from +axis.
      if (side == 0) std::swap(walk[1], walk[3]);
      for (unsigned i = 0; i < 4; ++i) {
        const unsigned from = walk[i], to = walk[(i + 1) % 4];
        if ((signs >> from & 1) != 0 || (signs >> to & 1) == 0) continue;
        unsigned j = (i + 1) % 4;
        while ((signs >> walk[(j + 1) % 4] & 1) != 0) j = (j + 1) % 4;
        next[edgeBetween(from, to)] = static_cast<std::uint8_t>(edgeBetween(walk[j], walk[(j + 1) % 4]));
      }
    }
  CellPolygons polygons;
  std::array<bool, 12> taken{};
  for (std::uint8_t start = 0; start < 12; ++start) {
    if (next[start] == 12 || taken[start]) continue;
    CellPolygon polygon;
    for (std::uint8_t e = start; !taken[e]; e = next[e]) {
      taken[e] = true;
      polygon.edges[polygon.count++] = e;
    }
    polygon.apex = static_cast<std::int8_t>(findApex(polygon));
    polygons.push_back(polygon);
  }
  return polygons;
}

class Marcher {
 public:
  Marcher(const VoxelGrid& grid, const std::vector<float>& values) : grid_(grid), values_(values) {
    for (unsigned signs = 0; signs < 256; ++signs) table_[signs] = polygonsOf(signs);
    const std::size_t layer = std::size_t{grid.nx} * grid.ny;
    for (auto& half : vertices_)
      for (auto& axis : half) axis.assign(layer, kNone);
  }

  bool run(const Progress& progress, TriangleMesh& out) {
    for (std::uint32_t z = 0; z + 1 < grid_.nz; ++z) {
      if (!report(progress, z, grid_.nz, "hull")) return false;
      for (std::uint32_t y = 0; y + 1 < grid_.ny; ++y)
        for (std::uint32_t x = 0; x + 1 < grid_.nx; ++x) cell(x, y, z);
      vertices_[0].swap(vertices_[1]);
      for (auto& axis : vertices_[1]) std::fill(axis.begin(), axis.end(), kNone);
    }
    out = std::move(out_);
    return true;
  }

 private:
  void cell(std::uint32_t x, std::uint32_t y, std::uint32_t z) {
    const std::size_t i = grid_.index(x, y, z);
    const std::size_t row = grid_.nx, layer = row * grid_.ny;
    unsigned signs = 0;
    for (unsigned c = 0; c < 8; ++c) {
      const std::size_t node = i + (c & 1) + (c >> 1 & 1) * row + (c >> 2) * layer;
      signs |= (values_[node] > 0 ? 1u : 0u) << c;
    }
    if (signs == 0 || signs == 255) return;
    for (const CellPolygon& polygon : table_[signs]) {
      std::array<std::uint32_t, 12> v;
      for (unsigned k = 0; k < polygon.count; ++k) v[k] = vertexOn(polygon.edges[k], x, y, z);
      emit(polygon, v);
    }
  }

  void emit(const CellPolygon& polygon, const std::array<std::uint32_t, 12>& v) {
    const unsigned n = polygon.count;
    if (polygon.apex >= 0) {
      const auto apex = static_cast<unsigned>(polygon.apex);
      for (unsigned k = 1; k + 1 < n; ++k)
        out_.triangles.push_back({v[apex], v[(apex + k) % n], v[(apex + k + 1) % n]});
      return;
    }
    Vec3 middle{0, 0, 0};
    for (unsigned k = 0; k < n; ++k) middle = middle + out_.positions[v[k]];
    const auto centre = static_cast<std::uint32_t>(out_.positions.size());
    out_.positions.push_back(1.0 / n * middle);
    for (unsigned k = 0; k < n; ++k) out_.triangles.push_back({centre, v[k], v[(k + 1) % n]});
  }

  std::uint32_t vertexOn(unsigned edge, std::uint32_t x, std::uint32_t y, std::uint32_t z) {
    const unsigned from = kEdgeFrom[edge];
    const unsigned axis = edge / 4;
    x += from & 1;
    y += from >> 1 & 1;
    const unsigned up = from >> 2;
    std::uint32_t& vertex = vertices_[up][axis][std::size_t{y} * grid_.nx + x];
    if (vertex != kNone) return vertex;
    const std::size_t i = grid_.index(x, y, z + up);
    const std::size_t step = axis == 0 ? 1 : axis == 1 ? grid_.nx : std::size_t{grid_.nx} * grid_.ny;
    const auto a = static_cast<double>(values_[i]), b = static_cast<double>(values_[i + step]);
    const double share = std::min(1 - kFromEnds, std::max(kFromEnds, a / (a - b)));
    Vec3 p = grid_.position(x, y, z + up);
    (axis == 0 ? p.x : axis == 1 ? p.y : p.z) += share * grid_.spacing;
    vertex = static_cast<std::uint32_t>(out_.positions.size());
    out_.positions.push_back(p);
    return vertex;
  }

  const VoxelGrid& grid_;
  const std::vector<float>& values_;
  std::array<CellPolygons, 256> table_;
  /// For the lower and the upper layer of nodes, and each axis: the vertex on the edge that starts there.
  std::array<std::array<std::vector<std::uint32_t>, 3>, 2> vertices_;
  TriangleMesh out_;
};

}  // namespace

bool isoSurface(const VoxelGrid& grid, const std::vector<float>& values, const Progress& progress, TriangleMesh& out) {
  return Marcher(grid, values).run(progress, out);
}

}  // namespace cagecast::cages
