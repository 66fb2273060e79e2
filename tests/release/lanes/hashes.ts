import type { Mesh } from 'cagecast';

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

/** The scenes that tests/release/lanes/lane.cpp wrote. */
function readScenes(bytes: ArrayBuffer): { cage: Mesh; target: Mesh }[] {
  let at = 0;
  const take = <A>(type: new (buffer: ArrayBuffer, offset: number, length: number) => A): A => {
    const [count] = new Uint32Array(bytes, at, 1);
    const values = new type(bytes, at + 4, count!);
    at += 4 + 4 * count!;
    return values;
  };
  const takeMesh = (): Mesh => ({
    positions: take(Float32Array),
    indices: take(Uint32Array),
    uvs: take(Float32Array),
    groups: take(Uint32Array),
  });
  const scenes = [];
  while (at < bytes.byteLength) scenes.push({ cage: takeMesh(), target: takeMesh() });
  return scenes;
}

/**
 * The hashes that tests/release/lanes/lane.cpp prints.
 * @param build  A build of the package, ready.
 * @param load  Gets a file of scenes that lane.cpp wrote.
 */
export async function hashesOf(
  build: typeof import('cagecast'),
  load: (name: string) => ArrayBuffer | Promise<ArrayBuffer>,
): Promise<string> {
  const { transfer, cutBorders } = build;
  const hashes = [new Hash(), new Hash(), new Hash()] as const;
  for (const { cage, target } of readScenes(await load('paper.bin'))) {
    const { uvs, zones, triangles, segments } = transfer(cage, target, { preset: 'paper' });
    hashes[0].add(uvs, zones, triangles, segments);
  }
  for (const { cage, target } of readScenes(await load('default.bin'))) {
    const { uvs, zones, triangles, segments, cosmeticTriangles, cornerUvs } = transfer(cage, target);
    hashes[1].add(uvs, zones, triangles, segments, cosmeticTriangles, cornerUvs);
  }
  const borders = await load('borders.bin');
  for (const seams of ['vertex', 'corner'] as const) {
    for (const { cage, target } of readScenes(borders)) {
      const cut = cutBorders(cage, target, transfer(cage, target, { seams }), { seams });
      hashes[2].add(cut.sources, cut.weights, cut.indices, cut.triangles, cut.uvs, cut.cornerUvs);
      hashes[2].add(cut.zones, cut.cosmeticTriangles);
    }
  }
  return hashes.map(({ text }) => text).join(' ');
}
