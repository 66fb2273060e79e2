#pragma once

#include <vector>

#include "instance.hpp"

namespace cagecast::gltf {

/// Places the instances of a scene with skeletons at rest. Files that are quantised, or whose rig has another unit or
/// axis than the scene, store this only in the inverse bind matrices. The same as `placeMeshes` in JavaScript.
///
/// In the bind pose all joints of a mesh give the same transform (joint in the scene · inverse bind matrix), which is
/// taken. If those of any mesh differ, the model has moved: joints of other meshes may be equal only because they have
/// turned together, as those of an eye. Then the topmost joint says where the mesh would be, which may have moved as
/// well; so what comes nearest to it is taken: the mesh as it is stored, or moved by its own node or one above the
/// joints. The topmost joint itself decides if it is turned by a quarter against all of these, and for meshes that are
/// quantised or of another size. Meshes without a skin that hang on a joint go with it.
/// @param worlds  The transform of each of the file's nodes to the scene.
void placeMeshes(const tinygltf::Model& model, const std::vector<Transform>& worlds, std::vector<Instance>& instances);

}  // namespace cagecast::gltf
