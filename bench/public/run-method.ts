// Runs a method that is a JavaScript or TypeScript module, by the protocol of README.md: tsx run-method.ts FILE

import { Console } from 'node:console';
import { readFileSync, writeFileSync } from 'node:fs';
import { createInterface } from 'node:readline';
import { pathToFileURL } from 'node:url';
import { npyOf, readNpy } from './npy.js';

/** A mesh as methods get it. */
export interface Arrays {
  /** 3 per vertex. */
  positions: Float32Array;
  /** 3 per triangle. */
  indices: Uint32Array;
  /** 2 per vertex; cages have them. */
  uvs?: Float32Array;
  /** 1 per vertex: the number of its part; targets have them. */
  groups?: Uint32Array;
}

/** What a module exports. */
export interface MethodModule {
  /** 1 per vertex of the target: 0 may be painted, anything else must not. */
  zones(input: { cage: Arrays; target: Arrays }): ArrayLike<number> | Promise<ArrayLike<number>>;
  /** What is done once and is not measured. */
  prepare?(): void | Promise<void>;
}

const say = (reply: unknown): void => void process.stdout.write(`${JSON.stringify(reply)}\n`);
// What a method prints must not get among the replies.
globalThis.console = new Console(process.stderr);

function arraysOf(folder: string, mesh: string, names: readonly string[]): Arrays {
  const read = (name: string) => readNpy(readFileSync(`${folder}/${mesh}_${name}.npy`)).values;
  return Object.fromEntries(names.map((name) => [name, read(name)])) as unknown as Arrays;
}

async function measure(method: MethodModule, folder: string, runs: number): Promise<number[]> {
  const input = {
    cage: arraysOf(folder, 'cage', ['positions', 'indices', 'uvs']),
    target: arraysOf(folder, 'target', ['positions', 'indices', 'groups']),
  };
  const seconds: number[] = [];
  let zones: ArrayLike<number> | undefined;
  for (let run = 0; run <= runs; ++run) {
    const own = structuredClone(input); // a method may write into it
    const began = performance.now();
    zones = await method.zones(own);
    if (run > 0) seconds.push((performance.now() - began) / 1000);
  }
  const isTyped = ArrayBuffer.isView(zones) && !(zones instanceof DataView);
  if (!isTyped && !Array.isArray(zones))
    throw new Error(
      `zones() returned ${zones === null ? 'null' : typeof zones}; an array is expected${zones === undefined ? ': is a return missing?' : ''}`,
    );
  writeFileSync(`${folder}/zones.npy`, npyOf(isTyped ? (zones as Uint8Array) : Float64Array.from(zones!)));
  return seconds;
}

try {
  const file = process.argv[2]!;
  const method = (await import(pathToFileURL(file).href)) as MethodModule;
  if (typeof method.zones !== 'function') throw new Error(`${file} exports no function called zones`);
  await method.prepare?.();
  say({ ready: true });
  for await (const line of createInterface(process.stdin)) {
    const { folder, runs } = JSON.parse(line) as { folder: string; runs: number };
    say({ seconds: await measure(method, folder, runs) });
  }
} catch (error) {
  console.error(error);
  say({ error: String(error) });
}
