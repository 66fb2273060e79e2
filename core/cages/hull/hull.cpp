#include "hull/hull.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

#include "hull/steps.hpp"
#include "mesh/bounds.hpp"
#include "mesh/progress.hpp"

namespace cagecast::cages {

namespace {

/// Nodes beyond the hull on each side of the grid: one for the flood, one for the border, one for rounding.
constexpr double kBorder = 3;
constexpr std::uint32_t kMinVoxels = 8;
constexpr std::uint32_t kMaxVoxels = 512;
/// Nodes that a flood reaches between two calls of the callback: a few milliseconds of work.
constexpr std::size_t kNodesPerReport = 1 << 18;

double longestOf(const Vec3& size) { return std::max({size.x, size.y, size.z}); }

/// Spaces between the nodes along the longest side, without the border.
double spacesFor(std::uint32_t voxels) {
  return static_cast<double>(std::clamp(voxels, kMinVoxels, kMaxVoxels)) - 2 * kBorder + 1;
}

/// The least that a mesh can be dilated by: any point is within 0.87 spaces of a node, so that the body has neither
/// gaps that the flood gets in through, nor is empty.
double leastDilation(const TriangleMesh& mesh, std::uint32_t voxels) {
  constexpr double kSpaces = 0.9;
  return kSpaces * longestOf(boundsOf(mesh).size()) / (spacesFor(voxels) - 2 * kSpaces);  // The grid has room for it.
}

VoxelGrid gridAround(const TriangleMesh& mesh, double pad, std::uint32_t voxels) {
  const Bounds bounds = boundsOf(mesh);
  const Vec3 size = bounds.size() + 2 * pad * Vec3{1, 1, 1};
  VoxelGrid grid;
  grid.spacing = longestOf(size) / spacesFor(voxels);
  const auto nodes = [&](double side) {
    return static_cast<std::uint32_t>(std::ceil(side / grid.spacing) + 2 * kBorder);
  };
  grid.nx = nodes(size.x);
  grid.ny = nodes(size.y);
  grid.nz = nodes(size.z);
  const double border = kBorder * grid.spacing + pad;
  grid.origin = bounds.low - border * Vec3{1, 1, 1};
  return grid;
}

/// A mark for each node of a grid.
struct Marks {
  const VoxelGrid& grid;
  std::vector<std::uint8_t> of;

