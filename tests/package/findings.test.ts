import assert from 'node:assert/strict';
import { before, describe, test } from 'node:test';
import { type Finding, init, inspect, type Mesh, type TransferOptions, transfer } from 'cagecast';
import { isDoubtful } from '../../wasm/src/inspect/finding.js';
import { ball, head, join3d, readPlain, smallHole, within } from './scenes.js';

before(init);

const { cage, target } = head(1, 16);
const codes = (findings: readonly Finding[]): string[] => findings.map(({ code }) => code);
const find = (findings: readonly Finding[], code: string): Finding => {
  const found = findings.find((finding) => finding.code === code);
  assert.ok(found, `${code} is missing: ${JSON.stringify(findings)}`);
  return found;
};
/** Without those about the surface and the UVs of the cage. */
const findingsOf = (...args: Parameters<typeof inspect>): Finding[] =>
  inspect(...args).findings.filter(({ code }) => !/^(uvs|cracks|nonManifold|degenerate|doubled)/.test(code));
const sample = async (name: string): Promise<{ cage: Mesh; target: Mesh }> => ({
  cage: await readPlain(`examples/samples/${name}/cage.glb`),
  target: await readPlain(`examples/samples/${name}/target.glb`),
});
const culled = (options: TransferOptions): boolean[] =>
  transfer(cage, target, options).segmentStats.map((segment) => segment.culled);

describe('the findings about a result', () => {
  test('are none if the cage fits and nothing is in doubt', async () => {
    assert.deepEqual(findingsOf(cage, target), []);
    for (const name of ['lizard', 'human']) {
      const scene = await sample(name);
      assert.deepEqual(findingsOf(scene.cage, scene.target), [], name);
    }
  });

  test('eyes fused with the skin: the holes over them, and the segments that they cut', async () => {
    const scene = await sample('human-fused');
    const { places, sentence } = find(findingsOf(scene.cage, scene.target), 'holeUnexplained');
    assert.match(sentence, /^2 holes/);
    const { segmentStats } = transfer(scene.cage, scene.target);
    assert.deepEqual(
      places!.map(({ segment }) => segmentStats[segment]!.culled),
      [false],
    );
  });

  test('a misplaced cage: that first, then the skin in doubt, and the lock that decides it', async () => {
    const scene = await sample('human-misaligned');
    const findings = findingsOf(scene.cage, scene.target);
    assert.equal(findings[0]!.code, 'cageMisplaced');
    const { places, locks } = find(findings, 'segmentInDoubt');
    const { segment } = places![0]!;
    assert.equal(transfer(scene.cage, scene.target).segmentStats[segment]!.culled, false);
    assert.equal(transfer(scene.cage, scene.target, { locks }).segmentStats[segment]!.culled, true);
  });

  test('near the threshold on either side: the reason, and the lock that reverses the verdict', () => {
    const [, eye] = transfer(cage, target).segmentStats;
    for (const [threshold, words] of [
      [eye!.coverage - 0.02, /is painted, but only just: .* and the threshold is/],
      [eye!.coverage + 0.02, /is not painted, but only just: .* less than the threshold/],
    ] as const) {
      const options = { threshold, steps: { floor: false, holes: false } } as const;
      const { sentence, advice, places, locks } = find(findingsOf(cage, target, options), 'segmentInDoubt');
      assert.match(sentence, words);
      assert.deepEqual(places, [{ segment: 1, group: 1, part: 'group 1' }]);
      const isCulled = culled(options)[1]!;
      assert.match(advice, /^If that is wrong, override it, /);
      assert.equal(culled({ ...options, locks })[1], !isCulled);
      for (const lock of ['keep', 'exclude'] as const)
        assert.ok(!codes(findingsOf(cage, target, { ...options, locks: { 1: lock } })).includes('segmentInDoubt'));
    }
  });

  test('a coverage below the threshold reads as less, and a part that is named as the reason is not in doubt as well', async () => {
    const near = smallHole(0.1);
    const { sentence } = find(
      findingsOf(near.cage, near.target, { threshold: 0.69, steps: { floor: false, holes: false } }),
      'segmentInDoubt',
    );
    assert.match(sentence, /its coverage is 0\.68, less than the threshold of 0\.69/); // 0.6859
    const bust = await sample('human');
    assert.deepEqual(codes(findingsOf(bust.cage, bust.target, { threshold: 1 })), ['nothingToPaint']);
  });

  test('a hole that seems to be meant for a part: it says so, and has the lock that paints it', () => {
    const { cage, target } = smallHole(0.08);
    const { sentence, places, locks } = find(findingsOf(cage, target), 'segmentInDoubt');
    assert.match(
      sentence,
      /^"group 1" is not painted, but only just: its coverage is 0\.81, but a hole of the cage seems to be meant for it/,
    );
    assert.deepEqual(
      places!.map(({ segment }) => segment),
      [1],
    );
    assert.deepEqual(
      transfer(cage, target, { locks }).segmentStats.map(({ culled }) => culled),
      [false, false],
    );
  });

  test('near the least covered area: it says so', () => {
    const { cage, target } = smallHole();
    const [, eye] = transfer(cage, target).segmentStats;
    const minCovered = (0.95 * eye!.coveredArea * eye!.coverage) / eye!.area;
    assert.match(
      find(findingsOf(cage, target, { threshold: 0.1, minCovered, steps: { holes: false } }), 'segmentInDoubt')
        .sentence,
      /"group 1" is painted, but only just: its coverage is \d\.\d\d, and it has 1\.1 times the required covered area/,
    );
  });

  test('many pieces of one part are one finding', () => {
    // Balls under the rim of a cage that ends at the equator: half of each is covered.
    const balls = join3d(...[0, 1, 2, 3, 4].map((i) => ball([2 * i, 0, 0], () => 0.5, 24, 24)));
    const shells = join3d(...[0, 1, 2, 3, 4].map((i) => ball([2 * i, 0, 0], () => 0.55, 24, 24)));
    const upper = within(shells, (_, __, z) => z > -0.01);
    const one = { ...balls, groups: undefined };
    const found = findingsOf(upper, one, { preset: 'paper' }).filter(({ code }) => code === 'segmentInDoubt');
    assert.equal(found.length, 1);
    assert.match(found[0]!.sentence, /^5 segments of "target" are painted, but only just/);
    assert.equal(found[0]!.places!.length, 5);
  });
});

test('a cage that is nearly unfit, or has a hole over nothing, is in doubt', () => {
  assert.ok(!isDoubtful([]) && !isDoubtful([{ code: 'eyesUnknown', weight: 0.3 }]));
  assert.ok(
    isDoubtful([
      { code: 'eyesUnknown', weight: 0.3 },
      { code: 'targetPokesOut', weight: 0.66 },
    ]),
  );
  assert.ok(isDoubtful([{ code: 'holeUnexplained', weight: 0.3 }]));
});
