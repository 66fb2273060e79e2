#include "charts/unwrap.hpp"

#include <algorithm>
#include <cmath>
#include <utility>

#include "charts/slim.hpp"
#include "charts/steps.hpp"

namespace cagecast::cages {

namespace {

/// Charts with more energy than this are cut in two (4: no stretch; 5: stretched by about a quarter each way).
constexpr double kMaxEnergy = 6;
/// Energy that is borne before there are too many charts.
constexpr double kBorneEnergy = 9;
/// Sides of props are joined if the chart has no more energy, …
constexpr double kJoinedEnergy = 4.2;
/// … fills so much of its box, …
constexpr double kMinFill = 0.45;
/// … and is no longer than this, as a share of the square root of the whole area.
constexpr double kLongestChart = 1.25;
/// A head, two arms, two legs.
constexpr std::size_t kMaxLimbs = 5;
/// Those of a spider.
constexpr std::size_t kMaxLegs = 8;
/// Props should not have more charts than this.
constexpr std::size_t kMaxPropCharts = 10;
/// Seams on a head cost this much more in front than at the back.
constexpr double kFrontCost = 12;
/// The neck is a loop at least this share as long as the longest.
constexpr double kMinNeck = 0.5;
/// Seams that are cut to let a chart lie flat, at most.
constexpr int kMaxSeams = 4;
/// A face gets a chart of its own if seams over it would be longer than this, in distances of the eyes.
constexpr double kMaxFaceSeam = 0.25;

/// Where the seam of a head may start: the furthest place in this direction.
struct SeamStart {
  double up, front;
  double reluctance;  ///< Factor on what the chart is stretched.
};
/// The crown, or somewhat behind or before it; and the throat, for heads with a snout.
constexpr SeamStart kSeamStarts[] = {{1, 0, 1}, {1, -0.6, 1}, {1, 0.5, 1.15}, {-1, 0, 1.6}};

/// How far the work is when all pieces are flat, and when they are joined.
constexpr double kFlatShare = 0.6, kJoinedShare = 0.9;

Vec3 centreOf(const TriangleMesh& mesh) {
  Vec3 sum{0, 0, 0};
  double whole = 0;
  for (const Triangle3& t : mesh.triangles) {
    const double area = length(areaNormal(mesh, t));
    whole += area;
    for (const std::uint32_t v : t) sum = sum + area / 3 * mesh.positions[v];
  }
  return whole > 0 ? 1 / whole * sum : Vec3{0, 0, 0};
}

/// The vertex around which a chart is stretched most.
std::uint32_t mostStretched(const Chart& chart) {
  const TriangleMesh& mesh = chart.piece.mesh;
  const RestShapes rest = restShapesOf(mesh);
  std::vector<double> sums(mesh.positions.size()), weights(mesh.positions.size());
  for (std::size_t t = 0; t < mesh.triangles.size(); ++t)
    for (const std::uint32_t v : mesh.triangles[t]) {
      sums[v] += rest.weights[t] * jacobianOf(rest.gradients[t], mesh.triangles[t], chart.uvs).energy();
      weights[v] += rest.weights[t];
    }
  std::uint32_t worst = 0;
  for (std::uint32_t v = 1; v < sums.size(); ++v)
    if (sums[v] * weights[worst] > sums[worst] * weights[v]) worst = v;
  return worst;
}

/// Flattens a piece; where it is stretched too much, seams from there to the boundary help (Gu, Gortler, Hoppe 2002).
/// @param mostEnergy  That the chart may have.
Chart flattenWithSeams(Piece piece, double mostEnergy, Ticker& ticker) {
  Chart chart = flatten(cutToDisk(std::move(piece), {}), ticker);
  for (int i = 0; i < kMaxSeams && chart.valid && chart.energy > mostEnergy; ++i) {
    const std::uint32_t worst = mostStretched(chart);
    const TriangleMesh& mesh = chart.piece.mesh;
    std::vector<std::uint32_t> boundary;
    for (const auto& loop : loopsOf(mesh, halfEdgeTwins(mesh)))
      for (const std::uint32_t h : loop)
        if (originOf(mesh, h) != worst) boundary.push_back(originOf(mesh, h));
    Chart next = flatten(cutToDisk(cutBetween(chart.piece, {&worst, 1}, boundary, {}), {}), ticker);
    if (!next.valid || next.energy > chart.energy) break;
    chart = std::move(next);
  }
  return chart;
}

/// The border of the neck: of the long loops the lowest.
std::vector<std::uint32_t> neckOf(const TriangleMesh& mesh, const Vec3& up) {
  const auto loops = loopsOf(mesh, halfEdgeTwins(mesh));
  std::vector<std::uint32_t> neck;
  double lowest = 0;
  for (const auto& loop : loops) {
    if (lengthOf(mesh, loop) < kMinNeck * lengthOf(mesh, loops[0])) break;
    std::vector<std::uint32_t> vertices = originsOf(mesh, loop);
    const double height = dot(middleOf(mesh, vertices), up);
    if (!neck.empty() && height >= lowest) continue;
    lowest = height;
    neck = std::move(vertices);
  }
  return neck;
}

/// The vertex that is furthest in a direction and near the plane between left and right.
std::uint32_t furthest(const TriangleMesh& mesh, const Vec3& direction, const Vec3& side) {
  const Vec3 centre = centreOf(mesh);
  std::uint32_t best = 0;
  double most = -1e300;
  for (std::uint32_t v = 0; v < mesh.positions.size(); ++v) {
    const Vec3 p = mesh.positions[v] - centre;
    const double value = dot(p, direction) - 2 * std::abs(dot(p, side));
    if (value > most) most = value, best = v;
  }
  return best;
}

/// What all steps share. Functions return false if cancelled.
class Unwrapper {
 public:
  /// @param isFace  Per triangle of the mesh: whether it is in a chart of the face. Empty: there is none.
  Unwrapper(const TriangleMesh& mesh, const UnwrapOptions& options, std::vector<bool> isFace, Ticker& ticker)
      : options_(options),
        isFace_(std::move(isFace)),
        ticker_(ticker),
        whole_(static_cast<double>(mesh.triangles.size())) {}

