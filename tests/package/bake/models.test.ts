// Baking into the textures of models: of documents, and of files by the command.
import assert from 'node:assert/strict';
import { readFileSync, writeFileSync } from 'node:fs';
import { createRequire } from 'node:module';
import { before, describe, test } from 'node:test';
import { Document, type GLTF, type Material, NodeIO, TextureInfo } from '@gltf-transform/core';
import { ALL_EXTENSIONS, KHRMaterialsTransmission, KHRMaterialsVariants } from '@gltf-transform/extensions';
import { init } from 'cagecast';
import type { Image } from 'cagecast/engines';
import { type BakeReport, bake, cagecast, type ImageCodec } from 'cagecast/gltf';
import { PNG } from 'pngjs';
import { fails, ok } from '../../support/command.js';
import { isOverlay, packGlb, primitivesOf, unpackGlb, validate } from '../../support/gltf.js';
import { ktx2Of } from '../../support/ktx2';
import { islandAt, islandCage, texturedBox } from '../../support/models';
import { temporaryFolder } from '../../support/temporary.js';
import { picture } from './reference.js';

const { folder } = temporaryFolder('bake');
const io = new NodeIO().registerExtensions(ALL_EXTENSIONS);
const size = 96;
const margin = Math.ceil(size / 64) + 2;

const pngOf = ({ width, height, data }: Image): Uint8Array<ArrayBuffer> =>
  new Uint8Array(PNG.sync.write(Object.assign(new PNG({ width, height }), { data: Buffer.from(data) })));
const own = picture(size, (x, y) => [10, 20, 200, (x * 7 + y * 3) % 256]);
const plain = (...color: number[]) => picture(4, () => color);
const red = plain(230, 30, 40, 255);
const images: ImageCodec = {
  decode: async (bytes) => PNG.sync.read(Buffer.from(bytes)),
  encode: async (image) => pngOf(image),
};

before(async () => {
  await init();
  process.chdir(folder); // so that commands are short
  writeFileSync('cage.glb', (await islandCage(1)).buffer);
  writeFileSync('box.glb', (await texturedBox(Buffer.from(pngOf(own)))).buffer);
  for (const [name, image] of Object.entries({ red, lean: plain(204, 128, 230, 255), rough: plain(255, 60, 90, 255) }))
    writeFileSync(`${name}.png`, pngOf(image));
});

const texel = ({ data, width }: Image, x: number, y: number) => [
  ...data.subarray(4 * (y * width + x), 4 * (y * width + x) + 4),
];
/** The middle of an island that is painted, and a place beside all of them. */
const [kIsland, kBeside] = [
  [16, 24],
  [90, 2],
] as const;
const imageOf = (texture: { getImage(): Uint8Array | null } | null): Image =>
  PNG.sync.read(Buffer.from(texture!.getImage()!));
const pngIn = (path: string): Image => PNG.sync.read(readFileSync(path));
const materialsOf = (document: Document): Material[] => document.getRoot().listMaterials();
const colorsOf = (document: Document): Image => imageOf(materialsOf(document)[0]!.getBaseColorTexture());
const box = () => io.read('box.glb');
const primitiveOf = (document: Document) => document.getRoot().listMeshes()[0]!.listPrimitives()[0]!;
const accessor = (
  document: Document,
  type: 'VEC2' | 'VEC3' | 'VEC4' | 'SCALAR',
  array: Float32Array | Uint8Array | Uint16Array,
) => document.createAccessor().setType(type).setArray(array).setBuffer(document.getRoot().listBuffers()[0]!);
const textureOf = (document: Document, image: Image, name = '') =>
  document.createTexture(name).setMimeType('image/png').setImage(pngOf(image));

/** Asserts that the islands of a box are red, and all else is as before. */
function assertPainted(image: Image): void {
  const counts = [0, 0];
  for (let y = 0; y < size; ++y)
    for (let x = 0; x < size; ++x) {
      const before = texel(own, x, y);
      const island = islandAt(x, y, size, margin);
      if (island >= 0) ++counts[island]!;
      if (island < 0) continue;
      assert.deepEqual(texel(image, x, y), island === 1 ? [230, 30, 40, before[3]] : before, `${x}, ${y}`);
    }
  assert.ok(Math.min(...counts) > 1000, String(counts));
}

/** Bakes into a document. */
async function baked(document: Document, more: Partial<Parameters<typeof bake>[0]> = {}): Promise<BakeReport> {
  let report: BakeReport | undefined;
  const onBaked = (found: BakeReport) => void (report = found);
  await document.transform(bake({ cage: await io.read('cage.glb'), paints: { color: red }, images, onBaked, ...more }));
  return report!;
}

/** Bakes into a document, and into its file by the command. @returns what both have become, and what they say. */
async function both(document: Document, more: Partial<Parameters<typeof bake>[0]> = {}, flags = '--texture red.png') {
  writeFileSync('model.glb', await io.writeBinary(document));
  const report = await baked(document, more);
  const stdout = await ok(`bake model.glb --cage cage.glb ${flags} -o out.glb`);
  assert.deepEqual(await validate('out.glb'), []);
  return { documents: [document, await io.read('out.glb')], report, stdout };
}

