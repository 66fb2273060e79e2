// A model file in, the painted file out: the same as the command writes.
import assert from 'node:assert/strict';
import { readFileSync } from 'node:fs';
import { after, test } from 'node:test';
import { CagecastError } from 'cagecast';
import { cageGlb, terminate as endCages, loadTemplate } from 'cagecast/cages';
import type { Image } from 'cagecast/engines';
import { type PaintOptions, paintGlb } from 'cagecast/gltf';
import { terminate as endWorker } from 'cagecast/worker';
import draco3d from 'draco3dgltf';
import { build } from 'esbuild';
import { MeshoptDecoder } from 'meshoptimizer';
import { ok } from '../../support/command.js';
import { GlbMaker, glbOf, unpackGlb, validate } from '../../support/gltf.js';
import { ball } from '../scenes.js';
import { inRepository, png, workplace, write, writeChanged } from './workplace.js';

const { cage, target } = workplace('glb');
const texture = png(200);
const read = (name: string) => new Uint8Array(readFileSync(name));
const human = (name: string) => read(inRepository(`examples/samples/human/${name}.glb`));

after(() => {
  endWorker();
  endCages();
});

const avatars: [version: string, extensions: object][] = [
  ['VRM', { VRM: { materialProperties: [{ name: 'skin', shader: 'VRM/MToon' }], meta: { title: 'Ünï' } } }],
  ['VRMC_vrm', { VRMC_vrm: { specVersion: '1.0', meta: { name: 'Ünï', authors: ['a'] } } }],
];
for (const [name, extensions] of avatars)
  test(`an avatar with ${name} keeps it, and is what the command writes`, async () => {
    writeChanged(`${name}.vrm`, glbOf(target), (json) => {
      json.materials = [{ name: 'skin' }];
      json.meshes![0]!.primitives[0]!.material = 0;
      json.extensionsUsed = [name];
      Object.assign(json, { extensions: structuredClone(extensions) });
    });
    write('paint.png', texture);
    for (const borders of ['triangle', 'cut'] as const) {
      await ok(`transfer ${name}.vrm --cage cage.glb --texture paint.png --borders ${borders} -o out.vrm`);
      const before = read(`${name}.vrm`);
      const { bytes, triangles, note, bare, fit } = await paintGlb(before, {
        cage: read('cage.glb'),
        texture,
        borders,
        attributes: true,
      });
      const [ours, commands] = [unpackGlb(bytes), unpackGlb(read('out.vrm'))];
      for (const { json } of [ours, commands]) for (const image of json.images ?? []) delete image.name;
      for (const { json } of [ours, commands]) for (const one of json.textures ?? []) delete one.name;
      assert.deepEqual(ours, commands);
      assert.deepEqual(await validate(bytes), []);
      assert.ok(triangles.painted > 0 && triangles.total === target.indices.length / 3);
      assert.deepEqual([note, bare, fit], [undefined, [], undefined]);
      assert.deepEqual(before, read(`${name}.vrm`));
    }
  });

test('without attributes only the overlay has UVs, and parts without one stay as they are', async () => {
  const around = { cage: read('cage.glb'), texture };
  const [lean, whole] = [
    await paintGlb(glbOf(target), around),
    await paintGlb(glbOf(target), { ...around, attributes: true }),
  ];
  assert.deepEqual(lean.triangles, whole.triangles);
  assert.ok(lean.bytes.length < whole.bytes.length);
  assert.deepEqual(await validate(lean.bytes, 2), await validate(glbOf(target), 2), 'nothing is unused');
  const primitives = (bytes: Uint8Array) => unpackGlb(bytes).json.meshes!.flatMap((mesh) => mesh.primitives);
  const [base, ...overlays] = primitives(lean.bytes);
  assert.deepEqual(Object.keys(base!.attributes).sort(), Object.keys(primitives(glbOf(target))[0]!.attributes).sort());
  assert.deepEqual([overlays.length, 'TEXCOORD_0' in overlays[0]!.attributes], [1, true]);
  const again = await paintGlb(lean.bytes, around);
  assert.equal(primitives(again.bytes).length, 2, 'an earlier transfer is replaced');
  assert.deepEqual(again.triangles, lean.triangles);
  const bare = await paintGlb(glbOf(target), { ...around, parts: { exclude: ['*'] } });
  assert.deepEqual(unpackGlb(bare.bytes), unpackGlb(glbOf(target)));
});

