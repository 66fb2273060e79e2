// MediaPipe's canonical face as a template that users bring. Its file is not here: a mesh with its count of points and some of its UVs is.
import assert from 'node:assert/strict';
import { writeFileSync } from 'node:fs';
import { describe, test } from 'node:test';
import { Document, NodeIO } from '@gltf-transform/core';
import { objTemplate, type Template } from 'cagecast/cages';
import * as gltf from 'cagecast/gltf';
import * as three from 'cagecast/three';
import { BufferAttribute, BufferGeometry } from 'three';
import { kEye, kMiddle, kMouth, kRight, type Uv } from '../../wasm/src/parts/face-mesh-uvs.js';
import { cagecast } from '../support/command.js';
import { glbOf } from '../support/gltf.js';
import { temporaryFolder } from '../support/temporary.js';

const { at } = temporaryFolder('face-mesh');

const mirrored = ([u, v]: Uv): Uv => [1 - u, v];
/** The known points of its right half but for the eye, and those of both halves. */
const right = [...kMouth, kRight['mouth_corner']!];
const known = [...kEye, ...kEye.map(mirrored), ...right, ...right.map(mirrored), ...Object.values(kMiddle)];

/** A face with eyes that 28 triangles fill. */
function face(points = 468): Required<Pick<Template, 'positions' | 'uvs' | 'indices'>> {
  const own = [...new Map(known.map((uv) => [uv.join(), uv])).values()]; // the middle of the lips is its own mirror image
  const others = Array.from({ length: points - own.length }, (_, i): Uv => [0.05 + 0.002 * i, i % 2 ? 0.02 : 0.99]);
  const all = [...own, ...others];
  const indices: number[] = [];
  for (const first of [0, 16]) for (let k = 2; k < 16; ++k) indices.push(first, first + k - 1, first + k);
  for (let v = 2; v < all.length; ++v) if (v >= 32) indices.push(v - 32, v, v - 1);
  return {
    positions: Float32Array.from(all.flatMap(([u, v]) => [2 * u - 1, 0.7 - v, 0.5 - Math.abs(u - 0.5)])),
    uvs: Float32Array.from(all.flat()),
    indices: Uint32Array.from(indices),
  };
}

function objOf({ positions, uvs, indices }: ReturnType<typeof face>): string {
  const rows = (word: string, list: Float32Array, size: number) =>
    Array.from({ length: list.length / size }, (_, i) => {
      const [x, y, z] = list.subarray(size * i, size * (i + 1));
      return [word, x, size === 2 ? 1 - y! : y, z].join(' ').trim();
    });
  const corner = (v: number) => `${v + 1}/${v + 1}`;
  const faces = Array.from(
    { length: indices.length / 3 },
    (_, t) => `f ${[...indices.subarray(3 * t, 3 * t + 3)].map(corner).join(' ')}`,
  );
  return ['# a face', ...rows('v', positions, 3), ...rows('vt', uvs, 2), ...faces, ''].join('\n');
}

const near = (a: readonly number[], b: readonly number[]) => Math.hypot(...a.map((x, k) => x - b[k]!)) < 1e-5;

function isFace({ positions, indices, landmarks, holes, kind, regions }: Template, split = false): void {
  const { indices: filled } = face();
  assert.equal(kind, 'head');
  assert.equal(indices?.length, filled.length - 3 * 28, 'eyes are open');
  assert.deepEqual(Object.keys(holes!), ['eye_left', 'eye_right', 'mouth']);
  assert.deepEqual(Object.keys(regions!), ['lips', 'eyelids', 'brows']);
  if (!split) assert.equal(holes!['mouth']!.length, 20 + 2); // both halves name its middle
  const x = (name: string) => landmarks[name]![0];
  assert.ok(x('eye_outer_left') > x('eye_inner_left') && x('eye_inner_left') > 0 && x('mouth_corner_right') < 0);
  assert.ok(near(landmarks['nose_tip']!, [2 * 0.5002 - 1, 0.7 - 0.5272, 0.5 - 0.0002]));
  for (const v of holes!['eye_left']!) assert.ok(positions[3 * v]! > 0);
}