/** A file whose JSON is changed. */
function changed(path: string, change: (json: GLTF.IGLTF) => void): void {
  const { json, bin } = unpackGlb(readFileSync('box.glb'));
  change(json);
  writeFileSync(path, packGlb({ json, bin }));
}

describe('documents and files', () => {
  test('the texture is painted in place, and nothing else changes; UVs may be moved by the material', async () => {
    for (const moved of [false, true]) {
      const document = await io.readBinary(
        new Uint8Array((await texturedBox(Buffer.from(pngOf(own)), { moved })).buffer),
      );
      const accessors = () =>
        document
          .getRoot()
          .listAccessors()
          .map((one) => one.getArray());
      const arrays = accessors();
      const { documents, report } = await both(document);
      assert.deepEqual(accessors(), arrays);
      for (const one of documents) {
        assert.equal(one.getRoot().listTextures().length, 1);
        assertPainted(colorsOf(one));
      }
      assert.deepEqual(report.left, []);
      assert.deepEqual(
        report.textures.map(({ slot, parts, width }) => [slot, parts, width]),
        [['color', ['box'], size]],
      );
      // Of the file, only where bytes lie has changed.
      const jsonOf = (path: string) => {
        const { bufferViews: _, buffers: __, ...rest } = unpackGlb(readFileSync(path)).json;
        return JSON.parse(JSON.stringify(rest, (key, value) => (key === 'bufferView' ? undefined : value)));
      };
      assert.deepEqual(jsonOf('out.glb'), jsonOf('model.glb'));
    }
  });

  test('the occlusion of a model stays beside that of the paint: none, in its metallic-roughness texture, in one of its own', async () => {
    const apart = picture(size, (_, y) => [y, 0, 0, 255]);
    const paint = plain(200, 60, 90, 255);
    writeFileSync('orm.png', pngOf(paint));
    for (const occlusion of ['none', 'packed', 'apart']) {
      const document = await box();
      const rough = textureOf(
        document,
        picture(size, (x) => [x, 100, 50, 255]),
      );
      const shown = occlusion === 'none' ? null : occlusion === 'packed' ? rough : textureOf(document, apart);
      materialsOf(document)[0]!.setMetallicRoughnessTexture(rough).setOcclusionTexture(shown).setOcclusionStrength(0.5);
      const { documents } = await both(document, { paints: { orm: paint } }, '--map orm=orm.png');
      for (const [material] of documents.map(materialsOf)) {
        const image = imageOf(material!.getMetallicRoughnessTexture());
        assert.deepEqual(texel(image, ...kIsland), [200, 60, 90, 255], occlusion);
        assert.deepEqual(texel(image, ...kBeside), [occlusion === 'none' ? 255 : 90, 100, 0, 255], occlusion);
        const dark = imageOf(material!.getOcclusionTexture());
        assert.deepEqual([...dark.data], [...(occlusion === 'apart' ? apart : image).data], occlusion);
        if (occlusion !== 'none') assert.equal(material!.getOcclusionStrength(), 0.5);
      }
    }
  });

  test('an overlay of an earlier transfer is taken away', async () => {
    const document = await box();
    await document.transform(cagecast({ cage: await io.read('cage.glb'), texture: pngOf(red) }));
    const overlaysOf = (one: Document) => primitivesOf(one).filter(isOverlay);
    assert.equal(overlaysOf(document).length, 1);
    const { documents, stdout } = await both(document);
    assert.match(stdout, /\ntook away 1 overlay of an earlier transfer$/m);
    for (const one of documents) {
      assert.equal(overlaysOf(one).length, 0);
      assert.deepEqual([materialsOf(one).length, one.getRoot().listTextures().length], [1, 1]);
      assertPainted(colorsOf(one));
    }
  });

  test('materials of variants are painted as well, or it says why not', async () => {
    const document = await box();
    const variants = document.createExtension(KHRMaterialsVariants);
    const list = variants.createMappingList();
    for (const [name, texture] of [
      ['night', textureOf(document, own, 'night')],
      ['glossy', materialsOf(document)[0]!.getBaseColorTexture()],
      ['plain', null],
    ] as const) {
      const material = document.createMaterial(name).setBaseColorTexture(texture).setRoughnessFactor(0);
      list.addMapping(variants.createMapping().setMaterial(material).addVariant(variants.createVariant(name)));
    }
    primitiveOf(document).setExtension('KHR_materials_variants', list);
    const { documents, report, stdout } = await both(document);
    for (const one of documents) {
      const [first, night, glossy, bare] = materialsOf(one).map((material) => material.getBaseColorTexture());
      for (const texture of [first!, night!]) assertPainted(imageOf(texture));
      assert.deepEqual([glossy === first, bare, one.getRoot().listTextures().length], [true, null, 2]);
    }
    const reason = 'its material has no texture';
    assert.deepEqual(report.left, [{ part: 'box', material: 'plain', reason }]);
    assert.deepEqual(
      report.textures.map(({ parts, overlap }) => [parts, overlap.texels < 0.001]),
      [
        [['box'], true],
        [['box'], true],
      ],
    );
    assert.ok(stdout.includes(`not painted: "box", with "plain" of its variants: ${reason}`), stdout);
    // The reason of its own material comes first, and that of a variant names it.
    const palette = /: nothing can be baked: "box": its texture is a palette, or too small for/;
    await fails(1, palette, 'bake model.glb --cage cage.glb --texture red.png --size 1 -o small.glb');
  });

  test('vertex colours hinder the paint unless all of them are white', async () => {
    const vertices = primitiveOf(await box())
      .getAttribute('POSITION')!
      .getCount();
    const coloured = async (type: 'VEC3' | 'VEC4', colors: Float32Array | Uint8Array) => {
      const document = await box();
      const isNormalized = colors instanceof Uint8Array;
      primitiveOf(document).setAttribute('COLOR_0', accessor(document, type, colors).setNormalized(isNormalized));
      return document;
    };
    for (const white of [
      await coloured(
        'VEC4',
        new Uint8Array(4 * vertices).map((_, i) => (i % 4 === 3 ? 128 : 255)),
      ),
      await coloured('VEC3', new Float32Array(3 * vertices).fill(1)),
    ]) {
      const { documents, report } = await both(white);
      assert.deepEqual(report.left, []);
      for (const one of documents) assertPainted(colorsOf(one));
    }
    const tinted = await coloured('VEC3', new Float32Array(3 * vertices).fill(1).fill(0.5, 7, 8));
    writeFileSync('model.glb', await io.writeBinary(tinted));
    const reason = 'its vertices have colours';
    assert.deepEqual((await baked(tinted)).left, [{ part: 'box', reason }]);
    await fails(
      1,
      `model.glb: nothing can be baked: "box": ${reason}`,
      'bake model.glb --cage cage.glb --texture red.png -o out.glb',
    );
  });

  test('masks by images and by colours keep paint away, and bring it back', async () => {
    // The left third is white: the islands 0 and 3.
    const left = picture(96, (x) => (x < 32 ? [255, 255, 255, 255] : [0, 0, 0, 255]));
    writeFileSync('left.png', pngOf(left));
    writeFileSync('all.png', pngOf(plain(255, 255, 255, 255)));
    const islands = (image: Image) =>
      [16, 48, 80].flatMap((x) => [24, 72].map((y) => Number(texel(image, x, y)[0] === 230))).join('');
    const command = async (flags: string) => {
      await ok(`bake box.glb --cage cage.glb --texture red.png${flags} -o masked.png`);
      return islands(pngIn('masked.png'));
    };
    assert.equal(await command(''), '111111');
    assert.equal(await command(' --mask never=left.png'), '001111');
    assert.equal(await command(' --mask always=left.png --exclude box'), '110000');
    assert.equal(await command(' --mask always=all.png --mask never=left.png'), '001111');
    const document = await box();
    await baked(document, { maskImages: { never: left } });
    assert.equal(islands(colorsOf(document)), '001111');

    const colored = await box();
    const uvs = primitiveOf(colored).getAttribute('TEXCOORD_0')!;
    const colors = Float32Array.from({ length: 3 * uvs.getCount() }, (_, i) =>
      uvs.getElement(Math.floor(i / 3), [])[0]! < 1 / 3 && i % 3 > 0 ? 0 : 1,
    );
    primitiveOf(colored).setAttribute('_MASK', accessor(colored, 'VEC3', colors));
    let painted = 0;
    const onResult = ({ zones }: { zones: Uint8Array }) => void (painted = zones.filter((zone) => zone === 0).length);
    await colored.transform(cagecast({ cage: await io.read('cage.glb'), maskColors: '_MASK', onResult }));
    assert.equal(painted, (uvs.getCount() * 4) / 6);
    const none = /box\.glb: no part has COLOR_0 of 3 or 4 numbers/;
    await fails(1, none, 'bake box.glb --cage cage.glb --texture red.png --mask colors=COLOR_0 -o none.png');
  });

  test('a texture that is used in another way, too, stays; the paint gets one of its own', async () => {
    const document = await box();
    const [texture] = document.getRoot().listTextures();
    materialsOf(document)[0]!.setEmissiveTexture(texture!).setBaseColorFactor([1, 0.5, 1, 1]);
    for (const [material] of (await both(document)).documents.map(materialsOf)) {
      assert.deepEqual([...imageOf(material!.getEmissiveTexture()).data], [...own.data]);
      const painted = imageOf(material!.getBaseColorTexture());
      assert.deepEqual(texel(painted, ...kIsland).slice(0, 3), [230, 30, 40]);
      assert.ok(texel(painted, 0, 0)[1]! < texel(own, 0, 0)[1]!, 'the factor is in the texture');
      assert.deepEqual(material!.getBaseColorFactor(), [1, 1, 1, 1]);
    }
    // So does an ORM texture that an extension reads.
    const glass = await box();
    const shared = textureOf(
      glass,
      picture(size, () => [0, 180, 0, 255]),
    );
    const transmission = glass.createExtension(KHRMaterialsTransmission).createTransmission();
    transmission.setTransmissionFactor(1).setTransmissionTexture(shared);
    const [material] = materialsOf(glass);
    material!.setMetallicRoughnessTexture(shared).setExtension('KHR_materials_transmission', transmission);
    const rough = { paints: { orm: plain(255, 60, 90, 255) } };
    for (const [one] of (await both(glass, rough, '--map orm=rough.png')).documents.map(materialsOf)) {
      const after = one!.getExtension<typeof transmission>('KHR_materials_transmission')!;
      assert.deepEqual(texel(imageOf(after.getTransmissionTexture()), 0, 0), [0, 180, 0, 255]);
      assert.deepEqual(texel(imageOf(one!.getMetallicRoughnessTexture()), ...kIsland), [255, 60, 90, 255]);
    }
  });

  test('maps of normals and of roughness are added to materials that lack them, flat beside the paint', async () => {
    const paints = { normal: plain(204, 128, 230, 255), orm: plain(255, 60, 90, 255) };
    const flags = `--map normal=lean.png --map orm=rough.png --size ${size}`;
    const near = (a: number[], b: number[]) =>
      assert.ok(
        a.every((value, k) => Math.abs(value - b[k]!) <= 2),
        String(a),
      );
    for (const [material] of (await both(await box(), { paints, size }, flags)).documents.map(materialsOf)) {
      const [normal, rough] = [material!.getNormalTexture(), material!.getMetallicRoughnessTexture()].map(imageOf);
      near(texel(normal!, ...kIsland), [204, 128, 230, 255]);
      near(texel(normal!, ...kBeside), [128, 128, 255, 255]);
      near(texel(rough!, ...kIsland), [255, 60, 90, 255]);
      near(texel(rough!, ...kBeside), [255, 255, 0, 255]);
      assert.deepEqual([material!.getRoughnessFactor(), material!.getMetallicFactor()], [1, 1]);
      assert.deepEqual([...imageOf(material!.getBaseColorTexture()).data], [...own.data], 'colours stay');
      assert.equal(material!.getOcclusionTexture(), material!.getMetallicRoughnessTexture());
    }
  });
});

