// node node-race.mjs FILE.scene '{"turns":…}': races in this process and prints the result as JSON.
import { readFileSync } from 'node:fs';
import { type RaceOptions, race } from '../race.js';
import { readScene } from '../scene-file.js';
import { Runner } from './runner.js';

const [file, options] = process.argv.slice(2) as [string, string];
const { buffer, byteOffset, byteLength } = readFileSync(file);
const runner = await Runner.start(readScene((buffer as ArrayBuffer).slice(byteOffset, byteOffset + byteLength)));
const realm = { pid: process.pid, run: runner.run.bind(runner), differences: runner.differences.bind(runner) };
console.log(JSON.stringify(await race(realm, JSON.parse(options) as RaceOptions)));
