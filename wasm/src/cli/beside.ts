import { readFileSync, statSync } from 'node:fs';
import { dirname } from 'node:path';
import type { GLTF } from '@gltf-transform/core';
import { defaultReading, isOutside, localFile, type ReadOptions } from '../gltf/files.js';
import { parseGltf } from '../gltf/parse.js';
import { filesOf } from './glob.js';
import { tilePath } from './paint/read-paint.js';
import type { TransferCommand } from './transfer-command.js';

/** Files with more hold their buffers themselves, as a rule; parsing them would take long. */
const mostBytes = 2 ** 23;

/** The files that the JSON of a glTF in a folder names. */
export const filesNamedIn = ({ buffers = [], images = [] }: GLTF.IGLTF, folder: string): string[] =>
  [...buffers, ...images].flatMap(({ uri }) => (uri === undefined ? [] : (localFile(uri, folder) ?? [])));

/**
 * The files that a `.gltf` names and may be read with, whether they exist or not. None if it cannot be read: what opens it says what
 * is wrong.
 */
export function filesBeside(path: string, { limits, allowOutside }: ReadOptions = defaultReading): string[] {
  if (!/\.gltf$/i.test(path)) return [];
  try {
    const found = statSync(path);
    if (!found.isFile() || found.size > mostBytes) return [];
    const files = filesNamedIn(parseGltf(readFileSync(path), limits).json, dirname(path));
    return files.filter((file) => allowOutside || !isOutside(file, dirname(path)));
  } catch {
    return [];
  }
}

/** What a transfer reads, as it is named. */
const readBy = ({ target, cage, referenceCage, texture, rules, regions = [] }: TransferCommand): string[] =>
  [
    target,
    cage,
    referenceCage,
    texture,
    rules.masks?.never,
    rules.masks?.always,
    ...regions.flatMap((region) => [region.cage, region.texture]),
  ].filter((path) => path !== undefined);

/** All files that a transfer reads, tiles of textures and what is beside a `.gltf` included. */
export const filesReadBy = (command: TransferCommand): string[] =>
  readBy(command)
    .flatMap((path) => filesOf(tilePath(path, '*')))
    .flatMap((path) => [path, ...filesBeside(path, command.reading)]);