describe('documents', () => {
  test('two primitives with images of their own are painted each in its own; what cannot hold paint is reported', async () => {
    const document = await box();
    const [mesh] = document.getRoot().listMeshes();
    const first = primitiveOf(document);
    const all = [...first.getIndices()!.getArray()!];
    const [second, bare] = ['second', 'bare'].map((name) => document.createMaterial(name));
    second!.setBaseColorTexture(textureOf(document, own, 'other'));
    const third = all.length / 3;
    [first, ...[second, bare].map((material) => first.clone().setMaterial(material!))].forEach((primitive, p) => {
      const corners = Uint16Array.from(all.slice(p * third, (p + 1) * third));
      primitive.setIndices(accessor(document, 'SCALAR', corners));
      if (p > 0) mesh!.addPrimitive(primitive);
    });
    const report = await baked(document);
    assert.deepEqual(
      report.textures.map(({ parts }) => parts),
      [['box/own'], ['box/second']],
    );
    assert.deepEqual(report.left, [{ part: 'box/bare', reason: 'its material has no texture' }]);
    // Islands 0 and 1 are of the first primitive, 2 and 3 of the second.
    const isRed = (material: Material, x: number) => texel(imageOf(material.getBaseColorTexture()), x, 24)[0] === 230;
    const [own1, own2] = [materialsOf(document)[0]!, second!].map((material) => [
      isRed(material, 16),
      isRed(material, 80),
    ]);
    assert.deepEqual(
      [own1, own2],
      [
        [true, false],
        [false, true],
      ],
    );

    const overlaid = await box();
    materialsOf(overlaid)[0]!.setBaseColorTexture(null);
    const without = await baked(overlaid, { texture: pngOf(red) });
    assert.equal(without.textures.length, 0);
    assert.equal(
      overlaid.getRoot().listMeshes()[0]!.listPrimitives().length,
      2,
      'what cannot be baked gets an overlay',
    );
  });

  test('triangles without area are nothing to paint, whatever their number; surfaces without area in UVs are a palette', async () => {
    const document = await box();
    const indices = primitiveOf(document).getIndices()!;
    const all = [...indices.getArray()!];
    indices.setArray(Uint16Array.from([...all, ...all.flatMap((v) => [v, v, v])]));
    const { textures, left } = await baked(document);
    assert.deepEqual([textures.length, left], [1, []]);
    assertPainted(colorsOf(document));
    const palette = await box();
    const uvs = primitiveOf(palette).getAttribute('TEXCOORD_0')!;
    uvs.setArray(new Float32Array(2 * uvs.getCount()).fill(0.4));
    assert.match((await baked(palette)).left[0]!.reason, /is a palette/);
  });

  test('what is wrong with the arguments or the codec is an error, and the document is unchanged', async () => {
    const document = await box();
    const before = await io.writeBinary(document);
    let encoded = 0;
    const encode = async (image: Image) => {
      if (++encoded === 2) throw new Error('the disk is full');
      return pngOf(image);
    };
    const decode = async (bytes: Uint8Array) => {
      const { width, height, data } = PNG.sync.read(Buffer.from(bytes));
      return { width, height, data: data.filter((_, i) => i % 4 !== 3) };
    };
    const paints = /^CagecastError: bake: paints is of type Object, not { color, normal, orm }/;
    const sizes = [0, -5, 0.5, Number.NaN, 99999, null, '64'].map((wrong): [object, RegExp] => [
      { size: wrong },
      /^CagecastError: bake: size is .+, not a whole number of texels from 1 to 8192$/,
    ]);
    const cases: [object, RegExp][] = [
      [{ paints: { color: red, normal: red }, images: { ...images, encode } }, /the disk is full/],
      [
        { images: { ...images, decode } },
        /^CagecastError: bake: images\.decode\(…\)\.data has 27648 bytes, not 4 for each of 96 × 96 pixels/,
      ],
      [{ paints: {} }, paints],
      [{ paints: { color: red, norml: red } }, paints],
      [{ images: undefined }, /bake: images is undefined, not/],
      ...sizes,
    ];
    for (const [given, message] of cases) {
      await assert.rejects(async () => baked(document, given), message);
      assert.deepEqual(await io.writeBinary(document), before);
    }
    assert.equal(encoded, 2);
  });
});

