// Files that cannot be used, and files damaged at random. What they demand too much of is in hostile.test.ts.
import assert from 'node:assert/strict';
import { spawnSync } from 'node:child_process';
import { cpSync, existsSync, mkdirSync, readdirSync, readFileSync, symlinkSync } from 'node:fs';
import { test } from 'node:test';
import { PNG } from 'pngjs';
import { fails, ok, run } from '../../support/command.js';
import { GlbMaker, glbOf, packGlb, unpackGlb } from '../../support/gltf.js';
import { random } from '../scenes.js';
import { inRepository, jsonOf, png, workplace, write, writeChanged } from './workplace.js';

const { target, cage } = workplace('reading');
const whole = glbOf(target);
const vertices = target.positions.length / 3;

/** Sets members of JSON by their paths. */
function set(json: object, changes: Record<string, unknown>): void {
  for (const [path, value] of Object.entries(changes)) {
    const names = path.split('.');
    const last = names.pop()!;
    const owner = names.reduce(
      (one, name) => (one[name] ??= {}) as Record<string, unknown>,
      json as Record<string, unknown>,
    );
    owner[last] = value;
  }
}

const primitive = (changes: Record<string, unknown>) =>
  Object.fromEntries(Object.entries(changes).map(([name, value]) => [`meshes.0.primitives.0.${name}`, value]));
const instances = (TRANSLATION: unknown) => ({
  'nodes.0.extensions.EXT_mesh_gpu_instancing': { attributes: { TRANSLATION } },
});
const skin = (one: object) => ({ skins: [one], 'nodes.0.skin': 0 });
const draco = { bufferView: 0, attributes: { POSITION: 0 } };
const meshopt = { buffer: 0, byteOffset: 0, byteLength: 60, byteStride: 12, count: vertices, mode: 'ATTRIBUTES' };

