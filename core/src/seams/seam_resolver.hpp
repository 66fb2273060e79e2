#pragma once

#include <cstdint>

#include "seams/chart_flood.hpp"
#include "steps/point_data.hpp"

namespace cagecast {

/// Gives target triangles that lie across a seam UVs of their own: step 12. Works on a batch of triangles at a time.
class SeamResolver {
 public:
  /// Allocates its working memory; check `scene.arena.failed()` afterwards.
  SeamResolver(const Scene& scene, const UvCharts& charts) noexcept;

  /// Queues a triangle if a seam separates its corners. Its UVs are written at the latest by `finish`.
  /// @param triangle   3 points.
  /// @param[out] uvs   6 floats.
  void add(const PointData& data, const std::uint32_t* triangle, float* uvs) noexcept;

  /// Writes the UVs of all queued triangles.
  void finish() noexcept;

 private:
  static constexpr std::uint32_t kMaxTriangles = ChartFlood::kBatch;
  /// Triangles mostly share corners. Those of triangles that turn out not to lie across a seam take room too.
  static constexpr std::uint32_t kMaxCorners = 2 * kMaxTriangles;
  /// Size of the table that finds the corner of a point, by the last bits of the point's number.
  static constexpr std::uint32_t kRecent = 4096;

  /// A triangle across a seam.
  struct Queued {
    Corner* corners[3];
    float* uvs;
    ChartPatch* patches[3];  ///< Around each corner's closest point; null if an earlier one lies on the same triangle.
    std::uint8_t inGroup[3][3];  ///< For each patch, the corners' numbers among the points of its group.
  };
  /// The corners projected onto one patch.
  struct Projected {
    double sum;  ///< Of the distances.
    float uvs[6];
  };

  void addPatches(Queued& queued) noexcept;
  void choose(const Queued& queued) noexcept;
  void projectOnto(const Queued& queued, int k, Projected& out) noexcept;
  const Candidate& closestOnPatch(const Corner& corner, const ChartPatch& patch, std::uint32_t inGroup) noexcept;
  void setCorner(Corner& corner, std::uint32_t point, const float* position, std::uint32_t cageTriangle) const noexcept;
  [[nodiscard]] bool isAcrossSeam(const Corner* const (&corners)[3]) const noexcept;

  const Cage& cage_;
  const CageTree& tree_;
  const UvCharts& charts_;
  double diagonal_;
  ChartFlood flood_;
  Candidate* candidates_;  ///< Room for those of one corner.
  Corner* corners_;
  std::uint32_t* recent_;
  Queued* queue_;
  std::uint32_t cornerCount_ = 0, queuedCount_ = 0;
};

}  // namespace cagecast