describe('cagecast bake', () => {
  test('a PNG has the paint alone; the way back has it in the cage’s UVs', async () => {
    await ok('bake box.glb --cage cage.glb --texture red.png -o paint.png');
    await ok('bake box.glb --cage cage.glb --texture red.png -o painted.glb');
    await ok(`bake painted.glb --cage cage.glb --back --size ${size} -o back.png`);
    const [paint, back] = [pngIn('paint.png'), pngIn('back.png')];
    assert.deepEqual([paint.width, back.width], [size, size]);
    for (let y = 0; y < size; ++y)
      for (let x = 0; x < size; ++x) {
        if (islandAt(x, y, size, 0) === 1) {
          assert.deepEqual(texel(paint, x, y), [230, 30, 40, 255]);
          // The alpha of the model's texture is its own.
          if (texel(back, x, y)[3]! > 16) assert.deepEqual(texel(back, x, y).slice(0, 3), [230, 30, 40], `${x}, ${y}`);
        }
        if (islandAt(x, y, size, margin) === 0)
          for (const image of [paint, back]) assert.equal(texel(image, x, y)[3], 0, `${x}, ${y}`);
      }
  });

  test('--part takes a node that holds others for all below it, unless a part has its name', async () => {
    changed('held.glb', ({ nodes = [], scenes = [] }) => {
      const holding = (name: string, ...children: number[]) => nodes.push({ name, children }) - 1;
      const far = nodes.push({ name: 'far', mesh: 0, translation: [9, 0, 0] }) - 1;
      scenes[0]!.nodes = [holding('Near', 0), holding('Away', holding('box', far))];
    });
    const line = 'bake held.glb --cage cage.glb --texture red.png -o part.png --part';
    for (const part of ['Ne*', 'box']) assert.match(await ok(line, part), /part\.png: 96 × 96, for "box"$/m, part);
    await fails(1, /held\.glb: nothing of it may be painted\n$/, line, 'Away');
    await fails(1, /--part Nose: nothing has this name; there are: box, /, line, 'Nose');
  });

  test('what follows the end of a PNG is not part of it, as in viewers', async () => {
    const padded = (image: Image) => Buffer.concat([pngOf(image), Buffer.alloc(3)]);
    writeFileSync('padded.glb', (await texturedBox(padded(own))).buffer);
    writeFileSync('padded.png', padded(red));
    await ok('bake padded.glb --cage cage.glb --texture padded.png -o out.glb');
    assertPainted(colorsOf(await io.read('out.glb')));
  });

  test('an image keeps its name and what applications know of it; what is optional in a file stays so', async () => {
    changed('named.glb', (json) => {
      const [{ bufferView: _, ...image }] = json.images as [GLTF.IImage];
      json.images = [{ mimeType: image.mimeType!, uri: 'skin.png', extras: { licence: 'own' } }];
    });
    writeFileSync('skin.png', pngOf(own));
    await ok('bake named.glb --cage cage.glb --texture red.png -o out.glb');
    const [image] = unpackGlb(readFileSync('out.glb')).json.images!;
    assert.deepEqual([image!.name, image!.extras], ['skin', { licence: 'own' }]);

    changed('optional.glb', (json) => {
      // A second texture, which is not painted, has another image for viewers that know it.
      const source = json.images!.push({ ...json.images![0]! }) - 1;
      json.textures!.push({ source: 0, extensions: { EXT_texture_webp: { source } } });
      json.materials!.push({ name: 'eye', pbrMetallicRoughness: { baseColorTexture: { index: 1 } } });
      // Some writers have null for what a material does not have.
      json.materials!.push({ extensions: { KHR_materials_clearcoat: null } } as object, { extensions: null } as object);
      json.extensionsUsed = ['EXT_texture_webp'];
    });
    await ok('bake optional.glb --cage cage.glb --texture red.png -o out.glb');
    const { extensionsUsed, extensionsRequired } = unpackGlb(readFileSync('out.glb')).json;
    assert.deepEqual([extensionsUsed, extensionsRequired], [['EXT_texture_webp'], undefined]);
  });

  test('avatars show the paint where their own materials name the texture, even if others go on using it', async () => {
    const vectors = { _ShadeColor: [0, 0, 0, 1] };
    changed('avatar.glb', (json) => {
      const [material] = json.materials!;
      const { baseColorTexture } = material!.pbrMetallicRoughness!;
      const { index } = baseColorTexture!;
      material!.emissiveTexture = { index }; // so it is not painted in its place
      material!.extensions = { VRMC_materials_mtoon: { specVersion: '1.0', shadeMultiplyTexture: { index } } };
      material!.pbrMetallicRoughness!.baseColorFactor = [0.5, 0.25, 0.5, 1];
      const textureProperties = { _MainTex: index, _ShadeTexture: index };
      const vectorProperties = { _Color: [0.5, 0.25, 0.5, 1], ...vectors };
      json.extensions = { VRM: { materialProperties: [{ textureProperties, vectorProperties }] } };
      json.extensionsUsed = ['VRM', 'VRMC_materials_mtoon'];
    });
    await ok('bake avatar.glb --cage cage.glb --texture red.png -o out.vrm');
    const { json } = unpackGlb(readFileSync('out.vrm'));
    const [painted] = json.materials!;
    const now = painted!.pbrMetallicRoughness!.baseColorTexture!.index;
    assert.notEqual(now, painted!.emissiveTexture!.index);
    assert.deepEqual(json.extensions!['VRM'], {
      materialProperties: [
        {
          textureProperties: { _MainTex: now, _ShadeTexture: now },
          vectorProperties: { _Color: [1, 1, 1, 1], ...vectors }, // the factor is in the texture
        },
      ],
    });
    const mtoon = painted!.extensions!['VRMC_materials_mtoon'] as { shadeMultiplyTexture: { index: number } };
    const shade = mtoon.shadeMultiplyTexture.index;
    assert.ok(shade !== now && shade !== painted!.emissiveTexture!.index, 'without the factor of what is in the light');
  });

  test('overlapping UVs are reported', async () => {
    writeFileSync('mirrored.glb', (await texturedBox(Buffer.from(pngOf(own)), { mirrored: true })).buffer);
    const overlap =
      /UVs overlap: \d+\.\d % of its texels are claimed twice, \d+\.\d % of the paint found no room \("box"\)/;
    assert.match(await ok('bake mirrored.glb --cage cage.glb --texture red.png -o out.glb'), overlap);
  });

  test('another size keeps the colours under an alpha of 0, and the longer side is as long as asked', async () => {
    const data = picture(64, (x) => [10 + x, 20, 200, 0]).data.subarray(0, 4 * 32 * 64);
    writeFileSync('clear.glb', (await texturedBox(Buffer.from(pngOf({ width: 32, height: 64, data })))).buffer);
    await ok('bake clear.glb --cage cage.glb --texture red.png --size 32 -o out.glb');
    const image = colorsOf(await io.read('out.glb'));
    assert.deepEqual([image.width, image.height], [16, 32]);
    assert.ok(
      image.data.every((byte, i) => i % 4 !== 2 || byte >= 40),
      'none is black',
    );
    assert.match(
      await ok('bake clear.glb --cage cage.glb --texture red.png --size 32 -o clear.png'),
      /: 16 × 32, for /,
    );
    // Of a texture that cannot be read, nothing is needed.
    changed('packed.glb', (json) => {
      const uri = `data:image/ktx2;base64,${Buffer.from(ktx2Of(1, 2, 3)).toString('base64')}`;
      json.images = [{ uri }];
    });
    assert.match(
      await ok('bake packed.glb --cage cage.glb --texture red.png --size 32 -o packed.png'),
      /: 32 × 32, for /,
    );
    const unreadable = /packed\.glb: its texture is a KTX2 image, which cannot be baked/;
    await fails(1, unreadable, 'bake packed.glb --cage cage.glb --texture red.png -o packed.png');
    // The way back shows what an opaque material does.
    await ok('bake clear.glb --cage cage.glb --back -o back.png');
    assert.ok(pngIn('back.png').data.some((byte, i) => i % 4 === 3 && byte === 255));
  });

  test('no file that was read is overwritten, whoever names it', async () => {
    changed('named.glb', (json) => (json.images = [{ uri: 'skin.png' }]));
    writeFileSync('mask.png', pngOf(plain(0, 0, 0, 255)));
    writeFileSync('own.json', '{ "neverMask": "mask.png" }');
    writeFileSync('skin.png', pngOf(own));
    const settings = 'bake box.glb --cage cage.glb --texture red.png --config own.json';
    assert.match(await ok(`${settings} -o out.glb`), /\nsettings from .*own\.json\n$/);
    const refused = /^cagecast: .*\.png would overwrite .*\.png, which this command reads/;
    for (const [line, path] of [
      ['bake named.glb --cage cage.glb --texture red.png', 'skin.png'],
      [settings, 'mask.png'],
    ] as const) {
      const before = readFileSync(path);
      await fails(2, refused, `${line} -o ${path}`);
      assert.deepEqual(readFileSync(path), before);
    }
  });

  test('what cannot be baked is one line that names the file', async () => {
    const bare = await box();
    primitiveOf(bare).setAttribute('TEXCOORD_0', null);
    writeFileSync('bare.glb', await io.writeBinary(bare));
    writeFileSync('short.png', pngOf(red).subarray(0, 40));
    writeFileSync('text.png', 'no picture');
    // Numbers of what is not there.
    changed('texture.glb', ({ materials }) => (materials![0]!.pbrMetallicRoughness!.baseColorTexture!.index = 7));
    changed('image.glb', ({ textures }) => (textures![0]!.source = 5));
    const nothing = 'nothing can be baked: "box": it';
    const whole = 'bake box.glb --cage cage.glb --texture red.png';
    const cases: [line: string, status: number, message: RegExp | string][] = [
      [
        'bake bare.glb --cage cage.glb --texture red.png -o no.glb',
        1,
        `bare.glb: ${nothing} has no TEXCOORD_0, the UVs of its texture`,
      ],
      ['bake bare.glb --cage cage.glb --texture red.png -o no.png', 1, /bare\.glb: "box" has no TEXCOORD_0/],
      ['bake box.glb --cage cage.glb --texture short.png -o no.glb', 1, /short\.png: is truncated/],
      ['bake box.glb --cage cage.glb --texture text.png -o no.glb', 1, /text\.png: is not a PNG, JPEG or WebP image/],
      [
        'bake texture.glb --cage cage.glb --texture red.png -o no.glb',
        1,
        `texture.glb: ${nothing}s material has no texture`,
      ],
      ['bake image.glb --cage cage.glb --texture red.png -o no.glb', 1, `image.glb: ${nothing}s texture has no image`],
      ['bake box.glb --cage cage.glb -o no.glb', 2, /there is nothing to bake/],
      [`${whole} --mask colors=POSITION -o no.glb`, 2, /POSITION is not COLOR_0, COLOR_1, … or an attribute of/],
      [`${whole} --mask never=no.glb -o no.glb`, 2, /no\.glb would overwrite .*no\.glb, which/],
      [`${whole} --back -o no.png`, 2, /--back takes no paint/],
      [`${whole} --part nose -o no.png`, 1, /--part nose: nothing has this name; there are: box, own/],
      [`${whole} -o nowhere/out.png`, 1, 'nowhere/out.png: cannot be written (its folder does not exist)'],
      ['bake box.glb --cage cage.glb --back -o nowhere/out.png', 1, /^cagecast: nowhere\/out\.png: cannot be written/],
      ...['0', '1e5', 'NaN'].map((text): [string, number, RegExp] => [
        `${whole} --size ${text} -o no.glb`,
        2,
        /It is not a whole number of texels within 1\.\.8192/,
      ]),
    ];
    for (const [line, status, message] of cases) await fails(status, message, line);
  });
});

