import assert from 'node:assert/strict';
import { execFileSync } from 'node:child_process';
import { before, describe, test } from 'node:test';
import { classify, init, project, transfer, Zone, type Mesh, type TransferResult } from 'cagecast';
import { head, smallest, soup } from './scenes.js';

const arrays = ['uvs', 'zones', 'triangles', 'distances', 'segments', 'cosmeticTriangles'] as const;

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
    assert.equal(execFileSync(process.execPath, ['--input-type=module', '-e', script], { encoding: 'utf8' }).trim(), '0 1');
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
    assert.equal(execFileSync(process.execPath, ['--input-type=module', '-e', script], { encoding: 'utf8' }).trim(), 'unsupported unsupported\nfunction');
  });
});

describe('transfer', () => {
  before(init);

  test('gives every array its documented type and length', () => {
    const { cage, target } = head(1);
    const result = transfer(cage, target);
    const vertices = target.positions.length / 3;
    assert.ok(result.uvs instanceof Float32Array && result.uvs.length === 2 * vertices);
    assert.ok(result.zones instanceof Uint8Array && result.zones.length === vertices);
    assert.ok(result.triangles instanceof Uint32Array && result.triangles.length === vertices);
    assert.ok(result.distances instanceof Float32Array && result.distances.length === vertices);
    assert.ok(result.segments instanceof Uint32Array && result.segments.length === vertices);
    assert.ok(result.cosmeticTriangles instanceof Uint8Array && result.cosmeticTriangles.length === target.indices.length / 3);
    assert.equal(result.segmentStats.length, 1 + Math.max(...result.segments));
    for (const { points, area, exposedArea, coveredArea, coverage, culled } of result.segmentStats) {
      assert.ok(points > 0 && area > 0 && exposedArea <= area * (1 + 1e-9) && coveredArea <= exposedArea * (1 + 1e-9));
      assert.equal(coverage, exposedArea > 0 ? coveredArea / exposedArea : 0);
      assert.equal(culled, coveredArea < 0.5 * exposedArea);
    }
    assert.deepEqual(Object.keys(result.timings), ['weld', 'build', 'project', 'occluded', 'covered', 'segments', 'classify', 'total']);
    for (const time of Object.values(result.timings)) assert.ok(time >= 0 && Number.isFinite(time));
    assert.ok(result.peakBytes > 0);
  });

  test('paints the skin, not the eye under the hole nor the tongue inside', () => {
    const { cage, target } = head(1);
    const { zones, cosmeticTriangles } = transfer(cage, target);
    const share = (group: number, zone: number) => {
      const own = [...zones].filter((_, v) => target.groups![v] === group);
      return own.filter((one) => one === zone).length / own.length;
    };
    assert.ok(share(0, Zone.Cosmetic) > 0.9, `skin ${share(0, Zone.Cosmetic)}`);
    assert.equal(share(1, Zone.Cosmetic), 0);
    assert.equal(share(2, Zone.Occluded), 1);
    for (let t = 0; t < cosmeticTriangles.length; ++t) {
      const corners = [...target.indices.subarray(3 * t, 3 * t + 3)];
      assert.equal(cosmeticTriangles[t], corners.every((v) => zones[v] === Zone.Cosmetic) ? 1 : 0);
    }
  });

  test('gives the same bits every time', () => {
    for (const { name, cage, target } of [head(2), soup(3)]) {
      const first = bytes(transfer(cage, target));
      for (let i = 0; i < 3; ++i) assert.deepEqual(bytes(transfer(cage, target)), first, name);
    }
  });

  test('results are owned: later calls and a growing memory leave them as they were', () => {
    const { cage, target } = head(4, 10);
    const result = transfer(cage, target);
    const copy = bytes(result);
    const large = head(5, 150);
    transfer(large.cage, large.target);
    project(large.cage, large.target);
    assert.deepEqual(bytes(result), copy);
    for (const name of arrays) assert.ok(result[name].byteOffset === 0 && result[name].byteLength === result[name].buffer.byteLength, name);
    assert.equal(new Set(arrays.map((name) => result[name].buffer)).size, arrays.length);
  });

  test('inputs are only read', () => {
    const { cage, target } = head(6, 10);
    const copy = structuredClone({ cage, target });
    transfer(cage, target);
    assert.deepEqual({ cage, target }, copy);
  });

  test('takes indices of 8, 16 and 32 bits, views into larger buffers, and meshes without what they need not have', () => {
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
    const { uvs, zones } = transfer(cage, target, { projection: 'nearestVertex' });
    assert.ok(zones.every((zone) => zone === Zone.Cosmetic));
    const used = new Set(cage.indices);
    for (let v = 0; v < zones.length; ++v) {
      let [best, least] = [-1, Infinity];
      for (const c of used) {
        const distance = Math.hypot(...[0, 1, 2].map((k) => target.positions[3 * v + k]! - cage.positions[3 * c + k]!));
        if (distance < least - 1e-9) [best, least] = [c, distance];
      }
      const ties = [...used].filter((c) => Math.hypot(...[0, 1, 2].map((k) => target.positions[3 * v + k]! - cage.positions[3 * c + k]!)) < least + 1e-6);
      assert.ok(best >= 0 && ties.some((c) => cage.uvs![2 * c] === uvs[2 * v] && cage.uvs![2 * c + 1] === uvs[2 * v + 1]), `vertex ${v}`);
    }
  });
});

describe('project and classify', () => {
  before(init);

  test('give together what transfer gives, for any threshold', () => {
    for (const { name, cage, target } of [head(8), soup(9)]) {
      const projection = project(cage, target);
      assert.ok(projection.zones.every((zone) => zone !== Zone.Culled));
      assert.ok(projection.segmentStats.every(({ culled }) => !culled));
      assert.deepEqual(projection.indices, new Uint32Array(target.indices));
      for (const threshold of [0, 0.1, 0.37, 0.5, 0.9, 1]) {
        const expected = transfer(cage, target, { threshold });
        const decided = classify(projection, { threshold });
        assert.deepEqual(decided.zones, expected.zones, name);
        assert.deepEqual(decided.cosmeticTriangles, expected.cosmeticTriangles, name);
        assert.deepEqual(decided.segmentStats, expected.segmentStats, name);
      }
      assert.deepEqual(classify(projection).zones, transfer(cage, target).zones);
    }
  });

  test('a projection is plain data: it can be cloned and sent', () => {
    const { cage, target } = head(10, 8);
    const projection = project(cage, target);
    assert.deepEqual(classify(structuredClone(projection), { threshold: 0.2 }), classify(projection, { threshold: 0.2 }));
  });

  test('classify leaves the projection as it was', () => {
    const { cage, target } = head(11, 8);
    const projection = project(cage, target);
    const copy = structuredClone(projection);
    classify(projection, { threshold: 1 });
    assert.deepEqual(projection, copy);
  });
});
