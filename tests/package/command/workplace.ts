// The folder in which the tests of a file work, and the models in it.
import { readFileSync, writeFileSync } from 'node:fs';
import { resolve } from 'node:path';
import { after, before } from 'node:test';
import { fileURLToPath } from 'node:url';
import { type GLTF, NodeIO } from '@gltf-transform/core';
import { ALL_EXTENSIONS } from '@gltf-transform/extensions';
import { init } from 'cagecast';
import { PNG } from 'pngjs';
import { GlbMaker, glbOf, packGlb, unpackGlb } from '../../support/gltf.js';
import { temporaryFolder } from '../../support/temporary.js';
import { head, modelFolders, type Scene } from '../scenes.js';

/** A path in the repository. */
export const inRepository = (path: string): string => fileURLToPath(new URL(`../../../${path}`, import.meta.url));

/** Folders of real models: some of the samples, and all of CAGECAST_ASSETS where that is set. Has to be called before `workplace`. */
export const modelsLike = (samples: RegExp): string[] =>
  modelFolders()
    .filter((folder) => !folder.startsWith('examples') || samples.test(folder))
    .map((folder) => resolve(folder));

/** A picture of one colour. */
export function png(level: number, size = 4): Buffer {
  const image = new PNG({ width: size, height: size });
  image.data.fill(level);
  return PNG.sync.write(image);
}

export const write = (name: string, data: Uint8Array | string): void => writeFileSync(name, data);

/** Makes a folder the current one, with a target.glb, a cage.glb and a paint.png. @returns its path, and the models. */
export function workplace(name: string, { cage, target }: Scene = head(1, 10)) {
  const { folder, at } = temporaryFolder(name);
  const scene = { cage, target: { ...target, groups: undefined } };
  const home = process.cwd();
  process.chdir(folder);
  after(() => process.chdir(home));
  before(init);
  write('target.glb', glbOf(scene.target));
  write('cage.glb', glbOf(scene.cage));
  write('paint.png', png(200));
  return { folder, at, ...scene };
}

type Changed = ReturnType<typeof unpackGlb>;

/** Writes a GLB in which something was changed. */
export function writeChanged(name: string, glb: Uint8Array, change: (json: GLTF.IGLTF, glb: Changed) => void): void {
  const parts = unpackGlb(glb);
  change(parts.json, parts);
  write(name, packGlb(parts));
}

/** Writes a GLB that is made by hand. */
export function writeMade(name: string, make: (maker: GlbMaker) => void): void {
  const maker = new GlbMaker();
  make(maker);
  write(name, maker.finish());
}

export const io = new NodeIO().registerExtensions(ALL_EXTENSIONS);

/** The JSON of a file. */
export const jsonOf = (name: string): GLTF.IGLTF => unpackGlb(readFileSync(name)).json;
