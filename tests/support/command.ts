import assert from 'node:assert/strict';
import { spawnSync } from 'node:child_process';
import path from 'node:path';
import { fileURLToPath, pathToFileURL } from 'node:url';
import type { Counts } from './site';

/** The program. */
export const kProgram = fileURLToPath(new URL('../../dist/cli.js', import.meta.url));

/** The function that the program calls. */
export const { runCommand } = (await import(pathToFileURL(path.join(path.dirname(kProgram), 'command.js')).href)) as {
  runCommand(
    args: readonly string[],
    streams: { stdout(data: Uint8Array | string): void; stderr(text: string): void; columns?: number },
  ): Promise<number>;
};

/** What a run of the command came to. */
export interface Finished {
  status: number | null;
  stdout: string;
  stderr: string;
}

/** Runs the command in this process. */
export async function cagecast(...args: string[]): Promise<Finished> {
  const finished = { stdout: '', stderr: '' };
  const status = await runCommand(args, {
    stdout: (data) => void (finished.stdout += Buffer.from(data).toString()),
    stderr: (text) => void (finished.stderr += text),
  });
  return { status, ...finished };
}

/** Runs the command as a process of its own, in the current folder, with an input and by another program if there are any. */
export function cagecastProcess(
  args: readonly string[],
  { input, by = [], node = [] }: { input?: Uint8Array; by?: readonly string[]; node?: readonly string[] } = {},
): Omit<Finished, 'stdout'> & { stdout: Buffer } {
  const [program, ...words] = [...by, process.execPath, ...node, kProgram, ...args];
  const { status, stdout, stderr } = spawnSync(program!, words, { timeout: 60_000, ...(input && { input }) });
  return { status, stdout, stderr: stderr.toString() };
}

/** The arguments of a line, and more as they are. */
const wordsOf = (line: string, more: readonly string[]): string[] => [...line.split(' '), ...more];

/** Runs the command with the words of a line, and more arguments as they are. */
export const run = (line: string, ...more: string[]): Promise<Finished> => cagecast(...wordsOf(line, more));

/** The same; what it prints. Asserts that it ends well. */
export async function ok(line: string, ...more: string[]): Promise<string> {
  const { status, stdout, stderr } = await run(line, ...more);
  assert.deepEqual([status, stderr], [0, ''], [line, ...more].join(' '));
  return stdout;
}

/** The same with --json. @param status  The exit code. */
export async function json<Report = object>(line: string, status = 0): Promise<Report> {
  const finished = await run(`${line} --json`);
  assert.deepEqual([finished.status, finished.stderr], [status, ''], line);
  return JSON.parse(finished.stdout) as Report;
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
export async function report(target: string, cage: string, { preset, ...flags }: Flags = {}): Promise<Report> {
  const words = Object.entries(flags).flatMap(([name, value]) => [`--${name}`, String(value)]);
  if (preset) words.push('--set', `preset=${preset}`);
  const { stdout } = await cagecast('transfer', target, '--cage', cage, ...words, '--json');
  return JSON.parse(stdout);
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
  const { stdout } = await cagecast('inspect', target, '--cage', cage, '--json');
  return JSON.parse(stdout);
}
