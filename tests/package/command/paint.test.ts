import assert from 'node:assert/strict';
import { mkdirSync, readdirSync, readFileSync, writeFileSync } from 'node:fs';
import { before, test } from 'node:test';
import { type Document, NodeIO, type Primitive } from '@gltf-transform/core';
import { ALL_EXTENSIONS } from '@gltf-transform/extensions';
import type { Mesh } from 'cagecast';
import draco from 'draco3dgltf';
import { MeshoptDecoder } from 'meshoptimizer';
import { PNG } from 'pngjs';
import { cagecast, glbOf, unpackGlb, validate } from '../../support/gltf.js';
import { ktx2Of } from '../../support/ktx2.js';
import { temporaryFolder } from '../../support/temporary.js';
import { head } from '../scenes.js';

const { folder, at } = temporaryFolder('paint');
const scene = head(5, 12);
const target = at('target.glb');
const cage = ['--cage', at('cage.glb')];
let io: NodeIO;

interface Report {
  counts: object;
  options: { uvBounds?: number[]; referenceCage?: string };
  triangles: { total: number; cosmetic: number; outOfBounds?: number };
  cut: { triangles: Report['triangles'] } | null;
  regions: { cage: string; uvSet: string; zones: string; triangles: { total: number; cosmetic: number } }[];
}

const png = (shade: number) => {
  const image = new PNG({ width: 4, height: 4 });
  image.data.fill(shade);
  return PNG.sync.write(image);
};
const uvsMoved = (mesh: Mesh, move: (u: number, v: number) => [number, number]): Mesh => ({
  ...mesh,
  uvs: mesh.uvs!.map((_, i) => move(mesh.uvs![i - (i % 2)]!, mesh.uvs![i - (i % 2) + 1]!)[i % 2]!),
});
/** Those triangles of a mesh whose centre a test takes. */
const some = (mesh: Mesh, isTaken: (centre: number[]) => boolean): Mesh => {
  const indices = mesh.indices as Uint32Array;
  const centre = (first: number) =>
    [0, 1, 2].map((k) => [0, 1, 2].reduce((sum, c) => sum + mesh.positions[3 * indices[first + c]! + k]! / 3, 0));
  return { ...mesh, indices: indices.filter((_, i) => isTaken(centre(i - (i % 3)))) };
};

before(async () => {
  await MeshoptDecoder.ready;
  io = new NodeIO().registerExtensions(ALL_EXTENSIONS).registerDependencies({
    'meshopt.decoder': MeshoptDecoder,
    'draco3d.decoder': await draco.createDecoderModule(),
  });
  writeFileSync(target, glbOf({ ...scene.target, groups: undefined, uvs: undefined }));
  writeFileSync(at('cage.glb'), glbOf(scene.cage));
  for (const [name, shade] of Object.entries({ paint: 90, other: 200, 'tile.1001': 1, 'tile.1002': 2 }))
    writeFileSync(at(`${name}.png`), png(shade));
});

const ok = (...args: string[]) => {
  const { status, stdout, stderr } = cagecast(...args);
  assert.deepEqual([status, stderr], [0, '']);
  return stdout;
};
const reportOf = (...args: string[]) => JSON.parse(ok('transfer', target, ...args, '--json')) as Report;
const primitivesOf = (document: Document): Primitive[] =>
  document
    .getRoot()
    .listMeshes()
    .flatMap((mesh) => mesh.listPrimitives());
/** The triangles of overlays, by the name of their texture: each by the places of its corners. */
const overlaysOf = (document: Document) =>
  primitivesOf(document)
    .filter((primitive) => primitive.getExtras()['cagecastOverlay'])
    .map((primitive) => {
      const [corners, positions] = [primitive.getIndices()!.getArray()!, primitive.getAttribute('POSITION')!];
      const places = [...corners].map((v) =>
        positions
          .getElement(v, [] as number[])
          .map((x) => x.toFixed(4))
          .join(),
      );
      const triangles = places.flatMap((_, i) =>
        i % 3 === 0
          ? [
              places
                .slice(i, i + 3)
                .sort()
                .join(' '),
            ]
          : [],
      );
      return { texture: primitive.getMaterial()!.getBaseColorTexture()!.getName(), triangles, primitive };
    });

