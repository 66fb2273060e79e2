import assert from 'node:assert/strict';
import { execFileSync } from 'node:child_process';
import { copyFileSync, mkdtempSync, readFileSync, rmSync, writeFileSync } from 'node:fs';
import { tmpdir } from 'node:os';
import { join } from 'node:path';
import { after, before, describe, test } from 'node:test';
import { pathToFileURL } from 'node:url';
import {
  CagecastError,
  classify,
  init,
  type Lock,
  type Locks,
  type Mesh,
  type Preset,
  presetOptions,
  project,
  splitVertices,
  type TransferResult,
  transfer,
  Visibility,
  Zone,
} from 'cagecast';
import { head, smallest, smallHole, soup } from './scenes.js';

const arrays = ['uvs', 'zones', 'triangles', 'distances', 'segments', 'cosmeticTriangles', 'cornerUvs'] as const;
const presets: Preset[] = ['paper', 'default'];

function bytes(result: Pick<TransferResult, (typeof arrays)[number]>): Buffer[] {
  return arrays.map((name) => Buffer.from(new Uint8Array(result[name].buffer)));
}

describe('init', () => {
  test('resolves for any number of calls at once', async () => {
    await Promise.all(Array.from({ length: 10 }, () => init()));
    await init();
  });

  test('nothing starts at import: a process that only imports compiles nothing', () => {
    const script = `
      let compiled = 0;
      for (const name of ['compile', 'instantiate', 'compileStreaming']) {
        const original = WebAssembly[name];
        WebAssembly[name] = (...args) => (++compiled, original.apply(WebAssembly, args));
      }
      const { init } = await import('cagecast');
      const before = compiled;
      await Promise.all([init(), init(), init()]);
      await init();
      console.log(before, compiled);`;
    assert.equal(
      execFileSync(process.execPath, ['--input-type=module', '-e', script], { encoding: 'utf8' }).trim(),
      '0 1',
    );
  });

  test('a failed start may be tried again', () => {
    const script = `
      const { compile } = WebAssembly;
      WebAssembly.compile = () => Promise.reject(new WebAssembly.CompileError('no SIMD here'));
      const { init, transfer, CagecastError } = await import('cagecast');
      const failures = await Promise.allSettled([init(), init()]);
      console.log(failures.map(({ reason }) => reason instanceof CagecastError && reason.code).join(' '));
      WebAssembly.compile = compile;
      await init();
      console.log(typeof transfer);`;
    assert.equal(
      execFileSync(process.execPath, ['--input-type=module', '-e', script], { encoding: 'utf8' }).trim(),
      'unsupported unsupported\nfunction',
    );
  });

  test('the module within the script is the same that lies beside it', () => {
    const script = `
      import { readFileSync } from 'node:fs';
      const { compile } = WebAssembly;
      WebAssembly.compile = (bytes) => {
        console.log(Buffer.from(bytes).equals(readFileSync('dist/cagecast.wasm')));
        return compile(bytes);
      };
      await (await import('cagecast')).init();`;
    const said = execFileSync(process.execPath, ['--input-type=module', '-e', script], { encoding: 'utf8' }).trim();
    assert.equal(said, 'true');
  });
});

describe('a modified WebAssembly file', () => {
  const folder = mkdtempSync(join(tmpdir(), 'cagecast-file-'));
  after(() => rmSync(folder, { recursive: true, force: true }));
  const start = (file: Buffer) => {
    writeFileSync(join(folder, 'package.json'), '{ "type": "module" }');
    copyFileSync('dist/slim.js', join(folder, 'slim.js'));
    writeFileSync(join(folder, 'cagecast.wasm'), file);
    const script = `
      await (await import(${JSON.stringify(pathToFileURL(join(folder, 'slim.js')).href)})).init().then(() => console.log('ready'), (error) => console.log(error.message));`;
    return execFileSync(process.execPath, ['--input-type=module', '-e', script], { encoding: 'utf8' }).trim();
  };
  const shipped = readFileSync('dist/cagecast.wasm');

  test('runs if a tool has added to it', () => {
    const section = Buffer.from([0, 3, 2, 104, 105]); // one of its own, by the name of "hi"
    assert.equal(start(Buffer.concat([shipped.subarray(0, 8), section, shipped.subarray(8)])), 'ready');
  });

  test('is reported if it is something else', () => {
    assert.match(
      start(Buffer.from('<!doctype html><title>Not found</title>')),
      /cannot run the WebAssembly module .*cagecast\.wasm: .*magic/,
    );
  });
});