test('a cage may be a mesh; parts stay bare, or not, by their names', async () => {
  const model = glbOf(target);
  const painted = async (options: Partial<PaintOptions>) =>
    (await paintGlb(model, { cage: { ...cage, uvs: cage.uvs! }, texture, ...options })).triangles.painted;
  assert.equal(await painted({}), (await paintGlb(model, { cage: read('cage.glb'), texture })).triangles.painted);
  assert.equal(await painted({ parts: { exclude: ['ON*'] } }), 0);
});

test('a template is fitted first, here by its bytes; the cage that this makes can be given the next time', async () => {
  const shares: number[] = [];
  const template = cageGlb(await loadTemplate('human-head'));
  const first = await paintGlb(human('target'), { template, texture, onProgress: (share) => shares.push(share) });
  assert.ok(first.triangles.painted > 1000);
  assert.deepEqual(first.bare, ['l-eye', 'r-eye', 'upper-teeth', 'lower-teeth', 'tongue']);
  assert.deepEqual(
    shares,
    [...shares].sort((a, b) => a - b),
  );
  assert.deepEqual([shares[0], shares.at(-1)], [0, 1]);
  const again = await paintGlb(human('target'), { cage: first.fit!.cage, texture });
  assert.deepEqual(again.bytes, first.bytes);
  const abort = new AbortController();
  const aborted = paintGlb(human('target'), {
    template,
    texture,
    signal: abort.signal,
    onProgress: (share) => share > 0.2 && abort.abort(),
  });
  await assert.rejects(aborted, { name: 'AbortError' });
});

/** An egg that faces +z, with a texture of `paintedFace`. */
function paintedEgg(): Uint8Array {
  const egg = ball([0, 0, 0], () => 1, 40, 80);
  const positions = egg.positions.map((x, i) => x * [0.7, 1, 0.85][i % 3]!);
  const uvs = Float32Array.from({ length: (2 * positions.length) / 3 }, (_, i) => {
    const [x, y, z] = positions.subarray(3 * (i >> 1));
    return z! <= 0 ? 0.001 : i % 2 === 0 ? 0.5 + 0.5 * x! : 0.5 - 0.5 * y!;
  });
  const maker = new GlbMaker();
  maker.json.images = [{ bufferView: maker.view(png(200)), mimeType: 'image/png' }];
  maker.json.textures = [{ source: 0 }];
  maker.json.materials = [{ pbrMetallicRoughness: { baseColorTexture: { index: 0 } } }];
  maker.node({ mesh: maker.mesh({ positions, indices: egg.indices, uvs }, { material: 0 }) });
  return new Uint8Array(maker.finish());
}

/** A face as seen from the front, whose corners are -1 and 1: hair, eyes and lips on skin. */
function paintedFace(): Image {
  const [width, height] = [256, 256];
  const data = new Uint8Array(4 * width * height);
  for (let i = 0; i < width * height; ++i) {
    const [x, y] = [(i % width) / 128 - 1, 1 - Math.floor(i / width) / 128];
    const [across, up] = [Math.abs(x) - 0.27, y - 0.05];
    const isEye = Math.hypot(across / 0.13, up / 0.08) < 1;
    const isLip = Math.hypot(x / 0.2, (y + 0.45) / 0.06) < 1;
    const isHair = y > 0.5 || Math.abs(x) > 0.6;
    data.set(isEye ? [60, 90, 140] : isLip ? [180, 90, 90] : isHair ? [70, 45, 30] : [224, 172, 140], 4 * i);
    data[4 * i + 3] = 255;
  }
  return { width, height, data };
}

test('a face that is only painted is found by the images that the caller decodes', async () => {
  const guessed = async (options: object) =>
    (await paintGlb(paintedEgg(), { template: 'human-head', texture, ...options })).fit!.guessed;
  assert.ok((await guessed({})).includes('eye_centre_left'));
  assert.ok(!(await guessed({ decode: paintedFace })).includes('eye_centre_left'));
  const none = () => Promise.reject(new Error('KTX2'));
  assert.ok((await guessed({ decode: none })).includes('eye_centre_left'));
});