test('a glTF has its bytes and its images beside it, and is what the GLB is', async () => {
  mkdirSync(at('text'));
  ok('transfer', target, ...cage, '--texture', at('paint.png'), '-o', at('whole.glb'));
  const out = at('text', 'my head.gltf');
  ok('transfer', target, ...cage, '--texture', at('paint.png'), '-o', out);
  assert.deepEqual(readdirSync(at('text')).sort(), ['my head-image0.png', 'my head.bin', 'my head.gltf']);
  assert.deepEqual(readFileSync(at('text', 'my head-image0.png')), png(90));
  const [text, whole] = [await io.read(out), await io.read(at('whole.glb'))];
  assert.deepEqual(overlaysOf(text)[0]!.triangles, overlaysOf(whole)[0]!.triangles);
  const { json } = unpackGlb(readFileSync(at('whole.glb')));
  const own = JSON.parse(readFileSync(out, 'utf8')) as typeof json;
  assert.deepEqual([own.meshes, own.images![0]!.uri], [json.meshes, 'my%20head-image0.png']);
  // It can be read again.
  ok('transfer', out, ...cage, '--texture', at('paint.png'), '-o', at('text', 'again.gltf'), '--compress', 'draco');
  assert.ok(primitivesOf(await io.read(at('text', 'again.gltf'))).length > 1);
  const clash = cagecast('transfer', target, ...cage, '--texture', at('text/my head-image0.png'), '-o', out);
  assert.match(clash.stderr, /my head-image0\.png: would be overwritten, but is read by this command/);
});

test('it is said where an overlay fills what a material cuts out', async () => {
  const document = await io.read(target);
  const cutOut = document.createMaterial('hair').setAlphaMode('MASK');
  const [first, ...others] = primitivesOf(document);
  first!.setMaterial(cutOut);
  await io.write(at('hair.glb'), document);
  const args = [at('hair.glb'), ...cage, '--texture', at('paint.png'), '-o', at('painted-hair.glb')];
  const { parts } = JSON.parse(ok('transfer', ...args, '--json')) as {
    parts: { fillsCutOuts: boolean }[];
  };
  assert.deepEqual(
    parts.map(({ fillsCutOuts }) => fillsCutOuts),
    [true, ...others.map(() => false)],
  );
  assert.match(
    ok('transfer', ...args),
    /\nthe overlay fills what the material cuts out of “[^”]+”; cagecast bake paints/,
  );
});

test('a KTX2 texture is the file as it is; what glTF cannot hold is an error', async () => {
  const ktx2 = Buffer.from(ktx2Of(200, 30, 60));
  const texture = (name: string, bytes: Uint8Array) => {
    writeFileSync(at(name), bytes);
    return cagecast('transfer', target, ...cage, '--texture', at(name), '-o', at('ktx2.glb'));
  };
  assert.equal(texture('paint.ktx2', ktx2).status, 0);
  assert.deepEqual(await validate(at('ktx2.glb')), []);
  assert.deepEqual(unpackGlb(readFileSync(at('ktx2.glb'))).json.extensionsRequired, ['KHR_texture_basisu']);
  const [found] = (await io.read(at('ktx2.glb'))).getRoot().listTextures();
  assert.deepEqual([found!.getMimeType(), Buffer.from(found!.getImage()!)], ['image/ktx2', ktx2]);
  assert.match(texture('half.ktx2', ktx2.subarray(0, 150)).stderr, /half\.ktx2: is truncated: the KTX2 image/);
  const plain = Buffer.from(ktx2);
  plain.writeUInt32LE(37, 12);
  assert.match(texture('plain.ktx2', plain).stderr, /that glTF cannot hold: vkFormat is 37, not 0 \(Basis Universal\)/);
  const odd = Buffer.from(ktx2);
  odd.writeUInt32LE(5, 20);
  assert.match(texture('odd.ktx2', odd).stderr, /it has 5 × 4 pixels, not multiples of 4/);
});

