// What is written: UVs, zones and overlays, and all that the target had.
import assert from 'node:assert/strict';
import { existsSync, mkdirSync, readFileSync } from 'node:fs';
import { test } from 'node:test';
import type { GLTF } from '@gltf-transform/core';
import { transfer } from 'cagecast';
import { cagecast as cagecastTransform } from 'cagecast/gltf';
import { PNG } from 'pngjs';
import { fails, json, ok } from '../../support/command.js';
import {
  assertNear,
  assertTransferred,
  type Glb,
  GlbMaker,
  glbOf,
  isOverlay,
  primitivesOf,
  storedUv,
  unpackGlb,
  validate,
} from '../../support/gltf.js';
import { ktx2Of } from '../../support/ktx2.js';
import { ball } from '../scenes.js';
import { io, jsonOf, png, workplace, write, writeChanged, writeMade } from './workplace.js';

const { cage, target } = workplace('written');
const vertices = target.positions.length / 3;
const paint = png(200);
const smile = target.positions.map((x) => 0.1 * x);
/** The target as the file shows it that has all. */
const smiling = { ...target, positions: target.positions.map((x, i) => x + 0.25 * smile[i]!) };

interface Report {
  counts: Record<'cosmetic' | 'occluded' | 'uncovered' | 'culled', number>;
  triangles: { cosmetic: number };
  parts: { uvSet: string | null; overlayTriangles: number; fillsCutOuts: boolean; splitVertices: number | null }[];
}

const glb = (name: string): Glb => unpackGlb(readFileSync(name));
const read = async (name: string) => primitivesOf(await io.read(name));

test('a target without UVs gets its first set; UVs that 16 bits cannot hold are floats', async () => {
  const { uvs: _, ...plain } = target;
  write('plain.glb', glbOf(plain));
  write('wide.glb', glbOf({ ...cage, uvs: cage.uvs!.map((x) => 3 * x) }));
  const { parts } = await json<Report>('transfer plain.glb --cage wide.glb -o plain-out.glb');
  assert.deepEqual(
    parts.map(({ uvSet }) => uvSet),
    ['TEXCOORD_0'],
  );
  assert.ok((await read('plain-out.glb'))[0]!.getAttribute('TEXCOORD_0')!.getArray() instanceof Float32Array);
});

test('nothing to paint, no overlay', async () => {
  write('far.glb', glbOf({ ...cage, positions: cage.positions.map((x, i) => (i % 3 === 0 ? x + 50 : x)) }));
  const { parts, counts } = await json<Report>('transfer target.glb --cage far.glb --texture paint.png -o bare.glb');
  assert.deepEqual([counts.cosmetic, parts[0]!.overlayTriangles], [0, 0]);
  assert.deepEqual(
    await validate('bare.glb', 2),
    [0, 1].map((set) => `/meshes/0/primitives/0/attributes/TEXCOORD_${set}: UNUSED_OBJECT: This object may be unused.`),
  );
  assert.equal(jsonOf('bare.glb').meshes![0]!.primitives.length, 1);
});

test('the same input gives the same bytes', async () => {
  for (const name of ['overlay', 'again'])
    await ok(`transfer target.glb --cage cage.glb --texture paint.png -o ${name}.glb`);
  assert.deepEqual(readFileSync('overlay.glb'), readFileSync('again.glb'));
});

test('an overlay is lit as its base is, and as transparent; where it fills what a material cuts out, it says so', async () => {
  writeChanged('unlit.glb', glbOf(target), (json) => {
    const pbrMetallicRoughness = { baseColorFactor: [1, 1, 1, 0.25] };
    json.materials = [{ alphaMode: 'BLEND', pbrMetallicRoughness, extensions: { KHR_materials_unlit: {} } }];
    json.meshes![0]!.primitives[0]!.material = 0;
    json.extensionsUsed = ['KHR_materials_unlit'];
  });
  await ok('transfer unlit.glb --cage cage.glb --texture paint.png -o unlit-out.glb');
  assert.deepEqual(await validate('unlit-out.glb'), []);
  const transformed = await io.read('unlit.glb');
  await transformed.transform(cagecastTransform({ cage, texture: paint }));
  for (const document of [await io.read('unlit-out.glb'), transformed]) {
    const material = primitivesOf(document).find(isOverlay)!.getMaterial()!;
    assert.ok(material.getExtension('KHR_materials_unlit'));
    assert.equal(material.getAlpha(), 0.25);
  }
  writeChanged('hair.glb', readFileSync('unlit.glb'), (json) => {
    Object.assign(json.materials![0]!, { alphaMode: 'MASK', alphaCutoff: 0.2 });
  });
  const line = 'transfer hair.glb --cage cage.glb --texture paint.png -o hair-out.glb';
  assert.ok((await json<Report>(line)).parts[0]!.fillsCutOuts);
  assert.match(await ok(line), /\nthe overlay fills what the material cuts out of “only”; cagecast bake paints/);
});

