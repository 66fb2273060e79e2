#pragma once

#include "base/list.hpp"
#include "clip/target_triangle.hpp"

namespace cagecast {

/// A triangle that was cut out of a target triangle.
struct Piece {
  TrianglePoint corners[3];
  std::uint32_t region;  ///< That it lies in.
};

/// Makes triangles of polygons that lie in one region each.
class PieceBuilder {
 public:
  explicit PieceBuilder(TargetTriangle& triangle) noexcept : triangle_(triangle) {}

  /// Begins a polygon.
  void startPolygon() noexcept { polygon_.truncate(0); }
  /// Adds a corner to the polygon, unless it is the same vertex as the one before or the first one.
  void addCorner(const TrianglePoint& point) noexcept;
  /// Triangulates the polygon.
  void finishPolygon(std::uint32_t region) noexcept;
  /// Adds a triangle.
  void add(const TrianglePoint (&corners)[3], std::uint32_t region) noexcept;

  /// The triangles that were added since `forget`.
  [[nodiscard]] const List<Piece>& pieces() const noexcept { return pieces_; }
  void forget() noexcept { pieces_.truncate(0); }

  [[nodiscard]] bool failed() const noexcept { return polygon_.failed() || pieces_.failed(); }

 private:
  [[nodiscard]] std::size_t findEar() const noexcept;
  [[nodiscard]] bool isEar(std::size_t i) const noexcept;

  TargetTriangle& triangle_;
  List<TrianglePoint> polygon_;
  List<Piece> pieces_;
};

}  // namespace cagecast
