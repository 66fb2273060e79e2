/**
 * Cagecast for three.js: a loaded model in, its meshes with new UVs, zones and a cosmetic overlay out.
 * @module cagecast/three
 */
import { BufferAttribute, Mesh, type BufferGeometry, type Material, type Object3D, type Texture } from 'three';
import { CagecastError, transfer, type Classification, type TransferOptions, type TransferResult } from '../index.js';
import { splitPart } from '../split-part.js';
import { extract, isTurned, type Extracted, type Part } from './extract.js';
import { layOnSurface, makeOverlay, paintMaterial, showTriangles } from './overlay.js';
import { splitGeometry } from './split.js';

export { extract, type Extracted, type Part };

/** The attribute that holds each vertex's `Zone`: the name that GLTFLoader gives to `_NCZ`. */
export const zoneAttribute = '_ncz';

/** Options of `applyTransfer`: those of `transfer`, and what to show. */
export interface ApplyOptions extends TransferOptions {
  /** What `transfer` or `cagecast/worker` gave for the meshes that `extract` made of `cage` and `target`, if that is done already. */
  result?: TransferResult | undefined;
  /** The paint, in the cage's UVs: shown as an overlay of the cosmetic triangles. Its `channel` and `flipY` are left alone unless `uv` says otherwise. */
  texture?: Texture | undefined;
  /** The material of the overlays, in place of one that shows `texture` with the gloss and relief of what it lies on. */
  material?: Material | undefined;
  /** The channel of the new UVs, 1 … 3: the attribute `uv1`, `uv2` or `uv3`; 1 by default. `texture.channel` is set to it. */
  channel?: 1 | 2 | 3 | undefined;
}

/** What was added to a scene. */
export interface Applied {
  /** For the vertices that the target had. */
  result: TransferResult;
  /** How many vertices were added because triangles that share one have different UVs there; 0 with `seams: 'vertex'`. */
  splitVertices: number;
  parts: Part[];
  /** One for each part that is a mesh, with a texture or a material; children of the meshes they lie on. */
  overlays: Mesh[];
  /** Shows another decision of `classify`, in microseconds. */
  update(classification: Pick<Classification, 'zones' | 'cosmeticTriangles'>): void;
  /** Takes the overlays away and frees their buffers. The new attributes stay. */
  dispose(): void;
}

/**
 * Carries a cage's UVs to the meshes of a scene: each geometry gets the attributes `uv1` (2 per vertex) and `_ncz` (the
 * `Zone`: 0 may be painted), and, with a texture, each mesh a child that shows the texture on the cosmetic triangles.
 * Skins and morph targets keep working: the overlays share them. A geometry that several meshes show is copied for all but
 * the first. Where triangles that share a vertex have different UVs there, the geometry gets copies of it after the vertices
 * that it has, with all of its attributes and morph deltas, so that no triangle stretches across the texture.
 *
 * `await init()` once before; or leave the main thread free with `extract`, `cagecast/worker` and the option `result`.
 *
 * @param target  A loaded scene, a mesh, or a geometry (which gets the attributes, but no overlay).
 * @param cage    The same, with the attribute `uv`; in the same space as the target.
 * @throws {CagecastError} as `transfer` does, and for parts that cannot be read.
 *
 * @example
 * import { init } from 'cagecast';
 * import { applyTransfer } from 'cagecast/three';
 *
 * await init();
 * const [head, cage] = await Promise.all(['head.glb', 'cage.glb'].map((url) => loader.loadAsync(url)));
 * const paint = await new TextureLoader().loadAsync('paint.png');
 * paint.flipY = false; // as all textures of glTF
 * paint.colorSpace = SRGBColorSpace;
 * applyTransfer(head.scene, cage.scene, { texture: paint });
 * scene.add(head.scene);
 */
export function applyTransfer(
  target: Object3D | BufferGeometry,
  cage: Object3D | BufferGeometry,
  { result: known, texture, material, channel = 1, ...options }: ApplyOptions = {},
): Applied {
  const { mesh, parts } = extract(target, 'target');
  const result = known ?? transfer(extract(cage, 'cage').mesh, mesh, options);
  const vertices = mesh.positions.length / 3;
  if (result.zones.length !== vertices || result.cosmeticTriangles.length !== mesh.indices.length / 3) {
    throw new CagecastError('badArgument', `cagecast/three: result is of ${result.zones.length} vertices, the target has ${vertices}: extract it before vertices are split`);
  }
  const uvName = `uv${channel}`;
  const taken = new Set<BufferGeometry>();
  for (const part of parts) {
    if (part.mesh && taken.has(part.geometry)) part.mesh.geometry = part.geometry = part.geometry.clone();
    taken.add(part.geometry);
  }
  const splits = parts.map((part) => {
    const { geometry, matrix, vertexCount, triangleCount } = part;
    const localIndices = geometry.index?.array ?? Uint32Array.from({ length: vertexCount }, (_, v) => v);
    const split = splitPart({ ...part, turned: isTurned(matrix), localIndices: localIndices.subarray(0, 3 * triangleCount) }, result);
    if (split.copies > 0) splitGeometry(geometry, split);
    geometry.setAttribute(uvName, new BufferAttribute(split.uvs, 2));
    geometry.setAttribute(zoneAttribute, new BufferAttribute(new Float32Array(split.sources.length), 1));
    return split;
  });

  if (texture) texture.channel = channel;
  const own: Material[] = [];
  const layers: { overlay: Mesh; part: Part }[] = [];
  for (const part of texture || material ? parts : []) {
    if (!part.mesh) continue;
    const paint = material ?? paintMaterial([part.mesh.material].flat()[0], texture!);
    if (paint !== material) {
      layOnSurface(paint);
      own.push(paint);
    }
    layers.push({ overlay: makeOverlay(part, part.mesh, uvName, paint), part });
  }
  const update: Applied['update'] = ({ zones, cosmeticTriangles }) => {
    parts.forEach(({ geometry, firstVertex }, p) => {
      const attribute = geometry.getAttribute(zoneAttribute) as BufferAttribute;
      splits[p]!.sources.forEach((source, v) => (attribute.array[v] = zones[firstVertex + source]!));
      attribute.needsUpdate = true;
    });
    for (const { overlay, part } of layers) {
      showTriangles(overlay, part, cosmeticTriangles.subarray(part.firstTriangle, part.firstTriangle + part.triangleCount));
    }
  };
  update(result);
  for (const { overlay, part } of layers) part.mesh!.add(overlay);
  return {
    result,
    splitVertices: splits.reduce((sum, { copies }) => sum + copies, 0),
    parts,
    overlays: layers.map(({ overlay }) => overlay),
    update,
    dispose() {
      for (const { overlay } of layers) {
        overlay.removeFromParent();
        overlay.geometry.dispose();
      }
      for (const paint of own) paint.dispose();
    },
  };
}
