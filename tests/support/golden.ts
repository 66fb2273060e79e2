import { readScene, type Scene } from '../../bench/scene-file.js';

type Numbers = Uint8Array | Uint32Array | Float32Array;

/** FNV-1a, 64 bits, over the bytes of arrays, as tests/core/hash.hpp has it; in two halves, as BigInt takes long. */
class Hash {
  #high = 0xcbf29ce4;
  #low = 0x84222325;

  add(...arrays: Numbers[]): void {
    let [high, low] = [this.#high, this.#low];
    for (const { buffer, byteOffset, byteLength } of arrays) {
      for (const byte of new Uint8Array(buffer, byteOffset, byteLength)) {
        // Times 0x100000001b3: the low half by 0x1b3 in two steps, and the whole by 2^40.
        low = (low ^ byte) >>> 0;
        const first = (low & 0xffff) * 0x1b3;
        const second = (low >>> 16) * 0x1b3 + (first >>> 16);
        high = (Math.imul(high, 0x1b3) + (second >>> 16) + (low << 8)) >>> 0;
        low = ((second & 0xffff) << 16) | (first & 0xffff);
      }
    }
    [this.#high, this.#low] = [high, low >>> 0];
  }

  get text(): string {
    return [this.#high, this.#low].map((half) => half.toString(16).padStart(8, '0')).join('');
  }
}

/** Gets a file that `cagecast_reference --golden` wrote; none, if there is no such file. */
export type Load = (name: string) => ArrayBuffer | Promise<ArrayBuffer>;

/** The scenes that a hash is of, in its order. */
async function scenesOf(kind: 'paper' | 'default' | 'borders', load: Load): Promise<Scene[]> {
  const scenes = [];
  for (;;) {
    const bytes = await load(`${kind}-${scenes.length}.scene`);
    if (bytes.byteLength === 0) return scenes;
    scenes.push(readScene(bytes));
  }
}

/**
 * The hashes that tests/release/lanes/lane.cpp prints.
 * @param build  A build of the package, ready.
 */
export async function hashesOf(build: typeof import('cagecast'), load: Load): Promise<string> {
  const { transfer, cutBorders } = build;
  const hashes = [new Hash(), new Hash(), new Hash()] as const;
  for (const { cage, target } of await scenesOf('paper', load)) {
    const { uvs, zones, triangles, segments } = transfer(cage, target, { preset: 'paper' });
    hashes[0].add(uvs, zones, triangles, segments);
  }
  for (const { cage, target } of await scenesOf('default', load)) {
    const { uvs, zones, triangles, segments, cosmeticTriangles, cornerUvs } = transfer(cage, target);
    hashes[1].add(uvs, zones, triangles, segments, cosmeticTriangles, cornerUvs);
  }
  const borders = await scenesOf('borders', load);
  for (const seams of ['vertex', 'corner'] as const) {
    for (const { cage, target } of borders) {
      const cut = cutBorders(cage, target, transfer(cage, target, { seams }), { seams });
      hashes[2].add(cut.sources, cut.weights, cut.indices, cut.triangles, cut.uvs, cut.cornerUvs);
      hashes[2].add(cut.zones, cut.cosmeticTriangles);
    }
  }
  return hashes.map(({ text }) => text).join(' ');
}
