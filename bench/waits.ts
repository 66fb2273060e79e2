import { spawnSync } from 'node:child_process';
import { existsSync, mkdirSync } from 'node:fs';
import { join } from 'node:path';
import { NodeIO } from '@gltf-transform/core';
import { PNG } from 'pngjs';
import { root } from './native.js';
import { resized } from './resize.js';
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
const paint = `${root}examples/samples/human/paint-makeup.png`;

/** Medians of what a command takes; nothing if it fails. */
function run(runs: number, ...args: string[]): { steps: Steps; memory: number } | undefined {
  const all: { steps: Steps; memory: number }[] = [];
  for (let i = 0; i < runs; ++i) {
    const { status, stdout } = spawnSync(process.execPath, [`${root}bench/waits/run.mjs`, ...args], {
      encoding: 'utf8',
      cwd: root,
    });
    if (status !== 0) return undefined;
    all.push(JSON.parse(stdout) as (typeof all)[number]);
  }
  const steps = Object.keys(all[0]!.steps).map((step) => [step, median(all.map((one) => one.steps[step] ?? 0))]);
  return { steps: Object.fromEntries(steps) as Steps, memory: median(all.map((one) => one.memory)) };
}

/** The models that are measured: the samples, and of open avatars those that a folder has. */
export const modelsOf = (folder: string | undefined): (readonly [name: string, path: string])[] =>
  [
    ...kSamples.map((name) => [name.split('/')[0]!, `${root}examples/samples/${name}.glb`] as const),
    ...(folder ? kAvatars.map((name) => [name, join(folder, name)] as const) : []),
  ].filter(([, path]) => existsSync(path));

/**
 * Measures where the processor time of commands goes, from the start of their process to the written file.
 * @param folder  Of avatars, beside the samples. Those that are absent are left out.
 */
export function measureWaits(folder: string | undefined, runs: number, say: (line: string) => void) {
  mkdirSync(out, { recursive: true });
  const waits: Record<string, Waits> = {};
  for (const [name, path] of modelsOf(folder)) {
    say(`waits: ${name}`);
    const [cage, painted] = [`${out}/cage.glb`, `${out}/painted.glb`];
    const of = {
      'fit auto': run(runs, 'fit', path, '--template', 'auto', '-o', cage),
      make: run(runs, 'make', path, '-o', cage),
      'fit human-head': run(runs, 'fit', path, '--template', 'human-head', '-o', cage),
      transfer: run(runs, 'transfer', path, '--cage', cage, '--texture', paint, '-o', painted),
      'glTF-Transform': run(runs, 'rewrite', path, painted),
    };
    waits[name] = Object.fromEntries(Object.entries(of).flatMap(([door, took]) => (took ? [[door, took.steps]] : [])));
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

/** What commands take of one figure, in milliseconds and bytes. */
export interface Growth {
  triangles: number;
  /** Pixels of a side of its texture. */
  texture: number;
  took: Record<string, { ms: number; bytes: number }>;
}

const kTriangles = [10_000, 50_000, 200_000, 1_000_000];
const kTextures = [512, 2048, 4096, 8192];

/** Measures how the costs of the sample's head grow with its triangles, and with its texture. */
export async function measureGrowth(runs: number, say: (line: string) => void): Promise<Growth[]> {
  mkdirSync(out, { recursive: true });
  const growth: Growth[] = [];
  const sizes = [
    ...kTriangles.map((triangles) => [triangles, 512] as const),
    ...kTextures.map((side) => [10_000, side] as const),
  ];
  for (const [triangles, texture] of sizes.filter(([, side], i) => i < kTriangles.length || side !== 512)) {
    say(`growth: ${triangles} triangles, ${texture}²`);
    const [model, cage, painted] = [`${out}/grown.glb`, `${out}/cage.glb`, `${out}/painted.glb`];
    await writeGrown(triangles, texture, model);
    const took: Growth['took'] = {};
    for (const [name, ...args] of [
      ['fit', 'fit', model, '--template', 'human-head', '-o', cage],
      ['transfer', 'transfer', model, '--cage', cage, '--texture', paint, '-o', painted],
      ['make', 'make', model, '-o', cage],
    ] as [string, ...string[]][]) {
      const found = run(runs, ...args);
      if (found) took[name] = { ms: sumOf(found.steps), bytes: found.memory };
    }
    growth.push({ triangles, texture, took });
  }
  return growth;
}

/** The sample's head with so many triangles, whose skin has a texture of so many pixels a side. */
async function writeGrown(triangles: number, texture: number, path: string): Promise<void> {
  const io = new NodeIO();
  const document = await io.read(`${root}examples/samples/human/target.glb`);
  const all = document
    .getRoot()
    .listMeshes()
    .flatMap((mesh) => mesh.listPrimitives());
  const count = all.reduce((sum, one) => sum + one.getIndices()!.getCount() / 3, 0);
  for (const primitive of all) {
    const indices = Uint32Array.from(primitive.getIndices()!.getArray()!);
    const positions = Float32Array.from(primitive.getAttribute('POSITION')!.getArray()!);
    const grown = await resized({ positions, indices }, Math.round((triangles * indices.length) / 3 / count));
    for (const name of primitive.listSemantics()) primitive.setAttribute(name, null);
    const accessor = (type: 'VEC2' | 'VEC3' | 'SCALAR', array: Float32Array | Uint32Array) =>
      document
        .createAccessor()
        .setType(type)
        .setArray(array as never)
        .setBuffer(document.getRoot().listBuffers()[0]!);
    const uvs = Float32Array.from(
      { length: (grown.positions.length / 3) * 2 },
      (_, i) => grown.positions[3 * (i >> 1) + (i & 1)]! % 1,
    );
    primitive
      .setAttribute('POSITION', accessor('VEC3', grown.positions))
      .setAttribute('TEXCOORD_0', accessor('VEC2', uvs))
      .setIndices(accessor('SCALAR', grown.indices));
  }
  const image = new PNG({ width: texture, height: texture });
  for (let i = 0; i < image.data.length; ++i) image.data[i] = i % 4 === 3 ? 255 : 150 + (((i * i) >> 7) % 50);
  const skin = document.createTexture().setMimeType('image/png').setImage(PNG.sync.write(image));
  for (const material of document.getRoot().listMaterials())
    if (/skin/i.test(material.getName())) material.setBaseColorTexture(skin);
  await io.write(path, document);
}

/** A line for each figure. */
export const growthTable = (growth: readonly Growth[]): string =>
  table(
    ['triangles', 'texture', ...['fit', 'make', 'transfer'].flatMap((name) => [`${name}, s`, 'MB'])],
    growth.map(({ triangles, texture, took }) => [
      triangles.toLocaleString('en'),
      `${texture}²`,
      ...['fit', 'make', 'transfer'].flatMap((name) =>
        took[name] ? [(took[name].ms / 1000).toFixed(1), (took[name].bytes / 1e6).toFixed(0)] : ['', ''],
      ),
    ]),
  );