test('an overlay is no metal where the material of its base knows none', async () => {
  const metalness = async (material: GLTF.IMaterial) => {
    writeChanged('other.glb', glbOf(target), (json) => {
      json.materials = [material];
      json.meshes![0]!.primitives[0]!.material = 0;
      json.extensionsUsed = Object.keys(material.extensions ?? {});
    });
    await ok('transfer other.glb --cage cage.glb --texture paint.png -o other-out.glb');
    return primitivesOf(await io.read('other-out.glb'))
      .find(isOverlay)!
      .getMaterial()!
      .getMetallicFactor();
  };
  const glossy = { KHR_materials_pbrSpecularGlossiness: { glossinessFactor: 0.5 } };
  assert.equal(await metalness({ extensions: glossy }), 0);
  assert.equal(await metalness({ extensions: { VRMC_materials_mtoon: { specVersion: '1.0' } } }), 0);
  assert.equal(await metalness({ pbrMetallicRoughness: { metallicFactor: 0.75 } }), 0.75);
});

test('in a VRM 0, the overlay has an entry among the properties of materials, which goes with it', async () => {
  writeChanged('zero.vrm', glbOf(target), (json) => {
    json.materials = [{ name: 'skin' }];
    json.meshes![0]!.primitives[0]!.material = 0;
    json.extensionsUsed = ['VRM'];
    json.extensions = { VRM: { materialProperties: [{ name: 'skin', shader: 'VRM/MToon' }] } };
  });
  const properties = (name: string) => {
    const { extensions, materials } = jsonOf(name);
    const all = (extensions!['VRM'] as { materialProperties: { name: string; shader: string }[] }).materialProperties;
    assert.deepEqual(
      all.map((one) => one.name),
      materials!.map((material) => material.name),
    );
    return all.map(({ shader }) => shader);
  };
  await ok('transfer zero.vrm --cage cage.glb --texture paint.png -o zero-out.vrm');
  assert.deepEqual(properties('zero-out.vrm'), ['VRM/MToon', 'VRM_USE_GLTFSHADER']);
  await ok('transfer zero-out.vrm --cage cage.glb -o zero-bare.vrm');
  assert.deepEqual(properties('zero-bare.vrm'), ['VRM/MToon']);
});

