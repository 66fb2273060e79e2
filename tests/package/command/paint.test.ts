// Which texture is where: regions, tiles, bounds of UVs, reference cages; and what of it an earlier transfer left.
import assert from 'node:assert/strict';
import { mkdirSync, readdirSync, readFileSync } from 'node:fs';
import { before, test } from 'node:test';
import type { Document } from '@gltf-transform/core';
import type { Mesh } from 'cagecast';
import draco from 'draco3dgltf';
import { MeshoptDecoder } from 'meshoptimizer';
import { fails, json, ok, run } from '../../support/command.js';
import { glbOf, isOverlay, primitivesOf, unpackGlb, validate } from '../../support/gltf.js';
import { head } from '../scenes.js';
import { io, jsonOf, png, workplace, write } from './workplace.js';

const scene = head(5, 12);
const { cage } = workplace('paint', { ...scene, target: { ...scene.target, uvs: undefined } });
const transfer = 'transfer target.glb --cage cage.glb';
const loose = '--threshold 0 --set minCovered=0';

interface Report {
  counts: object;
  options: { uvBounds?: number[]; referenceCage?: string };
  triangles: { total: number; cosmetic: number; outOfBounds?: number };
  cut: { triangles: Report['triangles'] } | null;
  regions: { cage: string; uvSet: string; zones: string; triangles: { total: number; cosmetic: number } }[];
}

const uvsMoved = (move: (u: number, v: number) => [number, number]): Mesh => ({
  ...cage,
  uvs: cage.uvs!.map((_, i, uvs) => move(uvs[i - (i % 2)]!, uvs[i - (i % 2) + 1]!)[i % 2]!),
});
/** Those triangles of the cage of which the centre is far enough along x. */
const right = (least: number): Mesh => {
  const x = (corner: number) => cage.positions[3 * cage.indices[corner]!]! / 3;
  const isTaken = (first: number) => x(first) + x(first + 1) + x(first + 2) > least;
  return { ...cage, indices: (cage.indices as Uint32Array).filter((_, i) => isTaken(i - (i % 3))) };
};

before(async () => {
  await MeshoptDecoder.ready;
  io.registerDependencies({ 'meshopt.decoder': MeshoptDecoder, 'draco3d.decoder': await draco.createDecoderModule() });
  write('front.glb', glbOf(right(0.1)));
  for (const [name, level] of Object.entries({ paint: 90, other: 200, 'tile.1001': 1, 'tile.1002': 2 }))
    write(`${name}.png`, png(level));
});

/** The overlays of a file: the name of their texture, and their triangles, each by the places of its corners. */
const overlaysIn = async (name: string) => overlaysOf(await io.read(name));
const overlaysOf = (document: Document) =>
  primitivesOf(document)
    .filter(isOverlay)
    .map((primitive) => {
      const positions = primitive.getAttribute('POSITION')!;
      const places = [...primitive.getIndices()!.getArray()!].map((v) =>
        positions
          .getElement(v, [] as number[])
          .map((x) => x.toFixed(4))
          .join(),
      );
      const triangles = places.flatMap((_, i) =>
        i % 3 === 0
          ? places
              .slice(i, i + 3)
              .sort()
              .join(' ')
          : [],
      );
      return { texture: primitive.getMaterial()!.getBaseColorTexture()!.getName(), triangles, primitive };
    });
/** The UV sets and zones of the base of a file. */
const addedTo = (document: Document) =>
  primitivesOf(document)
    .find((primitive) => !isOverlay(primitive))!
    .listSemantics()
    .filter((semantic) => /NCZ|TEXCOORD/.test(semantic))
    .sort()
    .join();

