import { createHash } from 'node:crypto';
import { readFile, writeFile } from 'node:fs/promises';
import { gzipSync } from 'node:zlib';
import { buildNative, nativeProgram, output, root } from './native.js';
import { makeScenes, sampleScene } from './scenes.js';

export type Preset = 'paper' | 'default';
export type Processor = 'x86_64' | 'aarch64';

/** How many instructions one transfer takes on a processor, and the compiler that chose them. */
export interface InstructionCount {
  perRun: number;
  compiler: string;
}

/**
 * What a transfer and the package cost, as recorded: a guard against accidents, on any machine, however busy, as it has
 * instructions and bytes and no times. A commit that needs more records more (`npm run bench -- --record`), and says why in a line.
 */
export interface Budget {
  /** SHA-256 of the sample's scene file: counts of another model cannot be compared. */
  scene: string;
  /** Instructions per transfer of the sample, as last recorded. */
  instructions: Record<Preset, Record<Processor, InstructionCount>>;
  /** Bytes of each file, gzipped, as last recorded. */
  gz: Record<string, number>;
  /** How much of each the project may have: lines, exported names, words (`wasm/tools/lint/scale.mjs`). */
  scale: Record<string, number>;
}

/** By which share counts and sizes may exceed what is recorded. */
const kTolerance = { instructions: 0.15, gz: 0.1 };

/** The files whose size counts. */
const kSizedFiles = {
  'cagecast.wasm': 'dist/cagecast.wasm',
  'cagecast (WebAssembly inlined)': 'dist/index.js',
  'cagecast-cages.wasm': 'dist/cagecast-cages.wasm',
};

const file = `${root}bench/budget.json`;

/** The size of each file, gzipped. */
export async function measureSizes(): Promise<Record<string, number>> {
  const sizes: Record<string, number> = {};
  for (const [name, path] of Object.entries(kSizedFiles))
    sizes[name] = gzipSync(await readFile(root + path), { level: 9 }).length;
  return sizes;
}

/**
 * Counts the instructions of a transfer of the sample: on x86-64 by Valgrind, on 64-bit ARM by QEMU with a plugin of ours. What
 * many runs take beyond a few, per run: reading the file and the first run's allocations fall out.
 */
export async function countInstructions(processor: Processor, preset: Preset): Promise<InstructionCount> {
  const isArm = processor === 'aarch64';
  if (isArm) await buildNative('aarch64');
  const program = nativeProgram(isArm ? 'aarch64' : 'release');
  const counter = isArm
    ? ['qemu-aarch64', '-plugin', `${root}build/release/bench/libcagecast_count_instructions.so`]
    : ['valgrind', '--tool=callgrind', '--callgrind-out-file=/dev/null'];
  const count = async (runs: number): Promise<{ instructions: number; compiler: string }> => {
    const [command, ...args] = [...counter, program, sampleScene.path, '--contestants', preset, '--runs', String(runs)];
    const { stdout, stderr } = await output(command!, args);
    const found = /Collected : (\d+)|^instructions (\d+)/m.exec(stderr);
    if (found === null) throw new Error(`no instruction count in: ${stderr.trim()}`);
    return { instructions: Number(found[1] ?? found[2]), compiler: JSON.parse(stdout).compiler };
  };
  const [few, many] = [2, 12];
  const { instructions, compiler } = await count(many);
  return { perRun: Math.round((instructions - (await count(few)).instructions) / (many - few)), compiler };
}

/** Makes the sample's scene file, and returns its fingerprint. */
async function sampleFingerprint(): Promise<string> {
  await buildNative();
  await makeScenes([sampleScene], () => {});
  return createHash('sha256')
    .update(await readFile(sampleScene.path))
    .digest('hex');
}

/** Records counts and sizes as those that later ones are held against. */
export async function recordBudget(): Promise<Budget> {
  const scene = await sampleFingerprint();
  const both = async (preset: Preset) => ({
    x86_64: await countInstructions('x86_64', preset),
    aarch64: await countInstructions('aarch64', preset),
  });
  const budget: Budget = {
    ...(await readBudget()),
    scene,
    instructions: { paper: await both('paper'), default: await both('default') },
    gz: await measureSizes(),
  };
  await writeFile(file, `${JSON.stringify(budget, null, 2)}\n`);
  return budget;
}

const readBudget = async (): Promise<Budget> => JSON.parse(await readFile(file, 'utf8')) as Budget;

/**
 * Counts anew and holds the count against the recorded one.
 * @return Each fault, in a sentence with its remedy; empty if there is none.
 */
export async function checkInstructions(processor: Processor, preset: Preset): Promise<string> {
  const { scene, instructions } = await readBudget();
  if ((await sampleFingerprint()) !== scene)
    return 'bench/budget.json was recorded for another sample model; record it again: npm run bench -- --record';
  const recorded = instructions[preset][processor];
  const now = await countInstructions(processor, preset);
  if (now.perRun <= recorded.perRun * (1 + kTolerance.instructions)) return '';
  const more = ((100 * now.perRun) / recorded.perRun - 100).toFixed(1);
  const compiler =
    now.compiler === recorded.compiler
      ? ''
      : ` But it was recorded with compiler ${recorded.compiler}, and this is ${now.compiler}: on the recorded one the count may be within it.`;
  return `a transfer of the sample with the preset \`${preset}\` takes ${now.perRun} ${processor} instructions, ${more} % more than the ${recorded.perRun} recorded; at most ${100 * kTolerance.instructions} % are allowed.${compiler}`;
}

/** Holds the sizes of the built package against those recorded; as `checkInstructions`. */
export async function checkSizes(): Promise<string> {
  const { gz } = await readBudget();
  const sizes = await measureSizes();
  return Object.entries(gz)
    .filter(([name, recorded]) => !(sizes[name]! <= recorded * (1 + kTolerance.gz)))
    .map(
      ([name, recorded]) =>
        `${name} has ${sizes[name]} bytes gzipped, more than ${100 * kTolerance.gz} % above the ${recorded} recorded`,
    )
    .join('; ');
}
