import assert from 'node:assert/strict';
import path from 'node:path';
import { before, test } from 'node:test';
import { classify, init, type Mesh, type Projection, project, Visibility } from 'cagecast';
import { BoundaryLoops } from '../../../web/src/explain/boundary-loops';
import { explain } from '../../../web/src/explain/explanation';
import type { Shown } from '../../../web/src/state/scene';
import { head, modelFolders, readPlain, smallHole, within } from '../../package/scenes';

before(() => init());

/** A mesh with a primitive for each group, as on the page. */
function withPrimitives(mesh: Mesh) {
  const { groups, indices } = mesh;
  const count = Math.max(...groups!) + 1;
  const firstTriangle = (group: number): number => {
    for (let triangle = 0; 3 * triangle < indices.length; triangle++)
      if (groups![indices[3 * triangle]!]! >= group) return triangle;
    return indices.length / 3;
  };
  return {
    ...mesh,
    primitives: Array.from({ length: count }, (_, group) => ({
      name: `part ${group}`,
      firstTriangle: firstTriangle(group),
    })),
  };
}

/** What is shown of a projection; of the models only their meshes are asked for. */
const shownOf = (cage: Mesh, target: Mesh, projection: Projection): Shown =>
  ({
    target: { mesh: withPrimitives(target) },
    cage: { mesh: cage },
    projection: { ...projection, leftOut: [] },
  }) as unknown as Shown;

for (const folder of modelFolders()) {
  test(`${path.basename(folder)}: explanations agree with the zones and the verdicts`, async () => {
    const [target, cage] = await Promise.all(
      ['target', 'cage'].map((name) => readPlain(path.join(folder, `${name}.glb`))),
    );
    const loops = new BoundaryLoops(cage!);
    for (const preset of ['default', 'paper'] as const) {
      const projection = project(cage!, target!, { preset });
      const shown = shownOf(cage!, target!, projection);
      const segmentOf = (triangle: number): number => projection.segments[target!.indices[3 * triangle]!]!;
      // One triangle of each segment.
      const triangles = new Map(
        Array.from({ length: target!.indices.length / 3 }, (_, triangle) => [segmentOf(triangle), triangle]),
      );
      for (const threshold of [0.3, 0.5, 0.8]) {
        const classification = classify(projection, { threshold });
        for (const [segment, triangle] of triangles) {
          const facts = { shown, classification, rules: { preset, threshold }, locks: {}, loops };
          const { verdict, steps, part, zone } = explain(facts, triangle, [1, 0, 0]);
          const { culled, coverage } = classification.segmentStats[segment]!;
          const where = `${preset}, ${threshold}, segment ${segment}: ${steps.at(-1)!.sentence}`;
          assert.equal(verdict === 'Painted', classification.cosmeticTriangles[triangle] === 1, where);
          assert.equal(zone === 0, verdict === 'Painted');
          assert.match(
            steps.at(-1)!.sentence,
            culled ? /culled as a whole|exposed, so it is culled/ : /passes\.|is exposed\./,
            where,
          );
          assert.equal(part.passes, !culled);
          // Whatever is culled although it is covered well enough is distinguished from what is not.
          if (culled && coverage >= threshold && part.exposed > 0)
            assert.match(steps.at(-1)!.sentence, /area is small|beneath the cage|meant for it/, where);
        }
      }
    }
  });
}

test('a vertex that was recovered is explained by what recovered it: a recheck, or the rule for holes', async () => {
  const found = new Map<number, number>();
  for (const folder of modelFolders()) {
    const [target, cage] = await Promise.all(
      ['target', 'cage'].map((name) => readPlain(path.join(folder, `${name}.glb`))),
    );
    const projection = project(cage!, target!);
    const shown = shownOf(cage!, target!, projection);
    const classification = classify(projection);
    const loops = new BoundaryLoops(cage!);
    for (const zone of [1, 2]) {
      const triangle = classification.cosmeticTriangles.findIndex((isPainted, t) => {
        const vertex = target!.indices[3 * t]!;
        return isPainted === 1 && projection.visibility[vertex] === zone && classification.zones[vertex] === 0;
      });
      if (triangle < 0) continue;
      const facts = { shown, classification, rules: { preset: 'default', threshold: 0.5 } as const, locks: {}, loops };
      const { because, steps } = explain(facts, triangle, [1, 0, 0]);
      const step = steps.find(({ title }) => title === (zone === 1 ? 'Recheck' : 'Hole'));
      assert.match(
        because,
        zone === 1 ? /seemed hidden, but rays|only what stays bare/ : /uncovered, but the rule for holes/,
        folder,
      );
      assert.match(step?.sentence ?? '', /so it is recovered/, folder);
      found.set(zone, (found.get(zone) ?? 0) + 1);
    }
  }
  assert.deepEqual([...found.keys()].sort(), [1, 2], 'both are among the models');
});

