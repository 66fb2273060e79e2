// Looks on materials whose textures cannot hold all of them.
import assert from 'node:assert/strict';
import { before, describe, test } from 'node:test';
import { type Document, NodeIO } from '@gltf-transform/core';
import { ALL_EXTENSIONS, KHRMaterialsEmissiveStrength } from '@gltf-transform/extensions';
import { type PaintOptions, paintGlb } from 'cagecast/gltf';
import type { SavedLayer, SavedLayers } from 'cagecast/three';
import { PNG } from 'pngjs';
import { packGlb, unpackGlb, validate } from '../../support/gltf.js';
import { islandCage, texturedBox } from '../../support/models';
import { picture } from './reference.js';

const io = new NodeIO().registerExtensions(ALL_EXTENSIONS);
type Image = ReturnType<typeof picture>;
const pngOf = ({ width, height, data }: Image): Buffer =>
  PNG.sync.write(Object.assign(new PNG({ width, height }), { data: Buffer.from(data) }));
const urlOf = (...color: number[]) => `data:image/png;base64,${pngOf(picture(4, () => color)).toString('base64')}`;
const own = pngOf(picture(96, () => [100, 120, 200, 255]));

/** One red layer. */
const redWith = (style: Partial<SavedLayer>): SavedLayers => ({
  version: 1,
  layers: [
    {
      ...{ name: 'red', image: urlOf(255, 0, 0, 255), opacity: 1, tint: '#ffffff' },
      ...{ blend: 'normal', visible: true, region: null },
      ...style,
    },
  ],
  baseTint: '#808080',
});
/** As they lie in linear light. */
const kTint = ((128 / 255 + 0.055) / 1.055) ** 2.4;

let box: Uint8Array;
let cage: Uint8Array;
before(async () => {
  cage = (await islandCage(1)).buffer;
  box = (await texturedBox(own)).buffer;
});

const paint = (bytes: Uint8Array, look: SavedLayers, more: Partial<PaintOptions> = {}) =>
  paintGlb(bytes, { cage, look, ...more });
const decode: PaintOptions['decode'] = async (bytes) => {
  if (Buffer.from(bytes).equals(own)) throw new Error('is no such image');
  const { width, height, data } = PNG.sync.read(Buffer.from(bytes));
  return { width, height, data };
};
const read = async (bytes: Uint8Array): Promise<Document> => io.readBinary(bytes);
/** The box with something else in it. */
async function boxWith(change: (document: Document) => void): Promise<Uint8Array> {
  const document = await read(box);
  change(document);
  return io.writeBinary(document);
}
/** With colours of its vertices. */
const colored = () =>
  boxWith((document) => {
    const [primitive] = document.getRoot().listMeshes()[0]!.listPrimitives();
    const count = primitive!.getAttribute('POSITION')!.getCount();
    const colors = document
      .createAccessor()
      .setType('VEC3')
      .setArray(new Float32Array(3 * count).fill(0.5));
    primitive!.setAttribute('COLOR_0', colors.setBuffer(document.getRoot().listBuffers()[0]!));
  });
/** The materials of what is drawn: what is left of the surface, its copy and the overlay. */
async function shownBy(bytes: Uint8Array) {
  assert.deepEqual(
    (await validate(bytes)).filter((line) => !/COLOR_0/.test(line)),
    [],
  );
  const primitives = (await read(bytes)).getRoot().listMeshes()[0]!.listPrimitives();
  return primitives.map((primitive) => primitive.getMaterial()!);
}