for (const borders of ['triangle', 'cut'])
  test(`a region paints what no cage before it paints (--borders ${borders})`, async () => {
    const front = some(scene.cage, ([x]) => x! > 0.1);
    writeFileSync(at('front.glb'), glbOf(front));
    const out = at(`regions-${borders}.glb`);
    const rules = ['--borders', borders, '--min-covered', '0', '--threshold', '0'];
    const alone = reportOf('--cage', at('front.glb'), ...rules, '-o', at('alone.glb'), '--texture', at('paint.png'));
    const region = ['--region', `${at('cage.glb')}=${at('other.png')}`];
    const report = reportOf('--cage', at('front.glb'), '--texture', at('paint.png'), ...region, ...rules, '-o', out);
    assert.deepEqual(report.triangles, alone.triangles);
    assert.ok(report.triangles.cosmetic > 0);
    assert.deepEqual(await validate(out), []);
    const document = await io.read(out);
    const [first, second, ...others] = overlaysOf(document);
    assert.deepEqual([first!.texture, second!.texture, others.length], ['paint.png', 'other.png', 0]);
    const taken = new Set(first!.triangles);
    if (borders === 'triangle')
      assert.deepEqual(first!.triangles, overlaysOf(await io.read(at('alone.glb')))[0]!.triangles);
    assert.ok(second!.triangles.length > 0 && second!.triangles.every((triangle) => !taken.has(triangle)));
    const [{ uvSet, zones, triangles }] = report.regions as [Report['regions'][number]];
    assert.deepEqual([uvSet, zones, triangles.cosmetic], ['TEXCOORD_1', '_NCZ_1', second!.triangles.length]);
    const base = primitivesOf(document).find((primitive) => !primitive.getExtras()['cagecastOverlay'])!;
    assert.deepEqual(
      base
        .listSemantics()
        .filter((semantic) => /NCZ|TEXCOORD/.test(semantic))
        .sort(),
      ['TEXCOORD_0', 'TEXCOORD_1', '_NCZ', '_NCZ_1'],
    );
    assert.equal(second!.primitive.getAttribute('TEXCOORD_0'), base.getAttribute('TEXCOORD_1'));
  });

test('the files of a region may be in folders with = in their names', () => {
  mkdirSync(at('run=3'));
  for (const name of ['cage.glb', 'other.png']) writeFileSync(at('run=3', name), readFileSync(at(name)));
  const region = ['--region', `${at('run=3', 'cage.glb')}=${at('run=3', 'other.png')}`];
  const report = reportOf('--cage', at('front.glb'), ...region, '-o', at('of-folders.glb'));
  assert.equal(report.regions[0]!.cage, at('run=3', 'cage.glb'));
  for (const wrong of [at('cage.glb'), `${at('cage.glb')}=`, '=paint.png'])
    assert.match(cagecast('transfer', target, ...cage, '--region', wrong).stderr, /with = between them/);
});

test('regions keep the compression of the file', async () => {
  const region = ['--region', `${at('cage.glb')}=${at('other.png')}`];
  for (const [form, extension] of [
    ['draco', 'KHR_draco_mesh_compression'],
    ['meshopt', 'EXT_meshopt_compression'],
  ] as const) {
    ok('transfer', target, ...cage, '--compress', form, '-o', at('small.glb'));
    const out = at(`regions-${form}.glb`);
    ok('transfer', at('small.glb'), '--cage', at('front.glb'), '--threshold', '0', ...region, '-o', out);
    assert.ok(unpackGlb(readFileSync(out)).json.extensionsUsed!.includes(extension));
    assert.deepEqual(await validate(out), []);
  }
});

for (const form of ['none', 'meshopt', 'draco'])
  test(`painting again takes the place of the paint before (--compress ${form})`, async () => {
    const region = ['--region', `${at('cage.glb')}=${at('other.png')}`];
    const [once, twice] = [at(`once-${form}.glb`), at(`twice-${form}.glb`)];
    const front = ['--cage', at('front.glb'), '--threshold', '0', '--min-covered', '0'];
    ok('transfer', target, ...front, '--texture', at('paint.png'), ...region, '--compress', form, '-o', once);
    assert.equal(overlaysOf(await io.read(once)).length, 2);
    const text = ok('transfer', once, ...cage, '--texture', at('other.png'), '-o', twice);
    assert.match(text, /; took away 2 overlays of an earlier transfer\n/);
    const document = await io.read(twice);
    assert.deepEqual(
      overlaysOf(document).map(({ texture }) => texture),
      ['other.png'],
    );
    const base = primitivesOf(document).find((primitive) => !primitive.getExtras()['cagecastOverlay'])!;
    assert.deepEqual(
      base
        .listSemantics()
        .filter((semantic) => /NCZ|TEXCOORD/.test(semantic))
        .sort(),
      ['TEXCOORD_0', '_NCZ'],
    );
    const { json } = unpackGlb(readFileSync(twice));
    assert.deepEqual([json.materials!.length, json.textures!.length, json.images!.length], [1, 1, 1]);
    assert.deepEqual(await validate(twice), []);
    const bare = at(`bare-${form}.glb`);
    ok('transfer', twice, ...cage, '-o', bare);
    assert.equal(overlaysOf(await io.read(bare)).length, 0);
    assert.deepEqual(
      (['materials', 'textures', 'images'] as const).map((list) => unpackGlb(readFileSync(bare)).json[list]),
      [undefined, undefined, undefined],
    );
  });