describe('transfer', () => {
  before(init);

  for (const preset of presets) {
    test(`gives every array its documented type and length: ${preset}`, () => {
      const { cage, target } = head(1);
      const result = transfer(cage, target, { preset });
      const vertices = target.positions.length / 3;
      assert.ok(result.uvs instanceof Float32Array && result.uvs.length === 2 * vertices);
      assert.ok(
        result.cornerUvs instanceof Float32Array &&
          result.cornerUvs.length === (preset === 'paper' ? 0 : 2 * target.indices.length),
      );
      assert.ok(result.zones instanceof Uint8Array && result.zones.length === vertices);
      assert.ok(result.triangles instanceof Uint32Array && result.triangles.length === vertices);
      assert.ok(result.distances instanceof Float32Array && result.distances.length === vertices);
      assert.ok(result.segments instanceof Uint32Array && result.segments.length === vertices);
      assert.ok(
        result.cosmeticTriangles instanceof Uint8Array && result.cosmeticTriangles.length === target.indices.length / 3,
      );
      assert.equal(result.segmentStats.length, 1 + Math.max(...result.segments));
      for (const [
        s,
        { points, area, exposedArea, coveredArea, coverage, depth, group, ratios, score, culled, culledBy },
      ] of result.segmentStats.entries()) {
        assert.ok(
          points > 0 && area > 0 && exposedArea <= area * (1 + 1e-9) && coveredArea <= exposedArea * (1 + 1e-9),
        );
        assert.ok(coveredArea > 0 ? depth > 0 && depth < 1 : depth === 0);
        assert.equal(coverage, exposedArea > 0 ? coveredArea / exposedArea : 0);
        if (preset === 'paper') assert.equal(culled, coveredArea < 0.5 * exposedArea);
        assert.equal(group, target.groups![result.segments.indexOf(s)]);
        assert.equal(score, Math.min(ratios.threshold, ratios.floor, ratios.depth, ratios.hole));
        assert.equal(culled, score < 1);
        assert.equal(culled, culledBy !== 'none');
      }
      assert.deepEqual(Object.keys(result.timings), [
        'weld',
        'build',
        'project',
        'occluded',
        'covered',
        'segments',
        'recheck',
        'holes',
        'seams',
        'classify',
        'total',
      ]);
      for (const time of Object.values(result.timings)) assert.ok(time >= 0 && Number.isFinite(time));
      assert.ok(result.peakBytes > 0);
    });

    test(`paints the skin, not the eye under the hole nor the tongue inside: ${preset}`, () => {
      const { cage, target } = head(1);
      const { zones, cosmeticTriangles } = transfer(cage, target, { preset });
      const share = (group: number, zone: number) => {
        const own = [...zones].filter((_, v) => target.groups![v] === group);
        return own.filter((one) => one === zone).length / own.length;
      };
      assert.ok(share(0, Zone.Cosmetic) > 0.9, `skin ${share(0, Zone.Cosmetic)}`);
      assert.equal(share(1, Zone.Cosmetic), 0);
      assert.equal(share(2, Zone.Occluded), 1);
      for (let t = 0; t < cosmeticTriangles.length; ++t) {
        const corners = [...target.indices.subarray(3 * t, 3 * t + 3)].map((v) => zones[v]);
        const some =
          corners.includes(Zone.Cosmetic) && corners.every((zone) => zone === Zone.Cosmetic || zone === Zone.Occluded);
        assert.equal(
          cosmeticTriangles[t],
          (preset === 'paper' ? corners.every((zone) => zone === Zone.Cosmetic) : some) ? 1 : 0,
        );
      }
    });
  }

  test('the preset is default unless another is named', () => {
    for (const { cage, target } of [head(1), soup(3)]) {
      assert.deepEqual(bytes(transfer(cage, target)), bytes(transfer(cage, target, { preset: 'default' })));
    }
    const { cage, target } = head(1);
    assert.notDeepEqual(
      transfer(cage, target).cosmeticTriangles,
      transfer(cage, target, { preset: 'paper' }).cosmeticTriangles,
    );
  });

  test('gives the same bits every time', () => {
    for (const { name, cage, target } of [head(2), soup(3)]) {
      const first = bytes(transfer(cage, target));
      for (let i = 0; i < 3; ++i) assert.deepEqual(bytes(transfer(cage, target)), first, name);
    }
  });

  test('areas of the largest meshes are exact', () => {
    const sides = [-1, 1, 1, 1, -1, -1, -1, -1, 1]; // a triangle across a box
    const at = (size: number, times: number): Mesh => ({
      positions: Float32Array.from({ length: 9 * times }, (_, i) => size * sides[i % 9]!),
      indices: Uint32Array.from({ length: 3 * times }, (_, i) => i),
    });
    const areaOf = (size: number) => {
      const cage = { ...at(size, 1), uvs: new Float32Array(6) };
      return transfer(cage, at(size, 7), { preset: 'paper' }).segmentStats[0]!.area / size / size;
    };
    assert.ok(Math.abs(areaOf(4e37) / areaOf(1) - 1) < 1e-6, `${areaOf(4e37)} ${areaOf(1)}`);
  });

  test('results are owned: later calls and a growing memory do not change them', () => {
    const { cage, target } = head(4, 10);
    const result = transfer(cage, target);
    const copy = bytes(result);
    const large = head(5, 150);
    transfer(large.cage, large.target);
    project(large.cage, large.target);
    assert.deepEqual(bytes(result), copy);
    for (const name of arrays)
      assert.ok(result[name].byteOffset === 0 && result[name].byteLength === result[name].buffer.byteLength, name);
    assert.equal(new Set(arrays.map((name) => result[name].buffer)).size, arrays.length);
    assert.ok(result.cornerUvs.length > 0);
  });

  test('inputs are only read', () => {
    const { cage, target } = head(6, 10);
    const copy = structuredClone({ cage, target });
    transfer(cage, target);
    assert.deepEqual({ cage, target }, copy);
  });

  test('takes indices of 8, 16 and 32 bits, views into larger buffers, and meshes without optional arrays', () => {
    const { cage, target } = smallest();
    const expected = bytes(transfer(cage, target));
    const padded = new Float32Array(20);
    padded.set(target.positions, 5);
    const variants: Mesh[] = [
      { ...target, indices: new Uint16Array(target.indices) },
      { ...target, indices: new Uint8Array(target.indices) },
      { ...target, positions: padded.subarray(5, 14) },
      { positions: target.positions, indices: target.indices },
      { ...target, uvs: undefined, groups: undefined },
    ];
    for (const variant of variants) assert.deepEqual(bytes(transfer(cage, variant)), expected);
  });

  test('groups keep vertices in one place apart, weldTolerance joins those that nearly meet', () => {
    const { cage } = smallest();
    const positions = new Float32Array([0, 0, 0, 1, 0, 0, 0, 1, 0, 1, 0, 0, 1, 1, 0, 0, 1, 0]);
    const target = { positions, indices: new Uint32Array([0, 1, 2, 3, 4, 5]) };
    assert.equal(transfer(cage, target).segmentStats.length, 1);
    assert.equal(transfer(cage, { ...target, groups: new Uint32Array([0, 0, 0, 1, 1, 1]) }).segmentStats.length, 2);
    const apart = { ...target, positions: positions.map((value, i) => (i >= 9 ? value + 1e-4 : value)) };
    assert.equal(transfer(cage, apart).segmentStats.length, 2);
    assert.equal(transfer(cage, apart, { weldTolerance: 1e-3 }).segmentStats.length, 1);
  });

  test("nearestVertex is the naive baseline: each vertex takes its nearest cage vertex's UV, nothing is filtered", () => {
    const { cage, target } = head(7, 8);
    const { uvs, zones } = transfer(cage, target, { steps: { projection: 'nearestVertex' } });
    assert.ok(zones.every((zone) => zone === Zone.Cosmetic));
    const used = new Set(cage.indices);
    for (let v = 0; v < zones.length; ++v) {
      let [best, least] = [-1, Infinity];
      for (const c of used) {
        const distance = Math.hypot(...[0, 1, 2].map((k) => target.positions[3 * v + k]! - cage.positions[3 * c + k]!));
        if (distance < least - 1e-9) [best, least] = [c, distance];
      }
      const ties = [...used].filter(
        (c) =>
          Math.hypot(...[0, 1, 2].map((k) => target.positions[3 * v + k]! - cage.positions[3 * c + k]!)) < least + 1e-6,
      );
      assert.ok(
        best >= 0 && ties.some((c) => cage.uvs![2 * c] === uvs[2 * v] && cage.uvs![2 * c + 1] === uvs[2 * v + 1]),
        `vertex ${v}`,
      );
    }
  });
});

