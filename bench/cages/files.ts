import { existsSync, readdirSync, readFileSync } from 'node:fs';
import { output, root } from '../native.js';
import type { Joint } from '../read-glb.js';
import { cagesFolder, type Figure } from './figures.js';
import type { Person } from './fit-score.js';
import type { Shape } from './shape.js';

/** A figure as `scenes.ts` wrote it. */
export type StoredFigure = Omit<Figure, 'target' | 'cage' | 'landmarks'>;

/** A model as `scenes.ts` wrote it, see bench/native/cages.cpp. */
export interface StoredModel extends Shape {
  groups: ArrayLike<number>;
  parts: string[];
  joints: Joint[];
}

/** A cage as the tool writes it. `used` and `missing` are of a fit. */
export interface StoredCage extends Shape {
  uvs: ArrayLike<number>;
  landmarks: Landmarks;
  used?: Landmarks;
  missing?: string[];
}
/** Name → position. */
export type Landmarks = Record<string, readonly [number, number, number]>;

/** Reads a file of build/cages. @throws if it is not there. */
export const read = <T>(name: string): T => JSON.parse(readFileSync(`${cagesFolder}/${name}.json`, 'utf8')) as T;

/** Whether build/cages has a file. */
export const has = (name: string): boolean => existsSync(`${cagesFolder}/${name}.json`);

/** The figures that are there, or those of them that are named, or of a kind. @throws if there are none. */
export function storedFigures(only: readonly string[]): StoredFigure[] {
  const names = (existsSync(cagesFolder) ? readdirSync(cagesFolder) : [])
    .filter((file) => file.endsWith('.figure.json'))
    .map((file) => file.replace('.figure.json', ''));
  if (names.length === 0) throw new Error(`no figures in ${cagesFolder}: run npx tsx bench/cages/scenes.ts first`);
  const all = names.sort().map((name) => read<StoredFigure>(`${name}.figure`));
  return all.filter(({ name, kind }) => only.length === 0 || only.includes(name) || only.includes(kind));
}

/** What a fit to a figure is scored with. */
export const personOf = ({ name, truth, source }: StoredFigure): Person & { target: StoredModel } => ({
  target: read<StoredModel>(`${name}.model`),
  truth,
  landmarks: read(`${name}.landmarks`),
  ...(source && { source: source.points }),
});

const tool = `${root}build/release/bench/cagecast_cages_tool`;

/** Runs the native tool. @returns its last line: time and outcome. */
export async function runTool(...args: string[]): Promise<string> {
  if (!existsSync(tool)) throw new Error(`no ${tool}: cmake --build --preset release --target cagecast_cages_tool`);
  try {
    return (await output(tool, args)).stdout.trim().split('\n').at(-1)!;
  } catch (error) {
    // Without the command line.
    return (error as Error).message.replace(/^.* failed \(exit \d+\): /s, '').trim();
  }
}
