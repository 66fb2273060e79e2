// Files that strangers may send: each is refused with one clear line, or read at a cost in proportion to its size.
import assert from 'node:assert/strict';
import { execFileSync } from 'node:child_process';
import { chmodSync, existsSync, lstatSync, mkdirSync, readdirSync, readFileSync, rmSync, symlinkSync } from 'node:fs';
import { describe, test } from 'node:test';
import type { GLTF } from '@gltf-transform/core';
import type { CagecastError } from 'cagecast';
import { checkGltf } from 'cagecast/gltf';
import { cagecast, fails, ok, run } from '../support/command.js';
import { type Glb, glbOf, packGlb, tetrahedron, unpackGlb } from '../support/gltf.js';
import { png, workplace, write } from './command/workplace.js';

const { at } = workplace('hostile', { name: 'tetrahedra', cage: tetrahedron(1), target: tetrahedron(0.9) });
const transfer = 'transfer target.glb --cage cage.glb';
const whole = glbOf(tetrahedron(0.9), 'ball');
mkdirSync('asset');

function changed(change: (json: GLTF.IGLTF, glb: Glb) => void): Buffer {
  const glb = unpackGlb(whole);
  change(glb.json, glb);
  return packGlb(glb);
}

/** The accessor that positions (0), UVs (1) or indices (2) are in, no longer in the file, with another number of elements. */
function imply(accessor: number, count: number): Buffer {
  return changed(({ accessors = [] }) => {
    delete accessors[accessor]!.bufferView;
    accessors[accessor]!.count = count;
    if (accessor === 0) {
      delete accessors[1]!.bufferView;
      accessors[1]!.count = count;
    }
  });
}

/** A glTF whose JSON has this many levels. */
const nested = (levels: number) =>
  Buffer.from(`{"asset":{"version":"2.0"},"extras":${'{"a":'.repeat(levels - 1)}1${'}'.repeat(levels - 1)}}`);

/** Nodes that all show the mesh. */
const instances = (count: number) =>
  changed((json) => {
    json.nodes = Array.from({ length: count }, () => ({ mesh: 0 }));
    json.scenes![0]!.nodes = [...json.nodes.keys()];
  });

const compressed = (count: number, byteLength: number) =>
  changed((json) => {
    json.buffers!.push({ byteLength });
    const meshopt = { buffer: 0, byteOffset: 0, byteLength: 40, byteStride: 12, count, mode: 'ATTRIBUTES' };
    json.bufferViews![0] = { buffer: 1, byteLength, byteStride: 12, extensions: { EXT_meshopt_compression: meshopt } };
  });

/** @param uri  Where its buffer is. */
function gltf(uri: string, more: object = {}): string {
  const { json } = unpackGlb(whole);
  return JSON.stringify({ ...json, buffers: [{ byteLength: json.buffers![0]!.byteLength, uri }], ...more });
}

const files: [string, () => Uint8Array, RegExp][] = [
  [
    'positions that are not in the file',
    () => imply(0, 2 ** 24),
    /accessors\[0\] \(meshes\[0\]\.primitives\[0\]\.attributes\.POSITION\) has 16,777,216 elements that are not in the file; the limit "implied" is 1,000,000/,
  ],
  [
    'indices that are not in the file',
    () => imply(2, 3e7),
    /accessors\[2\] \(meshes\[0\]\.primitives\[0\]\.indices\) has 30,000,000 elements that are not/,
  ],
  [
    'a compressed view that holds more than its view',
    () => compressed(2 ** 27, 48),
    /bufferViews\[0\] \(compressed\) holds 1610612736 bytes, not the 48 of its view/,
  ],
  [
    'a compressed view that claims to hold gigabytes',
    () => compressed(2 ** 27, 12 * 2 ** 27),
    /decodes to [\d,]+ bytes, [\d,]+ times its size; the limit "expansion" is 100/,
  ],
  [
    'ten thousand instances',
    () => instances(10_000),
    /the positions of meshes\[0\] are in 10000 places of the scene; the limit "instances" is 1,000/,
  ],
  [
    'primitives that share their positions, ten thousand times',
    () =>
      changed(({ meshes = [] }) => {
        meshes[0]!.primitives = Array.from({ length: 10_000 }, () => meshes[0]!.primitives[0]!);
      }),
    /the positions of meshes\[0\] are in 1001 places/,
  ],
  [
    'accessors that share their bytes',
    () =>
      changed((json, glb) => {
        const byteLength = 2 ** 20;
        glb.bin = new Uint8Array(Buffer.concat([glb.bin, Buffer.alloc(byteLength)]));
        json.buffers![0]!.byteLength = glb.bin.length;
        json.bufferViews!.push({ buffer: 0, byteOffset: glb.bin.length - byteLength, byteLength });
        for (let a = 0; a < 200; ++a)
          json.accessors!.push({ bufferView: 3, componentType: 5126, count: byteLength / 4, type: 'SCALAR' });
      }),
    /decodes to 209,[\d,]+ bytes, 1\d\d times its size; the limit "expansion" is 100/,
  ],
  [
    'JSON that is nested deep',
    () => nested(5000),
    /its JSON is nested more than 1000 deep; the limit "nesting" is 1,000/,
  ],
  [
    'nodes that are nested deep',
    () =>
      changed((json) => {
        json.nodes = Array.from({ length: 5000 }, (_, n) => (n < 4999 ? { children: [n + 1] } : { mesh: 0 }));
      }),
    /nodes\[1000\] is on level 1001; the limit "nesting" is 1,000/,
  ],
];