test('with <UDIM> in its name, each tile of the cage shows its own texture', async () => {
  // The left half of the texture is tile 1001, the right one 1002 but for its upper quarter, which is above it.
  writeFileSync(at('tiled.glb'), glbOf(uvsMoved(scene.cage, (u, v) => [2 * u, v])));
  const out = at('tiled-out.glb');
  ok('transfer', target, '--cage', at('tiled.glb'), '--texture', at('tile.<UDIM>.png'), '-o', out);
  assert.deepEqual(await validate(out), []);
  ok('transfer', target, ...cage, '--texture', at('paint.png'), '-o', at('plain.glb'));
  const overlays = overlaysOf(await io.read(out));
  assert.deepEqual(
    overlays.map(({ texture }) => texture),
    ['tile.1001.png', 'tile.1002.png'],
  );
  for (const [i, { primitive }] of overlays.entries()) {
    const uvs = primitive.getAttribute('TEXCOORD_0')!;
    const us = [...primitive.getIndices()!.getArray()!].map((v) => uvs.getElement(v, [] as number[])[0]!);
    for (let c = 0; c < us.length; c += 3) assert.equal(Math.floor((us[c]! + us[c + 1]! + us[c + 2]!) / 3), i);
  }
  const all = overlays.flatMap(({ triangles }) => triangles).sort();
  assert.deepEqual(all, [...overlaysOf(await io.read(at('plain.glb')))[0]!.triangles].sort());
  // In glTF, v grows downwards: the tile above is at −1..0.
  writeFileSync(at('above.glb'), glbOf(uvsMoved(scene.cage, (u, v) => [u, v - 1])));
  const above = cagecast('transfer', target, '--cage', at('above.glb'), '--texture', at('tile.<UDIM>.png'), '-o', out);
  assert.equal(above.status, 1);
  assert.match(above.stderr, /tile\.1011\.png: no such file \(.*above\.glb uses the tile 1011\)/);
  for (const [move, says] of [
    [
      (u: number, v: number): [number, number] => [u + 0.47, v],
      /triangle \d+ is in more than one UDIM tile: its UVs are /,
    ],
    [(u: number, v: number): [number, number] => [u, v + 1], /triangle 0 is in no UDIM tile: its UVs are /],
  ] as const) {
    writeFileSync(at('wrong.glb'), glbOf(uvsMoved(scene.cage, move)));
    const { stderr } = cagecast(
      'transfer',
      target,
      '--cage',
      at('wrong.glb'),
      '--texture',
      at('tile.<UDIM>.png'),
      '-o',
      out,
    );
    assert.match(stderr, says);
    assert.match(stderr, /wrong\.glb: meshes\[0\]\.primitives\[0\]/);
  }
});

