#pragma once

#include <string_view>
#include <vector>

#include "cagecast/cages.hpp"

namespace cagecast::cages {

/// Whether a text is what a pattern describes: `*` stands for any text, `?` for one character, case does not matter.
/// Takes time in proportion to the product of the lengths at worst, whatever the pattern.
bool matches(std::string_view text, std::string_view pattern) noexcept;

/// The words of a name: "Wolf3D_EyeLeft/l-eye" has the words Wolf, D, Eye, Left, l and eye.
std::vector<std::string_view> wordsOf(std::string_view name);

/// Whether a pattern matches a name, as `matchingParts` says.
bool matchesName(std::string_view name, std::string_view pattern);

/// Whether each triangle of a model belongs to one of some parts.
/// @param isMatch  Per part. Triangles of groups beyond it, and of models without groups, do not.
std::vector<bool> trianglesOf(const MeshView& mesh, const std::vector<bool>& isMatch);

}  // namespace cagecast::cages
