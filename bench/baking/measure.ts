// Measures baking on the lizard: processor time, and how far a paint that went there and back is from itself.
//   npx tsx bench/baking/measure.ts        needs `npm run build`

import { readFileSync } from 'node:fs';
import { NodeIO } from '@gltf-transform/core';
import { init, type Mesh, transfer } from 'cagecast';
import { type Baked, bake, cageTexture, type Image, resize } from 'cagecast/bake';
import { PNG } from 'pngjs';

const folder = 'examples/samples/lizard';
const kSide = 1024;
const kRuns = 7;

/** The first primitive of a node, or of the first one with a mesh. */
async function read(file: string, name?: string): Promise<Mesh> {
  const nodes = (await new NodeIO().read(`${folder}/${file}`)).getRoot().listNodes();
  const node = nodes.find((one) => one.getMesh() && (name === undefined || one.getName() === name))!;
  const primitive = node.getMesh()!.listPrimitives()[0]!;
  return {
    positions: primitive.getAttribute('POSITION')!.getArray() as Float32Array,
    indices: Uint32Array.from(primitive.getIndices()!.getArray()!),
    uvs: primitive.getAttribute('TEXCOORD_0')!.getArray() as Float32Array,
  };
}

/** Milliseconds on all threads: the first call, which compiles, and the median of the others. */
function processorTime(call: () => void): string {
  const times = Array.from({ length: kRuns }, () => {
    const before = process.cpuUsage();
    call();
    const { user, system } = process.cpuUsage(before);
    return (user + system) / 1000;
  });
  const [first, ...others] = times;
  return `${first!.toFixed(0)} ms at first, then ${others.sort((a, b) => a - b)[(kRuns - 1) >> 1]!.toFixed(0)} ms`;
}

/** The mean difference of premultiplied bytes, over texels that are covered completely. */
function difference(back: Baked, paint: Image): number {
  const before = resize(paint, back.width, back.height);
  let [sum, count] = [0, 0];
  back.mask.forEach((share, i) => {
    if (share !== 255) return;
    ++count;
    for (let k = 0; k < 4; ++k) {
      const seen = ({ data }: Image) => (k === 3 ? data[4 * i + 3]! : (data[4 * i + k]! * data[4 * i + 3]!) / 255);
      sum += Math.abs(seen(back) - seen(before)) / 4;
    }
  });
  return sum / count;
}

await init();
const [cage, target] = [await read('cage.glb'), await read('target.glb', 'skin')];
const result = transfer(cage, target);
for (const name of ['war-paint', 'tiger']) {
  const paint = PNG.sync.read(readFileSync(`${folder}/paint-${name}.png`));
  let atlas: Baked | undefined;
  const there = processorTime(() => (atlas = bake(target, result, paint, { width: kSide })));
  const back = processorTime(() => cageTexture(target, result, atlas!, { width: kSide }));
  console.log(`${name}: ${kSide}², bake ${there}; cageTexture ${back}`);
  for (const width of [kSide, 2 * kSide, 4 * kSide]) {
    const own = bake(target, result, paint, { width });
    const found = cageTexture(target, result, own, { width: kSide });
    console.log(`  there and back by ${width}²: ${difference(found, paint).toFixed(2)}/255`);
  }
}
