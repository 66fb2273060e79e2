import { output, root } from './native.js';

export type Preset = 'paper' | 'default';

/** How many instructions one transfer takes on a processor, and the compiler that chose them. */
export interface InstructionCount {
  perRun: number;
  compiler: string;
}

/** How many a transfer takes in WebAssembly: machine code and the engine's own work together. */
export interface WasmCount {
  /** Once the engine has optimised all of it. */
  optimised: number;
  /** The first of all, compiled function by function as they are called, and not optimised. */
  first: number;
}

const plugin = `${root}build/release/bench/libcagecast_count_instructions.so`;
const runs = { few: 2, many: 12 };

/** What all runs together take beyond the first few, per run: reading the file and the first run's allocations fall out. */
async function perRun(count: (runs: number) => Promise<number>): Promise<number> {
  return Math.round(((await count(runs.many)) - (await count(runs.few))) / (runs.many - runs.few));
}

function numberIn(text: string, pattern: RegExp): number {
  const found = pattern.exec(text)?.[1];
  if (found === undefined) throw new Error(`no instruction count in: ${text.trim()}`);
  return Number(found);
}

async function compilerOf(program: string, args: readonly string[], scene: string): Promise<string> {
  const { stdout } = await output(program, [...args, scene, '--runs', '1', '--json']);
  return (JSON.parse(stdout) as { compiler: string }).compiler;
}

/** Counts on this machine's processor, by Valgrind. */
export async function countX86(scene: string, preset: Preset = 'paper'): Promise<InstructionCount> {
  const program = `${root}build/release/bench/cagecast_bench`;
  const count = async (n: number): Promise<number> => {
    const { stderr } = await output('valgrind', [
      '--tool=callgrind',
      '--callgrind-out-file=/dev/null',
      program,
      scene,
      '--preset',
      preset,
      '--runs',
      String(n),
    ]);
    return numberIn(stderr, /Collected : (\d+)/);
  };
  return { perRun: await perRun(count), compiler: await compilerOf(program, [], scene) };
}

/** Builds for 64-bit ARM and counts there, by QEMU with a plugin of ours. */
export async function countAarch64(scene: string, preset: Preset = 'paper'): Promise<InstructionCount> {
  await output('cmake', ['--preset', 'aarch64', '-Wno-dev', '--log-level=WARNING']);
  await output('cmake', ['--build', '--preset', 'aarch64', '--target', 'cagecast_bench']);
  const program = `${root}build/aarch64/bench/cagecast_bench`;
  const count = async (n: number): Promise<number> => {
    const { stderr } = await output('qemu-aarch64', [
      '-plugin',
      plugin,
      program,
      scene,
      '--preset',
      preset,
      '--runs',
      String(n),
    ]);
    return numberIn(stderr, /^instructions (\d+)/m);
  };
  return { perRun: await perRun(count), compiler: await compilerOf('qemu-aarch64', [program], scene) };
}

/** Counts the package in this Node, by QEMU for the processor that it runs on. `bundle` is that of bench/web/count.ts. */
export async function countWasm(bundle: string, scene: string, preset: Preset): Promise<WasmCount> {
  const qemu = process.arch === 'arm64' ? 'qemu-aarch64' : 'qemu-x86_64';
  const counted =
    (...engine: string[]) =>
    async (n: number): Promise<number> => {
      const { stderr } = await output(qemu, [
        '-cpu',
        'max',
        '-plugin',
        plugin,
        process.execPath,
        '--single-threaded',
        '--predictable',
        ...engine,
        bundle,
        scene,
        preset,
        String(n),
      ]);
      return numberIn(stderr, /^instructions (\d+)/m);
    };
  const unoptimised = counted('--wasm-lazy-compilation', '--no-wasm-tier-up', '--no-wasm-dynamic-tiering');
  return { optimised: await perRun(counted('--no-liftoff')), first: (await unoptimised(1)) - (await unoptimised(0)) };
}

/** The result's hash, as computed on 64-bit ARM. */
export async function hashOnAarch64(scene: string): Promise<string> {
  const { stdout } = await output('qemu-aarch64', [
    `${root}build/aarch64/bench/cagecast_bench`,
    scene,
    '--runs',
    '1',
    '--json',
  ]);
  return (JSON.parse(stdout) as { hash: string }).hash;
}
