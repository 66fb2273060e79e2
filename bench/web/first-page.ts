// What a page's first use of the package costs. It imports nothing at its start but what reads the input.
import type { Preset } from 'cagecast';
import { readScene } from '../scene-file.js';

export interface FirstUse {
  /** Fetching (from this machine), parsing and running the script. */
  import: number;
  /** Compiling and instantiating the module. */
  init: number;
  transfer: number;
  total: number;
  /** The size of WebAssembly memory after the first transfer, and after twenty, in bytes. */
  heap: number;
  heapLater: number;
}

const memories: WebAssembly.Memory[] = [];
WebAssembly.Instance = new Proxy(WebAssembly.Instance, {
  construct(target, args: ConstructorParameters<typeof WebAssembly.Instance>) {
    const instance = new target(...args);
    memories.push(...Object.values(instance.exports).filter((value) => value instanceof WebAssembly.Memory));
    return instance;
  },
});
const heap = (): number => memories.reduce((sum, { buffer }) => sum + buffer.byteLength, 0);

async function firstUse(url: string, script: string, preset: Preset): Promise<FirstUse> {
  const { cage, target } = readScene(await (await fetch(url)).arrayBuffer());
  const laps = [performance.now()];
  const { init, transfer } = (await import(script)) as typeof import('cagecast');
  laps.push(performance.now());
  await init();
  laps.push(performance.now());
  transfer(cage, target, { preset });
  laps.push(performance.now());
  const [start, imported, started, done] = laps as [number, number, number, number];
  const heapFirst = heap();
  for (let i = 0; i < 20; ++i) transfer(cage, target, { preset });
  return {
    import: imported - start,
    init: started - imported,
    transfer: done - started,
    total: done - start,
    heap: heapFirst,
    heapLater: heap(),
  };
}

Object.assign(window, { firstUse });
