// Masks of regions of a cage.
import assert from 'node:assert/strict';
import { after, describe, test } from 'node:test';
import { loadTemplate, type TemplateName, terminate } from 'cagecast/cages';
import { regionMask } from 'cagecast/engines';

after(terminate);

const square = (from: number, to: number) => [
  [from, from] as const,
  [to, from] as const,
  [to, to] as const,
  [from, to] as const,
];
const regions = { frame: [square(0.25, 0.75), square(0.4, 0.6)] };
const alphaAt = ({ width, data }: ReturnType<typeof regionMask>, x: number, y: number) =>
  data[4 * (y * width + x) + 3]!;

describe('regionMask', () => {
  test('is opaque within an odd number of outlines, and white everywhere', () => {
    const mask = regionMask({ regions }, 'frame', { width: 100, height: 50, softness: 0 });
    assert.deepEqual([mask.width, mask.height, mask.data.length], [100, 50, 20_000]);
    assert.deepEqual([alphaAt(mask, 30, 15), alphaAt(mask, 50, 25), alphaAt(mask, 10, 25)], [255, 0, 0]);
    for (let i = 0; i < mask.data.length; i += 4) assert.equal(mask.data[i], 255);
  });

  test('fades outwards, as far as softness says', () => {
    const mask = regionMask({ regions: { box: [square(0.5, 0.75)] } }, 'box', { width: 100, softness: 0.1 });
    const row = Array.from({ length: 12 }, (_, i) => alphaAt(mask, 38 + i, 60));
    assert.equal(row[0], 0);
    assert.ok(row.every((alpha, i) => i === 0 || alpha >= row[i - 1]!));
    assert.ok(Math.abs(alphaAt(mask, 45, 60) - 255 * 0.55) < 2);
    assert.equal(alphaAt(mask, 50, 60), 255);
  });

  test('of templates is its own mirror image, small, and not empty', async () => {
    for (const name of ['human-head', 'human-body', 'face-mask'] satisfies TemplateName[]) {
      const cage = await loadTemplate(name);
      for (const region of ['lips', 'eyelids', 'brows', 'nose', 'cheeks', 'chin', 'forehead']) {
        const mask = regionMask(cage, region, { width: 256, softness: 0 });
        const all = Array.from({ length: 256 * 256 }, (_, i) => [i % 256, Math.floor(i / 256)] as const);
        const inside = all.filter(([x, y]) => alphaAt(mask, x, y) > 127);
        const oneSided = inside.filter(([x, y]) => alphaAt(mask, 255 - x, y) < 100);
        assert.ok(inside.length > 10 && inside.length < 0.15 * all.length, `${name} ${region}: ${inside.length}`);
        assert.ok(oneSided.length <= 0.1 * inside.length, `${name} ${region}: ${oneSided.length} on one side only`);
      }
    }
    assert.deepEqual(Object.keys((await loadTemplate('human-body')).regions!).slice(-2), ['hands', 'feet']);
  });

  test('of a region that is not there, or with wrong options, is an error that says what there is', () => {
    const of = (cage: object, options?: object) => () => regionMask(cage, 'nose', options);
    assert.throws(of({ regions }), {
      code: 'badArgument',
      message: /name is "nose"; the cage has these regions: "frame"/,
    });
    assert.throws(of({}), { message: /these regions: none/ });
    assert.throws(of({ regions: { nose: regions.frame } }, { softness: 2 }), { message: /softness is 2, not 0 to 1/ });
    assert.throws(of({ regions: { nose: regions.frame } }, { width: 0 }), { message: /width is 0/ });
    assert.throws(of({ regions: { nose: regions.frame } }, { soft: 1 }), { code: 'badOption' });
  });
});
