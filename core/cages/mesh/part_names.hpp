#pragma once

#include <cstdint>
#include <span>
#include <string_view>
#include <vector>

#include "cagecast/cages.hpp"

namespace cagecast::cages {

/// Whether a text is what a pattern describes: `*` stands for any text, `?` for one character, case does not matter.
/// Takes time in proportion to the product of the lengths at worst, whatever the pattern.
bool matches(std::string_view text, std::string_view pattern) noexcept;

/// The words of a name: "Wolf3D_EyeLeft/l-eye" has the words Wolf, D, Eye, Left, l and eye.
std::vector<std::string_view> wordsOf(std::string_view name);

/// Whether a pattern describes a whole name, what is between slashes in it ("node/mesh/material"), or one of its words:
/// `eye` matches "l-eye" and "EyeLeft", but not "eyelid".
bool matchesName(std::string_view name, std::string_view pattern);

/// Whether each part's name matches one of the patterns.
std::vector<bool> matchingParts(const std::vector<std::string>& parts, const std::vector<std::string>& patterns);

/// Whether any part is named as one that only vehicles have, such as a wheel.
bool isVehicle(const std::vector<std::string>& parts);

/// Whether each triangle of a model belongs to one of some parts.
/// @param isMatch  Per part. Triangles of groups beyond it, and of models without groups, do not.
std::vector<bool> trianglesOf(const MeshView& mesh, const std::vector<bool>& isMatch);

/// @return badOption for a number that is no group of the model.
Status checkParts(const Model& model, const Parts& parts) noexcept;

/// Whether each triangle is of some groups.
std::vector<bool> trianglesIn(const MeshView& mesh, std::span<const std::uint32_t> groups);

/// Whether each triangle is of a part that is excluded, by number or by name.
std::vector<bool> excludedTriangles(const Model& model, const Parts& parts);

/// A model without the triangles of some parts.
class WithoutParts {
 public:
  WithoutParts(const Model& model, std::span<const std::uint32_t> groups);
  WithoutParts(const WithoutParts&) = delete;
  WithoutParts& operator=(const WithoutParts&) = delete;

  [[nodiscard]] const Model& model() const noexcept { return model_; }

 private:
  Model model_;
  std::vector<std::uint32_t> indices_;
  std::vector<std::uint8_t> marks_;
};

}  // namespace cagecast::cages
