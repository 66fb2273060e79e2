import assert from 'node:assert/strict';
import { spawnSync } from 'node:child_process';
import {
  chmodSync,
  copyFileSync,
  existsSync,
  lstatSync,
  mkdirSync,
  readdirSync,
  readFileSync,
  rmSync,
  symlinkSync,
  writeFileSync,
} from 'node:fs';
import { basename, join } from 'node:path';
import { before, describe, test } from 'node:test';
import { type GLTF, NodeIO } from '@gltf-transform/core';
import { ALL_EXTENSIONS, KHRMaterialsUnlit } from '@gltf-transform/extensions';
import { init, type Mesh, presetOptions, transfer } from 'cagecast';
import { cagecast as cagecastTransform } from 'cagecast/gltf';
import { PNG } from 'pngjs';
import {
  assertNear,
  assertTransferred,
  cagecast,
  GlbMaker,
  glbOf,
  packGlb,
  storedUv,
  unpackGlb,
  validate,
} from '../../support/gltf.js';
import { temporaryFolder } from '../../support/temporary.js';
import { ball, head, join3d, modelFolders, random, readPlain } from '../scenes.js';

const { folder, at } = temporaryFolder('cli');
const write = (name: string, data: Uint8Array | string) => {
  writeFileSync(at(name), data);
  return at(name);
};

const scene = head(1, 10);
const paint = () => {
  const png = new PNG({ width: 4, height: 4 });
  png.data.fill(200);
  return PNG.sync.write(png);
};

before(async () => {
  await init();
  write('target.glb', glbOf(scene.target));
  write('cage.glb', glbOf(scene.cage));
  write('paint.png', paint());
});

/** A report, as far as tests look at it. */
interface Report {
  counts: Record<'cosmetic' | 'occluded' | 'uncovered' | 'culled', number>;
  areas: Record<'total' | 'cosmetic' | 'occluded' | 'uncovered' | 'culled', number>;
  segments: {
    points: number;
    vertices: number;
    exposedArea: number;
    coveredArea: number;
    coverage: number;
    culled: boolean;
    culledBy: string;
    part: string;
  }[];
  parts: {
    name: string;
    place: string;
    vertices: number;
    uvSet: string | null;
    overlayTriangles: number;
    splitVertices: number | null;
  }[];
  target: { vertices: number; triangles: number };
  triangles: { total: number; cosmetic: number };
  options: object;
  timings: { total: number };
  versions: { cagecast: string };
}

function report(target: string, cage = at('cage.glb'), ...more: string[]): Report {
  const path = at('report.json');
  const { status, stderr } = cagecast('transfer', target, '--cage', cage, '--report', path, ...more);
  assert.equal(status, 0, stderr);
  assert.equal(stderr, '');
  return JSON.parse(readFileSync(path, 'utf8')) as Report;
}

/** Counts, areas and segments of a target, which other forms of the same mesh must share. */
function answer(path: string): object {
  const { counts, areas, segments } = report(path);
  const round = (x: number) => Number(x.toPrecision(5));
  return {
    counts,
    area: round(areas.total),
    segments: segments.map(({ points, exposedArea, coveredArea, culled }) => ({
      points,
      e: round(exposedArea),
      c: round(coveredArea),
      culled,
    })),
  };
}

