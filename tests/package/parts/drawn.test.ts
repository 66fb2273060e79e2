import assert from 'node:assert/strict';
import { test } from 'node:test';
import { chooseParts } from '../../../wasm/src/parts/drawn.js';

const box = [0, 0, 0, 1, 0, 0, 0, 1, 0, 0, 0, 1];
const identity = [1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1];

test('collision shapes are left out by their names, colours are not', () => {
  const left = (...parts: (string | string[])[]): string[] => {
    const look = (names: string[]) => ({
      names,
      isHidden: false,
      isClear: false,
      sides: 'both' as const,
      positions: box,
      indices: undefined,
      matrix: identity,
    });
    const named = parts.map((names) => ({ name: [names].flat()[0]!, names: [names].flat() }));
    const fail = (text: string) => new Error(text);
    return chooseParts(named, ({ names }) => look(names), {}, fail).leftOut.map(({ name }) => name);
  };
  const shapes = [
    'UCX_Body_00',
    'Body_collider',
    'Body-colonly',
    'Body-convcolonly',
    'collision_torso',
    'Arm_Hitbox.001',
    'hitbox',
    'Collision.001',
    'Body_col',
    'col_Body',
    'COL-Body.001',
    'UCX.Body',
    'MCDCX_Body_01',
    'hitbox-head',
    'Hit_Box_Arm',
    'ArmHitBox',
    'HeadHitbox2',
    'Body Collision',
    'Body.collision',
    'BodyCollider',
    'Body_CollisionMesh',
    'collision-mesh',
    'ColliderBox.002',
    'Colliders',
    'Body$colonly',
    'Floor-navmesh',
    'Body-occonly',
    'Body-noimp',
    'helper-tights',
    'joint-l-knee',
  ];
  assert.deepEqual(left('Body', ...shapes), shapes);
  const words = [
    'Collisionless',
    'Protocol',
    'Collar',
    'Column',
    'Color',
    'Colt',
    'col',
    'Colossus_body',
    'Ucxmal',
    'Whitebox',
  ];
  assert.deepEqual(
    left('Body', 'Skin_col', 'col_Skin', 'Skin-col', ...words, 'joint-1', 'Helper', 'ColliderScope_lens'),
    [],
  );
  const began = process.cpuUsage();
  left('Body', `col_${'1'.repeat(200_000)}x`);
  assert.ok(process.cpuUsage(began).user < 2e6, 'in time that grows with the name');
  // Materials of a model, and of another part, that have its colours.
  assert.deepEqual(left(['Body', 'Body_col'], ['Body_col', 'Body'], ['Hair', 'Body_col']), []);
});
