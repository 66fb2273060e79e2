import { type Extracted, extract, partOf, placeOf } from '../gltf/extract.js';
import { InputError } from '../gltf/input-error.js';
import { type GltfFile, readGltf } from '../gltf/read.js';
import { CagecastError, init, type TransferOptions, type TransferResult, transfer } from '../index.js';
import { type Rules, transferOptions } from './options.js';
import type { Progress } from './progress.js';

/** Two files, read and transferred. */
export interface Run {
  targetFile: GltfFile;
  target: Extracted;
  cageFile: GltfFile;
  cage: Extracted;
  /** What `transfer` was called with. */
  options: TransferOptions;
  result: TransferResult;
}

/**
 * Reads target and cage and runs the transfer.
 * @throws {InputError} that names the file at fault.
 */
export async function run(targetPath: string, cagePath: string, rules: Rules, progress: Progress): Promise<Run> {
  progress.step(`reading ${targetPath}`);
  const targetFile = await readGltf(targetPath);
  const target = usable(targetFile, extract(targetFile));
  const options = optionsFor(targetFile, target, rules);
  progress.step(`reading ${cagePath}`);
  const cageFile = await readGltf(cagePath);
  const cage = usable(cageFile, extract(cageFile));
  if (cage.mesh.uvs === undefined) {
    const part = cage.parts.find(
      ({ mesh, primitive }) =>
        cageFile.json.meshes![mesh]!.primitives[primitive]!.attributes['TEXCOORD_0'] === undefined,
    )!;
    throw new InputError(
      `${placeOf(part)} ("${part.name}") has no TEXCOORD_0: the texture is drawn in the cage's UVs`,
    ).in(cagePath);
  }
  const vertices = target.mesh.positions.length / 3;
  progress.step(`transferring to ${vertices.toLocaleString('en')} vertices`);
  await init();
  const files = { targetFile, target, cageFile, cage };
  try {
    return { ...files, options, result: transfer(cage.mesh, target.mesh, options) };
  } catch (error) {
    throw inFile(error, files);
  }
}

function optionsFor({ path }: GltfFile, target: Extracted, rules: Rules): TransferOptions {
  try {
    return transferOptions(rules, target);
  } catch (error) {
    throw error instanceof InputError ? error.in(path) : error;
  }
}

function usable(file: GltfFile, extracted: Extracted): Extracted {
  if (extracted.mesh.indices.length === 0) {
    throw new InputError(
      `has no ${(file.json.meshes ?? []).length === 0 ? 'meshes' : 'triangles in its scene'}; at least one triangle is needed`,
    ).in(file.path);
  }
  return extracted;
}

/** Adds the file, and the place in it, to an error of the core; returns any other error unchanged. */
export function inFile(
  error: unknown,
  { targetFile, target, cageFile, cage }: Omit<Run, 'options' | 'result'>,
): unknown {
  if (!(error instanceof CagecastError)) return error;
  const { message, code, at } = error;
  const text = message.replace(/^\w+: /, '');
  const isCage = text.startsWith('cage');
  if (!isCage && !text.startsWith('target')) return new InputError(text).in(targetFile.path);
  const { parts } = isCage ? cage : target;
  const perVertex = { nonFinitePosition: 3, tooLarge: 3, nonFiniteUv: 2 }[code as string];
  const part = perVertex === undefined ? undefined : partOf(parts, Math.floor(at / perVertex));
  const where = part ? ` (${placeOf(part)}, "${part.name}")` : '';
  return new InputError(`${text}${where}`).in((isCage ? cageFile : targetFile).path);
}
