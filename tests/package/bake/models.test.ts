import assert from 'node:assert/strict';
import { readFileSync, writeFileSync } from 'node:fs';
import { before, test } from 'node:test';
import { Document, type Material, NodeIO, TextureInfo } from '@gltf-transform/core';
import {
  ALL_EXTENSIONS,
  KHRMaterialsTransmission,
  KHRMaterialsVariants,
  type Transmission,
} from '@gltf-transform/extensions';
import { init } from 'cagecast';
import type { Image } from 'cagecast/bake';
import { type BakeReport, bake, cagecast as cagecastTransform, type ImageCodec } from 'cagecast/gltf';
import { PNG } from 'pngjs';
import { cagecast, packGlb, unpackGlb, validate } from '../../support/gltf.js';
import { ktx2Of } from '../../support/ktx2';
import { islandAt, islandCage, texturedBox } from '../../support/models';
import { temporaryFolder } from '../../support/temporary.js';
import { picture } from './reference.js';

const { at } = temporaryFolder('bake');
const io = new NodeIO().registerExtensions(ALL_EXTENSIONS);
const size = 96;

const pngOf = ({ width, height, data }: Image): Buffer =>
  PNG.sync.write(Object.assign(new PNG({ width, height }), { data: Buffer.from(data) }));
const own = picture(size, (x, y) => [10, 20, 200, (x * 7 + y * 3) % 256]);
const red = picture(4, () => [230, 30, 40, 255]);
const images: ImageCodec = {
  decode: async (bytes) => PNG.sync.read(Buffer.from(bytes)),
  encode: async (image) => pngOf(image),
};

before(async () => {
  await init();
  writeFileSync(at('cage.glb'), (await islandCage(1)).buffer);
  writeFileSync(at('box.glb'), (await texturedBox(pngOf(own))).buffer);
  writeFileSync(at('moved.glb'), (await texturedBox(pngOf(own), { moved: true })).buffer);
  writeFileSync(at('mirrored.glb'), (await texturedBox(pngOf(own), { mirrored: true })).buffer);
  writeFileSync(at('red.png'), pngOf(red));
  writeFileSync(at('lean.png'), pngOf(picture(4, () => [204, 128, 230, 255])));
  writeFileSync(at('rough.png'), pngOf(picture(4, () => [255, 60, 90, 255])));
});

const texel = ({ data }: Image, x: number, y: number) => [...data.subarray(4 * (y * size + x), 4 * (y * size + x) + 4)];
const imageOf = (texture: { getImage(): Uint8Array | null } | null): Image =>
  PNG.sync.read(Buffer.from(texture!.getImage()!));
const materialOf = (document: Document): Material => document.getRoot().listMaterials()[0]!;

/** Checks that the islands of a box are red, and all else is as before. */
function assertPainted(image: Image): void {
  const counts = [0, 0];
  for (let y = 0; y < size; ++y) {
    for (let x = 0; x < size; ++x) {
      const before = texel(own, x, y);
      const island = islandAt(x, y, size, Math.ceil(size / 64) + 2);
      if (island === 1) assert.deepEqual(texel(image, x, y), [230, 30, 40, before[3]], `${x}, ${y}`);
      if (island === 0) assert.deepEqual(texel(image, x, y), before, `${x}, ${y}`);
      if (island >= 0) ++counts[island]!;
    }
  }
  assert.ok(Math.min(...counts) > 1000, String(counts));
}

/** Bakes into a document. */
async function baked(document: Document, more: Partial<Parameters<typeof bake>[0]> = {}): Promise<BakeReport> {
  let report: BakeReport | undefined;
  const cage = await io.read(at('cage.glb'));
  await document.transform(
    bake({ cage, paints: { color: red }, images, onBaked: (found) => void (report = found), ...more }),
  );
  return report!;
}

for (const name of ['box', 'moved']) {
  test(`${name}: a document and the command paint the texture in place, and nothing else changes`, async () => {
    const document = await io.read(at(`${name}.glb`));
    const before = document
      .getRoot()
      .listAccessors()
      .map((accessor) => accessor.getArray());
    const report = await baked(document);
    assert.deepEqual(
      document
        .getRoot()
        .listAccessors()
        .map((accessor) => accessor.getArray()),
      before,
    );
    assert.equal(document.getRoot().listTextures().length, 1);
    assertPainted(imageOf(materialOf(document).getBaseColorTexture()));
    assert.deepEqual(report.left, []);
    assert.deepEqual(
      report.textures.map(({ slot, parts, width }) => [slot, parts, width]),
      [['color', ['box'], size]],
    );

    const { status, stderr } = cagecast('bake', at(`${name}.glb`), at('cage.glb'), at('red.png'), '-o', at('out.glb'));
    assert.deepEqual([status, stderr], [0, '']);
    const bytes = readFileSync(at('out.glb'));
    await validate(at('out.glb'));
    assertPainted(imageOf(materialOf(await io.readBinary(bytes)).getBaseColorTexture()));
    const [was, is] = [readFileSync(at(`${name}.glb`)), bytes].map((glb) => unpackGlb(glb).json);
    const { bufferViews: _, buffers: __, ...rest } = is!;
    const { bufferViews: ___, buffers: ____, ...restBefore } = was!;
    const withoutViews = (json: object) =>
      JSON.parse(JSON.stringify(json, (key, value) => (key === 'bufferView' ? undefined : value)));
    assert.deepEqual(withoutViews(rest), withoutViews(restBefore), 'the texture is replaced in its place');
  });
}