describe('a file that demands too much', () => {
  for (const [name, make, message] of files) {
    test(`${name}: checkGltf names the element and the limit`, () => {
      assert.throws(
        () => checkGltf(make()),
        (error: CagecastError) => error.code === 'badArgument' && message.test(error.message),
      );
    });
  }

  test('the command refuses them with one line and writes nothing', async () => {
    for (const [, make, message] of files.filter((_, f) => [0, 2, 4, 7].includes(f))) {
      write('huge.glb', make());
      await fails(
        1,
        new RegExp(`^cagecast: huge\\.glb: .*${message.source}`),
        'transfer huge.glb --cage cage.glb -o never.glb',
      );
    }
    assert.ok(!existsSync('never.glb'), 'nothing is written');
  });

  test('zones that are not in the file are as many as the positions, and overlays are counted by themselves', () => {
    const zones = (count: number) =>
      changed(({ accessors = [], meshes = [] }) => {
        accessors.push({ componentType: 5121, type: 'SCALAR', count });
        meshes[0]!.primitives[0]!.attributes['_NCZ'] = accessors.length - 1;
      });
    const { count } = unpackGlb(whole).json.accessors![0]!;
    checkGltf(zones(count), { limits: { implied: 0 } });
    assert.throws(() => checkGltf(imply(0, count), { limits: { implied: 0 } }), /limit "implied"/);
    const painted = (overlays: number) =>
      changed((json) => {
        const [base] = json.meshes![0]!.primitives;
        const overlay = { ...base!, extras: { cagecastOverlay: true } };
        json.meshes![0]!.primitives.push(...Array.from({ length: overlays }, () => overlay));
        json.nodes = Array.from({ length: 600 }, () => ({ mesh: 0 }));
        json.scenes![0]!.nodes = [...json.nodes.keys()];
      });
    checkGltf(painted(1));
    assert.throws(() => checkGltf(painted(2)), /are in 1200 places/);
  });

  test('what stays within the limits is read, and limits can be set', async () => {
    for (const bytes of [imply(0, 1000), imply(2, 3000), instances(1000), nested(900)]) checkGltf(bytes);
    checkGltf(instances(1001), { limits: { instances: 2000 } });
    checkGltf(whole, { limits: { instances: undefined } });
    assert.throws(() => checkGltf(instances(3), { limits: { instances: 2 } }), /in 3 places .* "instances" is 2/);
    checkGltf(whole, { limits: { bytes: whole.length } });
    assert.throws(
      () => checkGltf(whole, { limits: { bytes: 100 } }),
      /checkGltf: has more than 100 bytes; the limit "bytes" is 100$/,
    );
    assert.throws(() => checkGltf(whole, { otherBytes: 2 ** 30 }), /the limit "bytes" is 1,073,741,824$/);
    assert.throws(() => checkGltf(whole, { limits: { bytes: -1 } }), /checkGltf: limits\.bytes = -1 is not a number/);
    assert.throws(
      () => checkGltf(whole, { limits: { vertices: 3 } as object }),
      /limits\.vertices = 3 .* one of bytes, nesting, instances, implied, expansion/,
    );
    assert.throws(
      () => checkGltf(whole, { limit: { instances: 0 } } as object),
      /^CagecastError: checkGltf: limit is not an option$/,
    );
    for (const otherBytes of [NaN, -1, '9999999'])
      assert.throws(
        () => checkGltf(whole, { otherBytes: otherBytes as number }),
        /checkGltf: otherBytes = .* is not a number ≥ 0/,
      );
    assert.throws(() => checkGltf('a.glb' as never), /checkGltf: bytes is "a\.glb", not a Uint8Array/);
    write('many.glb', instances(3));
    const many = 'transfer many.glb --cage cage.glb --limit';
    await fails(1, /many\.glb: .* in 3 places .* limit "instances" is 2\n/, `${many} instances=2`);
    await fails(1, 'many.glb: has more than 100 bytes; the limit "bytes" is 100', `${many} bytes=100`);
    await ok(`${many} instances=2 --limit instances=3`);
  });
});

