/**
 * Cagecast for three.js: adds UVs, zones and a painted overlay to the meshes of a loaded model; and the functions of
 * `cagecast/cages` for loaded models.
 * @module cagecast/three
 */
import { BufferAttribute, type BufferGeometry, type Material, type Mesh, type Object3D, type Texture } from 'three';
import {
  type Mesh as Arrays,
  CagecastError,
  type Classification,
  type CutTarget,
  cutBorders,
  type TransferOptions,
  type TransferResult,
  transfer,
} from '../index.js';
import { type Borders, isCut } from '../parts/borders-option.js';
import { type CutPart, decideAgain } from '../parts/cut-part.js';
import { type SplitPart, splitPart } from '../parts/split-part.js';
import { cutGeometry, type PartRange } from './cut.js';
import { type Extracted, extract, isTurned, nameOf, type Part, placeOf } from './extract.js';
import { layOnSurface, makeOverlay, paintMaterial, showTriangles } from './overlay.js';
import { splitGeometry } from './split.js';

export {
  cageGeometry,
  cageModel,
  cageTemplate,
  findLandmarks,
  fitCage,
  type Loaded,
  type LoadedGltf,
  makeCage,
  refineCage,
} from './loaded-cages.js';
export {
  type Borders,
  type CutPart,
  cutGeometry,
  decideAgain,
  type Extracted,
  extract,
  type Part,
  type PartRange,
  placeOf,
  type SplitPart,
};

/** The attribute with the `Zone` of each vertex. GLTFLoader gives `_NCZ` the same name. */
export const zoneAttribute = '_ncz';

/** Options of `applyTransfer`: those of `transfer`, and what to display. */
export interface ApplyOptions extends TransferOptions {
  /** A result of `transfer`, also from `cagecast/worker`, for the arrays that `extract` returned for `cage` and `target`. */
  result?: TransferResult | undefined;
  /** The paint, in the cage's UV space, shown as an overlay on the cosmetic triangles. Its `channel` is set, its `flipY` is not. */
  texture?: Texture | undefined;
  /** The material of the overlays. Default: one that shows `texture` with the gloss and relief of the material below it. */
  material?: Material | undefined;
  /**
   * The channel of the new UVs, 1 to 3: the attribute `uv1`, `uv2` or `uv3`, which is overwritten. Default: the lowest that no
   * geometry uses already. `texture.channel` is set to it.
   */
  channel?: 1 | 2 | 3 | undefined;
  /**
   * Where the paint ends: at existing triangle edges (`triangle`, the default), or exactly at holes and seams, where triangles are
   * then cut (`cut`): smooth borders, but more triangles.
   */
  borders?: Borders | undefined;
}

/** What was added to a scene. */
export interface Applied {
  /** The result for the original vertices of the target. */
  result: TransferResult;
  /** The number of vertices added because triangles at the same vertex need different UVs; 0 with `seams: 'vertex'`. */
  splitVertices: number;
  /** The number of triangles added by cutting borders. */
  cutTriangles: number;
  parts: Part[];
  /** With a texture or a material: one overlay for each part that is a mesh, as a child of that mesh. */
  overlays: Mesh[];
  /**
   * Shows another classification, in microseconds. If borders were cut, segments whose verdict has changed are painted by whole
   * triangles. The classification is not kept, so the next `classify` may overwrite it (`reuse`); it must not overwrite `result`.
   * @throws {CagecastError} `badArgument` if the classification is of another target.
   */
  update(classification: Classification): void;
  /** Removes the overlays and frees their buffers. The new attributes stay. */
  dispose(): void;
}

