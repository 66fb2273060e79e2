#pragma once

#include "base/list.hpp"
#include "clip/piece_builder.hpp"

namespace cagecast {

/// Finds regions that lie inside a piece without reaching its edges: no crossing on an edge tells of them.
class EnclosedSearch {
 public:
  explicit EnclosedSearch(TargetTriangle& triangle) noexcept
      : triangle_(triangle), left_(kBaseParts + kPartsPerTriangle * triangle.input.target.indices.size() / 3) {}

  /// Finds a point well inside one of some pieces that is not in the region of that piece.
  /// Cost: a piece is quartered until its parts surely lie in one region or are as small as the features that may be
  /// missed. Where neither is provable, that is some thousand parts for a large piece.
  /// @return false if there is none, or none was found when the parts of the whole call were used up.
  bool find(const List<Piece>& pieces, TrianglePoint& point) noexcept;

  [[nodiscard]] bool failed() const noexcept { return parts_.failed(); }

 private:
  /// How many parts may be searched in a call, and how many more for each triangle of the target. A real car with bad
  /// borders needs 300 per triangle; scenes that are made for it would need millions.
  static constexpr std::size_t kBaseParts = 8192;
  static constexpr std::size_t kPartsPerTriangle = 256;

  /// A part of a piece that has to be searched.
  struct Part {
    TrianglePoint corners[3];
    std::uint32_t piece;
    NearbyTriangles nearby;
  };

  void addPart(const Piece& piece, Part part) noexcept;
  [[nodiscard]] bool isSurelyInRegion(const Piece& piece, Part& part, Hull core) noexcept;
  [[nodiscard]] std::uint32_t clipToCore(const Piece& piece, const Part& part,
                                         Vec3 (&core)[BorderClassifier::kMaxCorners]) const noexcept;

  TargetTriangle& triangle_;
  List<Part> parts_;
  std::size_t left_;  ///< How many parts may still be searched.
};

}  // namespace cagecast