test('a PNG has the paint alone; the way back has it in the cage’s UVs', () => {
  assert.equal(cagecast('bake', at('box.glb'), at('cage.glb'), at('red.png'), '-o', at('paint.png')).status, 0);
  const paint = PNG.sync.read(readFileSync(at('paint.png')));
  assert.equal(paint.width, size);
  assert.equal(cagecast('bake', at('box.glb'), at('cage.glb'), at('red.png'), '-o', at('painted.glb')).status, 0);
  const { status, stderr } = cagecast(
    'bake',
    at('painted.glb'),
    at('cage.glb'),
    '--back',
    '--size',
    String(size),
    '-o',
    at('back.png'),
  );
  assert.deepEqual([status, stderr], [0, '']);
  const back = PNG.sync.read(readFileSync(at('back.png')));
  for (let y = 0; y < size; ++y)
    for (let x = 0; x < size; ++x) {
      if (islandAt(x, y, size, 0) === 1) {
        assert.deepEqual(texel(paint, x, y), [230, 30, 40, 255]);
        // The alpha of the model's texture is its own.
        if (texel(back, x, y)[3]! > 16) assert.deepEqual(texel(back, x, y).slice(0, 3), [230, 30, 40], `${x}, ${y}`);
      }
      if (islandAt(x, y, size, Math.ceil(size / 64) + 2) === 0) {
        assert.equal(texel(paint, x, y)[3], 0);
        assert.equal(texel(back, x, y)[3], 0);
      }
    }
});

test('--part takes a node that holds others for all below it, unless a part has its name', () => {
  const { json, bin } = unpackGlb(readFileSync(at('box.glb')));
  const nodes = json.nodes!;
  const far = nodes.push({ name: 'far', mesh: 0, translation: [9, 0, 0] }) - 1;
  const holding = (name: string, ...children: number[]) => nodes.push({ name, children }) - 1;
  json.scenes![0]!.nodes = [holding('Near', 0), holding('Away', holding('box', far))];
  writeFileSync(at('held.glb'), packGlb({ json, bin }));
  const bake = (part: string) =>
    cagecast('bake', at('held.glb'), at('cage.glb'), at('red.png'), '--part', part, '-o', at('part.png'));
  for (const part of ['Ne*', 'box']) {
    const { stdout, stderr } = bake(part);
    assert.deepEqual([stderr, /part\.png: 96 × 96, for "box"$/m.test(stdout)], ['', true], part);
  }
  assert.match(bake('Away').stderr, /held\.glb: nothing of it may be painted\n$/);
  assert.match(bake('Nose').stderr, /--part Nose: no node or material has this name; there are: box, /);
});

test('maps of normals and of roughness are added to materials that lack them, flat beside the paint', async () => {
  const args = [
    'bake',
    at('box.glb'),
    at('cage.glb'),
    '--normal',
    at('lean.png'),
    '--orm',
    at('rough.png'),
    '--size',
    String(size),
  ];
  const { status, stderr } = cagecast(...args, '-o', at('maps.glb'));
  assert.deepEqual([status, stderr], [0, '']);
  await validate(at('maps.glb'));
  const material = materialOf(await io.read(at('maps.glb')));
  const [normal, rough, color] = [
    imageOf(material.getNormalTexture()),
    imageOf(material.getMetallicRoughnessTexture()),
    imageOf(material.getBaseColorTexture()),
  ];
  // The middle of an island, where box and cage have the same UVs, and a corner beside all of them.
  const near = (a: number[], b: number[]) =>
    assert.ok(
      a.every((value, k) => Math.abs(value - b[k]!) <= 2),
      String(a),
    );
  near(texel(normal, 16, 24), [204, 128, 230, 255]);
  near(texel(normal, 0, 0), [128, 128, 255, 255]);
  near(texel(rough, 16, 24), [255, 60, 90, 255]);
  near(texel(rough, 0, 0), [255, 255, 0, 255]);
  assert.deepEqual([material.getRoughnessFactor(), material.getMetallicFactor()], [1, 1]);
  assert.deepEqual(texel(color, 16, 24), texel(own, 16, 24), 'colours stay');
  assert.equal(material.getOcclusionTexture(), material.getMetallicRoughnessTexture());
});

test('the occlusion of a model stays beside that of the paint: none, in its metallic-roughness texture, in one of its own', async () => {
  const packed = picture(size, (x) => [x, 100, 50, 255]);
  const apart = picture(size, (_, y) => [y, 0, 0, 255]);
  const paint = picture(4, () => [200, 60, 90, 255]);
  writeFileSync(at('orm.png'), pngOf(paint));
  for (const occlusion of ['none', 'packed', 'apart']) {
    const document = await io.read(at('box.glb'));
    const [rough, dark] = [packed, apart].map((image) =>
      document
        .createTexture()
        .setMimeType('image/png')
        .setImage(new Uint8Array(pngOf(image))),
    );
    materialOf(document)
      .setMetallicRoughnessTexture(rough!)
      .setOcclusionTexture(occlusion === 'none' ? null : occlusion === 'packed' ? rough! : dark!)
      .setOcclusionStrength(0.5);
    if (occlusion !== 'apart') dark!.dispose();
    writeFileSync(at('dark.glb'), await io.writeBinary(document));
    const { status, stderr } = cagecast(
      'bake',
      at('dark.glb'),
      at('cage.glb'),
      '--orm',
      at('orm.png'),
      '-o',
      at('orm.glb'),
    );
    assert.deepEqual([status, stderr], [0, '']);
    assert.deepEqual(await validate(at('orm.glb')), []);
    await baked(document, { paints: { orm: paint } });
    for (const material of [document, await io.read(at('orm.glb'))].map(materialOf)) {
      const [image, shown] = [material.getMetallicRoughnessTexture(), material.getOcclusionTexture()].map(imageOf);
      assert.deepEqual(texel(image!, 16, 24), [200, 60, 90, 255], occlusion);
      assert.deepEqual(texel(image!, 90, 2), [occlusion === 'none' ? 255 : 90, 100, 0, 255], occlusion);
      assert.deepEqual([...shown!.data], [...(occlusion === 'apart' ? apart : image!).data], occlusion);
      if (occlusion !== 'none') assert.equal(material.getOcclusionStrength(), 0.5);
    }
  }
});