describe('usage', () => {
  test('--version prints the version of package.json, --help shows examples', () => {
    const { version } = JSON.parse(readFileSync('package.json', 'utf8')) as { version: string };
    assert.deepEqual(cagecast('--version'), { status: 0, stdout: `${version}\n`, stderr: '' });
    for (const args of [['--help'], ['transfer', '--help'], ['inspect', '--help']]) {
      const { status, stdout, stderr } = cagecast(...args);
      assert.equal(status, 0);
      assert.equal(stderr, '');
      assert.match(stdout, /Example/);
    }
  });

  test('wrong usage exits 2 with one line and writes nothing', () => {
    const ok = ['transfer', at('target.glb'), '--cage', at('cage.glb')];
    const cases: [string[], RegExp][] = [
      [['transfer'], /missing required argument 'TARGET'|required option/],
      [['transfer', at('target.glb')], /required option '--cage/],
      [[...ok, '--threshold', '2'], /--threshold.*'2' is invalid.*not a number within 0\.\.1/],
      [[...ok, '--threshold', 'half'], /not a number within 0\.\.1/],
      [[...ok, '--threshold', ''], /not a number within 0\.\.1/],
      [[...ok, '--weld-tolerance', '1'], /not a number within 0\.\.0\.01/],
      [[...ok, '--seams', 'none'], /--seams.*'none' is invalid.*vertex, corner/],
      [[...ok, '--occlusion-reach', '-1'], /not a number within 0\.\.Infinity/],
      [[...ok, '--min-covered', '2'], /not a number within 0\.\.1/],
      [[...ok, '--preset', 'papre'], /--preset.*'papre' is invalid.*paper/],
      [[...ok, '--output', at('out.obj')], /must end in \.glb/],
      [[...ok, '--texture', at('paint.png')], /--texture needs -o/],
      [
        [...ok, '-o', at('target.glb')],
        /target\.glb would overwrite .*target\.glb, which this command reads; choose another output$/m,
      ],
      [
        [...ok, '-o', at('out.glb'), '--report', at('out.glb')],
        /out\.glb would overwrite .*out\.glb, which this command writes; choose another output$/m,
      ],
      [[...ok, 'extra.glb', '-o', at('out.glb')], /too many arguments/],
      [[...ok, '--colour', 'red'], /unknown option '--colour'/],
      [['transmogrify'], /unknown command 'transmogrify'/],
      [['transfer', '', '--cage', at('cage.glb')], /TARGET is empty/],
      [['transfer', at('target.glb'), '--cage', ''], /--cage is empty/],
      [[...ok, '--report', ''], /--report is empty/],
      [[...ok, '--region', '=paint.png', '-o', at('out.glb')], /not the file of a cage and that of a texture/],
      [['batch', '', '--cage', at('cage.glb')], /TARGETS is empty/],
      [['transfer', '-', '--cage', at('cage.glb'), '--config', '-'], /only one file can be the standard input/],
      [['inspect', '-', '--cage', at('cage.glb'), '--config', '-'], /only one file can be the standard input/],
      [['bake', '-', at('cage.glb'), at('paint.png'), '--config', '-', '-o', at('out.glb')], /only one file can be/],
    ];
    const files = readdirSync(folder).sort();
    for (const [args, message] of cases) {
      const { status, stdout, stderr } = cagecast(...args);
      assert.equal(status, 2, `${args.join(' ')}: ${stderr}`);
      assert.equal(stdout, '');
      assert.match(stderr, message);
      assert.match(stderr, /^cagecast: [^\n]+\n$/);
    }
    assert.deepEqual(readdirSync(folder).sort(), files);
  });

  test('without a command it shows its help and exits 2', () => {
    const { status, stderr } = cagecast();
    assert.equal(status, 2);
    assert.match(stderr, /Usage: cagecast/);
  });
});

describe('input that cannot be used exits 1 with one line, and writes nothing', () => {
  const whole = () => readFileSync(at('target.glb'));
  const changed = (change: (glb: ReturnType<typeof unpackGlb>) => void) => {
    const glb = unpackGlb(whole());
    change(glb);
    return packGlb(glb);
  };
  const positionsAt = ({ json }: ReturnType<typeof unpackGlb>) =>
    json.bufferViews![json.accessors![json.meshes![0]!.primitives[0]!.attributes['POSITION']!]!.bufferView!]!
      .byteOffset!;
  const indicesAt = ({ json }: ReturnType<typeof unpackGlb>) =>
    json.bufferViews![json.accessors![json.meshes![0]!.primitives[0]!.indices!]!.bufferView!]!.byteOffset!;

  const targets: [string, () => Uint8Array | string, RegExp][] = [
    [
      'a NaN position',
      () =>
        changed((glb) =>
          new DataView(glb.bin.buffer, glb.bin.byteOffset).setFloat32(positionsAt(glb) + 12 * 5 + 4, NaN, true),
        ),
      /bad\.glb: meshes\[0\]\.primitives\[0\]: POSITION of vertex 5 has NaN, which is not a finite number/,
    ],
    [
      'an index out of range',
      () =>
        changed((glb) =>
          new DataView(glb.bin.buffer, glb.bin.byteOffset).setUint32(indicesAt(glb) + 4 * 17, 912345, true),
        ),
      /bad\.glb: meshes\[0\]\.primitives\[0\]: indices\[17\] = 912345 is out of range \(\d+ vertices\)/,
    ],
    [
      'an empty mesh',
      () => {
        const maker = new GlbMaker();
        maker.node({ name: 'empty' });
        return maker.finish();
      },
      /bad\.glb: has no meshes; at least one triangle is needed/,
    ],
    [
      'a mesh of lines',
      () =>
        changed(({ json }) => {
          json.meshes![0]!.primitives[0]!.mode = 1;
        }),
      /bad\.glb: has no triangles in its scene/,
    ],
    [
      'a mesh that is not in the scene',
      () =>
        changed(({ json }) => {
          json.scenes![0]!.nodes = [];
        }),
      /bad\.glb: has no triangles in its scene/,
    ],
    [
      'a truncated GLB',
      () => whole().subarray(0, whole().length - 100),
      /bad\.glb: is truncated: its header says \d+ bytes, there are \d+/,
    ],
    [
      'a GLB cut within its header',
      () => whole().subarray(0, 10),
      /bad\.glb: is truncated: a GLB has at least 20 bytes, this one 10/,
    ],
    [
      'a GLB of another version',
      () => Buffer.concat([whole().subarray(0, 4), Buffer.from([1, 0, 0, 0]), whole().subarray(8)]),
      /bad\.glb: is a GLB of version 1/,
    ],
    ['a file that is no GLB', () => 'hello, world\n', /bad\.glb: is neither a GLB nor a glTF file/],
    ['JSON that is no glTF', () => '{"hello": 1}', /bad\.glb: is JSON but not glTF/],
    ['null', () => 'null', /bad\.glb: is JSON but not glTF/],
    ['an empty file', () => '', /bad\.glb: the file is empty/],
    ['glTF 1.0', () => '{"asset": {"version": "1.0"}}', /bad\.glb: is glTF 1\.0; only 2\.x/],
    [
      'damaged JSON in a GLB',
      () => {
        const bytes = Buffer.from(whole());
        bytes[20] = 0x21;
        return bytes;
      },
      /bad\.glb: its JSON is damaged/,
    ],
    [
      'an accessor beyond its view',
      () =>
        changed(({ json }) => {
          json.accessors![0]!.count = 1e6;
        }),
      /bad\.glb: accessors\[0\] ends at byte \d+ of bufferViews\[0\], which has \d+/,
    ],
    [
      'an accessor of absurd size',
      () =>
        changed(({ json }) => {
          json.accessors![0]!.count = 2 ** 40;
          delete json.accessors![0]!.bufferView;
        }),
      /bad\.glb: accessors\[0\]\.count = \d+ is more than/,
    ],
    [
      'a view beyond its buffer',
      () =>
        changed(({ json }) => {
          json.bufferViews![0]!.byteOffset = 1e9;
        }),
      /bad\.glb: bufferViews\[0\] ends at byte \d+ of buffers\[0\], which has \d+/,
    ],
    [
      'a buffer larger than the file',
      () =>
        changed(({ json }) => {
          json.buffers![0]!.byteLength = 1e9;
        }),
      /bad\.glb: buffers\[0\] is truncated/,
    ],
    [
      'a buffer in a file that is missing',
      () => JSON.stringify({ asset: { version: '2.0' }, buffers: [{ uri: 'gone.bin', byteLength: 4 }] }),
      /bad\.glb: buffers\[0\] is in gone\.bin: no such file/,
    ],
    [
      'a buffer on another host',
      () =>
        JSON.stringify({ asset: { version: '2.0' }, buffers: [{ uri: 'https://example.com/a.bin', byteLength: 4 }] }),
      /bad\.glb: buffers\[0\] is at https:.* only local files can be read/,
    ],
    [
      'a data URI that is none',
      () =>
        JSON.stringify({
          asset: { version: '2.0' },
          buffers: [{ uri: 'data:application/octet-stream;base64', byteLength: 4 }],
        }),
      /bad\.glb: buffers\[0\] is "data:[^"]*", not a valid data URI\n/,
    ],
    [
      'an attribute of too few vertices',
      () =>
        changed(({ json }) => {
          const short = json.accessors!.push({ componentType: 5126, count: 5, type: 'VEC3' }) - 1;
          json.meshes![0]!.primitives[0]!.attributes['NORMAL'] = short;
        }),
      /bad\.glb: meshes\[0\]\.primitives\[0\]\.attributes\.NORMAL has 5 elements for \d+ vertices/,
    ],
    [
      'a reference to no accessor',
      () =>
        changed(({ json }) => {
          json.meshes![0]!.primitives[0]!.attributes['POSITION'] = 99;
        }),
      /bad\.glb: meshes\[0\]\.primitives\[0\]\.attributes\.POSITION = 99 is out of range \(\d+ accessors\)/,
    ],
    [
      'a node that is its own ancestor',
      () =>
        changed(({ json }) => {
          json.nodes!.push({ children: [2] }, { children: [1] });
        }),
      /bad\.glb: has no|two parents|nodes/,
    ],
    [
      'a scene whose root is its own ancestor',
      () =>
        changed(({ json }) => {
          json.nodes![0]!.children = [0];
        }),
      /bad\.glb: nodes\[0\] is a root of scenes\[0\] and a child of nodes\[0\]/,
    ],
    [
      'a node that is twice in the scene',
      () =>
        changed(({ json }) => {
          json.scenes![0]!.nodes = [0, 0];
        }),
      /bad\.glb: nodes\[0\] is twice a root of scenes\[0\]/,
    ],
    [
      'morph targets that are not an array',
      () =>
        changed(({ json }) => {
          Object.assign(json.meshes![0]!.primitives[0]!, { targets: -1 });
        }),
      /bad\.glb: meshes\[0\]\.primitives\[0\]\.targets is not an array of objects/,
    ],
    [
      'a morph target that is nowhere',
      () =>
        changed(({ json }) => {
          json.meshes![0]!.primitives[0]!.targets = [{ POSITION: 99 }];
        }),
      /bad\.glb: meshes\[0\]\.primitives\[0\]\.targets\[0\]\.POSITION = 99 is out of range \(\d+ accessors\)/,
    ],
    [
      'an object for a number',
      () =>
        changed(({ json }) => {
          Object.assign(json, { scene: {} });
        }),
      /bad\.glb: scene = of type Object is out of range \(1 scenes\)/,
    ],
    [
      'corners that are no triangles',
      () =>
        changed(({ json }) => {
          json.accessors![json.meshes![0]!.primitives[0]!.indices!]!.count -= 1;
        }),
      /bad\.glb: meshes\[0\]\.primitives\[0\] has \d+ corners, not 3 per triangle/,
    ],
    [
      'damaged Draco data',
      () =>
        changed(({ json }) => {
          json.extensionsUsed = json.extensionsRequired = ['KHR_draco_mesh_compression'];
          json.meshes![0]!.primitives[0]!.extensions = {
            KHR_draco_mesh_compression: { bufferView: 0, attributes: { POSITION: 0 } },
          };
        }),
      /bad\.glb: cannot be decoded/,
    ],
    [
      'damaged meshopt data',
      () =>
        changed(({ json }) => {
          json.extensionsUsed = json.extensionsRequired = ['EXT_meshopt_compression'];
          const view = json.bufferViews![0]!;
          view.extensions = {
            EXT_meshopt_compression: {
              buffer: 0,
              byteOffset: 0,
              byteLength: 60,
              byteStride: 12,
              count: view.byteLength / 12,
              mode: 'ATTRIBUTES',
            },
          };
        }),
      /bad\.glb: cannot be decoded/,
    ],
  ];

  const fails = (args: string[], message: RegExp) => {
    const before = readdirSync(folder).sort();
    const { status, stdout, stderr } = cagecast(...args, '-o', at('never.glb'), '--report', at('never.json'));
    assert.match(stderr, message);
    assert.match(stderr, /^cagecast: [^\n]+\n$/);
    assert.equal(status, 1, stderr);
    assert.equal(stdout, '');
    assert.deepEqual(readdirSync(folder).sort(), before);
  };

  for (const [name, make, message] of targets.filter(([name]) => name !== 'a node that is its own ancestor')) {
    test(name, () => {
      const path = write('bad.glb', make());
      fails(['transfer', path, '--cage', at('cage.glb')], message);
      rmSync(path);
    });
  }

  test('a node outside the scene that is its own ancestor is ignored', () => {
    const path = write(
      'loop.glb',
      changed(({ json }) => {
        json.nodes!.push({ children: [2] }, { children: [1] });
      }),
    );
    assert.deepEqual(answer(path), answer(at('target.glb')));
    rmSync(path);
  });

  test('a missing file, and a folder', () => {
    fails(['transfer', at('gone.glb'), '--cage', at('cage.glb')], /gone\.glb: no such file/);
    fails(['transfer', at('target.glb'), '--cage', at('gone.glb')], /gone\.glb: no such file/);
    fails(['transfer', folder, '--cage', at('cage.glb')], /: is a folder, not a file/);
  });

  test('a cage without UVs, or without a triangle that has an area', () => {
    const bare = write('bare.glb', glbOf({ positions: scene.cage.positions, indices: scene.cage.indices }));
    fails(
      ['transfer', at('target.glb'), '--cage', bare],
      /bare\.glb: meshes\[0\]\.primitives\[0\] \("only"\) has no TEXCOORD_0: the texture is drawn in the cage's UVs/,
    );
    const flat = write('flat.glb', glbOf({ ...scene.cage, positions: scene.cage.positions.map(() => 0) }));
    fails(['transfer', at('target.glb'), '--cage', flat], /flat\.glb: cage has no triangle with an area/);
    rmSync(bare);
    rmSync(flat);
  });

  test('a cage with a vertex too far away', () => {
    const far = write(
      'far-away.glb',
      glbOf({ ...scene.cage, positions: scene.cage.positions.map((x, i) => (i === 7 ? 1e30 : x)) }),
    );
    fails(
      ['transfer', at('target.glb'), '--cage', far],
      /far-away\.glb: cage\.positions\[7\] = .* is too far from the origin .* \(meshes\[0\]\.primitives\[0\], "only"\)/,
    );
    rmSync(far);
  });

  test('a texture that is not an image, and half of one', () => {
    const text = write('text.png', 'no image');
    fails(
      ['transfer', at('target.glb'), '--cage', at('cage.glb'), '--texture', text],
      /text\.png: is not a PNG, JPEG, WebP or KTX2 image/,
    );
    const half = write('half.png', paint().subarray(0, 60));
    fails(
      ['transfer', at('target.glb'), '--cage', at('cage.glb'), '--texture', half],
      /half\.png: is truncated: the PNG image is incomplete/,
    );
    rmSync(text);
    rmSync(half);
  });

  test('an output that cannot be written leaves the other unwritten, too', () => {
    const { status, stderr } = cagecast(
      'transfer',
      at('target.glb'),
      '--cage',
      at('cage.glb'),
      '-o',
      at('never.glb'),
      '--report',
      at('gone/never.json'),
    );
    assert.equal(status, 1);
    assert.match(stderr, /^cagecast: .*gone\/never\.json: cannot be written \(its folder does not exist\)\n$/);
    assert.ok(!existsSync(at('never.glb')));
    // A folder is no file that could be replaced.
    const kept = write('kept.glb', 'before');
    mkdirSync(at('folder'));
    const second = cagecast(
      'transfer',
      at('target.glb'),
      '--cage',
      at('cage.glb'),
      '-o',
      kept,
      '--report',
      at('folder'),
    );
    assert.deepEqual(
      [second.status, second.stderr],
      [1, `cagecast: ${at('folder')}: cannot be written (is a folder)\n`],
    );
    assert.equal(readFileSync(kept, 'utf8'), 'before');
    const third = cagecast('transfer', at('target.glb'), '--cage', at('cage.glb'), '-o', join(kept, 'never.glb'));
    assert.deepEqual(
      [third.status, third.stderr],
      [1, `cagecast: ${join(kept, 'never.glb')}: cannot be written (its folder is a file)\n`],
    );
    rmSync(kept);
    rmSync(at('folder'), { recursive: true });
    assert.ok(!readdirSync(folder).some((name) => name.endsWith('.tmp')));
  });

  test('a link to a file that does not exist yet is followed, two names of one folder are the same, and permissions stay', () => {
    mkdirSync(at('folder'));
    symlinkSync(at('folder'), at('way'));
    symlinkSync('folder/later.glb', at('link.glb'));
    assert.equal(cagecast('transfer', at('target.glb'), '--cage', at('cage.glb'), '-o', at('link.glb')).status, 0);
    assert.ok(lstatSync(at('link.glb')).isSymbolicLink());
    assert.equal(readFileSync(at('folder/later.glb')).toString('latin1', 0, 4), 'glTF');
    const clash = cagecast(
      'transfer',
      at('target.glb'),
      '--cage',
      at('cage.glb'),
      '-o',
      at('folder/same.glb'),
      '--report',
      at('way/same.glb'),
    );
    assert.equal(clash.status, 2);
    assert.match(clash.stderr, /would overwrite .*, which this command writes/);
    assert.deepEqual(readdirSync(at('folder')), ['later.glb']);
    chmodSync(at('folder/later.glb'), 0o600);
    assert.equal(
      cagecast('transfer', at('target.glb'), '--cage', at('cage.glb'), '-o', at('folder/later.glb')).status,
      0,
    );
    assert.equal(lstatSync(at('folder/later.glb')).mode & 0o777, 0o600);
    for (const name of ['link.glb', 'way', 'folder']) rmSync(at(name), { recursive: true });
  });

  test('a link is written through, and so is its target kept from being an input', () => {
    const [link, file] = [at('link.glb'), write('behind.glb', 'before')];
    symlinkSync(file, link);
    assert.equal(cagecast('transfer', at('target.glb'), '--cage', at('cage.glb'), '-o', link).status, 0);
    assert.ok(lstatSync(link).isSymbolicLink());
    assert.equal(readFileSync(file).toString('latin1', 0, 4), 'glTF');
    const { status, stderr } = cagecast('transfer', file, '--cage', at('cage.glb'), '-o', link);
    assert.deepEqual(
      [status, stderr],
      [2, `cagecast: ${link} would overwrite ${file}, which this command reads; choose another output\n`],
    );
    rmSync(link);
    rmSync(file);
  });

  test('a pipe is written to, not replaced', {
    skip: process.platform === 'win32' && 'there are no such pipes',
  }, () => {
    const [pipe, copy] = [at('pipe'), at('copy.json')];
    const script = `mkfifo "$1" && { cat "$1" > "$2" & "$3" dist/cli.js transfer "$4" --cage "$5" --report "$1" && test -p "$1" && wait; }`;
    const { status, stderr } = spawnSync(
      'sh',
      ['-c', script, 'sh', pipe, copy, process.execPath, at('target.glb'), at('cage.glb')],
      { encoding: 'utf8', timeout: 60000 },
    );
    assert.equal(status, 0, stderr);
    assert.equal((JSON.parse(readFileSync(copy, 'utf8')) as Report).parts.length, 1);
    rmSync(pipe);
    rmSync(copy);
  });

  test('inspect fails in the same way', () => {
    const { status, stderr } = cagecast('inspect', at('gone.glb'), '--cage', at('cage.glb'));
    assert.equal(status, 1);
    assert.match(stderr, /^cagecast: .*gone\.glb: no such file\n$/);
  });
});

