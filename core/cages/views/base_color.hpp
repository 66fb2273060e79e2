#pragma once

#include <cstdint>
#include <optional>

#include "cagecast/cages.hpp"
#include "geometry/vec3.hpp"

namespace cagecast::cages {

/// The base colour of a model at a point of one of its triangles, in CIELAB, whose distances are about as large as
/// people see them: x is lightness, 0..100, y from green to red, z from blue to yellow.
/// @param model  With base colours. @param triangle  Of the model.
/// @return Nothing where the image is transparent.
std::optional<Vec3> baseColorAt(const Model& model, std::uint32_t triangle, const Vec3& point);

}  // namespace cagecast::cages
