import type { Mesh, TransferResult } from '../../api/index.js';
import type { Parts } from '../../api/parts.js';
import { cageGlb } from '../../cages/cage-glb.js';
import { isTemplateName } from '../../cages/template-names.js';
import { CagecastError } from '../../core/error.js';
import { plainArray } from '../../core/typed-arrays.js';
import { noteOf } from '../../inspect/bare.js';
import { type Finding, isWorse, type Verdict } from '../../inspect/finding.js';
import type { PreparedPart } from '../../parts/prepare.js';
import type { PartRange } from '../../parts/split-part.js';
import { clearPrimitives } from '../../scene/clear-textures.js';
import { extract, type Part } from '../../scene/extract.js';
import { InputError } from '../../scene/input-error.js';
import { isMirrored } from '../../scene/matrix.js';
import { type Engine, engine } from '../../worker/engine.js';
import { dracoOf, meshoptView } from '../checks/check-geometry.js';
import { hostDecode } from '../host-decode.js';
import { meshoptDecoder, started } from '../meshopt.js';
import { openGltf } from '../open-gltf.js';
import { type Paint, paintOf } from '../overlay.js';
import {
  bareParts,
  errorInFile,
  landmarksIn,
  movedApart,
  type ReadModel,
  regionsIn,
  turned,
  withUvs,
} from '../read-model.js';
import { writeTransfer } from '../write-transfer.js';
import { fitTo } from './fit.js';
import { opacityOf } from './opacity.js';
import { bytesOf, checkOptions, type PaintedGlb, type PaintOptions, wrong } from './options.js';
import { withLook } from './with-look.js';

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
  checkOptions(options);
  const {
    texture,
    look,
    size,
    encode,
    cage,
    cageUvs,
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
  try {
    const paintFor = typeof texture === 'function' && template === 'auto' ? texture : undefined;
    const given = paintFor || look ? undefined : readPaint(texture);
    signal?.throwIfAborted();
    onProgress(0, 'reading');
    const computing = await engine();
    const target = await readModel('bytes', bytesOf('bytes', bytes), { parts: patterns, decoders, decode });
    const fitted =
      template &&
      (await fitTo(target, template, { inspect: computing.inspect, landmarks, decode, signal, onProgress }));
    const around = await readCage(fitted?.cage ?? cage!, target, { decoders, cageUvs });
    const paint = given ?? (paintFor && readPaint(await paintFor(fitted!.template!, fitted!.cage)));
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
      throw new CagecastError('badModel', 'paintGlb', notEnough(verdict, atLeast, findings));
    const prepared = await computing.prepareParts(...arrays, {
      ...compute,
      ...{ result, ranges: target.extracted.parts.map(rangeOf), borders, separatePaint: false },
    });
    onProgress(0.95, 'writing');
    const form = isDecodedBy(decoders, target) ? 'none' : 'keep';
    const write = async (model: ReadModel, parts: readonly PreparedPart[], shown: Paint) =>
      writeTransfer(model.file, model.extracted, parts, {
        paints: [{ ...shown, hides: shown.look ? undefined : await opacityOf(shown, decode ?? hostDecode()) }],
        form,
        hasAttributes: attributes,
      });
    const { data, ...done } = paint
      ? { data: (await write(target, prepared.parts, paint)).data, left: [], moving: [] }
      : await withLook(look!, target, {
          ...{ form, result, size, decode, encode, write },
          regions: regionsIn(around),
          prepared: prepared.parts,
          read: (painted) => readModel('bytes', painted, { parts: patterns, decoders, decode }),
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
      ...done,
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

const notEnough = (verdict: Verdict, atLeast: Verdict, findings: readonly Finding[]): string =>
  `the cage is ${verdict}, not ${atLeast}: ${findings[0]!.sentence}`;

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
  {
    beside,
    parts,
    decoders,
    decode = hostDecode(),
    cageUvs,
  }: { beside?: ReadModel; parts?: Parts | undefined } & Pick<PaintOptions, 'decoders' | 'decode' | 'cageUvs'> = {},
): Promise<ReadModel> {
  const { meshopt, draco } = decoders ?? {};
  const opened = await openGltf(name, bytes, {
    cageUvs,
    decoders: {
      meshopt: () => (meshopt ? started(meshopt) : meshoptDecoder().catch(adviseDecoder)),
      ...(draco && { draco: async () => draco }),
    },
  });
  const file = beside ? opened : { ...opened, clear: await clearPrimitives(opened, decode) };
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
  reading: Pick<PaintOptions, 'decoders' | 'cageUvs'>,
): Promise<ReadModel> {
  const file = plainArray(cage, 'Uint8Array');
  if (file) return withUvs(await readModel('cage', file, { beside: target, ...reading }));
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