test('two primitives with images of their own are painted each in its own; what cannot hold paint is reported', async () => {
  const document = await io.read(at('box.glb'));
  const [mesh] = document.getRoot().listMeshes();
  const [first] = mesh!.listPrimitives();
  const indices = first!.getIndices()!;
  const all = [...indices.getArray()!];
  const materials = ['second', 'bare'].map((name) => document.createMaterial(name));
  const second = document
    .createTexture('other')
    .setMimeType('image/png')
    .setImage(new Uint8Array(pngOf(own)));
  materials[0]!.setBaseColorTexture(second);
  const third = all.length / 3;
  [first!, ...materials].forEach((of, p) => {
    const primitive = p === 0 ? first! : first!.clone().setMaterial(of as Material);
    const part = document.createAccessor().setArray(Uint16Array.from(all.slice(p * third, (p + 1) * third)));
    primitive.setIndices(part.setBuffer(document.getRoot().listBuffers()[0]!));
    if (p > 0) mesh!.addPrimitive(primitive);
  });
  const report = await baked(document);
  assert.deepEqual(
    report.textures.map(({ parts }) => parts),
    [['box/own'], ['box/second']],
  );
  assert.deepEqual(report.left, [{ part: 'box/bare', reason: 'its material has no texture' }]);
  const [ownImage, otherImage] = [materialOf(document), materials[0]!].map((material) =>
    imageOf(material.getBaseColorTexture()),
  );
  // Islands 0 and 1 are of the first primitive, 2 and 3 of the second.
  assert.deepEqual(
    [texel(ownImage!, 16, 24), texel(ownImage!, 80, 24)],
    [[230, 30, 40, texel(own, 16, 24)[3]], texel(own, 80, 24)],
  );
  assert.deepEqual(
    [texel(otherImage!, 16, 24), texel(otherImage!, 80, 24)],
    [texel(own, 16, 24), [230, 30, 40, texel(own, 80, 24)[3]]],
  );

  const overlaid = await io.read(at('box.glb'));
  materialOf(overlaid).setBaseColorTexture(null);
  const without = await baked(overlaid, { texture: new Uint8Array(pngOf(red)) });
  assert.equal(without.textures.length, 0);
  assert.equal(overlaid.getRoot().listMeshes()[0]!.listPrimitives().length, 2, 'what cannot be baked gets an overlay');
});

test('a texture that is used in another way, too, stays; the paint gets one of its own', async () => {
  const document = await io.read(at('box.glb'));
  const [texture] = document.getRoot().listTextures();
  materialOf(document).setEmissiveTexture(texture!).setBaseColorFactor([1, 0.5, 1, 1]);
  writeFileSync(at('glowing.glb'), await io.writeBinary(document));
  const { status, stderr } = cagecast('bake', at('glowing.glb'), at('cage.glb'), at('red.png'), '-o', at('shared.glb'));
  assert.deepEqual([status, stderr], [0, '']);
  await validate(at('shared.glb'));
  const material = materialOf(await io.read(at('shared.glb')));
  assert.deepEqual([...imageOf(material.getEmissiveTexture()).data], [...own.data]);
  const painted = imageOf(material.getBaseColorTexture());
  assert.deepEqual(texel(painted, 16, 24).slice(0, 3), [230, 30, 40]);
  assert.ok(texel(painted, 0, 0)[1]! < texel(own, 0, 0)[1]!, 'the factor is in the texture');
  assert.deepEqual(material.getBaseColorFactor(), [1, 1, 1, 1]);
});

test('an ORM texture that an extension reads, too, stays as the extension shows it', async () => {
  const document = await io.read(at('box.glb'));
  const shared = document
    .createTexture('orm')
    .setMimeType('image/png')
    .setImage(new Uint8Array(pngOf(picture(size, () => [0, 180, 0, 255]))));
  const transmission = document.createExtension(KHRMaterialsTransmission).createTransmission();
  transmission.setTransmissionFactor(1).setTransmissionTexture(shared);
  materialOf(document).setMetallicRoughnessTexture(shared).setExtension('KHR_materials_transmission', transmission);
  writeFileSync(at('glass.glb'), await io.writeBinary(document));
  const args = ['bake', at('glass.glb'), at('cage.glb'), '--orm', at('rough.png'), '-o', at('glass-out.glb')];
  const { status, stderr } = cagecast(...args);
  assert.deepEqual([status, stderr], [0, '']);
  await validate(at('glass-out.glb'));
  const material = materialOf(await io.read(at('glass-out.glb')));
  const after = material.getExtension<Transmission>('KHR_materials_transmission')!;
  assert.deepEqual(texel(imageOf(after.getTransmissionTexture()), 0, 0), [0, 180, 0, 255]);
  assert.deepEqual(texel(imageOf(material.getMetallicRoughnessTexture()), 16, 24), [255, 60, 90, 255]);
});

