// Layers as saved by cagecast/three, drawn into the textures of files: without three.js and a GPU.
import assert from 'node:assert/strict';
import { readFileSync, writeFileSync } from 'node:fs';
import { after, before, describe, test } from 'node:test';
import { type Document, type GLTF, type Material, NodeIO } from '@gltf-transform/core';
import { ALL_EXTENSIONS } from '@gltf-transform/extensions';
import { type PaintOptions, paintGlb } from 'cagecast/gltf';
import type { SavedLayer, SavedLayers } from 'cagecast/three';
import { terminate } from 'cagecast/worker';
import { PNG } from 'pngjs';
import { fails, json, ok } from '../../support/command.js';
import { packGlb, unpackGlb, validate } from '../../support/gltf.js';
import { islandCage, texturedBox } from '../../support/models';
import { temporaryFolder } from '../../support/temporary.js';
import { picture } from './reference.js';

const { folder } = temporaryFolder('look');
const io = new NodeIO().registerExtensions(ALL_EXTENSIONS);
const size = 96;
type Image = ReturnType<typeof picture>;

const pngOf = ({ width, height, data }: Image): Buffer =>
  PNG.sync.write(Object.assign(new PNG({ width, height }), { data: Buffer.from(data) }));
const urlOf = (...color: number[]) => `data:image/png;base64,${pngOf(picture(4, () => color)).toString('base64')}`;
const own = picture(size, () => [100, 120, 200, 255]);
/** The middle of an island that is painted, and a place beside all of them. */
const [kIsland, kBeside] = [[16, 24], [90, 2]] as const; // biome-ignore format: pairs

const plain = { opacity: 1, tint: '#ffffff', blend: 'normal', visible: true, region: null } as const;
const layer = (color: number[], style: Partial<SavedLayer> = {}): SavedLayer => ({
  name: 'layer',
  image: urlOf(...color),
  ...plain,
  ...style,
});
const lookOf = (layers: SavedLayer[], more: Partial<SavedLayers> = {}): SavedLayers => ({
  version: 1,
  layers,
  ...more,
});
/** Colours, gloss, metal, glow and relief. */
const whole = lookOf(
  [
    layer([255, 0, 0, 128], { roughness: 0.2 }),
    layer([255, 255, 255, 255], { blend: 'none', metalness: 0.6, normal: urlOf(200, 128, 230, 255) }),
    layer([0, 255, 0, 255], { opacity: 0.5, emissive: 2 }),
  ],
  { baseTint: '#808080' },
);

let box: Uint8Array;
let cage: Uint8Array;
before(async () => {
  process.chdir(folder); // so that commands are short
  cage = (await islandCage(1)).buffer;
  box = (await texturedBox(pngOf(own))).buffer;
  writeFileSync('cage.glb', cage);
  writeFileSync('box.glb', box);
  writeFileSync('look.json', JSON.stringify(whole));
  writeFileSync('red.json', JSON.stringify(lookOf([layer([200, 20, 20, 255])])));
});
after(terminate);

const texel = (image: Uint8Array | null | undefined, [x, y]: readonly [number, number]): number[] => {
  const { data, width } = PNG.sync.read(Buffer.from(image!));
  const scale = width / size;
  const at = 4 * (Math.floor(y * scale) * width + Math.floor(x * scale));
  return [...data.subarray(at, at + 4)];
};
const near = (found: readonly number[], expected: readonly number[], most = 2) =>
  assert.ok(
    expected.every((value, k) => Math.abs(value - found[k]!) <= most),
    `${found} is not ${expected}`,
  );
const read = async (bytes: Uint8Array): Promise<Document> => io.readBinary(bytes);
const materialOf = async (bytes: Uint8Array): Promise<Material> => (await read(bytes)).getRoot().listMaterials()[0]!;
const paint = (bytes: Uint8Array, look: unknown, more: Partial<PaintOptions> = {}) =>
  paintGlb(bytes, { cage, look: look as SavedLayers, ...more });
