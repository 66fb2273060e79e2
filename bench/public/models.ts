import { existsSync, readdirSync, readFileSync, statSync } from 'node:fs';
import { basename, resolve } from 'node:path';
import type { Mesh } from 'cagecast';
import { readCage, readTarget } from '../read-glb.js';
import { type Labels, labelsOf, readJson } from './labels.js';
import { Misuse } from './misuse.js';

/** The files of a model. */
export interface ModelFiles {
  name: string;
  target: string;
  cage: string;
  labels: string;
}

/** A target with its cage, and what is known of it. */
export interface LabelledModel {
  name: string;
  scene: { cage: Mesh; target: Mesh };
  labels: Labels;
}

const kLabels = ['labels.json', 'truth.json'] as const;

/** Folders that are models, or have models in them. @return A sentence for each folder that is no model. @throws {Misuse} */
export function findModels(folders: readonly string[]): { models: ModelFiles[]; skipped: string[] } {
  const models: ModelFiles[] = [];
  const skipped: string[] = [];
  for (const folder of folders.map((path) => resolve(path))) {
    if (!existsSync(folder) || !statSync(folder).isDirectory()) throw new Misuse(`there is no folder ${folder}`);
    const names = readdirSync(folder, { withFileTypes: true }).filter((entry) => entry.isDirectory());
    const candidates = existsSync(`${folder}/target.glb`)
      ? [folder]
      : names.map(({ name }) => `${folder}/${name}`).sort();
    if (candidates.length === 0) skipped.push(`${folder}: has no target.glb and no folders`);
    for (const path of candidates) {
      const labels = kLabels.find((name) => existsSync(`${path}/${name}`));
      const missing = !existsSync(`${path}/target.glb`)
        ? 'has no target.glb'
        : labels === undefined
          ? `has no ${kLabels.join(' or ')}, which says what must not be painted`
          : existsSync(`${path}/cage.glb`)
            ? undefined
            : `has no cage.glb; make one, in the folder of the project, by: npx cagecast make ${path}/target.glb -o ${path}/cage.glb (or fit a template: npx cagecast fit human-head …)`;
      if (missing !== undefined) skipped.push(`${path}: ${missing}`);
      else
        models.push({
          name: nameFor(basename(path), models),
          target: `${path}/target.glb`,
          cage: `${path}/cage.glb`,
          labels: `${path}/${labels}`,
        });
    }
  }
  return { models, skipped };
}

/** A name, with a number if it is taken. */
export function nameFor(name: string, taken: readonly { name: string }[]): string {
  const count = taken.filter((one) => one.name.replace(/ \d+$/, '') === name).length;
  return count === 0 ? name : `${name} ${count + 1}`;
}

/** Reads the files of a model. @throws {Error} that names the file. */
export async function readModel({ name, ...files }: ModelFiles): Promise<LabelledModel> {
  const of = <T>(path: string, read: Promise<T>): Promise<T> =>
    read.catch((error: Error) => {
      throw new Error(`${path}: ${error.message}`);
    });
  for (const file of [files.target, files.cage])
    if (readFileSync(file).toString('latin1', 0, 4) !== 'glTF') throw new Error(`${file}: is no GLB file`);
  const model = await of(files.target, readTarget(files.target));
  const { positions, indices, uvs } = await of(files.cage, readCage(files.cage));
  if (uvs === undefined) throw new Error(`${files.cage}: has no UVs; the texture is drawn in them`);
  const labels = labelsOf(readJson(files.labels), files.labels, model);
  const { names: _, joints: __, groups = new Uint32Array(model.positions.length / 3), ...target } = model;
  return { name, labels, scene: { cage: { positions, indices, uvs }, target: { ...target, groups } } };
}
