import assert from 'node:assert/strict';
import { before, describe, test } from 'node:test';
import { CagecastError, init, type Mesh, type TransferOptions, transfer } from 'cagecast';
import { type Finding, inspect, suggest } from 'cagecast/inspect';
import { ball, head, join3d, readPlain, smallHole, within } from './scenes.js';

before(init);

const { cage, target } = head(1, 16);
const codes = (findings: readonly Finding[]): string[] => findings.map(({ code }) => code);
const find = (findings: readonly Finding[], code: string): Finding => {
  const found = findings.find((finding) => finding.code === code);
  assert.ok(found, `${code} is missing: ${JSON.stringify(findings)}`);
  return found;
};
const sample = async (name: string): Promise<{ cage: Mesh; target: Mesh }> => ({
  cage: await readPlain(`examples/samples/${name}/cage.glb`),
  target: await readPlain(`examples/samples/${name}/target.glb`),
});
const culled = (options: TransferOptions): boolean[] =>
  transfer(cage, target, options).segmentStats.map((segment) => segment.culled);

describe('score', () => {
  test('is at least 1 if a segment passes without its lock, and less if it is culled', () => {
    for (const options of [
      {},
      { preset: 'paper' },
      { threshold: 0.9 },
      { steps: { floor: 'area' } },
      { threshold: 0 },
    ] satisfies TransferOptions[]) {
      const { segmentStats } = transfer(cage, target, options);
      for (const segment of segmentStats)
        assert.equal(segment.score < 1, segment.culled, JSON.stringify({ options, segment }));
      const locked = transfer(cage, target, { ...options, locks: { segments: { 0: 'exclude', 1: 'keep' } } });
      assert.deepEqual(
        locked.segmentStats.map(({ score }) => score),
        segmentStats.map(({ score }) => score),
      );
    }
  });

  test('without a floor is the coverage by the threshold', () => {
    for (const { exposedArea, coverage, score } of transfer(cage, target, { preset: 'paper', threshold: 0.4 })
      .segmentStats) {
      const expected = exposedArea > 0 ? coverage / Math.fround(0.4) : Infinity; // nothing is asked of what is hidden
      assert.ok(score === expected || Math.abs(score - expected) < 1e-9, String(score));
    }
  });
});

