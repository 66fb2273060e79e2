// What comes into view when a face moves is painted: poses are found by the names of morph targets, by all that read models.
import assert from 'node:assert/strict';
import { writeFileSync } from 'node:fs';
import { before, describe, test } from 'node:test';
import { NodeIO } from '@gltf-transform/core';
import { init, type Mesh, project, type TransferOptions, type TransferResult, transfer } from 'cagecast';
import { cageGlb } from 'cagecast/cages';
import { cageModel as documentModel, cagecast as transform } from 'cagecast/gltf';
import { applyTransfer, extract, cageModel as sceneModel } from 'cagecast/three';
import { GLTFLoader } from 'three/examples/jsm/loaders/GLTFLoader.js';
import { cagecast } from '../support/command.js';
import { GlbMaker } from '../support/glb.js';
import { temporaryFolder } from '../support/temporary.js';
import { ball } from './scenes.js';

before(init);
const { at } = temporaryFolder('motion');
Object.assign(globalThis, { self: globalThis }); // which GLTFLoader expects

const kColumns = 11;

/** Rows of points from x = −1 to 1, from top to bottom, each at a height and a depth. */
function strip(...rows: readonly (readonly [y: number, z: number])[]): {
  positions: Float32Array;
  indices: Uint32Array;
} {
  const across = Array.from({ length: kColumns }, (_, c) => -1 + (2 * c) / (kColumns - 1));
  const indices: number[] = [];
  for (let v = 0; v < (rows.length - 1) * kColumns; ++v)
    if ((v + 1) % kColumns > 0) indices.push(v, v + kColumns, v + 1, v + 1, v + kColumns, v + kColumns + 1);
  return {
    positions: Float32Array.from(rows.flatMap(([y, z]) => across.flatMap((x) => [x, y, z]))),
    indices: Uint32Array.from(indices),
  };
}

const lidDepth = Math.fround(-0.02);
/** A forehead with a lid that is folded behind it. */
const face = strip([1, 0], [0.7, 0], [0.4, 0], [0.2, 0], [0.25, lidDepth], [0.35, lidDepth], [0.45, lidDepth]);
const lid = Array.from({ length: face.positions.length / 3 }, (_, v) => face.positions[3 * v + 2] === lidDepth);

/** How a target moves the lid: where x is on a side. */
function deltas(side: number): Float32Array {
  const out = new Float32Array(face.positions.length);
  lid.forEach((isLid, v) => {
    if (!isLid || face.positions[3 * v]! * side < 0) return;
    out[3 * v + 1] = 0.55 - 2.6 * face.positions[3 * v + 1]!;
    out[3 * v + 2] = 0.04;
  });
  return out;
}

/** A face and its eye. @param targets  The side that each target moves: −1 is right, 0 both. */
function faceGlb(targets: Readonly<Record<string, number>>, { weights = [] as number[], extensions = {} } = {}) {
  const maker = new GlbMaker();
  const mesh = maker.mesh(face);
  const json = maker.json.meshes[mesh]!;
  json.extras = { targetNames: Object.keys(targets) };
  json.primitives[0]!.targets = Object.values(targets).map((side) => ({
    POSITION: maker.accessor(deltas(side), 'VEC3'),
  }));
  if (weights.length > 0) json.weights = weights;
  maker.node({ name: 'Face', mesh });
  maker.node({ name: 'Eye', mesh: maker.mesh(ball([0, 0, -0.35], () => 0.3, 8, 12)) });
  Object.assign(maker.json, { extensions, extensionsUsed: Object.keys(extensions) });
  return maker.finish();
}

/** A level cage. */
const cage: Mesh = (() => {
  const corners = [-1.2, 1.2].flatMap((y) => [-1.2, 1.2].map((x) => [x, y] as const));
  return {
    positions: Float32Array.from(corners.flatMap(([x, y]) => [x, y, 0.15])),
    indices: Uint32Array.of(0, 1, 3, 0, 3, 2),
    uvs: Float32Array.from(corners.flatMap(([x, y]) => [x / 3 + 0.5, y / 3 + 0.5])),
  };
})();

/** The sides of the lid that are painted: right, middle, left. */
const painted = ({ zones }: Pick<TransferResult, 'zones'>): boolean[] =>
  [-1, 0, 1].map((side) =>
    lid.every((isLid, v) => !isLid || Math.sign(Math.round(10 * face.positions[3 * v]!)) !== side || zones[v] === 0),
  );

async function byDocument(glb: Uint8Array, options: TransferOptions = {}): Promise<boolean[]> {
  const document = await new NodeIO().readBinary(new Uint8Array(glb));
  let result: TransferResult | undefined;
  await document.transform(transform({ cage, onResult: (found) => (result = found), ...options }));
  return painted(result!);
}

const load = async (glb: Uint8Array) => (await new GLTFLoader().parseAsync(Uint8Array.from(glb).buffer, '')).scene;

async function byThree(glb: Uint8Array, options: TransferOptions = {}): Promise<boolean[]> {
  const { BufferAttribute, BufferGeometry } = await import('three');
  const around = new BufferGeometry();
  around.setAttribute('position', new BufferAttribute(cage.positions, 3));
  around.setAttribute('uv', new BufferAttribute(cage.uvs!, 2));
  around.setIndex([...cage.indices]);
  return painted(applyTransfer(await load(glb), { cage: around, ...options }).result);
}

