import assert from 'node:assert/strict';
import path from 'node:path';
import { before, test } from 'node:test';
import { classify, init, type Mesh, type Projection, project } from 'cagecast';
import { BoundaryLoops } from '../../../web/src/explain/boundary-loops';
import { explain } from '../../../web/src/explain/explanation';
import type { Shown } from '../../../web/src/state/scene';
import { modelFolders, readPlain, smallHole } from '../../package/scenes';

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

for (const folder of modelFolders()) {
  test(`${path.basename(folder)}: explanations agree with the zones and the verdicts`, async () => {
    const [target, cage] = await Promise.all(
      ['target', 'cage'].map((name) => readPlain(path.join(folder, `${name}.glb`))),
    );
    const loops = new BoundaryLoops(cage!);
    for (const preset of ['default', 'paper'] as const) {
      const projection = project(cage!, target!, { preset });
      // Of the models only their meshes are asked for.
      const shown = { target: { mesh: withPrimitives(target!) }, cage: { mesh: cage }, projection } as unknown as Shown;
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
    const shown = { target: { mesh: withPrimitives(target!) }, cage: { mesh: cage }, projection } as unknown as Shown;
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
  const shown = { target: { mesh: withPrimitives(target) }, cage: { mesh: cage }, projection } as unknown as Shown;
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
    const classification = classify(projection, { locks: { segments: locks } });
    const shown = { target: { mesh: withPrimitives(target!) }, cage: { mesh: cage }, projection } as unknown as Shown;
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
