import { closeSync, openSync, readSync, statSync } from 'node:fs';
import { dirname } from 'node:path';
import type { GLTF } from '@gltf-transform/core';
import { parseGltf } from '../../gltf/parse.js';
import { defaultReading, type ReadOptions } from '../model/reading.js';
import { isOutside, localFile } from './files.js';

/** Files with more JSON hold their buffers in it, as a rule; parsing them would take long. */
const kMaxBytes = 2 ** 23;

/** The files that the JSON of a glTF in a folder names. */
export const filesNamedIn = ({ buffers = [], images = [] }: GLTF.IGLTF, folder: string): string[] =>
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
  const file = openSync(path, 'r');
  try {
    const start = Buffer.alloc(20);
    const isGlb = readSync(file, start, 0, 20, 0) === 20 && start.toString('latin1', 0, 4) === 'glTF';
    const length = isGlb ? 20 + start.readUInt32LE(12) : found.size;
    if (length > Math.min(found.size, kMaxBytes)) return new Uint8Array();
    const bytes = Buffer.alloc(length);
    readSync(file, bytes, 0, length, 0);
    if (isGlb) bytes.writeUInt32LE(length, 8);
    return bytes;
  } finally {
    closeSync(file);
  }
}
