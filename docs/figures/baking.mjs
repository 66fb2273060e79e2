// Draws docs/figures/baking.png: a paint, baked into the lizard's own texture, and back. Needs `npm run build`.
//   node docs/figures/baking.mjs
import { execFileSync } from 'node:child_process';
import { mkdtempSync, readFileSync, rmSync, writeFileSync } from 'node:fs';
import { tmpdir } from 'node:os';
import { join } from 'node:path';
import { fileURLToPath } from 'node:url';
import { NodeIO } from '@gltf-transform/core';
import { resize } from 'cagecast/bake';
import { PNG } from 'pngjs';

const root = fileURLToPath(new URL('../..', import.meta.url));
const lizard = (name) => join(root, 'examples/samples/lizard', name);
const kSide = 280; // pixels
const kGap = 12;

const folder = mkdtempSync(join(tmpdir(), 'cagecast-figure-'));
const at = (name) => join(folder, name);
const run = (...args) => execFileSync(process.execPath, [join(root, 'dist/cli.js'), 'bake', ...args]);
try {
  run(lizard('target.glb'), lizard('cage.glb'), lizard('paint-war-paint.png'), '-o', at('painted.glb'));
  run(at('painted.glb'), lizard('cage.glb'), '--back', '-o', at('back.png'));
  const document = await new NodeIO().read(at('painted.glb'));
  const skin = document
    .getRoot()
    .listMaterials()
    .find((material) => material.getName() === 'skin');
  const files = [
    readFileSync(lizard('paint-war-paint.png')),
    skin.getBaseColorTexture().getImage(),
    readFileSync(at('back.png')),
  ];
  const out = new PNG({ width: 3 * kSide + 2 * kGap, height: kSide });
  out.data.fill(255);
  files.forEach((file, panel) => {
    const image = resize(PNG.sync.read(Buffer.from(file)), kSide, kSide);
    for (let i = 0; i < kSide * kSide; ++i) {
      const [x, y] = [i % kSide, Math.floor(i / kSide)];
      const board = (Math.floor(x / 10) + Math.floor(y / 10)) % 2 ? 225 : 245; // behind what is transparent
      const alpha = image.data[4 * i + 3] / 255;
      const to = 4 * (y * out.width + panel * (kSide + kGap) + x);
      for (let k = 0; k < 3; ++k) out.data[to + k] = alpha * image.data[4 * i + k] + (1 - alpha) * board;
    }
  });
  writeFileSync(join(root, 'docs/figures/baking.png'), PNG.sync.write(out));
} finally {
  rmSync(folder, { recursive: true });
}
