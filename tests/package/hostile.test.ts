// Files that strangers may send: each is refused with one clear line, or read at a cost in proportion to its size.
import assert from 'node:assert/strict';
import { execFileSync } from 'node:child_process';
import { existsSync, mkdirSync, readFileSync, rmSync, symlinkSync, writeFileSync } from 'node:fs';
import { before, describe, test } from 'node:test';
import type { GLTF } from '@gltf-transform/core';
import { type CagecastError, init } from 'cagecast';
import { checkGltf } from 'cagecast/gltf';
import { PNG } from 'pngjs';
import { cagecast, type Glb, glbOf, packGlb, tetrahedron, unpackGlb } from '../support/gltf.js';
import { temporaryFolder } from '../support/temporary.js';

const { at } = temporaryFolder('hostile');
const write = (data: Uint8Array | string, ...names: string[]) => {
  writeFileSync(at(...names), data);
  return at(...names);
};

const whole = glbOf(tetrahedron(0.9), 'ball');
before(async () => {
  await init();
  mkdirSync(at('asset'));
  write(glbOf(tetrahedron(1)), 'cage.glb');
});

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

  test('the command refuses them with one line and writes nothing', () => {
    for (const [name, make, message] of files.filter((_, f) => [0, 2, 4, 7].includes(f))) {
      const target = write(make(), 'target.glb');
      const { status, stdout, stderr } = cagecast('transfer', target, '--cage', at('cage.glb'), '-o', at('never.glb'));
      assert.equal(status, 1, name);
      assert.match(stderr, message);
      assert.match(stderr, /^cagecast: .*target\.glb: [^\n]+\n$/);
      assert.equal(stdout, '');
      assert.ok(!existsSync(at('never.glb')));
    }
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

  test('what stays within the limits is read, and limits can be set', () => {
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
    const target = write(instances(3), 'target.glb');
    const run = (...flags: string[]) => cagecast('transfer', target, '--cage', at('cage.glb'), ...flags);
    assert.match(run('--limit', 'instances=2').stderr, /target\.glb: .* in 3 places .* limit "instances" is 2\n/);
    assert.match(run('--limit', 'bytes=100').stderr, /target\.glb: has more than 100 bytes; the limit "bytes" is 100/);
    assert.equal(run('--limit', 'vertices=2').status, 2);
    assert.equal(run('--limit', 'instances=2', '--limit', 'instances=3').status, 0);
  });
});

describe('what a file refers to', { skip: process.platform === 'win32' && 'there are no pipes and devices' }, () => {
  const run = (...flags: string[]) =>
    cagecast('transfer', at('asset', 'target.gltf'), '--cage', at('cage.glb'), '-o', at('out.glb'), ...flags);
  const refused = (uri: string, message: RegExp, ...flags: string[]) => {
    write(gltf(uri), 'asset', 'target.gltf');
    const { status, stderr } = run(...flags);
    assert.equal(status, 1, uri);
    assert.match(stderr, message);
    assert.match(stderr, /^cagecast: [^\n]+\n$/);
    assert.ok(!existsSync(at('out.glb')));
  };

  test('devices and pipes are not read', () => {
    execFileSync('mkfifo', [at('asset', 'pipe.bin')]);
    refused('pipe.bin', /target\.gltf: buffers\[0\] is in pipe\.bin: is a device or a pipe, not a file/);
    refused('/dev/zero', /is in \/dev\/zero: is a device or a pipe/, '--allow-outside');
  });

  test('files outside its folder are read with --allow-outside only', () => {
    write(unpackGlb(whole).bin, 'secret.bin');
    const outside = /is outside the folder of the file that refers to it; --allow-outside permits it/;
    refused('../secret.bin', outside);
    refused('..%2fsecret.bin', outside);
    refused(at('secret.bin'), outside);
    refused('/dev/zero', outside);
    symlinkSync('../secret.bin', at('asset', 'link.bin'));
    refused('link.bin', outside);
    const png = PNG.sync.write(new PNG({ width: 1, height: 1 }));
    write(png, 'secret.png');
    write(gltf('link.bin', { images: [{ uri: '../secret.png' }] }), 'asset', 'target.gltf');
    assert.equal(run('--allow-outside').status, 0);
    assert.ok(readFileSync(at('out.glb')).includes(png));
    rmSync(at('out.glb'));
    write(unpackGlb(whole).bin, 'asset', 'own.bin');
    write(gltf('own.bin', { images: [{ uri: '../secret.png' }] }), 'asset', 'target.gltf');
    const { status, stderr } = run();
    assert.equal(status, 1);
    assert.match(stderr, /images\[0\] is in \.\.\/secret\.png: is outside/);
    assert.ok(!existsSync(at('out.glb')));
  });

  test('links to themselves, long names and devices are plain errors', () => {
    symlinkSync('loop.glb', at('loop.glb'));
    const long = `${'a'.repeat(300)}.glb`;
    const transfer = (target: string, out: string) => cagecast('transfer', target, '--cage', at('cage.glb'), '-o', out);
    for (const [target, out, message] of [
      [at('loop.glb'), at('out.glb'), /loop\.glb: is a link that leads back to itself/],
      [at('loop.glb', 'x.glb'), at('out.glb'), /x\.glb: is a link that leads back to itself/],
      [at('cage.glb', 'x.glb'), at('out.glb'), /x\.glb: no such file/],
      [at(long), at('out.glb'), /a\.glb: its name is too long/],
      ['/dev/null', at('out.glb'), /null: is a device, not a file/],
      [at('cage.glb'), at('loop.glb', 'x.glb'), /x\.glb: cannot be written \(is a link that leads back to itself\)/],
      [at('cage.glb'), at(long), /a\.glb: cannot be written \(its name is too long\)/],
    ] as const) {
      const { status, stderr } = transfer(target, out);
      assert.match(stderr, message);
      assert.match(stderr, /^cagecast: [^\n]+\n$/);
      assert.equal(status, 1);
    }
  });
});

