#include "input/ignored_parts.hpp"

#include <algorithm>

namespace cagecast {
namespace {

/// Which vertices are of some groups.
/// @param[out] isIgnored  1 per vertex.
/// @return badOption for a group without vertices.
Status findIgnored(std::span<const std::uint32_t> groups, const MeshView& target, Arena& arena, bool* isIgnored) {
  const Arena::Scope scope(arena);
  auto* sorted = arena.allocate<std::uint32_t>(groups.size());
  auto* isFound = arena.allocate<bool>(groups.size());
  if (arena.failed()) return {Code::outOfMemory};
  std::copy(groups.begin(), groups.end(), sorted);
  std::sort(sorted, sorted + groups.size());
  std::fill_n(isFound, groups.size(), false);
  const auto placeOf = [&](std::uint32_t group) {
    return static_cast<std::size_t>(std::lower_bound(sorted, sorted + groups.size(), group) - sorted);
  };
  for (std::size_t v = 0; v < target.positions.size() / 3; ++v) {
    const std::uint32_t group = target.groups.empty() ? 0 : target.groups[v];
    const std::size_t place = placeOf(group);
    isIgnored[v] = place < groups.size() && sorted[place] == group;
    if (isIgnored[v]) isFound[place] = true;
  }
  for (const std::uint32_t group : groups) {
    if (!isFound[placeOf(group)]) return {Code::badOption, Argument::options, group, Option::ignoredParts};
  }
  return {};
}

}  // namespace

Status ignoreParts(std::span<const std::uint32_t> groups, Arena& arena, MeshView& target) noexcept {
  if (groups.empty()) return {};
  const std::size_t vertexCount = target.positions.size() / 3;
  auto* isIgnored = arena.allocate<bool>(vertexCount);
  auto* positions = arena.allocate<float>(target.positions.size());
  auto* poses = arena.allocate<float>(target.poses.size());
  auto* indices = arena.allocate<std::uint32_t>(target.indices.size());
  if (arena.failed()) return {Code::outOfMemory};
  if (const Status status = findIgnored(groups, target, arena, isIgnored); !status.ok()) return status;
  const auto left = static_cast<std::size_t>(std::find(isIgnored, isIgnored + vertexCount, false) - isIgnored);
  if (left == vertexCount) return {Code::badOption, Argument::options, groups[0], Option::ignoredParts, 1};

  // A pose that is not whole is found later.
  const auto place = [&](std::span<const float> from, float* to) {
    for (std::size_t i = 0; i < from.size(); ++i) {
      const std::size_t v = i / 3 % vertexCount;
      const std::size_t of = isIgnored[v] ? i - 3 * v + 3 * left : i;
      to[i] = from[of < from.size() ? of : i];
    }
  };
  place(target.positions, positions);
  place(target.poses, poses);
  for (std::size_t i = 0; i < target.indices.size(); i += 3) {
    const auto corners = target.indices.subspan(i, 3);
    const auto* const ignored =
        std::find_if(corners.data(), corners.data() + 3, [&](std::uint32_t v) { return isIgnored[v]; });
    const bool isThere = ignored == corners.data() + 3;
    for (std::size_t k = 0; k < 3; ++k) indices[i + k] = isThere ? corners[k] : *ignored;
  }
  target.positions = {positions, target.positions.size()};
  target.poses = {poses, target.poses.size()};
  target.indices = {indices, target.indices.size()};
  return {};
}

}  // namespace cagecast
