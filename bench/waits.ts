import { spawnSync } from 'node:child_process';
import { existsSync, mkdirSync } from 'node:fs';
import { join } from 'node:path';
import { root } from './native.js';
import { median } from './statistics.js';
import { table } from './table.js';

/** Milliseconds of processor time by step. */
type Steps = Record<string, number>;

/** What one model waits for, by command; without those that do not take it. */
export type Waits = Record<string, Steps>;

const kSamples = ['human/target', 'human-body/target', 'avatar/avatar', 'lizard/target', 'car/target'];

/** Open avatars, of those that `bench/avatars` names. */
const kAvatars = [
  ...['rpm_man.glb', 'rpm_sport.glb', 'kana_sitting.glb', 'meebit.vrm', 'q_suit.glb', 'valid_aian_m_milit.glb'],
  ...['bee_bot.glb', 'c4d_female.glb', 'tripo_cat.glb', 'mixamo_xbot_fbx.fbx', 'rpm_girl_fbx.fbx'],
];

/** The columns of the table, and the steps in each, as commands name them. */
const kColumns = {
  start: ['start'],
  read: ['reading'],
  colours: ['looking'],
  landmarks: ['landmarks'],
  hull: ['hull', 'making', 'fitting', 'choosing'],
  shape: ['holes', 'simplify', 'enclose', 'fit', 'push out'],
  charts: ['unwrap'],
  transfer: ['transferring'],
  inspect: ['inspecting', 'inspect', 'done'],
  write: ['writing'],
};

const out = `${root}build/bench/waits`;

function run(runs: number, ...args: string[]): Steps | undefined {
  const all: Steps[] = [];
  for (let i = 0; i < runs; ++i) {
    const { status, stdout } = spawnSync(process.execPath, [`${root}bench/waits/run.mjs`, ...args], {
      encoding: 'utf8',
      cwd: root,
    });
    if (status !== 0) return undefined;
    all.push(JSON.parse(stdout) as Steps);
  }
  return Object.fromEntries(Object.keys(all[0]!).map((step) => [step, median(all.map((one) => one[step] ?? 0))]));
}

/**
 * Measures where the processor time of commands goes, from the start of their process to the written file.
 * @param folder  Of avatars, beside the samples. Those that are absent are left out.
 */
export function measureWaits(folder: string | undefined, runs: number, say: (line: string) => void) {
  mkdirSync(out, { recursive: true });
  const models = [
    ...kSamples.map((name) => [name.split('/')[0]!, `${root}examples/samples/${name}.glb`] as const),
    ...(folder ? kAvatars.map((name) => [name, join(folder, name)] as const) : []),
  ];
  const waits: Record<string, Waits> = {};
  for (const [name, path] of models.filter(([, path]) => existsSync(path))) {
    say(`waits: ${name}`);
    const [cage, painted] = [`${out}/cage.glb`, `${out}/painted.glb`];
    const paint = `${root}examples/samples/human/paint-makeup.png`;
    const of = {
      'fit auto': run(runs, 'fit', path, '--template', 'auto', '-o', cage),
      make: run(runs, 'make', path, '-o', cage),
      'fit human-head': run(runs, 'fit', path, '--template', 'human-head', '-o', cage),
      transfer: run(runs, 'transfer', path, '--cage', cage, '--texture', paint, '-o', painted),
      'glTF-Transform': run(runs, 'rewrite', path, painted),
    };
    waits[name] = Object.fromEntries(Object.entries(of).flatMap(([door, steps]) => (steps ? [[door, steps]] : [])));
  }
  return waits;
}

const sumOf = (steps: Steps): number => Object.values(steps).reduce((sum, ms) => sum + ms, 0);

/** A line for each model and command: the time, and the share of each step in it. */
export function waitsTable(waits: Record<string, Waits>): string {
  const lines = Object.entries(waits).flatMap(([model, doors]) =>
    Object.entries(doors).map(([door, steps]) => {
      const all = sumOf(steps);
      const shares = Object.values(kColumns).map((names) =>
        names.reduce((sum, name) => sum + (steps[name] ?? 0) / all, 0),
      );
      return [
        model,
        door,
        all.toFixed(0),
        ...shares.map((share) => (share < 0.005 ? '' : `${(100 * share).toFixed(0)} %`)),
      ];
    }),
  );
  return table(['model', 'command', 'ms', ...Object.keys(kColumns)], lines);
}
