/** How a texture lies on UVs, as KHR_texture_transform says. */
export interface UvTransform {
  offset: readonly [number, number];
  /** Radians, counter-clockwise. */
  rotation: number;
  scale: readonly [number, number];
}

/** Where UVs are in a texture: scaled, rotated, then moved. @param uvs  2 per vertex. */
export function transformUvs(uvs: Float32Array, { offset, rotation, scale }: UvTransform): Float32Array {
  const [cos, sin] = [Math.cos(rotation), Math.sin(rotation)];
  const out = new Float32Array(uvs.length);
  for (let i = 0; i < uvs.length; i += 2) {
    const [u, v] = [scale[0] * uvs[i]!, scale[1] * uvs[i + 1]!];
    out[i] = offset[0] + cos * u + sin * v;
    out[i + 1] = offset[1] - sin * u + cos * v;
  }
  return out;
}