  explicit Marks(const VoxelGrid& on) : grid(on), of(on.size(), 0) {}
};

/// Marks the nodes that a walk along the axes reaches from `start` through nodes that `open` accepts.
/// @return how many; 0 if `progress` cancelled it.
template <class Open>
std::size_t flood(Marks& marks, std::size_t start, std::uint8_t mark, const Open& open, const Progress& progress) {
  const VoxelGrid& grid = marks.grid;
  const std::size_t row = grid.nx, layer = row * grid.ny;
  const auto isLeft = [&](std::size_t i) { return marks.of[i] != mark && open(i); };
  std::vector<std::size_t> stack = {start};
  std::size_t reached = 0, reported = 0;
  while (!stack.empty()) {
    const std::size_t i = stack.back();
    stack.pop_back();
    if (marks.of[i] == mark) continue;
    // All of the row that is reached along it, then the rows beside it.
    const std::size_t rowStart = i - i % row, y = i / row % grid.ny, z = i / layer;
    std::size_t begin = i, end = i + 1;
    while (begin > rowStart && isLeft(begin - 1)) --begin;
    while (end < rowStart + row && isLeft(end)) ++end;
    std::fill(marks.of.begin() + static_cast<std::ptrdiff_t>(begin),
              marks.of.begin() + static_cast<std::ptrdiff_t>(end), mark);
    reached += end - begin;
    const auto visit = [&](std::size_t from) {
      bool before = false;
      for (std::size_t n = from; n < from + (end - begin); ++n) {
        const bool now = isLeft(n);
        if (now && !before) stack.push_back(n);
        before = now;
      }
    };
    if (y > 0) visit(begin - row);
    if (y + 1 < grid.ny) visit(begin + row);
    if (z > 0) visit(begin - layer);
    if (z + 1 < grid.nz) visit(begin + layer);
    if (reached - reported < kNodesPerReport) continue;
    reported = reached;
    if (!report(progress, reached, grid.size(), "hull")) return 0;
  }
  return reached;
}

/// Where the distance passes `level` between the nodes outside and the others.
std::vector<GridPoint> outerBorder(const DistanceBand& band, const Marks& outside, double level) {
  const VoxelGrid& grid = outside.grid;
  std::vector<GridPoint> points;
  const std::array<std::size_t, 3> steps = {1, grid.nx, std::size_t{grid.nx} * grid.ny};
  for (std::uint32_t z = 0; z + 1 < grid.nz; ++z)
    for (std::uint32_t y = 0; y + 1 < grid.ny; ++y)
      for (std::uint32_t x = 0; x + 1 < grid.nx; ++x) {
        const std::size_t i = grid.index(x, y, z);
        for (unsigned axis = 0; axis < 3; ++axis) {
          const std::size_t j = i + steps[axis];
          if (outside.of[i] == outside.of[j]) continue;
          const auto a = static_cast<double>(band.distance[i]), b = static_cast<double>(band.distance[j]);
          const double share = a == b ? 0.5 : std::min(1.0, std::max(0.0, (level - a) / (b - a)));
          GridPoint point{grid.position(x, y, z), x, y, z};
          (axis == 0 ? point.position.x : axis == 1 ? point.position.y : point.position.z) += share * grid.spacing;
          if (share > 0.5) ++(axis == 0 ? point.x : axis == 1 ? point.y : point.z);
          points.push_back(point);
        }
      }
  return points;
}

/// The positive node nearest to a point.
std::size_t nearestNode(const VoxelGrid& grid, const std::vector<float>& values, const Vec3& point) {
  std::size_t nearest = 0;
  double least = std::numeric_limits<double>::infinity();
  for (std::uint32_t z = 0; z < grid.nz; ++z)
    for (std::uint32_t y = 0; y < grid.ny; ++y)
      for (std::uint32_t x = 0; x < grid.nx; ++x) {
        const double distance = length(grid.position(x, y, z) - point);
        if (distance >= least || !(values[grid.index(x, y, z)] > 0)) continue;
        least = distance;
        nearest = grid.index(x, y, z);
      }
  return nearest;
}

/// Leaves one body of positive nodes without pockets in it.
/// @param near  As in `HullOptions`.
/// @param[out] share  Its share of all positive nodes.
/// @return false if `progress` cancelled it.
bool keepOne(const VoxelGrid& grid, const std::optional<Vec3>& near, const Progress& progress,
             std::vector<float>& values, double& share) {
  constexpr float kTiny = 1e-6f;  // In spacings: the vertices stay next to the node that changes its sign.
  const auto tiny = kTiny * static_cast<float>(grid.spacing);
  {
    Marks outside(grid);
    const auto negative = [&](std::size_t i) { return values[i] <= 0; };
    if (flood(outside, 0, 1, negative, partOf(progress, 0, 0.4f)) == 0) return false;
    for (std::size_t i = 0; i < grid.size(); ++i)
      if (outside.of[i] == 0 && values[i] <= 0) values[i] = tiny;
  }
  Marks bodies(grid);
  std::size_t largest = 0, seed = 0, all = 0;
  const auto positive = [&](std::size_t i) { return values[i] > 0; };
  for (std::size_t i = 0; i < grid.size(); ++i) {
    if (bodies.of[i] != 0 || !positive(i)) continue;
    const std::size_t size = flood(bodies, i, 1, positive, partOf(progress, 0.4f, 0.8f));
    if (size == 0) return false;
    all += size;
    if (size <= largest) continue;
    largest = size;
    seed = i;
  }
  share = 1;
  if (largest == all) return true;
  if (near) seed = nearestNode(grid, values, *near);
  const std::size_t kept = flood(bodies, seed, 2, positive, partOf(progress, 0.8f, 1));
  if (kept == 0) return false;
  for (std::size_t i = 0; i < grid.size(); ++i)
    if (bodies.of[i] == 1) values[i] = -tiny;
  share = static_cast<double>(kept) / static_cast<double>(all);
  return true;
}

}  // namespace

std::vector<Opening> findOpenings(const TriangleMesh& mesh, double width) {
  std::vector<Opening> wide;
  for (std::vector<std::uint32_t>& loop : boundaryLoops(mesh)) {
    const double across = boundsOf(mesh, loop).diagonal();
    if (loop.size() >= 3 && across > width) wide.push_back({std::move(loop), across});
  }
  std::stable_sort(wide.begin(), wide.end(), [](const Opening& a, const Opening& b) { return a.width > b.width; });
  return wide;
}

TriangleMesh closeOpenings(const TriangleMesh& mesh, double width) {
  TriangleMesh out = mesh;
  for (const auto& [loop, across] : findOpenings(mesh, width)) {
    const auto centre = static_cast<std::uint32_t>(out.positions.size());
    out.positions.push_back(middleOf(mesh, loop));
    for (std::size_t i = 0; i < loop.size(); ++i)
      out.triangles.push_back({centre, loop[(i + 1) % loop.size()], loop[i]});
  }
  return out;
}

bool makeHull(const TriangleMesh& mesh, const HullOptions& options, const Progress& progress, TriangleMesh& out,
              double* share) {
  // Dilated by `outwards`, what remains is then eroded by `inwards`. The difference is the offset.
  if (!report(progress, 0, "hull")) return false;
  const TriangleMesh closed = closeOpenings(mesh, 2 * options.closing);
  const double outwards = std::max({options.closing, options.offset, leastDilation(closed, options.voxels)});
  const double inwards = outwards - options.offset;
  const VoxelGrid grid = gridAround(closed, outwards, options.voxels);
  // Beyond both levels by the diagonal of a cell, so that the nodes on either side of them have distances.
  const double beyond = 1.8 * grid.spacing;
  DistanceBand band;
  if (!distanceToMesh(closed, grid, outwards + beyond, partOf(progress, 0, 0.6f), band)) return false;
  Marks outside(grid);
  const auto level = static_cast<float>(outwards);
  const auto isBeyond = [&](std::size_t i) { return band.distance[i] > level; };
  if (flood(outside, 0, 1, isBeyond, partOf(progress, 0.6f, 0.65f)) == 0) return false;
  if (!report(progress, 0.65, "hull")) return false;
  const std::vector<GridPoint> border = outerBorder(band, outside, outwards);
  if (!distanceToPoints(border, grid, inwards + beyond, partOf(progress, 0.65f, 0.9f), band)) return false;
  const auto depth = static_cast<float>(inwards);
  for (std::size_t i = 0; i < grid.size(); ++i)
    band.distance[i] = (outside.of[i] != 0 ? -band.distance[i] : band.distance[i]) - depth;
  double kept = 1;
  if (!keepOne(grid, options.near, partOf(progress, 0.9f, 0.95f), band.distance, kept)) return false;
  if (share != nullptr) *share = kept;
  if (!isoSurface(grid, band.distance, partOf(progress, 0.95f, 1), out)) return false;
  return report(progress, 1, "hull");
}

}  // namespace cagecast::cages