test('masks by images and by colours keep paint away, and bring it back: documents, files', async () => {
  // The left third is white: the islands 0 and 3.
  const left = picture(96, (x) => (x < 32 ? [255, 255, 255, 255] : [0, 0, 0, 255]));
  const all = picture(8, () => [255, 255, 255, 255]);
  writeFileSync(at('left.png'), pngOf(left));
  writeFileSync(at('all.png'), pngOf(all));
  const islands = (image: Image) =>
    [16, 48, 80].flatMap((x) => [24, 72].map((y) => Number(texel(image, x, y)[0] === 230))).join('');
  const command = (...flags: string[]) => {
    const found = cagecast('bake', at('box.glb'), at('cage.glb'), at('red.png'), ...flags, '-o', at('masked.png'));
    assert.deepEqual([found.status, found.stderr], [0, '']);
    return islands(PNG.sync.read(readFileSync(at('masked.png'))));
  };
  assert.equal(command(), '111111');
  assert.equal(command('--never-mask', at('left.png')), '001111');
  assert.equal(command('--always-mask', at('left.png'), '--exclude', 'box'), '110000');
  assert.equal(command('--always-mask', at('all.png'), '--never-mask', at('left.png')), '001111');

  const document = await io.read(at('box.glb'));
  await baked(document, { maskImages: { never: left } });
  assert.equal(islands(imageOf(materialOf(document).getBaseColorTexture())), '001111');

  const colored = await io.read(at('box.glb'));
  const [primitive] = colored.getRoot().listMeshes()[0]!.listPrimitives();
  const uvs = primitive!.getAttribute('TEXCOORD_0')!;
  const colors = Float32Array.from({ length: 3 * uvs.getCount() }, (_, i) =>
    uvs.getElement(Math.floor(i / 3), [])[0]! < 1 / 3 && i % 3 > 0 ? 0 : 1,
  );
  primitive!.setAttribute(
    '_MASK',
    colored.createAccessor().setType('VEC3').setArray(colors).setBuffer(uvs.getBuffer()),
  );
  writeFileSync(at('colored.glb'), await io.writeBinary(colored));
  let painted = 0;
  const document2 = await io.read(at('colored.glb'));
  await document2.transform(
    cagecastTransform({
      cage: await io.read(at('cage.glb')),
      maskColors: '_MASK',
      onResult: ({ zones }) => void (painted = zones.filter((zone) => zone === 0).length),
    }),
  );
  assert.equal(painted, (uvs.getCount() * 4) / 6);
  const { status, stderr } = cagecast(
    'bake',
    at('box.glb'),
    at('cage.glb'),
    at('red.png'),
    '--mask-colors',
    'COLOR_0',
    '-o',
    at('none.png'),
  );
  assert.equal(status, 1);
  assert.match(stderr, /box\.glb: no part has COLOR_0 of 3 or 4 numbers/);
});

test('baking a model that has an overlay of an earlier transfer takes it away: documents, files', async () => {
  const [painted, out] = [at('overlaid.glb'), at('no-overlay.glb')];
  const { status: made } = cagecast(
    ...['transfer', at('box.glb'), '--cage', at('cage.glb'), '--texture', at('lean.png'), '-o', painted],
  );
  assert.equal(made, 0);
  const overlaysOf = (document: Document) =>
    document
      .getRoot()
      .listMeshes()
      .flatMap((mesh) => mesh.listPrimitives().filter((primitive) => primitive.getExtras()['cagecastOverlay']));
  const document = await io.read(painted);
  assert.equal(overlaysOf(document).length, 1);
  await baked(document);
  const { status, stdout, stderr } = cagecast('bake', painted, at('cage.glb'), at('red.png'), '-o', out);
  assert.deepEqual([status, stderr], [0, '']);
  assert.match(stdout, /\ntook away 1 overlay of an earlier transfer$/m);
  await validate(out);
  for (const one of [document, await io.read(out)]) {
    assert.equal(overlaysOf(one).length, 0);
    assert.deepEqual([one.getRoot().listMaterials().length, one.getRoot().listTextures().length], [1, 1]);
    assertPainted(imageOf(materialOf(one).getBaseColorTexture()));
  }
});