const linear = (byte: number) => (byte <= 10 ? byte / 255 / 12.92 : ((byte / 255 + 0.055) / 1.055) ** 2.4);
const srgb = (share: number) => 255 * (share <= 0.0031308 ? 12.92 * share : 1.055 * share ** (1 / 2.4) - 0.055);

describe('a look in a file', () => {
  test('colours, tint, gloss, metal, relief and glow are in the textures, as far as the cage paints', async () => {
    const { bytes, left, triangles } = await paint(box, whole);
    assert.deepEqual(left, []);
    assert.ok(triangles.painted > 0);
    assert.deepEqual(await validate(bytes), await validate(box));
    const material = await materialOf(bytes);
    const mixed = [100, 120, 200].map((byte, k) => {
      const tinted = linear(byte) * linear(128);
      const red = (128 / 255) * [1, 0, 0][k]! + (127 / 255) * tinted;
      return srgb(0.5 * [0, 1, 0][k]! + 0.5 * red);
    });
    near(texel(material.getBaseColorTexture()!.getImage(), kIsland), mixed);
    near(texel(material.getBaseColorTexture()!.getImage(), kBeside), [100, 120, 200, 255], 0);
    const rough = texel(material.getMetallicRoughnessTexture()!.getImage(), kIsland);
    near(rough, [255, 255 * ((128 / 255) * 0.2 + 127 / 255), 255 * 0.6]);
    near(texel(material.getMetallicRoughnessTexture()!.getImage(), kBeside), [255, 255]);
    const [x, y, z] = texel(material.getNormalTexture()!.getImage(), kIsland).map((byte) => byte / 127.5 - 1);
    near([Math.hypot(x!, y!, z!), z!], [1, 0.8], 0.1);
    assert.ok(Math.hypot(x!, y!) > 0.4);
    near(texel(material.getNormalTexture()!.getImage(), kBeside), [128, 128, 255]);
    const strength = material.getExtension('KHR_materials_emissive_strength') as unknown as {
      getEmissiveStrength(): number;
    } | null;
    const shine = texel(material.getEmissiveTexture()!.getImage(), kIsland);
    near([linear(shine[1]!) * (strength?.getEmissiveStrength() ?? 1)], [1], 0.02);
    assert.deepEqual(material.getEmissiveFactor(), [1, 1, 1]);
    near(texel(material.getEmissiveTexture()!.getImage(), kBeside), [0, 0, 0], 0);
  });

  test('the command writes the same', async () => {
    const { textures } = await json<{ textures: { slot: string }[] }>(
      'bake box.glb --cage cage.glb --look look.json -o out.glb',
    );
    assert.deepEqual(
      textures.map(({ slot }) => slot),
      ['color', 'normal', 'orm', 'emissive'],
    );
    const [ours, commands] = [
      await materialOf((await paint(box, whole)).bytes),
      await materialOf(readFileSync('out.glb')),
    ];
    for (const get of [
      'getBaseColorTexture',
      'getNormalTexture',
      'getMetallicRoughnessTexture',
      'getEmissiveTexture',
    ] as const)
      assert.deepEqual(
        PNG.sync.read(Buffer.from(ours[get]()!.getImage()!)).data,
        PNG.sync.read(Buffer.from(commands[get]()!.getImage()!)).data,
      );
  });

  test('what a look lacks stays byte for byte', async () => {
    const { bytes } = await paint(box, lookOf([layer([255, 0, 0, 255])]));
    const material = await materialOf(bytes);
    assert.equal(material.getMetallicRoughnessTexture(), null);
    assert.equal(material.getEmissiveTexture(), null);
    assert.equal(material.getNormalTexture(), null);
  });

  test('a part without a texture shows it by a copy of its surface and an overlay, and says so; they are replaced', async () => {
    const { json, bin } = unpackGlb(box);
    delete json.materials![0]!.pbrMetallicRoughness!.baseColorTexture;
    const bare = packGlb({ json, bin });
    const { bytes, left } = await paint(bare, whole);
    assert.deepEqual(
      left.map(({ reason }) => reason),
      ['its material has no texture'],
    );
    assert.deepEqual(await validate(bytes), []);
    const primitives = (await read(bytes)).getRoot().listMeshes()[0]!.listPrimitives();
    const count = (p: number) => primitives[p]!.getIndices()!.getCount();
    const [before] = (await read(bare)).getRoot().listMeshes()[0]!.listPrimitives();
    assert.equal(primitives.length, 3);
    // A primitive has at least one triangle.
    assert.deepEqual([count(0) + count(1), count(2)], [before!.getIndices()!.getCount(), 3]);
    const [, surface, overlay] = primitives.map((primitive) => primitive.getMaterial()!);
    const tinted = linear(128);
    const mixed = [0, 1, 2].map((k) =>
      srgb(0.5 * [0, 1, 0][k]! + 0.5 * ((128 / 255) * [1, 0, 0][k]! + (127 / 255) * tinted)),
    );
    near(texel(surface!.getBaseColorTexture()!.getImage(), [48, 48]), mixed);
    assert.deepEqual(surface!.getBaseColorFactor(), [1, 1, 1, 1]);
    assert.ok(overlay!.getBaseColorTexture());
    for (const one of [surface!, overlay!]) {
      assert.ok(one.getNormalTexture() && one.getMetallicRoughnessTexture() && one.getEmissiveTexture());
      assert.deepEqual([one.getRoughnessFactor(), one.getMetallicFactor()], [1, 1]);
    }
    const { triangles, bytes: again } = await paint(bytes, lookOf([]));
    assert.equal(triangles.total, before!.getIndices()!.getCount() / 3);
    assert.equal(unpackGlb(again).json.images?.length ?? 0, unpackGlb(bare).json.images?.length ?? 0);
  });

  test('another size; another codec', async () => {
    const { bytes } = await paint(box, whole, {
      size: 48,
      encode: async (image) => {
        assert.equal(image.width, 48);
        return pngOf(image as Image);
      },
    });
    assert.equal(PNG.sync.read(Buffer.from((await materialOf(bytes)).getBaseColorTexture()!.getImage()!)).width, 48);
  });

  test('what is no look is refused, with the way out', async () => {
    const refuses = (look: unknown, message: RegExp, more: Partial<PaintOptions> = {}) =>
      assert.rejects(paint(box, look, more), message);
    await refuses({}, /^CagecastError: paintGlb: saved is of type Object, not what save returned/);
    await refuses(lookOf([layer([0, 0, 0, 0], { opacity: 2 })]), /paintGlb: saved\.layers\[0\]\.opacity is 2/);
    await refuses(
      lookOf([layer([0, 0, 0, 0], { region: 'lips' })]),
      /region is "lips", which is not known; the cage has none/,
    );
    await refuses(whole, /texture and look are both given; one of them is needed/, { texture: new Uint8Array(3) });
    await refuses(whole, /options\.size is 0, not a whole number/, { size: 0 });
    await refuses(undefined, /neither texture nor look is given/);
    writeFileSync('bad.json', JSON.stringify({ version: 2, layers: [] }));
    await fails(1, /bad\.json: saved\.version is 2/m, 'bake box.glb --cage cage.glb --look bad.json -o out.glb');
    await fails(
      2,
      /--look takes no other paint/,
      'bake box.glb --cage cage.glb --look look.json --texture look.json -o out.glb',
    );
  });
});