test('an overlay is lit by the maps of its base, which lie as they did: normals, occlusion, roughness and metalness', async () => {
  writeMade('pores.glb', (maker) => {
    const mesh = maker.mesh(target, { material: 0 });
    const { attributes } = maker.json.meshes[mesh]!.primitives[0]!;
    const tangents = Float32Array.from({ length: 4 * vertices }, (_, i) => Number(i % 4 === 0 || i % 4 === 3));
    attributes['TANGENT'] = maker.accessor(tangents, 'VEC4');
    attributes['NORMAL'] = maker.accessor(
      Float32Array.from({ length: 3 * vertices }, (_, i) => Number(i % 3 === 2)),
      'VEC3',
    );
    attributes['TEXCOORD_1'] = maker.accessor(new Float32Array(2 * vertices).fill(0.5), 'VEC2');
    maker.node({ mesh, name: 'head' });
    maker.json.images = [{ bufferView: maker.view(paint), mimeType: 'image/png' }];
    maker.json.textures = [{ source: 0 }];
    maker.json.extensionsUsed = ['KHR_texture_transform'];
    const extensions = { KHR_texture_transform: { scale: [4, 4], texCoord: 1 } };
    maker.json.materials = [
      {
        name: 'skin',
        normalTexture: { index: 0, scale: 0.5, extensions },
        occlusionTexture: { index: 0 },
        pbrMetallicRoughness: { metallicRoughnessTexture: { index: 0 }, roughnessFactor: 0.7 },
      },
    ];
  });
  await ok('transfer pores.glb --cage cage.glb --texture paint.png -o pores-out.glb');
  assert.deepEqual(await validate('pores-out.glb'), []);
  const { meshes, materials } = jsonOf('pores-out.glb');
  const [base, overlay] = meshes![0]!.primitives;
  assert.deepEqual(
    ['TEXCOORD_1', 'TEXCOORD_2', 'TANGENT'].map((semantic) => overlay!.attributes[semantic]),
    ['TEXCOORD_1', 'TEXCOORD_0', 'TANGENT'].map((semantic) => base!.attributes[semantic]),
  );
  const { normalTexture, occlusionTexture, pbrMetallicRoughness: pbr } = materials![overlay!.material!]!;
  const extensions = { KHR_texture_transform: { scale: [4, 4] } };
  assert.deepEqual(normalTexture, { index: 0, scale: 0.5, texCoord: 1, extensions });
  assert.deepEqual(occlusionTexture, { index: 0, texCoord: 2 });
  assert.deepEqual(
    [pbr!.metallicRoughnessTexture, pbr!.metallicFactor, pbr!.roughnessFactor],
    [{ index: 0, texCoord: 2 }, 1, 0.7],
  );
  const transformed = await io.read('pores.glb');
  await transformed.transform(cagecastTransform({ cage, texture: paint }));
  const primitive = primitivesOf(transformed).find(isOverlay)!;
  assert.deepEqual(primitive.listSemantics().sort(), Object.keys(overlay!.attributes).sort());
  const material = primitive.getMaterial()!;
  assert.deepEqual(
    [material.getNormalScale(), material.getMetallicFactor(), material.getRoughnessFactor()],
    [0.5, 1, 0.7],
  );
  assert.equal(material.getMetallicRoughnessTextureInfo()!.getTexCoord(), 2);
});

test('what the paint hides is drawn in place of the surface; what it shows through, over it', async () => {
  // Opaque but for its right half.
  const image = new PNG({ width: 16, height: 16 });
  image.data.forEach((_, i) => (image.data[i] = i % 4 === 3 && (i >> 2) % 16 >= 8 ? 100 : 255));
  write('half.png', PNG.sync.write(image));
  const { parts, triangles } = await json<Report>('transfer target.glb --cage cage.glb --texture half.png -o half.glb');
  assert.equal(parts[0]!.overlayTriangles, triangles.cosmetic);
  assert.deepEqual(
    (await validate('half.glb')).filter((line) => !line.includes('UNUSED_OBJECT')),
    [],
  );
  const { meshes, materials, accessors } = jsonOf('half.glb');
  const [base, first, second] = meshes![0]!.primitives;
  const counts = [base, first, second].map((one) => accessors![one!.indices!]!.count / 3);
  assert.deepEqual(
    [first, second].map((one) => materials![one!.material!]!.alphaMode),
    [undefined, 'BLEND'],
  );
  assert.equal(counts[0]! + counts[1]!, target.indices.length / 3);
  assert.equal(counts[1]! + counts[2]!, triangles.cosmetic);
  assert.ok(counts[1]! > 0 && counts[2]! > 0, String(counts));

  // Whoever reads it again has the whole model, and another paint takes the place of this one.
  const again = await json<Report>('transfer half.glb --cage cage.glb --texture half.png -o again.glb');
  assert.deepEqual(again.triangles, triangles);
  const repainted = jsonOf('again.glb');
  assert.deepEqual(
    repainted.meshes![0]!.primitives.map(({ indices }) => repainted.accessors![indices!]!.count / 3),
    counts,
  );
  await ok('transfer half.glb --cage cage.glb -o bare.glb');
  const bare = jsonOf('bare.glb');
  assert.deepEqual(
    bare.meshes![0]!.primitives.map(({ indices }) => bare.accessors![indices!]!.count),
    [target.indices.length],
  );
  const document = await io.read('half.glb');
  await document.transform(cagecastTransform({ cage }));
  const [only, ...others] = primitivesOf(document);
  assert.deepEqual([only!.getIndices()!.getCount(), others.length], [target.indices.length, 0]);
});

