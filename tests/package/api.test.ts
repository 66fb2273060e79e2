import assert from 'node:assert/strict';
import { copyFileSync, readFileSync, writeFileSync } from 'node:fs';
import { before, describe, test } from 'node:test';
import { pathToFileURL } from 'node:url';
import {
  type ClassifyOptions,
  classify,
  init,
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
import { printed } from '../support/script.js';
import { temporaryFolder } from '../support/temporary.js';
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
    assert.equal(printed(script), '0 1');
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
    assert.equal(printed(script), 'unsupported unsupported\nfunction');
  });

  test('takes a module that is compiled already, as where nothing may be compiled or read', () => {
    const script = `
      import { readFileSync } from 'node:fs';
      const compiled = {};
      for (const name of ['cagecast', 'cagecast-cages'])
        compiled[name] = await WebAssembly.compile(readFileSync(new URL(import.meta.resolve('cagecast/' + name + '.wasm'))));
      WebAssembly.compile = globalThis.fetch = process.getBuiltinModule = () => { throw new Error('forbidden'); };
      const mesh = { positions: new Float32Array([0, 0, 0, 1, 0, 0, 0, 1, 0]), indices: new Uint32Array([0, 1, 2]), uvs: new Float32Array(6) };
      for (const entry of ['cagecast', 'cagecast/slim']) {
        const { init, transfer } = await import(entry);
        await init({ module: 'cagecast.wasm' }).catch(({ code, message }) => console.log(code, message));
        await init({ module: compiled.cagecast });
        console.log(transfer(mesh, mesh).zones.length);
      }
      const cages = await import('cagecast/cages');
      await cages.init({ module: compiled['cagecast-cages'] });
      console.log((await cages.excludedByName(['eye']))[0]);`;
    const failure = 'badOption init: options.module is "cagecast.wasm", neither a WebAssembly.Module nor its bytes';
    assert.equal(printed(script), `${failure}\n3\n${failure}\n3\ntrue`);
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
    assert.equal(printed(script), 'true');
  });
});

describe('a modified WebAssembly file', () => {
  const { at } = temporaryFolder('file');
  const start = (file: Buffer) => {
    writeFileSync(at('package.json'), '{ "type": "module" }');
    copyFileSync('dist/slim.js', at('slim.js'));
    writeFileSync(at('cagecast.wasm'), file);
    const script = `
      await (await import(${JSON.stringify(pathToFileURL(at('slim.js')).href)})).init().then(() => console.log('ready'), (error) => console.log(error.message));`;
    return printed(script);
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
        'motion',
        'holes',
        'seams',
        'classify',
        'total',
      ]);
      for (const time of Object.values(result.timings)) assert.ok(time >= 0 && Number.isFinite(time));
      assert.ok(result.peakBytes > 0);
    });
  }

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
});

