/** The extension by which a node shows its mesh many times, in many places. */
export const instancing = 'EXT_mesh_gpu_instancing';

/** What is wrong with such a node: there is one UV for each vertex, but not one place. */
export const isInstanced = 'shows its mesh in many places at once (instances); give each a node of its own first';