test('a part that a hole is meant for is explained so, and is painted without that rule', () => {
  const { cage, target } = smallHole();
  const projection = project(cage, target);
  const shown = shownOf(cage, target, projection);
  const isEyes = (triangle: number): boolean => projection.segments[target.indices[3 * triangle]!] === 1;
  const covered = Array.from({ length: target.indices.length / 3 }, (_, triangle) => triangle).find(
    (triangle) => isEyes(triangle) && projection.visibility[target.indices[3 * triangle]!] === 0,
  )!;
  const told = (projected: Projection): string => {
    const facts = {
      shown,
      classification: classify(projected),
      rules: { preset: 'default', threshold: 0.5 } as const,
      locks: {},
      loops: new BoundaryLoops(cage),
    };
    const { verdict, because, steps } = explain(facts, covered, [1, 0, 0]);
    return `${verdict}: ${because}. ${steps.at(-1)!.sentence}`;
  };
  assert.match(
    told(projection),
    /^Not painted: culled: a hole of the cage seems to be meant for “part 1”\. .* covers 69 % of its exposed area, which is enough\. But it is small, .* meant for it\./,
  );
  assert.match(
    told(project(cage, target, { steps: { holes: false } })),
    /^Painted: .* covers 69 % of its exposed area, at least the threshold of 50 %: it passes\.$/,
  );
});

test('a locked part is explained by its lock only', async () => {
  const folder = modelFolders()[0]!;
  const [target, cage] = await Promise.all(
    ['target', 'cage'].map((name) => readPlain(path.join(folder, `${name}.glb`))),
  );
  const projection = project(cage!, target!);
  const segment = projection.segments[target!.indices[0]!]!;
  for (const lock of ['keep', 'exclude'] as const) {
    const locks = { [segment]: lock };
    const classification = classify(projection, { locks });
    const shown = shownOf(cage!, target!, projection);
    const { steps } = explain(
      { shown, classification, rules: { preset: 'default', threshold: 0.5 }, locks, loops: new BoundaryLoops(cage!) },
      0,
      [1, 0, 0],
    );
    assert.match(
      steps.at(-1)!.sentence,
      new RegExp(`You chose to ${lock} it.*${lock === 'keep' ? 'it passes' : 'it is culled'}`),
    );
  }
});

test('what lies beyond the border of an open cage is explained so, and not as a hole', () => {
  const { cage: whole, target } = head(1);
  const cage = within(whole, (_, __, z) => z > 0.6);
  const projection = project(cage, target);
  const shown = shownOf(cage, target, projection);
  const classification = classify(projection);
  const facts = { shown, classification, rules: { preset: 'default', threshold: 0.5 } as const, locks: {} };
  const isBeyond = (corner: number): boolean => projection.visibility[target.indices[corner]!] === Visibility.Beyond;
  const beyond = Array.from({ length: target.indices.length / 3 }, (_, triangle) => triangle).find((triangle) =>
    [0, 1, 2].every((corner) => isBeyond(3 * triangle + corner)),
  )!;
  const { verdict, because, steps } = explain({ ...facts, loops: new BoundaryLoops(cage) }, beyond, [1, 0, 0]);
  assert.equal(verdict, 'Not painted: beyond the cage');
  assert.equal(because, 'it lies beyond the border of the cage, which says nothing of it');
  assert.deepEqual(
    steps.map(({ title }) => title),
    ['Closest', 'Border', 'Part'],
  );
  assert.doesNotMatch(steps.map(({ sentence }) => sentence).join(' '), /hole/);
});
