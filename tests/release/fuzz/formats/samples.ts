import { readdirSync, readFileSync } from 'node:fs';
import { extname } from 'node:path';
import { fileURLToPath } from 'node:url';
import { zipSync } from 'three/addons/libs/fflate.module.js';
import { jpegOf, ktx2Of, webpOf } from '../../../support/files/costly.js';
import type { Files } from './check.js';

const corpus = fileURLToPath(new URL('../corpus/', import.meta.url));
const folder = `${corpus}formats/`;
const read = (name: string): Buffer => readFileSync(folder + name);

/** A file, of which others are made. */
export interface Sample {
  bytes: Buffer;
  /** What is read: the file, with what belongs to it. */
  filesOf(bytes: Uint8Array): Files;
}

const beside: Files = { 'model.mtl': read('model.mtl'), 'skin.png': read('skin.png') };
const alone = (name: string, bytes = read(name)): Sample => ({
  bytes,
  filesOf: (changed) => ({ [name]: changed, ...beside }),
});
const zipped = (files: Record<string, Uint8Array>) => zipSync(files, { level: 0, mtime: '2020-01-01' });

/** By name; formats are known by what is in a file. */
export const samples: Record<string, Sample> = {
  ...Object.fromEntries(
    readdirSync(folder)
      .filter((name) => !['', '.mtl'].includes(extname(name)))
      .map((name) => [name, alone(name)]),
  ),
  ...Object.fromEntries(
    ['skinned.glb', 'sparse.glb', 'embedded.gltf'].map((name) => [
      name,
      alone(name, readFileSync(`${corpus}glb/${name}`)),
    ]),
  ),
  'skin.jpg': alone('skin.jpg', jpegOf(2, 2)),
  'skin.webp': alone('skin.webp', webpOf(2, 2)),
  'skin.ktx2': alone('skin.ktx2', ktx2Of(2, 2)),
  // What is inside others, or beside them.
  'model.mtl': {
    bytes: read('model.mtl'),
    filesOf: (bytes) => ({ 'model.obj': read('model.obj'), ...beside, 'model.mtl': bytes }),
  },
  'usda in usdz': {
    bytes: read('text.usda'),
    filesOf: (bytes) => ({ 'packed.usdz': zipped({ 'model.usda': bytes, 'skin.png': read('skin.png') }) }),
  },
};

/** Files that broke a promise once, with those beside them. */
export const found: Record<string, Files> = Object.fromEntries(
  readdirSync(`${folder}found`).map((name) => [
    name,
    extname(name) === '.mtl'
      ? samples['model.mtl']!.filesOf(read(`found/${name}`))
      : { [name]: read(`found/${name}`), ...beside },
  ]),
);