interface Vrm0 {
  materialProperties: {
    textureProperties: Record<string, number>;
    vectorProperties: Record<string, number[]>;
    floatProperties: Record<string, number>;
  }[];
  blendShapeMaster?: object;
}
interface Toon {
  shadeMultiplyTexture?: { index: number };
  shadeColorFactor: number[];
  uvAnimationScrollXSpeedFactor?: number;
}

/**
 * The box as an avatar with a toon material, half as bright in the shade.
 * @param shade   Its texture there: one of its own, that of the light, or none.
 * @param factor  By which its colour is multiplied in the light.
 */
function avatar(version: 0 | 1, shade: 'own' | 'same' | 'none' = 'none', factor = 1): Uint8Array {
  const { json, bin } = unpackGlb(box);
  const [material] = json.materials as GLTF.IMaterial[];
  const pbr = material!.pbrMetallicRoughness!;
  pbr.baseColorFactor = [factor, factor, factor, 1];
  const { index } = pbr.baseColorTexture!;
  const own = shade === 'own' ? json.textures!.push({ ...json.textures![index] }) - 1 : index;
  if (version === 1) {
    json.extensionsUsed = ['VRMC_vrm', 'VRMC_materials_mtoon'];
    const toon: Toon = {
      shadeColorFactor: [0.5, 0.5, 0.5],
      ...(shade !== 'none' && { shadeMultiplyTexture: { index: own } }),
    };
    material!.extensions = { VRMC_materials_mtoon: { specVersion: '1.0', ...toon } };
  } else {
    const half = 0.5 ** (1 / 2.2);
    const lit = factor ** (1 / 2.2);
    const properties = {
      name: 'skin',
      shader: 'VRM/MToon',
      ...{ floatProperties: {}, keywordMap: {}, tagMap: {} },
      vectorProperties: { _Color: [lit, lit, lit, 1], _ShadeColor: [half, half, half, 1] },
      textureProperties: { _MainTex: index, ...(shade !== 'none' && { _ShadeTexture: own }) },
    };
    json.extensionsUsed = ['VRM'];
    Object.assign(json, { extensions: { VRM: { materialProperties: [properties] } } });
  }
  return packGlb({ json, bin });
}