test('paint is as metallic as its base, and does not hide its glow', async () => {
  writeChanged('metal.glb', readFileSync('target.glb'), (own) => {
    own.materials = [
      {
        emissiveFactor: [0.5, 0.25, 0],
        extensions: { KHR_materials_emissive_strength: { emissiveStrength: 3 } },
        pbrMetallicRoughness: { metallicFactor: 0.75, roughnessFactor: 0.25 },
      },
    ];
    own.extensionsUsed = ['KHR_materials_emissive_strength'];
    own.meshes![0]!.primitives[0]!.material = 0;
  });
  await ok('transfer metal.glb --cage cage.glb --texture paint.png -o metal-out.glb');
  const { materials } = jsonOf('metal-out.glb');
  const transformed = await io.read('metal.glb');
  await transformed.transform(cagecastTransform({ cage, texture: paint }));
  const material = primitivesOf(transformed).find(isOverlay)!.getMaterial()!;
  assert.deepEqual([material.getMetallicFactor(), material.getEmissiveFactor()], [0.75, [0.5, 0.25, 0]]);
  assert.ok(material.getExtension('KHR_materials_emissive_strength'));
  const { emissiveFactor, extensions, pbrMetallicRoughness } = materials![1]!;
  assert.deepEqual(
    [emissiveFactor, extensions, pbrMetallicRoughness!.metallicFactor],
    [[0.5, 0.25, 0], { KHR_materials_emissive_strength: { emissiveStrength: 3 } }, 0.75],
  );
});

/** A target with a bit of everything. */
function rich(): Uint8Array {
  const maker = new GlbMaker();
  const own = maker.json;
  const mesh = maker.mesh(target, { material: 0, extras: { part: 'skin' } });
  const floats = (size: number, value: (i: number) => number) =>
    Float32Array.from({ length: size * vertices }, (_, i) => value(i));
  const primitive = own.meshes[mesh]!.primitives[0]!;
  Object.assign(primitive.attributes, {
    NORMAL: maker.accessor(
      floats(3, (i) => Number(i % 3 === 2)),
      'VEC3',
    ),
    COLOR_0: maker.accessor(new Uint8Array(4 * vertices).fill(255), 'VEC4', { normalized: true }),
    JOINTS_0: maker.accessor(new Uint8Array(4 * vertices), 'VEC4'),
    WEIGHTS_0: maker.accessor(
      floats(4, (i) => Number(i % 4 === 0)),
      'VEC4',
    ),
    _TEMPERATURE: maker.accessor(
      floats(1, () => 37),
      'SCALAR',
    ),
  });
  primitive.targets = [
    {
      POSITION: maker.accessor(smile, 'VEC3'),
    },
  ];
  Object.assign(own.meshes[mesh]!, { weights: [0.25], extras: { targetNames: ['smile'] } });
  const identity = new Float32Array([1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1]);
  own.skins = [{ joints: [1], inverseBindMatrices: maker.accessor(identity, 'MAT4') }];
  maker.node({ mesh, skin: 0, name: 'head', extras: { id: 7 }, extensions: { ACME_avatar: { node: 0, mesh: 0 } } });
  maker.node({ name: 'bone' });
  const input = maker.accessor(new Float32Array([0, 1]), 'SCALAR', { min: [0], max: [1] });
  const output = maker.accessor(new Float32Array([0, 0, 0, 1, 0, 0, 0, 1]), 'VEC4');
  const channels: GLTF.IAnimationChannel[] = [{ sampler: 0, target: { node: 1, path: 'rotation' } }];
  own.animations = [{ name: 'nod', samplers: [{ input, output }], channels }];
  own.images = [{ bufferView: maker.view(paint), mimeType: 'image/png', name: 'freckles' }];
  own.textures = [{ source: 0 }];
  own.materials = [
    {
      name: 'skin',
      doubleSided: true,
      pbrMetallicRoughness: { baseColorTexture: { index: 0 }, roughnessFactor: 0.4 },
      extensions: {
        KHR_materials_sheen: { sheenRoughnessFactor: 0.5 },
        VRMC_materials_mtoon: { specVersion: '1.0', shadeColorFactor: [0.1, 0.25, 1] },
        ACME_secret: { a: [1, 2, { b: null }] },
      },
    },
  ];
  own.extensionsUsed = ['KHR_materials_sheen', 'VRMC_vrm', 'VRMC_materials_mtoon', 'ACME_secret', 'ACME_avatar'];
  const preset = { happy: { morphTargetBinds: [{ node: 0, index: 0, weight: 0.3 }] } };
  const VRMC_vrm = { specVersion: '1.0', meta: { name: 'Ünïcode', authors: ['a', 'b'] }, expressions: { preset } };
  own.extensions = { ACME_avatar: { meshes: [0], textures: [0], stiffness: 1e-7 }, VRMC_vrm };
  own.extras = { author: 'someone' };
  own.asset.generator = 'by hand';
  return maker.finish();
}

