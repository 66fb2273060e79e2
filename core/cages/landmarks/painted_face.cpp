#include "landmarks/painted_face.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <map>
#include <numeric>

#include "landmarks/landmark_list.hpp"
#include "views/base_color.hpp"

/// Faces that are only painted. Skin is one of the commonest colours of a head; what differs from it and is surrounded
/// by it are features: eyes, brows, lips. Which of them are which follows from their places and shapes.
namespace cagecast::cages {

namespace {

// Lengths are shares of the frame's unit, which is about the diagonal of head and neck.
constexpr double kPortraitStep = 0.006;
constexpr double kHalfWidth = 0.45, kBelow = 0.6, kAbove = 0.35;  ///< Of what is looked at, about the eyes.
constexpr double kRaysFrom = 0.8;

/// How far a colour has to differ from skin, in units of CIELAB: little for faint lips, much where shadows are painted.
constexpr double kLevels[] = {6, 10, 16, 25, 40};

/// A head seen from the front.
struct Portrait {
  HeadFrame frame;
  HeightMap map;             ///< Its columns mirror each other.
  std::vector<Vec3> colors;  ///< CIELAB per place, as `baseColorAt` has them.

  [[nodiscard]] bool has(const Place& place) const { return std::isfinite(map.at(place)); }
  /// The point of the surface that is seen at a place; at the height of another one where nothing is seen.
  [[nodiscard]] Vec3 pointAt(double x, double y, double otherHeight) const {
    const double height = map.near(x, y);
    return {x, y, std::isfinite(height) ? height : otherHeight};
  }
};

/// Looks at a figure without hair that has a name. What is transparent is not there.
Portrait portraitOf(const Figure& figure, const Model& model, const HeadFrame& frame) {
  constexpr double kReach = 1.0;  ///< Of the head.
  constexpr int kLayers = 4;      ///< That are transparent, at most.
  Portrait out{frame, {}, {}};
  const Grid grid = Grid::over(-kHalfWidth, kHalfWidth, -kBelow, kAbove, kPortraitStep);
  std::vector<bool> keep;
  std::vector<std::uint32_t> ofModel;
  for (std::size_t t = 0; t < figure.roles.size(); ++t) {
    const Triangle3& corners = figure.mesh.triangles[t];
    keep.push_back(figure.roles[t] != Role::cover && std::any_of(corners.begin(), corners.end(), [&](std::uint32_t v) {
                     return length(figure.mesh.positions[v] - frame.origin) < kReach * frame.unit;
                   }));
    if (keep.back()) ofModel.push_back(figure.triangleOf[t]);
  }
  if (ofModel.empty()) return out;
  const Surface surface(frame.toLocal(subset(figure.mesh, keep)));
  out.map = heightMapOf(surface, kFrontView, grid, kRaysFrom);
  out.colors.resize(out.map.heights.size());
  for (int row = 0; row < grid.rows; ++row)
    for (int column = 0; column < grid.columns; ++column) {
      const std::size_t at = out.map.index(column, row);
      double& height = out.map.heights[at];
      std::optional<Vec3> color;
      for (int layer = 0; layer < kLayers && std::isfinite(height) && !color; ++layer) {
        const Vec3 point = kFrontView.point(grid.a(column), grid.b(row), height);
        color = baseColorAt(model, ofModel[out.map.triangles[at]], frame.toModel(point));
        if (color) break;
        const SurfaceRay ray{point - 1e-4 * kFrontView.toward, -1 * kFrontView.toward};
        const RayHit hit = surface.trace({&ray, 1})[0];
        height = ray.origin.z - hit.distance;
        out.map.triangles[at] = hit.triangle;
      }
      if (color)
        out.colors[at] = *color;
      else
        height = HeightMap::kNone;
    }
  return out;
}

/// The commonest colours of a portrait, each with all that are about like it.
std::vector<Vec3> commonColors(const Portrait& portrait) {
  constexpr double kBin = 8, kSameColor = 14;
  constexpr double kCommon = 0.04;  ///< Of all places.
  constexpr std::size_t kMax = 4;
  std::vector<Vec3> left;
  for (std::size_t i = 0; i < portrait.colors.size(); ++i)
    if (std::isfinite(portrait.map.heights[i])) left.push_back(portrait.colors[i]);
  const double enough = kCommon * static_cast<double>(left.size());
  std::vector<Vec3> out;
  while (!left.empty() && out.size() < kMax) {
    std::map<std::array<int, 3>, std::vector<Vec3>> bins;
    const auto binOf = [](double x) { return static_cast<int>(std::floor(x / kBin)); };
    for (const Vec3& color : left) bins[{binOf(color.x), binOf(color.y), binOf(color.z)}].push_back(color);
    const auto fullest = std::max_element(
        bins.begin(), bins.end(), [](const auto& a, const auto& b) { return a.second.size() < b.second.size(); });
    Vec3 middle = meanOf(fullest->second);
    std::vector<Vec3> alike, others;
    for (int round = 0; round < 3; ++round) {
      alike.clear();
      others.clear();
      for (const Vec3& color : left) (length(color - middle) < kSameColor ? alike : others).push_back(color);
      if (alike.empty()) return out;
      middle = meanOf(alike);
    }
    if (static_cast<double>(alike.size()) < enough) break;
    out.push_back(middle);
    left = std::move(others);
  }
  return out;
}

/// A connected area of a portrait that differs from skin.
struct Spotted {
  double x = 0, y = 0;                            ///< Its middle.
  double left = 0, right = 0, low = 0, high = 0;  ///< Where it ends.
  double leftY = 0, rightY = 0;                   ///< The height of its two ends.
  double middleY = 0;                             ///< Its height on the midline, if it is there; else of its middle.
  double area = 0;
  double contrast = 0;       ///< How far its mean colour is from skin.
  double variety = 0;        ///< How far its colours are from their mean.
  double redness = 0;        ///< Beyond that of skin.
  bool isSurrounded = true;  ///< Whether it ends within the head.