/**
 * Transfers a cage's UVs to the meshes of a scene. Each geometry gets the attributes `uv1` (2 per vertex; `uv2` or `uv3` if some
 * geometry uses `uv1` already) and `_ncz` (the `Zone`: 0 may be painted). With a texture, each mesh gets a child that shows the
 * texture on the cosmetic triangles.
 *
 * Skins and morph targets keep working, because the overlays share them. If several meshes share a geometry, all but the first get
 * a copy. If triangles at the same vertex need different UVs, copies of the vertex, with all attributes and morph deltas, are added
 * after the existing vertices. Cut borders add vertices that blend existing ones.
 *
 * Call `await init()` once before. To keep the main thread free, use `extract`, `cagecast/worker` and the option `result` instead.
 *
 * @param target  A loaded scene, a mesh, or a geometry (which gets the attributes, but no overlay).
 * @param cage    Of the same types, with the attribute `uv`, and in the same space as the target.
 * @throws {CagecastError} as `transfer` does, and if a part cannot be read.
 *
 * @example
 * import { init } from 'cagecast';
 * import { applyTransfer } from 'cagecast/three';
 *
 * await init();
 * const [head, cage] = await Promise.all(['head.glb', 'cage.glb'].map((url) => loader.loadAsync(url)));
 * const paint = await new TextureLoader().loadAsync('paint.png');
 * paint.flipY = false; // as for all textures of glTF
 * paint.colorSpace = SRGBColorSpace;
 * applyTransfer(head.scene, cage.scene, { texture: paint });
 * scene.add(head.scene);
 */
export function applyTransfer(
  target: Object3D | BufferGeometry,
  cage: Object3D | BufferGeometry,
  options: ApplyOptions = {},
): Applied {
  checkOptions(options);
  const extracted = extract(target, 'target');
  if (!isCut('applyTransfer', options.borders)) {
    return apply(
      extracted,
      resultOf(extracted, options, () => extract(cage, 'cage').mesh),
      options,
    );
  }
  const { mesh } = extract(cage, 'cage');
  const result = resultOf(extracted, options, () => mesh);
  return apply(extracted, result, options, cutBorders(mesh, extracted.mesh, result, rulesOf(options)));
}

const rulesOf = ({ result, texture, material, channel, borders, ...rules }: ApplyOptions): TransferOptions => rules;

function resultOf({ mesh }: Extracted, options: ApplyOptions, cage: () => Arrays): TransferResult {
  if (options.result === undefined) return transfer(cage(), mesh, rulesOf(options));
  const { result } = options;
  const [vertices, triangles] = [mesh.positions.length / 3, mesh.indices.length / 3];
  const hint = '; extract it before vertices are split';
  const cornerUvs = result?.cornerUvs?.length === 0 ? 0 : 6 * triangles;
  checkLengths(
    'options.result',
    result,
    {
      zones: vertices,
      cosmeticTriangles: triangles,
      uvs: 2 * vertices,
      cornerUvs,
      segments: vertices,
      segmentStats: result?.segmentStats?.length ?? 1,
    },
    hint,
  );
  return result;
}

/** Checks by the lengths of its arrays that an argument belongs to this target. */
function checkLengths(name: string, given: object, lengths: Record<string, number>, hint = ''): void {
  for (const [field, length] of Object.entries(lengths)) {
    const found = (given as Record<string, ArrayLike<unknown> | undefined> | null)?.[field]?.length;
    if (found !== length)
      throw new CagecastError(
        'badArgument',
        `cagecast/three: ${name}.${field} ${found === undefined ? 'is not an array' : `has ${found} entries`}, the target needs ${length}${hint}`,
      );
  }
}

/** The channels that earlier transfers added to geometries, to be overwritten by the next one. */
const givenChannels = new WeakMap<BufferGeometry, number>();

function freeChannel(parts: readonly Part[]): 1 | 2 | 3 {
  const free = ([1, 2, 3] as const).find((channel) =>
    parts.every(({ geometry }) => givenChannels.get(geometry) === channel || !geometry.hasAttribute(`uv${channel}`)),
  );
  if (free === undefined)
    throw new CagecastError(
      'badArgument',
      'cagecast/three: target has uv1, uv2 and uv3 of its own; choose the one to overwrite with options.channel',
    );
  return free;
}