const wrongJson: [changes: Record<string, unknown>, message: RegExp][] = [
  [{ meshes: [], nodes: [], 'scenes.0.nodes': [] }, /has no meshes; at least one triangle is needed$/m],
  [primitive({ mode: 1 }), /has no triangles in its scene; at least one triangle is needed$/m],
  [{ 'scenes.0.nodes': [] }, /has no triangles in its scene/],
  [{ asset: { version: '1.0' } }, /is glTF 1\.0; only 2\.x/],
  [{ scene: {} }, /scene = of type Object is out of range \(1 scenes\)/],
  [{ 'scenes.0.nodes': [0, 0] }, /nodes\[0\] is twice a root of scenes\[0\]/],
  [{ 'nodes.0.children': [0] }, /nodes\[0\] is a root of scenes\[0\] and a child of nodes\[0\]/],
  [{ 'nodes.0.name': 5 }, /nodes\[0\]\.name is not a string/],
  [{ 'accessors.0.count': 1e6 }, /accessors\[0\] ends at byte \d+ of bufferViews\[0\], which has \d+/],
  [{ 'accessors.0.count': 2 ** 40, 'accessors.0.bufferView': undefined }, /accessors\[0\]\.count = \d+ is more than/],
  [{ 'bufferViews.0.byteOffset': 1e9 }, /bufferViews\[0\] ends at byte \d+ of buffers\[0\], which has \d+/],
  [{ 'buffers.0.byteLength': 1e9 }, /buffers\[0\] is truncated/],
  [{ 'buffers.0.uri': 'gone.bin' }, /buffers\[0\] is in gone\.bin: no such file/],
  [{ 'buffers.0.uri': 'https://example.com/a.bin' }, /buffers\[0\] is at https:.* only local files can be read/],
  [{ 'buffers.0.uri': 'data:application/octet-stream;base64' }, /buffers\[0\] is "data:[^"]*", not a valid data URI$/m],
  [primitive({ mode: '4' }), /meshes\[0\]\.primitives\[0\]\.mode is not a whole number/],
  [
    primitive({ 'attributes.POSITION': 99 }),
    /primitives\[0\]\.attributes\.POSITION = 99 is out of range \(3 accessors\)/,
  ],
  [
    { 'accessors.3': { componentType: 5126, count: 5, type: 'VEC3' }, ...primitive({ 'attributes.NORMAL': 3 }) },
    /meshes\[0\]\.primitives\[0\]\.attributes\.NORMAL has 5 elements for \d+ vertices/,
  ],
  [primitive({ targets: -1 }), /meshes\[0\]\.primitives\[0\]\.targets is not an array of objects/],
  [primitive({ targets: [{ POSITION: 99 }] }), /primitives\[0\]\.targets\[0\]\.POSITION = 99 is out of range/],
  [
    primitive({ extensions: { KHR_materials_variants: { mappings: {} } } }),
    /meshes\[0\]\.primitives\[0\]: mappings of KHR_materials_variants is not an array of objects/,
  ],
  [
    {
      extensionsUsed: ['KHR_draco_mesh_compression'],
      ...primitive({ 'extensions.KHR_draco_mesh_compression': draco }),
    },
    /cannot be decoded/,
  ],
  [
    { extensionsUsed: ['EXT_meshopt_compression'], 'bufferViews.0.extensions.EXT_meshopt_compression': meshopt },
    /cannot be decoded/,
  ],
  [{ animations: {} }, /animations is not an array of objects/],
  [{ animations: [null] }, /animations is not an array of objects/],
  [{ animations: [{ channels: {} }] }, /animations\[0\]\.channels is not an array of objects/],
  [
    { materials: [{ pbrMetallicRoughness: { baseColorFactor: null } }] },
    /materials\[0\]\.pbrMetallicRoughness\.baseColorFactor is not an array of numbers/,
  ],
  [
    { 'nodes.0.extensions.EXT_mesh_gpu_instancing': null },
    /nodes\[0\]\.extensions\.EXT_mesh_gpu_instancing is not an object/,
  ],
  [instances(99), /nodes\[0\]: TRANSLATION of EXT_mesh_gpu_instancing is 99, not one of 3 accessors/],
  [instances('first'), /is "first", not one of 3 accessors/],
  [skin({ joints: [99] }), /skins\[0\]\.joints/],
  [skin({ joints: 'all' }), /skins\[0\]\.joints is not an array of numbers/],
  [skin({ joints: undefined }), /skins\[0\]\.joints is not an array of numbers/],
  [skin({ joints: [0], inverseBindMatrices: 99 }), /skins\[0\]\.inverseBindMatrices/],
];

const float = (offset: number, value: number) => {
  const bytes = Buffer.from(whole);
  bytes.writeFloatLE(value, bytes.length - unpackGlb(whole).bin.length + offset);
  return bytes;
};
const patched = (offset: number, ...values: number[]) => {
  const bytes = Buffer.from(whole);
  bytes.set(values, offset);
  return bytes;
};
const wrongBytes: [bytes: Uint8Array | string, message: RegExp][] = [
  ['', /the file is empty/],
  ['hello, world\n', /is neither a GLB or glTF file nor one of FBX/],
  ['{"hello": 1}', /is JSON but not glTF/],
  ['null', /is JSON but not glTF/],
  [whole.subarray(0, 10), /is truncated: a GLB has at least 20 bytes, this one 10/],
  [whole.subarray(0, whole.length - 100), /is truncated: its header says \d+ bytes, there are \d+/],
  [patched(4, 1), /is a GLB of version 1/],
  [patched(20, 0x21), /its JSON is damaged/],
  // The indices are the last: a float whose bits are a large number.
  [float(unpackGlb(whole).bin.length - 4, 1), /indices\[\d+\] = 1065353216 is out of range \(\d+ vertices\)/],
];

