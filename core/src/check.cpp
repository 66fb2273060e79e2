#include "check.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

#include "simd.hpp"

namespace cagecast {
namespace {

/// Farthest a coordinate may be from the origin, in diagonals of the target: fourth powers of it still fit a float with
/// room to spare, and at this distance a float no longer resolves the target anyway.
constexpr float kMaxProportion = 1e8f;
/// Rays may begin between floats, and then round with the distance from the origin of coordinates; where that is so many
/// times the scene, it is what the kernels must allow for.
constexpr float kRestReach = 0.5f;
/// Largest weld tolerance, as a share of the diagonal: beyond it a head is a handful of points.
constexpr float kMaxWeldTolerance = 0.01f;

struct Box {
  float low[3] = {std::numeric_limits<float>::infinity(), std::numeric_limits<float>::infinity(),
                  std::numeric_limits<float>::infinity()};
  float high[3] = {-std::numeric_limits<float>::infinity(), -std::numeric_limits<float>::infinity(),
                   -std::numeric_limits<float>::infinity()};

  [[nodiscard]] double diagonal() const {
    double sum = 0;
    for (int k = 0; k < 3; ++k) {
      const double side = static_cast<double>(high[k]) - static_cast<double>(low[k]);
      sum += side * side;
    }
    return std::sqrt(sum);
  }
};

/// The place of the first value that is not finite, or the size.
std::size_t firstNonFinite(std::span<const float> values) {
  // x · 0 is 0 for finite x and NaN otherwise: one sum tells whether there is anything to look for.
  simd::f32x4 sums = simd::splat(0);
  std::size_t i = 0;
  for (; i + simd::kWidth <= values.size(); i += simd::kWidth) sums = sums + simd::load(&values[i]) * simd::splat(0);
  bool finite = simd::bits(sums <= simd::splat(0)) == 15;
  for (; i < values.size(); ++i) finite = finite && std::isfinite(values[i]);
  if (finite) return values.size();
  return static_cast<std::size_t>(
      std::find_if(values.begin(), values.end(), [](float x) { return !std::isfinite(x); }) - values.begin());
}

std::uint32_t highestOf(std::span<const std::uint32_t> indices) {
  simd::count4 fours = simd::splatCount(0);
  std::size_t i = 0;
  for (; i + simd::kWidth <= indices.size(); i += simd::kWidth) fours = simd::max(fours, simd::load(&indices[i]));
  std::uint32_t highest = std::max({simd::countOf<0>(fours), simd::countOf<1>(fours), simd::countOf<2>(fours), simd::countOf<3>(fours)});
  for (; i < indices.size(); ++i) highest = std::max(highest, indices[i]);
  return highest;
}

Status checkMesh(const MeshView& mesh, Argument argument, Box& box) {
  const auto fault = [argument](Code code, std::size_t at = 0) {
    return Status{code, argument, static_cast<std::uint32_t>(std::min<std::size_t>(at, UINT32_MAX))};
  };
  if (mesh.positions.empty()) return fault(Code::emptyMesh);
  if (mesh.positions.size() % 3 != 0) return fault(Code::positionsNotTriples, mesh.positions.size());
  const std::size_t vertices = mesh.positions.size() / 3;
  if (mesh.indices.empty()) return fault(Code::emptyMesh);
  if (mesh.indices.size() % 3 != 0) return fault(Code::indicesNotTriples, mesh.indices.size());
  if (vertices > kMaxVertices) return fault(Code::tooLarge, vertices);
  if (mesh.indices.size() / 3 > kMaxTriangles) return fault(Code::tooLarge, mesh.indices.size() / 3);
  if (!mesh.uvs.empty() && mesh.uvs.size() != 2 * vertices) return fault(Code::uvCountMismatch, mesh.uvs.size());
  if (argument == Argument::cage && mesh.uvs.empty()) return fault(Code::missingUvs);
  if (!mesh.groups.empty() && mesh.groups.size() != vertices) return fault(Code::groupCountMismatch, mesh.groups.size());

  if (const std::size_t at = firstNonFinite(mesh.positions); at < mesh.positions.size()) {
    return fault(Code::nonFinitePosition, at);
  }
  if (const std::size_t at = firstNonFinite(mesh.uvs); at < mesh.uvs.size()) return fault(Code::nonFiniteUv, at);
  const std::uint32_t highest = highestOf(mesh.indices);
  if (highest >= vertices) {
    const auto first = std::find_if(mesh.indices.begin(), mesh.indices.end(), [&](std::uint32_t i) { return i >= vertices; });
    return fault(Code::indexOutOfRange, static_cast<std::size_t>(first - mesh.indices.begin()));
  }

  // Four vertices are three vectors; what lane holds which axis repeats.
  const float* p = mesh.positions.data();
  const std::size_t fours = vertices / simd::kWidth * simd::kWidth;
  if (fours > 0) {
    simd::f32x4 low[3] = {simd::load(p), simd::load(p + 4), simd::load(p + 8)};
    simd::f32x4 high[3] = {low[0], low[1], low[2]};
    for (std::size_t v = simd::kWidth; v < fours; v += simd::kWidth) {
      for (std::size_t j = 0; j < 3; ++j) {
        const simd::f32x4 row = simd::load(p + 3 * v + 4 * j);
        low[j] = simd::min(low[j], row);
        high[j] = simd::max(high[j], row);
      }
    }
    float lows[12];
    float highs[12];
    for (std::size_t j = 0; j < 3; ++j) {
      simd::store(lows + 4 * j, low[j]);
      simd::store(highs + 4 * j, high[j]);
    }
    for (std::size_t j = 0; j < 12; ++j) {
      box.low[j % 3] = std::min(box.low[j % 3], lows[j]);
      box.high[j % 3] = std::max(box.high[j % 3], highs[j]);
    }
  }
  for (std::size_t v = fours; v < vertices; ++v) {
    for (std::size_t k = 0; k < 3; ++k) {
      box.low[k] = std::min(box.low[k], p[3 * v + k]);
      box.high[k] = std::max(box.high[k], p[3 * v + k]);
    }
  }
  return {};
}

/// The place of the first coordinate that is out of proportion, or the size.
std::size_t firstTooLarge(std::span<const float> positions, double scale) {
  const auto found = std::find_if(positions.begin(), positions.end(), [&](float x) {
    return std::abs(static_cast<double>(x) * scale) > static_cast<double>(kMaxProportion);
  });
  return static_cast<std::size_t>(found - positions.begin());
}

}  // namespace

Status checkInput(const MeshView& cage, const MeshView& target, const ProjectOptions& options, Units& units) noexcept {
  Box cageBox;
  Box targetBox;
  if (const Status status = checkMesh(cage, Argument::cage, cageBox); !status.ok()) return status;
  if (const Status status = checkMesh(target, Argument::target, targetBox); !status.ok()) return status;
  if (!(options.weldTolerance >= 0.0f && options.weldTolerance <= kMaxWeldTolerance)) {
    return {Code::badWeldTolerance, Argument::options};
  }
  if (!(options.occlusionReach >= 0.0f)) return {Code::badOcclusionReach, Argument::options};
  if (!(options.pokeThrough >= 0.0f && options.pokeThrough <= 1.0f)) return {Code::badPokeThrough, Argument::options};

  // A target that is a single point has no size; then the cage's serves.
  const double size = targetBox.diagonal() > 0 ? targetBox.diagonal() : cageBox.diagonal();
  int exponent = 0;
  if (size > 0) std::frexp(size, &exponent);
  const double scale = std::ldexp(1.0, std::clamp(1 - exponent, -126, 127));
  float reach = 0;
  for (int k = 0; k < 3; ++k) {
    const auto scaled = [scale](float x) { return static_cast<float>(static_cast<double>(x) * scale); };
    for (const float x : {cageBox.low[k], cageBox.high[k]}) {
      if (std::abs(scaled(x)) > kMaxProportion) {
        return {Code::tooLarge, Argument::cage, static_cast<std::uint32_t>(firstTooLarge(cage.positions, scale))};
      }
    }
    for (const float x : {targetBox.low[k], targetBox.high[k]}) {
      if (std::abs(scaled(x)) > kMaxProportion) {
        return {Code::tooLarge, Argument::target, static_cast<std::uint32_t>(firstTooLarge(target.positions, scale))};
      }
    }
    units.low[k] = scaled(targetBox.low[k]);
    units.high[k] = scaled(targetBox.high[k]);
    const float low = std::min(units.low[k], scaled(cageBox.low[k]));
    const float high = std::max(units.high[k], scaled(cageBox.high[k]));
    reach = std::max({reach, high - low, high * kRestReach, -low * kRestReach});
  }
  units.scale = static_cast<float>(scale);
  units.diagonal = targetBox.diagonal() * scale;
  units.reach = reach;
  return {};
}

Status checkClassifyOptions(const ClassifyOptions& options) noexcept {
  if (!(options.threshold >= 0.0f && options.threshold <= 1.0f)) return {Code::badThreshold, Argument::options};
  if (!(options.minCovered >= 0.0f && options.minCovered <= 1.0f)) return {Code::badMinCovered, Argument::options};
  if (!(options.minOfAll >= 0.0f && options.minOfAll <= 1.0f)) return {Code::badMinOfAll, Argument::options};
  if (!(options.maxUncovered >= 0.0f && options.maxUncovered <= 1.0f)) return {Code::badMaxUncovered, Argument::options};
  return {};
}

}  // namespace cagecast
