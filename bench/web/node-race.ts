// node node-race.mjs FILE.scene '{"runs":…}': races in this process and prints the result as JSON.
import { readFileSync } from 'node:fs';
import { readScene } from '../scene-file.js';
import { race, type RaceOptions } from './race.js';

const [file, options] = process.argv.slice(2) as [string, string];
const { buffer, byteOffset, byteLength } = readFileSync(file);
const scene = readScene((buffer as ArrayBuffer).slice(byteOffset, byteOffset + byteLength));
console.log(JSON.stringify(await race(scene, JSON.parse(options) as RaceOptions)));