describe('project and classify', () => {
  before(init);

  for (const preset of presets) {
    test(`together give the result of transfer, for any threshold: ${preset}`, () => {
      for (const { name, cage, target } of [head(8), soup(9)]) {
        const projection = project(cage, target, { preset });
        assert.ok(projection.visibility.every((found) => found <= Visibility.Uncovered));
        assert.ok(projection.segmentStats.every(({ culled }) => !culled));
        assert.deepEqual(projection.indices, new Uint32Array(target.indices));
        for (const threshold of [0, 0.1, 0.37, 0.5, 0.9, 1]) {
          const expected = transfer(cage, target, { preset, threshold });
          const decided = classify(projection, { threshold });
          assert.deepEqual(decided.zones, expected.zones, name);
          assert.deepEqual(decided.cosmeticTriangles, expected.cosmeticTriangles, name);
          assert.deepEqual(decided.segmentStats, expected.segmentStats, name);
        }
        assert.deepEqual(classify(projection).zones, transfer(cage, target, { preset }).zones);
      }
    });
  }

  test('classify has the preset of the projection unless it is given another', () => {
    const { cage, target } = head(8);
    const projection = project(cage, target);
    assert.deepEqual(classify(projection), classify(projection, { preset: 'default' }));
    const { floor, partialTriangles } = presetOptions('paper').steps;
    assert.deepEqual(
      classify(projection, { preset: 'paper' }),
      classify(projection, { steps: { floor, partialTriangles } }),
    );
    assert.notDeepEqual(
      classify(projection, { preset: 'paper' }).cosmeticTriangles,
      classify(projection).cosmeticTriangles,
    );
  });

  test('a projection is plain data: it can be cloned and sent', () => {
    const { cage, target } = head(10, 8);
    const projection = project(cage, target);
    assert.deepEqual(
      classify(structuredClone(projection), { threshold: 0.2 }),
      classify(projection, { threshold: 0.2 }),
    );
  });

  test('classify does not change the projection', () => {
    const { cage, target } = head(11, 8);
    const projection = project(cage, target);
    const copy = structuredClone(projection);
    classify(projection, { threshold: 1 });
    assert.deepEqual(projection, copy);
  });
});

