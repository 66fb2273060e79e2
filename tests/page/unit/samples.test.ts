import assert from 'node:assert/strict';
import { existsSync, readFileSync, statSync } from 'node:fs';
import { before, test } from 'node:test';
import { type Document, NodeIO, type Primitive } from '@gltf-transform/core';
import { ALL_EXTENSIONS } from '@gltf-transform/extensions';
import { paintGlb } from 'cagecast/gltf';
import { MeshoptDecoder } from 'meshoptimizer';
import { PNG } from 'pngjs';
import { loadModel } from '../../../web/src/loading/load-model';
import type { Sample } from '../../../web/src/state/sample';
import { packGlb, unpackGlb } from '../../support/glb';

const file = (name: string): string => `examples/samples/${name}`;
const samples: Sample[] = JSON.parse(readFileSync(file('index.json'), 'utf8'));
const io = new NodeIO().registerExtensions(ALL_EXTENSIONS).registerDependencies({ 'meshopt.decoder': MeshoptDecoder });
await MeshoptDecoder.ready;

test('the list of samples names files that are there, and marks those that are cases for tests', () => {
  for (const { target, cage, paints } of samples)
    for (const name of [target, cage, ...paints.map(({ file }) => file)]) assert.ok(existsSync(file(name)), name);
  assert.deepEqual(
    samples.filter(({ test }) => test).map(({ name }) => name),
    ['human-fused', 'human-misaligned'],
  );
});

let avatar: Document;
before(async () => void (avatar = await io.read(file('avatar/avatar.glb'))));

const partOf = (document: Document, name: string): Primitive =>
  document
    .getRoot()
    .listNodes()
    .find((node) => node.getName() === name && node.getMesh())!
    .getMesh()!
    .listPrimitives()[0]!;
type Point = [number, number, number];
/** Where the vertices of a part are in a morph. All parts are in one space. */
function pointsOf(name: string, morph?: string): Point[] {
  const part = partOf(avatar, name);
  const positions = part.getAttribute('POSITION')!;
  const shifts = part.listTargets().find((target) => target.getName() === morph);
  return Array.from({ length: positions.getCount() }, (_, v) => {
    const shift = shifts?.getAttribute('POSITION')?.getElement(v, []) ?? [0, 0, 0];
    return positions.getElement(v, []).map((value, k) => value + shift[k]!) as Point;
  });
}

/** Whether a part lies before a point, seen from the front. */
function covers(points: readonly Point[], indices: ArrayLike<number>, [x, y, z]: Point): boolean {
  for (let i = 0; i < indices.length; i += 3) {
    const [a, b, c] = [0, 1, 2].map((k) => points[indices[i + k]!]!) as [Point, Point, Point];
    const area = (b[0] - a[0]) * (c[1] - a[1]) - (c[0] - a[0]) * (b[1] - a[1]);
    const s = ((x - a[0]) * (c[1] - a[1]) - (c[0] - a[0]) * (y - a[1])) / area;
    const t = ((b[0] - a[0]) * (y - a[1]) - (x - a[0]) * (b[1] - a[1])) / area;
    if (s >= 0 && t >= 0 && s + t <= 1 && a[2] + s * (b[2] - a[2]) + t * (c[2] - a[2]) > z) return true;
  }
  return false;
}

test('the avatar is small, has a skeleton with weights that add up, and clips that can be repeated', () => {
  assert.ok(statSync(file('avatar/avatar.glb')).size < 400_000);
  const [skin, ...others] = avatar.getRoot().listSkins();
  assert.equal(others.length, 0, 'all parts hang on one skeleton');
  const names = skin!.listJoints().map((joint) => joint.getName());
  for (const name of ['hips', 'head', 'leftLowerArm', 'rightLowerLeg', 'leftIndexDistal'])
    assert.ok(names.includes(name));
  for (const node of avatar.getRoot().listNodes()) {
    const weights = node.getMesh()?.listPrimitives()[0]?.getAttribute('WEIGHTS_0');
    for (let v = 0; v < (weights?.getCount() ?? 0); v++) {
      const sum = weights!.getElement(v, []).reduce((all, weight) => all + weight, 0);
      assert.ok(Math.abs(sum - 1) < 0.02, `${node.getName()}: vertex ${v} weighs ${sum}`);
    }
  }
  const clips = avatar.getRoot().listAnimations();
  assert.deepEqual(
    clips.map((clip) => clip.getName()),
    ['Idle', 'Wave', 'Walk'],
  );
  for (const clip of clips)
    for (const sampler of clip.listSamplers()) {
      const output = sampler.getOutput()!;
      const ends = [0, output.getCount() - 1].map((key) => output.getElement(key, []));
      ends[0]!.forEach((value, k) => assert.ok(Math.abs(value - ends[1]![k]!) < 1e-4, clip.getName()));
    }
});

