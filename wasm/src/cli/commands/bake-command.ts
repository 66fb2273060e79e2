import { type Command, InvalidArgumentError } from 'commander';
import { CagecastError, type CutTarget } from '../../api/index.js';
import { type Baked, type Image, mostTexels } from '../../bake/index.js';
import { type AtlasReport, packTextures } from '../../gltf/bake/atlas.js';
import { FileModel } from '../../gltf/bake/bake-file.js';
import { type BakeReport, bakeModel, type Coats, coatsOf, type Paints } from '../../gltf/bake/plan.js';
import { removeOverlays } from '../../gltf/earlier-in-file.js';
import { GlbWriter } from '../../gltf/glb-writer.js';
import { coatsOfLook, readLook } from '../../gltf/look/index.js';
import { preparePiece } from '../../gltf/primitive-group.js';
import { regionsIn } from '../../gltf/read-model.js';
import { percent } from '../../inspect/finding.js';
import { grouped } from '../../inspect/geometry.js';
import type { Borders } from '../../parts/cut-part.js';
import type { Part } from '../../scene/extract.js';
import { InputError, naming, withName } from '../../scene/input-error.js';
import type { ImageCodec } from '../../scene/materials.js';
import { readBytes } from '../io/files.js';
import { decodeImage, encodeLike, encodePng, readImage } from '../io/images.js';
import type { Io } from '../io/io.js';
import { refuseOverwriting, writeFiles } from '../io/output.js';
import { readGltf } from '../io/read-gltf.js';
import { UsageError } from '../model/failures.js';
import { parseObject } from '../model/json.js';
import { resolveSettings } from '../model/settings.js';
import { isByTemplate, type Sources, texturePath } from '../model/sources.js';
import { configLine, quoted, takenAway } from '../model/text.js';
import { allFilesReadBy } from '../transfer/files-read.js';
import { inspectionReport } from '../transfer/inspection.js';
import { cageReport, choiceLines, missingLine, uvSetsLine } from '../transfer/report-parts.js';
import { cutTarget, type Run, runTransfer } from '../transfer/run-transfer.js';
import { listNames, paintForModel, paintOfModel } from './bake-picture.js';
import * as common from './common-flags.js';
import { type Found, perform } from './perform.js';
import { addTarget } from './transfer-command.js';

interface BakeFlags extends common.SettingFlags, common.AroundFlags, common.ReadFlags, common.PrintFlags {
  /** Files of images in the cage's UVs. */
  texture?: string;
  map?: Maps;
  /** The file of saved layers. */
  look?: string;
  /** A GLB or VRM, or a PNG: the paint alone, in the model's UVs. */
  output: string;
  /** Whether the PNG is in the cage's UVs: what is painted on the model. */
  back?: boolean;
  /** Names of the parts whose texture is meant, for a PNG; none for all. */
  part?: string[];
  size?: number;
  /** Whether the textures are packed; into one of so many texels, if a number. */
  atlas?: true | number;
}

/** Files of images besides the colours. */
type Maps = Partial<Record<'normal' | 'orm', string>>;

/** Parses the flag of such a file. */
function mapOf(text: string, before: Maps = {}): Maps {
  const [, kind, path] = /^(normal|orm)=(.+)$/s.exec(text) ?? [];
  if (kind === undefined) throw new InvalidArgumentError('It is not normal=MAP or orm=MAP.');
  return { ...before, [kind]: path };
}

/** The arguments of `cagecast bake`. */
interface BakeCommand extends Sources, Omit<BakeFlags, keyof common.SettingFlags | 'cage' | 'texture'> {
  paint: string | undefined;
  borders: Borders;
}

/** The fewest texels of packed textures. */
const kMinAtlas = 64;

