import { spawn } from 'node:child_process';
import { mkdir, writeFile } from 'node:fs/promises';
import { cpus } from 'node:os';
import { fileURLToPath } from 'node:url';
import { median } from './statistics.js';

/** The folder of the checkout, with a slash at its end. */
export const root = fileURLToPath(new URL('..', import.meta.url));

/** Where results are kept. */
export const resultsFolder = `${root}bench/results`;

/** What results were measured on. */
export const kMachine = { processor: cpus()[0]!.model, cores: cpus().length, node: process.versions.node };

/** Writes numbers with six digits: more than they are good for. What has no parts of its own is kept on one line. */
export async function writeJson(name: string, results: unknown): Promise<void> {
  await mkdir(resultsFolder, { recursive: true });
  const rounded = (_: string, value: unknown): unknown =>
    typeof value === 'number' ? Number(value.toPrecision(6)) : value;
  const text = JSON.stringify(results, rounded, 1);
  await writeFile(
    `${resultsFolder}/${name}.json`,
    `${text.replace(/\{[^{}[\]]*\}|\[[^{}[\]]*\]/g, (leaf) => leaf.replace(/\s+/g, ' '))}\n`,
  );
}

/** Runs a program and returns what it printed. */
export function output(command: string, args: readonly string[]): Promise<{ stdout: string; stderr: string }> {
  return new Promise((resolve, reject) => {
    const child = spawn(command, args, { cwd: root, stdio: ['ignore', 'pipe', 'pipe'] });
    let stdout = '';
    let stderr = '';
    child.stdout.on('data', (data) => (stdout += data));
    child.stderr.on('data', (data) => (stderr += data));
    child.on('error', reject);
    child.on('close', (status) => {
      if (status === 0) resolve({ stdout, stderr });
      else reject(new Error(`${command} ${args.join(' ')} failed (exit ${status}): ${stderr.trim() || stdout.trim()}`));
    });
  });
}

/** The steps, as `cagecast_bench` names them. */
export const kStages = [
  'weld',
  'build',
  'project',
  'occluded',
  'covered',
  'segments',
  'recheck',
  'holes',
  'seams',
  'classify',
  'total',
] as const;
export type Stage = (typeof kStages)[number];

/** What `cagecast_bench` prints; times in ms of CPU time, run by run. */
export interface NativeResult {
  compiler: string;
  triangles: number;
  vertices: number;
  points: number;
  cageTriangles: number;
  contestants: Record<
    string,
    {
      times: Record<Stage, number[]>;
      /** Of the library's presets. */
      hash?: string;
      peakBytes?: number;
      /** Of peers: at how many vertices they say another zone. */
      otherZones?: number;
    }
  >;
}

export const nativeProgram = (preset: 'release' | 'aarch64'): string => `${root}build/${preset}/bench/cagecast_bench`;

/** Builds the native benchmark. */
export async function buildNative(preset: 'release' | 'aarch64' = 'release'): Promise<void> {
  const targets = preset === 'release' ? ['cagecast_bench', 'cagecast_count_instructions'] : ['cagecast_bench'];
  await output('cmake', ['--preset', preset, '-Wno-dev', '--log-level=WARNING']);
  await output('cmake', ['--build', '--preset', preset, '--target', ...targets]);
}

/** Measures contestants with one scene file, in turns. */
export async function measureNative(scene: string, runs: number, contestants: string[]): Promise<NativeResult> {
  const args = [scene, '--runs', String(runs), '--contestants', contestants.join(',')];
  return JSON.parse((await output(nativeProgram('release'), args)).stdout) as NativeResult;
}

/** The median time of a contestant's step. */
export const timeOf = ({ contestants }: NativeResult, name: string, stage: Stage = 'total'): number =>
  median(contestants[name]!.times[stage]);

/** The median of a contestant's time ÷ that of another in the same turn. */
export function ratioOf({ contestants }: NativeResult, name: string, by: string, stage: Stage = 'total'): number {
  const others = contestants[by]!.times[stage];
  return median(contestants[name]!.times[stage].map((time, run) => time / others[run]!));
}
