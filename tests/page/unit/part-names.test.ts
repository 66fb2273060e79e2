import assert from 'node:assert/strict';
import { test } from 'node:test';
import type { SegmentStats } from 'cagecast';
import type { Shown } from '../../../web/src/state/scene';
import { bareParts, plainNameOf } from '../../../web/src/state/verdict/part-names';

const part = (name: string, material = ''): Shown['target']['mesh']['primitives'][number] =>
  ({ name, mesh: { material: { name: material } } }) as never;

test('parts have plain names, by their materials or else their meshes; names that do not tell stay', () => {
  const names = [
    part('Wolf3D_Teeth'),
    part('EyeLeft'),
    part('Face (merged)', 'N00_000_00_EyeIris_00_EYE (Instance)'),
    part('Eyebrows'),
    part('eye_lashes'),
    part('Wolf3D_Glasses'),
    part('Body', 'N00_002_03_Tops_01_CLOTH'),
    part('Wolf3D_Outfit_Footwear'),
    part('Windshield'),
    part('Tire_FL'),
    part('BeardStyle_2'),
    part('centre'),
    part('node_17'),
  ].map(plainNameOf);
  const expected = ['teeth', 'eyes', 'eyes', 'brows', 'lashes', 'glasses', 'clothes', 'shoes', 'windows', 'wheels'];
  assert.deepEqual(names, [...expected, 'beard', 'centre', 'node_17']);
});

test('parts that are mostly bare are named once, those that are known first; what lies beyond the cage or is left out is not', () => {
  const names = ['Shell', 'Tongue', 'EyeLeft', 'EyeRight', 'Skin', 'Legs', 'Plate'];
  const shown = {
    target: { mesh: { primitives: names.map((name) => part(name)) } },
    projection: { leftOut: [6] },
  } as unknown as Shown;
  const bare = { area: 1, exposedArea: 1, coveredArea: 0.9, beyondArea: 0, culled: true };
  const stats: SegmentStats[] = names.map((_, group) => ({ ...bare, group }) as never);
  stats[1]!.exposedArea = stats[1]!.coveredArea = 0; // hidden in the mouth
  stats[4]!.culled = false;
  stats[5]!.beyondArea = 0.8;
  assert.deepEqual(bareParts(shown, stats), ['eyes', 'tongue', 'Shell']);
});
