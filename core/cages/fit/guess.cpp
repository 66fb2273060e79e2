#include <algorithm>
#include <cmath>
#include <limits>
#include <numeric>

#include "fit/steps.hpp"
#include "landmarks/frame.hpp"
#include "landmarks/parts.hpp"
#include "views/height_map.hpp"

/// Where a template's landmarks would be if the model were the template's, stretched to the same size: for models that
/// too little is known of.
namespace cagecast::cages {

namespace {

constexpr float kGuessed = 0.25f;       ///< Confidence.
constexpr double kProfileStep = 0.004;  ///< In diagonals.

/// A model or a template in a space of its own, whose axes are its left, up and front; lengths in diagonals.
struct Upright {
  HeadFrame frame;
  TriangleMesh mesh;
  Bounds box;  ///< Of a head, from the chin up; else of all.

  Upright(const TriangleMesh& source, const Vec3& left, const Vec3& middle) {
    frame.left = left;
    frame.front = cross(left, frame.up);
    frame.origin = middle;
    frame.unit = diagonalOf(source);
    mesh = frame.toLocal(source);
    for (const Vec3& p : mesh.positions) box.add(p);
  }

  /// Leaves out what is below a head.
  void cutBelow(double chin) {
    box = {};
    for (const Vec3& p : mesh.positions)
      if (p.y >= chin) box.add(p);
    box.low.y = chin;
  }
};

/// How a figure looks from the front, by rows from its top down.
struct Silhouette {
  HeightMap map;
  std::vector<int> widths;     ///< Connected to the middle, in steps; from the first row that is hit.
  std::vector<double> fronts;  ///< How far the middle is in front.
  int top = 0;                 ///< The row of the first.

  explicit Silhouette(const Upright& figure) {
    const Bounds& box = figure.box;
    const Grid grid = Grid::over(box.low.x, box.high.x, box.low.y, box.high.y, kProfileStep);
    map = heightMapOf(Surface(figure.mesh), kFrontView, grid, 2);
    const int middle = grid.columnOf(0);
    for (int row = grid.rows - 1; row >= 0; --row) {
      const auto isHit = [&](int column) { return std::isfinite(map.at(column, row)); };
      if (!isHit(middle)) {
        if (widths.empty()) continue;
        break;
      }
      if (widths.empty()) top = row;
      int left = middle, right = middle;
      while (isHit(right + 1)) ++right;
      while (isHit(left - 1)) --left;
      widths.push_back(right - left + 1);
      fronts.push_back(map.at(middle, row));
    }
  }
};

/// Where a head's chin is: a neck is narrower than what is above it, and the front falls back there from the face;
/// without a neck, shoulders are wider. A head alone ends where it ends.
/// @param eyes  The height of its eyes, if it is known.
double chinOf(const Upright& figure, const std::optional<double>& eyes) {
  constexpr double kNarrower = 0.75, kWider = 1.25;
  constexpr double kShortest = 0.6;   ///< Heads are at least this high, in widths of theirs.
  constexpr double kFallen = 0.85;    ///< Of the way from the face to the neck.
  constexpr std::size_t kSudden = 5;  ///< Rows.
  const Silhouette seen(figure);
  const std::vector<int>& widths = seen.widths;
  const auto heightAt = [&](std::size_t i) { return seen.map.grid.b(seen.top - static_cast<int>(i)); };
  int widest = 0;
  std::size_t i = 0;
  for (; i < widths.size(); ++i) {
    const bool mayEnd = i > kSudden && (eyes ? heightAt(i) < *eyes : static_cast<double>(i) > kShortest * widest);
    if (mayEnd && widths[i] < kNarrower * widest) break;
    if (mayEnd && widths[i] > kWider * widest && widths[i] > kWider * widths[i - kSudden]) {
      while (i > kSudden && widths[i] > kWider * widths[i - kSudden]) --i;
      return heightAt(i);
    }
    widest = std::max(widest, widths[i]);
  }
  if (i == widths.size()) return figure.box.low.y;
  std::size_t neck = i;
  for (; i < widths.size() && widths[i] < kWider * widths[neck]; ++i)
    if (widths[i] < widths[neck]) neck = i;
  const auto begin = seen.fronts.begin();
  const double face = *std::max_element(begin, begin + static_cast<std::ptrdiff_t>(neck));
  const double throat =
      *std::min_element(begin + static_cast<std::ptrdiff_t>(neck), begin + static_cast<std::ptrdiff_t>(i));
  const double level = face + kFallen * (throat - face);
  std::size_t chin = i - 1;
  while (chin > 0 && seen.fronts[chin] < level) --chin;
  return heightAt(chin);
}

/// A height that two models have in common.
struct Level {
  double from, to;
};

/// What is between two levels is between them there, too.
double between(const std::vector<Level>& levels, double y) {
  std::size_t i = 1;
  while (i + 1 < levels.size() && y > levels[i].from) ++i;
  const Level &a = levels[i - 1], &b = levels[i];
  return b.from > a.from ? a.to + (b.to - a.to) * (y - a.from) / (b.from - a.from) : a.to;
}

/// Stretches the template to the size of a model.
class Stretch {
 public:
  Stretch(const Upright& from, const Upright& to, std::vector<Level> known) : from_(from.box), to_(to.box) {
    std::sort(known.begin(), known.end(), [](const Level& a, const Level& b) { return a.from < b.from; });
    levels_ = {{from_.low.y, to_.low.y}};
    const Level top{from_.high.y, to_.high.y};
    const auto isAbove = [&](const Level& a, const Level& b) {
      constexpr double kApart = 0.05;  ///< Of the height: two eyes are at one level.
      return a.from - b.from > kApart * from_.size().y && a.to - b.to > kApart * to_.size().y;
    };
    for (const Level& level : known)
      if (isAbove(level, levels_.back()) && isAbove(top, level)) levels_.push_back(level);
    levels_.push_back(top);
  }

