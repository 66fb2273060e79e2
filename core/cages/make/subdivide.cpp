#include "make/steps.hpp"

#include <array>
#include <unordered_map>

namespace cagecast::cages {

void subdivide(const std::vector<bool>& isChosen, TriangleMesh& mesh, std::vector<std::uint32_t>& parents) {
  std::unordered_map<std::uint64_t, std::uint32_t> middles;
  for (const Triangle3& t : mesh.triangles) {
    if (!isChosen[t[0]] && !isChosen[t[1]] && !isChosen[t[2]]) continue;
    for (std::size_t i = 0; i < 3; ++i) {
      const std::uint32_t a = t[i], b = t[(i + 1) % 3];
      const auto [found, isNew] = middles.try_emplace(edgeKey(a, b), static_cast<std::uint32_t>(mesh.positions.size()));
      if (isNew) mesh.positions.push_back(0.5 * (mesh.positions[a] + mesh.positions[b]));
    }
  }
  std::vector<Triangle3> triangles;
  std::vector<std::uint32_t> inherited;
  triangles.reserve(mesh.triangles.size());
  inherited.reserve(mesh.triangles.size());
  for (std::size_t old = 0; old < mesh.triangles.size(); ++old) {
    const Triangle3& t = mesh.triangles[old];
    const auto add = [&](std::uint32_t a, std::uint32_t b, std::uint32_t c) {
      triangles.push_back({a, b, c});
      inherited.push_back(parents[old]);
    };
    std::array<std::uint32_t, 3> middle{};
    unsigned cuts = 0;
    for (std::size_t i = 0; i < 3; ++i) {
      const auto found = middles.find(edgeKey(t[i], t[(i + 1) % 3]));
      middle[i] = found == middles.end() ? kNone : found->second;
      cuts += found == middles.end() ? 0 : 1;
    }
    if (cuts == 0) {
      add(t[0], t[1], t[2]);
    } else if (cuts == 3) {
      for (std::size_t i = 0; i < 3; ++i) add(t[i], middle[i], middle[(i + 2) % 3]);
      add(middle[0], middle[1], middle[2]);
    } else {
      // Turned so that the first edge is cut, and the last one is not.
      std::size_t i = 0;
      while (middle[i] == kNone || middle[(i + 2) % 3] != kNone) ++i;
      const std::uint32_t a = t[i], b = t[(i + 1) % 3], c = t[(i + 2) % 3], m = middle[i], n = middle[(i + 1) % 3];
      add(a, m, c);
      if (cuts == 1) {
        add(m, b, c);
      } else {
        add(m, b, n);
        add(m, n, c);
      }
    }
  }
  parents.swap(inherited);
  mesh.triangles.swap(triangles);
}

}  // namespace cagecast::cages
