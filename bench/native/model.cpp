#include "model.hpp"

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <cstring>
#include <fstream>
#include <iterator>
#include <map>
#include <numeric>
#include <tuple>

namespace cagecast::bench {
namespace {

static_assert(std::endian::native == std::endian::little, "scene files are read as they lie in memory");

template <typename T>
void take(std::istream& in, std::vector<T>& values, std::size_t count) {
  values.resize(count);
  in.read(reinterpret_cast<char*>(values.data()), static_cast<std::streamsize>(count * sizeof(T)));
}

void takeMesh(std::istream& in, Mesh& mesh) {
  std::vector<std::uint32_t> counts;
  std::vector<std::uint8_t> flags;
  take(in, counts, 2);
  take(in, flags, 4);
  if (!in) return;
  mesh.positions.reserve(std::size_t{3} * counts[0] + 1);  // Embree reads 16 bytes at each position.
  take(in, mesh.positions, std::size_t{3} * counts[0]);
  take(in, mesh.indices, counts[1]);
  if (flags[0] != 0) take(in, mesh.uvs, std::size_t{2} * counts[0]);
  if (flags[1] != 0) take(in, mesh.groups, counts[0]);
}

/// Spreads the lowest 10 bits three apart.
std::uint32_t spread(std::uint32_t bits) {
  bits = (bits | bits << 16) & 0x030000ff;
  bits = (bits | bits << 8) & 0x0300f00f;
  bits = (bits | bits << 4) & 0x030c30c3;
  return (bits | bits << 2) & 0x09249249;
}

Points weld(const Mesh& mesh) {
  using Position = std::array<float, 3>;
  const auto at = [&](std::size_t v) {
    return Position{mesh.positions[3 * v], mesh.positions[3 * v + 1], mesh.positions[3 * v + 2]};
  };
  const std::size_t vertexCount = mesh.positions.size() / 3;
  Position low = at(0);
  Position high = low;
  for (std::size_t v = 0; v < vertexCount; ++v)
    for (std::size_t k = 0; k < 3; ++k) {
      low[k] = std::min(low[k], at(v)[k]);
      high[k] = std::max(high[k], at(v)[k]);
    }
  const Position size{high[0] - low[0], high[1] - low[1], high[2] - low[2]};
  const float side = *std::max_element(size.begin(), size.end());

  std::map<std::tuple<std::uint32_t, Position, std::uint32_t>, std::vector<std::uint32_t>> verticesAt;
  for (std::uint32_t v = 0; v < vertexCount; ++v) {
    const Position p = at(v);
    std::uint32_t key = 0;
    for (std::size_t k = 0; k < 3; ++k) {
      const float cell = side > 0 ? 1023 * (p[k] - low[k]) / side : 0;
      key |= spread(static_cast<std::uint32_t>(cell)) << k;
    }
    verticesAt[{key, p, mesh.groups.empty() ? 0 : mesh.groups[v]}].push_back(v);
  }
  Points points;
  points.diagonal = std::hypot(size[0], size[1], size[2]);
  points.ofVertex.resize(vertexCount);
  for (const auto& [where, vertices] : verticesAt) {
    for (const std::uint32_t v : vertices) points.ofVertex[v] = static_cast<std::uint32_t>(points.positions.size() / 3);
    const Position& p = std::get<1>(where);
    points.positions.insert(points.positions.end(), p.begin(), p.end());
  }
  return points;
}

}  // namespace

std::string readModel(const std::string& path, Model& out) {
  std::ifstream in(path, std::ios::binary);
  std::vector<char> magic;
  take(in, magic, 8);
  if (!in || std::memcmp(magic.data(), "CAGESCN1", magic.size()) != 0) return path + ": is not a scene file";
  takeMesh(in, out.cage);
  takeMesh(in, out.target);
  if (!in || in.peek() != std::ifstream::traits_type::eof()) return path + ": is cut off, or longer than it says";
  out.points = weld(out.target);
  return "";
}

}  // namespace cagecast::bench
