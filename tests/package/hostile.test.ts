// Files that strangers may send: each is refused with one clear line, or read at a cost in proportion to its size.
import assert from 'node:assert/strict';
import { execFileSync, spawnSync } from 'node:child_process';
import {
  chmodSync,
  existsSync,
  mkdirSync,
  readdirSync,
  readFileSync,
  rmSync,
  statSync,
  symlinkSync,
  writeFileSync,
} from 'node:fs';
import { before, describe, test } from 'node:test';
import type { GLTF } from '@gltf-transform/core';
import { checkGltf, checkImage } from 'cagecast/gltf';
import { PNG } from 'pngjs';
import { fails, kProgram, ok, run } from '../support/command.js';
import { costlyFiles, fbxOfZeros, jpegOf, pngOf } from '../support/files/costly.js';
import { type Glb, glbOf, packGlb, tetrahedron, unpackGlb } from '../support/gltf.js';
import { temporaryFolder } from '../support/temporary.js';
import { ball } from './scenes.js';

const { folder, at } = temporaryFolder('hostile');
const whole = glbOf(tetrahedron(0.9), 'ball');
before(() => {
  process.chdir(folder); // so that commands are short
  mkdirSync('asset');
  writeFileSync('cage.glb', glbOf(tetrahedron(1)));
});

function changed(change: (json: GLTF.IGLTF, glb: Glb) => void): Buffer {
  const glb = unpackGlb(whole);
  change(glb.json, glb);
  return packGlb(glb);
}

/** The accessor that positions (0), UVs (1) or indices (2) are in, no longer in the file, with another number of elements. */
function imply(accessor: number, count: number): Buffer {
  return changed(({ accessors = [] }) => {
    for (const one of accessor === 0 ? [0, 1] : [accessor]) {
      delete accessors[one]!.bufferView;
      accessors[one]!.count = count;
    }
  });
}

/** A glTF whose JSON has this many levels. */
const nested = (levels: number) =>
  Buffer.from(`{"asset":{"version":"2.0"},"extras":${'{"a":'.repeat(levels - 1)}1${'}'.repeat(levels - 1)}}`);

/** Nodes that all show the mesh, with as many overlays. */
const instances = (count: number, overlays = 0) =>
  changed((json) => {
    const { primitives } = json.meshes![0]!;
    for (let i = 0; i < overlays; ++i) primitives.push({ ...primitives[0]!, extras: { cagecastOverlay: true } });
    json.nodes = Array.from({ length: count }, () => ({ mesh: 0 }));
    json.scenes![0]!.nodes = [...json.nodes.keys()];
  });

const compressed = (count: number, byteLength: number) =>
  changed((json) => {
    json.buffers!.push({ byteLength });
    const meshopt = { buffer: 0, byteOffset: 0, byteLength: 40, byteStride: 12, count, mode: 'ATTRIBUTES' };
    json.bufferViews![0] = { buffer: 1, byteLength, byteStride: 12, extensions: { EXT_meshopt_compression: meshopt } };
  });

/** Zones that are not in the file. */
const zones = (count: number) =>
  changed(({ accessors = [], meshes = [] }) => {
    accessors.push({ componentType: 5121, type: 'SCALAR', count });
    meshes[0]!.primitives[0]!.attributes['_NCZ'] = accessors.length - 1;
  });

/** Triangles as large as the model, one behind the other. */
function layered(layers: number) {
  const corners = Array.from({ length: layers }, (_, n) => [-1, -1, n / 1e4, 1, -1, n / 1e4, 0, 1, n / 1e4]);
  return {
    positions: Float32Array.from(corners.flat()),
    indices: Uint16Array.from({ length: 3 * layers }, (_, i) => i),
  };
}