  [[nodiscard]] Vec3 operator()(const Vec3& p) const {
    const Vec3 size = from_.size(), wanted = to_.size();
    const auto along = [](double value, double low, double length, double toLow, double toLength) {
      return length > 0 ? toLow + toLength * (value - low) / length : toLow;
    };
    return {along(p.x, from_.low.x, size.x, to_.low.x, wanted.x), between(levels_, p.y),
            along(p.z, from_.low.z, size.z, to_.low.z, wanted.z)};
  }

 private:
  Bounds from_, to_;
  std::vector<Level> levels_;
};

/// The planes that may mirror a model, with a normal to its left.
/// @param left  If it is known.
std::vector<MirrorPlane> likelyPlanes(const TriangleMesh& skin, const std::optional<Vec3>& left) {
  if (left) return {{*left, dot(*left, boundsOf(skin).middle())}};
  std::vector<MirrorPlane> out;
  for (const MirrorPlane& plane : findMirrorPlanes(skin))
    for (const double side : {1.0, -1.0}) out.push_back({side * plane.left, side * plane.offset, plane.residual});
  return out;
}

}  // namespace

bool isHead(const Template& from) {
  return placeOf(from.landmarks, "chin").has_value() && !placeOf(from.landmarks, "hip_left") &&
         !placeOf(from.landmarks, "joint_hips");
}

std::vector<Landmark> guessLandmarks(const Template& from, const TemplateCage& cage, const Model& model,
                                     const std::vector<Landmark>& known) {
  const bool isFace = isHead(from);
  const Figure all = readFigure(model);
  const TriangleMesh skin = (isFace ? headOf(all, model) : all).only(Role::surface);

  Upright own(cage.mesh, leftOf(from.landmarks).value_or(Vec3{1, 0, 0}), boundsOf(cage.mesh).middle());
  if (isFace) {
    const auto menton = placeOf(from.landmarks, "menton");
    own.cutBelow(own.frame.toLocal(menton ? *menton : *placeOf(from.landmarks, "chin")).y);
  }
  const std::optional<Vec3> left = leftOf(known);
  const Surface surface(skin);
  std::vector<Landmark> best;
  double least = std::numeric_limits<double>::infinity();
  // Of the ways that it may face, the one that brings the cage nearest to it.
  for (const MirrorPlane& plane : likelyPlanes(skin, left ? left : leftOf(all.rig.joints))) {
    const Vec3 middle = boundsOf(skin).middle();
    Upright there(skin, plane.left, middle + (plane.offset - dot(plane.left, middle)) * plane.left);
    const auto eye = placeOf(known, "eye_centre_left");
    if (isFace) there.cutBelow(chinOf(there, eye ? std::optional(there.frame.toLocal(*eye).y) : std::nullopt));
    // What is found of a face of which so little is found may be no nose or brow.
    std::vector<Level> levels;
    for (const Landmark& landmark : known)
      if (const auto place = placeOf(from.landmarks, landmark.name);
          place && (landmark.confidence == 1 || landmark.name.starts_with("eye_centre")))
        levels.push_back({own.frame.toLocal(*place).y, there.frame.toLocal(positionOf(landmark)).y});
    const Stretch stretch(own, there, levels);
    const auto placed = [&](const Vec3& p) { return there.frame.toModel(stretch(own.frame.toLocal(p))); };
    double off = 0;
    std::vector<Vec3> points;
    for (const Vec3& p : cage.mesh.positions)
      if (own.frame.toLocal(p).y >= own.box.low.y) points.push_back(placed(p));
    for (const SurfacePoint& point : surface.closest(points)) off += point.distance;
    // Files face +z, unless the shape clearly says something else.
    constexpr double kLikely = 0.9;
    if (there.frame.front.z > 0.7) off *= kLikely;
    if (off >= least) continue;
    least = off;
    best.clear();
    for (const Landmark& landmark : from.landmarks) {
      Vec3 place = placed(positionOf(landmark));
      if (isOnSkin(landmark.name)) place = surface.closest(place).position;
      best.push_back({landmark.name, toPosition(place), kGuessed});
    }
  }
  return best;
}

}  // namespace cagecast::cages
