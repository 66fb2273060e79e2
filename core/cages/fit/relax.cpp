#include "fit/steps.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "fit/warp.hpp"
#include "mesh/half_edges.hpp"

namespace cagecast::cages {

namespace {

constexpr double kSharpTurn = -0.5;  ///< Cosine of the angle at an edge at which two triangles count as folded.
/// A triangle is thin if its smallest angle is below this, in radians, and below this share of its angle in the
/// template.
constexpr double kThin = 18 * std::numbers::pi / 180, kThinShare = 0.9;
/// At first the corners of thin and folded triangles move; in later stages those of folded ones, with up to two rings
/// of neighbours; in the last one those on tracks leave them.
constexpr int kStages = 3, kRoundsPerStage = 10;
constexpr int kRings[kStages] = {0, 1, 1};
constexpr int kRelaxSweeps = 10;
/// Then single vertices are tried at places around, this far off at first, in lengths of their longest edge.
constexpr int kSearchRounds = 10;
constexpr double kFirstSearchStep = 0.1;

std::vector<double> smallestAngles(const TriangleMesh& mesh) {
  std::vector<double> angles;
  angles.reserve(mesh.triangles.size());
  for (const Triangle3& t : mesh.triangles) {
    double least = std::numbers::pi;
    for (std::size_t k = 0; k < 3; ++k) {
      const Vec3& p = mesh.positions[t[k]];
      const Vec3 a = mesh.positions[t[(k + 1) % 3]] - p, b = mesh.positions[t[(k + 2) % 3]] - p;
      least = std::min(least, std::atan2(length(cross(a, b)), dot(a, b)));
    }
    angles.push_back(least);
  }
  return angles;
}

/// Moves vertices to where the template's shape has them, turned and scaled as each place is: As-rigid-as-possible
/// surface modeling (Sorkine, Alexa 2007), with similarities.
/// @param tracks  Per vertex: the only direction in which it moves; zero if it is free.
void restoreShape(const TemplateCage& cage, const std::vector<bool>& moves, const std::vector<Vec3>& tracks,
                  std::vector<Vec3>& positions) {
  const std::vector<Vec3>& own = cage.mesh.positions;
  std::vector<bool> near = moves;
  grow(cage.neighbours, near);
  std::vector<Similarity> maps(positions.size());
  for (std::size_t v = 0; v < positions.size(); ++v) {
    if (!near[v]) continue;
    std::vector<Vec3> from{own[v]}, to{positions[v]};
    for (const std::uint32_t u : cage.neighbours[v]) {
      from.push_back(own[u]);
      to.push_back(positions[u]);
    }
    maps[v] = fitSimilarity(from, to);
  }
  for (int sweep = 0; sweep < kRelaxSweeps; ++sweep)
    for (std::size_t v = 0; v < positions.size(); ++v) {
      if (!moves[v]) continue;
      Vec3 sum{0, 0, 0};
      for (const std::uint32_t u : cage.neighbours[v]) {
        const Vec3 edge = own[v] - own[u];
        sum = sum + positions[u] + 0.5 * (maps[u].turned(edge) + maps[v].turned(edge));
      }
      const Vec3 move = 1 / static_cast<double>(cage.neighbours[v].size()) * sum - positions[v];
      const bool isFree = !(length(tracks[v]) > 0);
      positions[v] = positions[v] + (isFree ? move : dot(move, tracks[v]) * tracks[v]);
    }
}

/// The triangles that share a vertex with the neighbours of a vertex.
class Surroundings {
 public:
  Surroundings(const TemplateCage& cage, const std::vector<bool>& foldedBefore, std::uint32_t vertex,
               const std::vector<Vec3>& positions)
      : mesh_{positions, {}}, vertex_(vertex) {
    std::vector<bool> ring(positions.size());
    ring[vertex] = true;
    grow(cage.neighbours, ring);
    std::vector<bool> twoRings = ring;
    grow(cage.neighbours, twoRings);
    const auto touches = [](const Triangle3& t, const std::vector<bool>& vertices) {
      return vertices[t[0]] || vertices[t[1]] || vertices[t[2]];
    };
    for (std::size_t t = 0; t < foldedBefore.size(); ++t) {
      const Triangle3& corners = cage.mesh.triangles[t];
      if (!touches(corners, twoRings)) continue;
      mesh_.triangles.push_back(corners);
      counts_.push_back(!foldedBefore[t] && touches(corners, ring));
    }
  }

  /// How many of them are folded, but not in the template, if the vertex is at a place.
  int foldsWith(const Vec3& place) {
    mesh_.positions[vertex_] = place;
    const std::vector<bool> folded = foldedTriangles(mesh_);
    int count = 0;
    for (std::size_t t = 0; t < folded.size(); ++t)
      if (folded[t] && counts_[t]) ++count;
    return count;
  }

