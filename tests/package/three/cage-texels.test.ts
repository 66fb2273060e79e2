import assert from 'node:assert/strict';
import { test } from 'node:test';
import { BoxGeometry, type BufferAttribute, type BufferGeometry, PlaneGeometry, SphereGeometry, Vector3 } from 'three';
import { disjoint, type Rect } from '../../../wasm/src/three/gpu/rect';
import { type CageMesh, CageTexels, kFacing, type SurfacePoint } from '../../../wasm/src/three/painting/cage-texels';
import { Stroke } from '../../../wasm/src/three/painting/stroke';

const kSize = 128;

function cageOf(geometry: BufferGeometry, moveUvs = 0): CageMesh {
  const array = (name: string): Float32Array => geometry.getAttribute(name).array as Float32Array;
  return {
    positions: array('position'),
    indices: Uint32Array.from(geometry.index!.array),
    uvs: array('uv').map((value) => value + moveUvs),
  };
}

/** A box whose six sides are islands of their own, three in a row. */
function box(): BufferGeometry {
  const geometry = new BoxGeometry(2, 2, 2);
  const uv = geometry.getAttribute('uv');
  for (let vertex = 0; vertex < uv.count; vertex++) {
    const side = Math.floor(vertex / 4);
    uv.setXY(
      vertex,
      ((side % 3) + 0.2 + 0.6 * uv.getX(vertex)) / 3,
      (Math.floor(side / 3) + 0.2 + 0.6 * uv.getY(vertex)) / 2,
    );
  }
  return geometry;
}

/** Numbers from 0 to 1, the same in every run. */
function random(seed: number): () => number {
  return () => {
    seed = (Math.imul(seed, 1664525) + 1013904223) >>> 0;
    return seed / 2 ** 32;
  };
}

test('each texel of a chart maps to its point on the cage, and the gutter to the border', () => {
  const texels = new CageTexels(cageOf(box()), kSize);
  // The middle of the fifth side, which faces +z.
  const { point, normal } = texels.at(1.5 / 3, 1.5 / 2)!;
  assert.ok(point.distanceTo(new Vector3(0, 0, 1)) < 1e-6 && normal.distanceTo(new Vector3(0, 0, 1)) < 1e-6);
  const left = (1 + 0.2) / 3;
  const border = texels.at(left - 2.5 / kSize, 1.5 / 2)!;
  const { x, y, z } = border.point;
  const texel = 2 / (0.2 * kSize);
  assert.ok(x === -1 && z === 1 && Math.abs(y) < 1.5 * texel, `${x}, ${y}, ${z}`);
  assert.equal(texels.at(left - 6 / kSize, 1.5 / 2), undefined, 'nothing is there');
});

test('UVs outside 0..1 repeat', () => {
  const [inside, outside] = [0, 2.5].map((move) => new CageTexels(cageOf(new SphereGeometry(1, 24, 16), move), kSize));
  for (let i = 0; i < 50; i++) {
    const [u, v] = [(i * 0.379) % 1, 0.2 + ((i * 0.713) % 0.6)];
    const [a, b] = [inside!.at(u, v), outside!.at(u + 2.5, v + 2.5)];
    assert.ok(a && b && a.point.distanceTo(b.point) < 1e-3, `${u}, ${v}`);
  }
});

test('`touched` covers every texel near the brush that faces it, and `enclosed` no others', () => {
  const next = random(7);
  let enclosed = 0;
  for (const geometry of [box(), new SphereGeometry(1, 24, 16)]) {
    const texels = new CageTexels(cageOf(geometry), kSize);
    const places: [u: number, v: number, place: SurfacePoint][] = [];
    for (let row = 0; row < kSize; row++) {
      for (let column = 0; column < kSize; column++) {
        const [u, v] = [(column + 0.5) / kSize, (row + 0.5) / kSize];
        const place = texels.at(u, v);
        if (place) places.push([u, v, place]);
      }
    }
    for (let i = 0; i < 30; i++) {
      const radius = 0.02 + 0.3 * next();
      const from = places[Math.floor(next() * places.length)]![2];
      const to =
        places.find(([, , { point }]) => point !== from.point && point.distanceTo(from.point) < 0.3)?.[2] ?? from;
      const rects = texels.touched({ from, to, radius }, new Set());
      const way = new Vector3().subVectors(to.point, from.point);
      const patches = new Set(texels.enclosed({ from, to, radius }));
      enclosed += patches.size;
      assert.equal(texels.touched({ from, to, radius }, patches).length, rects.length - patches.size);
      for (const [u, v, { point, normal }] of places) {
        const isEnclosed = patches.has(texels.owners[Math.floor(v * kSize) * kSize + Math.floor(u * kSize)]!);
        const facing = [normal.dot(from.normal), normal.dot(to.normal)];
        if (isEnclosed) assert.ok(Math.min(...facing) >= kFacing, 'all along');
        if (Math.max(...facing) < kFacing) continue;
        const share = Math.min(
          1,
          Math.max(0, new Vector3().subVectors(point, from.point).dot(way) / Math.max(way.lengthSq(), 1e-30)),
        );
        const distance = point.distanceTo(from.point.clone().addScaledVector(way, share));
        if (isEnclosed) assert.ok(distance < radius + 1e-6, `${distance} from the way of a brush of ${radius}`);
        if (distance > radius) continue;
        assert.ok(
          rects.some(({ left, right, top, bottom }) => left <= u && u <= right && top <= v && v <= bottom),
          `${u}, ${v} of ${JSON.stringify(rects)}`,
        );
      }
    }
  }
  assert.ok(enclosed > 100, `${enclosed} triangles were enclosed`);
});