  [[nodiscard]] double width() const { return right - left; }
  [[nodiscard]] double height() const { return high - low; }
};

/// How far a colour is from skin. Shadows and light that are painted in, which change all of a colour alike, count
/// less.
double distanceTo(const Vec3& skin, const Vec3& color) {
  constexpr double kBlack = 16;  ///< Colours of one hue and any light meet at this lightness below 0.
  constexpr double kDarkest = 0.6, kBrightest = 1.25, kShade = 0.3;
  const Vec3 from{skin.x + kBlack, skin.y, skin.z}, to{color.x + kBlack, color.y, color.z};
  const double shade = std::clamp(dot(to, from) / dot(from, from), kDarkest, kBrightest);
  return length(to - shade * from) + kShade * std::abs(1 - shade) * length(from);
}

/// The shape and colours of an area.
Spotted describeArea(const Portrait& portrait, const std::vector<Place>& area, const Vec3& skin) {
  const Grid& grid = portrait.map.grid;
  Spotted out;
  const auto count = static_cast<double>(area.size());
  out.area = count * grid.step * grid.step;
  Place low = area[0], high = area[0];
  Vec3 mean{0, 0, 0};
  for (const Place& place : area) {
    out.x += grid.a(place.column) / count;
    out.y += grid.b(place.row) / count;
    low = {std::min(low.column, place.column), std::min(low.row, place.row)};
    high = {std::max(high.column, place.column), std::max(high.row, place.row)};
    mean = mean + 1 / count * portrait.colors[portrait.map.index(place.column, place.row)];
    for (const Place& step : {Place{1, 0}, {-1, 0}, {0, 1}, {0, -1}})
      out.isSurrounded = out.isSurrounded && portrait.has({place.column + step.column, place.row + step.row});
  }
  for (const Place& place : area)
    out.variety += length(portrait.colors[portrait.map.index(place.column, place.row)] - mean) / count;
  out.contrast = distanceTo(skin, mean);
  out.redness = mean.y - skin.y;
  const double half = 0.5 * grid.step;
  out.left = grid.a(low.column) - half;
  out.right = grid.a(high.column) + half;
  out.low = grid.b(low.row) - half;
  out.high = grid.b(high.row) + half;
  const auto heightWhere = [&](const auto& isThere) {
    double sum = 0, places = 0;
    for (const Place& place : area)
      if (isThere(place)) {
        sum += grid.b(place.row);
        ++places;
      }
    return places > 0 ? sum / places : out.y;
  };
  out.leftY = heightWhere([&](const Place& place) { return place.column == low.column; });
  out.rightY = heightWhere([&](const Place& place) { return place.column == high.column; });
  out.middleY = heightWhere([&](const Place& place) { return 2 * std::abs(place.column) == grid.columns - 1; });
  return out;
}

/// The areas of a portrait that differ from skin and are no larger than features are.
std::vector<Spotted> areasOf(const Portrait& portrait, const Vec3& skin, double level) {
  constexpr std::size_t kSmallest = 3;  ///< Places.
  constexpr double kLargest = 0.3;      ///< Across.
  const HeightMap& map = portrait.map;
  std::vector<bool> isOpen(map.heights.size());
  for (std::size_t i = 0; i < isOpen.size(); ++i)
    isOpen[i] = std::isfinite(map.heights[i]) && distanceTo(skin, portrait.colors[i]) > level;
  std::vector<Spotted> out;
  for (int row = 0; row < map.grid.rows; ++row)
    for (int column = 0; column < map.grid.columns; ++column) {
      if (!isOpen[map.index(column, row)]) continue;
      std::vector<Place> area = {{column, row}};
      isOpen[map.index(column, row)] = false;
      for (std::size_t i = 0; i < area.size(); ++i)
        for (const Place& step : {Place{1, 0}, {-1, 0}, {0, 1}, {0, -1}}) {
          const Place next{area[i].column + step.column, area[i].row + step.row};
          if (!map.grid.has(next.column, next.row) || !isOpen[map.index(next.column, next.row)]) continue;
          isOpen[map.index(next.column, next.row)] = false;
          area.push_back(next);
        }
      if (area.size() < kSmallest ||
          static_cast<double>(area.size()) > kLargest * kLargest / (kPortraitStep * kPortraitStep))
        continue;
      const Spotted found = describeArea(portrait, area, skin);
      if (std::max(found.width(), found.height()) < kLargest) out.push_back(found);
    }
  return out;
}

/// How plausible a measure is: 0 up to `none`, 1 from `full` on, or the other way round.
double ramp(double value, double none, double full) { return std::clamp((value - none) / (full - none), 0.0, 1.0); }

/// Two areas that mirror each other.
struct Pair {
  Spotted left, right;
  double score = 0;

