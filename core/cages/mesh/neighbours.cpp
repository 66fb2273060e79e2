#include "mesh/neighbours.hpp"

#include <algorithm>
#include <utility>

namespace cagecast::cages {

Neighbours::Neighbours(const TriangleMesh& mesh) : ends_(mesh.positions.size(), 0) {
  // Each corner has two neighbours in its triangle. List them all, by a counting sort.
  for (const Triangle3& t : mesh.triangles)
    for (const std::uint32_t v : t) ends_[v] += 2;
  std::uint32_t total = 0;
  for (std::uint32_t& end : ends_) total += std::exchange(end, total);
  list_.resize(total);
  for (const Triangle3& t : mesh.triangles)
    for (std::size_t i = 0; i < 3; ++i)
      for (std::size_t k = 1; k < 3; ++k) list_[ends_[t[i]]++] = t[(i + k) % 3];
  // Two triangles at an edge list the same neighbour.
  std::uint32_t *first = list_.data(), *kept = first;
  for (std::uint32_t& end : ends_) {
    std::uint32_t* const last = list_.data() + end;
    std::sort(first, last);
    kept = std::move(first, std::unique(first, last), kept);
    first = last;
    end = static_cast<std::uint32_t>(kept - list_.data());
  }
  list_.resize(static_cast<std::size_t>(kept - list_.data()));
}

void grow(const Neighbours& neighbours, std::vector<bool>& marks, int edges) {
  std::vector<std::uint32_t> front, next;
  for (std::uint32_t v = 0; v < marks.size(); ++v)
    if (marks[v]) front.push_back(v);
  for (int i = 0; i < edges; ++i) {
    for (const std::uint32_t v : front)
      for (const std::uint32_t n : neighbours[v]) {
        if (marks[n]) continue;
        marks[n] = true;
        next.push_back(n);
      }
    front.swap(next);
    next.clear();
  }
}

}  // namespace cagecast::cages
