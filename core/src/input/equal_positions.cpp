#include "input/equal_positions.hpp"

#include <cstddef>

namespace cagecast {

void findFirstAtPosition(std::span<const float> positions, HashIndex& index, std::uint32_t* first) noexcept {
  const auto count = static_cast<std::uint32_t>(positions.size() / 3);
  for (std::uint32_t v = 0; v < count; ++v) {
    const float* p = positions.data() + std::size_t{3} * v;
    const float position[3] = {p[0] + 0.0f, p[1] + 0.0f, p[2] + 0.0f};  // −0 becomes 0.
    first[v] = index.firstEqual(v, HashIndex::hash(position), [&](std::uint32_t other) {
      const float* o = positions.data() + std::size_t{3} * other;
      return o[0] == p[0] && o[1] == p[1] && o[2] == p[2];
    });
  }
}

}  // namespace cagecast
