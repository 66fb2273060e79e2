import { type ChildProcessWithoutNullStreams, spawn, spawnSync } from 'node:child_process';
import { accessSync, constants, existsSync, readFileSync, rmSync, statSync, writeFileSync } from 'node:fs';
import { basename, delimiter, extname, resolve } from 'node:path';
import { createInterface } from 'node:readline';
import { fileURLToPath } from 'node:url';
import type { Mesh } from 'cagecast';
import { Misuse } from './misuse.js';
import { npyOf, readNpy } from './npy.js';

/** What finds zones: a program that speaks the protocol of README.md. */
export interface Method {
  name: string;
  command: [program: string, ...args: string[]];
  /** Where it is started. */
  folder: string;
}

/** How a method is run. */
export interface RunOptions {
  /** That are timed, after one that is not. */
  runs: number;
  /** Seconds until it is ended. */
  timeout: number;
  /** Is given what it prints beside its replies. */
  say?: (text: string) => void;
}

/** What a method found for a model, or why it did not. */
export type Outcome = { zones: Uint8Array; seconds: number[]; memory?: number } | { failed: string };

const at = (name: string): string => fileURLToPath(new URL(name, import.meta.url));
/** The names of the methods that are included. */
export const kIncluded: readonly string[] = ['naive', 'decals', 'by-hand', 'paper', 'default'];

let python: string | undefined;
/** The Python that has NumPy: of the environment variable PYTHON, or the first that does. @throws {Misuse} */
export function findPython(): string {
  const { PYTHON } = process.env;
  const all = PYTHON ? [PYTHON] : ['python3', 'python', '/usr/bin/python3'];
  python ??= all.find((program) => spawnSync(program, ['-c', 'import numpy']).status === 0);
  if (python !== undefined) return python;
  throw new Misuse(
    `methods in Python need Python 3 with NumPy; tried ${all.join(', ')}: install NumPy for one, or name a Python that has it by PYTHON=…`,
  );
}

/**
 * A method by what the command line says of it: a name of those included, a file of Python or JavaScript, or a program with arguments;
 * before it there may be a name for the tables and `=`.
 * @param folder  Where relative paths start, and the method itself.
 * @throws {Misuse}
 */
