import { Document, NodeIO } from '@gltf-transform/core';
import { drawTexture, linear, type Rgba, rgb, type Shade } from './image.ts';
import type { Mesh } from './mesh.ts';
import type { Vec3 } from './vec.ts';

/** A named piece of a model: one node, one mesh, one material. */
export interface Part {
  name: string;
  mesh: Mesh; // with normals and UVs
  colour: Rgba; // sRGB; multiplies the texture
  roughness: number;
  metallic?: number;
  doubleSided?: boolean; // open: its back can be seen
  texture?: Buffer; // PNG of the base colour, over the mesh's UVs
  ncz: boolean | ((p: Vec3) => boolean); // must not be painted, whole or at a point
  ambiguous?: boolean; // nobody would mind either way: not scored
}

/** A part whose colour is drawn into a texture of its own, `size` texels wide. */
export const textured = (
  name: string,
  mesh: Mesh,
  shade: Shade,
  size: number,
  roughness: number,
  ncz: Part['ncz'],
): Part => ({
  name,
  mesh,
  colour: [1, 1, 1, 1],
  roughness,
  ncz,
  texture: drawTexture(mesh, size, shade, rgb('#808080'), 1),
});

/** Writes parts as one GLB, in order; the same parts give the same bytes. */
export const writeGlb = async (title: string, parts: readonly Part[]): Promise<Uint8Array> => {
  const document = new Document();
  document.getRoot().getAsset().generator = 'cagecast sample models';
  const buffer = document.createBuffer();
  const scene = document.createScene(title);
  for (const part of parts) {
    const { positions, indices, normals, uvs } = part.mesh;
    const accessor = (type: 'VEC2' | 'VEC3' | 'SCALAR', array: Float32Array | Uint16Array | Uint32Array) =>
      document.createAccessor().setType(type).setArray(array).setBuffer(buffer);
    const primitive = document
      .createPrimitive()
      .setAttribute('POSITION', accessor('VEC3', positions))
      .setIndices(accessor('SCALAR', positions.length / 3 <= 0xffff ? Uint16Array.from(indices) : indices));
    if (normals) primitive.setAttribute('NORMAL', accessor('VEC3', normals));
    if (uvs) primitive.setAttribute('TEXCOORD_0', accessor('VEC2', uvs));
    const material = document
      .createMaterial(part.name)
      .setBaseColorFactor(linear(part.colour))
      .setRoughnessFactor(part.roughness)
      .setMetallicFactor(part.metallic ?? 0)
      .setDoubleSided(part.doubleSided ?? false);
    if (part.colour[3] < 1) material.setAlphaMode('BLEND');
    if (part.texture)
      material.setBaseColorTexture(document.createTexture(part.name).setMimeType('image/png').setImage(part.texture));
    primitive.setMaterial(material);
    scene.addChild(document.createNode(part.name).setMesh(document.createMesh(part.name).addPrimitive(primitive)));
  }
  return new NodeIO().writeBinary(document);
};
