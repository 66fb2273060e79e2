import type { Mesh, TransferOptions } from '../../api/index.js';
import { faultOfNames, optionNames } from '../../api/option-names.js';
import { faultOfParts, type Parts } from '../../api/parts.js';
import { mostTexels } from '../../bake/image.js';
import type { CageCallOptions, Choice, Fit, Landmarks, TemplateName, Tried } from '../../cages/index.js';
import type { Cage, Template } from '../../cages/types.js';
import { CagecastError, type Code, show } from '../../core/error.js';
import { plainArray } from '../../core/typed-arrays.js';
import { type Finding, kVerdicts, type Verdict } from '../../inspect/finding.js';
import { type Borders, isCut } from '../../parts/cut-part.js';
import type { ImageCodec } from '../../scene/materials.js';
import { isUvSetNumber, uvSetNumberText } from '../../scene/uv-sets.js';
import type { BakeReport } from '../bake/plan.js';
import type { MeshoptDecoder } from '../decoders.js';
import type { SavedLayers } from '../look/saved-layers.js';

/** Options of `paintGlb`: those of `transfer`, and what to paint. Of `cage` and `template`, one is needed. */
export interface PaintOptions
  extends Omit<TransferOptions, 'parts' | 'locks' | 'masks'>,
    Pick<CageCallOptions, 'signal' | 'onProgress'> {
  /**
   * The image that was drawn in the cage's UVs: the bytes of a PNG, JPEG, WebP or KTX2 file. With `template: 'auto'` also a function of
   * what was chosen, as each template has a paint of its own.
   */
  texture?: Uint8Array | ((template: Choice['template'], cage: Cage) => Uint8Array | Promise<Uint8Array>) | undefined;
  /**
   * Instead of a texture: what `save` of layers of `cagecast/three` returned. All that three.js shows of them is drawn into the textures of
   * the model's own materials: colours, base tint, roughness, metalness, glow and relief. Parts whose textures cannot hold it show it in
   * the cage's UVs, by a copy of their material and an overlay.
   */
  look?: SavedLayers | undefined;
  /** The longer side of textures that show a look, in texels, 1 to 8192. Default: as before; 1024 for those that a material lacks. */
  size?: number | undefined;
  /** The cage in its place around the model, with UVs: the bytes of a GLB, or a mesh, such as a `Cage`, in the space of the model's scene. */
  cage?: Uint8Array | Mesh | undefined;
  /**
   * The number of the cage's UV set that the texture was drawn in, from 0. Default: that of the cage's own base colour texture, else the
   * first; where another set differs and nothing tells, the finding `uvsUnknown` says so.
   */
  cageUvs?: number | undefined;
  /**
   * A cage that is fitted to the model first: the name of a template of the package, whose file is loaded, the bytes of a GLB, or a
   * `Template`. `auto`: what `chooseCage` of `cagecast/cages` chooses.
   */
  template?: TemplateName | 'auto' | Uint8Array | Template | undefined;
  /** The worst verdict that is painted; with a worse one, `paintGlb` rejects with `badModel`. Default: `unfit`. */
  atLeast?: Verdict | undefined;
  /** Spots of the model for the fit, in the space of its scene; they override those that are found. Default: none. */
  landmarks?: Landmarks | undefined;
  /**
   * Decodes an image: of the model for the fit, to find a face that is only painted; one with alpha, to leave out parts that it makes
   * invisible; a texture with alpha, to find where it is opaque: there the overlay is drawn as the surface itself, so that transparent
   * hair before it stays before it; and all for a look. Rejected images are left out. Default: the browser's own; other hosts look at no
   * colours or alpha of the model, blend all of a texture with alpha, and read PNGs for a look.
   */
  decode?: ImageCodec['decode'] | undefined;
  /** Writes the model's textures with a look. Default: PNGs, as all that overlays show. */
  encode?: ImageCodec['encode'] | undefined;
  /**
   * Decoders of compressed geometry: `MeshoptDecoder` of `meshoptimizer`, and what `createDecoderModule` of `draco3dgltf` makes. What they
   * decode is written without compression. Default: meshopt's own, which compiles WebAssembly, and none of Draco.
   */
  decoders?: { meshopt?: MeshoptDecoder | undefined; draco?: object | undefined } | undefined;
  /** Where the paint ends: at existing triangle edges (`triangle`, the default), or exactly at holes and seams, where triangles are cut (`cut`). */
  borders?: Borders | undefined;
  /**
   * What counts, by the names of nodes, meshes and materials. What a viewer does not draw is ignored, and so are cages, markers and
   * collision shapes; glasses, hats, weapons and what the cage was made without are excluded, by their names; unless `keep` names them.
   */
  parts?: Parts | undefined;
  /** Whether every primitive also gets the cage's UVs and `_NCZ` as attributes, for programs that read them. Default: false. */
  attributes?: boolean | undefined;
}