export function methodOf(text: string, folder: string): Method {
  const node = (file: string): Method['command'] => [
    process.execPath,
    '--import',
    import.meta.resolve('tsx'),
    at('run-method.ts'),
    file,
  ];
  if (kIncluded.includes(text)) return { name: text, command: node(at(`methods/${text}.ts`)), folder };
  const [, label, what = ''] = /^(?:([\w.-]+)=)?(.*)$/s.exec(text)!;
  const [first = '', ...args] = (what.match(/"[^"]*"|'[^']*'|\S+/g) ?? []).map((word) =>
    word.replace(/^(["'])(.*)\1$/s, '$2'),
  );
  const isFile = (path: string): boolean => existsSync(path) && statSync(path).isFile();
  const inPath = /[\\/]/.test(first)
    ? []
    : (process.env['PATH'] ?? '').split(delimiter).map((one) => resolve(one, first));
  const file = [resolve(folder, first), ...inPath].find(isFile);
  if (file === undefined || first === '')
    throw new Misuse(
      `--method: there is no method, file or program ${JSON.stringify(first)}; included are ${kIncluded.join(', ')}`,
    );
  const name = label ?? basename(file, extname(file));
  if (/\.py$/.test(file)) return { name, command: [findPython(), at('run_method.py'), file], folder };
  if (/\.[cm]?[jt]s$/.test(file)) return { name, command: node(file), folder };
  try {
    accessSync(file, constants.X_OK);
  } catch {
    throw new Misuse(
      `--method: ${file} may not be run (chmod +x allows it), and does not end in .py, .js, .mjs or .ts`,
    );
  }
  return { name, command: [file, ...args], folder };
}

/** Writes the arrays of a model, as methods read them. */
export function writeArrays(folder: string, meshes: Record<'cage' | 'target', Mesh>): void {
  const kColumns = { positions: 3, indices: 3, uvs: 2, groups: undefined };
  for (const [mesh, arrays] of Object.entries(meshes))
    for (const [name, columns] of Object.entries(kColumns)) {
      const values = arrays[name as keyof typeof kColumns];
      const path = `${folder}/${mesh}_${name}.npy`;
      if (values) writeFileSync(path, npyOf(name === 'indices' ? Uint32Array.from(values) : values, columns));
    }
}

/**
 * Starts a method anew and lets it find the zones of a model: so what an earlier model took is no part of its memory.
 * @param folder    With the model's arrays; gets zones.npy.
 * @param vertices  Of the target.
 */
export async function run(
  { command: [program, ...args], folder: cwd }: Method,
  folder: string,
  vertices: number,
  { runs, timeout, say }: RunOptions,
): Promise<Outcome> {
  rmSync(`${folder}/zones.npy`, { force: true });
  const isPosix = process.platform !== 'win32';
  const child = spawn(program, args, { cwd, detached: isPosix });
  const stop = (): void => {
    try {
      // A program may have started others, which keep its output open.
      if (isPosix && child.pid !== undefined) process.kill(-child.pid, 'SIGKILL');
      else child.kill('SIGKILL');
    } catch {
      // All of them have ended.
    }
  };
  process.once('exit', stop);
  let isLate = false;
  const timer = setTimeout(() => {
    isLate = true;
    stop();
  }, 1000 * timeout);
  try {
    const ask = asker(child, say);
    await ask('{"ready": true}');
    const before = resetPeak(child.pid);
    const reply = await ask('{"seconds": [0.012]}', JSON.stringify({ folder, runs }));
    const after = peak(child.pid);
    return {
      seconds: secondsOf(reply['seconds']),
      zones: zonesOf(`${folder}/zones.npy`, vertices),
      ...(before !== undefined && after !== undefined && { memory: Math.max(0, after - before) }),
    };
  } catch (error) {
    return { failed: isLate ? `took more than ${timeout} s` : (error as Error).message };
  } finally {
    clearTimeout(timer);
    process.off('exit', stop);
    stop();
  }
}

/** What sends a line to a program, if there is one, and waits for a line of JSON. It throws what is wrong. */
function asker(child: ChildProcessWithoutNullStreams, say?: RunOptions['say']) {
  let said = '';
  let failure: string | undefined;
  child.on('error', (error) => (failure = `cannot be started: ${error.message}`));
  child.stdin.on('error', () => {}); // a program that has ended: its exit code says so
  child.stderr.setEncoding('utf8').on('data', (text: string) => {
    said = (said + text).slice(-2000);
    say?.(text);
  });
  const ended = new Promise<string>((done) =>
    child.on('close', (code, signal) => done(signal ? `was ended by ${signal}` : `ended with exit code ${code}`)),
  );
  const lines = createInterface(child.stdout)[Symbol.asyncIterator]();
  return async (expected: string, line?: string): Promise<Record<string, unknown>> => {
    if (line !== undefined) child.stdin.write(`${line}\n`);
    const { value, done } = await lines.next();
    if (done) {
      const how = await ended;
      const last = said.trim().split('\n').at(-1);
      throw new Error(failure ?? `${how} before it replied ${expected}${last ? `: ${last}` : ''}`);
    }
    const reply = parsed(value);
    if (typeof reply?.['error'] === 'string') throw new Error(reply['error']);
    if (reply === undefined || !(Object.keys(JSON.parse(expected) as object)[0]! in reply))
      throw new Error(`printed ${JSON.stringify(value.slice(0, 80))}; a line such as ${expected} is expected`);
    return reply;
  };
}

function parsed(line: string): Record<string, unknown> | undefined {
  try {
    const value: unknown = JSON.parse(line);
    return typeof value === 'object' && value !== null ? (value as Record<string, unknown>) : undefined;
  } catch {
    return undefined;
  }
}

function secondsOf(value: unknown): number[] {
  const seconds = [value].flat();
  if (seconds.length === 0 || !seconds.every((one) => typeof one === 'number' && one >= 0))
    throw new Error(`replied seconds of ${JSON.stringify(value)}; a number, or a list of numbers, is expected`);
  return seconds as number[];
}

function zonesOf(path: string, vertices: number): Uint8Array {
  if (!existsSync(path)) throw new Error('replied, but wrote no zones.npy');
  const { type, shape, values } = readNpy(readFileSync(path));
  if (shape.length !== 1 || shape[0] !== vertices)
    throw new Error(
      `zones has the shape (${shape.join(', ')}); ${vertices} values are expected, one for each vertex of the target`,
    );
  if (values === undefined) throw new Error(`zones is of the type ${type}; whole numbers or booleans are expected`);
  const wrong = [...values].findIndex((value) => typeof value === 'number' && !Number.isInteger(value));
  if (wrong >= 0) throw new Error(`zones[${wrong}] is ${values[wrong]}; whole numbers or booleans are expected`);
  return Uint8Array.from([...values], (value) => Number(Number(value) !== 0));
}

/** The most resident memory that a process has had since `resetPeak`, in bytes. Undefined where the system does not say. */
function peak(pid: number | undefined): number | undefined {
  const path = `/proc/${pid}/status`;
  const [, kilobytes] = (existsSync(path) && /VmHWM:\s*(\d+) kB/.exec(readFileSync(path, 'utf8'))) || [];
  return kilobytes === undefined ? undefined : 1024 * Number(kilobytes);
}

function resetPeak(pid: number | undefined): number | undefined {
  try {
    writeFileSync(`/proc/${pid}/clear_refs`, '5');
    return peak(pid);
  } catch {
    return undefined; // not Linux, or not allowed
  }
}