describe('options', () => {
  before(init);

  test('a preset is the sum of its single options', () => {
    assert.equal(presetOptions().seams, 'corner');
    assert.deepEqual(presetOptions(), presetOptions('default'));
    const paper = presetOptions('paper');
    const { projection, ...toggles } = paper.steps;
    assert.deepEqual([paper.seams, paper.occlusionReach, projection], ['vertex', Infinity, 'nearestPoint']);
    assert.deepEqual(new Set(Object.values(toggles)), new Set([false]));
    for (const { cage, target } of [head(1), soup(3)]) {
      for (const preset of presets) {
        const other = presets.find((one) => one !== preset)!;
        assert.deepEqual(
          bytes(transfer(cage, target, { preset: other, ...presetOptions(preset) })),
          bytes(transfer(cage, target, { preset })),
          preset,
        );
      }
    }
  });

  test('each single option reaches the core', () => {
    const { cage, target } = head(4);
    const plain = transfer(cage, target, { preset: 'paper' });
    assert.equal(
      transfer(cage, target, { preset: 'paper', seams: 'corner' }).cornerUvs.length,
      2 * target.indices.length,
    );
    assert.equal(transfer(cage, target, { seams: 'vertex' }).cornerUvs.length, 0);
    const painted = (options: object) =>
      transfer(cage, target, { preset: 'paper', ...options }).cosmeticTriangles.filter((one) => one === 1).length;
    assert.ok(painted({ steps: { partialTriangles: true } }) >= painted({}));
    assert.ok(painted({ steps: { holes: true } }) > painted({}));
    const culledBy = (options: object) =>
      transfer(smallHole().cage, smallHole().target, options).segmentStats.map((stats) => stats.culledBy);
    assert.deepEqual(culledBy({}), ['none', 'hole']);
    assert.deepEqual(culledBy({ steps: { holes: false } }), ['none', 'none']);
    assert.deepEqual(culledBy({ locks: { segments: { 1: 'exclude' } } }), ['none', 'lock']);
    assert.deepEqual(culledBy({ threshold: 1, steps: { floor: false, holes: false } }), ['none', 'coverage']);
    assert.ok(painted({ threshold: 0, minCovered: 1, steps: { floor: true } }) < painted({ threshold: 0 }));
    assert.ok(
      transfer(cage, target, { preset: 'paper', occlusionReach: 0 }).zones.filter((zone) => zone === Zone.Occluded)
        .length <= plain.zones.filter((zone) => zone === Zone.Occluded).length,
    );
  });
});

