#pragma once

#include <span>

#include "mesh/triangle_mesh.hpp"

namespace cagecast::cages {

/// The neighbours of each vertex of a mesh: the vertices that it shares an edge with, in ascending order.
class Neighbours {
 public:
  Neighbours() = default;
  explicit Neighbours(const TriangleMesh& mesh);

  /// The number of vertices.
  [[nodiscard]] std::size_t size() const { return ends_.size(); }
  [[nodiscard]] std::span<const std::uint32_t> operator[](std::size_t vertex) const {
    const std::uint32_t first = vertex == 0 ? 0 : ends_[vertex - 1];
    return {list_.data() + first, ends_[vertex] - first};
  }

 private:
  std::vector<std::uint32_t> list_;  ///< Vertex by vertex.
  std::vector<std::uint32_t> ends_;  ///< 1 per vertex: where its neighbours end in the list.
};

/// Marks all vertices that are at most so many edges away from a marked one.
void grow(const Neighbours& neighbours, std::vector<bool>& marks, int edges = 1);

}  // namespace cagecast::cages