test('a file beside a glTF is found by backslashes, too; if only capitals differ, the error says how it is named', async () => {
  mkdirSync('textures', { recursive: true });
  write('textures/Skin.PNG', png(5));
  const named = (uri: string) =>
    writeChanged('beside.glb', whole, (json) => {
      json.images = [{ uri }];
    });
  named('textures\\Skin.PNG');
  await ok('transfer beside.glb --cage cage.glb -o beside-out.glb');
  assert.equal(jsonOf('beside-out.glb').images![0]!.name, 'Skin');
  named('textures/skin.png');
  await fails(
    1,
    'beside.glb: images[0] is in textures/skin.png: no such file; there is Skin.PNG',
    'transfer beside.glb --cage cage.glb -o never.glb',
  );
});

test('a target that cannot be used is one line that names file and element, and nothing is written', async () => {
  const files = [...readdirSync('.'), 'bad.glb'].sort();
  const check = async (bytes: Uint8Array | string, message: RegExp) => {
    write('bad.glb', bytes);
    const named = new RegExp(`^cagecast: bad\\.glb: .*${message.source}`, message.flags);
    await fails(1, named, 'transfer bad.glb --cage cage.glb -o never.glb --report never.json');
  };
  for (const [changes, message] of wrongJson) {
    const { json, bin } = unpackGlb(whole);
    set(json, changes);
    await check(packGlb({ json, bin }), message);
  }
  for (const [bytes, message] of wrongBytes) await check(bytes, message);
  await fails(1, /^cagecast: bad\.glb: /, 'inspect bad.glb --cage cage.glb');
  assert.deepEqual(readdirSync('.').sort(), files);
});

test('so is a cage, a texture, or a path that leads to no file', async () => {
  const { uvs: _, ...bare } = cage;
  write('bare.glb', glbOf(bare));
  write('flat.glb', glbOf({ ...cage, positions: cage.positions.map(() => 0) }));
  write('far.glb', glbOf({ ...cage, positions: cage.positions.map((x, i) => (i === 7 ? 1e30 : x)) }));
  write('text.png', 'no image');
  write('half.png', png(1).subarray(0, 60));
  for (const [line, message] of [
    [
      '--cage bare.glb',
      /bare\.glb: meshes\[0\]\.primitives\[0\] \("only"\) has no TEXCOORD_0: the texture is drawn in/,
    ],
    ['--cage flat.glb', /flat\.glb: cage has no triangle with an area/],
    [
      '--cage far.glb',
      /far\.glb: cage\.positions\[7\] = .* is too far from the origin .* \(meshes\[0\]\.primitives\[0\], "only"\)/,
    ],
    ['--cage gone.glb', /gone\.glb: no such file/],
    ['--cage .', /\.: is a folder, not a file/],
    ['--cage cage.glb --texture text.png -o o.glb', /text\.png: is not a PNG, JPEG, WebP or KTX2 image/],
    ['--cage cage.glb --texture half.png -o o.glb', /half\.png: is truncated: the PNG image is incomplete/],
    ['--cage cage.glb --mask never=text.png', /text\.png: is not a PNG, JPEG or WebP image/],
  ] as const)
    await fails(1, message, `transfer target.glb ${line}`);
  await fails(1, 'gone.glb: no such file', 'transfer gone.glb --cage cage.glb');
  await fails(1, 'gone.glb: no such file', 'inspect gone.glb --cage cage.glb');
  assert.ok(!existsSync('o.glb'));
});