const greedy: Record<string, [bytes: () => Uint8Array, message: RegExp]> = {
  'positions that are not in the file': [
    () => imply(0, 2 ** 24),
    /accessors\[0\] \(meshes\[0\]\.primitives\[0\]\.attributes\.POSITION\) has 16,777,216 elements that are not in the file; the limit "implied" is 1,000,000/,
  ],
  'indices that are not in the file': [
    () => imply(2, 3e7),
    /accessors\[2\] \(meshes\[0\]\.primitives\[0\]\.indices\) has 30,000,000 elements that are not/,
  ],
  'a compressed view that holds more than its view': [
    () => compressed(2 ** 27, 48),
    /bufferViews\[0\] \(compressed\) holds 1610612736 bytes, not the 48 of its view/,
  ],
  'a compressed view that claims to hold gigabytes': [
    () => compressed(2 ** 27, 12 * 2 ** 27),
    /decodes to [\d,]+ bytes, [\d,]+ times its size; the limit "expansion" is 100/,
  ],
  'ten thousand instances': [
    () => instances(10_000),
    /the positions of meshes\[0\] are in 10000 places of the scene; the limit "instances" is 1,000/,
  ],
  'overlays in many places, which are counted by themselves': [() => instances(600, 2), /are in 1200 places/],
  'primitives that share their positions, ten thousand times': [
    () =>
      changed(({ meshes = [] }) => {
        meshes[0]!.primitives = Array.from({ length: 10_000 }, () => meshes[0]!.primitives[0]!);
      }),
    /the positions of meshes\[0\] are in 1001 places/,
  ],
  'accessors that share their bytes': [
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
  'JSON that is nested deep': [
    () => nested(5000),
    /its JSON is nested more than 1000 deep; the limit "nesting" is 1,000/,
  ],
  'nodes that are nested deep': [
    () =>
      changed((json) => {
        json.nodes = Array.from({ length: 5000 }, (_, n) => (n < 4999 ? { children: [n + 1] } : { mesh: 0 }));
      }),
    /nodes\[1000\] is on level 1001; the limit "nesting" is 1,000/,
  ],
};

describe('a file that demands too much', () => {
  const refused = (message: RegExp) => ({ name: 'CagecastError', code: 'badArgument', message });

  for (const [name, [bytes, message]] of Object.entries(greedy))
    test(name, async () => {
      assert.throws(() => checkGltf(bytes()), refused(message));
      writeFileSync('target.glb', bytes());
      await fails(1, message, 'transfer target.glb --cage cage.glb -o never.glb');
      assert.ok(!existsSync('never.glb'));
    });

  for (const [name, { bytes, refusal }] of Object.entries(costlyFiles).filter((one) => one[1].refusal))
    test(name, () => assert.throws(() => checkGltf(bytes()), refused(refusal!)));

  test('triangles in hundreds of layers: neither a cage nor a picture is made, and the report says why', async () => {
    const layers = 300;
    writeFileSync('layers.glb', glbOf(layered(layers)));
    await fails(
      1,
      /model has its triangles in too many layers: their area is \d+ times/,
      'make layers.glb -o made.glb',
    );
    const often = /cannot be drawn: its triangles cover the picture more than 64 times/;
    await fails(1, often, 'thumbnail layers.glb -o layers.png');
    assert.equal((await run('inspect layers.glb --cage cage.glb --report layers.html')).status, 3);
    assert.match(readFileSync('layers.html', 'utf8'), often);
    assert.deepEqual(['made.glb', 'layers.png'].filter(existsSync), []);
  });

  test('pictures of triangles in many layers cost little more than others', async () => {
    const micros = async (line: string) => {
      const from = process.cpuUsage();
      await run(line);
      const { user, system } = process.cpuUsage(from);
      return user + system;
    };
    const costOf = async (target: string, cage: string) => {
      const plain = await micros(`inspect ${target} --cage ${cage}`);
      return (await micros(`inspect ${target} --cage ${cage} --report out.html`)) - plain;
    };
    const whole = ball([0, 0, 0], () => 1, 12, 16);
    writeFileSync('open.glb', glbOf({ ...whole, indices: whole.indices.subarray(30) }));
    // Seen from each side, some are drawn from the back to the front.
    const sheets = [0, 1, 2].flatMap((axis) =>
      Array.from({ length: 70 }, (_, n) => [-0.9, -0.9, 0.9, -0.9, 0, 0.9].map((at) => [at, n / 80 - 0.45, axis])),
    );
    const positions = Float32Array.from(
      sheets.flatMap((sheet) =>
        [0, 2, 4].flatMap((k) => {
          const [[u], [v, depth, axis]] = [sheet[k]!, sheet[k + 1]!] as [[number], [number, number, number]];
          return [u, v, depth, u, v].slice(axis, axis + 3);
        }),
      ),
    );
    writeFileSync('sheets.glb', glbOf({ positions, indices: Uint16Array.from({ length: 630 }, (_, i) => i) }));
    writeFileSync('usual.glb', glbOf(ball([0, 0, 0], () => 0.9, 12, 16)));
    await costOf('usual.glb', 'open.glb'); // compiles
    const usual = await costOf('usual.glb', 'open.glb');
    const pictures = Math.min(await costOf('sheets.glb', 'open.glb'), await costOf('sheets.glb', 'open.glb'));
    assert.match(readFileSync('out.html', 'utf8'), /<img alt="the front"/);
    assert.ok(pictures < 4.5 * usual, `${pictures} µs, ${usual} for a usual file`);
  });

  test('a hundred thousand triangles in one place end the call, not the process', async () => {
    const corners = { positions: Float32Array.of(0, 0, 0, 0.5, 0, 0, 0, 0.5, 0) };
    writeFileSync('stack.glb', glbOf({ ...corners, indices: Uint16Array.from({ length: 450_000 }, (_, i) => i % 3) }));
    const whole = ball([0, 0, 0], () => 1, 8, 10);
    writeFileSync('ball.glb', glbOf({ ...whole, indices: whole.indices.subarray(30) })); // with a hole
    for (const line of ['transfer', 'inspect'])
      await fails(
        1,
        /target or cage has triangles that lie in each other, in thousands of layers/,
        `${line} stack.glb --cage ball.glb`,
      );
  });

  test('files of other formats that say or stand for more than they have', async () => {
    const ply = (format: string, vertices: number) =>
      `ply\nformat ${format} 1.0\nelement vertex ${vertices}\nproperty float x\nproperty float y\nproperty float z\nelement face 1\nproperty list uchar int vertex_indices\nend_header\n`;
    const files: Record<string, [bytes: Uint8Array, message: RegExp]> = {
      'zeros.fbx': [
        fbxOfZeros(1e8),
        /its arrays decompress to more than 33,554,432 bytes; the limit "expansion" is 100/,
      ],
      'liar.fbx': [fbxOfZeros(1e8, 3), /its arrays decompress to more than/],
      'said.fbx': [fbxOfZeros(8, 2 ** 31), /its arrays decompress to more than 33,554,432 bytes/],
      'groups.obj': [
        Buffer.from(`v 0 0 0\nv 1 0 0\nv 0 1 0\n${'g a\nf 1 2 3\n'.repeat(30_000)}`),
        /has 30,000 groups; the limit "parts" is 20,000/,
      ],
      'text.ply': [
        Buffer.from(`${ply('ascii', 2e9)}0 0 0\n`),
        /2,000,000,000 elements "vertex", more than its \d+ bytes hold/,
      ],
      'binary.ply': [
        Buffer.from(ply('binary_little_endian', 2e9)),
        /2,000,000,000 elements "vertex", more than its \d+ bytes hold/,
      ],
    };
    for (const [name, [bytes, message]] of Object.entries(files)) {
      writeFileSync(name, bytes);
      await fails(1, message, `inspect ${name} --cage cage.glb`);
    }
    for (const [name, limit, message] of [
      ['zeros.fbx', 'expansion=1000000 --limit seconds=600', /is an FBX file without any triangle/],
      ['groups.obj', 'parts=29999', /has 30,000 groups; the limit "parts" is 29,999/],
    ] as const) {
      await fails(1, message, `inspect ${name} --cage cage.glb --limit ${limit}`);
    }
  });

  test('a picture of billions of pixels is refused, one of a camera is not', () => {
    const [pixels, few] = [jpegOf(65_500, 65_500), pngOf(8192, 8192)];
    assert.throws(() => checkImage(pixels), {
      message: /^checkImage: it has 65,500 × 65,500 pixels; up to it, images decode to [\d,]+ bytes/,
    });
    checkImage(few);
    checkImage(Buffer.concat([jpegOf(11_648, 8736), Buffer.alloc(5e6)]));
    for (const other of ['', 'GIF89a', '\xff\xd8\xff\xc0', 'RIFF....WEBP', '\x89PNG\r\n\x1a\n'])
      checkImage(Buffer.from(other, 'latin1'));
  });

  test('what stays within the limits is read, and limits can be set', async () => {
    const { length } = whole;
    const { count } = unpackGlb(whole).json.accessors![0]!;
    const admitted: [Uint8Array, object?][] = [
      ...[imply(0, 1000), imply(2, 3000), instances(1000), instances(600, 1), nested(900)].map(
        (bytes): [Uint8Array] => [bytes],
      ),
      [instances(1001), { limits: { instances: 2000 } }],
      [whole, { limits: { instances: undefined, bytes: length } }],
      [zones(count), { limits: { implied: 0 } }],
    ];
    for (const [bytes, options] of admitted) checkGltf(bytes, options);
    const cases: [Uint8Array, object, RegExp][] = [
      [imply(0, count), { limits: { implied: 0 } }, /limit "implied"/],
      [instances(3), { limits: { instances: 2 } }, /in 3 places .* "instances" is 2/],
      [whole, { limits: { bytes: 100 } }, /^checkGltf: has more than 100 bytes; the limit "bytes" is 100$/],
      [whole, { otherBytes: 2 ** 30 }, /the limit "bytes" is 1,073,741,824$/],
      [whole, { limits: { bytes: -1 } }, /^checkGltf: limits\.bytes = -1 is not a number/],
      [
        whole,
        { limits: { vertices: 3 } },
        /limits\.vertices = 3 .* one of bytes, nesting, instances, parts, implied, expansion/,
      ],
      [whole, { limit: { instances: 0 } }, /^checkGltf: limit is not an option$/],
      ...[Number.NaN, -1, '9999999'].map((otherBytes): [Uint8Array, object, RegExp] => [
        whole,
        { otherBytes },
        /^checkGltf: otherBytes = .* is not a number ≥ 0/,
      ]),
      ['a.glb' as never, {}, /^checkGltf: bytes is "a\.glb", not a Uint8Array/],
    ];
    for (const [bytes, options, message] of cases) assert.throws(() => checkGltf(bytes, options), refused(message));
    writeFileSync('target.glb', instances(3));
    const line = 'transfer target.glb --cage cage.glb --limit';
    await fails(1, /target\.glb: .* in 3 places .* limit "instances" is 2\n/, line, 'instances=2');
    await fails(1, /target\.glb: has more than 100 bytes; the limit "bytes" is 100/, line, 'bytes=100');
    assert.equal((await run(line, 'vertices=2')).status, 2);
    await ok(line, 'instances=2', '--limit', 'instances=3');
  });
});

describe('what a file refers to', { skip: process.platform === 'win32' && 'there are no pipes and devices' }, () => {
  const line = 'transfer asset/target.gltf --cage cage.glb -o out.glb';
  /** Writes a glTF whose buffer is there, with more in its JSON. */
  function refer(uri: string, more: object = {}): void {
    const { json } = unpackGlb(whole);
    const buffers = [{ byteLength: json.buffers![0]!.byteLength, uri }];
    writeFileSync('asset/target.gltf', JSON.stringify({ ...json, buffers, ...more }));
  }
  const refused = async (message: RegExp, ...flags: string[]) => {
    await fails(1, message, line, ...flags);
    assert.ok(!existsSync('out.glb'));
  };

  test('devices and pipes are not read', async () => {
    execFileSync('mkfifo', ['asset/pipe.bin']);
    refer('pipe.bin');
    await refused(/target\.gltf: buffers\[0\] is in pipe\.bin: is a device or a pipe, not a file/);
    refer('/dev/zero');
    await refused(/is in \/dev\/zero: is a device or a pipe/, '--allow-outside');
  });

  test('files outside its folder are read with --allow-outside only', async () => {
    writeFileSync('secret.bin', unpackGlb(whole).bin);
    writeFileSync('asset/own.bin', unpackGlb(whole).bin);
    symlinkSync('../secret.bin', 'asset/link.bin');
    const outside = /is outside the folder of the file that refers to it; --allow-outside permits it/;
    for (const uri of ['../secret.bin', '..%2fsecret.bin', at('secret.bin'), '/dev/zero', 'link.bin']) {
      refer(uri);
      await refused(outside);
    }
    const png = PNG.sync.write(new PNG({ width: 1, height: 1 }));
    writeFileSync('secret.png', png);
    const images = { images: [{ uri: '../secret.png' }] };
    refer('own.bin', images);
    await refused(/images\[0\] is in \.\.\/secret\.png: is outside/);
    refer('link.bin', images);
    await ok(line, '--allow-outside');
    assert.ok(readFileSync('out.glb').includes(png));
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
});

describe('names', () => {
  const named = (name: string, path: string) =>
    writeFileSync(
      path,
      changed((json) => (json.nodes![0]!.name = name)),
    );

  test('bytes that a terminal obeys are printed as text, also in JSON, which keeps its meaning', async () => {
    const name = '\u009b31m\u001b]0;title\u0007\nsecond\rthird\u202e<script>alert(1)</script>';
    const odd = 'named\u009b\u202e.glb';
    for (const path of ['named.glb', odd]) named(name, path);
    const printed = async (line: string, ...more: string[]) => {
      const { stdout, stderr } = await run(line, ...more);
      assert.doesNotMatch(stdout + stderr, /(?!\n)[\p{Cc}\p{Bidi_Control}]/u);
      return stdout || stderr;
    };
    const inspect = 'inspect named.glb --cage cage.glb';
    assert.match(await printed(inspect), /\\u009b31m\\u001b\]0;title\\u0007\\u000a/);
    assert.equal(JSON.parse(await printed(`${inspect} --json`)).segments[0].part, name);
    assert.match(await printed(`${inspect} --keep nothing`), /^cagecast: [^\n]+there are: \\u009b31m[^\n]+\n$/);
    const report = await printed('transfer named.glb --cage cage.glb --report -');
    assert.equal(JSON.parse(report).segments[0].part, name);
    assert.equal(JSON.parse(await printed('batch --cage cage.glb', odd)).target, odd);
    await printed(`${inspect} --report page.html`);
    assert.doesNotMatch(readFileSync('page.html', 'utf8'), /<script>alert/);
  });

  test('a line that names a file stays one line', async () => {
    const target = 'named\ngood\tcage.glb';
    writeFileSync(target, whole);
    const written = await ok('transfer --cage cage.glb', target, '-o', 'painted\nGOOD.glb');
    assert.match(written, /^.*named\\u000agood\\u0009cage\.glb: 4 vertices/);
    assert.match(written, /^wrote .*painted\\u000aGOOD\.glb: /m);
    assert.match(await ok('inspect --cage cage.glb', target), /^target .*named\\u000agood\\u0009cage\.glb: 4 vertices/);
    assert.match((await run('make', target, '-o', 'made\nGOOD.glb')).stdout, /^wrote .*made\\u000aGOOD\.glb: /);
  });

  test('patterns match what they say, in time that grows with their length only', async () => {
    named('a'.repeat(4000), 'long.glb');
    named('abcab', 'short.glb');
    /** Whether the only part is ignored, so that there is nothing to paint. */
    async function matches(path: string, pattern: string): Promise<boolean> {
      const { status, stderr } = await run(`transfer ${path} --cage cage.glb --ignore`, pattern);
      if (status !== 0) assert.match(stderr, /all parts are left out: ".*" \(ignored\)/);
      return status !== 0;
    }
    const stars = '*a'.repeat(40);
    assert.equal(await matches('long.glb', `${stars}*b`), false);
    assert.equal(await matches('long.glb', `${stars}*`), true);
    for (const pattern of ['abcab', '*', 'a*b', '*bc*', 'ab*ab', '**c**'])
      assert.equal(await matches('short.glb', pattern), true, pattern);
    for (const pattern of ['ab*bcab', 'b*', 'abc*cab'])
      assert.equal(await matches('short.glb', pattern), false, pattern);
    const { status, stderr } = await run('transfer long.glb --cage cage.glb --keep abca');
    assert.equal(status, 1);
    assert.match(stderr, /nothing has this name; there are: a{59}…\n$/);
  });
});

describe('what is written', () => {
  const line = 'transfer good.glb --cage cage.glb';
  before(() => writeFileSync('good.glb', whole));

  test('goes to no name that somebody could plant a link at', async () => {
    mkdirSync('planted');
    writeFileSync('victim.txt', 'mine');
    for (const name of ['out.glb', 'report.json']) symlinkSync(at('victim.txt'), `planted/.${name}.${process.pid}.tmp`);
    for (let i = 0; i < 2; ++i) await ok(`${line} -o planted/out.glb --report planted/report.json`);
    assert.equal(readFileSync('victim.txt', 'utf8'), 'mine');
    assert.deepEqual(
      readdirSync('planted').filter((name) => !name.endsWith('.tmp')),
      ['out.glb', 'report.json'],
    );
  });

  test('has its name in any length, and the permissions of what it replaces', async () => {
    const name = `${'ü'.repeat(120)}.glb`; // 244 bytes, of 255
    await ok(`${line} -o ${name}`);
    chmodSync(name, 0o600);
    await ok(`${line} -o ${name}`);
    assert.equal(statSync(name).mode & 0o777, 0o600);
  });

  test('stays below the folder that is named, whatever the name of a target', async () => {
    mkdirSync('up/out', { recursive: true });
    for (const name of ['...glb', '..glb', '.glb']) writeFileSync(`up/${name}`, whole);
    const batch = 'batch up/...glb up/..glb up/.glb --cage cage.glb -o {dir}/out/{name}';
    assert.equal((await run(`${batch}/x.glb`)).status, 0);
    assert.deepEqual(readdirSync('up'), ['...glb', '..glb', '.glb', 'out']);
    assert.deepEqual(readdirSync('up/out'), ['...glb', '..glb', '.glb']);
  });
});

test('a configuration that is a link shows nothing of what it leads to', async () => {
  mkdirSync('with-model');
  writeFileSync('with-model/head.glb', whole);
  for (const secret of ['root:x:0:0', '{"password": "hunter2"}', '{"threshold": "hunter2"}']) {
    writeFileSync('secret.json', secret);
    rmSync('with-model/cagecast.config.json', { force: true });
    symlinkSync(at('secret.json'), 'with-model/cagecast.config.json');
    const { status, stdout, stderr } = await run('inspect with-model/head.glb --cage cage.glb');
    assert.equal(status, 1);
    assert.match(
      stderr,
      /config\.json: is a link to what is no configuration; --config shows what is wrong with it\n$/,
    );
    assert.doesNotMatch(stdout + stderr, /root|password|hunter2/);
    await fails(1, /secret\.json: /, 'inspect with-model/head.glb --cage cage.glb --config secret.json');
  }
  writeFileSync('secret.json', '{"threshold": 0.4}');
  await ok('inspect with-model/head.glb --cage cage.glb');
});

test('a folder that goes away is a plain error', () => {
  mkdirSync('gone');
  const command = `cd gone && rmdir ../gone && "${process.execPath}" "${kProgram}" inspect a.glb --cage b.glb`;
  const { status, stderr } = spawnSync('sh', ['-c', command], { encoding: 'utf8' });
  assert.equal(status, 1);
  assert.match(stderr, /the current folder is gone; change to another one\n$/);
  assert.doesNotMatch(stderr, /unexpectedly|\n.*\n/);
});
