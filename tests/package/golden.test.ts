import assert from 'node:assert/strict';
import { execFileSync } from 'node:child_process';
import { existsSync, readFileSync } from 'node:fs';
import { test } from 'node:test';
import { hashesOf } from '../support/golden.js';
import { nativeCommand } from '../support/native.js';
import { temporaryFolder } from '../support/temporary.js';

const { folder, at } = temporaryFolder('golden');
execFileSync(nativeCommand(), ['--golden', folder]);
const load = (name: string) =>
  existsSync(at(name)) ? Uint8Array.from(readFileSync(at(name))).buffer : new ArrayBuffer(0);

for (const [where, entry] of Object.entries({ inlined: 'cagecast', 'beside it': 'cagecast/slim' }))
  test(`the answers of the package on fixed scenes have the golden hashes, its WebAssembly ${where}`, async () => {
    const build = (await import(entry)) as typeof import('cagecast');
    await build.init();
    assert.ok(load('borders-0.scene').byteLength > 0);
    const golden = ['hash', 'hash-default', 'hash-borders'].map((name) => `tests/core/golden/${name}.txt`);
    const expected = golden.map((path) => readFileSync(path, 'utf8').trim());
    assert.deepEqual((await hashesOf(build, load)).split(' '), expected);
  });
