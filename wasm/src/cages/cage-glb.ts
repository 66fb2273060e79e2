import { CagecastError, show } from '../core/error.js';
import { boxOf, type Vector } from '../inspect/geometry.js';
import { packGlb } from '../parts/glb.js';
import type { Cage, Template } from './types.js';

/** What a GLB's node has in its `extras` if its mesh is a cage, as `cageGlb` writes it: docs/cages.md describes the format. */
type CageExtras = Pick<Cage, 'landmarks' | 'holes' | 'kind' | 'regions' | 'bare'>;

/**
 * Writes a cage as a GLB file: one node named `cage`, with landmarks, holes, kind, regions and names of bare parts in its `extras`. So it is a template for fits.
 * @param cage  `landmarks`, `holes`, `kind`, `regions` and `bare` may be missing. `origin` is where its origin is in the scene of its model, if elsewhere.
 * @throws {CagecastError} `badArgument` if positions, UVs or indices are not of the right type.
 */
export function cageGlb(
  cage: Pick<Template, 'positions' | 'uvs' | 'indices'> & Partial<CageExtras> & { origin?: Vector },
): Uint8Array<ArrayBuffer> {
  const { positions, uvs, indices, landmarks = {}, holes = {}, kind = 'automatic', regions, bare, origin } = cage;
  const types = {
    positions: ['Float32Array'],
    uvs: ['Float32Array'],
    indices: ['Uint32Array', 'Uint16Array', 'Uint8Array'],
  };
  for (const [name, known] of Object.entries(types) as [keyof typeof types, string[]][])
    if (!known.includes(Object.prototype.toString.call(cage[name]).slice(8, -1)))
      throw new CagecastError('badArgument', 'cageGlb', `cage.${name} is ${show(cage[name])}, not a ${known[0]}`, {
        argument: 'cage',
      });
  const { min, max } = boxOf(positions);
  const arrays = [positions, uvs, indices instanceof Uint32Array ? indices : Uint32Array.from(indices)];
  let end = 0;
  const bufferViews = arrays.map(({ byteLength }, a) => {
    const byteOffset = end;
    end += byteLength;
    return { buffer: 0, byteOffset, byteLength, target: a < 2 ? 34962 : 34963 };
  });
  const json = {
    asset: { version: '2.0', generator: `Cagecast ${CAGECAST_VERSION}` },
    scene: 0,
    scenes: [{ nodes: [0] }],
    nodes: [
      {
        name: 'cage',
        mesh: 0,
        ...(origin?.some((x) => x !== 0) && { translation: origin }),
        extras: { landmarks, holes, kind, ...(regions && { regions }), ...(bare && { bare }) } satisfies CageExtras,
      },
    ],
    meshes: [{ name: 'cage', primitives: [{ attributes: { POSITION: 0, TEXCOORD_0: 1 }, indices: 2 }] }],
    accessors: [
      { bufferView: 0, componentType: 5126, count: positions.length / 3, type: 'VEC3', min, max },
      { bufferView: 1, componentType: 5126, count: uvs.length / 2, type: 'VEC2' },
      { bufferView: 2, componentType: 5125, count: indices.length, type: 'SCALAR' },
    ],
    bufferViews,
    buffers: [{ byteLength: end }],
  };
  return packGlb(
    json,
    arrays.map(({ buffer, byteOffset, byteLength }) => new Uint8Array(buffer, byteOffset, byteLength)),
  );
}