describe('locks', () => {
  before(init);
  const { cage, target } = head(5);
  const vertices = (result: { zones: Uint8Array }, group: number) =>
    [...result.zones].filter((_, v) => target.groups![v] === group);
  /** The same locks in transfer and in classify. */
  const locked = (locks: Locks) => {
    const result = transfer(cage, target, { locks });
    const decided = classify(project(cage, target), { locks });
    assert.deepEqual(decided.zones, result.zones);
    assert.deepEqual(decided.cosmeticTriangles, result.cosmeticTriangles);
    assert.deepEqual(decided.segmentStats, result.segmentStats);
    assert.ok(result.timings.total >= result.timings.classify);
    return result;
  };

  test('exclude and keep a group regardless of its areas', () => {
    assert.ok(vertices(locked({}), 0).includes(Zone.Cosmetic));
    const excluded = locked({ groups: { 0: 'exclude' } });
    assert.ok(!vertices(excluded, 0).includes(Zone.Cosmetic));
    assert.ok(excluded.segmentStats.filter(({ group }) => group === 0).every(({ culled }) => culled));
    assert.ok(!vertices(locked({}), 1).includes(Zone.Cosmetic));
    const kept = locked({ groups: { 1: 'keep', 2: 'auto' } });
    assert.ok(kept.segmentStats.filter(({ group }) => group === 1).every(({ culled }) => !culled));
    assert.ok(!vertices(kept, 1).includes(Zone.Culled));
  });

  test('a lock of a segment overrides one of its group', () => {
    const segment = transfer(cage, target).segments[0]!;
    const locks = (lock: Lock) => ({ groups: { 0: 'exclude' }, segments: { [segment]: lock } }) as const;
    assert.ok(vertices(locked(locks('keep')), 0).includes(Zone.Cosmetic));
    assert.deepEqual(locked(locks('auto')).zones, locked({}).zones);
    assert.deepEqual(locked({ segments: { [segment]: 'exclude' } }).zones, locked({ groups: { 0: 'exclude' } }).zones);
  });

  test('a segment or group that does not exist cannot be locked', () => {
    const fails = (locks: unknown, message: RegExp) => {
      for (const call of [
        () => transfer(cage, target, { locks: locks as Locks }),
        () => classify(project(cage, target), { locks: locks as Locks }),
      ]) {
        assert.throws(
          call,
          (error) => error instanceof CagecastError && error.code === 'badOption' && message.test(error.message),
        );
      }
    };
    fails({ groups: { 7: 'keep' } }, /options\.locks\.groups\[7\] is given, but there is no segment of group 7$/);
    fails({ segments: { 99: 'exclude' } }, /options\.locks\.segments\[99\] is given, but there is no segment 99$/);
    fails(
      { segments: { 0: 'maybe' } },
      /options\.locks\.segments\[0\] = "maybe" is unknown; there are: "auto", "keep", "exclude"$/,
    );
    fails({ segment: {} }, /options\.locks\.segment is unknown; there are: segments, groups$/);
    fails('keep', /options\.locks is "keep", not an object$/);
    fails({ groups: 1 }, /options\.locks\.groups is 1, not an object/);
    fails({ groups: new Set([0]) }, /options\.locks\.groups is .*, not an object/);
    fails(new Map([['groups', { 0: 'exclude' }]]), /options\.locks is .*, not an object/);
  });
});