describe('files damaged at random', () => {
  const values = [-1, 0, 1.5, 2 ** 31, 2 ** 53, 1e300, null, 'x', [], {}, true, [null], [{}]];

  for (let seed = 1; seed <= 24; ++seed) {
    test(`seed ${seed}: done, or one clear line`, () => {
      const next = random(seed);
      const pick = <T>(list: readonly T[]): T => list[Math.floor(next() * list.length)]!;
      const glb = unpackGlb(readFileSync(at('target.glb')));
      const places: [Record<string, unknown>, string][] = [];
      const walk = (value: unknown) => {
        if (typeof value !== 'object' || value === null) return;
        for (const key of Object.keys(value)) {
          places.push([value as Record<string, unknown>, key]);
          walk((value as Record<string, unknown>)[key]);
        }
      };
      walk(glb.json);
      const [owner, key] = pick(places);
      owner[key] = pick(values);
      for (let i = 0; i < 3; ++i) glb.bin[Math.floor(next() * glb.bin.length)] = Math.floor(next() * 256);
      const path = write(`damaged-${seed}.glb`, packGlb(glb));
      const out = at(`damaged-${seed}-out.glb`);
      const { status, stderr } = cagecast(
        'transfer',
        path,
        '--cage',
        at('cage.glb'),
        '--texture',
        at('paint.png'),
        '-o',
        out,
      );
      if (status === 0) return assert.equal(stderr, '');
      assert.equal(status, 1, stderr);
      assert.match(stderr, /^cagecast: [^\n]+\n$/);
      assert.doesNotMatch(stderr, /unexpectedly/);
      assert.ok(!existsSync(out));
    });
  }
});

describe('transfer', () => {
  test('reports the result of the package', () => {
    const { counts, areas, segments, parts, target, options, versions, timings } = report(at('target.glb'));
    // The file holds one primitive, so one group.
    const result = transfer(scene.cage, { ...scene.target, groups: undefined });
    assert.deepEqual(
      Object.values(counts),
      [0, 1, 2, 3].map((zone) => result.zones.filter((one) => one === zone).length),
    );
    assert.equal(target.vertices, result.zones.length);
    assert.equal(segments.length, result.segmentStats.length);
    segments.forEach((segment, s) => {
      const { points, exposedArea, coveredArea, coverage, culled } = result.segmentStats[s]!;
      assert.deepEqual(
        [segment.points, segment.exposedArea, segment.coveredArea, segment.coverage, segment.culled],
        [points, exposedArea, coveredArea, coverage, culled],
      );
      assert.equal(segment.vertices, result.segments.filter((one) => one === s).length);
    });
    const sum = areas.cosmetic + areas.occluded + areas.uncovered + areas.culled;
    assert.ok(Math.abs(sum - areas.total) < 1e-9 * areas.total);
    assert.deepEqual(
      parts.map(({ name, place, vertices, uvSet }) => [name, place, vertices, uvSet]),
      [['only', 'meshes[0].primitives[0]', target.vertices, null]],
    );
    assert.deepEqual(options, { preset: 'default', ...presetOptions(), keep: [], exclude: [], config: null });
    assert.deepEqual(
      parts.map(({ splitVertices }) => splitVertices),
      [null],
    );
    assert.match(versions.cagecast, /^\d+\.\d+\.\d+/);
    assert.ok(timings.total > 0);
  });

  test('the threshold is obeyed', () => {
    for (const threshold of [0, 0.2, 1]) {
      const { counts } = report(at('target.glb'), at('cage.glb'), '--threshold', String(threshold));
      const { zones } = transfer(scene.cage, { ...scene.target, groups: undefined }, { threshold });
      assert.equal(counts.culled, zones.filter((zone) => zone === 3).length);
    }
  });

  test('presets and single options are obeyed', () => {
    const painted = (...flags: string[]) => report(at('target.glb'), at('cage.glb'), ...flags).triangles.cosmetic;
    const expected = (options: object) =>
      transfer(scene.cage, { ...scene.target, groups: undefined }, options).cosmeticTriangles.filter((one) => one === 1)
        .length;
    assert.equal(painted(), expected({}));
    assert.equal(painted('--preset', 'paper'), expected({ preset: 'paper' }));
    assert.notEqual(expected({}), expected({ preset: 'paper' }));
    assert.equal(
      painted('--min-covered', '1', '--poke-through', '0.1', '--occlusion-reach', '0'),
      expected({ minCovered: 1, pokeThrough: 0.1, occlusionReach: 0 }),
    );
    const { options } = report(at('target.glb'), at('cage.glb'), '--preset', 'paper');
    assert.equal((options as { occlusionReach: unknown }).occlusionReach, 'Infinity');
  });

  test('--keep and --exclude lock parts by the names of nodes and materials', () => {
    const maker = new GlbMaker();
    const part = (group: number, name: string, material: string) => {
      const indices = scene.target.indices.filter((_, i, all) => scene.target.groups![all[i - (i % 3)]!] === group);
      const number = maker.mesh(
        { ...scene.target, indices },
        { material: (maker.json.materials ??= []).push({ name: material }) - 1 },
      );
      maker.node({ mesh: number, name });
    };
    part(0, 'head', 'skin');
    part(1, 'eye.left', 'glass');
    part(2, 'tongue', 'flesh');
    const path = write('named.glb', maker.finish());
    const culled = (...flags: string[]) => {
      const { segments } = report(path, at('cage.glb'), ...flags);
      // Vertices in no triangle are segments as well.
      return ['head', 'eye.left', 'tongue'].map((name) =>
        segments.filter((segment) => segment.part === name && segment.points > 1).every((segment) => segment.culled),
      );
    };
    assert.deepEqual(culled().slice(0, 2), [false, true]);
    assert.deepEqual(culled('--exclude', 'skin', '--keep', 'eye*').slice(0, 2), [true, false]);
    assert.deepEqual(culled('--exclude', 'head', '--exclude', 'tongue', '--keep', '*glas*'), [true, false, true]);
    assert.deepEqual((report(path, at('cage.glb'), '--keep', 'eye*').options as { keep: string[] }).keep, ['eye*']);
    for (const [flags, message] of [
      [
        ['--keep', 'eyes*'],
        /named\.glb: --keep eyes\*: no node or material has this name; there are: head, skin, eye\.left, glass, tongue, flesh$/,
      ],
      [['--exclude', 'eye?left'], /--exclude eye\?left: no node/],
      [['--keep', '*', '--exclude', 'skin'], /--keep \* and --exclude skin both match "head"$/],
    ] as const) {
      const { status, stderr } = cagecast('transfer', path, '--cage', at('cage.glb'), ...flags);
      assert.equal(status, 1);
      assert.match(stderr.trim(), message);
    }
    assert.equal(
      cagecast('inspect', path, '--cage', at('cage.glb'), '--exclude', 'head', '--json').stdout.includes(
        '"exclude": [\n      "head"',
      ),
      true,
    );
  });

  test('--keep and --exclude take a node that holds others for all below it, unless a part has its name', () => {
    const maker = new GlbMaker();
    const part = (group: number, name: string) => {
      const indices = scene.target.indices.filter((_, i, all) => scene.target.groups![all[i - (i % 3)]!] === group);
      return (maker.json.nodes ??= []).push({ name, mesh: maker.mesh({ ...scene.target, indices }) }) - 1;
    };
    const [head, eye, tongue] = [part(0, 'head'), part(1, 'eye'), part(2, 'tongue')];
    const holding = (name: string, ...children: number[]) => maker.json.nodes!.push({ name, children }) - 1;
    const mouth = holding('mouth', tongue);
    maker.node({ name: 'Face', children: [eye, mouth] });
    maker.node({ children: [holding('eye', head)] });
    const path = write('holding.glb', maker.finish());
    const culled = (...flags: string[]) => {
      const { segments } = report(path, at('cage.glb'), ...flags);
      return ['head', 'eye', 'tongue'].map((name) =>
        segments.filter((one) => one.part === name && one.points > 1).every(({ culledBy }) => culledBy === 'lock'),
      );
    };
    assert.deepEqual(culled('--exclude', 'Fa*'), [false, true, true]);
    assert.deepEqual(culled('--exclude', 'mouth'), [false, false, true]);
    assert.deepEqual(culled('--exclude', 'eye'), [false, true, false]);
    const { status, stderr } = cagecast(
      ...['transfer', path, '--cage', at('cage.glb'), '--exclude', 'Face', '--keep', 'tongue'],
    );
    assert.deepEqual([status, /--keep tongue and --exclude Face both match "tongue"/.test(stderr)], [1, true], stderr);
    const unnamed = cagecast('transfer', path, '--cage', at('cage.glb'), '--exclude', '');
    assert.deepEqual([unnamed.status, /--exclude : no node or material has this name/.test(unnamed.stderr)], [1, true]);
  });

  test('splits vertices so that no triangle stretches across the texture', async () => {
    const out = at('split.glb');
    const { parts } = report(at('target.glb'), at('cage.glb'), '-o', out);
    assert.deepEqual(await validate(out), []);
    const [before, written] = await Promise.all(
      [at('target.glb'), out].map(
        async (path) => (await new NodeIO().read(path)).getRoot().listMeshes()[0]!.listPrimitives()[0]!,
      ),
    );
    const result = transfer(scene.cage, { ...scene.target, groups: undefined });
    const added = assertTransferred(before!, written!, result);
    assert.ok(added > 0);
    assert.deepEqual(
      parts.map(({ splitVertices }) => splitVertices),
      [added],
    );
  });

  test('with --seams vertex: writes the UVs and zones of the package; all else stays byte for byte', async () => {
    const out = at('out.glb');
    assert.equal(
      cagecast('transfer', at('target.glb'), '--cage', at('cage.glb'), '--seams', 'vertex', '-o', out).status,
      0,
    );
    assert.deepEqual(await validate(out), []);
    const result = transfer(scene.cage, { ...scene.target, groups: undefined });
    const document = await new NodeIO().read(out);
    const primitive = document.getRoot().listMeshes()[0]!.listPrimitives()[0]!;
    const uvs = primitive.getAttribute('TEXCOORD_1')!;
    assert.ok(uvs.getArray() instanceof Uint16Array && uvs.getNormalized());
    for (let v = 0; v < uvs.getCount(); ++v)
      assertNear(storedUv(uvs, v), result.uvs.subarray(2 * v, 2 * v + 2), `vertex ${v}`);
    assert.ok(primitive.getAttribute('_NCZ')!.getArray() instanceof Uint8Array);
    assert.deepEqual([...primitive.getAttribute('_NCZ')!.getArray()!], [...result.zones]);
    const [before, afterwards] = [unpackGlb(readFileSync(at('target.glb'))), unpackGlb(readFileSync(out))];
    assert.deepEqual(afterwards.bin.subarray(0, before.bin.length), before.bin);
    assert.deepEqual(afterwards.json.accessors!.slice(0, before.json.accessors!.length), before.json.accessors);
  });

  test('without -o and --report nothing is written', () => {
    const files = readdirSync(folder).sort();
    const { status, stdout } = cagecast('transfer', at('target.glb'), '--cage', at('cage.glb'));
    assert.equal(status, 0);
    assert.match(stdout, /nothing written/);
    assert.deepEqual(readdirSync(folder).sort(), files);
  });

  test('the same input gives the same bytes', () => {
    for (const name of ['a.glb', 'b.glb'])
      cagecast('transfer', at('target.glb'), '--cage', at('cage.glb'), '--texture', at('paint.png'), '-o', at(name));
    assert.deepEqual(readFileSync(at('a.glb')), readFileSync(at('b.glb')));
  });
});