describe('suggest', () => {
  test('is empty if the cage fits and nothing is in doubt', async () => {
    assert.deepEqual(suggest(cage, target), []);
    for (const name of ['lizard', 'human']) {
      const scene = await sample(name);
      assert.deepEqual(suggest(scene.cage, scene.target), [], name);
    }
  });

  test('gives exactly the findings of inspect about the result', async () => {
    for (const name of ['human-fused', 'human-misaligned', 'car']) {
      const scene = await sample(name);
      const suggestions = suggest(scene.cage, scene.target);
      const { findings } = inspect(scene.cage, scene.target);
      assert.deepEqual(
        suggestions,
        findings.filter(({ code }) => codes(suggestions).includes(code)),
      );
      assert.ok(
        findings.every(
          ({ code }) => codes(suggestions).includes(code) || /^(uvs|cracks|nonManifold|degenerate|doubled)/.test(code),
        ),
        JSON.stringify(findings),
      );
    }
  });

  test('eyes fused with the skin: the holes over them, and the segments that they cut', async () => {
    const scene = await sample('human-fused');
    const { places, sentence } = find(suggest(scene.cage, scene.target), 'holeUnexplained');
    assert.match(sentence, /^2 holes/);
    const { segmentStats } = transfer(scene.cage, scene.target);
    assert.deepEqual(
      places!.map(({ segment }) => segmentStats[segment]!.culled),
      [false],
    );
  });

  test('a misplaced cage: that first, then the skin in doubt, and the lock that decides it', async () => {
    const scene = await sample('human-misaligned');
    const suggestions = suggest(scene.cage, scene.target);
    assert.equal(suggestions[0]!.code, 'cageMisplaced');
    const { places, locks } = find(suggestions, 'segmentInDoubt');
    const { segment } = places![0]!;
    assert.equal(transfer(scene.cage, scene.target).segmentStats[segment]!.culled, false);
    assert.equal(transfer(scene.cage, scene.target, { locks }).segmentStats[segment]!.culled, true);
  });

  test('a cage inside the skin', () => {
    const shrunk = { ...cage, positions: cage.positions.map((x) => 0.85 * x) };
    assert.equal(suggest(shrunk, target)[0]!.code, 'cageTooSmall');
  });

  test('near the threshold on either side: the reason, and the lock that reverses the verdict', () => {
    const [, eye] = transfer(cage, target).segmentStats;
    for (const [threshold, words] of [
      [eye!.coverage - 0.02, /is painted, but only just: .* and the threshold is/],
      [eye!.coverage + 0.02, /is not painted, but only just: .* less than the threshold/],
    ] as const) {
      const options = { threshold, steps: { floor: 'none', holeContents: false } } as const;
      const { sentence, advice, places, locks } = find(suggest(cage, target, options), 'segmentInDoubt');
      assert.match(sentence, words);
      assert.deepEqual(places, [{ segment: 1, group: 1, part: 'group 1' }]);
      const isCulled = culled(options)[1]!;
      assert.match(advice, /^If that is wrong, override it, /);
      assert.equal(culled({ ...options, locks })[1], !isCulled);
    }
  });

  test('a coverage below the threshold reads as less, and a part that is named as the reason is not in doubt as well', async () => {
    const near = smallHole(0.1);
    const { sentence } = find(
      suggest(near.cage, near.target, { threshold: 0.69, steps: { floor: 'none', holeContents: false } }),
      'segmentInDoubt',
    );
    assert.match(sentence, /its coverage is 0\.68, less than the threshold of 0\.69/); // 0.6859
    const bust = await sample('human');
    assert.deepEqual(codes(suggest(bust.cage, bust.target, { threshold: 1 })), ['nothingToPaint']);
  });

  test('a hole that seems to be meant for a part: it says so, and has the lock that paints it', () => {
    const { cage, target } = smallHole(0.08);
    const { sentence, places, locks } = find(suggest(cage, target), 'segmentInDoubt');
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
    const [skin] = transfer(cage, target).segmentStats;
    const options = {
      threshold: 0.1,
      minCovered: (0.95 * skin!.coveredArea) / skin!.area,
      steps: { floor: 'area' },
    } as const;
    assert.match(
      find(suggest(cage, target, options), 'segmentInDoubt').sentence,
      /"group 0" is painted, but only just: its coverage is \d\.\d\d, and it has 1\.1 times the required covered area/,
    );
  });

  test('its errors name it', () => {
    const result = transfer(cage, target);
    for (const [options, expected] of [
      [null, 'suggest: options is null, not an object'],
      [{ parts: 5 }, 'suggest: options.parts is 5, not an array of ranges of vertices'],
      [
        { result: { ...result, segmentStats: 5 } },
        'suggest: result.segmentStats is 5, not an array; pass what transfer() returned',
      ],
    ] as const)
      assert.throws(
        () => suggest(cage, target, options as never),
        (error) => error instanceof CagecastError && error.message === expected,
        expected,
      );
    assert.throws(
      () => suggest({} as Mesh, target, { result }),
      /^CagecastError: suggest: cage\.positions is undefined/,
    );
  });

  test('many pieces of one part are one suggestion', () => {
    // Balls under the rim of a cage that ends at the equator: half of each is covered.
    const balls = join3d(...[0, 1, 2, 3, 4].map((i) => ball([2 * i, 0, 0], () => 0.5, 24, 24)));
    const shells = join3d(...[0, 1, 2, 3, 4].map((i) => ball([2 * i, 0, 0], () => 0.55, 24, 24)));
    const upper = within(shells, (_, __, z) => z > -0.01);
    const one = { ...balls, groups: undefined };
    const found = suggest(upper, one, { preset: 'paper' }).filter(({ code }) => code === 'segmentInDoubt');
    assert.equal(found.length, 1);
    assert.match(found[0]!.sentence, /^5 segments of "target" are painted, but only just/);
    assert.equal(found[0]!.places!.length, 5);
  });

  test('twins of which some are painted and some not', () => {
    const shell = ball([0, 0, 0], () => 1.1, 16, 24);
    const twins = join3d(
      ball([0, 0, 0], () => 1, 16, 24),
      ball([4, 0, 0], () => 1, 16, 24),
    );
    const { places, locks, sentence } = find(suggest(shell, twins), 'twinsDiffer');
    assert.equal(sentence, 'Of 2 segments with the shape of "group 0", 1 is painted and 1 is not');
    assert.deepEqual(places!.map(({ segment }) => segment).sort(), [0, 1]);
    assert.deepEqual(locks, { segments: { 1: 'keep' } });
  });

  test('takes an existing result, and gives plain data', () => {
    const options = {
      threshold: 0.99,
      parts: [{ name: 'all', firstVertex: 0, vertexCount: target.positions.length / 3 }],
    };
    const again = suggest(cage, target, { ...options, result: transfer(cage, target, { threshold: 0.99 }) });
    assert.ok(again.length > 0);
    assert.deepEqual(again, suggest(cage, target, options));
    assert.deepEqual(structuredClone(again), again);
  });
});