test('--uv-bounds: the texture covers a part of the UVs, and nothing is painted outside', async () => {
  const [whole, part] = [at('unbounded.glb'), at('bounded.glb')];
  ok('transfer', target, ...cage, '--texture', at('paint.png'), '-o', whole);
  const bounds = ['--uv-bounds', '0.25,0.2,0.75,0.6'];
  ok('transfer', target, ...cage, ...bounds, '--texture', at('paint.png'), '-o', part);
  assert.deepEqual(await validate(part), []);
  const [before, after] = [overlaysOf(await io.read(whole))[0]!, overlaysOf(await io.read(part))[0]!];
  assert.ok(after.triangles.length > 0 && after.triangles.length < before.triangles.length);
  assert.ok(after.triangles.every((triangle) => before.triangles.includes(triangle)));
  const [sampler] = unpackGlb(readFileSync(part)).json.samplers!;
  assert.deepEqual(sampler, { wrapS: 33071, wrapT: 33071 });
  // The same corner is at the same place of the cage's UVs.
  const uvOf = ({ primitive }: typeof before, i: number) =>
    primitive.getAttribute('TEXCOORD_0')!.getElement(primitive.getIndices()!.getArray()![i]!, []);
  const i = before.triangles.indexOf(after.triangles[0]!);
  const [old, own] = [uvOf(before, 3 * i), uvOf(after, 0)];
  assert.ok(Math.abs(own[0]! - (old[0]! - 0.25) / 0.5) < 1e-3 && Math.abs(own[1]! - (old[1]! - 0.2) / 0.4) < 1e-3);
  // A region has what the bounds leave.
  const region = ['--region', `${at('cage.glb')}=${at('other.png')}`];
  const report = at('bounded.json');
  ok('transfer', target, ...cage, ...bounds, '--texture', at('paint.png'), ...region, '-o', part, '--report', report);
  const { triangles, regions } = JSON.parse(readFileSync(report, 'utf8')) as Report;
  assert.equal(triangles.cosmetic, after.triangles.length);
  assert.equal(triangles.cosmetic + regions[0]!.triangles.cosmetic, before.triangles.length);
  const both = overlaysOf(await io.read(part));
  assert.equal(both.length, 2);
  assert.equal(both[0]!.triangles.length + both[1]!.triangles.length, before.triangles.length);
  // Whether the cage fits has nothing to do with what the texture covers.
  const inspected = (...flags: string[]) => {
    const { verdict, findings } = JSON.parse(cagecast('inspect', target, ...cage, ...flags, '--json').stdout);
    return [verdict, findings];
  };
  assert.deepEqual(inspected('--uv-bounds', '0.45,0.45,0.5,0.5'), inspected());
  writeFileSync(at('beside.glb'), glbOf(uvsMoved(scene.cage, (u, v) => [u + 1.1, v])));
  assert.match(JSON.stringify(inspected('--cage', at('beside.glb'))), /uvsOutside/);
  writeFileSync(at('four.glb'), glbOf(uvsMoved(scene.cage, (u, v) => [4 * u, 4 * v])));
  assert.deepEqual(inspected('--cage', at('four.glb'), '--uv-bounds', '0,0,4,4'), inspected());
  const bare = cagecast('transfer', target, ...cage, '--texture', at('paint.png'), '--exclude', '*', '-o', part);
  assert.match(bare.stdout, /_NCZ; no overlay, as the texture shows nowhere/);
  for (const [value, code, says] of [
    ['0,0,1', 2, /It is not four numbers U0,V0,U1,V1 with U0 < U1 and V0 < V1/],
    ['1,0,0,1', 2, /It is not four numbers/],
    ['5,5,6,6', 1, /cage\.glb: no triangle has UVs within the bounds 5, 5, 6, 6/],
  ] as const) {
    const { status, stderr } = cagecast('transfer', target, ...cage, '--uv-bounds', value);
    assert.equal(status, code);
    assert.match(stderr, says);
  }
});

for (const borders of ['triangle', 'cut'])
  test(`the report of --uv-bounds counts what is painted (--borders ${borders})`, async () => {
    const [whole, part, out] = [at(`whole-${borders}.json`), at(`part-${borders}.json`), at(`part-${borders}.glb`)];
    const flags = [...cage, '--texture', at('paint.png'), '--borders', borders, '-o', out];
    ok('transfer', target, ...flags, '--report', whole);
    const bounds = ['--uv-bounds', '0.25,0.2,0.75,0.6', '--reference-cage', at('cage.glb')];
    const text = ok('transfer', target, ...flags, ...bounds, '--report', part);
    const [before, after] = [whole, part].map((path) => JSON.parse(readFileSync(path, 'utf8')) as Report);
    const painted = (report: Report) => (report.cut ?? report).triangles;
    assert.equal(painted(after!).cosmetic, overlaysOf(await io.read(out))[0]!.triangles.length);
    assert.equal(after!.triangles.cosmetic + after!.triangles.outOfBounds!, before!.triangles.cosmetic);
    assert.match(text, new RegExp(`\n${after!.triangles.cosmetic} of \\d+ triangles may be painted`));
    assert.match(
      text,
      new RegExp(
        `\n${painted(after!).outOfBounds!.toLocaleString('en')} more could be painted, but lie outside of --uv-bounds;`,
      ),
    );
    // The zones are the cage's.
    assert.deepEqual(after!.counts, before!.counts);
    assert.deepEqual(after!.options.uvBounds, [0.25, 0.2, 0.75, 0.6]);
    assert.equal(after!.options.referenceCage, at('cage.glb'));
    assert.ok(!('uvBounds' in before!.options || 'referenceCage' in before!.options), 'options that are not given');
    assert.match(cagecast('diff', whole, part).stdout, /\n +triangles painted /);
    // The same if nothing is written.
    if (borders === 'triangle') {
      assert.deepEqual(reportOf(...cage, ...bounds).triangles, after!.triangles);
      const { stdout } = cagecast('batch', target, '--report', at('line.json'), ...cage, ...bounds);
      assert.deepEqual((JSON.parse(stdout) as Report).triangles, after!.triangles);
    }
  });

