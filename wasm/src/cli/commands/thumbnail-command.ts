import { type Command, InvalidArgumentError } from 'commander';
import type { Mesh } from '../../api/index.js';
import type { GltfFile } from '../../gltf/open-gltf.js';
import { drawFile } from '../../gltf/thumbnail/draw-file.js';
import { isColor, kLargest, kSize, kSmallest, type Thumbnail } from '../../gltf/thumbnail/options.js';
import { type Angles, type ViewName, views } from '../../gltf/thumbnail/views.js';
import { moved } from '../../parts/origin.js';
import { firstLine, InputError, withName } from '../../scene/input-error.js';
import { standard } from '../io/files.js';
import { filesOf } from '../io/glob.js';
import { decodeImage, encoderFor, imageEndings } from '../io/images.js';
import type { Io } from '../io/io.js';
import { makeFolder, writeFiles } from '../io/output.js';
import { readGltf } from '../io/read-gltf.js';
import { kExit, UsageError } from '../model/failures.js';
import type { ReadOptions } from '../model/reading.js';
import { resolveSettings } from '../model/settings.js';
import type { Line } from '../model/text.js';
import { readModel } from '../transfer/models.js';
import { allBut } from '../transfer/read-target.js';
import { missingLine } from '../transfer/report-parts.js';
import { filledFor, placeholderFault } from './batch-jobs.js';
import * as common from './common-flags.js';
import { type Found, perform } from './perform.js';

interface ThumbnailFlags extends common.ReadFlags, common.PrintFlags {
  output: string;
  size: number;
  view: ViewName | Angles;
  part?: string[];
  cage?: string;
  background?: string;
}

/** A picture that was made of a model, or why there is none. */
type Made = { model: string; output: string } & (Omit<Drawn, 'data'> | { error: string });

/** A picture, and what of the model was missing. */
type Drawn = Thumbnail & Pick<GltfFile, 'missing'>;

/** JPEG has no transparency: what is behind the model, unless a colour is given. */
const kWhite = '#ffffff';

/** What its help says after the flags. */
const kHelp = `
Shown: base colours with their textures, vertex colours, alpha, overlays of paint, in a light from the eye; skins in their bind pose.
Hidden nodes, cages and markers are left out. A texture that cannot be decoded is not shown; the summary says so.
face is the head from the front, if a joint is called so. front is +z, of a VRM 0 -z.
If one of several models cannot be used, the others are drawn, and the exit code is 1. Missing folders are made.

Examples:
  cagecast thumbnail painted.vrm --view face --size 512 -o painted.png
  cagecast thumbnail "painted/*.glb" --background "#ffffff" -o "pictures/{name}.webp"`;

/** Adds the command that draws pictures of models. */
export function addThumbnailCommand(program: Command, io: Io): void {
  const command = program
    .command('thumbnail')
    .description('draw a picture of each of MODELS, painted or not')
    .argument('<MODELS...>', 'GLB, glTF, VRM, FBX, OBJ, PLY, STL or USDZ; in names, * matches any text')
    .addOption(
      common
        .parsed(
          '-o, --output <OUT>',
          'a PNG; JPEG and WebP where sharp is installed; {name} and {dir} stand for those of the model; - for a PNG on the standard output',
          common.endingIn(...imageEndings),
        )
        .makeOptionMandatory(),
    )
    .addOption(
      common
        .parsed(
          '--size <PIXELS>',
          `width and height; ${kSmallest} to ${kLargest}`,
          common.wholeNumberWithin(kSmallest, kLargest, ' of pixels'),
        )
        .default(kSize),
    )
    .addOption(
      common
        .parsed(
          '--view <VIEW>',
          `from where: ${Object.keys(views).join(', ')}; or azimuth and elevation in degrees, as 30,15: from its left, and from above`,
          viewOf,
        )
        .default('front'),
    )
    .addOption(
      common.parsed('--part <NAME>', 'what is to fill the picture: parts of this name; as --ignore', common.oneMore),
    )
    .option('--cage <CAGE>', 'the same by a cage around it')
    .addOption(common.parsed('--background <COLOR>', 'as #rrggbb (default: transparent; white in a JPEG)', colorOf));
  common.addFlags(command, 'Reading', 'Printing');
  command.addHelpText('after', kHelp).action((patterns: string[], flags: ThumbnailFlags) => {
    const { output, part, cage } = flags;
    const fault = placeholderFault(output);
    if (fault !== undefined) throw new UsageError(fault);
    if (part && cage !== undefined) throw new UsageError('--part and --cage both say what fills the picture; give one');
    const models = [...new Set(patterns.flatMap(found))];
    const outputs = models.map((model) => filledFor(model, output));
    if (new Set(outputs).size < outputs.length)
      throw new UsageError(`${output} is written for several models; use {name} or {dir} in its path`);
    for (const one of outputs) if (one !== output) makeFolder(one);
    return perform(io, flags, { inputs: [...models, cage], outputs }, () => drawAll(models, flags, io));
  });
}