/** What its help says after the flags. */
const kHelp = `
A part is not painted if its material has no texture, or its UVs are not an unwrapping; the summary says which. Where UVs
overlap, as of mirrored halves, the first part has the texels. Overlays of an earlier transfer are taken away.

With --atlas, materials that differ only by textures and factors become one. Those whose UVs leave 0..1, or whose extensions may refer
to textures (VRM 0, MToon), keep their own; the summary says which.

Examples:
  cagecast bake head.glb --cage cage.glb --texture paint.png --map normal=scales.png --size 2048 -o painted.glb
  cagecast bake head.glb --cage cage.glb --back -o paint-again.png`;

/** Adds the command that bakes paint into textures. */
export function addBakeCommand(program: Command, io: Io): void {
  const command = addTarget(program.command('bake'))
    .description("bake PAINT into TARGET's own textures, in its own UVs; its geometry stays as it is")
    .option('--texture <PAINT>', "PNG in the cage's UV space; JPEG and WebP where sharp is installed")
    .addOption(
      common
        .parsed(
          '-o, --output <OUT>',
          "a GLB or VRM, or a PNG of the paint alone, in TARGET's UVs; - for a GLB on the standard output",
          common.endingIn('.glb', '.vrm', '.png'),
        )
        .makeOptionMandatory(),
    )
    .addOption(
      common.parsed(
        '--map <KIND=MAP>',
        "another map in the cage's UV space: normal=MAP, of normals; orm=MAP, of occlusion, roughness and metalness, as in glTF; may be repeated",
        mapOf,
      ),
    )
    .option(
      '--look <LOOK.json>',
      'instead of images: layers as saved by cagecast/three, with tint, gloss, metal, glow and relief',
    )
    .option('--back', "the way back: write what is painted on TARGET as a PNG in the cage's UV space")
    .addOption(common.parsed('--part <NAME>', 'for a PNG: only these parts; as --keep', common.oneMore))
    .addOption(
      common.parsed(
        '--size <TEXELS>',
        `the longer side of painted textures; 1 to ${mostTexels} (default: as before)`,
        common.wholeNumberWithin(1, mostTexels, ' of texels'),
      ),
    )
    .addOption(
      common.parsed(
        '--atlas [TEXELS]',
        `pack the textures of all materials into one for colours, one for normals, and one for occlusion, roughness and metalness, of so many texels; ${kMinAtlas} to ${mostTexels} (default: as many as they need, up to 4096)`,
        common.wholeNumberWithin(kMinAtlas, mostTexels, ' of texels'),
      ),
    )
    .addOption(common.bordersFlag());
  common.addFlags(command, 'Parts', 'Painting', 'Reading', 'Printing');
  command.addHelpText('after', kHelp).action((target: string, flags: BakeFlags) => {
    const { texture: paint } = flags;
    const around = common.aroundOf(flags, target);
    const fault = faultOf(flags);
    if (fault !== undefined) throw new UsageError(fault);
    const inputs = [target, ...common.inputsOf(flags), ...Object.values(flags.map ?? {}), ...[flags.look ?? []].flat()];
    return perform(io, flags, { inputs, outputs: [flags.output] }, async () => {
      const settings = resolveSettings(await common.layersFor(flags)(target));
      const reading = common.readingOf(flags);
      return bakeCommand({ ...flags, target, ...around, cageUvs: flags.set?.cageUvs, paint, ...settings, reading }, io);
    });
  });
}

/** What is wrong with the arguments together, if anything is. */
function faultOf({ output, texture, map, look, back, atlas, part = [], set }: BakeFlags): string | undefined {
  const isPicture = output.toLowerCase().endsWith('.png');
  const hasMaps = map !== undefined;
  if (back && (!isPicture || texture !== undefined || hasMaps)) return '--back takes no paint, and writes a PNG';
  if (look !== undefined && (isPicture || texture !== undefined || hasMaps))
    return '--look takes no other paint, and needs an OUT.glb';
  if (!back && isPicture && texture === undefined) return 'to write a PNG, --texture is needed';
  if (isPicture && hasMaps) return '--map needs an OUT.glb';
  if (isPicture && atlas !== undefined) return '--atlas needs an OUT.glb';
  if (!back && texture === undefined && !hasMaps && look === undefined)
    return 'there is nothing to bake: give --texture, --map or --look';
  if (!isPicture && part.length > 0) return '--part is for a PNG; for a GLB, use --exclude';
  return common.wholeCageFault(set);
}

