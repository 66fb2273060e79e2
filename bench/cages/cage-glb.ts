import { mkdirSync, writeFileSync } from 'node:fs';
import { cageGlb } from 'cagecast/cages';
import { cagesFolder } from './figures.js';
import type { StoredCage } from './files.js';

/** Writes a cage for three.js to build/cages/glb. @returns the file's path. */
export function writeCageGlb(
  name: string,
  { positions, uvs, indices }: Pick<StoredCage, 'positions' | 'uvs' | 'indices'>,
): string {
  mkdirSync(`${cagesFolder}/glb`, { recursive: true });
  const file = `${cagesFolder}/glb/${name}.glb`;
  const arrays = {
    positions: Float32Array.from(positions),
    uvs: Float32Array.from(uvs),
    indices: Uint32Array.from(indices),
  };
  writeFileSync(file, cageGlb(arrays));
  return file;
}
