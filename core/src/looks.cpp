#include "looks.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

namespace cagecast {
namespace {

constexpr double kFar = std::numeric_limits<double>::infinity();

}  // namespace

double Looker::Line::squaredDistance(Vec3 p) const noexcept {
  const Vec3 offset = p - from;
  const double t = std::min(std::max(dot(offset, along) * inverseSquare, 0.0), 1.0);
  const Vec3 away = offset - t * along;
  return dot(away, away);
}

Looker::Looker(const MeshView& mesh, const Cage& cage, const CageTree& tree, const Rims& rims, const Atlas* atlas, const Units& units,
               Scratch& scratch) noexcept
    : mesh_(mesh),
      cage_(cage),
      rims_(rims),
      atlas_(atlas),
      diagonal_(units.diagonal),
      // Places are rounded for the search, by less than what a reach more makes it allow for.
      search_(tree, units.diagonal + static_cast<double>(units.reach), scratch),
      found_(scratch.take<std::uint32_t>(cage.count)),
      candidates_(scratch.take<Candidate>(cage.count)),
      clearances_(scratch.take<double>(mesh.positions.size() / 3)) {
  auto* lines = scratch.take<Line>(std::size_t{3} * cage.count);
  lines_ = lines;
  if (scratch.failed()) return;
  for (std::uint32_t side = 0; side < 3 * cage.count; ++side) {
    const CageTriangle& t = cage.triangles[side / 3];
    const std::uint32_t k = side % 3;
    // An edge that the texture has one side of is a seam, if it is no rim.
    if (atlas != nullptr ? atlas->nextSide[side] != side : rims.ofSides[std::size_t{6} * (side / 3) + k] == Rims::kNone) continue;
    const float* corners[3] = {t.a, t.b, t.c};
    const Vec3 from = Vec3::from(corners[k]);
    const Vec3 along = Vec3::from(corners[(k + 1) % 3]) - from;
    lines[lineCount_++] = {from, along, 1 / dot(along, along)};
  }
  // There are few rims, and many places: how far each is from them is asked of all of them. Of seams there may be many.
  if (atlas == nullptr) return;
  std::fill(clearances_, clearances_ + mesh.positions.size() / 3, kFar);
  for (std::uint32_t slot = 0; slot < cage.count; ++slot) {
    const CageTriangle& t = cage.triangles[slot];
    const float* corners[3] = {t.a, t.b, t.c};
    for (std::uint32_t k = 0; k < 3; ++k) {
      const std::uint32_t vertex = cornersOf(slot)[k];
      if (clearances_[vertex] < kFar) continue;
      double least = kFar;
      for (std::size_t i = 0; i < lineCount_; ++i) least = std::min(least, lines[i].squaredDistance(Vec3::from(corners[k])));
      clearances_[vertex] = std::sqrt(least);
    }
  }
}

void Looker::at(const Vec3* places, std::uint32_t count, Look* looks) noexcept {
  alignas(16) float rounded[kMost][4] = {};
  for (std::uint32_t i = 0; i < count; ++i) {
    const Vec3 p = places[i];
    const float row[4] = {static_cast<float>(p.x), static_cast<float>(p.y), static_cast<float>(p.z), 0};
    std::copy(row, row + 4, rounded[i]);
  }
  search_.search(rounded[0], count);
  for (std::uint32_t i = 0; i < count; ++i) {
    const std::uint32_t found = search_.candidates(i, found_);
    for (std::uint32_t c = 0; c < found; ++c) candidates_[c] = {found_[c], placeOn(cage_.triangles[found_[c]], places[i])};
    looks[i] = judge(nearestOf(candidates_, found, diagonal_));
  }
}

Look Looker::judge(const Candidate& nearest) const noexcept {
  const auto& [slot, place] = nearest;
  const CageTriangle& t = cage_.triangles[slot];
  const Vec3 q = positionOf(t, place);
    Look look{atlas_ == nullptr ? 0 : atlas_->islands[slot], 4 * slot + 3, {slot, place.distance, uvAt(t, place)}};
  const std::uint32_t side = atlas_ == nullptr ? rims_.sideAt(t, slot, q, diagonal_) : Rims::kNone;
  if (side != Rims::kNone) {
    constexpr std::uint32_t kCorner = 1u << 31;
    look.side = 1;
    look.cell = side < 3 ? 4 * slot + side : kCorner | rims_.vertexOf[cornersOf(slot)[side - 3]];
  }
  return look;
}

double Looker::clearance(const Look& look, Vec3 p) const noexcept {
  const double distance = look.landing.distance;
  double least = 0;
  if (atlas_ == nullptr) {
    least = kFar;
    for (std::size_t i = 0; i < lineCount_; ++i) least = std::min(least, lines_[i].squaredDistance(p));
    least = std::sqrt(least);
  } else {
    const CageTriangle& t = cage_.triangles[look.landing.slot];
    const float* corners[3] = {t.a, t.b, t.c};
    for (std::uint32_t k = 0; k < 3; ++k) {
      least = std::max(least, clearances_[cornersOf(look.landing.slot)[k]] - length(p - Vec3::from(corners[k])));
    }
  }
  // The distance to the cage, and that to its rims or seams, change by no more than one steps.
  return (least - distance) / 2;
}

}  // namespace cagecast
