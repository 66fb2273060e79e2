#include "cagecast/cages.hpp"

namespace cagecast::cages {

const std::vector<std::string>& defaultExclusions() {
  static const std::vector<std::string> patterns = {
      // Faces. `eye` is a word of its own: lids are skin.
      "eye", "eyes", "eyeball*", "eyelash*", "eyebrow*", "eyeline*", "lash*", "brow", "brows", "iris*", "pupil*",
      "cornea*", "sclera*", "teeth*", "tooth*", "tongue*", "gum", "gums", "mouth*", "hair*", "beard*", "moustache*",
      "mustache*", "glass*", "goggles*",
      // Vehicles.
      "window*", "windscreen*", "windshield*", "wheel*", "tyre*", "tire*", "rim", "rims", "light", "lights",
      "headlight*", "taillight*", "lamp*", "grille*", "seat*", "dashboard*", "steering*", "interior*", "lining*",
      "floor*"};
  return patterns;
}

}  // namespace cagecast::cages
