#include <cstdio>

#include "cagecast/mesh.hpp"

namespace cagecast {

const char* codeName(Code code) noexcept {
  switch (code) {
    case Code::ok: return "ok";
    case Code::emptyMesh: return "emptyMesh";
    case Code::positionsNotTriples: return "positionsNotTriples";
    case Code::indicesNotTriples: return "indicesNotTriples";
    case Code::missingUvs: return "missingUvs";
    case Code::uvCountMismatch: return "uvCountMismatch";
    case Code::groupCountMismatch: return "groupCountMismatch";
    case Code::cornerUvCountMismatch: return "cornerUvCountMismatch";
    case Code::indexOutOfRange: return "indexOutOfRange";
    case Code::nonFinitePosition: return "nonFinitePosition";
    case Code::nonFiniteUv: return "nonFiniteUv";
    case Code::noUsableCageTriangle: return "noUsableCageTriangle";
    case Code::tooLarge: return "tooLarge";
    case Code::badThreshold: return "badThreshold";
    case Code::badWeldTolerance: return "badWeldTolerance";
    case Code::badOcclusionReach: return "badOcclusionReach";
    case Code::badPokeThrough: return "badPokeThrough";
    case Code::badMinCovered: return "badMinCovered";
    case Code::badMinOfAll: return "badMinOfAll";
    case Code::badMaxUncovered: return "badMaxUncovered";
    case Code::badLocks: return "badLocks";
    case Code::resultMismatch: return "resultMismatch";
    case Code::outOfMemory: return "outOfMemory";
  }
  return "unknown";
}

namespace {

std::string number(double value) {
  char text[32];
  std::snprintf(text, sizeof text, "%g", value);
  return text;
}

}  // namespace

std::string describe(const Status& status, const MeshView& cage, const MeshView& target) {
  const bool isCage = status.argument == Argument::cage;
  const MeshView& mesh = isCage ? cage : target;
  const std::string name = isCage ? "cage" : "target";
  const std::string at = "[" + std::to_string(status.at) + "]";
  const std::string vertices = std::to_string(mesh.positions.size() / 3) + " vertices";
  switch (status.code) {
    case Code::ok: return "ok";
    case Code::emptyMesh:
      return name + (mesh.positions.empty() ? " has no vertices" : " has no triangles") + "; at least one is needed";
    case Code::positionsNotTriples:
      return name + ".positions has " + std::to_string(mesh.positions.size()) + " numbers, not 3 per vertex";
    case Code::indicesNotTriples:
      return name + ".indices has " + std::to_string(mesh.indices.size()) + " entries, not 3 per triangle";
    case Code::missingUvs: return name + ".uvs is missing: the texture is drawn in the cage's UVs, 2 per vertex";
    case Code::uvCountMismatch:
      return name + ".uvs has " + std::to_string(mesh.uvs.size()) + " numbers, not 2 for each of " + vertices;
    case Code::groupCountMismatch:
      return name + ".groups has " + std::to_string(mesh.groups.size()) + " entries, not 1 for each of " + vertices;
    case Code::cornerUvCountMismatch:
      return "cornerUvs has not 2 numbers for each of " + std::to_string(mesh.indices.size()) + " indices";
    case Code::indexOutOfRange:
      return name + ".indices" + at + " = " + std::to_string(mesh.indices[status.at]) + " is out of range (" +
             vertices + ")";
    case Code::nonFinitePosition:
      return name + ".positions" + at + " = " + number(static_cast<double>(mesh.positions[status.at])) +
             " is not a finite number";
    case Code::nonFiniteUv:
      return name + ".uvs" + at + " = " + number(static_cast<double>(mesh.uvs[status.at])) + " is not a finite number";
    case Code::noUsableCageTriangle: return "cage has no triangle with an area";
    case Code::tooLarge:
      if (mesh.positions.size() / 3 > kMaxVertices)
        return name + " has " + vertices + ", more than " + std::to_string(kMaxVertices);
      if (mesh.indices.size() / 3 > kMaxTriangles) {
        return name + " has " + std::to_string(mesh.indices.size() / 3) + " triangles, more than " +
               std::to_string(kMaxTriangles);
      }
      return name + ".positions" + at + " = " + number(static_cast<double>(mesh.positions[status.at])) +
             " is out of all proportion (farther from the origin than 1e8 diagonals of the target)";
    case Code::badThreshold: return "options.threshold is not within 0..1";
    case Code::badWeldTolerance: return "options.weldTolerance is not within 0..0.01";
    case Code::badOcclusionReach: return "options.occlusionReach is not a number of at least 0";
    case Code::badPokeThrough: return "options.pokeThrough is not within 0..1";
    case Code::badMinCovered: return "options.minCovered is not within 0..1";
    case Code::badMinOfAll: return "options.minOfAll is not within 0..1";
    case Code::badMaxUncovered: return "options.maxUncovered is not within 0..1";
    case Code::badLocks: return "options.locks has " + std::to_string(status.at) + " entries, not 1 per segment";
    case Code::resultMismatch:
      return "the result is of " + std::to_string(status.at) + " vertices, or of other segments; the target has " +
             std::to_string(target.positions.size() / 3) + " vertices";
    case Code::outOfMemory: return "not enough memory for this target and cage";
  }
  return "unknown";
}

}  // namespace cagecast
