/** If triangles cover a texture more often than this, it is a pattern; mirrored halves use it twice at most. */
export const kMostLayers = 2.5;
