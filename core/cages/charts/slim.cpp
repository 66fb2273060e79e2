#include "charts/slim.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

namespace cagecast::cages {

namespace {

constexpr double kInfinite = std::numeric_limits<double>::infinity();
/// Triangles thinner than this share of their longest edge are taken to be this thick, so that their gradients are
/// finite.
constexpr double kMinTriangleHeight = 0.02;
/// Pull towards the previous step, as a share of the mean weight: fixes the translation and steadies the solver.
constexpr double kProximity = 1e-4;
/// Share of the way to the first flip that a step may go.
constexpr double kStepToFlip = 0.8;
constexpr int kHalvings = 12;

/// The coordinates that a triangle couples: all of its corners, two each.
std::vector<SparseEntry> couplingOf(const TriangleMesh& mesh) {
  std::vector<SparseEntry> entries;
  entries.reserve(36 * mesh.triangles.size());
  for (const Triangle3& t : mesh.triangles)
    for (const std::uint32_t row : t)
      for (const std::uint32_t column : t)
        for (std::uint32_t i = 0; i < 4; ++i) entries.push_back({2 * row + i / 2, 2 * column + i % 2});
  return entries;
}

}  // namespace

double Jacobian::energy() const {
  const double det = determinant();
  return det > 0 ? (a * a + b * b + c * c + d * d) * (1 + 1 / (det * det)) : kInfinite;
}

std::array<double, 2> Jacobian::singularValues() const {
  const double turn = std::sqrt((a + d) * (a + d) + (c - b) * (c - b)) / 2;
  const double mirror = std::sqrt((a - d) * (a - d) + (b + c) * (b + c)) / 2;
  return {turn + mirror, std::abs(turn - mirror)};
}

RestShapes restShapesOf(const TriangleMesh& mesh) {
  RestShapes rest;
  for (const Triangle3& t : mesh.triangles) {
    const Vec3 origin = mesh.positions[t[0]];
    Vec3 along = mesh.positions[t[1]] - origin, across = mesh.positions[t[2]] - origin;
    double longest = std::max({length(along), length(across), length(across - along)});
    if (!(longest > 0)) longest = 1e-12;
    // Corners (0, 0), (width, 0), (x, height).
    double width = length(along), x = 0, height = kMinTriangleHeight * longest;
    if (width > kMinTriangleHeight * longest) {
      x = dot(along, across) / width;
      height = std::max(height, length(cross(along, across)) / width);
    } else {
      width = kMinTriangleHeight * longest;
      height = longest;
    }
    const double gx1 = 1 / width, gy1 = -x / (width * height), gy2 = 1 / height;
    rest.gradients.push_back({{{-gx1, -gy1 - gy2}, {gx1, gy1}, {0, gy2}}});
    rest.weights.push_back(width * height / 2);
  }
  return rest;
}

Jacobian jacobianOf(const RestShapes::Gradients& g, const Triangle3& t, const std::vector<Uv>& uvs) {
  Jacobian j;
  for (std::size_t i = 0; i < 3; ++i) {
    const Uv& uv = uvs[t[i]];
    j.a += uv[0] * g[i][0];
    j.b += uv[0] * g[i][1];
    j.c += uv[1] * g[i][0];
    j.d += uv[1] * g[i][1];
  }
  return j;
}

Slim::Slim(const TriangleMesh& mesh, RestShapes rest)
    : mesh_(mesh), rest_(std::move(rest)), system_(2 * mesh.positions.size(), couplingOf(mesh)) {
  for (const double weight : rest_.weights) weight_ += weight;
}

double Slim::energy(const std::vector<Uv>& uvs) const {
  double sum = 0;
  for (std::size_t t = 0; t < mesh_.triangles.size(); ++t)
    sum += rest_.weights[t] * jacobianOf(rest_.gradients[t], mesh_.triangles[t], uvs).energy();
  return sum / weight_;
}

/// The longest step, up to 1, that comes only part of the way to the first flip.
double Slim::longestStep(const std::vector<Uv>& uvs, const std::vector<Uv>& direction) const {
  double least = 1 / kStepToFlip;
  for (const Triangle3& t : mesh_.triangles) {
    const Uv &a = uvs[t[0]], &b = uvs[t[1]], &c = uvs[t[2]];
    const Uv &da = direction[t[0]], &db = direction[t[1]], &dc = direction[t[2]];
    const double px = b[0] - a[0], py = b[1] - a[1], qx = c[0] - a[0], qy = c[1] - a[1];
    const double dpx = db[0] - da[0], dpy = db[1] - da[1], dqx = dc[0] - da[0], dqy = dc[1] - da[1];
    // The doubled area after a step s is k2 s^2 + k1 s + k0.
    const double k2 = dpx * dqy - dpy * dqx, k1 = px * dqy - py * dqx + dpx * qy - dpy * qx, k0 = px * qy - py * qx;
    const double inner = k1 * k1 - 4 * k2 * k0;
    if (inner < 0) continue;
    // The smallest positive root, by the formula without cancellation.
    const double q = -(k1 + (k1 < 0 ? -std::sqrt(inner) : std::sqrt(inner))) / 2;
    for (const double root : {q != 0 ? k0 / q : -1.0, k2 != 0 ? q / k2 : -1.0})
      if (root > 0) least = std::min(least, root);
  }
  return std::min(1.0, kStepToFlip * least);
}

double Slim::assemble(const std::vector<Uv>& uvs) {
  system_.clear();
  right_.assign(2 * uvs.size(), 0);
  double sum = 0;
  for (std::size_t t = 0; t < mesh_.triangles.size(); ++t) {
    const Triangle3& triangle = mesh_.triangles[t];
    const RestShapes::Gradients& g = rest_.gradients[t];
    const Jacobian j = jacobianOf(g, triangle, uvs);
    const double weight = rest_.weights[t] / weight_;
    sum += weight * j.energy();
    const auto [s1, s2] = j.singularValues();
    // The proxy weighs |J - R|^2 by a matrix with the axes of J J^T and these values.
    const auto weightOf = [](double s) { return (s + 1) * (s * s + 1) / (s * s * s); };
    const double w1 = weightOf(s1), w2 = weightOf(s2), gap = s1 * s1 - s2 * s2;
    const double slope = gap > 1e-9 * s1 * s1 ? (w1 - w2) / gap : 0, base = w1 - slope * s1 * s1;
    const double m00 = weight * (base + slope * (j.a * j.a + j.b * j.b));
    const double m11 = weight * (base + slope * (j.c * j.c + j.d * j.d));
    const double m01 = weight * slope * (j.a * j.c + j.b * j.d);
    // The rotation nearest to J.
    const double cosine = j.a + j.d, sine = j.c - j.b, size = std::sqrt(cosine * cosine + sine * sine);
    const double r0 = size > 0 ? cosine / size : 1, r1 = size > 0 ? sine / size : 0;
    for (std::size_t i = 0; i < 3; ++i) {
      const double x = r0 * g[i][0] - r1 * g[i][1], y = r1 * g[i][0] + r0 * g[i][1];
      const std::uint32_t row = 2 * triangle[i];
      right_[row] += m00 * x + m01 * y;
      right_[row + 1] += m01 * x + m11 * y;
      for (std::size_t k = 0; k < 3; ++k) {
        const double product = g[i][0] * g[k][0] + g[i][1] * g[k][1];
        const std::uint32_t column = 2 * triangle[k];
        system_.add(row, column, product * m00);
        system_.add(row + 1, column, product * m01);
        system_.add(row, column + 1, product * m01);
        system_.add(row + 1, column + 1, product * m11);
      }
    }
  }
  const double proximity = kProximity / weight_;
  for (std::uint32_t row = 0; row < right_.size(); ++row) {
    system_.add(row, row, proximity);
    right_[row] += proximity * uvs[row / 2][row % 2];
  }
  return sum;
}

double Slim::step(std::vector<Uv>& uvs) {
  const double before = assemble(uvs);
  if (!system_.factorize()) return 0;
  const std::vector<double> solution = system_.solve(right_);
  std::vector<Uv> direction(uvs.size());
  for (std::size_t v = 0; v < uvs.size(); ++v) {
    direction[v] = {solution[2 * v] - uvs[v][0], solution[2 * v + 1] - uvs[v][1]};
    if (!std::isfinite(direction[v][0]) || !std::isfinite(direction[v][1])) return 0;
  }
  double size = longestStep(uvs, direction);
  std::vector<Uv> moved(uvs.size());
  for (int i = 0; i < kHalvings; ++i, size /= 2) {
    for (std::size_t v = 0; v < uvs.size(); ++v)
      moved[v] = {uvs[v][0] + size * direction[v][0], uvs[v][1] + size * direction[v][1]};
    const double after = energy(moved);
    if (after < before) {
      uvs.swap(moved);
      return (before - after) / before;
    }
  }
  return 0;
}

}  // namespace cagecast::cages