describe('project and classify', () => {
  before(init);

  // That together they are a transfer is tested in any/call.test.ts.
  test('a projection has what can be decided later', () => {
    for (const { cage, target } of [head(8), soup(9)]) {
      const projection = project(cage, target);
      assert.ok(projection.visibility.every((found) => found <= Visibility.Beyond));
      assert.ok(projection.segmentStats.every(({ culled }) => !culled));
      assert.deepEqual(projection.indices, new Uint32Array(target.indices));
      assert.deepEqual(classify(projection).zones, transfer(cage, target).zones);
    }
  });

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

  test('a projection is plain data, which can be cloned and sent, and is not changed', () => {
    const { cage, target } = head(10, 8);
    const projection = project(cage, target);
    const copy = structuredClone(projection);
    assert.deepEqual(classify(copy, { threshold: 1 }), classify(projection, { threshold: 1 }));
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
      assert.deepEqual(bytes(transfer(cage, target)), bytes(transfer(cage, target, { preset: 'default' })));
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
    assert.notDeepEqual(transfer(cage, target).cosmeticTriangles, plain.cosmeticTriangles);
    const naive = transfer(cage, target, { steps: { projection: 'nearestVertex' } });
    assert.ok(naive.zones.every((zone) => zone === Zone.Cosmetic));
    const positions = new Float32Array([0, 0, 0, 1, 0, 0, 0, 1, 0, 1, 1e-4, 0, 1, 1, 0, 1e-4, 1, 0]);
    const apart = { positions, indices: new Uint32Array([0, 1, 2, 3, 4, 5]) };
    const segments = (mesh: Mesh, options: object) => transfer(smallest().cage, mesh, options).segmentStats.length;
    assert.equal(segments(apart, {}), 2);
    assert.equal(segments(apart, { weldTolerance: 1e-3 }), 1);
    assert.equal(segments({ ...apart, groups: new Uint32Array([0, 0, 0, 1, 1, 1]) }, { weldTolerance: 1e-3 }), 2);
    const painted = (options: object) =>
      transfer(cage, target, { preset: 'paper', ...options }).cosmeticTriangles.filter((one) => one === 1).length;
    assert.ok(painted({ steps: { partialTriangles: true } }) >= painted({}));
    assert.ok(painted({ steps: { holes: true } }) > painted({}));
    const culledBy = (options: object) =>
      transfer(smallHole().cage, smallHole().target, options).segmentStats.map((stats) => stats.culledBy);
    assert.deepEqual(culledBy({}), ['none', 'hole']);
    assert.deepEqual(culledBy({ steps: { holes: false } }), ['none', 'none']);
    assert.deepEqual(culledBy({ locks: { 1: 'exclude' } }), ['none', 'lock']);
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

  test('of groups and segments hold in transfer and classify', () => {
    const { cage, target } = head(5);
    const segment = transfer(cage, target).segments[0]!;
    const painted = (options: Pick<ClassifyOptions, 'parts' | 'locks'>, group: number) => {
      const result = transfer(cage, target, options);
      const decided = classify(project(cage, target), options);
      for (const name of ['zones', 'cosmeticTriangles', 'segmentStats'] as const)
        assert.deepEqual(decided[name], result[name]);
      const own = result.segmentStats.filter((stats) => stats.group === group);
      const isPainted = [...result.zones].some((zone, v) => target.groups![v] === group && zone === Zone.Cosmetic);
      assert.equal(
        isPainted,
        own.some(({ culled }) => !culled),
      );
      return isPainted;
    };
    for (const [options, group, expected] of [
      [{}, 0, true],
      [{ parts: { exclude: [0] } }, 0, false],
      [{ parts: { exclude: [0], keep: [0] } }, 0, true],
      [{ locks: { [segment]: 'exclude' } }, 0, false],
      [{ parts: { exclude: [0] }, locks: { [segment]: 'keep' } }, 0, true],
      [{ parts: { exclude: [0] }, locks: { [segment]: 'auto' } }, 0, true],
      [{}, 1, false],
    ] as [Pick<ClassifyOptions, 'parts' | 'locks'>, number, boolean][])
      assert.equal(painted(options, group), expected, JSON.stringify(options));
    const kept = transfer(
      cage,
      { ...target, names: ['skin', ['EYE', 'ball'], 'tongue'] },
      { parts: { keep: ['ey*'] } },
    );
    assert.ok(kept.segmentStats.every(({ group, culled }) => group !== 1 || !culled));
  });
});

describe('splitVertices', () => {
  before(init);

  test('input that cannot be split is an error', () => {
    const { target } = smallest();
    for (const [mesh, uvs, code, message] of [
      [target, new Float32Array(4), 'cornerUvCountMismatch', 'cornerUvs has 4 numbers, not 2 for each of 3 corners'],
      [target, [], 'badArgument', 'cornerUvs is of type Array, not a Float32Array'],
      [
        { ...target, indices: new Uint32Array([0, 1, 9]) },
        new Float32Array(6),
        'indexOutOfRange',
        'target.indices[2] = 9 is out of range (3 vertices)',
      ],
    ] as const)
      assert.throws(() => splitVertices(mesh, uvs as Float32Array), { code, message: `splitVertices: ${message}` });
  });
});
