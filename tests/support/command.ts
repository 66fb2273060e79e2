import { execFile } from 'node:child_process';
import { mkdtemp, readFile, rm } from 'node:fs/promises';
import { tmpdir } from 'node:os';
import path from 'node:path';
import { promisify } from 'node:util';
import { type Counts, inRepository } from './site';

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
