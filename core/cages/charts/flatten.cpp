#include "charts/steps.hpp"

#include <algorithm>
#include <cmath>
#include <utility>

#include "charts/slim.hpp"
#include "linear/sparse_system.hpp"

namespace cagecast::cages {

namespace {

/// What the triangles that fill a hole count: enough to keep its shape, too little to bend what is around it.
constexpr double kFillWeight = 0.05;
constexpr int kFlattenSteps = 60;
/// A step that gains less than this share is the last.
constexpr double kMinGain = 2e-4;
/// After so many steps overlaps are looked for; an overlap then turns the run back to its last good state.
constexpr int kStepsBetweenChecks = 4;

/// Closes all boundary loops but the longest with fans around a new vertex in their middle.
void fillHoles(TriangleMesh& mesh) {
  const std::vector<std::uint32_t> twins = halfEdgeTwins(mesh);
  const auto loops = loopsOf(mesh, twins);
  for (std::size_t i = 1; i < loops.size(); ++i) {
    const auto hub = static_cast<std::uint32_t>(mesh.positions.size());
    mesh.positions.push_back(middleOf(mesh, originsOf(mesh, loops[i])));
    for (const std::uint32_t h : loops[i]) mesh.triangles.push_back({endOf(mesh, h), originOf(mesh, h), hub});
  }
}

/// The point at a share of the way round the unit circle, about evenly, without transcendental functions.
Uv onCircle(double share) {
  const double quarters = 4 * share;
  const auto quarter = std::min(3, static_cast<int>(quarters));
  // tan(x / 2) to 1 %, exact at the ends of the quarter.
  const double part = quarters - quarter, t = part * (0.785 + 0.215 * part * part);
  const double x = (1 - t * t) / (1 + t * t), y = 2 * t / (1 + t * t);
  switch (quarter) {
    case 0: return {x, y};
    case 1: return {-y, x};
    case 2: return {-x, -y};
    default: return {y, -x};
  }
}

/// tan of half the angle between two vectors, kept within reason.
double halfTangent(const Vec3& a, const Vec3& b) {
  const double sine = length(cross(a, b)), cosine = dot(a, b), size = length(a) * length(b);
  return std::clamp(sine > 0 ? (size - cosine) / sine : 0.0, 0.01, 100.0);
}

/// The rim on a circle, all else at means of neighbours with mean value weights (Floater 2003). Never flips, save by
/// rounding.
bool mapToDisk(const TriangleMesh& mesh, std::vector<Uv>& uvs) {
  const std::vector<std::uint32_t> twins = halfEdgeTwins(mesh);
  const auto loops = loopsOf(mesh, twins);
  if (loops.size() != 1) return false;
  std::vector<bool> onRim(mesh.positions.size());
  uvs.assign(mesh.positions.size(), {0, 0});
  const double area = areaOf(mesh);
  double done = 0;
  const double whole = lengthOf(mesh, loops[0]), radius = std::sqrt(area / 3.14159265);
  if (!(whole > 0) || !(area > 0)) return false;
  const double least = 0.1 * whole / static_cast<double>(loops[0].size());
  double rim = 0;
  for (const std::uint32_t h : loops[0]) rim += std::max(least, lengthOf(mesh, {&h, 1}));
  for (const std::uint32_t h : loops[0]) {
    const Uv place = onCircle(done / rim);
    if (onRim[originOf(mesh, h)]) return false;
    onRim[originOf(mesh, h)] = true;
    uvs[originOf(mesh, h)] = {radius * place[0], radius * place[1]};
    done += std::max(least, lengthOf(mesh, {&h, 1}));
  }
  std::vector<std::uint32_t> row(mesh.positions.size(), kNone);
  std::uint32_t rows = 0;
  for (std::size_t v = 0; v < row.size(); ++v)
    if (!onRim[v]) row[v] = rows++;
  if (rows == 0) return true;
  std::vector<SparseEntry> entries;
  std::vector<double> rightU(rows), rightV(rows), total(rows);
  // Symmetric weights, for the symmetric solver: those of both ends added.
  for (std::size_t h = 0; h < twins.size(); ++h) {
    const std::uint32_t from = originOf(mesh, h), to = endOf(mesh, h);
    const std::uint32_t apex = endOf(mesh, nextInTriangle(h));
    const Vec3 edge = mesh.positions[to] - mesh.positions[from];
    const double size = std::max(length(edge), 1e-9 * whole);
    const double weight =
        (halfTangent(edge, mesh.positions[apex] - mesh.positions[from]) +
         halfTangent(mesh.positions[from] - mesh.positions[to], mesh.positions[apex] - mesh.positions[to])) /
        size;
    for (const auto& [one, other] : {std::pair{from, to}, std::pair{to, from}}) {
      if (row[one] == kNone) continue;
      total[row[one]] += weight;
      if (row[other] != kNone) {
        entries.push_back({row[one], row[other], -weight});
      } else {
        rightU[row[one]] += weight * uvs[other][0];
        rightV[row[one]] += weight * uvs[other][1];
      }
    }
  }
  SparseSystem system(rows, entries);
  for (const SparseEntry& entry : entries) system.add(entry.row, entry.column, entry.value);
  for (std::uint32_t i = 0; i < rows; ++i) system.add(i, i, total[i]);
  if (!system.factorize()) return false;
  const std::vector<double> u = system.solve(rightU), v = system.solve(rightV);
  for (std::size_t i = 0; i < row.size(); ++i)
    if (row[i] != kNone) uvs[i] = {u[row[i]], v[row[i]]};
  return true;
}

bool noneFlipped(const TriangleMesh& mesh, const std::vector<Uv>& uvs) {
  return std::all_of(mesh.triangles.begin(), mesh.triangles.end(),
                     [&](const Triangle3& t) { return doubledArea(uvs[t[0]], uvs[t[1]], uvs[t[2]]) > 0; });
}

}  // namespace

Chart flatten(Piece piece, Ticker& ticker) {
  Chart chart;
  chart.piece = std::move(piece);
  TriangleMesh mesh = chart.piece.mesh;
  const std::size_t real = mesh.triangles.size(), vertices = mesh.positions.size();
  fillHoles(mesh);
  if (!mapToDisk(mesh, chart.uvs) || !noneFlipped(mesh, chart.uvs)) return chart;
  RestShapes rest = restShapesOf(mesh);
  for (std::size_t t = real; t < rest.weights.size(); ++t) rest.weights[t] *= kFillWeight;
  Slim slim(mesh, std::move(rest));
  std::vector<Uv> uvs = chart.uvs;
  for (int i = 0; i < kFlattenSteps; ++i) {
    if (!ticker.work(mesh.triangles.size())) return chart;
    const double gain = slim.step(uvs);
    const bool last = gain < kMinGain || i + 1 == kFlattenSteps;
    if (last || i % kStepsBetweenChecks == kStepsBetweenChecks - 1) {
      if (countOverlaps(uvs, chart.piece.mesh.triangles, 1) > 0) break;
      chart.uvs = uvs;
    }
    if (last) break;
  }
  chart.energy = slim.energy(chart.uvs);
  chart.uvs.resize(vertices);
  chart.valid = true;
  return chart;
}

}  // namespace cagecast::cages