describe('what a target has is kept', () => {
  /** A target with a bit of everything. */
  function rich(): Uint8Array {
    const maker = new GlbMaker();
    const { json } = maker;
    const skin = { ...scene.target };
    const vertices = skin.positions.length / 3;
    const mesh = maker.mesh(skin, { material: 0, extras: { part: 'skin' } });
    const primitive = json.meshes[mesh]!.primitives[0]!;
    const normals = new Float32Array(skin.positions.length).map((_, i) => (i % 3 === 2 ? 1 : 0));
    primitive.attributes['NORMAL'] = maker.accessor(normals, 'VEC3');
    primitive.attributes['COLOR_0'] = maker.accessor(new Uint8Array(4 * vertices).fill(255), 'VEC4', {
      normalized: true,
    });
    primitive.attributes['JOINTS_0'] = maker.accessor(new Uint8Array(4 * vertices), 'VEC4');
    primitive.attributes['WEIGHTS_0'] = maker.accessor(
      new Float32Array(4 * vertices).map((_, i) => (i % 4 === 0 ? 1 : 0)),
      'VEC4',
    );
    primitive.attributes['_TEMPERATURE'] = maker.accessor(new Float32Array(vertices).fill(37), 'SCALAR');
    primitive.targets = [
      {
        POSITION: maker.accessor(
          skin.positions.map((x) => 0.1 * x),
          'VEC3',
        ),
      },
    ];
    json.meshes[mesh]!.weights = [0.25];
    json.meshes[mesh]!.extras = { targetNames: ['smile'] };
    const identity = new Float32Array([1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1]);
    json.skins = [{ joints: [1], inverseBindMatrices: maker.accessor(identity, 'MAT4') }];
    maker.node({ mesh, skin: 0, name: 'head', extras: { id: 7 }, extensions: { ACME_avatar: { node: 0, mesh: 0 } } });
    maker.node({ name: 'bone' });
    json.animations = [
      {
        name: 'nod',
        samplers: [
          {
            input: maker.accessor(new Float32Array([0, 1]), 'SCALAR', { min: [0], max: [1] }),
            output: maker.accessor(new Float32Array([0, 0, 0, 1, 0, 0, 0, 1]), 'VEC4'),
          },
        ],
        channels: [{ sampler: 0, target: { node: 1, path: 'rotation' } }],
      },
    ];
    const png = paint();
    json.images = [{ bufferView: maker.view(png), mimeType: 'image/png', name: 'freckles' }];
    json.textures = [{ source: 0 }];
    json.materials = [
      {
        name: 'skin',
        doubleSided: true,
        pbrMetallicRoughness: { baseColorTexture: { index: 0 }, roughnessFactor: 0.4 },
        extensions: { KHR_materials_sheen: { sheenRoughnessFactor: 0.5 }, ACME_secret: { a: [1, 2, { b: null }] } },
      },
    ];
    json.extensionsUsed = ['KHR_materials_sheen', 'ACME_secret', 'ACME_avatar'];
    json.extensions = { ACME_avatar: { meshes: [0], textures: [0] } };
    json.extras = { author: 'someone' };
    json.asset.generator = 'by hand';
    return maker.finish();
  }

  const subset = (whole: unknown, part: unknown, path = ''): void => {
    if (typeof part !== 'object' || part === null) {
      assert.deepEqual(whole, part, path);
      return;
    }
    for (const [key, value] of Object.entries(part)) {
      if (path === '/buffers/0' && key === 'byteLength') continue;
      subset((whole as Record<string, unknown>)[key], value, `${path}/${key}`);
    }
  };

  test('split vertices keep skins, morphs, colours and attributes of others; all else is as it was', async () => {
    const path = write('rich.glb', rich());
    const out = at('rich-split.glb');
    assert.equal(
      cagecast('transfer', path, '--cage', at('cage.glb'), '--texture', at('paint.png'), '-o', out).status,
      0,
    );
    assert.deepEqual(await validate(out), []);
    const read = async (file: string) =>
      (await new NodeIO().registerExtensions(ALL_EXTENSIONS).read(file)).getRoot().listMeshes()[0]!.listPrimitives();
    const [[before], [base, overlay]] = await Promise.all([read(path), read(out)]);
    assert.deepEqual(before!.listSemantics().sort(), [
      'COLOR_0',
      'JOINTS_0',
      'NORMAL',
      'POSITION',
      'TEXCOORD_0',
      'WEIGHTS_0',
      '_TEMPERATURE',
    ]);
    assert.equal(before!.listTargets().length, 1);
    assert.ok(assertTransferred(before!, base!, transfer(scene.cage, { ...scene.target, groups: undefined })) > 0);
    for (const name of ['NORMAL', 'JOINTS_0', 'WEIGHTS_0'])
      assert.deepEqual(overlay!.getAttribute(name)!.getArray(), base!.getAttribute(name)!.getArray());
    assert.deepEqual(
      overlay!.listTargets()[0]!.getAttribute('POSITION')!.getArray(),
      base!.listTargets()[0]!.getAttribute('POSITION')!.getArray(),
    );
    const [old, written] = [unpackGlb(readFileSync(path)).json, unpackGlb(readFileSync(out)).json];
    for (const field of ['nodes', 'skins', 'animations', 'extensions', 'extras', 'extensionsUsed', 'scenes'] as const)
      assert.deepEqual(written[field], old[field], field);
    assert.deepEqual(
      [written.meshes![0]!.weights, written.meshes![0]!.extras],
      [old.meshes![0]!.weights, old.meshes![0]!.extras],
    );
    assert.deepEqual(written.meshes![0]!.primitives[0]!.extras, { part: 'skin' });
  });

  test('quantised attributes of split vertices stay quantised, in words of four bytes', async () => {
    const maker = new GlbMaker();
    const vertices = scene.target.positions.length / 3;
    const padded = new Int16Array(4 * vertices);
    for (let i = 0; i < 3 * vertices; ++i)
      padded[4 * Math.floor(i / 3) + (i % 3)] = Math.round((scene.target.positions[i]! / 2) * 32767);
    const bufferView = maker.view(new Uint8Array(padded.buffer), { byteStride: 8 });
    const bound = (pick: (...values: number[]) => number) =>
      [0, 1, 2].map((k) => padded.filter((_, i) => i % 4 === k).reduce((a, b) => pick(a, b)));
    const POSITION =
      maker.json.accessors.push({
        bufferView,
        componentType: 5122,
        normalized: true,
        count: vertices,
        type: 'VEC3',
        min: bound(Math.min),
        max: bound(Math.max),
      } as GLTF.IAccessor) - 1;
    maker.node({
      mesh:
        maker.json.meshes.push({
          primitives: [
            { attributes: { POSITION }, indices: maker.accessor(scene.target.indices as Uint32Array, 'SCALAR') },
          ],
        }) - 1,
      scale: [2, 2, 2],
    });
    maker.json.extensionsUsed = maker.json.extensionsRequired = ['KHR_mesh_quantization'];
    const path = write('short.glb', maker.finish());
    const out = at('short-split.glb');
    const { parts } = report(path, at('cage.glb'), '-o', out);
    assert.ok(parts[0]!.splitVertices! > 0);
    assert.deepEqual(await validate(out), []);
    const read = async (file: string) =>
      (await new NodeIO().registerExtensions(ALL_EXTENSIONS).read(file))
        .getRoot()
        .listMeshes()[0]!
        .listPrimitives()[0]!
        .getAttribute('POSITION')!;
    const [before, written] = await Promise.all([read(path), read(out)]);
    assert.ok(written!.getArray() instanceof Int16Array && written!.getNormalized());
    assert.deepEqual(written!.getArray()!.subarray(0, 3 * vertices), before!.getArray());
  });

  test('with --seams vertex: skins, morphs, animations, materials, extras, colours, attributes of others, unknown extensions', async () => {
    const path = write('rich.glb', rich());
    assert.deepEqual(await validate(path), []);
    const out = at('rich-out.glb');
    const { status, stderr } = cagecast(
      'transfer',
      path,
      '--cage',
      at('cage.glb'),
      '--seams',
      'vertex',
      '--texture',
      at('paint.png'),
      '-o',
      out,
    );
    assert.equal(status, 0, stderr);
    assert.deepEqual(await validate(out), []);
    const [before, afterwards] = [unpackGlb(readFileSync(path)), unpackGlb(readFileSync(out))];
    subset(afterwards.json, before.json);
    assert.deepEqual(afterwards.bin.subarray(0, before.bin.length), before.bin);

    const [base, overlay] = afterwards.json.meshes![0]!.primitives as [GLTF.IMeshPrimitive, GLTF.IMeshPrimitive];
    const { attributes } = base;
    assert.deepEqual(overlay.targets, base.targets);
    for (const name of ['NORMAL', 'JOINTS_0', 'WEIGHTS_0']) assert.equal(overlay.attributes[name], attributes[name]);
    assert.equal(overlay.attributes['TEXCOORD_0'], attributes['TEXCOORD_1']);
    assert.equal(overlay.attributes['COLOR_0'], undefined);
    const material = afterwards.json.materials![overlay.material!]!;
    assert.equal(material.alphaMode, 'BLEND');
    assert.equal(material.doubleSided, true);
    const image =
      afterwards.json.images![
        afterwards.json.textures![material.pbrMetallicRoughness!.baseColorTexture!.index]!.source!
      ]!;
    const { byteOffset = 0, byteLength } = afterwards.json.bufferViews![image.bufferView!]!;
    assert.deepEqual(Buffer.from(afterwards.bin.subarray(byteOffset, byteOffset + byteLength)), paint());
  });

  test('the overlay has the cosmetic triangles only, and the vertices of its base', async () => {
    const out = at('overlay.glb');
    cagecast('transfer', at('target.glb'), '--cage', at('cage.glb'), '--texture', at('paint.png'), '-o', out);
    const [base, overlay] = (await new NodeIO().read(out)).getRoot().listMeshes()[0]!.listPrimitives();
    const { cosmeticTriangles } = transfer(scene.cage, { ...scene.target, groups: undefined });
    const expected = [...base!.getIndices()!.getArray()!].filter(
      (_, corner) => cosmeticTriangles[Math.floor(corner / 3)],
    );
    assert.deepEqual([...overlay!.getIndices()!.getArray()!], expected);
    assert.equal(overlay!.getAttribute('POSITION'), base!.getAttribute('POSITION'));
  });

  test('the overlay is lit as its base is, and as transparent', async () => {
    const io = new NodeIO().registerExtensions([KHRMaterialsUnlit]);
    const document = await io.read(at('target.glb'));
    const material = document.createMaterial().setAlphaMode('BLEND').setAlpha(0.25);
    material.setExtension('KHR_materials_unlit', document.createExtension(KHRMaterialsUnlit).createUnlit());
    for (const primitive of document.getRoot().listMeshes()[0]!.listPrimitives()) primitive.setMaterial(material);
    const path = write('unlit.glb', Buffer.from(await io.writeBinary(document)));
    const out = at('unlit-out.glb');
    cagecast('transfer', path, '--cage', at('cage.glb'), '--texture', at('paint.png'), '-o', out);
    assert.deepEqual(await validate(out), []);
    const [written, transformed] = [await io.read(out), await io.read(path)];
    await transformed.transform(cagecastTransform({ cage: scene.cage, texture: readFileSync(at('paint.png')) }));
    for (const made of [written, transformed]) {
      const overlay = made
        .getRoot()
        .listMaterials()
        .find((one) => one.getName() === 'Cagecast overlay')!;
      assert.ok(overlay.getExtension('KHR_materials_unlit'));
      assert.equal(overlay.getAlpha(), 0.25);
    }
  });

  test('an overlay is no part of the model when it is read again', () => {
    const [once, twice] = [at('once.glb'), at('twice.glb')];
    const run = (target: string, to: string) => report(target, at('cage.glb'), '--texture', at('paint.png'), '-o', to);
    const [first, second] = [run(at('target.glb'), once), run(once, twice)];
    assert.deepEqual(
      [second.triangles, second.parts.length, second.parts[0]!.uvSet],
      [first.triangles, first.parts.length, 'TEXCOORD_1'],
    );
    rmSync(once);
    rmSync(twice);
  });

  test('nothing to paint, no overlay', async () => {
    const far = write(
      'far.glb',
      glbOf({ ...scene.cage, positions: scene.cage.positions.map((x, i) => (i % 3 === 0 ? x + 50 : x)) }),
    );
    const { parts, counts } = report(at('target.glb'), far, '--texture', at('paint.png'), '-o', at('bare-out.glb'));
    assert.equal(counts.cosmetic, 0);
    assert.equal(parts[0]!.overlayTriangles, 0);
    assert.deepEqual(await validate(at('bare-out.glb'), 2), [
      '/meshes/0/primitives/0/attributes/TEXCOORD_0: UNUSED_OBJECT: This object may be unused.',
      '/meshes/0/primitives/0/attributes/TEXCOORD_1: UNUSED_OBJECT: This object may be unused.',
    ]);
    assert.equal(unpackGlb(readFileSync(at('bare-out.glb'))).json.meshes![0]!.primitives.length, 1);
  });

  test('a target without UVs gets its first set', () => {
    const path = write('plain.glb', glbOf({ positions: scene.target.positions, indices: scene.target.indices }));
    assert.deepEqual(
      report(path, at('cage.glb'), '-o', at('plain-out.glb')).parts.map(({ uvSet }) => uvSet),
      ['TEXCOORD_0'],
    );
  });
});