async function byCommand(glb: Uint8Array, ...flags: string[]): Promise<boolean[]> {
  writeFileSync(at('face.glb'), glb);
  writeFileSync(at('cage.glb'), cageGlb(cage as never));
  const { status, stderr } = await cagecast(
    ...['transfer', at('face.glb'), '--cage', at('cage.glb'), '-o', at('out.glb')],
    ...flags,
  );
  assert.equal(status, 0, stderr);
  const document = await new NodeIO().read(at('out.glb'));
  const primitive = document
    .getRoot()
    .listNodes()
    .find((node) => node.getName() === 'Face')!
    .getMesh()!;
  const zones = primitive.listPrimitives()[0]!.getAttribute('_NCZ')!.getArray()!;
  return painted({ zones: Uint8Array.from(zones) });
}

const all = [true, true, true];
const none = [false, false, false];

describe('a lid that is folded away at rest', () => {
  const vrm = {
    VRM: { blendShapeMaster: { blendShapeGroups: [{ presetName: 'blink', binds: [{ mesh: 0, index: 1 }] }] } },
  };
  const named: [targets: Record<string, number>, painted: boolean[], extensions?: object][] = [
    [{ browInnerUp: 0, eyeBlinkLeft: 1, eyeBlinkRight: -1 }, all],
    [{ eyeBlink_L: 1, eyeBlink_R: -1 }, all],
    [{ 'Face.M_F00_Fcl_EYE_Close': 0, 'Face.M_F00_Fcl_EYE_Close_L': 1 }, all],
    [{ まばたき: 0, ｳｨﾝｸ: 1 }, all],
    [{ ウィンク: 1, ウィンク右: -1 }, all],
    [{ Blink: 0 }, all],
    [{ eyesClosed: 0 }, all],
    [{ eyeBlinkLeft: 1 }, [false, true, true]],
    [{ jawOpen: 0 }, all],
    [{ viseme_aa: 0 }, all],
    [{ Fcl_MTH_A: 0 }, all],
    [{ あ: 0 }, all],
    [{ mouthSmileLeft: 1, mouthSmileRight: -1 }, all],
    [{ browInnerUp: 0, eyeLookUpLeft: 1, viseme_O: 0 }, none],
    [{ a0: 1, a1: 0 }, none],
  ];
  for (const [targets, sides] of named)
    test(`is painted by the names of targets: ${Object.keys(targets)}`, async () => {
      const glb = faceGlb(targets);
      assert.deepEqual(await byDocument(glb), sides);
      assert.deepEqual(await byThree(glb), sides);
      assert.deepEqual(await byCommand(glb), sides);
    });

  test('is painted in the arrays that cageModel gives', async () => {
    const glb = faceGlb({ blink: 0 });
    const document = await new NodeIO().readBinary(new Uint8Array(glb));
    for (const model of [await documentModel(document), await sceneModel(await load(glb))])
      assert.deepEqual(painted(transfer(cage, model)), all);
  });

  test('is painted by the names of the expressions of a VRM file', async () => {
    assert.deepEqual(await byCommand(faceGlb({ t0: 1, t1: 0 }, { extensions: vrm })), all);
  });

  test('stays bare without the option motion, and with the preset paper', async () => {
    const glb = faceGlb({ eyeBlinkLeft: 1, eyeBlinkRight: -1 });
    for (const options of [{ motion: false }, { preset: 'paper' }] as const) {
      assert.deepEqual(await byDocument(glb, options), none);
      assert.deepEqual(await byThree(glb, options), none);
    }
    assert.deepEqual(await byCommand(glb, '--set', 'motion=false'), none);
    assert.deepEqual(await byCommand(glb, '--set', 'preset=paper'), none);
    const { status, stderr } = await cagecast(
      'transfer',
      at('face.glb'),
      '--cage',
      at('cage.glb'),
      '--set',
      'motion=maybe',
    );
    assert.deepEqual([status, /"motion" is "maybe", not one of/.test(stderr)], [2, true], stderr);
  });

  test('moves on from the shape that is shown', async () => {
    // Closed by half already: the pose closes it, and no more.
    const { poses, positions } = extract(await load(faceGlb({ blink: 0 }, { weights: [0.5] }))).mesh;
    const full = extract(await load(faceGlb({ blink: 0 }))).mesh;
    assert.ok(positions.some((x, i) => x !== full.positions[i]));
    poses!.forEach((x, i) => assert.ok(Math.abs(x - full.poses![i]!) < 1e-6));
  });
});

test('poses of a mesh: what they bring is decided with the threshold and locks of classify', () => {
  const poses = face.positions.map((x, i) => x + deltas(0)[i]!);
  const target = { ...face, poses };
  assert.deepEqual(painted(transfer(cage, target)), all);
  assert.deepEqual(painted(transfer(cage, target, { motion: false })), none);
  assert.deepEqual(painted(transfer(cage, face)), none);
  const projection = project(cage, target);
  assert.ok(projection.timings.motion >= 0);
  for (const [wrong, code, message] of [
    [poses.subarray(1), 'poseCountMismatch', /target\.poses has 230 numbers, not a multiple of 231/],
    [poses.map((x, i) => (i === 5 ? Number.NaN : x)), 'badPose', /target\.poses\[5\] is not a finite number/],
    [[...poses], 'badArgument', /target\.poses is .*not a Float32Array/],
  ] as const)
    assert.throws(() => transfer(cage, { ...face, poses: wrong as never }), { code, message });
});
