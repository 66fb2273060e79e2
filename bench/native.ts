import { spawn } from 'node:child_process';
import { fileURLToPath } from 'node:url';

/** The folder of the checkout, with a slash at its end. */
export const root = fileURLToPath(new URL('..', import.meta.url));
const program = `${root}build/release/bench/cagecast_bench`;

/** Runs a program and returns what it printed. */
export function output(
  command: string,
  args: readonly string[],
  env: Record<string, string> = {},
): Promise<{ stdout: string; stderr: string }> {
  return new Promise((resolve, reject) => {
    const child = spawn(command, args, {
      cwd: root,
      env: { ...process.env, ...env },
      stdio: ['ignore', 'pipe', 'pipe'],
    });
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

export interface Spread {
  median: number;
  min: number;
  max: number;
}

/** The steps of the preset `paper`, as `cagecast_bench` names them. */
export const stages = ['weld', 'build', 'project', 'occluded', 'covered', 'segments', 'classify', 'total'] as const;
export type Stage = (typeof stages)[number];
/** What the preset `default` does besides. */
export const stagesOfDefault = ['recheck', 'holes', 'seams'] as const;
export type StageOfDefault = (typeof stagesOfDefault)[number];

/** What `cagecast_bench --json` prints; times in ms of CPU time. */
export interface NativeResult {
  runs: number;
  compiler: string;
  triangles: number;
  vertices: number;
  points: number;
  cageTriangles: number;
  peakBytes: number;
  hash: string;
  cagecast: Record<Stage | StageOfDefault, Spread>;
  peers: Record<
    string,
    {
      times: Record<Stage | StageOfDefault, Spread>;
      ratios: Partial<Record<Stage, number>>;
      otherZones: number;
      otherTriangles: number;
    }
  >;
}

/** Builds the native benchmark. */
export async function buildNative(): Promise<void> {
  await output('cmake', ['--preset', 'release', '-Wno-dev', '--log-level=WARNING']);
  await output('cmake', [
    '--build',
    '--preset',
    'release',
    '--target',
    'cagecast_bench',
    'cagecast_count_instructions',
  ]);
}

/** Measures one scene file natively. */
export async function measureNative(
  scene: string,
  runs: number,
  peers: readonly string[],
  options: readonly string[] = [],
): Promise<NativeResult> {
  const { stdout } = await output(program, [
    scene,
    '--json',
    '--runs',
    String(runs),
    ...options,
    ...(peers.length > 0 ? ['--peers', peers.join(',')] : []),
  ]);
  return JSON.parse(stdout) as NativeResult;
}

/** Writes a target and a cage, two glTF files, as one scene file. */
export async function saveScene(target: string, cage: string, scene: string): Promise<void> {
  await output(program, [target, cage, '--save', scene]);
}