describe('splitVertices', () => {
  before(init);

  test('gives every corner its UV, and copies no vertex more often than it must', () => {
    for (const { name, cage, target } of [head(6), soup(7)]) {
      const { cornerUvs } = transfer(cage, target);
      const { sources, indices, uvs } = splitVertices(target, cornerUvs);
      assert.equal(indices.length, target.indices.length);
      assert.equal(uvs.length, 2 * sources.length);
      const kinds = new Set<string>();
      indices.forEach((vertex, corner) => {
        assert.equal(sources[vertex], target.indices[corner], name);
        assert.deepEqual(
          [uvs[2 * vertex]! + 0, uvs[2 * vertex + 1]! + 0],
          [cornerUvs[2 * corner]! + 0, cornerUvs[2 * corner + 1]! + 0],
          name,
        );
        kinds.add(`${sources[vertex]} ${cornerUvs[2 * corner]! + 0} ${cornerUvs[2 * corner + 1]! + 0}`);
      });
      assert.equal(sources.length, kinds.size);
      if (name.startsWith('head')) assert.ok(sources.length > new Set(target.indices).size, 'the cage has a seam');
    }
  });

  test('input that cannot be split is an error', () => {
    const { target } = smallest();
    const fails = (call: () => unknown, code: string, message: RegExp) =>
      assert.throws(
        call,
        (error) => error instanceof CagecastError && error.code === code && message.test(error.message),
      );
    fails(
      () => splitVertices(target, new Float32Array(4)),
      'cornerUvCountMismatch',
      /^splitVertices: cornerUvs has 4 numbers, not 2 for each of 3 corners$/,
    );
    fails(
      () => splitVertices(target, [] as unknown as Float32Array),
      'badArgument',
      /^splitVertices: cornerUvs is of type Array, not a Float32Array$/,
    );
    fails(
      () => splitVertices({ ...target, indices: new Uint32Array([0, 1, 9]) }, new Float32Array(6)),
      'indexOutOfRange',
      /^splitVertices: target\.indices\[2\] = 9 is out of range \(3 vertices\)$/,
    );
  });
});
