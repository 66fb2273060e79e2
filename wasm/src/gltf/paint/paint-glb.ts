import type { Mesh, TransferOptions, TransferResult } from '../../api/index.js';
import { faultOfNames, optionNames } from '../../api/option-names.js';
import { faultOfParts, type Parts } from '../../api/parts.js';
import { cageGlb } from '../../cages/cage-glb.js';
import type { CageCallOptions, Choice, Fit, Landmarks, TemplateName, Tried } from '../../cages/index.js';
import { isTemplateName } from '../../cages/template-names.js';
import type { Cage, Template } from '../../cages/types.js';
import { CagecastError, type Code, show } from '../../core/error.js';
import { plainArray } from '../../core/typed-arrays.js';
import { noteOf } from '../../inspect/bare.js';
import { type Finding, isWorse, kVerdicts, type Verdict } from '../../inspect/finding.js';
import { type Borders, isCut } from '../../parts/cut-part.js';
import type { PartRange } from '../../parts/split-part.js';
import { extract, type Part } from '../../scene/extract.js';
import { InputError } from '../../scene/input-error.js';
import type { ImageCodec } from '../../scene/materials.js';
import { isMirrored } from '../../scene/matrix.js';
import { type Engine, engine } from '../../worker/engine.js';
import { dracoOf, meshoptView } from '../checks/check-geometry.js';
import type { MeshoptDecoder } from '../decoders.js';
import { hostDecode } from '../host-decode.js';
import { meshoptDecoder, started } from '../meshopt.js';
import { openGltf } from '../open-gltf.js';
import { type Paint, paintOf } from '../overlay.js';
import { bareParts, errorInFile, landmarksIn, movedApart, type ReadModel, turned, withUvs } from '../read-model.js';
import { writeTransfer } from '../write-transfer.js';
import { fitTo } from './fit.js';
import { opacityOf } from './opacity.js';

