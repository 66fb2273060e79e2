#pragma once

#include <string>
#include <string_view>
#include <vector>

#include "cagecast/cages.hpp"

namespace cagecast::cages {

/// Whether a name is what a pattern describes: `*` stands for any text, `?` for one character, case does not matter.
/// Takes time in proportion to the product of the lengths at worst, whatever the pattern.
bool matches(std::string_view name, std::string_view pattern) noexcept;

/// Whether each part's name matches one of the patterns. A part may have several names, "node/mesh/material": what is
/// between slashes is matched on its own, too.
std::vector<bool> matchingParts(const std::vector<std::string>& parts, const std::vector<std::string>& patterns);

/// Whether each triangle of a model belongs to one of some parts.
/// @param isMatch  Per part. Triangles of groups beyond it, and of models without groups, do not.
std::vector<bool> trianglesOf(const MeshView& mesh, const std::vector<bool>& isMatch);

}  // namespace cagecast::cages
