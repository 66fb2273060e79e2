import { createHash } from 'node:crypto';
import { readFile, writeFile } from 'node:fs/promises';
import { countAarch64, countX86, type InstructionCount, type Preset } from './instructions.js';
import { buildNative, root } from './native.js';
import { makeScenes, sampleScene } from './scenes.js';
import { measureSizes } from './size.js';

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
}

/** By which share counts and sizes may exceed what is recorded. */
const tolerance = { instructions: 0.15, gz: 0.1 };

const file = `${root}bench/budget.json`;

export async function readBudget(): Promise<Budget> {
  return JSON.parse(await readFile(file, 'utf8')) as Budget;
}

/** Makes the sample's scene file, and returns its fingerprint. */
export async function sampleFingerprint(): Promise<string> {
  await buildNative();
  await makeScenes([sampleScene], () => {});
  return createHash('sha256')
    .update(await readFile(sampleScene.path))
    .digest('hex');
}

/** Records counts and sizes as those that later ones are held against. */
export async function recordBudget(): Promise<Budget> {
  const scene = await sampleFingerprint();
  const gz = Object.fromEntries(Object.entries(await measureSizes()).map(([name, size]) => [name, size.gz]));
  const budget: Budget = {
    scene,
    instructions: { paper: await countBoth('paper'), default: await countBoth('default') },
    gz,
  };
  await writeFile(file, `${JSON.stringify(budget, null, 2)}\n`);
  return budget;
}

const processors = { x86_64: countX86, aarch64: countAarch64 };
type Processor = keyof typeof processors;

async function countBoth(preset: Preset): Promise<Record<Processor, InstructionCount>> {
  return { x86_64: await countX86(sampleScene.path, preset), aarch64: await countAarch64(sampleScene.path, preset) };
}

/**
 * Counts anew and holds the count against the recorded one.
 * @return What is wrong, in a sentence that says what to do; empty if nothing is.
 */
export async function checkInstructions(processor: Processor, preset: Preset): Promise<string> {
  const { scene, instructions } = await readBudget();
  if ((await sampleFingerprint()) !== scene) {
    return 'bench/budget.json was recorded for another sample model; record it again: npm run bench -- --record';
  }
  const recorded = instructions[preset][processor];
  const now = await processors[processor](sampleScene.path, preset);
  if (now.perRun <= recorded.perRun * (1 + tolerance.instructions)) return '';
  const more = ((100 * now.perRun) / recorded.perRun - 100).toFixed(1);
  const compiler =
    now.compiler === recorded.compiler
      ? ''
      : ` But it was recorded with compiler ${recorded.compiler}, and this is ${now.compiler}: on the recorded one the count may be within it.`;
  return `a transfer of the sample with the preset \`${preset}\` takes ${now.perRun} ${processor} instructions, ${more} % more than the ${recorded.perRun} recorded; at most ${100 * tolerance.instructions} % are allowed.${compiler}`;
}

/** Holds the sizes of the built package against those recorded; as `checkInstructions`. */
export async function checkSizes(): Promise<string> {
  const { gz } = await readBudget();
  const sizes = await measureSizes();
  return Object.entries(gz)
    .filter(([name, recorded]) => !(sizes[name]!.gz <= recorded * (1 + tolerance.gz)))
    .map(
      ([name, recorded]) =>
        `${name} has ${sizes[name]!.gz} bytes gzipped, more than ${100 * tolerance.gz} % above the ${recorded} recorded`,
    )
    .join('; ');
}
