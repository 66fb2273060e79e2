/**
 * Cagecast for three.js: a loaded model in, its meshes with new UVs, zones and a cosmetic overlay out.
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
  /**
   * The channel of the new UVs, 1 … 3: the attribute `uv1`, `uv2` or `uv3`, which is overwritten; by default the lowest that no geometry
   * has of its own. `texture.channel` is set to it.
   */
  channel?: 1 | 2 | 3 | undefined;
  /**
   * Lets paint end at the target's own triangles (`triangle`, by default), or cuts these where it does, at holes and seams (`cut`):
   * straight borders, more triangles.
   */
  borders?: Borders | undefined;
}

/** What was added to a scene. */
export interface Applied {
  /** For the vertices that the target had. */
  result: TransferResult;
  /** How many vertices were added because triangles that share one have different UVs there; 0 with `seams: 'vertex'`. */
  splitVertices: number;
  /** How many triangles there are more since borders were cut. */
  cutTriangles: number;
  parts: Part[];
  /** One for each part that is a mesh, with a texture or a material; children of the meshes they lie on. */
  overlays: Mesh[];
  /**
   * Shows another decision of `classify`, in microseconds. Where borders were cut, a segment that has another verdict now ends at its
   * own triangles. Nothing of the decision is kept: the next `classify` may have it as `into`, as it may not have `result`.
   * @throws {CagecastError} `badArgument` if it is of another target.
   */
  update(classification: Classification): void;
  /** Takes the overlays away and frees their buffers. The new attributes stay. */
  dispose(): void;
}

/**
 * Carries a cage's UVs to the meshes of a scene: each geometry gets the attributes `uv1` (2 per vertex; `uv2` or `uv3` if some
 * have one of their own) and `_ncz` (the `Zone`: 0 may be painted), and, with a texture, each mesh a child that shows the texture
 * on the cosmetic triangles.
 * Skins and morph targets keep working: the overlays share them. A geometry that several meshes show is copied for all but
 * the first. Where triangles that share a vertex have different UVs there, the geometry gets copies of it after the vertices
 * that it has, with all of its attributes and morph deltas, so that no triangle stretches across the texture. Where borders are
 * cut, it gets vertices that are blends of others.
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

/** Checks that what is given is of this target: by how long its lists are. */
function checkLengths(name: string, given: object, lengths: Record<string, number>, hint = ''): void {
  for (const [field, length] of Object.entries(lengths)) {
    const found = (given as Record<string, ArrayLike<unknown> | undefined> | null)?.[field]?.length;
    if (found !== length)
      throw new CagecastError(
        'badArgument',
        `cagecast/three: ${name}.${field} ${found === undefined ? 'is no list' : `has ${found} entries`}, the target needs ${length}${hint}`,
      );
  }
}

/** What was given to geometries before, to be overwritten by the next transfer. */
const givenChannels = new WeakMap<BufferGeometry, number>();

function freeChannel(parts: readonly Part[]): 1 | 2 | 3 {
  const free = ([1, 2, 3] as const).find((channel) =>
    parts.every(({ geometry }) => givenChannels.get(geometry) === channel || !geometry.hasAttribute(`uv${channel}`)),
  );
  if (free === undefined)
    throw new CagecastError(
      'badArgument',
      'cagecast/three: target has uv1, uv2 and uv3 of its own; say by options.channel which of them is to go',
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
        // The renderer frees the buffers of all attributes of what goes, whoever else uses them: these are the model's.
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