test('split vertices keep skins, morphs, colours and attributes of others; all else is as it was, in a VRM too', async () => {
  write('rich.vrm', rich());
  await ok('transfer rich.vrm --cage cage.glb --texture paint.png -o split.vrm');
  const [[before], [base, overlay]] = [await read('rich.vrm'), await read('split.vrm')];
  assert.deepEqual(
    before!.listSemantics().sort().join(),
    'COLOR_0,JOINTS_0,NORMAL,POSITION,TEXCOORD_0,WEIGHTS_0,_TEMPERATURE',
  );
  assert.equal(before!.listTargets().length, 1);
  assert.ok(assertTransferred(before!, base!, transfer(cage, smiling)) > 0);
  for (const name of ['NORMAL', 'JOINTS_0', 'WEIGHTS_0'])
    assert.deepEqual(overlay!.getAttribute(name)!.getArray(), base!.getAttribute(name)!.getArray());
  const morph = (primitive = base!) => primitive.listTargets()[0]!.getAttribute('POSITION')!.getArray();
  assert.deepEqual(morph(overlay), morph());
  const [old, own] = [jsonOf('rich.vrm'), jsonOf('split.vrm')];
  for (const field of ['nodes', 'skins', 'animations', 'extensions', 'extras', 'extensionsUsed', 'scenes'] as const)
    assert.equal(JSON.stringify(own[field]), JSON.stringify(old[field]), field);
  const [{ weights, extras, primitives }] = own.meshes as [GLTF.IMesh];
  assert.deepEqual([weights, extras, primitives[0]!.extras], [[0.25], { targetNames: ['smile'] }, { part: 'skin' }]);
});

test('with --set seams=vertex no vertex is added, and every byte and member stays what it was', async () => {
  write('rich.glb', rich());
  assert.deepEqual(await validate('rich.glb'), []);
  await ok('transfer rich.glb --cage cage.glb --set seams=vertex --texture paint.png -o rich-out.glb');
  assert.deepEqual(await validate('rich-out.glb'), []);
  const [before, after] = [glb('rich.glb'), glb('rich-out.glb')];
  const assertHolds = (whole: unknown, part: unknown, path = ''): void => {
    if (typeof part !== 'object' || part === null) {
      assert.deepEqual(whole, part, path);
      return;
    }
    for (const [key, value] of Object.entries(part))
      if (path !== '/buffers/0' || key !== 'byteLength')
        assertHolds((whole as Record<string, unknown>)[key], value, `${path}/${key}`);
  };
  assertHolds(after.json, before.json);
  assert.deepEqual(after.bin.subarray(0, before.bin.length), before.bin);
  const [base, overlay] = after.json.meshes![0]!.primitives as [GLTF.IMeshPrimitive, GLTF.IMeshPrimitive];
  assert.deepEqual(overlay.targets, base.targets);
  for (const name of ['NORMAL', 'JOINTS_0', 'WEIGHTS_0']) assert.equal(overlay.attributes[name], base.attributes[name]);
  assert.equal(overlay.attributes['TEXCOORD_0'], base.attributes['TEXCOORD_1']);
  assert.equal(overlay.attributes['COLOR_0'], undefined);
  const { materials, textures, images, bufferViews } = after.json;
  const { alphaMode, doubleSided, pbrMetallicRoughness } = materials![overlay.material!]!;
  assert.deepEqual([alphaMode, doubleSided], ['BLEND', true]);
  const image = images![textures![pbrMetallicRoughness!.baseColorTexture!.index]!.source!]!;
  const { byteOffset = 0, byteLength } = bufferViews![image.bufferView!]!;
  assert.deepEqual(Buffer.from(after.bin.subarray(byteOffset, byteOffset + byteLength)), paint);
  const result = transfer(cage, smiling);
  const [written] = await read('rich-out.glb');
  const [uvs, zones] = [written!.getAttribute('TEXCOORD_1')!, written!.getAttribute('_NCZ')!.getArray()!];
  assert.ok(uvs.getArray() instanceof Uint16Array && uvs.getNormalized() && zones instanceof Uint8Array);
  for (let v = 0; v < vertices; ++v) assertNear(storedUv(uvs, v), result.uvs.subarray(2 * v, 2 * v + 2), `vertex ${v}`);
  assert.deepEqual([...zones], [...result.zones]);
});