  [[nodiscard]] double apart() const { return left.x - right.x; }
  [[nodiscard]] double y() const { return 0.5 * (left.y + right.y); }
  [[nodiscard]] double width() const { return 0.5 * (left.width() + right.width()); }
  [[nodiscard]] double height() const { return 0.5 * (left.height() + right.height()); }
  [[nodiscard]] double contrast() const { return 0.5 * (left.contrast + right.contrast); }
};

/// How much two areas are like eyes, by themselves: 0..1.
double likeEyes(const Pair& pair) {
  constexpr double kApart = 0.16;  ///< Of most eyes.
  const double apart = pair.apart() / kApart, share = pair.width() / pair.apart();
  const double aspect = pair.height() / pair.width();
  const double fill = (pair.left.area + pair.right.area) / (2 * pair.width() * pair.height());
  const double variety = 0.5 * (pair.left.variety + pair.right.variety);
  return ramp(apart, 0.35, 0.6) * ramp(apart, 2.8, 1.9) * ramp(share, 0.06, 0.15) * ramp(share, 1.05, 0.85) *
         ramp(aspect, 0.06, 0.22) * ramp(aspect, 3.5, 2.2) * ramp(fill, 0.2, 0.45) * ramp(pair.contrast(), 5, 18) *
         (0.7 + 0.3 * ramp(variety, 0, 20));
}

/// How much two areas mirror each other: 0..1.
double likeMirrors(const Spotted& left, const Spotted& right) {
  const double size = std::max({left.width(), left.height(), right.width(), right.height()});
  const double off = std::hypot(left.x + right.x, left.y - right.y) / size;
  const double more = std::max(left.area, right.area) / std::min(left.area, right.area);
  const double sizes = std::hypot(left.width() - right.width(), left.height() - right.height()) / size;
  return ramp(off, 0.6, 0.15) * ramp(more, 2.2, 1.3) * ramp(sizes, 0.6, 0.2);
}

/// The pairs among the areas of one level, and how much each is like eyes: brows are flat, and above eyes.
std::vector<Pair> pairsOf(const std::vector<Spotted>& areas) {
  constexpr double kMiddle = 0.02;  ///< Nearer to the midline is no eye.
  constexpr double kBrow = 0.35, kUnderBrow = 1.2;
  std::vector<Pair> out;
  for (const Spotted& left : areas)
    for (const Spotted& right : areas) {
      if (!left.isSurrounded || !right.isSurrounded || left.x < kMiddle || right.x > -kMiddle) continue;
      const Pair pair{left, right, likeMirrors(left, right)};
      if (pair.score > 0) out.push_back(pair);
    }
  std::vector<double> scores;
  for (const Pair& pair : out) {
    double score = pair.score * likeEyes(pair);
    const auto isOver = [](const Pair& a, const Pair& b) {
      const double above = a.y() - b.y();
      return above > 0.3 * b.height() && above < 0.8 * b.apart() && a.height() < 1.2 * b.height() &&
             std::abs(a.left.x - b.left.x) < 0.5 * std::max(a.width(), b.width()) && b.contrast() > 0.6 * a.contrast();
    };
    for (const Pair& other : out) {
      if (isOver(pair, other) && likeEyes(other) > 0.5 * likeEyes(pair)) score *= kBrow;
      if (isOver(other, pair)) score = std::min(1.0, kUnderBrow * score);
    }
    scores.push_back(score);
  }
  for (std::size_t i = 0; i < out.size(); ++i) out[i].score = scores[i];
  return out;
}

/// How much an area is like the mouth below two eyes: 0..1.
double likeMouth(const Spotted& area, double apart, double eyesY) {
  if (!area.isSurrounded) return 0;
  const double below = (eyesY - area.y) / apart, wide = area.width() / apart;
  if (below < 0.25) return 0;
  const double where = std::log(below / 0.95) / 0.5;
  const double aside = std::abs(0.5 * (area.left + area.right));
  return std::exp(-where * where) * ramp(wide, 0.12, 0.4) * ramp(wide, 1.9, 1.4) *
         ramp(area.height() / area.width(), 1.4, 0.8) * ramp(area.contrast, 3, 10) *
         ramp(aside, 0.3 * apart, 0.1 * apart) * (0.85 + 0.15 * ramp(area.redness, 0, 8));
}

/// Areas that are like eyes, or may be a mouth.
struct Features {
  std::vector<Pair> eyes;
  std::vector<Spotted> others;
};

Features featuresOf(const Portrait& portrait) {
  constexpr double kLikely = 0.2;
  Features out;
  for (const Vec3& skin : commonColors(portrait))
    for (const double level : kLevels) {
      const std::vector<Spotted> areas = areasOf(portrait, skin, level);
      for (const Pair& pair : pairsOf(areas))
        if (pair.score > kLikely) out.eyes.push_back(pair);
      out.others.insert(out.others.end(), areas.begin(), areas.end());
    }
  return out;
}

/// The most plausible mouth among areas; null if there is none.
const Spotted* mouthOf(const std::vector<Spotted>& areas, double apart, double eyesY, double& score) {
  const Spotted* best = nullptr;
  score = 0;
  for (const Spotted& area : areas) {
    const double here = likeMouth(area, apart, eyesY);
    if (here <= score) continue;
    score = here;
    best = &area;
  }
  return best;
}

void addLandmark(const Portrait& portrait, const char* name, const Vec3& place, std::vector<Landmark>& out) {
  out.push_back({name, toPosition(portrait.frame.toModel(place)), 1});
}

void addMouth(const Portrait& portrait, const Spotted& area, std::vector<Landmark>& out) {
  const double height = portrait.map.near(area.x, area.y);
  const auto at = [&](double x, double y) { return portrait.pointAt(x, y, height); };
  addLandmark(portrait, "mouth", at(0, area.middleY), out);
  constexpr double kLip = 0.375;  ///< From the middle to what is called a lip, as a share of both.
  addLandmark(portrait, "lip_upper", at(0, area.middleY + kLip * area.height()), out);
  addLandmark(portrait, "lip_lower", at(0, area.middleY - kLip * area.height()), out);
  addLandmark(portrait, "mouth_corner_left", at(area.right - kPortraitStep, area.rightY), out);
  addLandmark(portrait, "mouth_corner_right", at(area.left + kPortraitStep, area.leftY), out);
}

/// The eyes, behind what is painted, and the corners of their lids.
void addEyes(const Portrait& portrait, const Pair& pair, PaintedFace& out) {
  constexpr double kRadius = 0.55;  ///< Of an eyeball, as a share of the distance of the corners of its lids.
  constexpr double kLargest = 0.3;  ///< As a share of the distance of the eyes.
  const double y = pair.y();
  const double radius = std::min(kRadius * pair.width(), kLargest * pair.apart());
  out.eyes.left = portrait.frame.left;
  out.eyes.front = portrait.frame.front;
  out.eyes.radius = radius * portrait.frame.unit;
  for (const std::size_t side : {std::size_t{0}, std::size_t{1}}) {
    const Spotted& area = side == 0 ? pair.left : pair.right;
    const double sign = side == 0 ? 1 : -1;
    Vec3 middle = portrait.pointAt(sign * 0.5 * pair.apart(), y, 0);
    const Vec3 inner = portrait.pointAt(side == 0 ? area.left : area.right, y, middle.z);
    const Vec3 outer = portrait.pointAt(side == 0 ? area.right : area.left, y, middle.z);
    middle.z = std::max(middle.z, std::midpoint(inner.z, outer.z));  // A socket without its eye is hollow.
    out.eyes.centres[side] = portrait.frame.toModel(middle - radius * kFrontView.toward);
    addLandmark(portrait, side == 0 ? "eye_inner_left" : "eye_inner_right", inner, out.landmarks);
    addLandmark(portrait, side == 0 ? "eye_outer_left" : "eye_outer_right", outer, out.landmarks);
  }
}

}  // namespace

std::optional<PaintedFace> findPaintedFace(const Figure& figure, const Model& model, const MirrorPlane& plane) {
  constexpr double kClear = 0.4;          ///< Eyes and mouth together.
  constexpr double kWithoutMouth = 0.45;  ///< What eyes alone count,
  constexpr double kOnBones = 0.65;       ///< and where bones say what is a head, and where its front is.
  constexpr double kLikely = 1.1;         ///< Files face +z, unless something else is clearly seen.
  if (model.baseColors.empty()) return std::nullopt;
  const TriangleMesh skin = figure.only(Role::surface);
  const double withoutMouth = figure.front ? kOnBones : kWithoutMouth;
  std::optional<PaintedFace> best;
  for (const double side : {1.0, -1.0}) {
    const HeadFrame frame = guessHeadFrame(skin, plane, side);
    if (figure.front && dot(frame.front, *figure.front) < 0) continue;
    const Portrait portrait = portraitOf(figure, model, frame);
    if (portrait.colors.empty()) continue;
    const Features features = featuresOf(portrait);
    for (const Pair& pair : features.eyes) {
      double likely = 0;
      const Spotted* mouth = mouthOf(features.others, pair.apart(), pair.y(), likely);
      const double score = pair.score * (withoutMouth + (1 - withoutMouth) * likely);
      const double preferred = frame.front.z > 0.7 ? kLikely * score : score;
      if (preferred <= (best ? best->score : kClear)) continue;
      best.emplace();
      best->score = preferred;
      addEyes(portrait, pair, *best);
      if (mouth != nullptr && likely > 0.3) addMouth(portrait, *mouth, best->landmarks);
      best->eyes.confidence = std::clamp(score, 0.5, 0.8);
      best->eyes.isNamed = true;  // What is painted is an eye at any distance.
    }
  }
  return best;
}

std::vector<Landmark> findPaintedMouth(const Figure& figure, const Model& model, const Head& head) {
  constexpr double kClear = 0.5;
  std::vector<Landmark> out;
  if (model.baseColors.empty()) return out;
  const Portrait portrait = portraitOf(figure, model, head.frame);
  if (portrait.colors.empty()) return out;
  const double apart = length(head.eyes.centres[0] - head.eyes.centres[1]);
  double score = 0;
  std::vector<Spotted> areas;
  for (const Vec3& skin : commonColors(portrait))
    for (const double level : kLevels)
      for (const Spotted& area : areasOf(portrait, skin, level)) areas.push_back(area);
  const Spotted* mouth = mouthOf(areas, apart, 0, score);
  if (mouth != nullptr && score > kClear) addMouth(portrait, *mouth, out);
  return out;
}

}  // namespace cagecast::cages