  std::vector<Chart>& charts() { return charts_; }

  /// Lays out a face by itself, and the rest as a head or a prop.
  bool layOutAs(Kind kind, const Piece& piece) {
    std::vector<std::uint32_t> labels(piece.triangleOf.size(), 0);
    for (std::size_t t = 0; t < labels.size(); ++t) labels[t] = isOfFace(piece, t) ? 1 : 0;
    for (Piece& face : piecesOf(piece, labels, 1))
      if (!layOut(std::move(face), kBorneEnergy)) return false;
    for (Piece& rest : piecesOf(piece, labels, 0))
      if (!(kind == Kind::head ? layOutHead(std::move(rest)) : layOutProp(rest))) return false;
    return true;
  }

  bool layOut(Piece piece, double mostEnergy = kMaxEnergy) {
    std::vector<Piece> waiting;
    waiting.push_back(std::move(piece));
    while (!waiting.empty()) {
      Chart chart = flattenWithSeams(std::move(waiting.back()), mostEnergy, ticker_);
      waiting.pop_back();
      if (ticker_.cancelled()) return false;
      if ((chart.valid && chart.energy < mostEnergy) || chart.piece.mesh.triangles.size() < 2) {
        accept(std::move(chart));
        continue;
      }
      for (Piece& half : splitBy(chart.piece, halvesOf(chart.piece.mesh))) waiting.push_back(std::move(half));
    }
    return true;
  }

  bool layOutHead(Piece piece) {
    const Vec3 up = options_.up, side = cross(up, options_.front);
    std::vector<std::uint32_t> neck = neckOf(piece.mesh, up);
    if (neck.empty()) neck.push_back(furthest(piece.mesh, -1.0 * up, side));
    Chart best;
    double least = 0;
    for (const SeamStart& start : kSeamStarts) {
      const Vec3 direction = start.up * up + start.front * options_.front;
      const std::uint32_t first = furthest(piece.mesh, direction, side);
      // A seam at the throat keeps to the middle only.
      const SeamCost cost = middleCost(piece.mesh, start.up > 0 ? kFrontCost : 0);
      Chart chart = flatten(cutToDisk(cutBetween(piece, {&first, 1}, neck, cost), {}), ticker_);
      if (ticker_.cancelled()) return false;
      const double fault = start.reluctance * (chart.energy - 4);
      if (!chart.valid || (best.valid && fault >= least)) continue;
      best = std::move(chart);
      least = fault;
    }
    if (best.valid && best.energy < kMaxEnergy) {
      accept(std::move(best));
      return true;
    }
    return layOut(best.valid ? std::move(best.piece) : std::move(piece));
  }