test('materials of variants are painted as well, or it says why not: documents, files', async () => {
  const document = await io.read(at('box.glb'));
  const [box] = document.getRoot().listMeshes()[0]!.listPrimitives();
  const variants = document.createExtension(KHRMaterialsVariants);
  const list = variants.createMappingList();
  const texture = document
    .createTexture('night')
    .setMimeType('image/png')
    .setImage(new Uint8Array(pngOf(own)));
  const same = materialOf(document).getBaseColorTexture();
  for (const [name, map] of [
    ['night', texture],
    ['glossy', same],
    ['plain', null],
  ] as const) {
    const material = document.createMaterial(name).setBaseColorTexture(map).setRoughnessFactor(0);
    list.addMapping(variants.createMapping().setMaterial(material).addVariant(variants.createVariant(name)));
  }
  box!.setExtension('KHR_materials_variants', list);
  await io.write(at('variants.glb'), document);
  const assertBaked = (painted: Document) => {
    const [first, night, glossy, plain] = painted.getRoot().listMaterials();
    for (const material of [first!, night!]) assertPainted(imageOf(material.getBaseColorTexture()));
    assert.equal(glossy!.getBaseColorTexture(), first!.getBaseColorTexture());
    assert.equal(plain!.getBaseColorTexture(), null);
    assert.equal(painted.getRoot().listTextures().length, 2);
  };
  const report = await baked(document);
  assertBaked(document);
  assert.deepEqual(
    report.textures.map(({ parts, overlap }) => [parts, overlap.texels < 0.001]),
    [
      [['box'], true],
      [['box'], true],
    ],
  );
  const reason = 'its material has no texture';
  assert.deepEqual(report.left, [{ part: 'box', material: 'plain', reason }]);
  const { status, stdout, stderr } = cagecast(
    ...['bake', at('variants.glb'), at('cage.glb'), at('red.png'), '-o', at('out.glb')],
  );
  assert.deepEqual([status, stderr], [0, '']);
  assert.ok(stdout.includes(`not painted: "box", with "plain" of its variants: ${reason}`), stdout);
  assertBaked(await io.read(at('out.glb')));
  // The reason of its own material comes first, and that of a variant names it.
  const small = ['bake', at('variants.glb'), at('cage.glb'), at('red.png'), '--size', '1', '-o', at('small.glb')];
  assert.match(cagecast(...small).stderr, /: nothing can be baked: "box": its texture is a palette, or too small for/);
});

test('triangles without area are nothing to paint, whatever their number; surfaces without area in UVs are a palette', async () => {
  const document = await io.read(at('box.glb'));
  const [box] = document.getRoot().listMeshes()[0]!.listPrimitives();
  const indices = box!.getIndices()!;
  const all = [...indices.getArray()!];
  indices.setArray(Uint16Array.from([...all, ...all.flatMap((v) => [v, v, v])]));
  const { textures, left } = await baked(document);
  assert.deepEqual([textures.length, left], [1, []]);
  assertPainted(imageOf(materialOf(document).getBaseColorTexture()));

  const palette = await io.read(at('box.glb'));
  const uvs = palette.getRoot().listMeshes()[0]!.listPrimitives()[0]!.getAttribute('TEXCOORD_0')!;
  uvs.setArray(new Float32Array(2 * uvs.getCount()).fill(0.4));
  assert.match((await baked(palette)).left[0]!.reason, /is a palette/);
});

test('vertex colours hinder the paint unless all of them are white', async () => {
  const coloured = async (colors: Float32Array | Uint8Array, type: 'VEC3' | 'VEC4', normalized: boolean) => {
    const document = await io.read(at('box.glb'));
    const [box] = document.getRoot().listMeshes()[0]!.listPrimitives();
    const accessor = document.createAccessor().setType(type).setNormalized(normalized).setArray(colors);
    box!.setAttribute('COLOR_0', accessor.setBuffer(document.getRoot().listBuffers()[0]!));
    writeFileSync(at('coloured.glb'), await io.writeBinary(document));
    return document;
  };
  const vertices = (await io.read(at('box.glb')))
    .getRoot()
    .listAccessors()
    .find((a) => a.getType() === 'VEC3')!
    .getCount();
  const bake = () => cagecast('bake', at('coloured.glb'), at('cage.glb'), at('red.png'), '-o', at('out.glb'));
  const white = [
    await coloured(
      new Uint8Array(4 * vertices).map((_, i) => (i % 4 === 3 ? 128 : 255)),
      'VEC4',
      true,
    ),
    await coloured(new Float32Array(3 * vertices).fill(1), 'VEC3', false),
  ];
  for (const document of white) {
    assert.deepEqual((await baked(document)).left, []);
    assertPainted(imageOf(materialOf(document).getBaseColorTexture()));
  }
  assert.equal(bake().status, 0);
  const tinted = await coloured(new Float32Array(3 * vertices).fill(1).fill(0.5, 7, 8), 'VEC3', false);
  const reason = 'its vertices have colours';
  assert.deepEqual((await baked(tinted)).left, [{ part: 'box', reason }]);
  assert.match(bake().stderr, new RegExp(`coloured\\.glb: nothing can be baked: "box": ${reason}`));
});

test('what follows the end of a PNG is not part of it, as in viewers', async () => {
  const padded = (png: Uint8Array) => Buffer.concat([png, Buffer.alloc(3)]);
  writeFileSync(at('padded.glb'), (await texturedBox(padded(pngOf(own)))).buffer);
  writeFileSync(at('padded.png'), padded(pngOf(red)));
  const { status, stderr } = cagecast('bake', at('padded.glb'), at('cage.glb'), at('padded.png'), '-o', at('out.glb'));
  assert.deepEqual([status, stderr], [0, '']);
  assertPainted(imageOf(materialOf(await io.read(at('out.glb'))).getBaseColorTexture()));
});

test('an image that is painted keeps its name and what applications know of it', () => {
  const { json, bin } = unpackGlb(readFileSync(at('box.glb')));
  delete json.images![0]!.bufferView;
  Object.assign(json.images![0]!, { uri: 'skin.png', extras: { licence: 'own' } });
  delete json.images![0]!.name;
  writeFileSync(at('named.glb'), packGlb({ json, bin }));
  writeFileSync(at('skin.png'), pngOf(own));
  const { status } = cagecast('bake', at('named.glb'), at('cage.glb'), at('red.png'), '-o', at('out.glb'));
  assert.equal(status, 0);
  const [image] = unpackGlb(readFileSync(at('out.glb'))).json.images!;
  assert.deepEqual([image!.name, image!.extras], ['skin', { licence: 'own' }]);
});

