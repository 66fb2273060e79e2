// Reads many versions of a small file of each format; `npm run fuzz -- formats` calls it.
import { createHash } from 'node:crypto';
import { writeFileSync } from 'node:fs';
import { extname } from 'node:path';
import fc from 'fast-check';
import { mutantsOf } from './edits.js';
import { Reader } from './reader.js';
import { type Sample, samples } from './samples.js';

export interface Budget {
  /** Of the processor, for all formats. */
  seconds: number;
  /** At most as many versions of each file. */
  files: number;
  seed: number;
  /** Where to write what breaks a promise. */
  found: string;
}

export interface Row {
  name: string;
  inputs: number;
  /** How many could be read. */
  read: number;
  seconds: number;
  /** The most that one took, in milliseconds of the processor and in megabytes. */
  worst: [milliseconds: number, megabytes: number];
  faults: string[];
}

/** As many versions are tried before the next seed; a seed repeats them. */
const kBatch = 200;
/** As many more are tried to find a smaller file with the same fault. */
const kTries = 60;

/** @param only  The names of samples; all, if there are none. @throws if there is no such sample. */
export async function fuzzFormats(only: readonly string[], budget: Budget): Promise<Row[]> {
  const chosen = Object.entries(samples).filter(([name]) => only.length === 0 || only.includes(name));
  const rows: Row[] = [];
  let left = budget.seconds;
  for (const [i, [name, sample]] of chosen.entries()) {
    // What one does not need is for those after it.
    const row = await fuzz(name, sample, { ...budget, seconds: left / (chosen.length - i) });
    console.log(`  ${name}: ${row.inputs} files, ${Math.round(row.seconds)} s`);
    left -= row.seconds;
    rows.push(row);
  }
  return rows;
}

/** A fault without numbers and names of the file, so that it counts once. */
const kindOf = (fault: string): string =>
  fault
    .split('\n', 1)[0]!
    .replace(/[\d.]+|"[^"]*"/g, '#')
    .slice(0, 160);

async function fuzz(name: string, sample: Sample, { seconds, files, seed, found }: Budget): Promise<Row> {
  const reader = new Reader(sample.filesOf(sample.bytes));
  const row: Row = { name, inputs: 0, read: 0, seconds: 0, worst: [0, 0], faults: [] };
  const known = new Set<string>();
  const isOver = () => row.seconds >= seconds || row.inputs >= files;
  for (let batch = seed; !isOver(); ++batch) {
    let [kind, triesLeft] = ['', Infinity];
    const property = fc.asyncProperty(mutantsOf(sample.bytes), async (bytes) => {
      if (triesLeft-- <= 0 || (kind === '' && isOver())) return;
      const { fault, isRead, milliseconds, megabytes } = await reader.check(sample.filesOf(bytes));
      ++row.inputs;
      row.read += Number(isRead);
      row.seconds += milliseconds / 1000;
      row.worst = [Math.max(row.worst[0], milliseconds), Math.max(row.worst[1], megabytes)];
      if (fault === undefined || known.has(kindOf(fault)) || (kind !== '' && kindOf(fault) !== kind)) return;
      if (kind === '') [kind, triesLeft] = [kindOf(fault), kTries];
      throw new Error(fault);
    });
    const { counterexample, errorInstance } = await fc.check(property, { seed: batch, numRuns: kBatch });
    if (kind === '' && errorInstance) throw errorInstance;
    if (!counterexample) continue;
    known.add(kind);
    const file = `formats-${createHash('sha256').update(kind).digest('hex').slice(0, 8)}-${name.replaceAll(' ', '-')}`;
    // The whole file: of what is packed, with what packs it.
    writeFileSync(`${found}/${file}`, Object.values(sample.filesOf(counterexample[0]))[0]!);
    if (extname(name) === '.mtl') writeFileSync(`${found}/${file}`, counterexample[0]);
    row.faults.push(`${file}: ${(errorInstance as Error).message.split('\n', 1)[0]} (--seed ${batch} ${name})`);
    console.log(`  ${row.faults.at(-1)}`);
  }
  reader.end();
  return row;
}