test('what animates a mesh, or is an expression of it, does so with its copies; what only another scene shows stays as it is', async () => {
  writeMade('moved.glb', (maker) => {
    const small = ball([0, 0, 0], () => 0.2, 8, 12);
    const POSITION = maker.accessor(new Float32Array(small.positions.length), 'VEC3');
    const mesh = maker.mesh(small, { targets: [{ POSITION }] });
    for (const x of [-0.6, 0.6]) maker.node({ mesh, translation: [x, 0, 0] });
    maker.json.scenes!.push({ nodes: [maker.node({ mesh }, false)] });
    const target = { path: 'pointer', extensions: { KHR_animation_pointer: { pointer: `/meshes/${mesh}/weights` } } };
    const times = maker.accessor(Float32Array.of(0, 1), 'SCALAR', { min: [0], max: [1] });
    const channel = { sampler: 0, target } as GLTF.IAnimationChannel;
    maker.json.animations = [{ samplers: [{ input: times, output: times }], channels: [channel] }];
    maker.json.extensionsUsed = ['KHR_animation_pointer', 'VRM'];
    const blendShapeGroups = [{ name: 'A', binds: [{ mesh, index: 0, weight: 100 }] }, null];
    const firstPerson = { meshAnnotations: [{ mesh, firstPersonFlag: 'Auto' }] };
    maker.json.extensions = { VRM: { blendShapeMaster: { blendShapeGroups }, firstPerson } };
  });
  await ok('transfer moved.glb --cage cage.glb --texture paint.png -o moved-out.glb');
  const { nodes, meshes, animations, extensions } = jsonOf('moved-out.glb');
  assert.deepEqual(
    nodes!.map(({ mesh }) => mesh),
    [0, 1, 2],
  );
  assert.deepEqual(
    meshes!.map(({ primitives }) => primitives.length),
    [2, 2, 1],
  );
  assert.deepEqual(Object.keys(meshes![2]!.primitives[0]!.attributes), ['POSITION', 'TEXCOORD_0']);
  const pointers = animations![0]!.channels.map(({ target }) => JSON.stringify(target.extensions));
  const all = [0, 1, 2];
  assert.deepEqual(
    pointers.sort(),
    all.map((n) => `{"KHR_animation_pointer":{"pointer":"/meshes/${n}/weights"}}`),
  );
  assert.deepEqual(extensions!['VRM'], {
    blendShapeMaster: {
      blendShapeGroups: [{ name: 'A', binds: all.map((mesh) => ({ mesh, index: 0, weight: 100 })) }, null],
    },
    firstPerson: { meshAnnotations: all.map((mesh) => ({ mesh, firstPersonFlag: 'Auto' })) },
  });
});