/** A strip from x = 0 to 2, or a part of it, whose u is a function of x. */
interface Strip {
  z: number;
  from?: number;
  to?: number;
  /** How many rectangles it has. Default: 16 */
  count?: number;
  u(x: number): number;
}

/** A model of strips with one texture, half red and half blue; a cage has none. */
async function strips(path: string, parts: readonly Strip[], wrapS?: keyof typeof TextureInfo.WrapMode): Promise<void> {
  const document = new Document();
  document.createBuffer();
  const scene = document.createScene();
  const material = document.createMaterial('skin');
  if (wrapS !== undefined) {
    const image = picture(64, (x) => (x < 32 ? [255, 0, 0, 255] : [0, 0, 255, 255]));
    material.setBaseColorTexture(textureOf(document, image));
    material.getBaseColorTextureInfo()!.setWrapS(TextureInfo.WrapMode[wrapS]!);
  }
  for (const { z, from = 0, to = 2, count = 16, u } of parts) {
    const columns = Array.from({ length: count + 1 }, (_, i) => from + ((to - from) * i) / count);
    const corners = columns.flatMap((x) => [0, 1].map((y) => [x, y] as const));
    const indices = columns.slice(1).flatMap((_, i) => [0, 2, 3, 0, 3, 1].map((k) => 2 * i + k));
    const uvs = corners.flatMap(([x, y]) => [u(x), 1 - y]);
    const primitive = document
      .createPrimitive()
      .setAttribute('POSITION', accessor(document, 'VEC3', Float32Array.from(corners.flatMap(([x, y]) => [x, y, z]))))
      .setAttribute('TEXCOORD_0', accessor(document, 'VEC2', Float32Array.from(uvs)))
      .setIndices(accessor(document, 'SCALAR', Uint16Array.from(indices)))
      .setMaterial(wrapS === undefined ? null : material);
    scene.addChild(document.createNode().setMesh(document.createMesh().addPrimitive(primitive)));
  }
  await io.write(path, document);
}