/** @throws {InputError} if a pattern has no files. */
function found(pattern: string): string[] {
  const files = filesOf(pattern);
  if (files.length === 0) throw new InputError('no file has such a name').in(pattern);
  return files;
}

function viewOf(text: string): ViewName | Angles {
  if (Object.hasOwn(views, text)) return text as ViewName;
  const [azimuth = Number.NaN, elevation = 0, ...more] = text.split(',').map((one) => (one.trim() ? Number(one) : NaN));
  if (!Number.isFinite(azimuth) || !(Math.abs(elevation) <= 90) || more.length > 0)
    throw new InvalidArgumentError(`It is neither ${Object.keys(views).join(', ')} nor two angles such as 30,15.`);
  return { azimuth, elevation };
}

function colorOf(text: string): string {
  if (!isColor(text)) throw new InvalidArgumentError(`It is not a colour such as ${kWhite}.`);
  return text;
}

/** Draws models. @throws {InputError} that names the file at fault, if there is only one model, or all fail by it. */
async function drawAll(models: readonly string[], flags: ThumbnailFlags, io: Io): Promise<Found> {
  const encode = encoderFor(flags.output);
  const reading = common.readingOf(flags);
  const cage = flags.cage === undefined ? undefined : await readCage(flags.cage, reading, io);
  const made: Made[] = [];
  for (const model of models) {
    const output = filledFor(model, flags.output);
    try {
      io.step(`drawing ${model}`);
      const { data, ...picture } = await draw(model, flags, cage);
      writeFiles([{ path: output, data: await encode({ ...picture, data }) }], io);
      made.push({ model, output, ...picture });
    } catch (error) {
      if (models.length === 1 || !(error instanceof InputError)) throw error;
      made.push({ model, output, error: firstLine(error) });
    }
  }
  const hasFailed = made.some((one) => 'error' in one);
  return { lines: made.flatMap(linesOf), report: made, exitCode: hasFailed ? kExit.unusable : 0 };
}

/** A cage in the space of its scene. @throws {InputError} that names the file. */
async function readCage(path: string, reading: ReadOptions, io: Io): Promise<Mesh> {
  const { mesh, origin } = (await readModel(path, reading, io)).extracted;
  return moved(mesh, [-origin[0], -origin[1], -origin[2]]);
}

/** Draws a model. @throws {InputError} that names the file. */
async function draw(model: string, flags: ThumbnailFlags, cage: Mesh | undefined): Promise<Drawn> {
  const { output, size, view, part, ignore = [] } = flags;
  const background = flags.background ?? (/\.jpe?g$/i.test(output) ? kWhite : undefined);
  const file = await readGltf(model, common.readingOf(flags));
  const { rules } = resolveSettings([{ settings: { ignore } }]);
  const options = { size, view, frame: part, cage, background, decode: decodeImage };
  try {
    return { ...(await drawFile(file, options, allBut(rules))), ...(file.missing && { missing: file.missing }) };
  } catch (error) {
    throw error instanceof InputError && error.message.startsWith(model) ? error : withName(error, model);
  }
}

function linesOf(one: Made): Line[] {
  if ('error' in one) return [one.error];
  const { model, output, width, height, framed, undecoded, missing } = one;
  const name = output === standard ? '' : `wrote ${output}: `;
  return [
    `${name}${width} × ${height}, of ${model}${framed === 'model' ? '' : `, its ${framed}`}`,
    missingLine(missing),
    ...undecoded.map((reason) => `not shown: the texture ${reason}`),
  ];
}