test('a WebP or KTX2 texture is the file as it is; what glTF cannot hold is an error', async () => {
  const webp = Buffer.from('UklGRhoAAABXRUJQVlA4TA0AAAAvAAAAEAcQERGIiP4HAA==', 'base64'); // 1 × 1 pixel, lossless
  const ktx2 = Buffer.from(ktx2Of(200, 30, 60));
  for (const [type, bytes, extension] of [
    ['webp', webp, 'EXT_texture_webp'],
    ['ktx2', ktx2, 'KHR_texture_basisu'],
  ] as const) {
    write(`paint.${type}`, bytes);
    await ok(`transfer target.glb --cage cage.glb --texture paint.${type} -o textured.glb`);
    assert.deepEqual(await validate('textured.glb'), []);
    assert.deepEqual(jsonOf('textured.glb').extensionsRequired, [extension]);
    const [texture] = (await io.read('textured.glb')).getRoot().listTextures();
    assert.deepEqual([texture!.getMimeType(), Buffer.from(texture!.getImage()!)], [`image/${type}`, bytes]);
  }
  const patched = (offset: number, value: number) => {
    const bytes = Buffer.from(ktx2);
    bytes.writeUInt32LE(value, offset);
    return bytes;
  };
  for (const [bytes, message] of [
    [webp.subarray(0, 20), /bad: is truncated: the WebP image is incomplete/],
    [ktx2.subarray(0, 150), /bad: is truncated: the KTX2 image/],
    [patched(12, 37), /bad: .*that glTF cannot hold: vkFormat is 37, not 0 \(Basis Universal\)/],
    [patched(20, 5), /bad: .*it has 5 × 4 pixels, not multiples of 4/],
  ] as const) {
    write('bad', bytes);
    await fails(1, message, 'transfer target.glb --cage cage.glb --texture bad -o never.glb');
  }
  assert.ok(!existsSync('never.glb'));
});

const countsOf = async (path: string) => (await json<Report>(`transfer ${path} --cage cage.glb`)).counts;

test('an unknown extension that is required, and nodes outside the scene that are their own ancestors, are no matter', async () => {
  writeChanged('odd.glb', glbOf(target), (json) => {
    json.extensionsUsed = json.extensionsRequired = ['ACME_materials'];
    json.nodes!.push({ children: [2] }, { children: [1] });
  });
  assert.deepEqual(await countsOf('odd.glb'), await countsOf('target.glb'));
});

test('quantised vertices that are split stay so, in words of four bytes', async () => {
  const words = Int16Array.from({ length: 4 * vertices }, (_, i) =>
    i % 4 === 3 ? 0 : Math.round((target.positions[3 * Math.floor(i / 4) + (i % 4)]! / 2) * 32767),
  );
  writeMade('quantised.glb', (maker) => {
    const bound = (pick: typeof Math.min) => [0, 1, 2].map((k) => pick(...words.filter((_, i) => i % 4 === k)));
    const accessor = { componentType: 5122, normalized: true, count: vertices, type: 'VEC3' } as const;
    const bufferView = maker.view(new Uint8Array(words.buffer), { byteStride: 8 });
    const POSITION =
      maker.json.accessors.push({ ...accessor, bufferView, min: bound(Math.min), max: bound(Math.max) }) - 1;
    const primitive = { attributes: { POSITION }, indices: maker.accessor(target.indices as Uint32Array, 'SCALAR') };
    maker.node({ mesh: maker.json.meshes.push({ primitives: [primitive] }) - 1, scale: [2, 2, 2] });
    maker.json.extensionsUsed = maker.json.extensionsRequired = ['KHR_mesh_quantization'];
  });
  assert.match(await ok('transfer quantised.glb --cage cage.glb -o split.glb'), / split at seams/);
  assert.deepEqual(await validate('split.glb'), []);
  const positions = (await read('split.glb'))[0]!.getAttribute('POSITION')!;
  assert.ok(positions.getNormalized());
  const before = words.filter((_, i) => i % 4 < 3);
  assert.deepEqual(positions.getArray()!.slice(0, 3 * vertices), before);
});