/**
 * Bakes paints into a model's own textures, or into a PNG.
 * @throws {InputError} that names the file at fault; then no file is written.
 */
async function bakeCommand(command: BakeCommand, io: Io): Promise<Found> {
  const { target, paint, map: { normal, orm } = {}, reading } = command;
  // What cannot be read is said before what takes long; for a chosen template it is only known then.
  const readAll = (template: string | undefined) =>
    Promise.all(
      [paint, normal, orm].map((path) =>
        path === undefined ? undefined : readImage(texturePath(path, template), reading),
      ),
    );
  const isLate = [paint, normal, orm].some((path) => path && isByTemplate(path));
  const known = isLate ? undefined : await readAll(undefined);
  const run = await runTransfer(command, io);
  const [color, normals, rough] = known ?? (await readAll(run.choice?.template));
  const cut = command.borders === 'cut' ? cutTarget(run, io) : undefined;
  io.step('baking');
  const isPicture = command.output.toLowerCase().endsWith('.png');
  const baked = isPicture
    ? bakePicture(command, run, cut, color)
    : bakeFile(command, run, cut, await coatsFor(command, run, { color, normal: normals, orm: rough }));
  const { data, lines, report } = await baked.catch((error) => {
    throw withName(error instanceof CagecastError ? new InputError(error.reason, { cause: error }) : error, target);
  });
  refuseOverwriting([...allFilesReadBy(command, run), paint, normal, orm, command.look], [command.output]);
  const fitted = command.template === undefined ? undefined : fittedOf(command, run, io);
  writeFiles([{ path: command.output, data }], io);
  const told = uvSetsLine(run.cage.extracted.mesh);
  return { lines: [...(fitted?.lines ?? []), ...lines, told], report: { ...report, ...fitted?.report } };
}

/** What is laid over textures: images, or a look. @throws {InputError} that names the file of the look. */
async function coatsFor({ look, reading }: BakeCommand, run: Run, paints: Paints): Promise<Coats> {
  if (look === undefined) return coatsOf(paints);
  return naming(look, async () => {
    const saved = parseObject(new TextDecoder().decode(await readBytes(look, reading.limits)));
    try {
      return coatsOfLook(await readLook(saved, regionsIn(run.cage), decodeImage));
    } catch (error) {
      throw error instanceof CagecastError ? new InputError(error.reason, { cause: error }) : error;
    }
  });
}

/** What is said of the cage that a template came to. */
function fittedOf(command: BakeCommand, run: Run, io: Io): Found {
  io.step('inspecting');
  const cage = cageReport(command.cage, run.cage, run);
  const { verdict, findings } = inspectionReport(command, run, []);
  return { lines: [...choiceLines(cage), `the cage is ${verdict}`], report: { cage, verdict, findings } };
}

/** A file that is to be written, and what is said of it. */
type Made = Found & { data: Uint8Array };

