import assert from 'node:assert/strict';
import { execFileSync } from 'node:child_process';
import { mkdtempSync, readdirSync, readFileSync, rmSync } from 'node:fs';
import { tmpdir } from 'node:os';
import { join } from 'node:path';
import { after, before, describe, test } from 'node:test';
import { readScene, type Scene } from '../../bench/scene-file.js';
import { nativeCommand, packages } from '../support/native.js';

const folder = mkdtempSync(join(tmpdir(), 'cagecast-golden-'));

/** FNV-1a, 64 bits, over the bytes of arrays, as tests/core/hash.hpp has it. */
class Hash {
  #hash = 0xcbf29ce484222325n;

  add(...arrays: (Uint8Array | Uint32Array | Float32Array)[]): void {
    for (const array of arrays) {
      for (const byte of new Uint8Array(array.buffer, array.byteOffset, array.byteLength))
        this.#hash = BigInt.asUintN(64, (this.#hash ^ BigInt(byte)) * 0x100000001b3n);
    }
  }

  get text(): string {
    return this.#hash.toString(16).padStart(16, '0');
  }
}

describe('the answer of the package on fixed scenes has the golden hash', () => {
  let builds: Awaited<ReturnType<typeof packages>>;
  const golden = (name: string) => readFileSync(`tests/core/golden/${name}.txt`, 'utf8').trim();
  /** The scenes that a hash is of, in its order. */
  const scenes = (kind: 'paper' | 'default' | 'borders'): Scene[] => {
    const count = readdirSync(folder).filter((name) => name.startsWith(`${kind}-`)).length;
    assert.ok(count > 0);
    return Array.from({ length: count }, (_, i) =>
      readScene(Uint8Array.from(readFileSync(join(folder, `${kind}-${i}.scene`))).buffer),
    );
  };

  before(async () => {
    execFileSync(nativeCommand(), ['--golden', folder]);
    builds = await packages();
  });
  after(() => rmSync(folder, { recursive: true, force: true }));

  for (const build of ['inline', 'slim'] as const) {
    test(`paper, ${build}`, () => {
      const hash = new Hash();
      for (const { cage, target } of scenes('paper')) {
        const { uvs, zones, triangles, segments } = builds[build].transfer(cage, target, { preset: 'paper' });
        hash.add(uvs, zones, triangles, segments);
      }
      assert.equal(hash.text, golden('hash'));
    });

    test(`default, ${build}`, () => {
      const hash = new Hash();
      for (const { cage, target } of scenes('default')) {
        const { uvs, zones, triangles, segments, cosmeticTriangles, cornerUvs } = builds[build].transfer(cage, target);
        hash.add(uvs, zones, triangles, segments, cosmeticTriangles, cornerUvs);
      }
      assert.equal(hash.text, golden('hash-default'));
    });

    test(`cut borders, ${build}`, () => {
      const { transfer, cutBorders } = builds[build];
      const hash = new Hash();
      for (const seams of ['vertex', 'corner'] as const) {
        for (const { cage, target } of scenes('borders')) {
          const { sources, weights, indices, triangles, uvs, cornerUvs, zones, cosmeticTriangles } = cutBorders(
            cage,
            target,
            transfer(cage, target, { seams }),
            { seams },
          );
          hash.add(sources, weights, indices, triangles, uvs, cornerUvs, zones, cosmeticTriangles);
        }
      }
      assert.equal(hash.text, golden('hash-borders'));
    });
  }
});
