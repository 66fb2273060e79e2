import { mkdirSync, writeFileSync } from 'node:fs';
import { Document, NodeIO } from '@gltf-transform/core';
import { cagesFolder } from './figures.js';
import type { StoredCage } from './files.js';

/** Writes a cage for three.js to build/cages/glb. @returns the file's path. */
export async function writeCageGlb(
  name: string,
  { positions, uvs, indices }: Pick<StoredCage, 'positions' | 'uvs' | 'indices'>,
): Promise<string> {
  const document = new Document();
  const buffer = document.createBuffer();
  const accessor = (array: Float32Array<ArrayBuffer> | Uint32Array<ArrayBuffer>, type: 'VEC3' | 'VEC2' | 'SCALAR') =>
    document.createAccessor().setBuffer(buffer).setArray(array).setType(type);
  const primitive = document
    .createPrimitive()
    .setAttribute('POSITION', accessor(Float32Array.from(positions), 'VEC3'))
    .setAttribute('TEXCOORD_0', accessor(Float32Array.from(uvs), 'VEC2'))
    .setIndices(accessor(Uint32Array.from(indices), 'SCALAR'));
  const node = document.createNode('cage').setMesh(document.createMesh('cage').addPrimitive(primitive));
  document.createScene().addChild(node);
  mkdirSync(`${cagesFolder}/glb`, { recursive: true });
  const file = `${cagesFolder}/glb/${name}.glb`;
  writeFileSync(file, await new NodeIO().writeBinary(document));
  return file;
}