test('`disjoint` covers the same texels without overlap', () => {
  const next = random(3);
  const rects: Rect[] = Array.from({ length: 40 }, () => {
    const [left, top] = [Math.floor(100 * next()), Math.floor(100 * next())];
    return { left, top, right: left + Math.ceil(12 * next()), bottom: top + Math.ceil(12 * next()) };
  });
  for (const most of [100, 3]) {
    const found = disjoint(rects, most);
    assert.ok(found.length <= most);
    const within = (x: number, y: number, list: Rect[]): number =>
      list.filter(({ left, top, right, bottom }) => x >= left && x < right && y >= top && y < bottom).length;
    for (let y = 0; y < 112; y++) {
      for (let x = 0; x < 112; x++) {
        assert.ok(within(x, y, found) <= 1, 'no overlap');
        if (within(x, y, rects) > 0) assert.equal(within(x, y, found), 1);
      }
    }
  }
});

test('a stroke around an edge of the cage stays on the cage', () => {
  const texels = new CageTexels(cageOf(box()), kSize);
  const [front, right] = [texels.at((1 + 0.2 + 0.6 * 0.9) / 3, 1.5 / 2)!, texels.at((0.2 + 0.6 * 0.1) / 3, 0.5 / 2)!];
  assert.ok(Math.abs(front.point.z - 1) < 1e-6 && Math.abs(right.point.x - 1) < 1e-6, 'on two sides of one edge');
  const stroke = new Stroke(texels, { radius: 0.05, mirror: false });
  stroke.to(front);
  const capsules = stroke.to(right, 0.3);
  assert.ok(capsules.length >= 4);
  for (const { from, to } of capsules) {
    for (const { point } of [from, to]) assert.ok(Math.abs(Math.max(point.x, point.z) - 1) < 1e-6, 'on the cage');
  }
  capsules.slice(1).forEach(({ from }, index) => assert.equal(from, capsules[index]!.to, 'one after the other'));
  stroke.to(front);
  assert.equal(stroke.to(right, 0.01).length, 1, 'too far for one step: the brush was lifted');
});

/** A chest, wide 2, with arms that hang 0.1 beside it, and meet it at the shoulders, where y is 1. All face +z. */
function chestWithArms(): BufferGeometry {
  const sheet = new PlaneGeometry(4, 2, 40, 20);
  const { position, uv } = sheet.attributes as { position: BufferAttribute; uv: BufferAttribute };
  for (let v = 0; v < uv.count; v++) uv.setXY(v, 0.1 + 0.8 * uv.getX(v), 0.1 + 0.8 * uv.getY(v));
  const middleOf = (corners: number[], get: (v: number) => number): number =>
    corners.reduce((sum, v) => sum + get(v), 0) / 3;
  const kept: number[] = [];
  for (let at = 0; at < sheet.index!.count; at += 3) {
    const corners = [0, 1, 2].map((i) => sheet.index!.getX(at + i));
    const x = Math.abs(middleOf(corners, (v) => position.getX(v)));
    const isGap = x > 1 && x < 1.1 && middleOf(corners, (v) => position.getY(v)) < 0.8;
    if (!isGap) kept.push(...corners);
  }
  return sheet.setIndex(kept);
}

test('a sticker gets from a chest to the arms beside it only where the shoulders are in it, too', () => {
  const texels = new CageTexels(cageOf(chestWithArms()), kSize);
  const at = (x: number, y: number): SurfacePoint => texels.at(0.5 + (0.8 * x) / 4, 0.5 + (0.8 * y) / 2)!;
  const isReached = (flags: Uint8Array, x: number, y: number): boolean => {
    const [column, row] = [0.5 + (0.8 * x) / 4, 0.5 + (0.8 * y) / 2].map((share) => Math.floor(share * kSize));
    return flags[texels.owners[row! * kSize + column!]!] === 255;
  };
  const axes = { right: new Vector3(1, 0, 0), up: new Vector3(0, 1, 0) };
  const low = texels.reached(at(0, -0.3), { ...axes, width: 3, height: 0.8 });
  assert.ok(isReached(low, 0, -0.3) && isReached(low, 0.95, -0.6) && isReached(low, -0.95, 0));
  for (const x of [-1.3, 1.3]) assert.ok(!isReached(low, x, -0.3), `an arm at ${x}`);
  const high = texels.reached(at(0, 0.3), { ...axes, width: 3, height: 1.2 });
  for (const x of [-1.3, 1.3]) assert.ok(isReached(high, x, 0.3), `a sleeve at ${x}`);
  const { point, normal } = at(0, -0.3);
  assert.deepEqual(texels.reached({ point, normal }, { ...axes, width: 3, height: 0.8 }), low, 'without its UV');
  const room = texels.room(at(0, -0.3), { ...axes, width: 4, height: 0.4 });
  assert.ok(room > 0.49 && room < 0.56, `a chest of 2 is half of 4, not ${room}`);
  assert.equal(texels.room(at(0, -0.3), { ...axes, width: 1, height: 0.4 }), 1, 'it has room');
  assert.ok(texels.room(at(0.8, -0.3), { ...axes, width: 1, height: 0.4 }) > 0.6, 'beside its middle, too');
});