describe('the canonical face', () => {
  const mesh = face();

  test('has its landmarks and open eyes as GLB, as OBJ and as geometry, in any order, and split into triangles', async () => {
    isFace(gltf.cageTemplate(await new NodeIO().readBinary(glbOf(mesh))));
    isFace(objTemplate(objOf(mesh)));
    const geometry = new BufferGeometry();
    geometry.setAttribute('position', new BufferAttribute(mesh.positions, 3));
    geometry.setAttribute('uv', new BufferAttribute(mesh.uvs, 2));
    geometry.setIndex(new BufferAttribute(mesh.indices, 1));
    isFace(three.cageTemplate(geometry));
    isFace(three.cageTemplate(geometry.toNonIndexed()), true);
    const order = Array.from({ length: 468 }, (_, v) => (v * 5) % 468);
    const turned = <T extends number>(size: T, list: Float32Array) =>
      Float32Array.from(order.flatMap((v) => [...list.subarray(size * v, size * (v + 1))]));
    const indices = mesh.indices.map((v) => order.indexOf(v));
    isFace(objTemplate(objOf({ positions: turned(3, mesh.positions), uvs: turned(2, mesh.uvs), indices })));
  });

  test('keeps the landmarks of a file that has some', async () => {
    const landmarks = { nose_tip: [0, 0, 1] as const };
    const file = gltf.addCage(new Document(), { ...mesh, landmarks } as never);
    assert.deepEqual(gltf.cageTemplate(file.document).landmarks, landmarks);
  });

  test('is no other mesh', () => {
    for (const other of [face(467), face(469), { ...mesh, uvs: mesh.uvs.map((x) => 0.9 * x) }])
      assert.deepEqual(objTemplate(objOf(other)).landmarks, {});
  });

  test('is a template of the command; one without landmarks is an error', async () => {
    writeFileSync(at('face.obj'), objOf(face(467)));
    const { status, stderr } = await cagecast(
      'fit',
      'examples/samples/human/target.glb',
      '--template',
      at('face.obj'),
      '-o',
      at('c.glb'),
    );
    assert.equal(status, 1);
    assert.match(stderr, /face\.obj: has no landmarks/);
  });
});

describe('objTemplate', () => {
  const triangle = ['v 0 0 0', 'v 1 0 0', 'v 0 1 0', 'v 1 1 0', 'vt 0 0', 'vt 1 0', 'vt 0 1', 'vt 1 1'];
  const read = (...lines: string[]) => objTemplate([...triangle, ...lines].join('\r\n'));

  test('reads polygons, numbers from the end, and vertices with several UVs', () => {
    const { positions, uvs, indices } = read('f 1/1/1 2/2/1 4/4/1 3/3/1 # a quad', 'f -4/-4 -3/-1 -2/-2');
    assert.deepEqual([...indices!], [0, 1, 4, 0, 4, 3, 0, 2, 3]);
    assert.deepEqual([...positions.subarray(3, 9)], [1, 0, 0, 1, 0, 0]);
    assert.deepEqual([...uvs.subarray(0, 6)], [0, 1, 1, 1, 1, 0]);
  });

  const errors: [string, string, RegExp][] = [
    ['a vertex that is not there', 'f 1/1 2/2 5/3', /line 9: a vertex is "5"; there are 4 so far/],
    ['a corner without a UV', 'f 1//1 2//1 3//1', /line 9: corner "1\/\/1" has no UV/],
    ['too few corners', 'f 1/1 2/2', /line 9: a face needs 3 corners/],
    ['words for numbers', 'v 1 2 x', /line 9: "v" needs 3 numbers/],
    ['no faces', '', /has no faces/],
  ];
  for (const [what, line, message] of errors)
    test(`${what} is an error`, () =>
      assert.throws(() => read(line), { code: 'badTemplate', argument: 'text', message }));

  test('no text is an error', () => assert.throws(() => objTemplate(1 as never), { code: 'badArgument' }));
});
