/** The extension by which a node draws many instances of its mesh. */
export const instancing = 'EXT_mesh_gpu_instancing';

/** Error message for such a node: a vertex has one UV, but several positions. */
export const isInstanced =
  'is instanced, so its mesh is in many places at once; give each instance a node of its own first';
