import assert from 'node:assert/strict';
import { spawnSync } from 'node:child_process';
import { existsSync, mkdirSync, readFileSync, rmSync, writeFileSync } from 'node:fs';
import { join } from 'node:path';
import { before, test } from 'node:test';
import { Document, type GLTF, NodeIO } from '@gltf-transform/core';
import { ALL_EXTENSIONS, KHRTextureTransform } from '@gltf-transform/extensions';
import { init, transfer } from 'cagecast';
import { cagecast as cagecastTransform } from 'cagecast/gltf';
import draco from 'draco3dgltf';
import { MeshoptDecoder } from 'meshoptimizer';
import { PNG } from 'pngjs';
import { cagecast, GlbMaker, glbOf, tetrahedron, unpackGlb, validate } from '../../support/gltf.js';
import { temporaryFolder } from '../../support/temporary.js';
import { head } from '../scenes.js';

const { at } = temporaryFolder('features');
const scene = head(5, 12);
const target = { ...scene.target, groups: undefined };
const cage = ['--cage', at('cage.glb')];
let io: NodeIO;

before(async () => {
  await Promise.all([init(), MeshoptDecoder.ready]);
  io = new NodeIO().registerExtensions(ALL_EXTENSIONS).registerDependencies({
    'meshopt.decoder': MeshoptDecoder,
    'draco3d.decoder': await draco.createDecoderModule(),
  });
  writeFileSync(at('cage.glb'), glbOf(scene.cage));
  writeFileSync(at('target.glb'), glbOf(target));
});

const ok = (...args: string[]) => {
  const { status, stdout, stderr } = cagecast(...args);
  assert.deepEqual([status, stderr], [0, '']);
  return stdout;
};
const jsonOf = (name: string) => unpackGlb(readFileSync(at(name))).json;
const uvsOf = (document: Document, set: string) => {
  const accessor = document.getRoot().listMeshes()[0]!.listPrimitives()[0]!.getAttribute(set)!;
  return Array.from({ length: accessor.getCount() }, (_, v) => accessor.getElement(v, []));
};

test('--compress writes the other forms, each from each', async () => {
  ok('transfer', at('target.glb'), ...cage, '-o', at('draco.glb'), '--compress', 'draco');
  ok('transfer', at('draco.glb'), ...cage, '-o', at('meshopt.glb'), '--compress', 'meshopt');
  ok('transfer', at('meshopt.glb'), ...cage, '-o', at('none.glb'), '--compress', 'none');
  for (const [name, extension] of [
    ['draco.glb', 'KHR_draco_mesh_compression'],
    ['meshopt.glb', 'EXT_meshopt_compression'],
    ['none.glb', undefined],
  ] as const) {
    const { extensionsRequired, extensionsUsed, buffers } = jsonOf(name);
    assert.deepEqual(
      [extensionsUsed, extensionsRequired],
      extension ? [[extension], [extension]] : [undefined, undefined],
    );
    assert.equal(buffers!.length, name === 'meshopt.glb' ? 2 : 1);
    assert.deepEqual(await validate(at(name)), []);
    const corners = (await io.read(at(name))).getRoot().listMeshes()[0]!.listPrimitives()[0]!.getIndices()!;
    assert.equal(corners.getCount(), target.indices.length, name);
  }
});

test('diff tells in a line which file is no report, and why', () => {
  ok('transfer', at('target.glb'), ...cage, '--report', at('whole.json'));
  const whole = JSON.parse(readFileSync(at('whole.json'), 'utf8')) as { target: object; segments: object[] };
  for (const [wrong, fault] of [
    [{ target: null }, 'target is null, not an object'],
    [{ target: { ...whole.target, diagonal: -1 } }, 'target.diagonal is -1, not a number from 0 on'],
    [{ areas: undefined }, 'areas is missing'],
    [{ segments: [null] }, 'segments[0] is null, not an object'],
    [{ segments: [whole.segments[0], { ...whole.segments[0], part: 5 }] }, 'segments[1].part is 5, not a text'],
    [{ parts: {} }, 'parts is {}, not an array'],
    [{ stretch: {} }, 'stretch.median is missing'],
    [{ regions: [{}] }, 'regions[0].counts is missing'],
    [{ verdict: 'bad' }, 'verdict is "bad", not one of unfit, usable, good'],
  ] as const) {
    writeFileSync(at('wrong.json'), JSON.stringify({ ...whole, ...wrong }));
    const { status, stdout, stderr } = cagecast('diff', at('whole.json'), at('wrong.json'));
    const text = 'is no report of cagecast transfer (--report) or inspect (--json)';
    assert.deepEqual([status, stdout, stderr], [1, '', `cagecast: ${at('wrong.json')}: ${text}: ${fault}\n`]);
  }
  const { stderr } = cagecast('diff', at('wrong.json'), at('whole.json'));
  assert.match(stderr, /^cagecast: .*wrong\.json: is no report of .*\n$/);
});

