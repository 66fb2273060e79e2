#pragma once

#include "base/list.hpp"
#include "clip/piece_builder.hpp"

namespace cagecast {

/// Finds regions that lie inside a piece without reaching its edges: no crossing on an edge tells of them.
class EnclosedSearch {
 public:
  explicit EnclosedSearch(TargetTriangle& triangle) noexcept
      : triangle_(triangle), left_(kSharedParts + kSharedPartsPerTriangle * triangle.input.target.indices.size() / 3) {}

  /// Finds a point well inside one of some pieces that is not in the region of that piece.
  /// Cost: a piece is quartered until its parts surely lie in one region or are as small as the features that may be
  /// missed. Where neither is provable, that is some thousand parts for a large piece.
  /// @return false if there is none, or none was found among the parts that may be searched.
  bool find(const List<Piece>& pieces, TrianglePoint& point) noexcept;

  [[nodiscard]] bool failed() const noexcept { return parts_.failed(); }

 private:
  /// How many parts are searched for each piece in any case: the piece, its quarters and theirs. So a region that is
  /// missed is smaller than a quarter of the piece, whatever was searched before.
  static constexpr std::size_t kOwnParts = 1 + 4 + 16;
  /// How many more parts all searches of a pass share, and how many more for each triangle of the target. A real car
  /// with many borders needs 26 per triangle.
  static constexpr std::size_t kSharedParts = 8192;
  static constexpr std::size_t kSharedPartsPerTriangle = 256;

  /// The greatest number of corners of a core: a triangle that was clipped three times, each of which adds half as many
  /// corners at most, even if rounding makes it less than convex.
  static constexpr std::size_t kMaxCorners = 9;

  /// A part of a piece that has to be searched.
  struct Part {
    TrianglePoint corners[3];
    std::uint32_t piece;
    NearbyTriangles nearby;  ///< Of what is well inside the piece.
  };

  void addPart(const Piece& piece, Part part) noexcept;
  [[nodiscard]] std::uint32_t clipToCore(const Piece& piece, const Part& part,
                                         Vec3 (&core)[kMaxCorners]) const noexcept;

  TargetTriangle& triangle_;
  List<Part> parts_;
  std::size_t left_;  ///< Of the shared parts.
};

}  // namespace cagecast