 private:
  TriangleMesh mesh_;
  std::vector<bool> counts_;
  std::uint32_t vertex_;
};

/// Moves a vertex no farther than it takes for fewer triangles around it to be folded.
/// @param track  The only direction in which it moves; zero if it is free.
void searchAround(const TemplateCage& cage, const std::vector<bool>& foldedBefore, std::uint32_t vertex,
                  const Vec3& track, std::vector<Vec3>& positions) {
  Surroundings around(cage, foldedBefore, vertex, positions);
  const Vec3 start = positions[vertex];
  double size = 0;
  for (const std::uint32_t u : cage.neighbours[vertex]) size = std::max(size, length(positions[u] - start));
  const int before = around.foldsWith(start);
  int least = before;
  for (double step = kFirstSearchStep; step < 1 && least == before; step *= 2)
    for (const double x : {-1.0, 0.0, 1.0})
      for (const double y : {-1.0, 0.0, 1.0})
        for (const double z : {-1.0, 0.0, 1.0}) {
          const Vec3 direction = length(track) > 0 ? x * track : Vec3{x, y, z};
          const Vec3 place = start + step * size * direction;
          const int count = around.foldsWith(place);
          if (count >= least) continue;
          least = count;
          positions[vertex] = place;
        }
}

}  // namespace

std::vector<bool> foldedTriangles(const TriangleMesh& mesh) {
  const std::size_t count = mesh.triangles.size();
  std::vector<Vec3> normals(count), around(mesh.positions.size(), Vec3{0, 0, 0});
  for (std::size_t t = 0; t < count; ++t) {
    normals[t] = areaNormal(mesh, mesh.triangles[t]);
    for (const std::uint32_t v : mesh.triangles[t]) around[v] = around[v] + normals[t];
  }
  const std::vector<std::uint32_t> twins = halfEdgeTwins(mesh);
  std::vector<bool> folded(count);
  for (std::size_t t = 0; t < count; ++t) {
    Vec3 sum = -3.0 * normals[t];
    for (const std::uint32_t v : mesh.triangles[t]) sum = sum + around[v];
    if (dot(sum, normals[t]) < 0) folded[t] = true;
    for (std::size_t h = 3 * t; h < 3 * t + 3; ++h) {
      if (twins[h] == kNone) continue;
      const Vec3& n = normals[twins[h] / 3];
      if (dot(n, normals[t]) < kSharpTurn * length(n) * length(normals[t])) folded[t] = folded[twins[h] / 3] = true;
    }
  }
  return folded;
}

bool relax(const TemplateCage& cage, const std::vector<Vec3>& tracks, const StepCallback& step,
           std::vector<Vec3>& positions) {
  const std::vector<bool> foldedBefore = foldedTriangles(cage.mesh);
  const std::vector<double> own = smallestAngles(cage.mesh);
  std::vector<bool> corners;
  const auto findCorners = [&](bool withThin) {
    const TriangleMesh mesh{positions, cage.mesh.triangles};
    const std::vector<bool> folded = foldedTriangles(mesh);
    const std::vector<double> angles = smallestAngles(mesh);
    corners.assign(positions.size(), false);
    for (std::size_t t = 0; t < folded.size(); ++t)
      if ((folded[t] && !foldedBefore[t]) || (withThin && angles[t] < std::min(kThin, kThinShare * own[t])))
        for (const std::uint32_t v : mesh.triangles[t]) corners[v] = true;
    return std::find(corners.begin(), corners.end(), true) != corners.end();
  };
  constexpr double kRounds = kStages * kRoundsPerStage + kSearchRounds;
  for (int round = 0; round < kStages * kRoundsPerStage; ++round) {
    const int stage = round / kRoundsPerStage;
    if (!step(round / kRounds)) return false;
    if (!findCorners(stage == 0)) return true;
    std::vector<bool> moves = corners;
    grow(cage.neighbours, moves, kRings[stage]);
    // Off the track only where nothing else has helped.
    std::vector<Vec3> current = tracks;
    for (std::size_t v = 0; v < tracks.size(); ++v)
      if (stage + 1 == kStages && corners[v]) current[v] = {0, 0, 0};
    restoreShape(cage, moves, current, positions);
  }
  for (int round = 0; round < kSearchRounds && findCorners(false); ++round) {
    for (std::uint32_t v = 0; v < positions.size(); ++v) {
      if (!corners[v]) continue;
      if (!step((kStages * kRoundsPerStage + round) / kRounds)) return false;
      searchAround(cage, foldedBefore, v, 2 * round < kSearchRounds ? tracks[v] : Vec3{0, 0, 0}, positions);
    }
  }
  return true;
}

}  // namespace cagecast::cages
