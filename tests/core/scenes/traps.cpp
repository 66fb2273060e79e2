#include "scenes/traps.hpp"

#include <algorithm>
#include <cmath>
#include <map>

namespace cagecast::scenes {
namespace {

/// The same triangles over no more vertices than they need.
Mesh trimmed(const Mesh& mesh) {
  constexpr std::uint32_t kUnused = 0xffffffff;
  std::vector<std::uint32_t> places(mesh.vertexCount(), kUnused);
  Mesh result;
  for (const std::uint32_t v : mesh.indices) {
    if (places[v] == kUnused) places[v] = result.addVertex(mesh.vertex(v), mesh.uvs[v * 2], mesh.uvs[v * 2 + 1]);
    result.indices.push_back(places[v]);
  }
  return result;
}

/// Adds a part of which each vertex is labelled as a function of its position says.
template <typename Wish>
void addBy(Trap& trap, const Mesh& mesh, Wish wish) {
  const Mesh part = trimmed(mesh);
  append(trap.scene.target, part);
  for (std::size_t v = 0; v < part.vertexCount(); ++v) trap.truth.push_back(wish(part.vertex(v)));
}

/// Adds a part of which all is labelled alike.
void add(Trap& trap, const Mesh& part, Label label) {
  addBy(trap, part, [&](Point) { return label; });
}

/// From 0 to 1 between two values, straight.
float ramp(float x, float from, float to) { return std::clamp((x - from) / (to - from), 0.0f, 1.0f); }

/// A unit sphere's point to that of a figure `size` times as thick: a trunk, a neck, a head.
Point onFigure(Point p, float size) {
  const float h = p[1];
  const float neck = 1 - 0.72f * ramp(h, 0.3f, 0.5f) + 0.22f * ramp(h, 0.55f, 0.65f);
  const float thick = 0.8f * neck;
  // What is above and below grows with the size as the sides do.
  return {p[0] * thick + (size - 1) * p[0] * 0.8f, 1.4f * h + (size - 1) * h * 0.8f,
          p[2] * thick + (size - 1) * p[2] * 0.8f};
}

constexpr Point kEyes[] = {{0.12f, 1.17f, 0.235f}, {-0.12f, 1.17f, 0.235f}};
constexpr Point kMouth{0, 0.98f, 0.29f};

float fromMouth(Point p) {
  return distance({p[0] * 0.6f, p[1] * 1.6f, p[2]}, {kMouth[0], kMouth[1] * 1.6f, kMouth[2]});
}

/// Whether a point is where a figure's eyes or mouth are open.
bool inOpening(Point p, float grow) {
  return distance(p, kEyes[0]) < 0.075f * grow || distance(p, kEyes[1]) < 0.075f * grow || fromMouth(p) < 0.08f * grow;
}

Mesh figure(float size, int cells) {
  return mapped(ellipsoid({}, {1, 1, 1}, cells), [&](Point p) { return onFigure(p, size); });
}

}  // namespace

Trap clothed(bool hooded) {
  Trap trap;
  trap.scene.name = hooded ? "hooded" : "clothed";
  trap.scene.cage = without(figure(1.12f, 24), [](Point p) { return inOpening(p, 1.35f); });
  const auto leftFree = [&](Point p, float margin) {
    if (hooded) return p[2] > 0.12f + margin && p[1] > 0.8f + margin;
    return p[1] > 0.62f + margin;
  };
  // The clothes end between what is surely free and what is surely covered.
  addBy(trap, without(figure(1, 40), [](Point p) { return inOpening(p, 1); }),
        [&](Point p) { return leftFree(p, 0.08f) ? Label::painted : Label::either; });
  add(trap, without(figure(1.05f, 32), [&](Point p) { return leftFree(p, 0); }), Label::painted);
  for (const Point& eye : kEyes)
    add(trap, ellipsoid({eye[0], eye[1], eye[2] - 0.05f}, {0.07f, 0.07f, 0.07f}, 6), Label::bare);
  add(trap, ellipsoid({0, 0.975f, 0.16f}, {0.09f, 0.03f, 0.13f}, 6), Label::bare);
  for (const float y : {-0.4f, -0.2f, 0.0f, 0.2f}) {
    const float x = y / 1.4f;
    add(trap, ellipsoid({0, y, 0.8f * std::sqrt(1 - x * x) + 0.045f}, {0.02f, 0.02f, 0.012f}, 2), Label::either);
  }
  return trap;
}

Trap doubled(bool own) {
  Scene plain = head(24);
  // A fold under the brow, that goes in and up.
  const auto depthAt = [](Point p) { return p[2] < 0 ? 0 : ramp(p[1], 0.35f, 0.6f) * (1 - ramp(p[1], 0.6f, 0.75f)); };
  std::vector<float> depths;
  std::size_t v = 0;
  for (; v < plain.target.vertexCount(); ++v)
    depths.push_back(plain.target.groups[v] == plain.target.groups[0] ? depthAt(plain.target.vertex(v)) : 0);
  v = 0;
  plain.target = mapped(plain.target, [&](Point p) {
    const float depth = depths[v++], in = 1 - 0.35f * depth;
    return Point{p[0] * in, p[1] + 0.12f * depth, p[2] * in};
  });
  Trap trap;
  trap.scene = std::move(plain);
  trap.scene.name = own ? "doubled with own vertices" : "doubled";
  Mesh& target = trap.scene.target;
  for (v = 0; v < target.vertexCount(); ++v) {
    // Nothing is asked of the bottom of the fold, nor of what lies beside a hole of the cage.
    float besides = 1e9f;
    for (const Point hole : {Point{0.35f, 0.25f, 0.85f}, Point{-0.35f, 0.25f, 0.85f}, Point{0, -0.4f, 0.95f}})
      besides = std::min(besides, distance(target.vertex(v), hole));
    const Label skin = depths[v] > 0.7f || besides < 0.32f ? Label::either : Label::painted;
    trap.truth.push_back(target.groups[v] == target.groups[0] ? skin : Label::bare);
  }
  const std::size_t triangles = target.triangleCount();
  std::uint32_t shift = 0;
  if (own) {
    shift = static_cast<std::uint32_t>(target.vertexCount());
    for (v = 0; v < shift; ++v) {
      target.addVertex(target.vertex(v), target.uvs[v * 2], target.uvs[v * 2 + 1], target.groups[v]);
      trap.truth.push_back(trap.truth[v]);
    }
  }
  for (std::size_t t = 0; t < triangles; ++t)
    target.addTriangle(shift + target.indices[t * 3], shift + target.indices[t * 3 + 2],
                       shift + target.indices[t * 3 + 1]);
  return trap;
}

Trap wrapped() {
  Trap trap;
  trap.scene.name = "wrapped";
  constexpr Point kRadii{0.8f, 1, 0.9f};
  constexpr Point kHoles[] = {{0.3f, 0.25f, 0.8f}, {-0.3f, 0.25f, 0.8f}};
  const auto besideEye = [&](Point p, float reach) {
    return distance(p, kHoles[0]) < reach || distance(p, kHoles[1]) < reach;
  };
  trap.scene.cage = without(ellipsoid({}, kRadii, 12), [&](Point p) { return besideEye(p, 0.24f); });
  addBy(trap, without(ellipsoid({}, kRadii, 25), [&](Point p) { return besideEye(p, 0.2f); }),
        [&](Point p) { return besideEye(p, 0.4f) ? Label::either : Label::painted; });
  for (const Point& hole : kHoles)
    add(trap, ellipsoid({hole[0], hole[1], hole[2] - 0.12f}, {0.16f, 0.16f, 0.16f}, 6), Label::bare);
  return trap;
}

Trap domed() {
  Trap trap;
  trap.scene.name = "domed";
  trap.scene.cage = ellipsoid({}, {0.46f, 0.66f, 0.46f}, 8);
  add(trap, ellipsoid({}, {0.4f, 0.6f, 0.4f}, 17), Label::painted);
  add(trap, ellipsoid({}, {1.6f, 1.5f, 1.6f}, 9), Label::bare);
  return trap;
}

Trap glazed() {
  Trap trap;
  trap.scene.name = "glazed";
  constexpr Point kBody{0.8f, 0.6f, 1.92f};
  constexpr float kAway = 0.13f;  // 3 % of the diagonal.
  // On either side a window in front and one behind, of so much of the side.
  constexpr float kLow = 0.1f, kHigh = 0.4f, kBack = 0.16f, kFront = 1.12f;
  const auto beside = [](float x, float from, float to) { return std::max({from - x, x - to, 0.0f}); };
  const auto fromWindow = [&](Point p) {
    const float above = beside(p[1], kLow, kHigh), along = beside(std::abs(p[2]), kBack, kFront);
    return std::abs(p[0]) < 0.7f ? 1 : std::sqrt(above * above + along * along);
  };
  trap.scene.cage = without(box({}, {kBody[0] + kAway, kBody[1] + kAway, kBody[2] + kAway}, 30), [&](Point p) {
    return std::abs(p[0]) > kBody[0] && p[1] > kLow + 0.03f && p[1] < kHigh - 0.03f && std::abs(p[2]) > kBack + 0.05f &&
           std::abs(p[2]) < kFront - 0.05f;
  });
  addBy(trap, without(box({}, kBody, 24), [&](Point p) { return fromWindow(p) == 0; }),
        [&](Point p) { return fromWindow(p) < 0.15f ? Label::either : Label::painted; });
  for (const float side : {-1.0f, 1.0f}) {
    for (const float end : {-1.0f, 1.0f}) {
      Mesh pane;
      for (const float y : {kLow, kHigh})
        for (const float z : {kBack, kFront}) pane.addVertex({side * kBody[0], y, end * z});
      pane.addTriangle(0, 1, 3);
      pane.addTriangle(0, 3, 2);
      add(trap, pane, Label::bare);
    }
  }
  return trap;
}

Trap hatted() {
  Trap trap;
  trap.scene.name = "hatted";
  constexpr float kCrown = 0.5f, kThick = 0.015f, kAway = 0.05f;
  const auto fromAxis = [](Point p) { return std::min(1.0f, std::sqrt(p[0] * p[0] + p[2] * p[2])); };
  const auto round = [](float x) { return std::sqrt(std::max(0.0f, 1 - x * x)); };
  const auto crown = [&](float r) { return 0.45f * round(r / kCrown); };
  // A hat of one closed shell, of a unit sphere whose upper half becomes its outside: a crown and a flat brim.
  addBy(trap,
        mapped(ellipsoid({}, {1, 1, 1}, 32),
               [&](Point p) {
                 const float r = fromAxis(p);
                 return Point{p[0], crown(r) + (p[1] < 0 ? -kThick : kThick) * round(r), p[2]};
               }),
        [&](Point p) {
          return fromAxis(p) < kCrown + 0.1f && p[1] < crown(fromAxis(p)) ? Label::either : Label::painted;
        });
  // The head under it.
  addBy(trap, ellipsoid({0, -0.4f, 0}, {0.42f, 0.75f, 0.42f}, 20),
        [](Point p) { return p[1] > -0.2f ? Label::either : Label::painted; });
  // Too high by 1 % of the diagonal, so that its upper side is nearer to the brim's lower one too.
  constexpr float kUp = 0.033f;
  trap.scene.cage = mapped(ellipsoid({}, {1, 1, 1}, 24), [&](Point p) {
    const float r = fromAxis(p), out = 1 + kAway;
    if (p[1] >= 0) return Point{p[0] * out, 0.5f * round(r * out / (kCrown + kAway)) + kAway + kUp, p[2] * out};
    return Point{p[0] * out, kUp - kAway - 1.15f * round(r * out / kCrown), p[2] * out};
  });
  return trap;
}

namespace {

/// A figure with eyes of 1.4 % of the diagonal, which is 2.4.
struct SmallEyed {
  static constexpr Point kRadii{0.5f, 1, 0.45f};
  static constexpr Point kEyes[] = {{0.11f, 0.3f, 0.418f}, {-0.11f, 0.3f, 0.418f}};
  static constexpr float kEye = 0.034f;

