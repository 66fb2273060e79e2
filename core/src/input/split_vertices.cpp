#include <algorithm>
#include <cstring>
#include <utility>

#include "base/hash_index.hpp"
#include "cagecast/split.hpp"

namespace cagecast {

Status splitVertices(std::span<const std::uint32_t> indices, std::span<const float> cornerUvs,
                     std::uint32_t vertexCount, SplitVertices& out) noexcept {
  const auto fault = [](Code code, std::size_t at = 0) {
    return Status{code, Argument::target, static_cast<std::uint32_t>(at)};
  };
  if (indices.size() % 3 != 0) return fault(Code::indicesNotTriples);
  if (indices.size() / 3 > kMaxTriangles) return fault(Code::tooLarge, indices.size() / 3);
  if (cornerUvs.size() != 2 * indices.size()) return fault(Code::cornerUvCountMismatch, cornerUvs.size());
  const auto stray = std::find_if(indices.begin(), indices.end(), [=](std::uint32_t v) { return v >= vertexCount; });
  if (stray != indices.end()) return fault(Code::indexOutOfRange, static_cast<std::size_t>(stray - indices.begin()));

  // Two corners are the same if their vertices and UVs are equal; −0 equals 0.
  struct Corner {
    std::uint32_t vertex;
    float u, v;
    // NOLINTNEXTLINE(bugprone-suspicious-memory-comparison): equal bits are what counts.
    bool operator==(const Corner& other) const { return std::memcmp(this, &other, sizeof(Corner)) == 0; }
  };
  const auto corner = [&](std::size_t i) {
    return Corner{indices[i], cornerUvs[2 * i] + 0.0f, cornerUvs[2 * i + 1] + 0.0f};
  };

  Arena arena;
  const auto cornerCount = static_cast<std::uint32_t>(indices.size());
  auto* firstCorners = arena.allocate<std::uint32_t>(cornerCount);  // Of each new vertex.
  HashIndex known(cornerCount, arena);
  SplitVertices made;  // The arguments may be arrays of `out`.
  if (arena.failed() || !made.indices.reset(cornerCount)) return {Code::outOfMemory};
  std::uint32_t count = 0;
  for (std::uint32_t i = 0; i < cornerCount; ++i) {
    const Corner c = corner(i);
    const std::uint32_t first =
        known.firstEqual(i, HashIndex::hash(c), [&](std::uint32_t other) { return corner(other) == c; });
    if (first == i) firstCorners[count++] = i;
    made.indices[i] = first == i ? count - 1 : made.indices[first];
  }
  if (!made.sources.reset(count) || !made.uvs.reset(std::size_t{2} * count)) return {Code::outOfMemory};
  for (std::uint32_t n = 0; n < count; ++n) {
    const std::size_t i = firstCorners[n];
    made.sources[n] = indices[i];
    std::copy_n(cornerUvs.data() + 2 * i, 2, made.uvs.data() + std::size_t{2} * n);
  }
  out = std::move(made);
  return {};
}

}  // namespace cagecast