  bool layOutBody(const Piece& body, std::size_t mostLimbs) {
    Limbs limbs = limbsOf(body.mesh, mostLimbs);
    if (limbs.tips.size() < 2) return layOutAs(Kind::prop, body);
    const Vec3 centre = centreOf(body.mesh), side = cross(options_.up, options_.front);
    std::uint32_t head = kNone;
    double highest = 0;
    for (std::uint32_t i = 0; i < limbs.tips.size(); ++i) {
      const Vec3 tip = body.mesh.positions[limbs.tips[i]] - centre;
      const double height = dot(tip, options_.up) - 2 * std::abs(dot(tip, side));
      if (height > highest) highest = height, head = i + 1;
    }
    const auto face = static_cast<std::uint32_t>(limbs.tips.size() + 1);
    for (std::size_t t = 0; t < limbs.labels.size(); ++t)
      if (isOfFace(body, t)) limbs.labels[t] = face;
    for (std::uint32_t label = 0; label <= face; ++label) {
      for (Piece& piece : piecesOf(body, limbs.labels, label)) {
        bool going = true;
        if (label == 0) {
          for (Piece& half : splitBy(piece, frontAndBackOf(piece.mesh, options_.front, ticker_)))
            going = going && layOut(std::move(half));
        } else if (label == head) {
          going = layOutHead(std::move(piece));
        } else if (label == face) {
          going = layOut(std::move(piece), kBorneEnergy);
        } else {
          going = layOutLimb(piece, body.vertexOf[limbs.tips[label - 1]], insideCost(body.mesh, piece.mesh));
        }
        if (!going) return false;
      }
    }
    return true;
  }

  bool layOutProp(const Piece& piece) {
    for (Piece& side : splitBy(piece, sidesOf(piece, options_, ticker_)))
      if (!layOut(std::move(side))) return false;
    return true;
  }

 private:
  [[nodiscard]] bool isOfFace(const Piece& piece, std::size_t t) const {
    return !isFace_.empty() && isFace_[piece.triangleOf[t]];
  }

  void accept(Chart chart) {
    done_ += static_cast<double>(chart.piece.triangleOf.size());
    ticker_.reach(kFlatShare * done_ / whole_);
    charts_.push_back(std::move(chart));
  }

  /// Seams keep to the plane between left and right, and away from the front.
  [[nodiscard]] SeamCost middleCost(const TriangleMesh& mesh, double frontCost) const {
    const Vec3 centre = centreOf(mesh), side = cross(options_.up, options_.front), front = options_.front;
    const double size = diagonalOf(mesh);
    return [=](const TriangleMesh& of, std::uint32_t from, std::uint32_t to) {
      const Vec3 middle = 0.5 * (of.positions[from] + of.positions[to]) - centre;
      const double aside = std::abs(dot(middle, side)) / size, ahead = std::max(0.0, dot(middle, front)) / size;
      return 1 + 20 * aside + frontCost * ahead;
    };
  }

  /// Seams on a limb keep to where it faces the body's middle, down and back.
  [[nodiscard]] SeamCost insideCost(const TriangleMesh& body, const TriangleMesh& limb) const {
    const Vec3 side = cross(options_.up, options_.front);
    const double aside = dot(centreOf(limb) - centreOf(body), side);
    const Vec3 shown = (aside < 0 ? -1.0 : 1.0) * side + 0.5 * (options_.up + options_.front);
    const Vec3 outward = 1 / length(shown) * shown;
    return [outward, normals = vertexNormals(limb)](const TriangleMesh&, std::uint32_t from, std::uint32_t to) {
      return 0.2 + std::max(0.0, 1 + 0.5 * dot(normals[from] + normals[to], outward));
    };
  }

  bool layOutLimb(const Piece& piece, std::uint32_t tip, const SeamCost& cost) {
    const auto loops = loopsOf(piece.mesh, halfEdgeTwins(piece.mesh));
    const auto start = std::find(piece.vertexOf.begin(), piece.vertexOf.end(), tip);
    if (loops.empty() || start == piece.vertexOf.end()) return layOut(piece);
    const auto first = static_cast<std::uint32_t>(start - piece.vertexOf.begin());
    return layOut(cutBetween(piece, {&first, 1}, originsOf(piece.mesh, loops[0]), cost));
  }

