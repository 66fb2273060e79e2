#pragma once

#include <vector>

#include "instance.hpp"

namespace cagecast::gltf {

/// Places the skinned instances of a scene by skeletons at rest. Files that are quantised, or whose rig has another
/// unit or axis than the scene, store this only in the inverse bind matrices. The same as `skinMatrices` in JavaScript.
///
/// In the bind pose all joints of a mesh give the same transform (joint in the scene · inverse bind matrix), which is
/// taken. If those of any mesh differ, the model has moved: joints of other meshes may be equal only because they have
/// turned together, as those of an eye. Then all meshes are taken as they are stored, unless that cannot be right
/// because they are quantised or of another size; these are placed by the first joint of their skin, which is most
/// often the root. Transforms of their nodes are ignored, as the format demands.
/// @param worlds  The transform of each of the file's nodes to the scene.
void placeSkinned(const tinygltf::Model& model, const std::vector<Transform>& worlds, std::vector<Instance>& instances);

}  // namespace cagecast::gltf
