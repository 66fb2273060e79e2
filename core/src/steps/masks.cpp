#include "steps/masks.hpp"

#include <algorithm>

#include "steps/classify.hpp"

namespace cagecast {
namespace {

Mask maskOf(std::span<const Mask> masks, std::size_t i) { return masks.empty() ? Mask::automatic : masks[i]; }

Status checkList(std::span<const Mask> masks, std::size_t count, Option option) {
  if (masks.empty()) return {};
  const auto wrong = [=](std::size_t at, float value) {
    return Status{Code::badOption, Argument::options, static_cast<std::uint32_t>(at), option, value};
  };
  if (masks.size() != count) return wrong(masks.size(), 0);
  const auto isMask = [](Mask mask) { return mask >= Mask::never && mask <= Mask::always; };
  const auto at = static_cast<std::size_t>(std::find_if_not(masks.begin(), masks.end(), isMask) - masks.begin());
  return at == count ? Status{} : wrong(at, static_cast<float>(masks[at]));
}

/// What the mask of a triangle and the masks of its corners say together, without its corners' zones.
struct TriangleMask {
  bool isNever, isAlways, isOfCorner;

  TriangleMask(const Masks& masks, std::span<const std::uint32_t> indices, std::size_t triangle) {
    const auto corners = indices.subspan(3 * triangle, 3);
    const auto hasCorner = [&](Mask mask) {
      return std::any_of(corners.begin(), corners.end(),
                         [&](std::uint32_t v) { return maskOf(masks.vertices, v) == mask; });
    };
    const Mask own = maskOf(masks.triangles, triangle);
    isNever = own == Mask::never || hasCorner(Mask::never);
    isAlways = own == Mask::always && !isNever;
    isOfCorner = hasCorner(Mask::always);
  }
};

/// Gives vertices the zones that the masks of their triangles ask for: cosmetic at one that always is, culled where all
/// are masked.
bool maskCorners(const Masks& masks, std::span<const std::uint32_t> indices, Array<Zone>& zones) {
  Array<std::uint8_t> hasOthers;  // 1 per vertex: whether it has a triangle that is not `never`.
  if (!hasOthers.reset(zones.size())) return false;
  std::fill(hasOthers.begin(), hasOthers.end(), std::uint8_t{0});
  for (std::size_t i = 0; i < indices.size(); ++i) {
    if (masks.triangles[i / 3] != Mask::never) hasOthers[indices[i]] = 1;
  }
  for (std::size_t t = 0; t < masks.triangles.size(); ++t) {
    if (masks.triangles[t] == Mask::automatic) continue;
    const bool isAlways = TriangleMask(masks, indices, t).isAlways;
    for (const std::uint32_t v : indices.subspan(3 * t, 3)) {
      if (isAlways) zones[v] = Zone::cosmetic;
      if (hasOthers[v] == 0) zones[v] = Zone::culled;
    }
  }
  return true;
}

}  // namespace

Status checkMasks(const Masks& masks, std::size_t vertexCount, std::size_t triangleCount) noexcept {
  const Status status = checkList(masks.vertices, vertexCount, Option::vertexMasks);
  return status.ok() ? checkList(masks.triangles, triangleCount, Option::triangleMasks) : status;
}

std::optional<bool> maskedVerdict(const TransferOptions& options, std::span<const std::uint32_t> indices,
                                  std::span<const Zone> zones, std::size_t triangle) noexcept {
  const TriangleMask mask(options.masks, indices, triangle);
  if (mask.isNever || mask.isAlways) return mask.isAlways;
  if (!mask.isOfCorner) return std::nullopt;
  return isCosmetic(zones, indices.data() + 3 * triangle, options);
}

bool applyMasks(const TransferOptions& options, std::span<const std::uint32_t> indices, Zones& out) noexcept {
  const Masks& masks = options.masks;
  for (std::size_t v = 0; v < masks.vertices.size(); ++v) {
    if (masks.vertices[v] == Mask::never) out.zones[v] = Zone::culled;
    if (masks.vertices[v] == Mask::always) out.zones[v] = Zone::cosmetic;
  }
  if (!masks.triangles.empty() && !maskCorners(masks, indices, out.zones)) return false;
  if (masks.vertices.empty() && masks.triangles.empty()) return true;
  for (std::size_t t = 0; t < out.cosmeticTriangles.size(); ++t) {
    const std::optional<bool> verdict = maskedVerdict(options, indices, out.zones, t);
    if (verdict) out.cosmeticTriangles[t] = *verdict;
  }
  return true;
}

}  // namespace cagecast