test('no file that was read is overwritten, whoever names it', async () => {
  const { json, bin } = unpackGlb(readFileSync(at('box.glb')));
  delete json.images![0]!.bufferView;
  json.images![0]!.uri = 'skin.png';
  writeFileSync(at('named.glb'), packGlb({ json, bin }));
  writeFileSync(at('mask.png'), pngOf(picture(4, () => [0, 0, 0, 255])));
  writeFileSync(at('own.json'), '{ "neverMask": "mask.png" }');
  for (const [args, path] of [
    [[at('named.glb')], at('skin.png')],
    [[at('box.glb'), '--config', at('own.json')], at('mask.png')],
  ] as const) {
    writeFileSync(at('skin.png'), pngOf(own));
    const before = readFileSync(path);
    const [target, ...more] = args;
    if (more.length > 0) {
      const used = cagecast('bake', target, at('cage.glb'), at('red.png'), ...more, '-o', at('out.glb'));
      assert.match(used.stdout, /\nsettings from .*own\.json\n$/);
    }
    const { status, stderr } = cagecast('bake', target, at('cage.glb'), at('red.png'), ...more, '-o', path);
    assert.equal(status, 2);
    assert.match(stderr, /^cagecast: .*\.png would overwrite .*\.png, which this command reads[^\n]*\n$/);
    assert.deepEqual(readFileSync(path), before);
  }
});

test('a PNG that cannot be written is named, and not the model', () => {
  for (const args of [[at('red.png')], ['--back']]) {
    const { status, stderr } = cagecast('bake', at('box.glb'), at('cage.glb'), ...args, '-o', at('nowhere/out.png'));
    assert.deepEqual(
      [status, stderr],
      [1, `cagecast: ${at('nowhere/out.png')}: cannot be written (its folder does not exist)\n`],
    );
  }
});

test('another size keeps the colours under an alpha of 0, and the longer side is as long as asked', async () => {
  const clear = picture(64, (x) => [10 + x, 20, 200, 0]);
  const tall = { width: 32, height: 64, data: clear.data.subarray(0, 4 * 32 * 64) };
  writeFileSync(at('clear.glb'), (await texturedBox(pngOf(tall))).buffer);
  const bakeTo = (out: string, ...more: string[]) =>
    cagecast('bake', at('clear.glb'), at('cage.glb'), ...more, '-o', at(out));
  assert.equal(bakeTo('clear-out.glb', at('red.png'), '--size', '32').status, 0);
  const image = imageOf(materialOf(await io.read(at('clear-out.glb'))).getBaseColorTexture());
  assert.deepEqual([image.width, image.height], [16, 32]);
  const blues = Array.from({ length: 16 * 32 }, (_, i) => image.data[4 * i + 2]!);
  assert.ok(Math.min(...blues) >= 40, 'none is black');
  assert.match(bakeTo('clear.png', at('red.png'), '--size', '32').stdout, /: 16 × 32, for /);
  // Of a texture that cannot be read, nothing is needed.
  const { json, bin } = unpackGlb(readFileSync(at('clear.glb')));
  delete json.images![0]!.bufferView;
  json.images![0]!.uri = `data:image/ktx2;base64,${Buffer.from(ktx2Of(1, 2, 3)).toString('base64')}`;
  writeFileSync(at('packed.glb'), packGlb({ json, bin }));
  const packed = (...more: string[]) =>
    cagecast('bake', at('packed.glb'), at('cage.glb'), at('red.png'), ...more, '-o', at('packed.png'));
  assert.match(packed('--size', '32').stdout, /: 32 × 32, for /);
  assert.match(packed().stderr, /packed\.glb: its texture is a KTX2 image, which cannot be baked/);
  // The way back shows what an opaque material does.
  assert.equal(bakeTo('back.png', '--back').status, 0);
  const back = PNG.sync.read(readFileSync(at('back.png')));
  assert.ok(back.data.some((byte, i) => i % 4 === 3 && byte === 255));
});

/** A strip from x = 0 to 2, or a part of it, whose u is a function of x. */
interface Strip {
  name: string;
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
  const buffer = document.createBuffer();
  const scene = document.createScene();
  const accessor = (type: 'VEC2' | 'VEC3' | 'SCALAR', array: Float32Array | Uint16Array) =>
    document.createAccessor().setType(type).setArray(array).setBuffer(buffer);
  const material = document.createMaterial('skin');
  if (wrapS !== undefined) {
    const image = pngOf(picture(64, (x) => (x < 32 ? [255, 0, 0, 255] : [0, 0, 255, 255])));
    material.setBaseColorTexture(document.createTexture().setImage(image).setMimeType('image/png'));
    material.getBaseColorTextureInfo()!.setWrapS(TextureInfo.WrapMode[wrapS]!);
  }
  for (const { name, z, from = 0, to = 2, count = 16, u } of parts) {
    const columns = Array.from({ length: count + 1 }, (_, i) => from + ((to - from) * i) / count);
    const corners = columns.flatMap((x) => [0, 1].map((y) => [x, y] as const));
    const primitive = document
      .createPrimitive()
      .setAttribute('POSITION', accessor('VEC3', Float32Array.from(corners.flatMap(([x, y]) => [x, y, z]))))
      .setAttribute('TEXCOORD_0', accessor('VEC2', Float32Array.from(corners.flatMap(([x, y]) => [u(x), 1 - y]))))
      .setIndices(
        accessor(
          'SCALAR',
          Uint16Array.from(columns.slice(1).flatMap((_, i) => [0, 2, 3, 0, 3, 1].map((k) => 2 * i + k))),
        ),
      )
      .setMaterial(wrapS === undefined ? null : material);
    scene.addChild(document.createNode(name).setMesh(document.createMesh(name).addPrimitive(primitive)));
  }
  await io.write(path, document);
}

