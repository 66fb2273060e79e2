#include "scenes/scenes.hpp"

#include <algorithm>
#include <cmath>
#include <utility>

namespace cagecast::scenes {

float distance(Point a, Point b) {
  const float x = a[0] - b[0], y = a[1] - b[1], z = a[2] - b[2];
  return std::sqrt(x * x + y * y + z * z);
}

namespace {

/// The point on a unit cube's surface for a place (0..1 each way) on one of its six faces.
Point onCube(int face, float u, float v) {
  const float a = 2 * u - 1, b = 2 * v - 1;
  switch (face) {
    case 0: return {1, a, b};
    case 1: return {-1, b, a};
    case 2: return {b, 1, a};
    case 3: return {a, -1, b};
    case 4: return {a, b, 1};
    default: return {b, a, -1};
  }
}

/// Six grids of cells × cells quads.
template <typename ClosestPoint>
Mesh sixGrids(int cells, ClosestPoint place) {
  Mesh mesh;
  for (int face = 0; face < 6; ++face) {
    const auto first = static_cast<std::uint32_t>(mesh.vertexCount());
    const auto side = static_cast<std::uint32_t>(cells + 1);
    for (int j = 0; j <= cells; ++j)
      for (int i = 0; i <= cells; ++i) {
        const float u = static_cast<float>(i) / static_cast<float>(cells),
                    v = static_cast<float>(j) / static_cast<float>(cells);
        mesh.addVertex(place(face, u, v), (static_cast<float>(face % 3) + u) / 3,
                       (static_cast<float>(face / 3) + v) / 2);
      }
    for (std::uint32_t j = 0; j + 1 < side; ++j)
      for (std::uint32_t i = 0; i + 1 < side; ++i) {
        const std::uint32_t a = first + j * side + i, b = a + 1, c = b + side, d = a + side;
        mesh.addTriangle(a, b, c);
        mesh.addTriangle(a, c, d);
      }
  }
  return mesh;
}

}  // namespace

Point Mesh::centroid(std::size_t triangle) const {
  Point sum{};
  for (std::size_t c = 0; c < 3; ++c)
    for (std::size_t k = 0; k < 3; ++k) sum[k] += positions[indices[triangle * 3 + c] * 3 + k] / 3;
  return sum;
}

std::uint32_t Mesh::addVertex(Point p, float u, float v, std::uint32_t group) {
  positions.insert(positions.end(), p.begin(), p.end());
  uvs.insert(uvs.end(), {u, v});
  groups.push_back(group);
  return static_cast<std::uint32_t>(vertexCount() - 1);
}

// splitmix64 (Steele, Lea, Flood 2014).
std::uint64_t Random::next() {
  std::uint64_t z = state_ += 0x9e3779b97f4a7c15u;
  z = (z ^ z >> 30) * 0xbf58476d1ce4e5b9u;
  z = (z ^ z >> 27) * 0x94d049bb133111ebu;
  return z ^ z >> 31;
}

float Random::between(float low, float high) {
  return low + (high - low) * (static_cast<float>(next() >> 40) * 0x1p-24f);
}

Mesh box(Point centre, Point halfSize, int cells) {
  return sixGrids(cells, [&](int face, float u, float v) {
    Point p = onCube(face, u, v);
    for (std::size_t k = 0; k < 3; ++k) p[k] = centre[k] + halfSize[k] * p[k];
    return p;
  });
}

Mesh ellipsoid(Point centre, Point radii, int cells) {
  return sixGrids(cells, [&](int face, float u, float v) {
    Point p = onCube(face, u, v);
    const float length = distance(p, {});
    for (std::size_t k = 0; k < 3; ++k) p[k] = centre[k] + radii[k] * (p[k] / length);
    return p;
  });
}

Mesh sheet(Point corner, Point u, Point v, int cells) {
  Mesh mesh;
  const auto row = static_cast<std::uint32_t>(cells + 1);
  for (std::uint32_t i = 0; i < row * row; ++i) {
    const float s = static_cast<float>(i % row) / static_cast<float>(cells);
    const float t = static_cast<float>(i / row) / static_cast<float>(cells);
    const auto at = [&](std::size_t k) { return corner[k] + s * u[k] + t * v[k]; };
    mesh.addVertex({at(0), at(1), at(2)}, s, t);
    if (i % row + 1 == row || i / row + 1 == row) continue;
    mesh.addTriangle(i, i + 1, i + row + 1);
    mesh.addTriangle(i, i + row + 1, i + row);
  }
  return mesh;
}

void append(Mesh& mesh, const Mesh& other) {
  const auto first = static_cast<std::uint32_t>(mesh.vertexCount());
  const std::uint32_t group = mesh.groups.empty() ? 0 : mesh.groups.back() + 1;
  mesh.positions.insert(mesh.positions.end(), other.positions.begin(), other.positions.end());
  mesh.uvs.insert(mesh.uvs.end(), other.uvs.begin(), other.uvs.end());
  mesh.groups.resize(mesh.groups.size() + other.vertexCount(), group);
  for (const std::uint32_t index : other.indices) mesh.indices.push_back(first + index);
}

Mesh rotated(const Mesh& mesh, std::array<int, 4> quaternion) {
  const double w = quaternion[0], x = quaternion[1], y = quaternion[2], z = quaternion[3];
  const double norm = w * w + x * x + y * y + z * z;
  const double m[3][3] = {{w * w + x * x - y * y - z * z, 2 * (x * y - w * z), 2 * (x * z + w * y)},
                          {2 * (x * y + w * z), w * w - x * x + y * y - z * z, 2 * (y * z - w * x)},
                          {2 * (x * z - w * y), 2 * (y * z + w * x), w * w - x * x - y * y + z * z}};
  return mapped(mesh, [&](Point p) {
    Point turned{};
    for (std::size_t row = 0; row < 3; ++row) {
      double sum = 0;
      for (std::size_t k = 0; k < 3; ++k) sum += m[row][k] / norm * static_cast<double>(p[k]);
      turned[row] = static_cast<float>(sum);
    }
    return turned;
  });
}

Mesh shuffled(const Mesh& mesh, Random& random, std::vector<std::uint32_t>& vertexOrder) {
  const auto order = [&](std::size_t count) {
    std::vector<std::uint32_t> places(count);
    for (std::uint32_t i = 0; i < count; ++i) {
      const std::uint32_t j = random.below(i + 1);
      places[i] = places[j];
      places[j] = i;
    }
    return places;
  };
  vertexOrder = order(mesh.vertexCount());
  std::vector<std::uint32_t> placeOf(mesh.vertexCount());
  Mesh result;
  for (std::uint32_t v = 0; v < vertexOrder.size(); ++v) {
    const std::uint32_t old = vertexOrder[v];
    result.addVertex(mesh.vertex(old), mesh.uvs[old * 2], mesh.uvs[old * 2 + 1], mesh.groups[old]);
    placeOf[old] = v;
  }
  for (const std::uint32_t t : order(mesh.triangleCount()))
    result.addTriangle(placeOf[mesh.indices[t * 3]], placeOf[mesh.indices[t * 3 + 1]],
                       placeOf[mesh.indices[t * 3 + 2]]);
  return result;
}

Scene strewn(std::uint64_t seed, int triangles) {
  Random random(seed);
  Scene scene{"strewn " + std::to_string(seed), {}, {}};
  for (int t = 0; t < triangles; ++t) {
    const Point centre{random.between(-1, 1), random.between(-1, 1), random.between(-1, 1)};
    std::uint32_t corners[3];
    for (std::uint32_t& corner : corners) {
      const auto known = static_cast<std::uint32_t>(scene.target.vertexCount());
      if (known > 0 && random.below(3) == 0) {
        corner = known - 1 - random.below(std::min(known, 8u));
        continue;
      }
      Point p;
      for (std::size_t k = 0; k < 3; ++k) p[k] = centre[k] + random.between(-0.1f, 0.1f);
      corner = scene.target.addVertex(p, random.between(0, 1), random.between(0, 1), random.below(2));
    }
    scene.target.addTriangle(corners[0], corners[1], corners[2]);
  }
  const Point hole{random.between(-1, 1), random.between(-1, 1), 1.5f};
  scene.cage = without(ellipsoid({}, {1.9f, 1.8f, 1.7f}, 5), [&](Point p) { return distance(p, hole) < 0.8f; });
  // Moved by their place, so that vertices that were equal stay so.
  scene.cage = mapped(scene.cage, [&](Point p) {
    const auto lump = [&](float x) { return x + 0.15f * std::abs(x * 1.7f - std::floor(x * 1.7f) - 0.5f); };
    return Point{p[0] + 0.1f * lump(p[1]), p[1] + 0.1f * lump(p[2]), p[2] + 0.1f * lump(p[0])};
  });
  scene.cage.addTriangle(0, 0, 1);
  scene.cage.addTriangle(2, 3, 3);
  return scene;
}

Scene gridded(std::uint64_t seed, int triangles) {
  Scene scene = strewn(seed, triangles);
  scene.name = "gridded " + std::to_string(seed);
  scene.target = mapped(scene.target, [](Point p) {
    for (float& x : p) x = std::round(x * 8) / 8;
    return p;
  });
  scene.cage =
      without(box({}, {1.5f, 1.5f, 1.5f}, 12), [&](Point p) { return p[2] > 1.49f && p[0] > 0 && p[1] > 0.5f; });
  return scene;
}

Scene patchwork(std::uint64_t seed) {
  Random random(seed);
  Scene scene{"patchwork " + std::to_string(seed), {}, {}};
  const auto cells = [&](std::uint32_t most) { return 2 + static_cast<int>(random.below(most - 1)); };
  const float size = random.between(1.05f, 1.4f);
  const int count = cells(10);
  scene.target = random.below(3) == 0 ? box({}, {0.7f, 0.7f, 0.7f}, count) : ellipsoid({}, {1, 0.95f, 0.9f}, count);
  scene.cage =
      random.below(2) == 0 ? box({}, {size, size, size}, cells(8)) : ellipsoid({}, {size, size, size}, cells(8));
  for (std::uint32_t holes = random.below(4); holes > 0; --holes) {
    const Point middle = scene.cage.vertex(random.below(static_cast<std::uint32_t>(scene.cage.vertexCount())));
    const float radius = random.between(0.2f, 0.8f);
    scene.cage = without(std::move(scene.cage), [&](Point p) { return distance(p, middle) < radius; });
  }
  if (random.below(2) == 0) {
    const std::size_t perSide = scene.target.vertexCount() / 6;
    for (std::size_t v = 0; v < scene.target.vertexCount(); ++v)
      scene.target.groups[v] = static_cast<std::uint32_t>(v / perSide % 2);
  }
  const float lumps = random.between(0, 0.1f);
  // Moved by their place, so that vertices that were equal stay so.
  scene.target = mapped(std::move(scene.target), [&](Point p) {
    const auto lump = [&](float x) { return lumps * std::abs(x * 3.7f - std::floor(x * 3.7f) - 0.5f); };
    return Point{p[0] + lump(p[1]), p[1] + lump(p[2]), p[2] + lump(p[0])};
  });
  const auto part = [&] { return static_cast<int>(random.below(9)); };
  const std::array<int, 4> quaternion{1 + part(), part(), part(), part()};
  scene.cage = rotated(scene.cage, quaternion);
  scene.target = rotated(scene.target, quaternion);
  return scene;
}

Scene lattice(int cells) {
  const float half = static_cast<float>(cells);  // One unit is half a cell, so that every coordinate is whole.
  return {"lattice " + std::to_string(cells), box({}, {half + 2, half + 2, half + 2}, cells + 2),
          box({}, {half, half, half}, cells)};
}

Scene stairs() {
  Scene scene{"stairs", box({}, {10, 10, 10}, 10), {}};
  append(scene.target, box({0, -4, 0}, {8, 2, 8}, 4));
  append(scene.target, box({0, 0, 0}, {4, 2, 4}, 2));
  append(scene.target, box({0, 4, 0}, {2, 2, 2}, 1));
  return scene;
}

Scene head(int cells) {
  constexpr Point kLeftEye{0.35f, 0.25f, 0.85f}, kRightEye{-0.35f, 0.25f, 0.85f}, kMouth{0, -0.4f, 0.95f};
  const auto inHole = [&](Point p, float grow) {
    return distance(p, kLeftEye) < 0.22f * grow || distance(p, kRightEye) < 0.22f * grow ||
           distance({p[0] / 2, p[1], p[2]}, kMouth) < 0.15f * grow;
  };
  // A nose and a chin, so that the head is neither convex nor symmetric about the equator.
  const auto shape = [](Point p) {
    const float nose = std::max(0.0f, 1 - distance(p, {0, -0.05f, 1}) / 0.25f);
    const float chin = std::max(0.0f, 1 - distance(p, {0, -0.9f, 0.5f}) / 0.5f);
    return Point{p[0], p[1] - 0.1f * chin, p[2] + 0.25f * nose + 0.1f * chin};
  };
  const auto skin = [&](float size, int count, float grow) {
    return mapped(
        without(ellipsoid({}, {0.8f * size, size, 0.95f * size}, count), [&](Point p) { return inHole(p, grow); }),
        shape);
  };
  Scene scene{"head " + std::to_string(cells), skin(1.12f, std::max(6, cells / 3), 1.15f), {}};
  append(scene.target, skin(1, cells, 1));
  const int few = std::max(3, cells / 4);
  append(scene.target, ellipsoid({0.35f, 0.25f, 0.66f}, {0.2f, 0.2f, 0.2f}, few));
  append(scene.target, ellipsoid({-0.35f, 0.25f, 0.66f}, {0.2f, 0.2f, 0.2f}, few));
  append(scene.target, box({0, -0.32f, 0.72f}, {0.2f, 0.03f, 0.05f}, 3));
  append(scene.target, box({0, -0.48f, 0.70f}, {0.18f, 0.03f, 0.05f}, 3));
  append(scene.target, ellipsoid({0, -0.42f, 0.55f}, {0.12f, 0.04f, 0.3f}, few));
  return scene;
}

Scene crowdedHead(int cells, float shift) {
  Scene scene = head(cells);
  const auto pane = [&](Point centre, float half) {
    const auto corner = [&](float x, float y) { return Point{centre[0] + half * x, centre[1] + half * y, centre[2]}; };
    const std::uint32_t group = static_cast<std::uint32_t>(scene.target.vertexCount());
    const std::uint32_t first = scene.target.addVertex(corner(-1, -1), 0, 0, group);
    scene.target.addVertex(corner(1, -1), 0, 0, group);
    scene.target.addVertex(corner(1, 1), 0, 0, group);
    scene.target.addVertex(corner(-1, 1), 0, 0, group);
    scene.target.addTriangle(first, first + 1, first + 2);
    scene.target.addTriangle(first, first + 2, first + 3);
  };
  pane({0.35f, 0.25f, 0.9f}, 0.2f);
  pane({-0.35f, 0.25f, 0.8f}, 0.25f);
  pane({0, -0.4f, 0.9f}, 0.18f);
  scene.cage = mapped(scene.cage, [&](Point p) { return Point{p[0] + shift, p[1], p[2] - shift / 2}; });
  scene.name += " crowded";
  return scene;
}

std::vector<Scene> golden() {
  std::vector<Scene> all{strewn(1, 200), strewn(2, 500), lattice(4), stairs(), head(12), head(25)};
  for (const std::array<int, 4> quaternion : {std::array{1, 1, 0, 0}, {3, 1, -2, 1}}) {
    Scene scene = lattice(5);
    scene.name += " rotated";
    all.push_back({scene.name, rotated(scene.cage, quaternion), rotated(scene.target, quaternion)});
  }
  return all;
}

std::vector<Scene> goldenDefault() {
  std::vector<Scene> all = golden();
  for (const float shift : {0.0f, 0.06f, -0.1f}) all.push_back(crowdedHead(18, shift));
  return all;
}

std::vector<Scene> goldenBorders() { return {head(8), head(16), strewn(1, 60)}; }

}  // namespace cagecast::scenes
