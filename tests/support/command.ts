import assert from 'node:assert/strict';
import { execFile, spawnSync } from 'node:child_process';
import { mkdtemp, readFile, rm } from 'node:fs/promises';
import { tmpdir } from 'node:os';
import path from 'node:path';
import { promisify } from 'node:util';
import { type Counts, inRepository } from './site';

/** What a run of the command came to. */
export interface Finished {
  status: number | null;
  stdout: string;
  stderr: string;
}

const kProgram = inRepository('dist/cli.js');

/** Runs the command. */
export const cagecast = async (...args: string[]): Promise<Finished> => {
  const { status, stdout, stderr } = spawnSync(process.execPath, [kProgram, ...args], { encoding: 'utf8' });
  return { status, stdout, stderr };
};

/** Runs the command with the words of a line, and more arguments as they are. */
export const run = (line: string, ...more: string[]): Promise<Finished> => cagecast(...line.split(' '), ...more);

/** The same; what it prints. Asserts that it ends well. */
export async function ok(line: string, ...more: string[]): Promise<string> {
  const { status, stdout, stderr } = await run(line, ...more);
  assert.deepEqual([status, stderr], [0, ''], [line, ...more].join(' '));
  return stdout;
}

/** Asserts that it ends with an exit code and prints one line, an error. */
export async function fails(status: number, message: RegExp | string, line: string, ...more: string[]): Promise<void> {
  const finished = await run(line, ...more);
  const label = [line, ...more].join(' ');
  if (typeof message === 'string') assert.equal(finished.stderr, `cagecast: ${message}\n`, label);
  else assert.match(finished.stderr, message, label);
  assert.match(finished.stderr, /^cagecast: [^\n]+\n$/, label);
  assert.deepEqual([finished.status, finished.stdout], [status, ''], label);
}

/** Flags of `cagecast transfer`. */
export interface Flags {
  threshold?: number;
  preset?: 'default' | 'paper';
  keep?: string;
  exclude?: string;
}

/** The part of a report that the page shows too. */
export interface Report {
  counts: Counts;
  segments: { part: string; points: number; area: number; exposedArea: number; coveredArea: number; culled: boolean }[];
}

/** The report of `cagecast transfer`. */
export async function report(target: string, cage: string, flags: Flags = {}): Promise<Report> {
  const folder = await mkdtemp(path.join(tmpdir(), 'cagecast-report-'));
  try {
    const file = path.join(folder, 'report.json');
    const words = Object.entries(flags).flatMap(([name, value]) => [`--${name}`, String(value)]);
    await promisify(execFile)(process.execPath, [
      inRepository('dist/cli.js'),
      'transfer',
      target,
      '--cage',
      cage,
      ...words,
      '--report',
      file,
    ]);
    return JSON.parse(await readFile(file, 'utf8'));
  } finally {
    await rm(folder, { recursive: true, force: true });
  }
}

/** The counts in the report of `cagecast transfer`. */
export async function reportedCounts(target: string, cage: string, flags: Flags = {}): Promise<Counts> {
  const { cosmetic, occluded, uncovered, culled } = (await report(target, cage, flags)).counts;
  return { cosmetic, occluded, uncovered, culled };
}

/** The answer of `cagecast inspect`. */
export async function inspection(
  target: string,
  cage: string,
): Promise<{ verdict: string; findings: { sentence: string; advice: string }[] }> {
  const words = [inRepository('dist/cli.js'), 'inspect', target, '--cage', cage, '--json'];
  // Exit code 3: the cage is unfit.
  const { stdout } = await promisify(execFile)(process.execPath, words).catch(
    (error: { code: number; stdout: string }) => {
      if (error.code === 3) return error;
      throw error;
    },
  );
  return JSON.parse(stdout);
}