test('a JPEG stays a JPEG; where a texture becomes a PNG, its line says so; other images keep their bytes', async () => {
  const sharp = createRequire(import.meta.url)('sharp') as (
    bytes: Uint8Array,
  ) => Record<'jpeg' | 'webp', () => { toBuffer(): Promise<Buffer> }>;
  for (const [type, line] of [
    ['jpeg', /^color: 96 × 96, on "box"$/m],
    ['webp', /^color: 96 × 96, on "box"; image\/png now, image\/webp before$/m],
  ] as const) {
    const bytes = await sharp(pngOf(picture(size, () => [10, 20, 200, 255])))
      [type]()
      .toBuffer();
    const { json, bin } = unpackGlb(readFileSync('box.glb'));
    const untouched = pngOf(plain(1, 2, 3, 255));
    const chunks = [Buffer.concat([bin, Buffer.alloc(-bin.length & 3)]), bytes, Buffer.from(untouched)];
    const add = (chunk: number, mimeType: string) => {
      const byteOffset = chunks.slice(0, chunk).reduce((sum, one) => sum + one.length, 0);
      const view = json.bufferViews!.push({ buffer: 0, byteOffset, byteLength: chunks[chunk]!.length }) - 1;
      return { bufferView: view, mimeType };
    };
    json.images![0] = add(1, `image/${type}`);
    json.images!.push(add(2, 'image/png'));
    json.textures!.push({ source: json.images!.length - 1 });
    json.materials![0]!.emissiveTexture = { index: json.textures!.length - 1 };
    const all = Buffer.concat(chunks);
    json.buffers![0]!.byteLength = all.length;
    writeFileSync(`${type}.glb`, packGlb({ json, bin: all }));
    assert.match(await ok(`bake ${type}.glb --cage cage.glb --texture red.png -o ${type}-out.glb`), line);
    const material = materialsOf(await io.read(`${type}-out.glb`))[0]!;
    assert.equal(material.getBaseColorTexture()!.getMimeType(), type === 'jpeg' ? 'image/jpeg' : 'image/png');
    assert.deepEqual([...material.getEmissiveTexture()!.getImage()!], [...untouched]);
  }
});