  static float fromEye(Point p) { return std::min(distance(p, kEyes[0]), distance(p, kEyes[1])); }
  /// Finer in front, where the eyes are.
  static Mesh body(float away) {
    return mapped(ellipsoid({}, {1, 1, 1}, 30), [&](Point p) {
      const Point q{p[0], p[1], p[2] + 0.85f};
      const float size = distance(q, {});
      return Point{q[0] / size * (kRadii[0] + away), q[1] / size * (kRadii[1] + away),
                   q[2] / size * (kRadii[2] + away)};
    });
  }
  static Mesh cage(float away, float hole) {
    return without(body(away), [&](Point p) { return fromEye({p[0], p[1], p[2] - away}) < hole; });
  }
  static void addTo(Trap& trap) {
    addBy(trap, without(body(0), [](Point p) { return fromEye(p) < 0.03f; }),
          [](Point p) { return fromEye(p) < 0.09f ? Label::either : Label::painted; });
    for (const Point& eye : kEyes) add(trap, ellipsoid(eye, {kEye, kEye, kEye}, 6), Label::bare);
  }
};

}  // namespace

Trap aside() {
  Trap trap;
  trap.scene.name = "aside";
  constexpr float kUp = 0.024f;  // 1 % of the diagonal.
  trap.scene.cage = mapped(SmallEyed::cage(0.036f, 0.022f), [](Point p) { return Point{p[0], p[1] + kUp, p[2]}; });
  SmallEyed::addTo(trap);
  return trap;
}

Trap bespectacled() {
  Trap trap;
  trap.scene.name = "bespectacled";
  trap.scene.cage = SmallEyed::cage(0.06f, 0.03f);
  SmallEyed::addTo(trap);
  for (const Point& eye : SmallEyed::kEyes)
    add(trap, ellipsoid({eye[0], eye[1], eye[2] + 0.045f}, {0.028f, 0.028f, 0.004f}, 4), Label::either);
  return trap;
}

std::vector<Trap> traps() {
  std::vector<Trap> all;
  all.push_back(clothed(false));
  all.push_back(clothed(true));
  all.push_back(doubled(false));
  all.push_back(doubled(true));
  all.push_back(wrapped());
  all.push_back(domed());
  all.push_back(glazed());
  all.push_back(hatted());
  all.push_back(aside());
  all.push_back(bespectacled());
  return all;
}

}  // namespace cagecast::scenes