describe('colours that no texture can hold lie in an overlay', () => {
  for (const [what, model, more] of [
    ['a texture that cannot be read', () => box, { decode }],
    ['colours of vertices', colored, {}],
  ] as const)
    test(`beside the channels that are baked: ${what}`, async () => {
      const { bytes, left } = await paint(await model(), redWith({ roughness: 0.2 }), more);
      assert.equal(left.length, 1);
      const [before, copy, overlay] = await shownBy(bytes);
      assert.ok(overlay, 'there is an overlay');
      assert.deepEqual(
        copy!.getBaseColorFactor().map((x) => x.toFixed(4)),
        [kTint, kTint, kTint, 1].map((x) => x.toFixed(4)),
      );
      assert.deepEqual(before!.getBaseColorFactor(), [1, 1, 1, 1]);
      for (const one of [before!, copy!, overlay]) {
        assert.ok(one.getMetallicRoughnessTexture());
        assert.deepEqual([one.getRoughnessFactor(), one.getMetallicFactor()], [1, 1]);
      }
    });

  test('without what lies beneath them where the material has variants, which is said', async () => {
    const { json, bin } = unpackGlb(await colored());
    json.extensionsUsed = ['KHR_materials_variants'];
    json.extensions = { KHR_materials_variants: { variants: [{ name: 'other' }] } };
    const mappings = [{ material: 0, variants: [0] }];
    json.meshes![0]!.primitives[0]!.extensions = { KHR_materials_variants: { mappings } };
    const { left } = await paint(packGlb({ json, bin }), redWith({}));
    assert.deepEqual(
      left.map(({ reason }) => reason),
      [
        'its vertices have colours',
        'its material has variants: neither the base tint nor what lies beneath the colours is shown',
      ],
    );
    const plain = await paint(packGlb({ json, bin }), { ...redWith({}), baseTint: '#ffffff' });
    assert.equal(plain.left.length, 1);
  });

  test('with the shade of a toon material, which is tinted once', async () => {
    const { json, bin } = unpackGlb(await colored());
    json.extensionsUsed = ['VRMC_vrm', 'VRMC_materials_mtoon'];
    json.materials![0]!.extensions = {
      VRMC_materials_mtoon: { specVersion: '1.0', shadeColorFactor: [0.5, 0.5, 0.5] },
    };
    const { bytes } = await paint(packGlb({ json, bin }), redWith({ emissive: 1 }));
    const painted = unpackGlb(bytes).json;
    const primitives = painted.meshes![0]!.primitives;
    assert.equal(primitives.length, 3);
    const [toon, copy] = primitives.slice(0, 2).map(
      ({ material }) =>
        painted.materials![material!]!.extensions!['VRMC_materials_mtoon'] as {
          shadeColorFactor: number[];
          shadeMultiplyTexture?: object;
        },
    );
    assert.equal(toon!.shadeMultiplyTexture, undefined);
    assert.equal(copy!.shadeMultiplyTexture, undefined);
    assert.ok(Math.abs(copy!.shadeColorFactor[0]! - 0.5 * kTint) < 1e-4);
    assert.ok(painted.materials![primitives[1]!.material!]!.emissiveTexture);
  });
});

/** The box without a texture, so that all of a look is on a copy of its surface. */
const bare = (change: (document: Document) => void) =>
  boxWith((document) => {
    document.getRoot().listMaterials()[0]!.setBaseColorTexture(null);
    change(document);
  });

describe('a copy of a surface', () => {
  test('glows as the material does where no layer glows', async () => {
    const model = await bare((document) => {
      const strength = document.createExtension(KHRMaterialsEmissiveStrength).createEmissiveStrength();
      const [material] = document.getRoot().listMaterials();
      material!.setEmissiveFactor([0.1, 0.1, 0.1]);
      material!.setExtension('KHR_materials_emissive_strength', strength.setEmissiveStrength(5));
    });
    const [, copy] = await shownBy((await paint(model, redWith({ emissive: 0.2 }))).bytes);
    assert.deepEqual(copy!.getEmissiveFactor(), [1, 1, 1]);
    assert.equal(copy!.getExtension('KHR_materials_emissive_strength'), null, 'its strength is in the texture');
  });

  test('has no tangents in its morph targets where it has none itself', async () => {
    const model = await bare((document) => {
      const [buffer] = document.getRoot().listBuffers();
      const [primitive] = document.getRoot().listMeshes()[0]!.listPrimitives();
      const count = primitive!.getAttribute('POSITION')!.getCount();
      const numbers = (type: 'VEC3' | 'VEC4', array: Float32Array) =>
        document.createAccessor().setType(type).setArray(array).setBuffer(buffer!);
      const tangents = new Float32Array(4 * count).map((_, i) => (i % 4 === 0 || i % 4 === 3 ? 1 : 0));
      primitive!.setAttribute('TANGENT', numbers('VEC4', tangents));
      const target = document.createPrimitiveTarget();
      target.setAttribute('POSITION', numbers('VEC3', new Float32Array(3 * count).fill(0.1)));
      target.setAttribute('TANGENT', numbers('VEC3', new Float32Array(3 * count)));
      primitive!.addTarget(target);
      document.getRoot().listMeshes()[0]!.setWeights([0]);
    });
    const before = await validate(model);
    const { bytes } = await paint(model, redWith({ normal: urlOf(200, 128, 230, 255) }));
    assert.deepEqual(
      (await validate(bytes)).filter((line) => !before.includes(line)),
      [],
    );
    const [, copy] = unpackGlb(bytes).json.meshes![0]!.primitives;
    assert.deepEqual(Object.keys(copy!.targets![0]!), ['POSITION']);
  });
});
