import assert from 'node:assert/strict';
import { test } from 'node:test';
import { Bone, BoxGeometry, Group, MathUtils, Mesh, type Texture } from 'three';
import { coveredBy, fittingDistance, frontOf, kFieldOfView, kHome } from '../../../web/src/view/framing';
import { Beside } from '../../../web/src/view/wardrobe/beside';

const names = [
  ['LeftArm', 'RightArm'],
  ['mixamorigLeftLeg', 'mixamorigRightLeg'],
  ['upperarm.l', 'upperarm.r'],
  ['L_hand', 'R_hand'],
  ['左腕', '右腕'],
] as const;

/** A skeleton that looks into a direction. */
function figure(angle: number, [left, right]: readonly [string, string]) {
  const scene = new Group();
  scene.rotation.y = angle;
  for (const [name, x] of [
    ['Head', 0],
    [left, 0.4],
    [right, -0.4],
  ] as const) {
    const bone = new Bone();
    bone.position.set(x, 1, 0);
    bone.userData['name'] = name;
    scene.add(bone);
  }
  return { loaded: { scene: new Group().add(scene) } } as never;
}

test('a model is seen from where its bones say that its front is', () => {
  for (const pair of names)
    for (const angle of [-Math.PI / 2, 1, 3]) assert.ok(Math.abs(frontOf(figure(angle, pair)) - angle) < 1e-6, pair[0]);
  // Who stands a little askew is left so; and bones without sides say nothing.
  assert.equal(frontOf(figure(0.5, names[0])), 0);
  assert.equal(frontOf(figure(2, ['Spine', 'Neck'])), 0);
  assert.equal(
    frontOf({ loaded: { scene: new Group(), parser: { json: { extensions: { VRM: {} } } } } } as never),
    Math.PI,
  );
});

const phone = { width: 390, height: 695, top: 96, bottom: 64, side: 12, fill: 0.9 };

/** The share of the view's height that a model fills at its distance. */
const filled = (points: number[], half: number): number =>
  half / (fittingDistance(phone, points, kHome, false) * Math.tan(MathUtils.degToRad(kFieldOfView / 2)));

test('a figure fills the height that is free on a phone, and can be turned there; a compact model gets room to be turned', () => {
  const figure = [0, 0.95, 0, 0, -0.95, 0, 0.48, 0.2, 0, -0.48, 0.2, 0, 0, 0, 0.15];
  const free = (phone.height - phone.top - phone.bottom) / phone.height;
  const share = filled(figure, 0.95);
  assert.ok(share > 0.85 * free && share < free, `${share} of ${free}`);
  const ball = [0, 0.6, 0, 0, -0.6, 0, 0.6, 0, 0, -0.6, 0, 0, 0, 0, 0.6];
  assert.ok(filled(ball, 0.6) < 0.6 * free);
});

test('strips of controls cover the edges of the view that they are at; columns stand beside the model', () => {
  const view = { left: 0, right: 390, top: 0, bottom: 695 };
  const [head, dock] = [
    { left: 8, right: 382, top: 0, bottom: 92 },
    { left: 4, right: 232, top: 635, bottom: 687 },
  ];
  const column = { left: 10, right: 66, top: 250, bottom: 480 };
  assert.deepEqual(coveredBy(view, [head, dock, column]), { top: 96, bottom: 64 });
  assert.deepEqual(coveredBy(view, [column]), { top: 0, bottom: 0 });
  const moved = (by: number) =>
    [view, head, dock].map((box) => ({ ...box, top: box.top + by, bottom: box.bottom + by }));
  const [movedView, ...controls] = moved(300);
  assert.deepEqual(coveredBy(movedView!, controls), { top: 96, bottom: 64 }, 'wherever the view is');
  const high = { ...head, bottom: 690 };
  assert.ok(
    coveredBy({ ...view, right: 900 }, [{ ...high, right: 900 }]).top <= 0.45 * 695,
    'the model has room, whatever is said',
  );
});

/** A model of a box that stands beside others. */
const box = (width: number, height: number): Beside =>
  new Beside({ scene: new Mesh(new BoxGeometry(width, height, 0.1)) } as never, undefined, {} as Texture);

test('models of much the same shape stand equally high; others keep their size, or nearly so', () => {
  const [slim, wide, flat] = [box(0.5, 1.8), box(1.7, 1.8), box(4, 0.5)];
  assert.ok(wide.high < 0.8 * slim.high, 'arms that are out cost height at first');
  const own = wide.wide / wide.high;
  wide.match(slim.high);
  assert.ok(Math.abs(wide.high - slim.high) < 1e-6);
  assert.ok(Math.abs(wide.wide / wide.high - own) < 1e-6, 'as a whole');
  const before = flat.high;
  flat.match(slim.high);
  assert.ok(Math.abs(flat.high / before - 1.4) < 1e-6, 'a car does not stand as high as a figure');
  flat.match();
  assert.equal(flat.high, before);
  assert.equal(flat.holder.scale.x, flat.holder.scale.y);
});
