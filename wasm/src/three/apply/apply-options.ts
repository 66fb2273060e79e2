import type { Material, Mesh, Texture } from 'three';
import type { Classification, TransferOptions, TransferResult } from '../../api/index.js';
import { optionNames } from '../../api/option-names.js';
import type { Parts } from '../../api/parts.js';
import type { Borders } from '../../parts/cut-part.js';
import type { Prepared } from '../../parts/prepare.js';
import { isUvSetNumber, uvSetNumberText } from '../../scene/uv-sets.js';
import { checkNames, checkParts, notA, wrong } from '../errors.js';
import type { Extracted, Part } from './extract-scene.js';
import { isModel, type LoadedCage } from './models.js';
import type { Calling } from './tasks.js';

/** A transfer that was made earlier, by `prepareTransfer` or as `deserialize` reads it, for `applyTransfer`. */
export interface Saved {
  /** Hashes of the target, the cage and the options, as hexadecimal digits. It is the same for the same three only. */
  key: string;
  prepared: Prepared;
}

/** Options of `applyTransfer`: those of `transfer`, and what to display. */
export interface ApplyOptions extends Omit<TransferOptions, 'parts'> {
  /**
   * The cage: what GLTFLoader loaded, a scene, a mesh or a geometry with the attribute `uv`, or a `Cage` or `Template` of
   * `cagecast/cages`, in the same space as the target. Default: the meshes of the target that are named as outer cages of others, as
   * `Head_OuterCage` of `Head_Geo`. Not needed with `saved`.
   */
  cage?: LoadedCage | undefined;
  /**
   * The number of the cage's UV set that the texture was drawn in: 0 is the attribute `uv`, 1 `uv1`. Default: that of the cage's own base
   * colour texture, else the first; where another set differs and nothing tells, `inspect` has the finding `uvsUnknown`.
   */
  cageUvs?: number | undefined;
  /**
   * A result of `transfer`, also from `cagecast/worker`, for the arrays that `extract` returned for cage and target. No transfer is
   * made, so the options of `transfer` count only where `borders` are cut, which needs the cage.
   */
  result?: TransferResult | undefined;
  /** What `prepareTransfer` or `deserialize` returned: instead of a transfer, whose options and `borders` it keeps. Needs neither a cage nor `init`. */
  saved?: Saved | undefined;
  /**
   * The paint, in the cage's UV space, mixed into the colour of the cosmetic triangles before they are lit. It is read, never
   * changed: its offset, repeat and rotation apply, its `channel` does not. Set its `flipY` to false, as for all textures of glTF.
   * Default: none, as null.
   */
  texture?: Texture | null | undefined;
  /** How much of the paint shows, 0 to 1. Default: 1. */
  opacity?: number | undefined;
  /**
   * The width of a soft border, inside the painted zone, as a share of the target's diagonal, 0 to 1. Default: 0. The edge of a mesh
   * is no border, nor is a seam of UVs. Cost: some milliseconds per 10,000 vertices. No effect on a `material`.
   */
  feather?: number | undefined;
  /**
   * A material to show on the cosmetic triangles instead of paint, as an overlay: a second mesh for each part. It finds the UVs in
   * the channel that `Applied` names. `texture` is not shown then. Default: none, as null.
   */
  material?: Material | null | undefined;
  /**
   * The channel of the new UVs, 1 to 3: the attribute `uv1`, `uv2` or `uv3`, which is overwritten. A transfer begins with the geometries
   * as they were before those that wrote its channel, and takes their place and that of later ones, so that others show beside it.
   * Default: the lowest that the model does not use itself, in the place of all earlier transfers; an error if all are in use.
   */
  channel?: 1 | 2 | 3 | undefined;
  /**
   * Where the paint ends: at existing triangle edges (`triangle`, the default), or exactly at holes and seams, where triangles are
   * then cut (`cut`): smooth borders, but more triangles.
   */
  borders?: Borders | undefined;
  /**
   * What counts, by the names of meshes, of the objects above them, and of materials. What three.js does not draw is ignored, and so are
   * cages, markers and collision shapes; glasses, hats, weapons and what the cage was made without are excluded, by their names; unless
   * `keep` names them.
   */
  parts?: Parts | undefined;
}

/**
 * What was added to a scene. Where a later transfer has taken its place, the methods change nothing.
 */