describe('what a file refers to', { skip: process.platform === 'win32' && 'there are no pipes and devices' }, () => {
  const line = 'transfer asset/target.gltf --cage cage.glb -o out.glb';
  const refused = async (uri: string, message: RegExp, flags = '', more = {}) => {
    write('asset/target.gltf', gltf(uri, more));
    await fails(1, message, line + flags);
    assert.ok(!existsSync('out.glb'), uri);
  };

  test('devices and pipes are not read', async () => {
    execFileSync('mkfifo', ['asset/pipe.bin']);
    await refused('pipe.bin', /target\.gltf: buffers\[0\] is in pipe\.bin: is a device or a pipe, not a file/);
    await refused('/dev/zero', /is in \/dev\/zero: is a device or a pipe/, ' --allow-outside');
  });

  test('files outside its folder are read with --allow-outside only', async () => {
    write('secret.bin', unpackGlb(whole).bin);
    write('asset/own.bin', unpackGlb(whole).bin);
    write('secret.png', png(1, 1));
    symlinkSync('../secret.bin', 'asset/link.bin');
    const outside = /is outside the folder of the file that refers to it; --allow-outside permits it/;
    for (const uri of ['../secret.bin', '..%2fsecret.bin', at('secret.bin'), '/dev/zero', 'link.bin'])
      await refused(uri, outside);
    const images = [{ uri: '../secret.png' }];
    await refused('own.bin', /images\[0\] is in \.\.\/secret\.png: is outside/, '', { images });
    write('asset/target.gltf', gltf('link.bin', { images }));
    await ok(`${line} --allow-outside`);
    assert.ok(readFileSync('out.glb').includes(png(1, 1)), 'the image is in the file');
    rmSync('out.glb');
  });

  test('links to themselves, long names and devices are plain errors', async () => {
    symlinkSync('loop.glb', 'loop.glb');
    const long = `${'a'.repeat(300)}.glb`;
    for (const [target, out, message] of [
      ['loop.glb', 'out.glb', /loop\.glb: is a link that leads back to itself/],
      ['loop.glb/x.glb', 'out.glb', /x\.glb: is a link that leads back to itself/],
      ['cage.glb/x.glb', 'out.glb', /x\.glb: no such file/],
      [long, 'out.glb', /a\.glb: its name is too long/],
      ['/dev/null', 'out.glb', /null: is a device, not a file/],
      ['cage.glb', 'loop.glb/x.glb', /x\.glb: cannot be written \(is a link that leads back to itself\)/],
      ['cage.glb', long, /a\.glb: cannot be written \(its name is too long\)/],
    ] as const)
      await fails(1, message, `transfer ${target} --cage cage.glb -o ${out}`);
  });

  test('links are written through, permissions stay, and two names of one file are one', async () => {
    mkdirSync('folder');
    symlinkSync('folder', 'way');
    symlinkSync('folder/later.glb', 'link.glb'); // does not exist yet
    await ok(`${transfer} -o link.glb`);
    assert.ok(lstatSync('link.glb').isSymbolicLink(), 'the link is kept');
    assert.equal(readFileSync('folder/later.glb').toString('latin1', 0, 4), 'glTF');
    chmodSync('folder/later.glb', 0o600);
    await ok(`${transfer} -o way/later.glb`);
    assert.equal(lstatSync('folder/later.glb').mode & 0o777, 0o600);
    await fails(
      2,
      /way\/a\.glb would overwrite folder\/a\.glb, which .* writes/,
      `${transfer} -o folder/a.glb --report way/a.glb`,
    );
    const reads = 'link.glb would overwrite folder/later.glb, which this command reads; choose another output';
    await fails(2, reads, 'transfer folder/later.glb --cage cage.glb -o link.glb');
    assert.deepEqual(readdirSync('folder'), ['later.glb']);
  });
});

