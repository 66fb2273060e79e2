#pragma once

#include <array>
#include <cstdint>
#include <string>
#include <vector>

#include "cagecast/cages.hpp"
#include "landmarks/landmark_list.hpp"
#include "mesh/neighbours.hpp"

namespace cagecast::cages {

/// The mirror plane and the directions of a head or figure, by its landmarks.
struct Axes {
  Vec3 left{1, 0, 0}, up{0, 1, 0}, front{0, 0, 1};
  Vec3 middle{};       ///< A point of the mirror plane.
  bool known = false;  ///< Whether there were landmarks on both sides and in front.
};

/// A cage to be fitted, welded, with what the fit needs to know of it. All in its own space.
struct TemplateCage {
  TriangleMesh mesh;
  std::vector<std::uint32_t> vertexOf;            ///< Vertex of `mesh` for each vertex of the given cage.
  std::vector<std::vector<std::uint32_t>> loops;  ///< Open borders: holes, and the rim where the figure ends.
  int rim = -1;  ///< The loop where the figure ends, as at a neck; -1 if there is none.
  double diagonal = 0;
  double offset = 0;  ///< How far the cage is off the model that it was made for, by the landmarks on its skin.
  Neighbours neighbours;
};

TemplateCage prepareTemplate(const Template& from);

/// Whether a landmark lies on the skin: joints and the centres of eyes do not.
bool isOnSkin(const std::string& name);

Axes axesOf(const std::vector<Landmark>& landmarks);

/// The boundary loop that is a rim: the longest one, if it is longer than `kMinRim` diagonals; -1 if there is none.
int rimOf(const TriangleMesh& mesh, const std::vector<std::vector<std::uint32_t>>& loops, double diagonal);

}  // namespace cagecast::cages