test('UVs that lie wholly outside of a clamped texture hold no paint, which is said', async () => {
  await strips('strip-cage.glb', [{ z: 0.02, u: (x) => x / 2 }]);
  await strips('outside.glb', [{ z: 0, u: (x) => x + 3 }], 'CLAMP_TO_EDGE');
  const reason = 'its UVs lie outside of 0..1, where its texture is clamped: nothing of the paint would be in it';
  const line = 'bake outside.glb --cage strip-cage.glb --texture red.png -o';
  await fails(1, `outside.glb: nothing can be baked: "nodes[0]": ${reason}`, `${line} never.glb`);
  await fails(1, `outside.glb: "nodes[0]": ${reason}`, `${line} never.png`);
});

test('the way back shows what the model shows: what is nearest to the cage, and textures that are mirrored or clamped', async () => {
  await strips('strip-cage.glb', [{ z: 0.02, u: (x) => x / 2 }]);
  const shirt: Strip = { z: 0.008, from: 0.5, to: 1.5, u: (x) => 0.5 + x / 4 };
  const skin: Strip = { z: 0, u: (x) => x / 4 }; // the red half
  const body = { z: 0, u: (x: number) => x };
  const cases: [Strip[], keyof typeof TextureInfo.WrapMode, string][] = [
    [[skin, shirt], 'REPEAT', 'rbbr'],
    [[shirt, skin], 'REPEAT', 'rbbr'],
    [[body], 'MIRRORED_REPEAT', 'rbbr'],
    [[body], 'REPEAT', 'rbrb'],
    [[{ z: 0, u: (x) => x - 0.5 }], 'CLAMP_TO_EDGE', 'rrbb'],
    [[{ z: 0, count: 1, u: (x) => 0.75 * x - 0.5 }], 'CLAMP_TO_EDGE', 'rrrb'],
  ];
  for (const [parts, wrap, colors] of cases) {
    await strips('strips.glb', parts, wrap);
    for (const borders of ['triangle', 'cut']) {
      await ok(`bake strips.glb --cage strip-cage.glb --back --size 64 --borders ${borders} -o strip.png`);
      const image = pngIn('strip.png');
      const found = [8, 24, 40, 56].map((x) => (texel(image, x, 32)[0]! > 200 ? 'r' : 'b')).join('');
      assert.equal(found, colors, `${wrap}, ${borders}`);
    }
  }
});