describe('names', () => {
  const name = '\u009b31m\u001b]0;title\u0007\nsecond\rthird\u202e<script>alert(1)</script>';
  const named = () =>
    changed((json) => {
      json.nodes![0]!.name = name;
    });

  test('bytes that a terminal obeys are printed as text, also in JSON, which keeps its meaning', async () => {
    write('named.glb', named());
    const commands = /(?!\n)[\p{Cc}\p{Bidi_Control}]/u;
    const inspect = 'inspect named.glb --cage cage.glb';
    const { stdout } = await run(inspect);
    assert.doesNotMatch(stdout, commands);
    assert.match(stdout, /\\u009b31m\\u001b\]0;title\\u0007\\u000a/);
    const { stderr } = await run(`${inspect} --keep nothing`);
    assert.match(stderr, /^cagecast: [^\n]+there are: \\u009b31m[^\n]+\n$/);
    assert.doesNotMatch(stderr, commands);
    for (const line of [`${inspect} --json`, 'transfer named.glb --cage cage.glb --report -']) {
      const json = (await run(line)).stdout;
      assert.doesNotMatch(json, commands);
      assert.equal(JSON.parse(json).segments[0].part, name);
    }
    const odd = 'named\u009b\u202e.glb';
    write(odd, named());
    const line = (await cagecast('batch', odd, '--cage', 'cage.glb')).stdout;
    assert.doesNotMatch(line, commands);
    assert.equal(JSON.parse(line).target, odd);
    await run(`${inspect} --html page.html`);
    assert.doesNotMatch(readFileSync('page.html', 'utf8'), /<script>alert/);
  });

  test('a line that names a file stays one line', async () => {
    const target = 'named\ngood\tcage.glb';
    write(target, whole);
    const lines = async (...args: string[]) => (await cagecast(...args)).stdout.split('\n');
    const transferred = await lines('transfer', target, '--cage', 'cage.glb', '-o', 'painted\nGOOD.glb');
    assert.match(transferred[0]!, /^named\\u000agood\\u0009cage\.glb: 4 vertices/);
    assert.ok(
      transferred.some((line) => /^wrote painted\\u000aGOOD\.glb: /.test(line)),
      transferred.join(),
    );
    assert.match(
      (await lines('inspect', target, '--cage', 'cage.glb'))[0]!,
      /^target {2}named\\u000agood\\u0009cage\.glb: 4/,
    );
    assert.match((await lines('make', target, '-o', 'made\nGOOD.glb'))[0]!, /^wrote made\\u000aGOOD\.glb: /);
  });

  test('a pattern with many stars is matched in time that grows with its length only', async () => {
    const long = 'a'.repeat(4000);
    write(
      'long.glb',
      changed((json) => (json.nodes![0]!.name = long)),
    );
    const keep = (pattern: string) => `transfer long.glb --cage cage.glb --keep ${pattern}`;
    await fails(1, /no node or material has this name; there are: a{59}…\n$/, keep(`${'*a'.repeat(40)}*b`));
    await ok(keep(`${'*a'.repeat(40)}*`));
  });

  test('patterns match what they say', async () => {
    write(
      'abcab.glb',
      changed((json) => (json.nodes![0]!.name = 'abcab')),
    );
    const line = 'transfer abcab.glb --cage cage.glb';
    await ok(line + ['abcab', '*', 'a*b', '*bc*', 'ab*ab', '**c**'].map((pattern) => ` --keep ${pattern}`).join(''));
    for (const pattern of ['abca', 'ab*bcab', 'b*', 'abc*cab'])
      await fails(1, /no node or material has this name/, `${line} --keep ${pattern}`);
  });
});