test('decoders that are given are used, and what they decode is written without compression', async () => {
  let calls = 0;
  const meshopt = {
    supported: true,
    ready: Promise.resolve(),
    decodeGltfBuffer: (...args: Parameters<typeof MeshoptDecoder.decodeGltfBuffer>) => {
      ++calls;
      MeshoptDecoder.decodeGltfBuffer(...args);
    },
  };
  const draco = await draco3d.createDecoderModule();
  await MeshoptDecoder.ready;
  const own = { cage: read('cage.glb'), texture };
  const plain = await paintGlb(glbOf(target), own);
  for (const form of ['meshopt', 'draco'] as const) {
    write('plain.glb', glbOf(target));
    await ok(`transfer plain.glb --cage cage.glb --compress ${form} -o compressed.glb`);
    const { bytes, triangles } = await paintGlb(read('compressed.glb'), { ...own, decoders: { meshopt, draco } });
    assert.deepEqual(unpackGlb(bytes).json.extensionsRequired ?? [], []);
    assert.deepEqual(await validate(bytes), []);
    assert.ok(Math.abs(triangles.painted - plain.triangles.painted) <= 2, form);
  }
  assert.ok(calls > 0);
  await assert.rejects(paintGlb(read('compressed.glb'), own), /compressed by Draco, whose decoder has to be given/);
});

test('what cannot be used is named, with what helps', async () => {
  const model = glbOf(target);
  const own = { cage: read('cage.glb'), texture };
  await assert.rejects(
    paintGlb(model, { ...own, attributes: 1 as never }),
    /options.attributes is 1, not true or false/,
  );
  const wrong: [bytes: Uint8Array, options: object, message: RegExp, argument: string][] = [
    [model, { texture }, /^paintGlb: neither cage nor template is given; one of them is needed/, 'cage'],
    [
      model,
      { ...own, template: 'human-head' },
      /^paintGlb: cage and template are both given; one of them is needed/,
      'cage',
    ],
    [
      model,
      { ...own, cage: 'human-head' },
      /^paintGlb: cage is .*; the template of this name is fitted by opt/,
      'cage',
    ],
    [model, { cage: own.cage }, /^paintGlb: neither texture nor look is given; one of them is needed/, 'texture'],
    [model, { ...own, texture: model }, /^paintGlb: texture: is not a PNG, JPEG, WebP or KTX2 image/, 'texture'],
    [model, { ...own, cage: texture }, /^paintGlb: cage: /, 'cage'],
    [
      model,
      { ...own, cage: glbOf({ ...cage, uvs: undefined }) },
      /^paintGlb: cage: meshes\[0\].*no TEXCOORD_0/,
      'cage',
    ],
    [
      model,
      { ...own, parts: { exclude: ['nose'] } },
      /^paintGlb: bytes: parts\.exclude: nothing is named "nose"; there are only/,
      'bytes',
    ],
    [
      model,
      { ...own, treshold: 1 },
      /^paintGlb: options\.treshold is not an option; paintGlb takes: texture, cage, .*threshold/,
      'options',
    ],
    [new Uint8Array(0), own, /^paintGlb: bytes: the file is empty/, 'bytes'],
    [
      new TextEncoder().encode(
        JSON.stringify({ asset: { version: '2.0' }, buffers: [{ uri: 'model.bin', byteLength: 4 }] }),
      ),
      own,
      /^paintGlb: bytes: buffers\[0\] is in model\.bin, another file; give a GLB/,
      'bytes',
    ],
  ];
  for (const [bytes, options, message, argument] of wrong)
    await assert.rejects(paintGlb(bytes, options as PaintOptions), (error: CagecastError) => {
      assert.ok(error instanceof CagecastError, String(error));
      assert.match(error.message, message);
      assert.equal(error.argument, argument, error.message);
      return true;
    });
});

test('nothing of Node is imported as it is loaded', async () => {
  const contents = "import { paintGlb } from 'cagecast/gltf'; console.log(paintGlb);";
  const { outputFiles } = await build({
    stdin: { contents, resolveDir: import.meta.dirname },
    bundle: true,
    format: 'esm',
    platform: 'browser',
    write: false,
  });
  assert.doesNotMatch(outputFiles[0]!.text, /\b(from|import)\s*\(?["']node:/);
});