test('--uv-bounds and tiles of UVs exclude each other', () => {
  const both = ['--texture', at('tile.<UDIM>.png'), '--uv-bounds', '0,0,1,1', '-o', at('both.glb')];
  const { status, stderr } = cagecast('transfer', target, ...cage, ...both);
  assert.deepEqual([status, /bounds of UVs cannot be given with a texture of <UDIM> tiles/.test(stderr)], [2, true]);
});

test('--reference-cage: triangles whose UVs it lacks count as cut away', () => {
  const isKept = (centre: number[]) => centre[0]! > 0;
  writeFileSync(at('kept.glb'), glbOf(some(scene.cage, isKept)));
  const flags = ['--threshold', '0', '--min-covered', '0'];
  const cut = reportOf('--cage', at('kept.glb'), ...flags) as Report & { counts: object };
  // The reference may have another form: only its UVs matter.
  const kept = some(scene.cage, isKept);
  writeFileSync(at('reference.glb'), glbOf({ ...kept, positions: kept.positions.map((x) => 3 * x + 1) }));
  const referred = reportOf(...cage, '--reference-cage', at('reference.glb'), ...flags) as typeof cut;
  assert.deepEqual([referred.counts, referred.triangles], [cut.counts, cut.triangles]);
  const whole = reportOf(...cage, '--reference-cage', at('cage.glb'), ...flags) as typeof cut;
  assert.deepEqual(whole.counts, (reportOf(...cage, ...flags) as typeof cut).counts);
  writeFileSync(at('far.glb'), glbOf(uvsMoved(scene.cage, (u, v) => [u + 7, v])));
  const far = cagecast('inspect', target, ...cage, '--reference-cage', at('far.glb'));
  assert.equal(far.status, 1);
  assert.match(far.stderr, /cage\.glb: none of its triangles has UVs that the reference cage .*far\.glb has/);
  const bare = cagecast('inspect', target, ...cage, '--reference-cage', target);
  assert.match(bare.stderr, /target\.glb: .* has no TEXCOORD_0/);
});

test('a manifest has regions, bounds and a reference', () => {
  const job = {
    target: 'target.glb',
    cage: 'front.glb',
    texture: 'paint.png',
    referenceCage: 'cage.glb',
    uvBounds: [0, 0, 1, 1],
    regions: [{ cage: 'cage.glb', texture: 'other.png' }],
    output: 'job.gltf',
    report: 'job.json',
    threshold: 0,
    minCovered: 0,
  };
  const lines = [
    job,
    { ...job, uvBounds: [0, 0] },
    { ...job, regions: ['cage.glb'] },
    { ...job, regions: [...job.regions, { cage: 'cage.glb' }] },
    { ...job, regions: {} },
    { ...job, texture: 'tile.<UDIM>.png' },
  ];
  writeFileSync(at('jobs.jsonl'), lines.map((line) => JSON.stringify(line)).join('\n'));
  const { stdout } = cagecast('batch', '--manifest', at('jobs.jsonl'));
  const found = stdout
    .trim()
    .split('\n')
    .map((line) => JSON.parse(line) as { status: string; error?: string });
  assert.deepEqual(found.map(({ status }) => status).sort(), ['done', ...Array(5).fill('failed')]);
  const errors = found.map(({ error }) => error ?? '').sort();
  assert.match(errors[1]!, /line 2 of .*: "uvBounds" is \[0,0\], not an array of four numbers/);
  assert.match(errors[2]!, /line 3 of .*: regions\[0\]: is "cage\.glb", not \{"cage": …, "texture": …\}$/);
  assert.match(errors[3]!, /line 4 of .*: regions\[1\]: has no "texture"$/);
  assert.match(errors[4]!, /line 5 of .*: "regions" is \{\}, not an array of \{"cage": …, "texture": …\}$/);
  assert.match(errors[5]!, /line 6 of .*: bounds of UVs cannot be given with a texture of <UDIM> tiles/);
  const report = JSON.parse(readFileSync(at('job.json'), 'utf8')) as Report;
  assert.equal(report.regions[0]!.uvSet, 'TEXCOORD_1');
  assert.ok(readdirSync(folder).includes('job-image1.png'));
});