/** @param cut  The target as it was cut. */
function apply(
  { mesh, parts }: Extracted,
  result: TransferResult,
  { texture, material, channel = freeChannel(parts) }: ApplyOptions,
  cut?: CutTarget,
): Applied {
  const uvName = `uv${channel}`;
  const taken = new Set<BufferGeometry>();
  for (const part of parts) {
    if (part.mesh && taken.has(part.geometry)) part.mesh.geometry = part.geometry = part.geometry.clone();
    taken.add(part.geometry);
  }
  const made = parts.map((part) => {
    const { geometry, matrix, vertexCount, triangleCount } = part;
    const localIndices = geometry.index?.array ?? Uint32Array.from({ length: vertexCount }, (_, v) => v);
    const whole = { ...part, turned: isTurned(matrix), localIndices: localIndices.subarray(0, 3 * triangleCount) };
    const { pieces, split } = cut
      ? cutGeometry(geometry, whole, cut, mesh.positions.length / 3)
      : { pieces: undefined, split: splitPart(whole, result) };
    if (!pieces && split.copies > 0) splitGeometry(geometry, split);
    geometry.setAttribute(uvName, new BufferAttribute(split.uvs, 2));
    givenChannels.set(geometry, channel);
    geometry.setAttribute(zoneAttribute, new BufferAttribute(new Float32Array(split.sources.length), 1));
    return { part, whole, pieces, split };
  });

  if (texture) texture.channel = channel;
  const own: Material[] = [];
  const layers = made.map(({ part }) => {
    if (!part.mesh || !(texture || material)) return undefined;
    const paint = material ?? paintMaterial([part.mesh.material].flat()[0], texture!);
    if (paint !== material) {
      layOnSurface(paint);
      own.push(paint);
    }
    return makeOverlay(part, part.mesh, uvName, paint);
  });
  const culled = result.segmentStats.map((segment) => segment.culled);
  const show = (now: Classification) => {
    const isOther = cut && Uint8Array.from(result.segments, (s) => Number(now.segmentStats[s]!.culled !== culled[s]));
    made.forEach(({ part, whole, pieces, split }, p) => {
      const { firstVertex, firstTriangle, triangleCount, vertexCount } = part;
      const { zones, cosmeticTriangles } = pieces
        ? decideAgain(pieces, whole, mesh.indices, isOther!, now)
        : {
            zones: now.zones.subarray(firstVertex, firstVertex + vertexCount),
            cosmeticTriangles: now.cosmeticTriangles.subarray(firstTriangle, firstTriangle + triangleCount),
          };
      const attribute = part.geometry.getAttribute(zoneAttribute) as BufferAttribute;
      split.sources.forEach((source, v) => (attribute.array[v] = zones[source]!));
      attribute.needsUpdate = true;
      const overlay = layers[p];
      if (overlay) showTriangles(overlay, part, cosmeticTriangles);
    });
  };
  show(result);
  layers.forEach((overlay, p) => overlay && parts[p]!.mesh!.add(overlay));
  const overlays = layers.filter((overlay) => overlay !== undefined);
  return {
    result,
    splitVertices: made.reduce((sum, { split }) => sum + split.copies, 0),
    cutTriangles: cut ? (cut.indices.length - mesh.indices.length) / 3 : 0,
    parts,
    overlays,
    update(classification) {
      checkLengths('classification', classification, {
        zones: result.zones.length,
        cosmeticTriangles: result.cosmeticTriangles.length,
        segmentStats: culled.length,
      });
      show(classification);
    },
    dispose() {
      for (const overlay of overlays) {
        overlay.removeFromParent();
        // Disposing a geometry frees the buffers of all its attributes, but these belong to the model.
        for (const name of Object.keys(overlay.geometry.attributes)) overlay.geometry.deleteAttribute(name);
        overlay.geometry.dispose();
      }
      for (const paint of own) paint.dispose();
    },
  };
}

function checkOptions(options: ApplyOptions): void {
  const check = (fits: boolean | undefined, name: string, value: unknown, what: string) => {
    if (!fits) throw new CagecastError('badOption', `cagecast/three: options${name} is ${nameOf(value)}, not ${what}`);
  };
  check(typeof options === 'object' && options !== null, '', options, 'an object');
  const { texture, material, channel = 1 } = options;
  check(!texture || texture.isTexture, '.texture', texture, 'a Texture');
  check(!material || material.isMaterial, '.material', material, 'a Material');
  check([1, 2, 3].includes(channel), '.channel', channel, '1, 2 or 3');
}
