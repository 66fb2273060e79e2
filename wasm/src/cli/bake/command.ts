import type { Baked, Image } from '../../bake/index.js';
import { FileModel } from '../../gltf/bake/bake-file.js';
import { type BakeReport, bakeModel, type Paints } from '../../gltf/bake/plan.js';
import { removeOverlays } from '../../gltf/earlier-in-file.js';
import { GlbWriter } from '../../gltf/glb-writer.js';
import { InputError, withName } from '../../gltf/input-error.js';
import { CagecastError, type CutTarget } from '../../index.js';
import type { Borders } from '../../parts/borders-option.js';
import { refuseOverwritingRead } from '../beside.js';
import { configLine, quoted } from '../options.js';
import { writeFiles } from '../output.js';
import type { Found } from '../print.js';
import type { Progress } from '../progress.js';
import { cutTarget, type Run, runTransfer, type Sources } from '../run.js';
import { percent, takenAway } from '../table.js';
import { decodeImage, encodePng, readImage } from './images.js';
import { listNames, paintForModel, paintOfModel } from './picture.js';

/** The arguments of `cagecast bake`. */
export interface BakeCommand extends Sources {
  /** Files of images in the cage's UVs. */
  paint?: string | undefined;
  normal?: string | undefined;
  orm?: string | undefined;
  /** A GLB or VRM, or a PNG: the paint alone, in the model's UVs. */
  output: string;
  /** Whether the PNG is in the cage's UVs: what is painted on the model. */
  back: boolean;
  /** Names of the parts whose texture is meant, for a PNG; empty for all. */
  part: string[];
  size?: number | undefined;
  borders: Borders;
}

/**
 * Bakes paints into a model's own textures, or into a PNG.
 * @throws {InputError} that names the file at fault; then no file is written.
 */
export async function bakeCommand(command: BakeCommand, progress: Progress): Promise<Found> {
  const { paint, normal, orm, reading } = command;
  const [color, normals, rough] = await Promise.all(
    [paint, normal, orm].map((path) => (path === undefined ? undefined : readImage(path, reading))),
  );
  const run = await runTransfer(command, progress);
  const cut = command.borders === 'cut' ? cutTarget(run, progress) : undefined;
  progress.step('baking');
  return command.output.toLowerCase().endsWith('.png')
    ? bakePicture(command, run, cut, color)
    : bakeFile(command, run, cut, { color, normal: normals, orm: rough });
}

/** An error of reading or baking the target, with its name. */
function inTarget(error: unknown, path: string): unknown {
  return withName(error instanceof CagecastError ? new InputError(error.reason, { cause: error }) : error, path);
}

/** Writes the output. @throws {InputError} if it would overwrite what was read. */
function write(command: BakeCommand, run: Run, data: Uint8Array): void {
  const { output, paint, normal, orm } = command;
  refuseOverwritingRead(command, run, [output], [paint, normal, orm]);
  writeFiles([{ path: output, data }]);
}

/** Writes the model with the paint in its textures. */
async function bakeFile(command: BakeCommand, run: Run, cut: CutTarget | undefined, paints: Paints): Promise<Found> {
  const { output, target, size } = command;
  const writer = await GlbWriter.from(run.targetFile, 'keep').catch((error) => {
    throw inTarget(error, target);
  });
  const overlays = removeOverlays(
    writer,
    run.target.parts.map(({ mesh }) => writer.json.meshes![mesh]!),
  );
  const model = new FileModel(run.targetFile, run.target.parts, writer);
  const { report } = await bakeModel(model, {
    result: run.result,
    cut,
    paints,
    codec: { decode: decodeImage, encode: encodePng },
    size,
  }).catch((error) => {
    throw inTarget(error, target);
  });
  if (report.textures.length === 0) {
    // The reason of a part's own material before those of variants.
    const first = report.left.find(({ material }) => material === undefined) ?? report.left[0];
    throw new InputError(first ? `nothing can be baked: ${leftText(first)}` : 'nothing of it may be painted').in(
      target,
    );
  }
  write(command, run, writer.finish());
  const { config } = command.rules;
  const lines = [...summary(output, report), overlays > 0 ? takenAway(overlays) : '', configLine(config)];
  return {
    lines: lines.filter(Boolean),
    report: { output, ...report, replacedOverlays: overlays, config: config ?? null },
  };
}

function summary(output: string, { textures, left }: BakeReport): string[] {
  return [
    `wrote ${output}`,
    ...textures.map(
      ({ slot, parts, width, height, overlap }) =>
        `${slot}: ${width} × ${height}, on ${listNames(parts)}${overlapText(overlap)}`,
    ),
    ...left.map((one) => `not painted: ${leftText(one)}`),
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

/** Writes a PNG: the paint alone in the model's UVs, or what is painted on the model in the cage's. */
async function bakePicture(command: BakeCommand, run: Run, cut: CutTarget | undefined, paint?: Image): Promise<Found> {
  const { output, target, back } = command;
  const made = back ? paintOfModel(command, run, cut) : paintForModel(command, run, cut, paint!);
  const { image, parts } = await made.catch((error) => {
    throw inTarget(error, target);
  });
  write(command, run, await encodePng(image));
  const { width, height, overlap } = image;
  const names = parts.map(({ name }) => name);
  const { config } = command.rules;
  const use = back ? `of ${listNames(names)}` : `for ${listNames(names)}${overlapText(overlap)}`;
  return {
    lines: [`wrote ${output}: ${width} × ${height}, ${use}`, configLine(config)].filter(Boolean),
    report: { output, parts: names, width, height, overlap, config: config ?? null },
  };
}
