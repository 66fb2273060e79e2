#pragma once

#include <cstdint>
#include <vector>

#include "scenes/scenes.hpp"

/// Models made to be difficult, with the truth about each: the same bits on every platform, like all scenes.
namespace cagecast::scenes {

/// What is to become of a vertex.
enum class Label : std::uint8_t {
  painted = 0,
  bare = 1,
  either = 2,  ///< Hidden, or a matter of taste.
};

struct Trap {
  Scene scene;
  std::vector<Label> truth;  ///< 1 per target vertex.
};

/// A figure in clothes: its skin, of one piece, shows at the head alone; eyes, a tongue that pushes out between the
/// lips as far as under the cage, and buttons on the shirt.
/// @param hooded  The clothes leave nothing free but the face.
Trap clothed(bool hooded);

/// A head with a deep fold under its brow, eyes, teeth and tongue, in which every triangle has a copy in reverse
/// winding.
/// @param own  The copies have vertices of their own; else they share those of the originals.
Trap doubled(bool own);

/// A head whose cage is its own skin with fewer vertices and no offset: between them the skin lies outside, by less
/// than a thousandth of the diagonal. Eyes behind holes.
Trap wrapped();

/// A figure under a closed dome that is part of the target: whatever leaves the figure's cage meets it.
Trap domed();

/// A van whose windows are panes of two triangles, in a cage 3 % of the diagonal away, with holes smaller than they
/// are.
Trap glazed();

/// A hat of one closed shell, whose brim is to be painted from below as well, on a head; the cage is too high.
Trap hatted();

/// A figure with eyes of 1.4 % of the diagonal, whose cage is 1 % aside.
Trap aside();

/// The same figure behind glasses, which hide the middle of its eyes; the cage is in place.
Trap bespectacled();

/// All of them.
std::vector<Trap> traps();

}  // namespace cagecast::scenes