test('a glTF has its bytes and its images beside it, and is what the GLB is', async () => {
  mkdirSync('text');
  await ok(`${transfer} --texture paint.png -o whole.glb`);
  await ok(`${transfer} --texture paint.png -o`, 'text/my head.gltf');
  assert.deepEqual(readdirSync('text').sort(), ['my head-image0.png', 'my head.bin', 'my head.gltf']);
  assert.deepEqual(readFileSync('text/my head-image0.png'), png(90));
  const [[text], [whole]] = [await overlaysIn('text/my head.gltf'), await overlaysIn('whole.glb')];
  assert.deepEqual(text!.triangles, whole!.triangles);
  const own = JSON.parse(readFileSync('text/my head.gltf', 'utf8')) as ReturnType<typeof jsonOf>;
  assert.deepEqual([own.meshes, own.images![0]!.uri], [jsonOf('whole.glb').meshes, 'my%20head-image0.png']);
  // It can be read again, and what is beside it is not overwritten.
  await ok(
    'transfer',
    'text/my head.gltf',
    ...'--cage cage.glb --texture paint.png -o again.gltf --compress draco'.split(' '),
  );
  assert.ok(primitivesOf(await io.read('again.gltf')).length > 1);
  const overwrites = (name: string) => new RegExp(`${name} would overwrite .*${name}, which this command reads`);
  await fails(
    2,
    overwrites('my head-image0\\.png'),
    `${transfer} -o`,
    'text/my head.gltf',
    '--texture',
    'text/my head-image0.png',
  );
  const { json: around, bin } = unpackGlb(glbOf(cage));
  around.buffers![0]!.uri = 'painted.bin';
  write('painted.bin', bin);
  write('around.gltf', JSON.stringify(around));
  await fails(2, overwrites('painted\\.bin'), 'transfer target.glb --cage around.gltf -o painted.gltf');
  assert.deepEqual(readFileSync('painted.bin'), Buffer.from(bin));
  const twice = /twice\.bin would overwrite .*twice\.bin, which this command writes/;
  await fails(2, twice, `${transfer} -o twice.gltf --report twice.bin`);
  assert.ok(!readdirSync('.').some((name) => name.startsWith('twice')));
});

for (const borders of ['triangle', 'cut'])
  test(`a region paints what no cage before it paints (--borders ${borders})`, async () => {
    const front = `transfer target.glb --cage front.glb --texture paint.png --borders ${borders} ${loose}`;
    const alone = await json<Report>(`${front} -o alone.glb`);
    const report = await json<Report>(`${front} --region cage.glb=other.png -o regions.glb`);
    assert.deepEqual(report.triangles, alone.triangles);
    assert.ok(report.triangles.cosmetic > 0);
    assert.deepEqual(await validate('regions.glb'), []);
    const document = await io.read('regions.glb');
    const [first, second, ...others] = overlaysOf(document);
    assert.deepEqual([first!.texture, second!.texture, others.length], ['paint.png', 'other.png', 0]);
    const taken = new Set(first!.triangles);
    if (borders === 'triangle') assert.deepEqual(first!.triangles, (await overlaysIn('alone.glb'))[0]!.triangles);
    assert.ok(second!.triangles.length > 0 && second!.triangles.every((triangle) => !taken.has(triangle)));
    const [{ uvSet, zones, triangles }] = report.regions as [Report['regions'][number]];
    assert.deepEqual([uvSet, zones, triangles.cosmetic], ['TEXCOORD_1', '_NCZ_1', second!.triangles.length]);
    assert.equal(addedTo(document), 'TEXCOORD_0,TEXCOORD_1,_NCZ,_NCZ_1');
    const base = primitivesOf(document).find((primitive) => !isOverlay(primitive))!;
    assert.equal(second!.primitive.getAttribute('TEXCOORD_0'), base.getAttribute('TEXCOORD_1'));
  });

test('the files of a region may be in folders with = in their names', async () => {
  mkdirSync('run=3');
  for (const name of ['cage.glb', 'other.png']) write(`run=3/${name}`, readFileSync(name));
  const region = '--region run=3/cage.glb=run=3/other.png';
  const report = await json<Report>(`transfer target.glb --cage front.glb ${region} -o of-folders.glb`);
  assert.equal(report.regions[0]!.cage, 'run=3/cage.glb');
});

for (const [form, extension] of [
  ['none', undefined],
  ['meshopt', 'EXT_meshopt_compression'],
  ['draco', 'KHR_draco_mesh_compression'],
] as const)
  test(`regions keep the compression, and painting again takes the place of the paint before (--compress ${form})`, async () => {
    await ok(`${transfer} --compress ${form} -o small.glb`);
    const front = `transfer small.glb --cage front.glb --texture paint.png ${loose} --region cage.glb=other.png`;
    await ok(`${front} -o once.glb`);
    assert.equal((await overlaysIn('once.glb')).length, 2);
    assert.deepEqual(await validate('once.glb'), []);
    assert.equal(jsonOf('once.glb').extensionsUsed?.[0], extension);
    const again = await ok('transfer once.glb --cage cage.glb --texture other.png -o twice.glb');
    assert.match(again, /; took away 2 overlays of an earlier transfer\n/);
    const document = await io.read('twice.glb');
    assert.deepEqual(
      overlaysOf(document).map(({ texture }) => texture),
      ['other.png'],
    );
    assert.equal(addedTo(document), 'TEXCOORD_0,_NCZ');
    const listsIn = (name: string) =>
      (['materials', 'textures', 'images'] as const).map((list) => jsonOf(name)[list]?.length);
    assert.deepEqual(listsIn('twice.glb'), [1, 1, 1]);
    assert.deepEqual(await validate('twice.glb'), []);
    await ok('transfer twice.glb --cage cage.glb -o bare.glb');
    assert.deepEqual(await overlaysIn('bare.glb'), []);
    assert.deepEqual(listsIn('bare.glb'), [undefined, undefined, undefined]);
  });

