#pragma once

#include "base/list.hpp"
#include "clip/piece_builder.hpp"

namespace cagecast {

/// Finds regions that lie inside a piece without reaching its edges: no crossing on an edge tells of them.
class EnclosedSearch {
 public:
  explicit EnclosedSearch(TargetTriangle& triangle) noexcept : triangle_(triangle) {}

  /// Begins with another triangle of the target, for whose pieces together `kMaxParts` parts may be searched.
  void begin() noexcept { left_ = kMaxParts; }

  /// Finds a point well inside one of some pieces that is not in the region of that piece.
  /// Cost: a piece is quartered until its parts surely lie in one region or are as small as the features that may be
  /// missed. Where neither is provable, that is some thousand parts for a large piece.
  /// @return false if there is none, or none was found when the parts of the triangle were used up.
  bool find(const List<Piece>& pieces, TrianglePoint& point) noexcept;

  [[nodiscard]] bool failed() const noexcept { return parts_.failed(); }

 private:
  /// Some triangles of real models need 50,000.
  static constexpr std::uint32_t kMaxParts = 1u << 16;

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
  std::uint32_t left_ = 0;  ///< How many parts may still be searched.
};

}  // namespace cagecast