/** Options of `paintGlb`: those of `transfer`, and what to paint. Of `cage` and `template`, one is needed. */
export interface PaintOptions
  extends Omit<TransferOptions, 'parts' | 'locks' | 'masks'>,
    Pick<CageCallOptions, 'signal' | 'onProgress'> {
  /**
   * The image that was drawn in the cage's UVs: the bytes of a PNG, JPEG, WebP or KTX2 file. With `template: 'auto'` also a function of
   * what was chosen, as each template has a paint of its own.
   */
  texture: Uint8Array | ((template: Choice['template'], cage: Cage) => Uint8Array | Promise<Uint8Array>);
  /** The cage in its place around the model, with UVs: the bytes of a GLB, or a mesh, such as a `Cage`, in the space of the model's scene. */
  cage?: Uint8Array | Mesh | undefined;
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
   * Decodes an image of the model for the fit, to find a face that is only painted; and a texture with alpha, to find where it is
   * opaque: there the overlay is drawn as the surface itself, so that transparent hair before it stays before it. Rejected images are left
   * out. Default: the browser's own; other hosts have none, look at no colours, and blend all of a texture with alpha.
   */
  decode?: ImageCodec['decode'] | undefined;
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
    'template',
    'atLeast',
    'landmarks',
    'decode',
    'decoders',
    'borders',
    'attributes',
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

/**
 * Paints a model: the bytes of a GLB or VRM in, those of the painted file out.
 *
 * What `cagecast transfer` does: each primitive gets an overlay of its triangles that may be painted. All else stays byte for byte, with every extension, those of VRM 0 and 1 too; an earlier transfer is replaced. The file must hold its buffers and
 * images itself. What meshopt compresses stays so; Draco is refused, unless its decoder is given.
 *
 * Fit and transfer run in workers where there are any. Nothing is loaded over the network but for a template by its name, and for a fit
 * `cagecast-cages.wasm`, unless `init` of `cagecast/cages` was given it.
 * Cost: reading and writing take about as long as copying the file some times; `inspect` 3 to 15 times a transfer; a fit takes seconds.
 * @throws {CagecastError} `badArgument` that names the argument, the element of the file and the value; `badOption`; as `transfer`, and with a
 * template as `fitCage`. With `signal`, its reason.
 *
 * @example
 * import { paintGlb } from 'cagecast/gltf';
 *
 * const { bytes, note } = await paintGlb(await readFile('avatar.vrm'), { template: 'human-head', texture: await readFile('paint.png') });
 */
export async function paintGlb(bytes: Uint8Array, options: PaintOptions): Promise<PaintedGlb> {
  const fault = faultOfNames('paintGlb', 'options', options, kOptions) ?? faultOfParts('paintGlb', options.parts);
  if (fault !== undefined) throw new CagecastError('badOption', 'paintGlb', fault);
  const {
    texture,
    cage,
    template,
    atLeast = 'unfit',
    landmarks,
    decode,
    decoders,
    borders,
    attributes = false,
    parts: patterns,
    signal,
    onProgress = () => {},
    ...rules
  } = options;
  const file = bytesOf('bytes', bytes);
  if (typeof attributes !== 'boolean') throw wrong('options.attributes', attributes, 'true or false', 'badOption');
  if (!kVerdicts.includes(atLeast))
    throw wrong('options.atLeast', atLeast, `one of ${kVerdicts.join(', ')}`, 'badOption');
  if ((cage === undefined) === (template === undefined)) {
    const what = cage === undefined ? 'neither cage nor template is' : 'cage and template are both';
    throw new CagecastError('badArgument', 'paintGlb', `${what} given; one of them is needed`, { argument: 'cage' });
  }
  if (decode !== undefined && typeof decode !== 'function')
    throw wrong('options.decode', decode, 'a function', 'badOption');
  if (decoders !== undefined && (typeof decoders !== 'object' || decoders === null))
    throw wrong('options.decoders', decoders, 'an object', 'badOption');
  isCut('paintGlb', borders);
  try {
    const paintFor = typeof texture === 'function' && template === 'auto' ? texture : undefined;
    const given = paintFor ? undefined : readPaint(texture);
    signal?.throwIfAborted();
    onProgress(0, 'reading');
    const computing = await engine();
    const target = await readModel('bytes', file, { parts: patterns, decoders });
    const fitted =
      template &&
      (await fitTo(target, template, { inspect: computing.inspect, landmarks, decode, signal, onProgress }));
    const around = await readCage(fitted?.cage ?? cage!, target, decoders);
    const paint = given ?? readPaint(await paintFor!(fitted!.template!, fitted!.cage));
    signal?.throwIfAborted();
    onProgress(0.9, 'transferring');
    const bare = bareParts(target, around);
    const { kept, excluded } = target.extracted;
    const named = { keep: kept, exclude: [...bare, ...excluded] };
    const pair = movedApart(target, around);
    const compute = { ...rules, parts: named, signal };
    const judged = await judge(computing, pair, target, { ...compute, landmarks: landmarksIn(around) });
    const { source, result, verdict, findings } = judged;
    const arrays = [source.extracted.mesh, pair.target.extracted.mesh] as const;
    if (isWorse(verdict, atLeast))
      throw new CagecastError(
        'badModel',
        'paintGlb',
        `the cage is ${verdict}, not ${atLeast}: ${findings[0]!.sentence}`,
      );
    const prepared = await computing.prepareParts(...arrays, {
      ...compute,
      ...{ result, ranges: target.extracted.parts.map(rangeOf), borders, separatePaint: false },
    });
    onProgress(0.95, 'writing');
    const { data } = await writeTransfer(target.file, target.extracted, prepared.parts, {
      paints: [{ ...paint, hides: await opacityOf(paint, decode ?? hostDecode()) }],
      form: isDecodedBy(decoders, target) ? 'none' : 'keep',
      hasAttributes: attributes,
    });
    signal?.throwIfAborted();
    onProgress(1, 'writing');
    const { mesh, parts } = target.extracted;
    return {
      bytes: data,
      triangles: {
        painted: result.cosmeticTriangles.reduce((sum, one) => sum + one, 0),
        total: result.cosmeticTriangles.length,
      },
      note: noteOf(mesh, result, parts, around.extracted.mesh),
      bare: [...new Set(bare.filter((p) => !kept.includes(p)).map((p) => parts[p]!.name))],
      ...{ verdict, findings, cage: fitted?.cage, fit: fitted?.fit, template: fitted?.template, tried: fitted?.tried },
    };
  } catch (error) {
    throw error instanceof InputError
      ? new CagecastError('badArgument', 'paintGlb', error.message, {
          argument: error.message.split(/\W/, 1)[0],
          cause: error,
        })
      : error;
  }
}

/** Where a part is in the arrays of its target. */
const rangeOf = ({ firstVertex, vertexCount, firstTriangle, triangleCount, matrix }: Part): PartRange => ({
  ...{ firstVertex, vertexCount, firstTriangle, triangleCount },
  mirrored: isMirrored(matrix),
});

/** A transfer, whether its cage fits, and the cage as it was for it: turned, if it faced the other way. */
async function judge(
  { transfer, inspect }: Engine,
  { target, wholeCage: cage }: ReturnType<typeof movedApart>,
  whole: ReadModel,
  { landmarks, ...options }: Omit<NonNullable<Parameters<Engine['inspect']>[2]>, 'result'>,
): Promise<{ source: ReadModel; result: TransferResult } & Awaited<ReturnType<Engine['inspect']>>> {
  const call = async (source: ReadModel) => {
    const arrays = [source.extracted.mesh, target.extracted.mesh] as const;
    try {
      const result = await transfer(...arrays, options);
      return { source, result, ...(await inspect(...arrays, { ...options, result, landmarks })) };
    } catch (error) {
      const isOfMesh = ['cage', 'target'].includes((error as CagecastError).argument ?? '');
      throw isOfMesh ? errorInFile(error, { target: whole, cage }) : error;
    }
  };
  const first = await call(cage);
  const isApart = target !== whole;
  return isApart || !first.findings.some(({ code }) => code === 'cageBackward') ? first : call(turned(cage));
}

/** Reads a target, or a cage around one. @throws {InputError} that names the argument. */
async function readModel(
  name: string,
  bytes: Uint8Array,
  { beside, parts, decoders }: { beside?: ReadModel; parts?: Parts | undefined } & Pick<PaintOptions, 'decoders'> = {},
): Promise<ReadModel> {
  const { meshopt, draco } = decoders ?? {};
  const file = await openGltf(name, bytes, {
    decoders: {
      meshopt: () => (meshopt ? started(meshopt) : meshoptDecoder().catch(adviseDecoder)),
      ...(draco && { draco: async () => draco }),
    },
  });
  const extracted = extract(file, beside?.extracted.origin ?? 'own', beside ? 'cage' : parts);
  if (extracted.mesh.indices.length > 0) return { file, extracted };
  throw new InputError('has no triangles in its scene; at least one is needed').in(name);
}

function adviseDecoder(cause: CagecastError): never {
  const reason = `${cause.reason}; another decoder can be given: options.decoders.meshopt`;
  throw new CagecastError(cause.code, 'paintGlb', reason, { cause });
}

/** Whether geometry of a file was decoded by what was given: there may be no encoder then. */
const isDecodedBy = (decoders: PaintOptions['decoders'], { file: { json } }: ReadModel): boolean =>
  (decoders?.meshopt !== undefined && (json.bufferViews ?? []).some(meshoptView)) ||
  (json.meshes ?? []).some(({ primitives }) => primitives.some(dracoOf));

async function readCage(
  cage: Uint8Array | Mesh,
  target: ReadModel,
  decoders: PaintOptions['decoders'],
): Promise<ReadModel> {
  const file = plainArray(cage, 'Uint8Array');
  if (file) return withUvs(await readModel('cage', file, { beside: target, decoders }));
  if (typeof cage !== 'object' || cage === null || cage instanceof Uint8Array) {
    const advice = isTemplateName(cage) ? '; the template of this name is fitted by options.template' : '';
    throw wrong('cage', cage, `the bytes of a GLB, or a mesh${advice}`);
  }
  if (cage.uvs === undefined)
    throw wrong('cage.uvs', cage.uvs, "a Float32Array: the texture is drawn in the cage's UVs");
  return readModel('cage', cageGlb({ ...cage, uvs: cage.uvs }), { beside: target });
}

function readPaint(texture: unknown): Paint {
  const image = bytesOf('texture', texture);
  try {
    return paintOf(image, 'paint', ['image/png', 'image/jpeg', 'image/webp', 'image/ktx2']);
  } catch (error) {
    throw error instanceof InputError ? error.in('texture') : error;
  }
}

/** Bytes of any realm. @throws {CagecastError} */
function bytesOf(name: string, value: unknown): Uint8Array {
  const bytes = plainArray(value, 'Uint8Array');
  if (!bytes) throw wrong(name, value, 'a Uint8Array');
  return bytes;
}

const wrong = (name: string, value: unknown, type: string, code: Code = 'badArgument') =>
  new CagecastError(code, 'paintGlb', `${name} is ${show(value)}, not ${type}`, {
    argument: name.split('.')[0],
  });
