// Applies a paint to a model: node examples/node/transfer.js head.glb cage.glb paint.png painted.glb
import { readFile } from 'node:fs/promises';
import { NodeIO } from '@gltf-transform/core';
import { ALL_EXTENSIONS } from '@gltf-transform/extensions';
import { cagecast } from 'cagecast/gltf';

const [target, cage, paint, output] = process.argv.slice(2);
const io = new NodeIO().registerExtensions(ALL_EXTENSIONS);
const document = await io.read(target);
await document.transform(
  cagecast({
    cage: await io.read(cage),
    texture: await readFile(paint),
    onResult: ({ timings }) => console.log(`${timings.total.toFixed(1)} ms`),
  }),
);
await io.write(output, document);