describe('the same mesh in other forms gives the same answer', () => {
  const expected = () => answer(at('target.glb'));
  const made = (name: string, make: (maker: GlbMaker) => void): string => {
    const maker = new GlbMaker();
    make(maker);
    return write(`${name}.glb`, maker.finish());
  };

  test('not indexed', () => {
    const positions = Float32Array.from(
      [...scene.target.indices].flatMap((v) => [...scene.target.positions.subarray(3 * v, 3 * v + 3)]),
    );
    const path = made('soup', (maker) => {
      const POSITION = maker.accessor(positions, 'VEC3');
      maker.node({ mesh: maker.json.meshes.push({ primitives: [{ attributes: { POSITION } }] }) - 1 });
    });
    const { segments, areas } = report(path);
    const plain = report(at('target.glb'));
    assert.deepEqual(
      segments.map(({ points }) => points),
      plain.segments.map(({ points }) => points),
    );
    assert.ok(Math.abs(areas.cosmetic - plain.areas.cosmetic) < 1e-6 * areas.total);
  });

  test('indices of 16 bits', () => {
    assert.deepEqual(
      answer(
        made('short', (maker) =>
          maker.node({ mesh: maker.mesh({ ...scene.target, indices: new Uint16Array(scene.target.indices) }) }),
        ),
      ),
      expected(),
    );
  });

  test('moved and turned by nodes, undone by their parents', () => {
    const path = made('nested', (maker) => {
      const inner = maker.node({ mesh: maker.mesh(scene.target), translation: [1, 2, 3], scale: [2, 2, 2] }, false);
      const middle = maker.node(
        { children: [inner], matrix: [1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0, -1, -2, -3, 1] },
        false,
      );
      maker.node({ children: [middle], scale: [0.5, 0.5, 0.5] });
    });
    assert.deepEqual(answer(path), expected());
  });

  test('mirrored by its node: outside stays outside', () => {
    const positions = scene.target.positions.map((x, i) => (i % 3 === 0 ? -x : x));
    const indices = new Uint32Array(scene.target.indices);
    for (let t = 0; t < indices.length; t += 3) [indices[t + 1], indices[t + 2]] = [indices[t + 2]!, indices[t + 1]!];
    assert.deepEqual(
      answer(made('mirrored', (maker) => maker.node({ mesh: maker.mesh({ positions, indices }), scale: [-1, 1, 1] }))),
      expected(),
    );
    const cage = {
      ...scene.cage,
      positions: scene.cage.positions.map((x, i) => (i % 3 === 1 ? -x : x)),
      indices: new Uint32Array(scene.cage.indices),
    };
    for (let t = 0; t < cage.indices.length; t += 3)
      [cage.indices[t + 1], cage.indices[t + 2]] = [cage.indices[t + 2]!, cage.indices[t + 1]!];
    const mirroredCage = made('mirrored-cage', (maker) => maker.node({ mesh: maker.mesh(cage), scale: [1, -1, 1] }));
    assert.deepEqual(report(at('target.glb'), mirroredCage).counts, report(at('target.glb')).counts);
  });

  test('a skinned mesh is not moved by its node, as the format demands', () => {
    const path = made('skinned', (maker) => {
      const mesh = maker.mesh(scene.target);
      const vertices = scene.target.positions.length / 3;
      const { attributes } = maker.json.meshes[mesh]!.primitives[0]!;
      attributes['JOINTS_0'] = maker.accessor(new Uint8Array(4 * vertices), 'VEC4');
      attributes['WEIGHTS_0'] = maker.accessor(
        new Float32Array(4 * vertices).map((_, i) => (i % 4 === 0 ? 1 : 0)),
        'VEC4',
      );
      maker.json.skins = [{ joints: [0] }];
      maker.node({ name: 'bone' });
      maker.node({ mesh, skin: 0, translation: [100, 0, 0] });
    });
    assert.deepEqual(answer(path), expected());
  });

  /** The target, 128 times as large as it is shown, held by two joints of a rig that is turned. @param bent Whether one has moved since. */
  const rigged = (maker: GlbMaker, times: number, bent = false): void => {
    const turned = [1, 0, 0, 0, 0, 0, 1, 0, 0, -1, 0, 0, 0, 0, 0, 1];
    const back = [1, 0, 0, 0, 0, 0, -1, 0, 0, 1, 0, 0, 0, 0, 0, 1].map((x, i) => (i < 12 ? x / times : x));
    const mesh = maker.mesh({ ...scene.target, positions: scene.target.positions.map((x) => times * x) });
    const vertices = scene.target.positions.length / 3;
    const { attributes } = maker.json.meshes[mesh]!.primitives[0]!;
    attributes['JOINTS_0'] = maker.accessor(
      Uint8Array.from({ length: 4 * vertices }, (_, i) => (i % 4 === 0 ? (i / 4) % 2 : 2)),
      'VEC4',
    );
    attributes['WEIGHTS_0'] = maker.accessor(
      Float32Array.from({ length: 4 * vertices }, (_, i) => (i % 4 === 0 ? 1 : 0)),
      'VEC4',
    );
    const inverses = [back, back.map((x, i) => (i === 12 ? x - 0.5 : x)), back.map(() => 7)]; // the third holds nothing
    maker.json.skins = [
      { joints: [1, 2, 0], inverseBindMatrices: maker.accessor(Float32Array.from(inverses.flat()), 'MAT4') },
    ];
    maker.json.nodes.push(
      { name: 'unused' },
      { name: 'rig', matrix: turned, children: [2] },
      { name: 'tip', translation: [bent ? 3 : 0.5, 0, 0] },
    );
    maker.json.scenes![0]!.nodes!.push(0, 1);
    maker.node({ mesh, skin: 0, translation: [100, 0, 0] });
  };

  test('a skinned mesh is where its skeleton holds it, whatever the unit and axes it is stored in', () => {
    assert.deepEqual(answer(made('rigged', (maker) => rigged(maker, 128))), expected());
  });

  test('a mesh with instances is where its first instance is', () => {
    const path = made('instanced', (maker) => {
      const TRANSLATION = maker.accessor(new Float32Array([0, 4, 0, 3, 0, 0]), 'VEC3');
      const ROTATION = maker.accessor(new Float32Array([0, 0, 1, 0, 0, 0, 0, 1]), 'VEC4');
      const SCALE = maker.accessor(new Float32Array([2, 2, 2, 1, 1, 1]), 'VEC3');
      // Undone by the node: moved back, turned back, and made small again.
      const instances = maker.node(
        {
          mesh: maker.mesh(scene.target),
          translation: [0, 2, 0],
          rotation: [0, 0, 1, 0],
          scale: [0.5, 0.5, 0.5],
          extensions: { EXT_mesh_gpu_instancing: { attributes: { TRANSLATION, ROTATION, SCALE } } },
        },
        false,
      );
      maker.node({ children: [instances] });
      maker.json.extensionsUsed = ['EXT_mesh_gpu_instancing'];
    });
    assert.deepEqual(answer(path), expected());
  });

  test('names, animations and materials of another shape are errors that name the element', () => {
    const { json, bin } = unpackGlb(glbOf(head(5, 8).target));
    const cases: [(broken: typeof json) => void, string][] = [
      [(to) => Object.assign(to, { animations: {} }), 'animations is not an array of objects'],
      [(to) => Object.assign(to, { animations: [null] }), 'animations is not an array of objects'],
      [
        (to) => Object.assign(to, { animations: [{ channels: {} }] }),
        'animations[0].channels is not an array of objects',
      ],
      [(to) => Object.assign(to.nodes![0]!, { name: 5 }), 'nodes[0].name is not a string'],
      [
        (to) => Object.assign(to.nodes![0]!, { extensions: { EXT_mesh_gpu_instancing: null } }),
        'nodes[0].extensions.EXT_mesh_gpu_instancing is not an object',
      ],
      [
        (to) =>
          Object.assign(to.meshes![0]!.primitives[0]!, { extensions: { KHR_materials_variants: { mappings: {} } } }),
        'meshes[0].primitives[0]: mappings of KHR_materials_variants is not an array of objects',
      ],
      [
        (to) => Object.assign(to.meshes![0]!.primitives[0]!, { mode: '4' }),
        'meshes[0].primitives[0].mode is not a whole number',
      ],
      [
        (to) => Object.assign(to, { materials: [{ pbrMetallicRoughness: { baseColorFactor: null } }] }),
        'materials[0].pbrMetallicRoughness.baseColorFactor is not an array of numbers',
      ],
    ];
    for (const [change, message] of cases) {
      const broken = structuredClone(json);
      change(broken);
      const path = at('shape.glb');
      writeFileSync(path, packGlb({ json: broken, bin }));
      const { status, stderr } = cagecast('transfer', path, '--cage', path);
      assert.deepEqual([status, stderr], [1, `cagecast: ${path}: ${message}\n`]);
    }
  });

  test('instances with broken references are errors', () => {
    for (const [TRANSLATION, says] of [
      [99, /nodes\[0\]: TRANSLATION of EXT_mesh_gpu_instancing is 99, not one of 2 accessors/],
      ['first', /is "first", not one of 2 accessors/],
      [1, /TRANSLATION of EXT_mesh_gpu_instancing is not of 3 finite numbers/],
    ] as const) {
      const path = made('instanced', (maker) => {
        const instances = { attributes: { TRANSLATION } } as object;
        maker.node({
          mesh: maker.mesh({ ...scene.target, uvs: undefined }),
          extensions: { EXT_mesh_gpu_instancing: instances },
        });
      });
      const { status, stderr } = cagecast('transfer', path, '--cage', at('cage.glb'));
      assert.equal(status, 1);
      assert.match(stderr, says);
    }
  });

  test('skins with broken references are errors', () => {
    for (const [skin, says] of [
      [{ joints: [99] }, /skins\[0\]\.joints/],
      [{ joints: 'all' }, /skins\[0\]\.joints is not an array of numbers/],
      [{ joints: [0], inverseBindMatrices: 99 }, /skins\[0\]\.inverseBindMatrices/],
    ] as const) {
      const path = made('stray', (maker) => {
        maker.json.skins = [skin as unknown as GLTF.ISkin];
        maker.node({ mesh: maker.mesh(scene.target), skin: 0 });
      });
      const { status, stderr } = cagecast('transfer', path, '--cage', at('cage.glb'), '-o', at('stray-out.glb'));
      assert.equal(status, 1);
      assert.match(stderr, says);
    }
  });

  test('a skinned mesh whose joints have moved is taken in its bind pose', () => {
    assert.deepEqual(answer(made('bent', (maker) => rigged(maker, 1, true))), expected());
    assert.deepEqual(answer(made('bent-large', (maker) => rigged(maker, 128, true))), expected());
  });

  test('strips and fans', async () => {
    // A strip and a fan of the same flat quad, against its two triangles.
    const positions = new Float32Array([-0.1, -0.1, 0.9, 0.1, -0.1, 0.9, -0.1, 0.1, 0.9, 0.1, 0.1, 0.9]);
    const form = (indices: number[], mode: number) =>
      made(`mode-${mode}`, (maker) => {
        const mesh = maker.mesh({ positions, indices: new Uint16Array(indices) }, {
          mode,
        } as Partial<GLTF.IMeshPrimitive>);
        maker.node({ mesh });
      });
    const triangles = answer(form([0, 1, 2, 2, 1, 3], 4));
    assert.deepEqual(answer(form([0, 1, 2, 3], 5)), triangles);
    assert.deepEqual(answer(form([1, 3, 2, 0], 6)), triangles);
    // All triangles of the overlay must face up, as the cage is above.
    for (const mode of [4, 5, 6]) {
      cagecast(
        'transfer',
        at(`mode-${mode}.glb`),
        '--cage',
        at('cage.glb'),
        '--texture',
        at('paint.png'),
        '-o',
        at('wound.glb'),
      );
      const overlay = (await new NodeIO().read(at('wound.glb'))).getRoot().listMeshes()[0]!.listPrimitives()[1]!;
      const corners = [...overlay.getIndices()!.getArray()!].map((v) =>
        overlay.getAttribute('POSITION')!.getElement(v, [] as number[]),
      );
      for (let i = 0; i < corners.length; i += 3) {
        const [a, b, c] = corners.slice(i, i + 3) as [number[], number[], number[]];
        const up = (b[0]! - a[0]!) * (c[1]! - a[1]!) - (b[1]! - a[1]!) * (c[0]! - a[0]!);
        assert.ok(up > 0, `mode ${mode}`);
      }
    }
  });

  test('sparse accessors', () => {
    const path = made('sparse', (maker) => {
      const base = scene.target.positions.slice();
      const moved = [3, 8, 20];
      const values = Float32Array.from(moved.flatMap((v) => [...base.subarray(3 * v, 3 * v + 3)]));
      for (const v of moved) base.fill(9, 3 * v, 3 * v + 3);
      const mesh = maker.mesh({ ...scene.target, positions: base });
      const accessor = maker.json.accessors[maker.json.meshes[mesh]!.primitives[0]!.attributes['POSITION']!]!;
      accessor.sparse = {
        count: moved.length,
        indices: { bufferView: maker.view(new Uint8Array(new Uint16Array(moved).buffer)), componentType: 5123 },
        values: { bufferView: maker.view(new Uint8Array(values.buffer)) },
      } as GLTF.IAccessorSparse;
      maker.node({ mesh });
    });
    assert.deepEqual(answer(path), expected());
  });

  test('quantised positions, normalised, with the scale in the node', () => {
    const rounded = scene.target.positions.map((x) => (Math.round((x / 2) * 32767) / 32767) * 2);
    const plain = write('rounded.glb', glbOf({ ...scene.target, positions: rounded }));
    const path = made('quantised', (maker) => {
      const vertices = rounded.length / 3;
      const padded = new Int16Array(4 * vertices);
      for (let v = 0; v < vertices; ++v)
        for (let k = 0; k < 3; ++k) padded[4 * v + k] = Math.round((rounded[3 * v + k]! / 2) * 32767);
      const bufferView = maker.view(new Uint8Array(padded.buffer), { byteStride: 8 });
      const POSITION =
        maker.json.accessors.push({
          bufferView,
          componentType: 5122,
          normalized: true,
          count: vertices,
          type: 'VEC3',
          min: [-32767, -32767, -32767],
          max: [32767, 32767, 32767],
        } as GLTF.IAccessor) - 1;
      const mesh =
        maker.json.meshes.push({
          primitives: [
            { attributes: { POSITION }, indices: maker.accessor(scene.target.indices as Uint32Array, 'SCALAR') },
          ],
        }) - 1;
      maker.node({ mesh, scale: [2, 2, 2] });
      maker.json.extensionsUsed = maker.json.extensionsRequired = ['KHR_mesh_quantization'];
    });
    assert.deepEqual(report(path).counts, report(plain).counts);
  });

  test('a glTF with its buffer and image beside it becomes one GLB', async () => {
    const { json, bin } = unpackGlb(glbOf(scene.target));
    mkdirSync(at('loose dir'), { recursive: true });
    writeFileSync(at('loose dir/mesh data.bin'), bin);
    copyFileSync(at('paint.png'), at('loose dir/skin.png'));
    json.buffers![0]!.uri = 'mesh%20data.bin';
    copyFileSync(at('paint.png'), at('loose dir/own name.png'));
    json.images = [{ uri: 'skin.png' }, { uri: 'own%20name.png', name: 'other' }];
    json.textures = [{ source: 0 }];
    json.materials = [{ pbrMetallicRoughness: { baseColorTexture: { index: 0 } } }];
    json.meshes![0]!.primitives[0]!.material = 0;
    const path = write('loose dir/target.gltf', JSON.stringify(json));
    assert.deepEqual(answer(path), expected());
    report(path, at('cage.glb'), '-o', at('packed.glb'));
    assert.deepEqual(await validate(at('packed.glb')), []);
    const document = await new NodeIO().read(at('packed.glb'));
    assert.deepEqual(Buffer.from(document.getRoot().listTextures()[0]!.getImage()!), paint());
    assert.deepEqual(
      unpackGlb(readFileSync(at('packed.glb'))).json.images!.map(({ name }) => name),
      ['skin', 'other'],
    );
  });

  test('images of kinds that only an extension admits are known by the endings of their names', () => {
    const { json, bin } = unpackGlb(glbOf(scene.target));
    json.images = [{ uri: 'skin.avif' }, { uri: 'skin.DDS' }, { uri: 'skin.bmp', mimeType: 'image/bmp' }];
    for (const { uri } of json.images) write(uri!, 'image');
    json.textures = [{ extensions: { EXT_texture_avif: { source: 0 } } }];
    json.extensionsUsed = ['EXT_texture_avif'];
    report(write('avif.glb', packGlb({ json, bin })), at('cage.glb'), '-o', at('avif-out.glb'));
    const { images } = unpackGlb(readFileSync(at('avif-out.glb'))).json;
    assert.deepEqual(
      images!.map(({ mimeType }) => mimeType),
      ['image/avif', 'image/vnd-ms.dds', 'image/bmp'],
    );
    delete json.images[2]!.mimeType;
    write('unknown.glb', packGlb({ json, bin }));
    const { status, stderr } = cagecast('transfer', at('unknown.glb'), '--cage', at('cage.glb'), '-o', at('none.glb'));
    assert.equal(status, 1);
    assert.match(stderr, /unknown\.glb: images\[2\] \("?skin\.bmp"?\) is of an unknown type; give it a mimeType\n$/);
  });

  test('buffers and images may be in data URIs of any kind', async () => {
    const { json, bin } = unpackGlb(glbOf(scene.target));
    const base64 = (bytes: Uint8Array) => Buffer.from(bytes).toString('base64');
    const escaped = (bytes: Uint8Array) => [...bytes].map((byte) => `%${byte.toString(16).padStart(2, '0')}`).join('');
    json.textures = [{ source: 0 }];
    json.materials = [{ pbrMetallicRoughness: { baseColorTexture: { index: 0 } } }];
    json.meshes![0]!.primitives[0]!.material = 0;
    for (const [kind, data] of [
      [';base64', base64],
      [';BASE64', base64],
      [';base64', (bytes: Uint8Array) => encodeURIComponent(base64(bytes))],
      ['', escaped],
    ] as const) {
      json.buffers![0]!.uri = `data:application/octet-stream${kind},${data(bin)}`;
      json.images = [{ uri: `data:image/png${kind},${data(paint())}` }];
      const path = write('embedded.gltf', JSON.stringify(json));
      assert.deepEqual(answer(path), expected());
      report(path, at('cage.glb'), '-o', at('embedded.glb'));
      const document = await new NodeIO().read(at('embedded.glb'));
      assert.deepEqual(Buffer.from(document.getRoot().listTextures()[0]!.getImage()!), paint(), kind);
    }
  });

  test('the joined buffer is not marked as a fallback', async () => {
    const path = made('stand-in', (maker) => {
      maker.node({ mesh: maker.mesh(scene.target) });
      maker.json.extensionsUsed = ['EXT_meshopt_compression'];
      maker.json.buffers![0]!.extensions = { EXT_meshopt_compression: { fallback: true } };
    });
    report(path, at('cage.glb'), '-o', at('stand-in-out.glb'));
    assert.deepEqual(
      unpackGlb(readFileSync(at('stand-in-out.glb'))).json.buffers!.map(({ extensions }) => extensions),
      [undefined],
    );
  });

  test('a file beside it may have a name that is not URI-encoded', () => {
    const { json, bin } = unpackGlb(glbOf(scene.target));
    json.buffers![0]!.uri = 'head 50%.bin';
    writeFileSync(at('head 50%.bin'), bin);
    writeFileSync(at('percent.gltf'), JSON.stringify(json));
    assert.deepEqual(answer(at('percent.gltf')), expected());
    report(at('percent.gltf'), at('cage.glb'), '-o', at('percent.glb'));
    const clash = cagecast('transfer', at('percent.gltf'), '--cage', at('cage.glb'), '-o', at('head 50%.gltf'));
    assert.equal(clash.status, 2);
    assert.match(clash.stderr, /head 50%\.bin: would be overwritten, but is read by this command/);
  });

  test('files beside the cage and masks are not overwritten either, nor one output by another', () => {
    const { json, bin } = unpackGlb(glbOf(scene.cage));
    json.buffers![0]!.uri = 'painted.bin';
    writeFileSync(at('painted.bin'), bin);
    writeFileSync(at('around.gltf'), JSON.stringify(json));
    const refused = (...args: string[]) => {
      const { status, stderr } = cagecast('transfer', at('target.glb'), ...args);
      assert.equal(status, 2, stderr);
      return stderr;
    };
    assert.match(
      refused('--cage', at('around.gltf'), '-o', at('painted.gltf')),
      /painted\.bin: would be overwritten, but is read by this command/,
    );
    assert.deepEqual(readFileSync(at('painted.bin')), Buffer.from(bin));
    assert.match(
      refused('--cage', at('cage.glb'), '-o', at('twice.gltf'), '--report', at('twice.bin')),
      /twice\.bin: would be written twice by this command/,
    );
    assert.ok(!existsSync(at('twice.gltf')) && !existsSync(at('twice.bin')));
  });

  test('an unknown extension of materials, though required, is accepted', () => {
    const path = made('required', (maker) => {
      maker.node({ mesh: maker.mesh(scene.target) });
      maker.json.extensionsUsed = maker.json.extensionsRequired = ['ACME_materials'];
    });
    assert.deepEqual(answer(path), expected());
  });
});