test('the way back shows what the model shows: what is nearest to the cage, and textures that are mirrored or clamped', async () => {
  await strips(at('strip-cage.glb'), [{ name: 'cage', z: 0.02, u: (x) => x / 2 }]);
  const shirt: Strip = { name: 'shirt', z: 0.008, from: 0.5, to: 1.5, u: (x) => 0.5 + x / 4 };
  const skin: Strip = { name: 'skin', z: 0, u: (x) => x / 4 }; // the red half
  await strips(at('skin-first.glb'), [skin, shirt], 'REPEAT');
  await strips(at('shirt-first.glb'), [shirt, skin], 'REPEAT');
  await strips(at('mirror.glb'), [{ name: 'body', z: 0, u: (x) => x }], 'MIRRORED_REPEAT');
  await strips(at('repeat.glb'), [{ name: 'body', z: 0, u: (x) => x }], 'REPEAT');
  await strips(at('clamp.glb'), [{ name: 'body', z: 0, u: (x) => x - 0.5 }], 'CLAMP_TO_EDGE');
  await strips(at('crossing.glb'), [{ name: 'body', z: 0, count: 1, u: (x) => 0.75 * x - 0.5 }], 'CLAMP_TO_EDGE');
  const [r, b] = ['red', 'blue'];
  const expected = {
    'skin-first': [r, b, b, r],
    'shirt-first': [r, b, b, r],
    mirror: [r, b, b, r],
    repeat: [r, b, r, b],
    clamp: [r, r, b, b],
    crossing: [r, r, r, b],
  };
  for (const [name, colors] of Object.entries(expected))
    for (const borders of ['triangle', 'cut']) {
      const args = [at(`${name}.glb`), at('strip-cage.glb'), '--back', '--size', '64', '--borders', borders];
      const { status, stderr } = cagecast('bake', ...args, '-o', at('strip.png'));
      assert.deepEqual([status, stderr], [0, ''], name);
      const { data } = PNG.sync.read(readFileSync(at('strip.png')));
      const found = [8, 24, 40, 56].map((x) => (data[4 * (32 * 64 + x)]! > 200 ? r : b));
      assert.deepEqual(found, colors, `${name}, ${borders}`);
    }
});

test('avatars show the paint where their own materials name the texture, even if others go on using it', async () => {
  const { json, bin } = unpackGlb(readFileSync(at('box.glb')));
  const [material] = json.materials!;
  const texture = material!.pbrMetallicRoughness!.baseColorTexture!.index;
  material!.emissiveTexture = { index: texture }; // so it is not painted in its place
  material!.extensions = { VRMC_materials_mtoon: { specVersion: '1.0', shadeMultiplyTexture: { index: texture } } };
  material!.pbrMetallicRoughness!.baseColorFactor = [0.5, 0.25, 0.5, 1];
  const textureProperties = { _MainTex: texture, _ShadeTexture: texture };
  const properties = {
    textureProperties,
    vectorProperties: { _Color: [0.5, 0.25, 0.5, 1], _ShadeColor: [0, 0, 0, 1] },
  };
  json.extensions = { VRM: { materialProperties: [properties] } };
  json.extensionsUsed = ['VRM', 'VRMC_materials_mtoon'];
  writeFileSync(at('avatar.glb'), packGlb({ json, bin }));
  assert.equal(cagecast('bake', at('avatar.glb'), at('cage.glb'), at('red.png'), '-o', at('out.vrm')).status, 0);
  const { json: after } = unpackGlb(readFileSync(at('out.vrm')));
  const [painted] = after.materials!;
  const now = painted!.pbrMetallicRoughness!.baseColorTexture!.index;
  assert.notEqual(now, painted!.emissiveTexture!.index);
  assert.deepEqual(after.extensions!['VRM'], {
    materialProperties: [
      {
        textureProperties: { _MainTex: now, _ShadeTexture: now },
        vectorProperties: { _Color: [1, 1, 1, 1], _ShadeColor: [0, 0, 0, 1] }, // the factor is in the texture
      },
    ],
  });
  const mtoon = painted!.extensions!['VRMC_materials_mtoon'] as { shadeMultiplyTexture: { index: number } };
  assert.equal(mtoon.shadeMultiplyTexture.index, now);
});

test('what is optional in a file stays so', async () => {
  const { json, bin } = unpackGlb(readFileSync(at('box.glb')));
  const image = json.images!.push({ ...json.images![0]! }) - 1;
  // A second texture, which is not painted, has another image for viewers that know it.
  json.textures!.push({ source: 0, extensions: { EXT_texture_webp: { source: image } } });
  json.materials!.push({ name: 'eye', pbrMetallicRoughness: { baseColorTexture: { index: 1 } } });
  // Some writers have null for what a material does not have.
  json.materials!.push({ extensions: { KHR_materials_clearcoat: null } } as object, { extensions: null } as object);
  json.extensionsUsed = ['EXT_texture_webp'];
  writeFileSync(at('optional.glb'), packGlb({ json, bin }));
  const { status } = cagecast('bake', at('optional.glb'), at('cage.glb'), at('red.png'), '-o', at('out.glb'));
  assert.equal(status, 0);
  const { json: after } = unpackGlb(readFileSync(at('out.glb')));
  assert.deepEqual([after.extensionsUsed, after.extensionsRequired], [['EXT_texture_webp'], undefined]);
});

