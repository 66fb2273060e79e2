// Whether memory stays the same however long a program runs: a hundred thousand transfers with `reuse` in one process, among them
// cut borders, baked layers and fitted cages.
//
//   node --expose-gc --import tsx tests/release/soak.ts [COUNT]      default: 100000
//
// Prints the memory after a hundredth of them and after all, and ends with 1 if what is allocated grew by more than 2 %.
import { setImmediate } from 'node:timers/promises';
import { cutBorders, init, type TransferResult, transfer } from 'cagecast';
import { bake, type Image, layOver } from 'cagecast/bake';
import { loadTemplate } from 'cagecast/cages';
import * as cages from 'cagecast/cages/sync';
import { ball } from '../package/scenes.js';

const count = Number(process.argv[2] ?? 100_000);
const cage = ball([0, 0, 0], () => 1, 5, 10);
const target = ball([0, 0, 0], () => 0.9, 6, 12);
const paint: Image = { width: 8, height: 8, data: new Uint8Array(256).fill(200) };
const template = await loadTemplate('human-head');
/** What differs from one call to the next: memory must not remember what came before. */
const sizes = [0.9, 0.95, 0.8].map((size) => ball([0, 0, 0.01], () => size, 6, 12));

let reuse: TransferResult | undefined;
function step(i: number): void {
  reuse = transfer(cage, sizes[i % 3]!, { seams: 'corner', threshold: (i % 7) / 7, ...(reuse && { reuse }) });
  if (i % 10 === 0) cutBorders(cage, sizes[i % 3]!, reuse);
  if (i % 50 === 0) {
    const baked = bake(target, reuse, paint, { width: 16 });
    layOver({ width: 16, height: 16, data: baked.data }, baked);
  }
}

/** Bytes of JavaScript, of its arrays, and of the WebAssembly memories, which never shrink. */
async function used(): Promise<Record<string, number>> {
  for (let i = 0; i < 4; ++i) {
    globalThis.gc!();
    await setImmediate();
  }
  const { heapUsed, external, rss } = process.memoryUsage();
  return { heap: heapUsed, external, resident: rss };
}

await Promise.all([init(), cages.init()]);
let early: Record<string, number> = {};
for (let i = 1; i <= count; ++i) {
  step(i);
  if (i % 1000 === 500) {
    cages.fitCage(template, template, template.landmarks);
    // Each call to cages/sync has an instance of its own, which is freed once the event loop turns.
    await setImmediate();
  }
  if (i === Math.ceil(count / 100)) early = await used();
}
const late = await used();
const text = (bytes: Record<string, number>) =>
  Object.entries(bytes)
    .map(([name, value]) => `${name} ${(value / 2 ** 20).toFixed(1)} MiB`)
    .join(', ');
console.log(`after ${Math.ceil(count / 100)}: ${text(early)}\nafter ${count}: ${text(late)}`);
const grown = (late['heap']! + late['external']!) / (early['heap']! + early['external']!) - 1;
const resident = late['resident']! / early['resident']! - 1;
console.log(`grown by ${(100 * grown).toFixed(2)} %, resident by ${(100 * resident).toFixed(2)} %`);
// What the process holds of the system differs by some percent with what the collector and the compiler keep.
process.exit(grown <= 0.02 && resident <= 0.15 ? 0 : 1);