const kOptions = [
  ...[
    'texture',
    'cage',
    'cageUvs',
    'template',
    'atLeast',
    'landmarks',
    'decode',
    'decoders',
    'borders',
    'attributes',
    'look',
    'size',
    'encode',
    'signal',
    'onProgress',
  ],
  ...optionNames('transfer').filter((name) => !['locks', 'masks', 'reuse'].includes(name)),
];

/** What `paintGlb` made. */
export interface PaintedGlb {
  /** The painted file: a GLB, or the VRM that it was. */
  bytes: Uint8Array;
  /** Triangles of the model as it was, and how many of them are painted. */
  triangles: { painted: number; total: number };
  /** Why nothing, or less than 5 % of what the cage covers, is painted, and what helps. */
  note: string | undefined;
  /** Names of the parts that stay bare because of their names: glasses, hats, and what the cage was made without. */
  bare: string[];
  /** With a look: the parts whose own textures cannot hold it, and why. */
  left: BakeReport['left'];
  /** With a look: the materials whose textures are moved while they are shown, and by what; the paint moves, too. */
  moving: BakeReport['moving'];
  /** Whether the cage fits, as `inspect` says it, and what was found, the most severe first. */
  verdict: Verdict;
  findings: Finding[];
  /** The cage of a template, in the space of the model's scene: it can be given as `cage` the next time. */
  cage: Cage | undefined;
  /** The fit, if there was one. */
  fit: Fit | undefined;
  /** With `template: 'auto'`, what was chosen, and all that was tried. */
  template: Choice['template'] | undefined;
  tried: Tried[] | undefined;
}

/** Checks options together, and the types of those that nothing else checks. @throws {CagecastError} */
export function checkOptions(given: PaintOptions): void {
  const fault = faultOfNames('paintGlb', 'options', given, kOptions) ?? faultOfParts('paintGlb', given.parts);
  if (fault !== undefined) throw new CagecastError('badOption', 'paintGlb', fault);
  const { texture, look, cage, template, size, cageUvs, ...options } = given;
  const { atLeast = 'unfit', attributes = false, decoders, borders } = options;
  if (typeof attributes !== 'boolean') throw wrong('options.attributes', attributes, 'true or false', 'badOption');
  if (!kVerdicts.includes(atLeast))
    throw wrong('options.atLeast', atLeast, `one of ${kVerdicts.join(', ')}`, 'badOption');
  refuseBoth('cage', cage, 'template', template);
  refuseBoth('texture', texture, 'look', look);
  for (const name of ['decode', 'encode'] as const)
    if (options[name] !== undefined && typeof options[name] !== 'function')
      throw wrong(`options.${name}`, options[name], 'a function', 'badOption');
  if (size !== undefined && !(Number.isInteger(size) && size > 0 && size <= mostTexels))
    throw wrong('options.size', size, `a whole number of texels from 1 to ${mostTexels}`, 'badOption');
  if (decoders !== undefined && (typeof decoders !== 'object' || decoders === null))
    throw wrong('options.decoders', decoders, 'an object', 'badOption');
  if (cageUvs !== undefined && !isUvSetNumber(cageUvs))
    throw wrong('options.cageUvs', cageUvs, uvSetNumberText, 'badOption');
  if (cageUvs !== undefined && !plainArray(cage, 'Uint8Array')) throw needs('cageUvs', 'a cage that is a file');
  for (const [name, value] of Object.entries({ size, encode: options.encode }))
    if (value !== undefined && look === undefined) throw needs(name, 'a look');
  isCut('paintGlb', borders);
}

/** The error of an option that says something of what is not given. */
const needs = (name: string, what: string) =>
  new CagecastError('badOption', 'paintGlb', `options.${name} is for ${what}; leave it out without one`, {
    argument: name,
  });

/** @throws {CagecastError} `badArgument` unless one of two is given. */
function refuseBoth(name: string, one: unknown, otherName: string, other: unknown): void {
  if ((one === undefined) !== (other === undefined)) return;
  const what = one === undefined ? `neither ${name} nor ${otherName} is` : `${name} and ${otherName} are both`;
  throw new CagecastError('badArgument', 'paintGlb', `${what} given; one of them is needed`, { argument: name });
}

/** Bytes of any realm. @throws {CagecastError} */
export function bytesOf(name: string, value: unknown): Uint8Array {
  const bytes = plainArray(value, 'Uint8Array');
  if (!bytes) throw wrong(name, value, 'a Uint8Array');
  return bytes;
}

/** The error of a wrong value. @param type  What it has to be. */
export const wrong = (name: string, value: unknown, type: string, code: Code = 'badArgument') =>
  new CagecastError(code, 'paintGlb', `${name} is ${show(value)}, not ${type}`, {
    argument: name.split('.')[0],
  });