/** The model with the paint in its textures. @throws {InputError} */
async function bakeFile(command: BakeCommand, run: Run, cut: CutTarget | undefined, coats: Coats): Promise<Made> {
  const { output, size } = command;
  const { file, extracted } = run.target;
  const writer = await GlbWriter.from(file, 'keep');
  const overlays = removeOverlays(
    writer,
    file,
    extracted.parts.map(({ mesh }) => writer.json.meshes![mesh]!),
  );
  const codec = { decode: decodeImage, encode: encodeLike };
  const prepared = (part: Part) => preparePiece(part, run.result, cut);
  const { report } = await bakeModel(new FileModel(file, extracted.parts, writer), {
    ...{ result: run.result, prepared, size, coats, codec },
  });
  if (report.textures.length === 0) {
    // The reason of a part's own material before those of variants.
    const first = report.left.find(({ material }) => material === undefined) ?? report.left[0];
    throw new InputError(first ? `nothing can be baked: ${leftText(first)}` : 'nothing of it may be painted');
  }
  const { config } = command.rules;
  const { data, lines, atlas } = await withAtlas(writer.finish(), command, codec);
  return {
    data,
    lines: [
      ...summary(output, report),
      ...lines,
      missingLine(file.missing),
      overlays > 0 && takenAway(overlays),
      configLine(config),
    ],
    report: {
      output,
      ...report,
      ...(file.missing && { missing: file.missing }),
      ...(atlas && { atlas }),
      replacedOverlays: overlays,
      config: config ?? null,
    },
  };
}

/** A baked file whose textures are packed, if that is asked for. @throws {InputError} */
async function withAtlas(
  data: Uint8Array,
  { atlas, target, reading }: BakeCommand,
  codec: ImageCodec,
): Promise<{ data: Uint8Array; lines: string[]; atlas?: AtlasReport }> {
  if (atlas === undefined) return { data, lines: [] };
  const file = await readGltf(target, reading, data);
  const { bytes, report } = await packTextures(file, codec, atlas === true ? undefined : atlas);
  const { packed, textures, left } = report;
  const lines = textures.map(({ slot, size }) => `${slot} atlas: ${size} × ${size}`);
  for (const names of packed) if (names.length > 1) lines.push(`one material now: ${listNames(names)}`);
  if (!bytes) lines.push('textures are not packed: fewer than two materials have some that can be');
  for (const some of grouped(left, ({ reason }) => reason))
    lines.push(`not packed: ${listNames(some.map(({ material }) => material))}: ${some[0].reason}`);
  return { data: bytes ?? data, lines, atlas: report };
}

function summary(output: string, { textures, left, moving }: BakeReport): string[] {
  return [
    `wrote ${output}`,
    ...textures.map(
      ({ slot, parts, width, height, overlap, mimeType, before = mimeType }) =>
        `${slot}: ${width} × ${height}, on ${listNames(parts)}${mimeType === before ? '' : `; ${mimeType} now, ${before} before`}${overlapText(overlap)}`,
    ),
    ...left.map((one) => `not painted: ${leftText(one)}`),
    ...moving.map(({ material, reason }) => `the paint moves on ${quoted(material)}: ${reason}`),
  ];
}

/** Which part is not painted, and why. */
const leftText = ({ part, material, reason }: BakeReport['left'][number]): string =>
  `${quoted(part)}${material === undefined ? '' : `, with ${quoted(material)} of its variants`}: ${reason}`;

const kFewTexels = 0.001; // is due to touching edges

const overlapText = ({ texels, lost, parts }: Baked['overlap']): string =>
  texels < kFewTexels
    ? ''
    : `; UVs overlap: ${percent(texels)} of its texels are claimed twice, ${percent(lost)} of the paint found no room (${listNames(parts)})`;

/** A PNG: the paint alone in the model's UVs, or what is painted on the model in the cage's. */
async function bakePicture(command: BakeCommand, run: Run, cut: CutTarget | undefined, paint?: Image): Promise<Made> {
  const { output, back } = command;
  const { image, parts } = await (back ? paintOfModel(command, run, cut) : paintForModel(command, run, cut, paint!));
  const { width, height, overlap } = image;
  const names = parts.map(({ name }) => name);
  const { config } = command.rules;
  const use = back ? `of ${listNames(names)}` : `for ${listNames(names)}${overlapText(overlap)}`;
  return {
    data: await encodePng(image),
    lines: [`wrote ${output}: ${width} × ${height}, ${use}`, configLine(config)],
    report: { output, parts: names, width, height, overlap, config: config ?? null },
  };
}