describe('several parts', () => {
  test('every primitive of every node is a group of its own', () => {
    const half = Math.floor(scene.target.indices.length / 6) * 3;
    const maker = new GlbMaker();
    const [a, b] = [
      maker.mesh({ ...scene.target, indices: scene.target.indices.subarray(0, half) }),
      maker.mesh({ ...scene.target, indices: scene.target.indices.subarray(half) }),
    ];
    maker.json.meshes[a]!.primitives.push(maker.json.meshes[b]!.primitives[0]!);
    maker.node({ mesh: a, name: 'split' });
    const { parts, segments, target } = report(write('parts.glb', maker.finish()));
    assert.equal(parts.length, 2);
    assert.equal(target.vertices, (2 * scene.target.positions.length) / 3);
    assert.ok(segments.length > report(at('target.glb')).segments.length);
  });

  test('a mesh that two nodes show gets UVs for each of them', async () => {
    const small = ball([0, 0, 0], () => 0.2, 8, 12);
    const maker = new GlbMaker();
    const mesh = maker.mesh(small);
    maker.node({ mesh, name: 'left', translation: [-0.6, 0, 0] });
    maker.node({ mesh, name: 'right', translation: [0.6, 0, 0] });
    const path = write('twins.glb', maker.finish());
    const out = at('twins-out.glb');
    const { parts } = report(path, at('cage.glb'), '--seams', 'vertex', '--texture', at('paint.png'), '-o', out);
    assert.deepEqual(
      parts.map(({ name }) => name),
      ['left', 'right'],
    );
    assert.deepEqual(await validate(out), []);
    const twins = [-0.6, 0.6].map((x) => ({
      ...small,
      positions: small.positions.map((value, i) => (i % 3 === 0 ? value + x : value)),
    }));
    const { uvs } = transfer(scene.cage, join3d(...twins));
    const document = await new NodeIO().read(out);
    document
      .getRoot()
      .listNodes()
      .forEach((node, n) => {
        const written = node.getMesh()!.listPrimitives()[0]!.getAttribute('TEXCOORD_1')!.getArray()!;
        const own = uvs.subarray((n * uvs.length) / 2, ((n + 1) * uvs.length) / 2);
        for (let i = 0; i < own.length; ++i)
          assert.ok(Math.abs(written[i]! / 65535 - own[i]!) < 1e-5, `UV ${i} of node ${n}`);
      });
    assert.notEqual(document.getRoot().listNodes()[0]!.getMesh(), document.getRoot().listNodes()[1]!.getMesh());
  });

  test('what animates a mesh, or is an expression of it, does so with its copies; what only another scene shows stays as it is', () => {
    const maker = new GlbMaker();
    const small = ball([0, 0, 0], () => 0.2, 8, 12);
    const mesh = maker.mesh(small, {
      targets: [{ POSITION: maker.accessor(new Float32Array(small.positions.length), 'VEC3') }],
    });
    for (const x of [-0.6, 0.6]) maker.node({ mesh, translation: [x, 0, 0] });
    maker.json.scenes!.push({ nodes: [maker.node({ mesh }, false)] });
    const target = { path: 'pointer', extensions: { KHR_animation_pointer: { pointer: `/meshes/${mesh}/weights` } } };
    const [input, output] = [
      maker.accessor(Float32Array.of(0, 1), 'SCALAR', { min: [0], max: [1] }),
      maker.accessor(Float32Array.of(0, 1), 'SCALAR'),
    ];
    maker.json.animations = [
      { samplers: [{ input, output }], channels: [{ sampler: 0, target: target as GLTF.IAnimationChannelTarget }] },
    ];
    maker.json.extensionsUsed = ['KHR_animation_pointer', 'VRM'];
    maker.json.extensions = {
      VRM: {
        blendShapeMaster: { blendShapeGroups: [{ name: 'A', binds: [{ mesh, index: 0, weight: 100 }] }, null] },
        firstPerson: { meshAnnotations: [{ mesh, firstPersonFlag: 'Auto' }] },
      },
    };
    report(
      write('moved-twins.glb', maker.finish()),
      at('cage.glb'),
      '--texture',
      at('paint.png'),
      '-o',
      at('moved-twins-out.glb'),
    );
    const { json } = unpackGlb(readFileSync(at('moved-twins-out.glb')));
    assert.deepEqual(
      json.nodes!.map((node) => node.mesh),
      [0, 1, 2],
    );
    assert.deepEqual(
      json.meshes!.map(({ primitives }) => primitives.length),
      [2, 2, 1],
    );
    assert.deepEqual(Object.keys(json.meshes![2]!.primitives[0]!.attributes), ['POSITION', 'TEXCOORD_0']);
    const pointers = json.animations![0]!.channels.map(
      ({ target }) =>
        (target.extensions as typeof target.extensions & { KHR_animation_pointer: { pointer: string } })
          .KHR_animation_pointer.pointer,
    );
    assert.deepEqual(
      pointers.sort(),
      [0, 1, 2].map((number) => `/meshes/${number}/weights`),
    );
    const all = [0, 1, 2];
    assert.deepEqual(json.extensions!['VRM'], {
      blendShapeMaster: {
        blendShapeGroups: [{ name: 'A', binds: all.map((number) => ({ mesh: number, index: 0, weight: 100 })) }, null],
      },
      firstPerson: { meshAnnotations: all.map((number) => ({ mesh: number, firstPersonFlag: 'Auto' })) },
    });
  });
});

