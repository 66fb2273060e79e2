// node count.mjs FILE.scene PRESET RUNS: so many transfers in this process, whose instructions somebody counts.
import { readFileSync } from 'node:fs';
import { init, type Preset, type TransferResult, transfer } from 'cagecast';
import { readScene } from '../scene-file.js';

const [file, preset, runs] = process.argv.slice(2) as [string, Preset, string];
const { buffer, byteOffset, byteLength } = readFileSync(file);
const { cage, target } = readScene((buffer as ArrayBuffer).slice(byteOffset, byteOffset + byteLength));
await init();
performance.now(); // Node loads what that takes when it is first asked for.
let reuse: TransferResult | undefined;
for (let i = 0; i < Number(runs); ++i) reuse = transfer(cage, target, { preset, reuse });