test('its lids cover the eyes, its jaw opens, and the corners of its mouth go up', () => {
  const indices = partOf(avatar, 'skin').getIndices()!.getArray()!;
  const rest = pointsOf('skin');
  for (const [eye, morph] of [
    ['l-eye', 'eyeBlinkLeft'],
    ['r-eye', 'eyeBlinkRight'],
  ] as const) {
    const [front] = pointsOf(eye).sort((a, b) => b[2] - a[2]);
    assert.equal(covers(rest, indices, front!), false, `${eye} is seen`);
    assert.equal(covers(pointsOf('skin', morph), indices, front!), true, `${morph} covers it`);
  }
  const rise = (part: string, morph: string): number[] => {
    const still = pointsOf(part);
    return pointsOf(part, morph).map(([, y], v) => y - still[v]![1]);
  };
  assert.ok(rise('lower-teeth', 'jawOpen').every((dy) => dy < 0));
  const smile = rise('skin', 'mouthSmileLeft');
  assert.ok(Math.max(...smile) > 4 * -Math.min(...smile));
  for (const morph of ['browInnerUp', 'mouthPucker'])
    assert.ok(
      rise('skin', morph).some((dy) => dy !== 0),
      morph,
    );
});

test('under its cage, skin and clothes are painted; eyes, teeth, tongue and hair are not', async () => {
  const texture = PNG.sync.write(new PNG({ width: 4, height: 4 }));
  const cage = readFileSync(file('avatar/cage.glb'));
  const { bytes, note } = await paintGlb(readFileSync(file('avatar/avatar.glb')), { cage, texture, attributes: true });
  assert.equal(note, undefined);
  const painted = await io.readBinary(bytes);
  const shareOf = (name: string): number => {
    const zones = partOf(painted, name).getAttribute('_NCZ')!;
    const all = Array.from({ length: zones.getCount() }, (_, v) => zones.getScalar(v));
    return all.filter((zone) => zone === 0).length / all.length;
  };
  for (const name of ['l-eye', 'r-eye', 'upper-teeth', 'lower-teeth', 'tongue', 'hair', 'brows', 'lashes'])
    assert.equal(shareOf(name), 0, name);
  for (const name of ['skin', 'shirt', 'trousers', 'shoes'])
    assert.ok(shareOf(name) > 0.7, `${name}: ${shareOf(name)}`);
});

test('a file that was painted comes back whole, without its paint', async () => {
  const [model, cage] = ['target.glb', 'cage.glb'].map((name) => readFileSync(file(`human/${name}`)));
  const opaque = Object.assign(new PNG({ width: 1, height: 1 }), { data: Buffer.of(0, 0, 255, 255) });
  const decode = async (png: Uint8Array) => PNG.sync.read(Buffer.from(png));
  const { bytes } = await paintGlb(model!, { cage: cage!, texture: PNG.sync.write(opaque), decode });
  const countsOf = async (bytes: Uint8Array) => {
    const { primitives } = (await loadModel(new File([new Uint8Array(bytes)], 'human.glb'), undefined)).mesh;
    return primitives.map(({ mesh }) => mesh.geometry.index!.count);
  };
  // Node decodes no images, and is no worker.
  Object.assign(globalThis, { self: globalThis });
  const { json, bin } = unpackGlb(bytes);
  assert.match(JSON.stringify(json.meshes), /cagecastInPlaceOf/);
  for (const { pbrMetallicRoughness } of json.materials!) delete pbrMetallicRoughness?.baseColorTexture;
  delete json.textures;
  delete json.images;
  assert.deepEqual(await countsOf(packGlb({ json, bin })), await countsOf(model!));
});