describe('names', () => {
  const name = '\u009b31m\u001b]0;title\u0007\nsecond\rthird\u202e<script>alert(1)</script>';
  const named = () =>
    changed((json) => {
      json.nodes![0]!.name = name;
    });

  test('bytes that a terminal obeys are printed as text, also in JSON, which keeps its meaning', () => {
    const target = write(named(), 'named.glb');
    const commands = /(?!\n)[\p{Cc}\p{Bidi_Control}]/u;
    const inspect = (...flags: string[]) => cagecast('inspect', target, '--cage', at('cage.glb'), ...flags);
    const { stdout } = inspect();
    assert.doesNotMatch(stdout, commands);
    assert.match(stdout, /\\u009b31m\\u001b\]0;title\\u0007\\u000a/);
    const json = inspect('--json').stdout;
    assert.doesNotMatch(json, commands);
    assert.equal(JSON.parse(json).segments[0].part, name);
    const { stderr } = inspect('--keep', 'nothing');
    assert.match(stderr, /^cagecast: [^\n]+there are: \\u009b31m[^\n]+\n$/);
    assert.doesNotMatch(stderr, commands);
    const report = cagecast('transfer', target, '--cage', at('cage.glb'), '--report', '-').stdout;
    assert.doesNotMatch(report, commands);
    assert.equal(JSON.parse(report).segments[0].part, name);
    const odd = write(named(), 'named\u009b\u202e.glb');
    const line = cagecast('batch', odd, '--cage', at('cage.glb')).stdout;
    assert.doesNotMatch(line, commands);
    assert.equal(JSON.parse(line).target, odd);
    inspect('--html', at('page.html'));
    assert.doesNotMatch(readFileSync(at('page.html'), 'utf8'), /<script>alert/);
  });

  test('a line that names a file stays one line', () => {
    const target = write(whole, 'named\ngood\tcage.glb');
    const output = at('painted\nGOOD.glb');
    const lines = (...command: string[]) => cagecast(...command, '--cage', at('cage.glb')).stdout.split('\n');
    assert.match(lines('transfer', target, '-o', output)[0]!, /named\\u000agood\\u0009cage\.glb: 4 vertices/);
    assert.ok(lines('transfer', target, '-o', output).some((line) => /^wrote .*painted\\u000aGOOD\.glb: /.test(line)));
    assert.match(lines('inspect', target)[0]!, /^target .*named\\u000agood\\u0009cage\.glb: 4 vertices/);
    const made = cagecast('make', target, '-o', at('made\nGOOD.glb')).stdout.split('\n');
    assert.match(made[0]!, /^wrote .*made\\u000aGOOD\.glb: /);
  });

  test('a pattern with many stars is matched in time that grows with its length only', () => {
    const long = 'a'.repeat(4000);
    const target = write(
      changed((json) => {
        json.nodes![0]!.name = long;
      }),
      'long.glb',
    );
    const run = (pattern: string) => cagecast('transfer', target, '--cage', at('cage.glb'), '--keep', pattern);
    const { status, stderr } = run(`${'*a'.repeat(40)}*b`);
    assert.equal(status, 1);
    assert.match(stderr, /no node or material has this name; there are: a{59}…\n$/);
    assert.equal(run(`${'*a'.repeat(40)}*`).status, 0);
  });

  test('patterns match what they say', () => {
    const target = write(
      changed((json) => {
        json.nodes![0]!.name = 'abcab';
      }),
      'abcab.glb',
    );
    const matches = (...patterns: string[]) =>
      cagecast('transfer', target, '--cage', at('cage.glb'), ...patterns.flatMap((text) => ['--keep', text])).status ===
      0;
    assert.ok(matches('abcab', '*', 'a*b', '*bc*', 'ab*ab', '**c**'));
    for (const pattern of ['abca', 'ab*bcab', 'b*', 'abc*cab']) assert.ok(!matches(pattern), pattern);
  });
});
