#pragma once

#include "base/list.hpp"
#include "clip/target_triangle.hpp"

namespace cagecast {

/// Makes the pieces of a target triangle fewer: removes vertices inside it that no border needs.
///
/// A vertex is removed by moving it to a neighbour, which takes the triangles between the two away. It may go if all
/// triangles around it are in one region, or if it lies between two regions and the border is straight there. No
/// triangle gets thinner than the thinnest around the vertex was.
class PieceMerger {
 public:
  explicit PieceMerger(TargetTriangle& triangle) noexcept : triangle_(triangle) {}

  /// Begins a target triangle. What is added from now on may be removed again.
  void start() noexcept;
  /// Keeps a vertex, for a border that the regions beside it do not show.
  void keep(std::uint32_t vertex) noexcept { kept_.add(vertex); }
  /// How many vertices are kept now.
  [[nodiscard]] std::size_t mark() const noexcept { return kept_.size(); }
  /// Forgets what was kept after a call of `mark`.
  void rewind(std::size_t mark) noexcept { kept_.truncate(mark); }
  /// Removes what is not needed of what was added since `start`.
  void merge() noexcept;

  [[nodiscard]] bool failed() const noexcept {
    return kept_.failed() || vertices_.failed() || nextCorners_.failed() || around_.failed();
  }

 private:
  /// The most triangles around a vertex that is removed.
  static constexpr std::size_t kMaxAround = 16;
  /// How often all vertices are tried: those around one that was removed may be removable then.
  static constexpr int kMaxRounds = 6;
  static constexpr std::uint32_t kNoCorner = UINT32_MAX;

  /// A vertex inside the target triangle.
  struct Inside {
    std::uint32_t firstCorner;  ///< Of triangles that have it, a list by `nextCorners_`.
    bool stays;
    bool isGone;
    double moved;          ///< How far the border beside it was moved, at most.
    std::uint32_t number;  ///< Of the vertex, once all that go are gone.
  };
  /// A triangle around a vertex: the edge opposite of it, counterclockwise.
  struct Around {
    std::size_t triangle;
    std::uint32_t from, to;
  };

  [[nodiscard]] bool isInside(std::uint32_t vertex) const noexcept { return vertex >= firstVertex_; }
  [[nodiscard]] TrianglePoint pointOf(std::uint32_t vertex) const noexcept;
  [[nodiscard]] double height(std::uint32_t a, std::uint32_t b, std::uint32_t c) const noexcept;
  [[nodiscard]] bool listAround(std::uint32_t vertex) noexcept;
  [[nodiscard]] bool mayMove(std::uint32_t vertex, std::uint32_t to, double& thinnest) const noexcept;
  std::uint32_t findNeighbour(std::uint32_t vertex) noexcept;
  void move(std::uint32_t vertex, std::uint32_t to) noexcept;
  void closeGaps() noexcept;

  TargetTriangle& triangle_;
  std::uint32_t firstVertex_ = 0;
  std::size_t firstTriangle_ = 0;
  List<std::uint32_t> kept_;
  List<Inside> vertices_;
  List<std::uint32_t> nextCorners_;  ///< 1 per corner of the triangles.
  List<Around> around_;              ///< The vertex that is tried.
};

}  // namespace cagecast