  const UnwrapOptions& options_;
  std::vector<bool> isFace_;
  Ticker& ticker_;
  double whole_, done_ = 0;
  std::vector<Chart> charts_;
};

/// Turns a chart so that up on the model is up, or for charts that lie flat front is up.
void standUpright(Chart& chart, const UnwrapOptions& options) {
  const TriangleMesh& mesh = chart.piece.mesh;
  const std::array<Vec3, 3> directions{options.up, -1.0 * options.front, cross(options.up, options.front)};
  double best = 0;
  Uv turn{0, 1};
  for (const Vec3& axis : directions) {
    // Where the axis, laid onto each triangle, points in the chart.
    Uv sum{0, 0};
    double whole = 0;
    for (const Triangle3& t : mesh.triangles) {
      const Vec3 e1 = mesh.positions[t[1]] - mesh.positions[t[0]], e2 = mesh.positions[t[2]] - mesh.positions[t[0]];
      const Vec3 n = cross(e1, e2);
      const double square = dot(n, n);
      if (!(square > 0)) continue;
      const double b1 = dot(cross(axis, e2), n) / square, b2 = dot(cross(e1, axis), n) / square;
      const double area = std::sqrt(square);
      whole += area;
      for (std::size_t k = 0; k < 2; ++k)
        sum[k] +=
            area * (b1 * (chart.uvs[t[1]][k] - chart.uvs[t[0]][k]) + b2 * (chart.uvs[t[2]][k] - chart.uvs[t[0]][k]));
    }
    const double size = std::sqrt(sum[0] * sum[0] + sum[1] * sum[1]);
    if (!(whole > 0) || size / whole < 0.2 || best > 0) continue;
    best = size;
    turn = {sum[0] / size, sum[1] / size};
  }
  for (Uv& uv : chart.uvs) uv = {uv[0] * turn[1] - uv[1] * turn[0], uv[0] * turn[0] + uv[1] * turn[1]};
}

/// Joins sides of props that lie flat together. Of any model that still has too many charts, joins more, as far as the
/// stretch can be borne.
void joinCharts(const TriangleMesh& mesh, const UnwrapOptions& options, Ticker& ticker, std::vector<Chart>& charts) {
  const double longest = kLongestChart * std::sqrt(areaOf(mesh));
  const bool isProp = options.kind == Kind::prop || options.kind == Kind::automatic;
  const Vec3 side = cross(options.up, options.front);
  if (isProp) mergeCharts(mesh, {kJoinedEnergy, 1, kMinFill, longest, side}, ticker, charts);
  const std::size_t enough = isProp ? kMaxPropCharts : options.kind == Kind::body ? 8 : 2;
  if (charts.size() > enough) mergeCharts(mesh, {kBorneEnergy, enough, 0, 1.5 * longest, {0, 0, 0}}, ticker, charts);
}

/// Gives a chart the area that it has on the model.
void scaleToArea(Chart& chart) {
  const double flat = chart.area(), solid = areaOf(chart.piece.mesh);
  if (!(flat > 0) || !(solid > 0)) return;
  const double scale = std::sqrt(solid / flat);
  for (Uv& uv : chart.uvs) uv = {scale * uv[0], scale * uv[1]};
}

/// Cuts and flattens a mesh as what it is.
/// @param mostLimbs  If not 0, limbs are cut off first.
/// @param isFace  As `Unwrapper` has it.
std::vector<Chart> chartsOf(const TriangleMesh& mesh, const UnwrapOptions& options, std::size_t mostLimbs,
                            Ticker& ticker, const std::vector<bool>& isFace = {}) {
  Unwrapper unwrapper(mesh, options, isFace, ticker);
  for (Piece& piece : componentsOf(cutOpen(wholeOf(mesh)))) {
    const bool going = mostLimbs > 0 ? unwrapper.layOutBody(piece, mostLimbs) : unwrapper.layOutAs(options.kind, piece);
    if (!going) return {};
  }
  joinCharts(mesh, options, ticker, unwrapper.charts());
  if (ticker.cancelled() || !options.face || !isFace.empty()) return std::move(unwrapper.charts());
  if (seamsOnFace(mesh, *options.face, unwrapper.charts()) <= kMaxFaceSeam) return std::move(unwrapper.charts());
  return chartsOf(mesh, options, mostLimbs, ticker, faceTriangles(mesh, *options.face));
}

}  // namespace

bool unwrap(const TriangleMesh& mesh, const UnwrapOptions& options, const Progress& progress, Layout& out) {
  out = {};
  Ticker ticker(progress);
  std::vector<Chart> charts = chartsOf(mesh, options, options.kind == Kind::body ? kMaxLimbs : 0, ticker);
  if (options.kind != Kind::head && options.kind != Kind::body && charts.size() > kMaxPropCharts) {
    // A spider has more sides than legs.
    std::vector<Chart> others = chartsOf(mesh, options, kMaxLegs, ticker);
    if (others.size() < charts.size()) charts = std::move(others);
  }
  if (ticker.cancelled()) return false;
  ticker.reach(kJoinedShare);
  for (Chart& chart : charts) {
    scaleToArea(chart);
    standUpright(chart, options);
  }
  if (!packCharts(options.gutter, ticker, charts)) return false;
  out.mesh.triangles.resize(mesh.triangles.size());
  for (const Chart& chart : charts) {
    const auto first = static_cast<std::uint32_t>(out.mesh.positions.size());
    for (const Vec3& p : chart.piece.mesh.positions) out.mesh.positions.push_back(p);
    for (const auto& [u, v] : chart.uvs)
      out.uvs.push_back({static_cast<double>(static_cast<float>(u)), static_cast<double>(static_cast<float>(1 - v))});
    for (std::size_t t = 0; t < chart.piece.triangleOf.size(); ++t) {
      const Triangle3& from = chart.piece.mesh.triangles[t];
      out.mesh.triangles[chart.piece.triangleOf[t]] = {first + from[0], first + from[1], first + from[2]};
    }
  }
  return true;
}

}  // namespace cagecast::cages