test('of a file damaged at random, all is done, or one clear line says what is wrong', async () => {
  const values = [-1, 0, 1.5, 2 ** 31, 2 ** 53, 1e300, null, 'x', [], {}, true, [null], [{}]];
  for (let seed = 1; seed <= 60; ++seed) {
    const next = random(seed);
    const pick = <T>(list: readonly T[]): T => list[Math.floor(next() * list.length)]!;
    writeChanged('damaged.glb', whole, (json, { bin }) => {
      const places: [owner: Record<string, unknown>, key: string][] = [];
      const walk = (value: unknown) => {
        if (typeof value !== 'object' || value === null) return;
        for (const key of Object.keys(value)) {
          places.push([value as Record<string, unknown>, key]);
          walk((value as Record<string, unknown>)[key]);
        }
      };
      walk(json);
      const [owner, key] = pick(places);
      owner[key] = pick(values);
      for (let i = 0; i < 3; ++i) bin[Math.floor(next() * bin.length)] = Math.floor(next() * 256);
    });
    const line = 'transfer damaged.glb --cage cage.glb --texture paint.png';
    const { status, stderr } = await run(line, '-o', `out-${seed}.glb`);
    const label = `seed ${seed}: ${stderr}`;
    assert.equal(existsSync(`out-${seed}.glb`), status === 0, label);
    if (status === 0) assert.equal(stderr, '', label);
    else assert.ok(status === 1 && /^cagecast: [^\n]+\n$/.test(stderr) && !stderr.includes('unexpectedly'), label);
  }
});

test('a picture that is no PNG is decoded by the sharp of the project, as what npx runs has none beside it', () => {
  cpSync(inRepository('dist'), 'elsewhere', { recursive: true });
  write('paint.webp', readFileSync(inRepository('tests/package/command/paint.webp')));
  const relay = () => {
    const { status, stderr } = spawnSync(
      process.execPath,
      'elsewhere/cli.js relay target.glb --cage cage.glb --texture paint.webp --to cage.glb -o relayed.png'.split(' '),
    );
    return [status, stderr.toString()];
  };
  assert.deepEqual(relay(), [
    1,
    'cagecast: paint.webp: is a WebP image; to read those, npm install sharp beside cagecast\n',
  ]);
  mkdirSync('node_modules');
  symlinkSync(inRepository('node_modules/sharp'), 'node_modules/sharp', 'junction');
  assert.deepEqual(relay(), [0, '']);
  assert.deepEqual([...PNG.sync.read(readFileSync('relayed.png')).data.subarray(0, 4)], [200, 200, 200, 200]);
});

test('a far larger picture without transparency is read in the small size that is looked at, others as they are', () => {
  const maker = new GlbMaker();
  const sizes = [
    { width: 2400, height: 1200, colorType: 2 },
    { width: 2400, height: 1200, colorType: 6 },
    { width: 2000, height: 1000, colorType: 2 },
  ] as const;
  const picture = ({ width, height, colorType }: (typeof sizes)[number]) =>
    PNG.sync.write(new PNG({ width, height, fill: true }), { colorType });
  maker.json.images = sizes.map((size) => ({ bufferView: maker.view(picture(size)), mimeType: 'image/png' }));
  maker.json.textures = sizes.map((_, source) => ({ source }));
  maker.json.materials = sizes.map((_, index) => ({ pbrMetallicRoughness: { baseColorTexture: { index } } }));
  const uvs = new Float32Array(2 * vertices);
  for (const [material] of sizes.entries()) maker.node({ mesh: maker.mesh({ ...target, uvs }, { material }) });
  write('textured.glb', maker.finish());
  cpSync(inRepository('dist'), 'told/dist', { recursive: true });
  mkdirSync('told/node_modules');
  write(
    'told/node_modules/sharp.js',
    `const sharp = require(${JSON.stringify(inRepository('node_modules/sharp'))});
    module.exports = (...args) => {
      const image = sharp(...args);
      const { resize } = image;
      image.resize = (...size) => { console.error('read at', size[0], size[1]); return resize.apply(image, size); };
      return image;
    };`,
  );
  const args = 'told/dist/cli.js make textured.glb -o made.glb'.split(' ');
  const { stderr } = spawnSync(process.execPath, args);
  assert.deepEqual(stderr.toString().match(/read at .*/g), ['read at 512 256']);
});
