import assert from 'node:assert/strict';
import { before, describe, test } from 'node:test';
import { init } from 'cagecast';
import { missedGoals } from '../../../bench/quality/goals.js';
import { measure, type Quality } from '../../../bench/quality/measure.js';
import { listFiles, loadFiles, type ModelFiles } from '../../../bench/quality/models.js';
import { score } from '../../../bench/quality/score.js';
import { visiblePixels } from '../../../bench/quality/visible.js';

describe('quality', () => {
  const results: Record<string, Quality> = {};
  const measureFiles = async (files: ModelFiles): Promise<Quality> =>
    (results[files.name] = await measure(await loadFiles(files)));
  const filesOf = (kind: ModelFiles['kind']): ModelFiles[] => listFiles().filter((files) => files.kind === kind);
  before(init);

  for (const files of filesOf('sample')) {
    test(`the ${files.name} is painted where it is to be, and nowhere else`, async (context) => {
      const quality = await measureFiles(files);
      for (const [method, { suppressed, kept, forbidden, bare }] of Object.entries(quality.methods)) {
        const shares = Object.entries({ suppressed, kept, forbidden, bare }).map(
          ([name, share]) => `${name} ${share.toFixed(4)}`,
        );
        context.diagnostic(`${method}: ${shares.join(', ')}`);
      }
      assert.deepEqual(missedGoals({ [files.name]: quality }), []);
    });
  }

  test('each step of the method suppresses no less than those before it', () => {
    for (const { methods } of Object.values(results)) {
      const suppressed = [methods.naive, methods['step 2'], methods['step 3'], methods.paper, methods.default].map(
        (score) => score.suppressed,
      );
      assert.deepEqual(
        suppressed,
        [...suppressed].sort((a, b) => a - b),
      );
    }
  });

  test('eyes fused to the skin, or a misplaced cage, let paint through, as the poster says', async () => {
    const sound = results['human']!.methods.paper;
    assert.equal(sound.forbidden, 0);
    const spoiled = await Promise.all(filesOf('spoiled').map(measureFiles));
    assert.equal(spoiled.length, 2);
    for (const {
      methods: { paper },
    } of spoiled)
      assert.ok(paper.forbidden > 0 && paper.suppressed < sound.suppressed, JSON.stringify(paper));
  });

  test('painting everything, or nothing, misses the goals', () => {
    const { lizard } = results;
    const withDefault = (suppressed: number, kept: number, forbidden: number, bare: number): string => {
      const methods = {
        ...lizard!.methods,
        default: { ...lizard!.methods.default, suppressed, kept, forbidden, bare },
      };
      return missedGoals({ lizard: { ...lizard!, methods } }).join('\n');
    };
    const { naive } = lizard!.methods;
    assert.match(
      withDefault(naive.suppressed, naive.kept, naive.forbidden, naive.bare),
      /default: suppressed.*\n.*paint where none must be/,
    );
    assert.match(withDefault(1, 0, 0, 1), /default: kept.*\n.*without paint/);
    assert.match(withDefault(NaN, NaN, NaN, NaN), /suppressed.*\n.*kept.*\n.*none must be.*\n.*without paint/);
  });

  test('a score leaves out what is ignored, and of what is to be painted what the cage says nothing about', () => {
    // Four triangles of areas 1, 2, 4 and 8, side by side.
    const positions = Float32Array.from([1, 2, 4, 8].flatMap((a, i) => [0, 0, i, 2 * a, 0, i, 0, 1, i]));
    const target = { positions, indices: Uint32Array.from({ length: 12 }, (_, v) => v) };
    const perVertex = (text: string): Uint8Array => Uint8Array.from([...text].flatMap((c) => [+c, +c, +c]));
    for (const [ncz, ignore, offCage, zones, suppressed, kept] of [
      ['0011', '0000', '0000', '0123', 1, 1 / 3],
      ['0011', '0000', '0000', '0003', 8 / 12, 1],
      ['0011', '0001', '0000', '0100', 0, 1 / 3],
      ['0011', '0000', '0100', '0203', 8 / 12, 1],
      ['0011', '0000', '0011', '0003', 8 / 12, 1],
    ] as const) {
      const truth = {
        ncz: perVertex(ncz),
        ignore: perVertex(ignore),
        offCage: perVertex(offCage),
        eyes: perVertex('0000'),
      };
      const found = score(target, truth, perVertex(zones));
      const text = `${ncz} ${ignore} ${offCage} ${zones}: ${JSON.stringify(found)}`;
      assert.ok(Math.abs(found.suppressed - suppressed) < 1e-6 && Math.abs(found.kept - kept) < 1e-6, text);
    }
  });

  test('pictures show the front surface, from all sides', () => {
    // A box in a larger one: nothing of the inner one is seen, and every side of the outer, though not from everywhere.
    const corners = (s: number): number[] =>
      [0, 1, 2, 3, 4, 5, 6, 7].flatMap((i) => [i & 1 ? s : -s, i & 2 ? s : -s, i & 4 ? s : -s]);
    const sides = [
      0, 2, 1, 1, 2, 3, 4, 5, 6, 5, 7, 6, 0, 1, 4, 1, 5, 4, 2, 6, 3, 3, 6, 7, 0, 4, 2, 2, 4, 6, 1, 3, 5, 3, 7, 5,
    ];
    const positions = Float32Array.from([...corners(0.9), ...corners(1)]);
    const counts = visiblePixels({ positions, indices: Uint32Array.from([...sides, ...sides.map((v) => v + 8)]) });
    const seen = (from: number, to: number): number => counts.subarray(from, to).reduce((sum, count) => sum + count, 0);
    assert.equal(seen(0, 36), 0, 'the inner box is hidden');
    for (let side = 6; side < 12; ++side) assert.ok(seen(6 * side, 6 * side + 6) > 1000, `side ${side} is seen`);
    // A box of side 2 around which a ball of radius √3 fills the picture: between its face and its section.
    const share = seen(36, 72) / (12 * 400 ** 2);
    assert.ok(share > 1 / 3 && share < 2 / 3, String(share));
  });
});
