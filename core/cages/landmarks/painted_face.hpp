#pragma once

#include <optional>
#include <vector>

#include "landmarks/head.hpp"

namespace cagecast::cages {

/// A face that the base colours of a figure show.
struct PaintedFace {
  double score = 0;                      ///< How plausible it is.
  Eyes eyes;                             ///< Their confidence is that of the face.
  std::vector<Landmark> landmarks = {};  ///< As the hints of a model, with both lips.
};

/// Looks at the front of a figure's head for two spots that mirror each other, and one below between them, that differ
/// from what is around them: painted eyes and a mouth.
/// @param model  That the figure was read from. Without base colours there is no face.
/// @param plane  That may mirror the head.
std::optional<PaintedFace> findPaintedFace(const Figure& figure, const Model& model, const MirrorPlane& plane);

/// Looks for a painted mouth below eyes that are known.
/// @return `mouth`, its corners and both lips, as the hints of a model; nothing if no mouth is clearly seen.
std::vector<Landmark> findPaintedMouth(const Figure& figure, const Model& model, const Head& head);

}  // namespace cagecast::cages