export interface Applied {
  /** The result for the original vertices of the target. */
  result: TransferResult;
  /**
   * Why nothing, or less than 5 % of what the cage covers, may be painted by the result, and what helps: a line for people. `undefined`
   * if more may. Cost, each time: some milliseconds per 100,000 triangles; up to a second if other parts hide the target.
   */
  readonly note: string | undefined;
  /**
   * The number of vertices added because triangles at the same vertex need different UVs, or because not all of them are painted.
   * Without a texture it is 0 with `seams: 'vertex'`.
   */
  splitVertices: number;
  /** The number of triangles added by cutting borders. */
  cutTriangles: number;
  /** The channel of the new UVs. */
  channel: 1 | 2 | 3;
  parts: Part[];
  /** The meshes that are left out, and why. */
  leftOut: Extracted['leftOut'];
  /**
   * With a texture: one for each part with a material that cannot be painted. With a material: one for each part. They are children
   * of the meshes below, and follow them; those without triangles are in no scene.
   */
  overlays: Mesh[];
  /**
   * Shows another texture in the next frame, or none (undefined or null). At no cost, but for the first texture since an
   * `applyTransfer` or `setClassification` without one: it costs about as much as that, and shaders are compiled for it. No effect where a
   * material is shown.
   * @throws {CagecastError} `badArgument` if it is not a texture.
   */
  setTexture(texture: Texture | null | undefined): void;
  /** Changes how much of the paint shows, 0 to 1. In the next frame, at no cost. @throws {CagecastError} `badArgument` */
  setOpacity(opacity: number): void;
  /**
   * Paints one more material, such as one that a mesh is given later. Materials that the meshes have at a call of `setClassification`
   * or `setTexture` are painted then.
   * @returns whether it can be painted; without a texture it will be with the first one.
   */
  paint(material: Material): boolean;
  /**
   * Shows another classification, as `classify` returns it for other options. If borders were cut, segments whose verdict has changed are painted by whole triangles. The
   * classification is not kept, so the next `classify` may overwrite it (`reuse`); it must not overwrite `result`.
   *
   * Cost: about 10 ms per 100,000 triangles; with `feather` more.
   * @throws {CagecastError} `badArgument` if the classification is of another target, or a geometry has changed since.
   */
  setClassification(classification: Classification): void;
  /**
   * Removes the paint and the overlays, and makes materials and geometries what they were. Geometries that are disposed of as well come
   * first, so that their buffers are freed at once.
   */
  dispose(): void;
}

/** The options that `transfer` does not have. */
const kOwnOptions = [
  'cage',
  'cageUvs',
  'texture',
  'opacity',
  'feather',
  'material',
  'channel',
  'borders',
  'parts',
  'result',
  'saved',
] satisfies (keyof ApplyOptions)[];
const kCalling = ['signal', 'onProgress'] satisfies (keyof Calling)[];

/** @throws {CagecastError} `badOption` that names the function, the option and its value. */
export function checkOptions(fn: string, options: ApplyOptions & Calling): void {
  if (isModel(options))
    throw wrong(`options is a model; give the cage as options.cage: ${fn}(target, { cage })`, fn, 'badOption');
  checkNames(fn, 'options', options, [
    ...kOwnOptions,
    ...(fn === 'applyTransfer' ? [] : kCalling),
    ...optionNames('transfer').filter((name) => name !== 'reuse'),
  ]);
  const check = (name: keyof typeof options, fits: unknown, what: string): void => {
    if (!fits) throw notA(what, `options.${name}`, options[name], fn, 'badOption');
  };
  const { texture, material, channel = 1, cageUvs, saved, parts, signal, onProgress } = options;
  check('texture', !texture || texture.isTexture, 'a Texture');
  check('material', !material || material.isMaterial, 'a Material');
  check('channel', [1, 2, 3].includes(channel), '1, 2 or 3');
  for (const name of ['opacity', 'feather'] as const) {
    const share = options[name] ?? 1;
    check(name, share >= 0 && share <= 1, 'a number from 0 to 1');
  }
  check('cageUvs', cageUvs === undefined || isUvSetNumber(cageUvs), uvSetNumberText);
  check('saved', !saved || typeof saved.key === 'string', 'what prepareTransfer or deserialize returned');
  checkParts(fn, parts);
  check('signal', signal == null || signal.throwIfAborted, 'an AbortSignal');
  check('onProgress', onProgress == null || typeof onProgress === 'function', 'a function');
}

/** The options of `transfer` among those of `applyTransfer`. */
export const transferOptions = (options: ApplyOptions): TransferOptions =>
  Object.fromEntries(Object.entries(options).filter(([name]) => !(kOwnOptions as string[]).includes(name)));

/** Checks by the lengths of its arrays that an argument belongs to this target. @throws {CagecastError} `badArgument` */
export function checkLengths(name: string, given: object | null, lengths: Record<string, number>, hint = ''): void {
  for (const [field, length] of Object.entries(lengths)) {
    const found = (given as Record<string, ArrayLike<unknown> | undefined> | null)?.[field]?.length;
    if (found !== length)
      throw wrong(
        `${name}.${field} ${found === undefined ? 'is not an array' : `has ${found} entries`}, the target needs ${length}${hint}`,
      );
  }
}