test('with <UDIM> in its name, each tile of the cage shows its own texture', async () => {
  // The left half of the texture is tile 1001, the right one 1002.
  write('tiled.glb', glbOf(uvsMoved((u, v) => [2 * u, v])));
  const tiled = (name: string) => `transfer target.glb --cage ${name}.glb --texture tile.<UDIM>.png -o tiled-out.glb`;
  await ok(tiled('tiled'));
  assert.deepEqual(await validate('tiled-out.glb'), []);
  const overlays = await overlaysIn('tiled-out.glb');
  assert.deepEqual(
    overlays.map(({ texture }) => texture),
    ['tile.1001.png', 'tile.1002.png'],
  );
  for (const [i, { primitive }] of overlays.entries()) {
    const uvs = primitive.getAttribute('TEXCOORD_0')!;
    const us = [...primitive.getIndices()!.getArray()!].map((v) => uvs.getElement(v, [] as number[])[0]!);
    for (let c = 0; c < us.length; c += 3) assert.equal(Math.floor((us[c]! + us[c + 1]! + us[c + 2]!) / 3), i);
  }
  await ok(`${transfer} --texture paint.png -o plain.glb`);
  const all = overlays.flatMap(({ triangles }) => triangles);
  assert.deepEqual(all.sort(), [...(await overlaysIn('plain.glb'))[0]!.triangles].sort());
  for (const [move, message] of [
    // In glTF, v grows downwards: the tile above is at −1..0.
    [(u, v) => [u, v - 1], /tile\.1011\.png: no such file \(wrong\.glb uses the tile 1011\)/],
    [(u, v) => [u + 0.47, v], /wrong\.glb: .* \("only"\), triangle \d+ is in more than one UDIM tile: its UVs are /],
    [(u, v) => [u, v + 1], /wrong\.glb: meshes\[0\]\.primitives\[0\] .*triangle 0 is in no UDIM tile: its UVs are /],
  ] as [(u: number, v: number) => [number, number], RegExp][]) {
    write('wrong.glb', glbOf(uvsMoved(move)));
    await fails(1, message, tiled('wrong'));
  }
});

test('uvBounds: the texture covers a part of the UVs, and nothing is painted outside', async () => {
  await ok(`${transfer} --texture paint.png -o whole.glb`);
  const bounds = '--set uvBounds=0.25,0.2,0.75,0.6 --texture paint.png';
  await ok(`${transfer} ${bounds} -o part.glb`);
  assert.deepEqual(await validate('part.glb'), []);
  const [[before], [after]] = [await overlaysIn('whole.glb'), await overlaysIn('part.glb')];
  assert.ok(after!.triangles.length > 0 && after!.triangles.length < before!.triangles.length);
  assert.ok(after!.triangles.every((triangle) => before!.triangles.includes(triangle)));
  assert.deepEqual(jsonOf('part.glb').samplers, [{ wrapS: 33071, wrapT: 33071 }]);
  // The same corner is at the same place of the cage's UVs.
  const uvOf = ({ primitive }: NonNullable<typeof before>, i: number) =>
    primitive.getAttribute('TEXCOORD_0')!.getElement(primitive.getIndices()!.getArray()![i]!, [] as number[]);
  const [old, own] = [uvOf(before!, 3 * before!.triangles.indexOf(after!.triangles[0]!)), uvOf(after!, 0)];
  assert.ok(Math.abs(own[0]! - (old[0]! - 0.25) / 0.5) < 1e-3 && Math.abs(own[1]! - (old[1]! - 0.2) / 0.4) < 1e-3);
  // A region has what the bounds leave.
  const { triangles, regions } = await json<Report>(`${transfer} ${bounds} --region cage.glb=other.png -o both.glb`);
  const counts = (await overlaysIn('both.glb')).map((overlay) => overlay.triangles.length);
  assert.deepEqual([triangles.cosmetic, regions[0]!.triangles.cosmetic], counts);
  assert.deepEqual(counts, [after!.triangles.length, before!.triangles.length - after!.triangles.length]);
  const bare = await ok(`${transfer} --texture paint.png --exclude * -o part.glb`);
  assert.match(bare, /_NCZ; no overlay, as the texture shows nowhere/);
  await fails(1, 'cage.glb: no triangle has UVs within the bounds 5, 5, 6, 6', `${transfer} --set uvBounds=5,5,6,6`);
});