test('what there is one of is called so', () => {
  writeFileSync(at('one.glb'), glbOf(tetrahedron()));
  const one = ['--cage', at('one.glb')];
  assert.match(ok('transfer', at('one.glb'), ...one), /, 1 segment \(/);
  const { uvs, ...mesh } = tetrahedron();
  uvs.set([2, 2]);
  writeFileSync(at('out-of-bounds.glb'), glbOf({ ...mesh, uvs }));
  const { stdout } = cagecast('inspect', at('one.glb'), '--cage', at('out-of-bounds.glb'));
  assert.match(stdout, /; 1 vertex outside 0\.\.1; /);
});

test('- is the standard input and output; the summary goes beside it', () => {
  const run = (args: string[], input?: Uint8Array) =>
    spawnSync(process.execPath, ['dist/cli.js', ...args], { ...(input && { input }) });
  ok('transfer', at('target.glb'), ...cage, '-o', at('named.glb'));
  const piped = run(['transfer', '-', ...cage, '-o', '-'], readFileSync(at('target.glb')));
  assert.equal(piped.status, 0, piped.stderr.toString());
  assert.deepEqual(piped.stdout, readFileSync(at('named.glb')));
  assert.match(piped.stderr.toString(), /^-: [\d,]+ vertices/);
  const quiet = run(['transfer', '-', ...cage, '-o', '-', '--quiet'], readFileSync(at('target.glb')));
  assert.deepEqual([quiet.stderr.length, quiet.stdout.length], [0, piped.stdout.length]);
  const empty = run(['inspect', '-', ...cage], new Uint8Array());
  assert.deepEqual([empty.status, empty.stderr.toString()], [1, 'cagecast: -: the file is empty\n']);
  const twice = run(['transfer', '-', '--cage', '-']);
  assert.deepEqual([twice.status, twice.stderr.toString()], [2, 'cagecast: only one file can be the standard input\n']);
});

test('a standard output that does not take all of it is one line and exit code 1', () => {
  if (!existsSync('/dev/full')) return;
  const transfer = ['transfer', at('target.glb'), ...cage];
  const shell = (script: string, ...args: string[]) => {
    const command = ['-c', script, at('cut'), process.execPath, 'dist/cli.js', ...args];
    const { status, stderr } = spawnSync('bash', command, { encoding: 'utf8' });
    return [status, stderr];
  };
  const line = (reason: string) => `cagecast: the standard output: cannot be written (${reason}, write)\n`;
  for (const args of [[...transfer, '-o', '-'], [...transfer, '--json'], ['completion', 'bash'], ['help']]) {
    const full = shell('"$@" > /dev/full', ...args);
    assert.deepEqual(full, [1, line('ENOSPC: no space left on device')], args.join(' '));
    const cut = shell('ulimit -f 1; "$@" > "$0"', ...args); // takes the first bytes
    assert.deepEqual(cut, [1, line('EFBIG: file too large')], args.join(' '));
  }
  assert.equal(shell('"$@" > /dev/full', 'batch', at('target.glb'), ...cage)[0], 1);
  assert.equal(shell('"$@" > /dev/full', ...transfer, '-o', '-', '--report', at('beside.json'))[0], 1);
  assert.ok(!existsSync(at('beside.json')), 'all files are written, or none');
});

test('a descriptor is written to, not replaced', { skip: !existsSync('/dev/fd') }, () => {
  for (const [redirection, path] of [
    ['', '/dev/stdout'],
    ['2', '/dev/stderr'],
    ['3', '/dev/fd/3'],
    ['4', '/proc/self/fd/4'],
  ] as const) {
    if (path.startsWith('/proc') && !existsSync('/proc/self/fd')) continue;
    writeFileSync(at('log'), 'before\n');
    const args = ['transfer', at('target.glb'), ...cage, '--quiet', '--report', path];
    const script = `"$@" ${redirection}>> "$0"`;
    spawnSync('bash', ['-c', script, at('log'), process.execPath, 'dist/cli.js', ...args]);
    const text = readFileSync(at('log'), 'utf8');
    assert.ok(text.startsWith('before\n{'), `${path}: ${text.slice(0, 20)}`);
    assert.ok((JSON.parse(text.slice(7)) as { counts: object }).counts, path);
  }
});

test('a reader that closes the pipe early changes neither the exit code nor what is written', () => {
  const shell = (...args: string[]) => {
    const command = ['-c', 'set -o pipefail; "$0" "$@" | true', process.execPath, 'dist/cli.js', ...args];
    const { status, stderr } = spawnSync('bash', command, { encoding: 'utf8' });
    return { status, stderr };
  };
  writeFileSync(at('far.glb'), glbOf({ ...target, positions: target.positions.map((x) => x + 9) }));
  assert.deepEqual(shell('inspect', at('far.glb'), ...cage), { status: 3, stderr: '' });
  const outputs = ['-o', at('read-{name}.glb'), '--workers', '1'];
  assert.equal(shell('batch', at('target.glb'), at('far.glb'), ...cage, ...outputs).status, 0);
  for (const name of ['read-target.glb', 'read-far.glb']) assert.ok(existsSync(at(name)), name);
});

test('--json and --quiet work on every command; help is a command', () => {
  const report = JSON.parse(ok('transfer', at('target.glb'), ...cage, '--json')) as { counts: object };
  const inspection = JSON.parse(ok('inspect', at('target.glb'), ...cage, '--json')) as { counts: object };
  assert.deepEqual(report.counts, inspection.counts);
  assert.equal(ok('inspect', at('target.glb'), ...cage, '--quiet'), '');
  const made = cagecast('make', at('target.glb'), '-o', at('made.glb'), '--json', '--triangles', '200');
  assert.ok(['good', 'usable', 'unfit'].includes((JSON.parse(made.stdout) as { verdict: string }).verdict));
  assert.match(ok('help'), /Usage: cagecast/);
  assert.match(ok('help', 'transfer'), /--compress/);
  assert.match(
    ok('help', 'transfer').replace(/\s+/g, ' '),
    /as covered; a share of the target's diagonal, 0 to 1; default: 0\.0025, or 0 with --preset paper/,
  );
});

test('diff shows what changed between two reports, and exits 4 over the limit', () => {
  const report = (name: string, ...flags: string[]) =>
    ok('transfer', at('target.glb'), ...cage, '--report', at(name), '--quiet', ...flags);
  report('a.json');
  report('b.json');
  report('c.json', '--exclude', 'only');
  assert.equal(ok('diff', at('a.json'), at('b.json')), 'nothing changed\n');
  const { status, stdout } = cagecast('diff', at('a.json'), at('c.json'));
  assert.equal(status, 4);
  assert.match(stdout, /area cosmetic +[\d.]+ % +0\.0 % +over/);
  assert.match(stdout, /part only: culled/);
  const { over, changes } = JSON.parse(cagecast('diff', at('a.json'), at('c.json'), '--json').stdout) as {
    over: number;
    changes: { measure: string; isOver: boolean }[];
  };
  assert.equal(over, changes.filter(({ isOver }) => isOver).length);
  assert.equal(cagecast('diff', at('a.json'), at('c.json'), '--tolerance', '1', '--quiet').status, 0);
  // A cage with half of the texture: all of it is stretched twice as much.
  writeFileSync(at('half.glb'), glbOf({ ...scene.cage, uvs: scene.cage.uvs!.map((x) => x / 2) }));
  ok('transfer', at('target.glb'), '--cage', at('half.glb'), '--report', at('half.json'), '--quiet');
  const stretched = JSON.parse(cagecast('diff', at('a.json'), at('half.json'), '--json').stdout) as {
    changes: { measure: string; before: number; after: number; isOver: boolean }[];
  };
  const median = stretched.changes.find(({ measure }) => measure === 'stretch, median')!;
  assert.ok(median.isOver && Math.abs(median.after / median.before - 2) < 1e-4);
  const { stretch } = JSON.parse(readFileSync(at('a.json'), 'utf8')) as { stretch: Record<string, number> };
  assert.ok(stretch['median']! > 0 && stretch['p95']! >= stretch['median']! && stretch['overTwice']! < 0.5);
  writeFileSync(
    at('worse.json'),
    ok('inspect', at('target.glb'), ...cage, '--json').replace(/"verdict": "\w+"/, '"verdict": "unfit"'),
  );
  writeFileSync(at('same.json'), ok('inspect', at('target.glb'), ...cage, '--json'));
  const worse = cagecast('diff', at('same.json'), at('worse.json'));
  assert.equal(worse.status, 4);
  assert.match(worse.stdout, /verdict +(good|usable) +unfit +over/);
  // A report of the same by another command: shares differ in digits that nobody sees.
  assert.equal(ok('diff', at('a.json'), at('same.json')), 'nothing changed\n');
  const region = (cosmetic: number) => {
    const counts = { cosmetic, occluded: 10 - cosmetic, uncovered: 0, culled: 0 };
    return {
      cage: 'c.glb',
      texture: 'c.png',
      uvSet: null,
      zones: '_NCZ_2',
      counts,
      triangles: { total: 10, cosmetic },
    };
  };
  for (const [name, regions] of Object.entries({ none: [], five: [region(5)], two: [region(2)] })) {
    const report = JSON.parse(readFileSync(at('a.json'), 'utf8')) as object;
    writeFileSync(at(`regions-${name}.json`), JSON.stringify({ ...report, regions }));
  }
  const regions = cagecast('diff', at('regions-five.json'), at('regions-two.json'));
  assert.equal(regions.status, 4);
  assert.match(regions.stdout, /region 1: triangles painted +50\.0 % +20\.0 % +over/);
  assert.match(regions.stdout, /region 1: vertices occluded +50\.0 % +80\.0 % +over/);
  assert.match(cagecast('diff', at('regions-five.json'), at('regions-none.json')).stdout, /region 1 +there +– +over/);
  assert.equal(ok('diff', at('same.json'), at('regions-five.json')), 'nothing changed\n');
  const wrong = cagecast('diff', at('a.json'), at('target.glb'));
  assert.deepEqual([wrong.status, wrong.stdout], [1, '']);
  assert.match(wrong.stderr, /^cagecast: .*target\.glb: is not JSON/);
});

test('diff compares the reports of two folders: what changed, is gone and is new', () => {
  const report = (name: string, ...flags: string[]) =>
    ok('transfer', at('target.glb'), ...cage, '--report', at(name), '--quiet', ...flags);
  for (const folder of ['approved/deep', 'build/deep', 'none']) mkdirSync(at(folder), { recursive: true });
  for (const name of [
    'approved/same.json',
    'build/same.json',
    'approved/other.json',
    'approved/gone.json',
    'build/new.json',
    'approved/deep/same.json',
    'build/deep/same.json',
    'approved/deep/gone.json',
  ])
    report(name);
  report('build/other.json', '--exclude', 'only');
  const { status, stdout } = cagecast('diff', at('approved'), at('build'));
  assert.equal(status, 4);
  assert.match(stdout, /^other\.json\n +before +after/);
  assert.match(
    stdout,
    /\ngone: deep.gone\.json\ngone: gone\.json\nnew: new\.json\n3 reports compared: 1 changed, 1 over the limit; 2 gone, 1 new\n$/,
  );
  const found = JSON.parse(cagecast('diff', at('approved'), at('build'), '--json').stdout) as {
    over: number;
    reports: { name: string; over: number }[];
    gone: string[];
    new: string[];
  };
  assert.deepEqual([found.gone, found.new], [[join('deep', 'gone.json'), 'gone.json'], ['new.json']]);
  assert.equal(found.over, 2 + found.reports.find(({ name }) => name === 'other.json')!.over);
  // A report that is gone is a change by itself; a new one is not.
  for (const name of ['approved/gone.json', 'approved/deep/gone.json', 'approved/other.json', 'build/other.json'])
    rmSync(at(name));
  assert.match(ok('diff', at('approved'), at('build')), /^new: new\.json\n2 reports compared: 0 changed/);
  assert.equal(cagecast('diff', at('build'), at('approved')).status, 4);
  for (const [before, after, message] of [
    ['approved', 'build/same.json', /approved: is a folder, and the other is a file/],
    ['approved', 'none', /none: has no reports \(\*\.json\)/],
    ['approved', 'nowhere', /nowhere/],
  ] as const) {
    const wrong = cagecast('diff', at(before), at(after));
    assert.deepEqual([wrong.status, wrong.stdout], [1, '']);
    assert.match(wrong.stderr, message);
  }
});

test('a VRM stays one: what it says of its avatar is not changed', () => {
  const maker = new GlbMaker();
  const mesh = maker.mesh(target, { material: 0 });
  const own = maker.json;
  own.materials = [
    { name: 'skin', extensions: { VRMC_materials_mtoon: { specVersion: '1.0', shadeColorFactor: [0.1, 0.25, 1] } } },
  ];
  maker.node({ mesh, name: 'Face', extensions: { VRMC_node_constraint: { specVersion: '1.0' } } });
  own.extensions = {
    VRMC_vrm: {
      specVersion: '1.0',
      meta: { name: 'Ünïcode', authors: ['a', 'b'] },
      humanoid: { humanBones: { head: { node: 0 } } },
      expressions: { preset: { happy: { morphTargetBinds: [{ node: 0, index: 0, weight: 0.3 }] } } },
    },
    VRMC_springBone: { springs: [{ joints: [{ node: 0, stiffness: 1e-7 }] }] },
  };
  own.extensionsUsed = ['VRMC_vrm', 'VRMC_springBone', 'VRMC_materials_mtoon', 'VRMC_node_constraint'];
  writeFileSync(at('in.vrm'), maker.finish());
  ok('transfer', at('in.vrm'), ...cage, '-o', at('out.vrm'));
  const [before, after] = [jsonOf('in.vrm'), jsonOf('out.vrm')];
  for (const part of ['extensions', 'extensionsUsed', 'materials', 'nodes'] as const)
    assert.equal(JSON.stringify(after[part]), JSON.stringify(before[part]), part);
  assert.match(cagecast('transfer', at('in.vrm'), ...cage, '-o', at('out.obj')).stderr, /must end in \.glb or \.vrm/);
});

test('a WebP texture is a WebP texture in the file', async () => {
  // The smallest lossless WebP: 1 × 1 pixel.
  const webp = Buffer.from('UklGRhoAAABXRUJQVlA4TA0AAAAvAAAAEAcQERGIiP4HAA==', 'base64');
  writeFileSync(at('paint.webp'), webp);
  ok('transfer', at('target.glb'), ...cage, '--texture', at('paint.webp'), '-o', at('webp.glb'));
  assert.deepEqual(await validate(at('webp.glb')), []);
  assert.deepEqual(jsonOf('webp.glb').extensionsRequired, ['EXT_texture_webp']);
  const [texture] = (await io.read(at('webp.glb'))).getRoot().listTextures();
  assert.deepEqual([texture!.getMimeType(), Buffer.from(texture!.getImage()!)], ['image/webp', webp]);
  writeFileSync(at('half.webp'), webp.subarray(0, 20));
  const half = cagecast('transfer', at('target.glb'), ...cage, '--texture', at('half.webp'), '-o', at('never.glb'));
  assert.match(half.stderr, /half\.webp: is truncated: the WebP image is incomplete/);
  assert.ok(!existsSync(at('never.glb')));
});

test('KHR_texture_transform on the cage is applied: scaled, rotated, moved; by the UV set that it names', async () => {
  const document = new Document();
  const buffer = document.createBuffer();
  const [extension, texture] = [document.createExtension(KHRTextureTransform), document.createTexture('drawn')];
  texture.setMimeType('image/png').setImage(new Uint8Array(8));
  const accessor = (array: Float32Array | Uint32Array, type: 'VEC3' | 'VEC2' | 'SCALAR') =>
    document
      .createAccessor()
      .setType(type)
      .setArray(array.slice() as Float32Array<ArrayBuffer>)
      .setBuffer(buffer);
  const material = document.createMaterial().setBaseColorTexture(texture);
  const transform = extension
    .createTransform()
    .setOffset([0.5, 0.9])
    .setRotation(Math.PI / 2)
    .setScale([0.5, 0.25]);
  material.getBaseColorTextureInfo()!.setExtension('KHR_texture_transform', transform.setTexCoord(1));
  const primitive = document
    .createPrimitive()
    .setAttribute('POSITION', accessor(scene.cage.positions as Float32Array, 'VEC3'))
    .setAttribute('TEXCOORD_0', accessor(new Float32Array(scene.cage.uvs!.length), 'VEC2'))
    .setAttribute('TEXCOORD_1', accessor(scene.cage.uvs as Float32Array, 'VEC2'))
    .setIndices(accessor(scene.cage.indices as Uint32Array, 'SCALAR'))
    .setMaterial(material);
  document.createScene().addChild(document.createNode().setMesh(document.createMesh().addPrimitive(primitive)));
  await io.write(at('turned.glb'), document);
  ok('transfer', at('target.glb'), '--cage', at('turned.glb'), '--seams', 'vertex', '-o', at('turned-out.glb'));
  const { uvs } = transfer(scene.cage, target, { seams: 'vertex' });
  const expected = Array.from({ length: uvs.length / 2 }, (_, v) => [
    0.5 + 0.25 * uvs[2 * v + 1]!,
    0.9 - 0.5 * uvs[2 * v]!,
  ]);
  const near = (is: number[][], what: string) =>
    is.forEach((uv, v) => {
      for (const k of [0, 1])
        assert.ok(Math.abs(uv[k]! - expected[v]![k]!) < 1e-4, `${what}: ${uv} of vertex ${v} is not ${expected[v]}`);
    });
  near(uvsOf(await io.read(at('turned-out.glb')), 'TEXCOORD_1'), 'command');
  const own = await io.read(at('target.glb'));
  await own.transform(cagecastTransform({ cage: document, seams: 'vertex' }));
  near(uvsOf(own, 'TEXCOORD_1'), 'function');
});

test('the UVs of a cage are those of its base colour texture, the first ones without a texture', async () => {
  const cageWith = (name: string, texture: object | undefined, sets = [0, 1]) => {
    const maker = new GlbMaker();
    const { positions, indices, uvs } = scene.cage;
    const attributes: GLTF.IMeshPrimitive['attributes'] = { POSITION: maker.accessor(positions, 'VEC3') };
    for (const set of sets)
      attributes[`TEXCOORD_${set}`] = maker.accessor(set === 0 ? uvs!.map((x) => x / 2) : uvs!.slice(), 'VEC2');
    const primitive = { attributes, indices: maker.accessor(Uint32Array.from(indices), 'SCALAR'), material: 0 };
    maker.node({ mesh: maker.json.meshes.push({ primitives: [primitive] }) - 1, name: 'around' });
    const image = PNG.sync.write(new PNG({ width: 1, height: 1 }));
    maker.json.images = [{ uri: `data:image/png;base64,${image.toString('base64')}` }];
    maker.json.textures = [{ source: 0 }];
    maker.json.materials = [{ pbrMetallicRoughness: texture ? { baseColorTexture: { index: 0, ...texture } } : {} }];
    writeFileSync(at(name), maker.finish());
    return at(name);
  };
  for (const [name, texture, factor] of [
    ['second.glb', { texCoord: 1 }, 1],
    ['first.glb', {}, 0.5],
    ['bare.glb', undefined, 0.5],
  ] as const) {
    const expected = transfer({ ...scene.cage, uvs: scene.cage.uvs!.map((x) => x * factor) }, target, {
      seams: 'vertex',
    }).uvs;
    const path = cageWith(name, texture);
    ok('transfer', at('target.glb'), '--cage', path, '--seams', 'vertex', '-o', at('second-out.glb'));
    const written = uvsOf(await io.read(at('second-out.glb')), 'TEXCOORD_1').flat();
    const first = written.slice(0, expected.length);
    assert.ok(
      first.every((x, i) => Math.abs(x - expected[i]!) < 1e-4),
      name,
    );
    let found: Float32Array | undefined;
    const document = await io.read(at('target.glb'));
    const onResult = ({ uvs }: { uvs: Float32Array }) => void (found = uvs);
    await document.transform(cagecastTransform({ cage: await io.read(path), seams: 'vertex', onResult }));
    assert.deepEqual(found, expected, name);
  }
  const { status, stderr } = cagecast(
    'transfer',
    at('target.glb'),
    '--cage',
    cageWith('lacking.glb', { texCoord: 1 }, [0]),
  );
  assert.equal(status, 1);
  assert.match(
    stderr,
    /lacking\.glb: meshes\[0\]\.primitives\[0\] \("around"\) has no TEXCOORD_1: the texture is drawn/,
  );
});
