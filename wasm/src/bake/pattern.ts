/** If triangles cover a texture more often than this, it is a pattern; mirrored halves use it twice at most. */
export const kMaxLayers = 2.5;