test('whether a cage fits has nothing to do with what the texture covers, but with where there is none', async () => {
  const inspected = async (flags: string) => {
    const { verdict, findings } = await json<{ verdict: string; findings: object[] }>(`inspect target.glb ${flags}`);
    return [verdict, findings];
  };
  const plain = await inspected('--cage cage.glb');
  assert.deepEqual(await inspected('--cage cage.glb --set uvBounds=0.45,0.45,0.5,0.5'), plain);
  write('beside.glb', glbOf(uvsMoved((u, v) => [u + 1.1, v])));
  assert.match(JSON.stringify(await inspected('--cage beside.glb')), /uvsOutside/);
  write('four.glb', glbOf(uvsMoved((u, v) => [4 * u, 4 * v])));
  assert.deepEqual(await inspected('--cage four.glb --set uvBounds=0,0,4,4'), plain);
});

for (const borders of ['triangle', 'cut'])
  test(`the report of uvBounds counts what is painted (--borders ${borders})`, async () => {
    const flags = `--texture paint.png --borders ${borders} -o part.glb`;
    await ok(`${transfer} ${flags} --report whole.json`);
    const bounds = '--set uvBounds=0.25,0.2,0.75,0.6 --set referenceCage=cage.glb';
    const text = await ok(`${transfer} ${flags} ${bounds} --report part.json`);
    const [before, after] = ['whole', 'part'].map((name) => JSON.parse(readFileSync(`${name}.json`, 'utf8')) as Report);
    const { cosmetic, outOfBounds } = (after!.cut ?? after!).triangles;
    assert.equal(cosmetic, (await overlaysIn('part.glb'))[0]!.triangles.length);
    assert.equal(after!.triangles.cosmetic + after!.triangles.outOfBounds!, before!.triangles.cosmetic);
    assert.match(text, new RegExp(`\n${after!.triangles.cosmetic} of \\d+ triangles may be painted`));
    const more = `\n${outOfBounds!.toLocaleString('en')} more could be painted, but lie outside of uvBounds;`;
    assert.ok(text.includes(more), text);
    assert.deepEqual(after!.counts, before!.counts, 'the zones are those of the cage');
    const { uvBounds, referenceCage } = after!.options;
    assert.deepEqual([uvBounds, referenceCage], [[0.25, 0.2, 0.75, 0.6], 'cage.glb']);
    assert.ok(!('uvBounds' in before!.options || 'referenceCage' in before!.options), 'options that are not given');
    assert.match((await run('diff whole.json part.json')).stdout, /\n +triangles painted /);
    const unwritten = await json<Report>(`${transfer} ${bounds}`);
    assert.deepEqual(unwritten.triangles, after!.triangles);
  });

test('referenceCage: triangles whose UVs it lacks count as cut away', async () => {
  const kept = right(0);
  write('kept.glb', glbOf(kept));
  const cut = await json<Report>(`transfer target.glb --cage kept.glb ${loose}`);
  // The reference may have another form: only its UVs matter.
  write('reference.glb', glbOf({ ...kept, positions: kept.positions.map((x) => 3 * x + 1) }));
  const referred = await json<Report>(`${transfer} --set referenceCage=reference.glb ${loose}`);
  assert.deepEqual([referred.counts, referred.triangles], [cut.counts, cut.triangles]);
  const whole = await json<Report>(`${transfer} --set referenceCage=cage.glb ${loose}`);
  assert.deepEqual(whole.counts, (await json<Report>(`${transfer} ${loose}`)).counts);
  write('mirrored.glb', glbOf(uvsMoved((u, v) => [1 - u, v])));
  const mirrored = `transfer target.glb --cage mirrored.glb --set referenceCage=mirrored.glb ${loose}`;
  assert.deepEqual((await json<Report>(mirrored)).counts, whole.counts);
  write('away.glb', glbOf(uvsMoved((u, v) => [u + 7, v])));
  const none = 'cage.glb: none of its triangles has UVs that the reference cage away.glb has';
  await fails(1, none, 'inspect target.glb --cage cage.glb --set referenceCage=away.glb');
  await fails(1, /target\.glb: .* has no TEXCOORD_0/, `${transfer} --set referenceCage=target.glb`);
});
