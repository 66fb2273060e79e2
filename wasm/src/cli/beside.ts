import { closeSync, openSync, readSync, statSync } from 'node:fs';
import { dirname } from 'node:path';
import type { GLTF } from '@gltf-transform/core';
import { defaultReading, isOutside, localFile, type ReadOptions, standard } from '../gltf/files.js';
import { parseGltf } from '../gltf/parse.js';
import { filesOf } from './glob.js';
import { canonicalPath } from './output.js';
import { isTiled, tilePath } from './paint/read-paint.js';
import type { Run, Sources } from './run.js';
import type { Region } from './transfer/command.js';
import { UsageError } from './usage.js';

/** Files with more JSON hold their buffers in it, as a rule; parsing them would take long. */
const kMaxBytes = 2 ** 23;

/** The files that the JSON of a glTF in a folder names. */
const filesNamedIn = ({ buffers = [], images = [] }: GLTF.IGLTF, folder: string): string[] =>
  [...buffers, ...images].flatMap(({ uri }) => (uri === undefined ? [] : (localFile(uri, folder) ?? [])));

/**
 * The files that a glTF or GLB names and may be read with, whether they exist or not. None if it cannot be read: what opens it says
 * what is wrong.
 */
export function filesBeside(path: string, { limits, allowOutside }: ReadOptions = defaultReading): string[] {
  if (!/\.(gltf|glb|vrm)$/i.test(path)) return [];
  try {
    const json = parseGltf(withoutBinary(path), limits).json;
    return filesNamedIn(json, dirname(path)).filter((file) => allowOutside || !isOutside(file, dirname(path)));
  } catch {
    return [];
  }
}

/** A glTF, or a GLB that ends after its JSON. Empty if that is too long. */
function withoutBinary(path: string): Uint8Array {
  const found = statSync(path);
  if (!found.isFile()) return new Uint8Array();
  const { size } = found;
  const file = openSync(path, 'r');
  try {
    const start = Buffer.alloc(20);
    const isGlb = readSync(file, start, 0, 20, 0) === 20 && start.toString('latin1', 0, 4) === 'glTF';
    const length = isGlb ? 20 + start.readUInt32LE(12) : size;
    if (length > Math.min(size, kMaxBytes)) return new Uint8Array();
    const bytes = Buffer.alloc(length);
    readSync(file, bytes, 0, length, 0);
    if (isGlb) bytes.writeUInt32LE(length, 8);
    return bytes;
  } finally {
    closeSync(file);
  }
}

/** What a command reads. */
interface Reads extends Sources {
  texture?: string | undefined;
  regions?: readonly Region[] | undefined;
}

/** What a transfer reads, as it is named. */
const readBy = ({ target, cage, referenceCage, texture, rules, regions = [] }: Reads): string[] =>
  [
    target,
    cage,
    referenceCage,
    texture,
    rules.masks?.never,
    rules.masks?.always,
    ...regions.flatMap((region) => [region.cage, region.texture]),
  ].filter((path) => path !== undefined);

/** All files that a transfer reads but its configuration, tiles of textures and what is beside a glTF included. */
export const filesReadBy = (command: Reads): string[] =>
  readBy(command)
    .flatMap((path) => (isTiled(path) ? filesOf(tilePath(path, '*')) : [path]))
    .flatMap((path) => [path, ...filesBeside(path, command.reading)]);

/**
 * Checks what a command is about to write, once its models are read.
 * @param more  What it reads besides the files of `command`.
 * @throws {UsageError} if a file would overwrite one that is read, or another one that is written.
 */
export function refuseOverwritingRead(
  command: Reads,
  { targetFile, cageFile }: Pick<Run, 'targetFile' | 'cageFile'>,
  written: readonly string[],
  more: readonly (string | undefined)[] = [],
): void {
  const paths = [
    ...filesReadBy(command),
    ...filesNamedIn(targetFile.json, dirname(command.target)),
    ...filesNamedIn(cageFile.json, dirname(command.cage)),
    ...[command.rules.config, ...more].filter((path) => path !== undefined),
  ];
  const read = new Set(paths.filter((path) => path !== standard).map((path) => canonicalPath(path)));
  const canonical = written.map((path) => canonicalPath(path));
  for (const [i, path] of written.entries()) {
    if (read.has(canonical[i]!))
      throw new UsageError(`${path}: would be overwritten, but is read by this command; choose another output`);
    if (canonical.indexOf(canonical[i]!) !== i)
      throw new UsageError(`${path}: would be written twice by this command; choose another output`);
  }
}
