import assert from 'node:assert/strict';
import { test } from 'node:test';
import { chooseParts } from '../../../wasm/src/parts/drawn.js';

const box = [0, 0, 0, 1, 0, 0, 0, 1, 0, 0, 0, 1];
const identity = [1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1];

test('collision shapes are left out by their names, colours are not', () => {
  const left = (...names: string[]): string[] => {
    const look = (name: string) => ({
      names: [name],
      isHidden: false,
      isClear: false,
      sides: 'both' as const,
      positions: box,
      indices: undefined,
      matrix: identity,
    });
    const parts = names.map((name) => ({ name }));
    return chooseParts(
      parts,
      ({ name }) => look(name),
      {},
      (text) => new Error(text),
    ).leftOut.map(({ name }) => name);
  };
  const shapes = [
    'UCX_Body_00',
    'Body_collider',
    'Body-colonly',
    'Body-convcolonly',
    'collision_torso',
    'Arm_Hitbox.001',
    'hitbox',
    'Body_col',
  ];
  assert.deepEqual(left('Body', ...shapes), shapes);
  assert.deepEqual(left('Body', 'Skin_col', 'Collisionless', 'Protocol', 'Collar'), []);
});