test('the triangles of strips and fans face the same way in the overlay', async () => {
  const positions = new Float32Array([-0.1, -0.1, 0.9, 0.1, -0.1, 0.9, -0.1, 0.1, 0.9, 0.1, 0.1, 0.9]);
  for (const [mode, indices] of [
    [4, [0, 1, 2, 2, 1, 3]],
    [5, [0, 1, 2, 3]],
    [6, [1, 3, 2, 0]],
  ] as const) {
    write('mode.glb', glbOf({ positions, indices: Uint16Array.from(indices), mode }));
    await ok('transfer mode.glb --cage cage.glb --texture paint.png -o wound.glb');
    const overlay = (await read('wound.glb'))[1]!;
    const corners = [...overlay.getIndices()!.getArray()!].map((v) =>
      overlay.getAttribute('POSITION')!.getElement(v, [] as number[]),
    );
    assert.equal(corners.length, 6);
    // They face up, as the cage is above.
    for (let i = 0; i < corners.length; i += 3) {
      const [a, b, c] = corners.slice(i, i + 3) as [number[], number[], number[]];
      assert.ok((b[0]! - a[0]!) * (c[1]! - a[1]!) > (b[1]! - a[1]!) * (c[0]! - a[0]!), `mode ${mode}`);
    }
  }
});

test('buffers and images beside a glTF, or in it as data URIs of any kind, become one GLB', async () => {
  const { json: whole, bin } = unpackGlb(glbOf(target));
  const base64 = (bytes: Uint8Array) => Buffer.from(bytes).toString('base64');
  const escaped = (bytes: Uint8Array) => [...bytes].map((byte) => `%${byte.toString(16).padStart(2, '0')}`).join('');
  const encoded = (bytes: Uint8Array) => encodeURIComponent(base64(bytes));
  const embedded = (kind: string, encode: (bytes: Uint8Array) => string): [string, string, string] => [
    `data:application/octet-stream${kind},${encode(bin)}`,
    `data:image/png${kind},${encode(paint)}`,
    'first',
  ];
  mkdirSync('loose');
  write('loose/mesh data.bin', bin);
  write('loose/head 50%.bin', bin);
  for (const name of ['skin', 'own name']) write(`loose/${name}.png`, paint);
  for (const [buffer, image, name] of [
    ['mesh%20data.bin', 'skin.png', 'skin'],
    ['head 50%.bin', 'own%20name.png', 'own name'], // as no URI is
    embedded(';base64', base64),
    embedded(';BASE64', base64),
    embedded(';base64', encoded),
    embedded('', escaped),
  ] as const) {
    whole.buffers![0]!.uri = buffer;
    whole.images = [{ uri: image, ...(name === 'first' && { name }) }];
    whole.textures = [{ source: 0 }];
    whole.materials = [{ pbrMetallicRoughness: { baseColorTexture: { index: 0 } } }];
    whole.meshes![0]!.primitives[0]!.material = 0;
    write('loose/target.gltf', JSON.stringify(whole));
    await ok('transfer loose/target.gltf --cage cage.glb -o packed.glb');
    assert.deepEqual(await countsOf('loose/target.gltf'), await countsOf('target.glb'), buffer.slice(0, 60));
    assert.deepEqual(await validate('packed.glb'), []);
    const { images, bufferViews } = unpackGlb(readFileSync('packed.glb')).json;
    const { byteOffset = 0, byteLength } = bufferViews![images![0]!.bufferView!]!;
    const stored = unpackGlb(readFileSync('packed.glb')).bin.subarray(byteOffset, byteOffset + byteLength);
    assert.deepEqual([images![0]!.name, Buffer.from(stored)], [name, paint]);
  }
});

test('images of kinds that only an extension admits are known by the endings of their names', async () => {
  const images: GLTF.IImage[] = [{ uri: 'skin.avif' }, { uri: 'skin.DDS' }, { uri: 'skin.bmp', mimeType: 'image/bmp' }];
  for (const { uri } of images) write(uri!, 'image');
  writeChanged('avif.glb', glbOf(target), (json) =>
    Object.assign(json, { images, extensionsUsed: ['EXT_texture_avif'] }),
  );
  await ok('transfer avif.glb --cage cage.glb -o avif-out.glb');
  const types = unpackGlb(readFileSync('avif-out.glb')).json.images!.map(({ mimeType }) => mimeType);
  assert.deepEqual(types, ['image/avif', 'image/vnd-ms.dds', 'image/bmp']);
});
