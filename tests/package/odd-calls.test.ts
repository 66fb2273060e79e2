// Calls with objects that run code of their own, or only look right: a clear error, or the right result.
import assert from 'node:assert/strict';
import { before, describe, test } from 'node:test';
import { runInNewContext } from 'node:vm';
import { type CagecastError, classify, cutBorders, init, type Mesh, project, splitVertices, transfer } from 'cagecast';
import { checkGltf, checkImage, paintGlb, thumbnail, toGlb } from 'cagecast/gltf';
import { glbOf, tetrahedron } from '../support/gltf.js';
import { png } from './command/workplace.js';

const cage = tetrahedron(1);
const target: Mesh = tetrahedron(0.9);
const zonesOf = (mesh: Mesh, options = {}) => [...transfer(cage, mesh, options).zones];

before(init);

const fails = (call: () => unknown, code: string, message: RegExp) => {
  assert.throws(call, (error: CagecastError) => error.code === code && message.test(error.message));
  assert.deepEqual(zonesOf(target), [0, 0, 0, 0], 'the next call works');
};

describe('typed arrays', () => {
  test('a proxy, or an object that only looks like one, is named', () => {
    const positions = new Proxy(target.positions, {});
    fails(
      () => transfer(cage, { ...target, positions }),
      'badArgument',
      /^transfer: target\.positions is a proxy or imitation, not a Float32Array/,
    );
    const imitation = Object.setPrototypeOf(new Uint8Array(12), Float32Array.prototype);
    fails(() => transfer(cage, { ...target, positions: imitation }), 'badArgument', /is a proxy or imitation/);
    const reuse = { ...transfer(cage, target) };
    reuse.uvs = new Proxy(reuse.uvs, {});
    fails(() => transfer(cage, target, { reuse }), 'badOption', /options\.reuse\.uvs is a proxy or imitation/);
    const segments = new Proxy(reuse.segments, {});
    fails(
      () => cutBorders(cage, target, { ...reuse, segments }),
      'badArgument',
      /result\.segments is a proxy or imitation/,
    );
    fails(() => splitVertices(target, new Proxy(cage.uvs, {})), 'badArgument', /cornerUvs is a proxy or imitation/);
    const projection = { ...project(cage, target), recovery: new Proxy(new Uint32Array(4), {}) };
    fails(() => classify(projection), 'badArgument', /projection\.recovery is a proxy or imitation/);
  });

  test('have the length that they have, whatever they say', () => {
    for (const length of [3, 12_000]) {
      const positions = Object.defineProperty(target.positions.slice(), 'length', { value: length });
      assert.deepEqual(zonesOf({ ...target, positions }), [0, 0, 0, 0]);
    }
  });

  test('of another realm, and in shared memory, are read', () => {
    const positions = runInNewContext('new Float32Array(values)', { values: [...target.positions] });
    assert.deepEqual(zonesOf({ ...target, positions }), [0, 0, 0, 0]);
    const shared = new Float32Array(new SharedArrayBuffer(48)) as unknown as Float32Array<ArrayBuffer>;
    shared.set(target.positions);
    assert.deepEqual(zonesOf({ ...target, positions: shared }), [0, 0, 0, 0]);
  });

  test('of another realm are bytes of a file and of a texture', async () => {
    const foreign = (bytes: Uint8Array) => runInNewContext('Uint8Array.from(values)', { values: [...bytes] });
    const [file, around, paint] = [glbOf(target), glbOf(cage), png(200)].map(foreign);
    assert.ok(!(file instanceof Uint8Array));
    checkGltf(file);
    assert.equal(checkImage(paint)!.width, 4);
    assert.equal((await paintGlb(file, { cage: around, texture: paint })).triangles.painted, 4);
    assert.equal((await thumbnail(file, { size: 16 })).width, 16);
    const obj = foreign(Buffer.from('v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n'));
    assert.ok((await toGlb(obj)).length > 100);
  });
});

describe('code of the caller that runs during a call', () => {
  test('may call again', () => {
    const parts = {
      get exclude() {
        transfer(cage, target, { threshold: 0.9 });
        return [0];
      },
    };
    assert.deepEqual(zonesOf(target, { parts }), [3, 3, 3, 3]);
    class Nosy extends Float32Array {
      override set(...args: Parameters<Float32Array['set']>): void {
        transfer(cage, cage);
        super.set(...args);
      }
    }
    const reuse = { ...transfer(cage, target) };
    reuse.uvs = new Nosy(reuse.uvs) as never;
    const expected = transfer(cage, target);
    assert.deepEqual(
      { ...transfer(cage, target, { reuse }), uvs: expected.uvs, timings: 0 },
      { ...expected, timings: 0 },
    );
  });

  test('cannot change what has been checked', () => {
    const projection = project(cage, target);
    const options = {
      get threshold() {
        projection.segments.fill(4e9);
        return 0.5;
      },
    };
    fails(() => classify(projection, options), 'badArgument', /projection\.segments\[0\] = 4000000000 is out of range/);
    let reads = 0;
    const share = { segment: 0, exposedArea: 1, uncoveredArea: 1, hiddenArea: 1 };
    const holeShares = [Object.defineProperty({ ...share }, 'hole', { get: () => (reads++ === 0 ? 0 : 4e9) })];
    assert.deepEqual([...classify({ ...project(cage, target), holeShares: holeShares as never }).zones], [0, 0, 0, 0]);
    const { zones, segments } = transfer(cage, target);
    const segmentStats = [Object.defineProperty({}, 'culled', { get: () => segments.fill(4e9).length < 0 })] as never;
    fails(
      () => cutBorders(cage, target, { zones, segments, segmentStats }),
      'resultMismatch',
      /result\.segments\[0\] = 4000000000 is out of range/,
    );
  });
});
