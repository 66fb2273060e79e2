import { createHash } from 'node:crypto';
import { readFile, writeFile } from 'node:fs/promises';
import { countAarch64, countX86, type InstructionCount, type Preset } from './instructions.js';
import { buildNative, root } from './native.js';
import { makeScenes, sampleScene } from './scenes.js';
import { measureSizes } from './size.js';

/** What a change may cost. It holds on any machine, however busy: instructions and bytes, no times. */
export interface Budget {
  /** SHA-256 of the sample's scene file: counts of another model cannot be compared. */
  scene: string;
  /** Instructions per transfer of the sample, as last recorded. */
  instructions: Record<Preset, Record<Processor, InstructionCount>>;
  /** The most bytes that a file may have, gzipped. */
  gz: Record<string, number>;
}

/** Counts may exceed what is recorded by this share. */
export const tolerance = 0.03;

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

/** Records the counts of now as those that later ones are held against. The limits of sizes stay. */
export async function recordBudget(): Promise<Budget> {
  const scene = await sampleFingerprint();
  const { gz } = await readBudget();
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
  if (now.perRun <= recorded.perRun * (1 + tolerance)) return '';
  const more = ((100 * now.perRun) / recorded.perRun - 100).toFixed(1);
  const compiler =
    now.compiler === recorded.compiler
      ? ''
      : ` But it was recorded with compiler ${recorded.compiler}, and this is ${now.compiler}: on the recorded one the count may be within it.`;
  return `a transfer of the sample with the preset \`${preset}\` takes ${now.perRun} ${processor} instructions, ${more} % more than the ${recorded.perRun} recorded; at most ${100 * tolerance} % are allowed.${compiler}`;
}

/** Holds the sizes of the built package against their limits; as `checkInstructions`. */
export async function checkSizes(): Promise<string> {
  const { gz } = await readBudget();
  const sizes = await measureSizes();
  return Object.entries(gz)
    .filter(([name, limit]) => !(sizes[name]!.gz <= limit))
    .map(([name, limit]) => `${name} has ${sizes[name]!.gz} bytes gzipped; at most ${limit} are allowed`)
    .join('; ');
}