/** The texel of a texture of a file. */
function texelIn(bytes: Uint8Array, texture: number, at: readonly [number, number]): number[] {
  const { json, bin } = unpackGlb(bytes);
  const { byteOffset = 0, byteLength } =
    json.bufferViews![json.images![json.textures![texture]!.source!]!.bufferView!]!;
  return texel(bin.subarray(byteOffset, byteOffset + byteLength), at);
}

/** The textures of a toon material: in the light, and in the shade. */
function texturesOf(bytes: Uint8Array): { lit: number; shade: number | undefined } {
  const { json } = unpackGlb(bytes);
  const [material] = json.materials!;
  const toon = material!.extensions?.['VRMC_materials_mtoon'] as Toon | undefined;
  const { textureProperties: old } = (json.extensions?.['VRM'] as Vrm0 | undefined)?.materialProperties[0] ?? {};
  return {
    lit: material!.pbrMetallicRoughness!.baseColorTexture!.index,
    shade: toon ? toon.shadeMultiplyTexture?.index : old!['_ShadeTexture'],
  };
}

describe('a toon material of an avatar', () => {
  test('gets what it shows: no gloss, but relief and glow', async () => {
    for (const version of [0, 1] as const) {
      const { bytes } = await paint(avatar(version), whole);
      const { json } = unpackGlb(bytes);
      const [material] = json.materials!;
      assert.equal(material!.pbrMetallicRoughness!.metallicRoughnessTexture, undefined);
      assert.ok(material!.normalTexture && material!.emissiveTexture);
      if (version === 1) continue;
      const [{ textureProperties, vectorProperties }] = (json.extensions!['VRM'] as Vrm0).materialProperties as [
        Vrm0['materialProperties'][0],
      ];
      const { lit, shade } = texturesOf(bytes);
      assert.deepEqual(textureProperties, {
        _MainTex: lit,
        _ShadeTexture: shade,
        _BumpMap: material!.normalTexture.index,
        _EmissionMap: material!.emissiveTexture.index,
      });
      assert.equal(vectorProperties['_EmissionColor']!.length, 4);
    }
  });

  const red = lookOf([layer([200, 20, 20, 255])]);
  for (const version of [0, 1] as const)
    for (const shade of ['own', 'same', 'none'] as const)
      test(`of VRM ${version} has paint in the shade, too, where its texture is ${shade}`, async () => {
        writeFileSync('avatar.vrm', avatar(version, shade));
        writeFileSync('red.png', pngOf(picture(4, () => [200, 20, 20, 255])));
        await json('bake avatar.vrm --cage cage.glb --texture red.png -o out.vrm');
        for (const bytes of [(await paint(avatar(version, shade), red)).bytes, readFileSync('out.vrm')]) {
          const textures = texturesOf(bytes);
          assert.equal(textures.lit === textures.shade, shade === 'same');
          for (const one of [textures.lit, textures.shade!]) near(texelIn(bytes, one, kIsland), [200, 20, 20]);
          const before = shade === 'none' ? [255, 255, 255] : [100, 120, 200];
          near(texelIn(bytes, textures.shade!, kBeside), before, 0);
        }
      });

  test('darkens paint as its own two colours differ', async () => {
    for (const version of [0, 1] as const) {
      // Three.js shows paint · min(0.5 / 0.8, 1) in the shade, whose factor stays.
      const { bytes } = await paint(avatar(version, 'own', 0.8), red, { size: 96 });
      near(texelIn(bytes, texturesOf(bytes).lit, kIsland), [200, 20, 20]);
      near(
        texelIn(bytes, texturesOf(bytes).shade!, kIsland),
        [200, 20, 20].map((byte) => srgb(linear(byte) / 0.8)),
      );
      near(texelIn(bytes, texturesOf(bytes).shade!, kBeside), [100, 120, 200], 0);
      const same = await paint(avatar(version, 'same', 0.8), red, { size: 96 });
      assert.notEqual(texturesOf(same.bytes).lit, texturesOf(same.bytes).shade, 'they are not the same any more');
    }
  });

  test('has the base tint in the shade', async () => {
    const { bytes } = await paint(avatar(1, 'own'), lookOf([], { baseTint: '#808080' }));
    for (const one of [texturesOf(bytes).lit, texturesOf(bytes).shade!])
      near(
        texelIn(bytes, one, kIsland),
        [100, 120, 200].map((byte) => srgb(linear(byte) * linear(128))),
      );
  });

  test('is named where something moves its textures, and the paint with them', async () => {
    const moved: [version: 0 | 1, change: (json: GLTF.IGLTF) => void, reason: RegExp][] = [
      [
        1,
        ({ materials }) =>
          Object.assign(materials![0]!.extensions!['VRMC_materials_mtoon'] as Toon, {
            uvAnimationScrollXSpeedFactor: 0.1,
          }),
        /its UVs scroll or turn/,
      ],
      [
        1,
        (json) => {
          const happy = { textureTransformBinds: [{ material: 0, offset: [0.5, 0] }] };
          json.extensions = { VRMC_vrm: { expressions: { preset: { happy } } } };
        },
        /the expression "happy" moves its textures/,
      ],
      [
        0,
        ({ extensions }) => {
          (extensions!['VRM'] as Vrm0).materialProperties[0]!.floatProperties['_UvAnimRotation'] = 1;
        },
        /its UVs scroll or turn/,
      ],
      [
        0,
        (json) => {
          json.materials![0]!.name = 'skin';
          const materialValues = [{ materialName: 'skin', propertyName: '_MainTex_ST', targetValue: [1, 1, 0.5, 0] }];
          (json.extensions!['VRM'] as Vrm0).blendShapeMaster = {
            blendShapeGroups: [{ name: 'blush', materialValues }],
          };
        },
        /the expression "blush" moves its textures/,
      ],
    ];
    for (const [version, change, reason] of moved) {
      const glb = unpackGlb(avatar(version));
      change(glb.json);
      const { moving } = await paint(packGlb(glb), red);
      assert.equal(moving.length, 1);
      assert.match(moving[0]!.reason, reason);
      writeFileSync('moving.vrm', packGlb(glb));
      const lines = await ok('bake moving.vrm --cage cage.glb --look red.json -o out.vrm');
      assert.match(lines, new RegExp(`the paint moves on ".*": ${reason.source}`));
    }
    assert.deepEqual((await paint(avatar(1), red)).moving, []);
  });
});