describe('inspect', () => {
  interface Report {
    verdict: 'good' | 'usable' | 'unfit';
    findings: { code: string; weight: number; sentence: string; advice: string; numbers: object }[];
    counts: object;
    coverage: Record<string, number>;
    placement: { distances: Record<'p50' | 'p90' | 'p99' | 'max', number> };
    holes: object[];
    segments: { part: string }[];
  }
  const json = (cage: string): { status: number | null; report: Report } => {
    const { status, stdout } = cagecast('inspect', at('target.glb'), '--cage', cage, '--json');
    return { status, report: JSON.parse(stdout) as Report };
  };

  test('calls a good cage good, in text and JSON', () => {
    const text = cagecast('inspect', at('target.glb'), '--cage', at('cage.glb'));
    assert.equal(text.status, 0, text.stderr);
    for (const word of [
      /cosmetic/,
      /outside the cage/,
      /median/,
      /F = C\/E/,
      /beneath/,
      /(GOOD|USABLE): the cage fits/,
    ])
      assert.match(text.stdout, word);
    const { status, report: inspection } = json(at('cage.glb'));
    assert.equal(status, 0);
    assert.notEqual(inspection.verdict, 'unfit');
    assert.deepEqual(inspection.counts, report(at('target.glb')).counts);
    assert.ok(Math.abs(Object.values(inspection.coverage).reduce((a, b) => a + b) - 1) < 1e-9);
    assert.equal(inspection.holes.length, 1);
    assert.ok(inspection.segments.every(({ part }) => part === 'only'));
    const { p50, p90, p99, max } = inspection.placement.distances;
    assert.ok(p50 <= p90 && p90 <= p99 && p99 <= max && max < 1);
  });

  test('a cage that is inside out, too small, elsewhere is unfit: exit 3, the cause first, with advice', () => {
    const cages: [string, Mesh, string][] = [
      ['flipped', { ...scene.cage, indices: scene.cage.indices.slice().reverse() }, 'normalsInward'],
      ['shrunk', { ...scene.cage, positions: scene.cage.positions.map((x) => 0.8 * x) }, 'cageTooSmall'],
      [
        'moved',
        { ...scene.cage, positions: scene.cage.positions.map((x, i) => (i % 3 === 0 ? x + 0.3 : x)) },
        'cageMisplaced',
      ],
      [
        'away',
        { ...scene.cage, positions: scene.cage.positions.map((x, i) => (i % 3 === 0 ? x + 9 : x)) },
        'cageElsewhere',
      ],
    ];
    for (const [name, cage, code] of cages) {
      const path = write(`${name}.glb`, glbOf(cage));
      const { status, stdout } = cagecast('inspect', at('target.glb'), '--cage', path);
      assert.equal(status, 3, name);
      assert.match(stdout, /UNFIT: the cage does not fit\.\n✗ .*\.\n {2}→ /, name);
      const { status: again, report: inspection } = json(path);
      assert.equal(again, 3);
      assert.equal(inspection.verdict, 'unfit');
      assert.equal(inspection.findings[0]!.code, code);
    }
  });

  test('an advice to override a verdict comes with the flag that does', () => {
    const strict = ['inspect', at('target.glb'), '--cage', at('cage.glb'), '--threshold', '1'];
    const { stdout } = cagecast(...strict);
    assert.match(stdout, /✗ No part of the target may be painted: .*\n {2}→ .* To override: --keep "only"\n/);
    assert.doesNotMatch(cagecast(...strict, '--keep', 'only').stdout, /No part of the target|To override/);
  });

  test('--html writes a page that needs nothing else', () => {
    const page = at('inspection.html');
    const { status, stdout } = cagecast('inspect', at('target.glb'), '--cage', at('cage.glb'), '--html', page);
    assert.equal(status, 0);
    assert.match(stdout, /wrote .*inspection\.html/);
    const html = readFileSync(page, 'utf8');
    assert.doesNotMatch(html, /(?:src|href)="(?!data:)|https?:\/\/|<script/);
    const pictures = [...html.matchAll(/data:image\/png;base64,([^"]+)"/g)].map(([, data]) =>
      PNG.sync.read(Buffer.from(data!, 'base64')),
    );
    assert.equal(pictures.length, 8);
    // Something is to be seen in each, and not everywhere.
    for (const { data } of pictures) {
      const shown = data.filter((_, i) => i % 4 === 3).filter((alpha) => alpha > 0).length / (data.length / 4);
      assert.ok(shown > 0.1 && shown < 0.95, `${shown} of a picture shows the model`);
    }
    assert.match(html, /<svg[\s\S]*<path/);
    assert.equal(cagecast('inspect', at('target.glb'), '--cage', at('cage.glb'), '--html', at('page.txt')).status, 2);
    assert.equal(
      cagecast('inspect', at('target.glb'), '--cage', at('cage.glb'), '--html', at('gone/page.html')).status,
      1,
    );
  });
});

describe('models', () => {
  for (const model of modelFolders()) {
    test(`${basename(model)}: the file is valid, its vertices keep what they have, UVs and zones are the package's`, async () => {
      const [target, cage, out, reportFile] = [
        join(model, 'target.glb'),
        join(model, 'cage.glb'),
        at('model.glb'),
        at('model.json'),
      ];
      const { status, stderr } = cagecast(
        'transfer',
        target,
        '--cage',
        cage,
        '--texture',
        at('paint.png'),
        '-o',
        out,
        '--report',
        reportFile,
      );
      assert.equal(status, 0, stderr);
      assert.deepEqual(await validate(out), []);
      const result = transfer(await readPlain(cage), await readPlain(target));
      const { counts } = JSON.parse(readFileSync(reportFile, 'utf8')) as Report;
      assert.deepEqual(
        Object.values(counts),
        [0, 1, 2, 3].map((zone) => result.zones.filter((one) => one === zone).length),
      );

      const read = async (path: string) => (await new NodeIO().registerExtensions(ALL_EXTENSIONS).read(path)).getRoot();
      const [before, afterwards] = [await read(target), await read(out)];
      // In the order of meshes, which is that of the scene in all of these.
      const first = { vertex: 0, triangle: 0 };
      before.listMeshes().forEach((mesh, m) =>
        mesh.listPrimitives().forEach((primitive, p) => {
          assertTransferred(primitive, afterwards.listMeshes()[m]!.listPrimitives()[p]!, result, first);
          first.vertex += primitive.getAttribute('POSITION')!.getCount();
          first.triangle += primitive.getIndices()!.getCount() / 3;
        }),
      );
      assert.equal(first.vertex, result.zones.length);
    });
  }

  const assets = process.env['CAGECAST_ASSETS'];
  const formats = assets === undefined ? [] : readdirSync(join(assets, 'formats'));
  for (const name of formats) {
    test(`${name} opens, stays compressed, and is valid`, async () => {
      const out = at('format.glb');
      const path = join(assets!, 'formats', name);
      for (const seams of ['vertex', 'corner']) {
        const { status, stderr } = cagecast(
          'transfer',
          path,
          '--cage',
          at('cage.glb'),
          '--seams',
          seams,
          '--texture',
          at('paint.png'),
          '-o',
          out,
        );
        assert.equal(status, 0, stderr);
        assert.deepEqual(await validate(out), []);
        const { json } = unpackGlb(readFileSync(out));
        assert.ok(json.extensionsRequired!.some((extension) => /draco|meshopt/.test(extension)));
        // It opens again.
        assert.equal(cagecast('transfer', out, '--cage', at('cage.glb')).status, 0);
      }
    });
  }

  if (assets !== undefined) {
    test('a real sedan, with Draco in a data URI, gives the counts of the uncompressed one', () => {
      const cage = join(assets, 'kenney_sedan/cage.glb');
      assert.deepEqual(
        report(join(assets, 'formats/kenney_sedan_draco_datauri.gltf'), cage).counts,
        report(join(assets, 'kenney_sedan/target.glb'), cage).counts,
      );
    });
  }

  test('inspect finds bad cages of models unfit, for the right reason first, and good ones good or usable', () => {
    const reasons: [RegExp, string][] = [
      [/shifted|misaligned/, 'cageMisplaced'],
      [/shrunk/, 'cageTooSmall'],
      [/flipped/, 'normalsInward'],
    ];
    for (const model of modelFolders()) {
      for (const name of readdirSync(model).filter((file) => /^cage.*\.glb$/.test(file))) {
        const path = join(model, name);
        const { status, stdout } = cagecast('inspect', join(model, 'target.glb'), '--cage', path, '--json');
        const { verdict, findings } = JSON.parse(stdout) as { verdict: string; findings: { code: string }[] };
        const reason = reasons.find(([pattern]) => pattern.test(path))?.[1];
        assert.equal(status, reason ? 3 : 0, path);
        assert.equal(verdict === 'unfit', reason !== undefined, path);
        if (reason) assert.equal(findings[0]!.code, reason, path);
      }
    }
  });
});