test('overlapping UVs are reported by the command', () => {
  const { status, stdout } = cagecast('bake', at('mirrored.glb'), at('cage.glb'), at('red.png'), '-o', at('out.glb'));
  assert.equal(status, 0);
  assert.match(
    stdout,
    /UVs overlap: \d+\.\d % of its texels are claimed twice, \d+\.\d % of the paint found no room \("box"\)/,
  );
});

test('a document is unchanged if its second texture cannot be written, or is read as something else than RGBA', async () => {
  const document = await io.read(at('box.glb'));
  const before = await io.writeBinary(document);
  let encoded = 0;
  const full: ImageCodec = {
    ...images,
    encode: async (image) => {
      if (++encoded === 2) throw new Error('the disk is full');
      return pngOf(image);
    },
  };
  await assert.rejects(baked(document, { paints: { color: red, normal: red }, images: full }), /the disk is full/);
  assert.equal(encoded, 2);
  assert.deepEqual(await io.writeBinary(document), before);
  const withoutAlpha: ImageCodec = {
    ...images,
    decode: async (bytes) => {
      const { width, height, data } = PNG.sync.read(Buffer.from(bytes));
      return { width, height, data: data.filter((_, i) => i % 4 !== 3) };
    },
  };
  await assert.rejects(
    baked(document, { images: withoutAlpha }),
    /^CagecastError: bake: images\.decode gave 27648 bytes for 96 × 96 pixels, not 4 for each$/,
  );
  assert.deepEqual(await io.writeBinary(document), before);
});

test('what cannot be baked is one line that names the file', async () => {
  const bare = await io.read(at('box.glb'));
  for (const primitive of bare.getRoot().listMeshes()[0]!.listPrimitives()) primitive.setAttribute('TEXCOORD_0', null);
  writeFileSync(at('bare.glb'), await io.writeBinary(bare));
  writeFileSync(at('short.png'), pngOf(red).subarray(0, 40));
  writeFileSync(at('text.png'), 'no picture');
  // Numbers of what is not there, and an image that is none.
  const whole = readFileSync(at('box.glb'));
  const patched = (name: string, from: string, to: string) => {
    const bytes = Buffer.from(whole);
    assert.ok(bytes.write(to, bytes.indexOf(from)) > 0 && from.length === to.length && whole.includes(from), from);
    writeFileSync(at(name), bytes);
  };
  patched('texture.glb', '"baseColorTexture":{"index":0', '"baseColorTexture":{"index":7');
  patched('image.glb', '"source":0', '"source":5');
  const [box, cage, paint, out] = [at('box.glb'), at('cage.glb'), at('red.png'), ['-o', at('none.glb')]];
  const cases: [string[], number, RegExp][] = [
    [
      [at('bare.glb'), cage, paint, ...out],
      1,
      /bare\.glb: nothing can be baked: "box": it has no TEXCOORD_0, the UVs of its texture/,
    ],
    [[at('bare.glb'), cage, paint, '-o', at('none.png')], 1, /bare\.glb: "box" has no TEXCOORD_0/],
    [[box, cage, at('short.png'), ...out], 1, /short\.png: is truncated/],
    [[box, cage, at('text.png'), ...out], 1, /text\.png: is not a PNG, JPEG or WebP image/],
    [
      [at('texture.glb'), cage, paint, ...out],
      1,
      /texture\.glb: nothing can be baked: "box": its material has no texture/,
    ],
    [
      [at('image.glb'), cage, paint, ...out],
      1,
      /image\.glb: nothing can be baked: "box\/?.*": its texture has no image/,
    ],
    [[box, cage, ...out], 2, /there is nothing to bake/],
    [[box, cage, paint, '--mask-colors', 'POSITION', ...out], 2, /It is not COLOR_0, COLOR_1, … or an attribute of/],
    [[box, cage, paint, '--never-mask', at('none.glb'), ...out], 2, /none\.glb would overwrite .*none\.glb, which/],
    [[box, cage, paint, '--back', '-o', at('none.png')], 2, /--back takes TARGET and CAGE only/],
    [
      [box, cage, paint, '--part', 'nose', '-o', at('none.png')],
      1,
      /--part nose: no node or material has this name; there are: box, own/,
    ],
    ...['0', '1e5', 'NaN'].map((text): [string[], number, RegExp] => [
      [box, cage, paint, '--size', text, ...out],
      2,
      /It is not a whole number of texels within 1\.\.8192/,
    ]),
  ];
  for (const [args, code, message] of cases) {
    const { status, stderr } = cagecast('bake', ...args);
    assert.deepEqual([status, stderr.trimEnd().includes('\n')], [code, false], stderr);
    assert.match(stderr, message);
  }
  const document = await io.read(at('box.glb'));
  await assert.rejects(
    async () => baked(document, { paints: {} }),
    /bake: paints is of type Object, not { color, normal, orm }/,
  );
  const misspelt = { color: red, norml: red };
  await assert.rejects(
    async () => baked(document, { paints: misspelt }),
    /bake: paints is of type Object, not { color, normal, orm }/,
  );
  for (const wrong of [0, -5, 0.5, NaN, 99999, null, '64'])
    await assert.rejects(
      async () => baked(document, { size: wrong as number }),
      /^CagecastError: bake: size is .+, not a whole number of texels from 1 to 8192$/,
    );
  await assert.rejects(async () => baked(document, { images: undefined as never }), /bake: images is undefined, not/);
});
