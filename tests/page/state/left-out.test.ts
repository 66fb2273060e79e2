import assert from 'node:assert/strict';
import { test } from 'node:test';
import { classify, type Finding, init, transfer } from 'cagecast';
import { codeFor } from '../../../web/src/export/code';
import { choicesOf, kFirstRules, type Locks } from '../../../web/src/state/choices';
import { choicesWithout, projectBy } from '../../../web/src/state/left-out';
import type { Model } from '../../../web/src/state/model';
import { remedyFor, takeBacks } from '../../../web/src/state/verdict/verdict';
import { ball, head, join3d } from '../../package/scenes';
import { tetrahedron } from '../../support/glb';
import { begin, copyOf, FakeTransferer, quiet, refusal, sceneOf } from './harness';

/** A session with a head in a visor. */
async function visored() {
  const page = await begin();
  const { session, loader } = page;
  session.request({
    target: loader.load(sceneOf('knight.glb', { Head: 1, Visor: 2, '(Rest)': 1 })),
    cage: page.load('cage.glb', 4),
  });
  await page.ready();
  const finding = (code: string, more: object): Finding => ({ code, numbers: {}, ...more }) as never;
  return {
    ...page,
    get state() {
      return page.state;
    },
    /** How many vertices of each part are painted. */
    painted: () => {
      const { zones } = session.classification!;
      return session
        .shown!.target.mesh.primitives.map(
          ({ name, firstVertex, vertexCount }) =>
            `${name} ${zones.subarray(firstVertex, firstVertex + vertexCount).filter((zone) => zone === 0).length}`,
        )
        .join();
    },
    remedy: (code: string, more: object) =>
      remedyFor(finding(code, more), { inward: { share: 0, triangles: [] } }, session, {} as never)!,
  };
}

test('a part that hides much is left out with a click, and taken back with another', async () => {
  const page = await visored();
  const { session } = page;
  assert.equal(page.painted(), 'Head 0,Visor 4');
  const { segments } = session.shown!.projection;
  const leaveOut = page.remedy('muchHidden', { ignore: ['Visor'] });
  assert.equal(leaveOut.title, 'Leave out “Visor”');
  leaveOut.run();
  await page.ready();
  assert.equal(page.painted(), 'Head 4,Visor 0');
  assert.deepEqual(session.locks, { 1: 'out' });
  assert.deepEqual(session.shown!.projection.segments, segments);
  session.setRules({ preset: 'paper' });
  session.request({ cage: page.load('other.glb', 5, 1) });
  await page.ready();
  assert.equal(page.painted(), 'Head 4,Visor 0', 'it stays so by other rules and with another cage');
  assert.match(codeFor(session).command, / --ignore Visor /);
  assert.match(codeFor(session).three, /parts: \{ ignore: \["Visor"\] \}/);
  const [back, ...others] = takeBacks(session);
  assert.deepEqual([back!.title, others], ['Take back “Visor”', []]);
  back!.run();
  await page.ready();
  assert.equal(page.painted(), 'Head 0,Visor 4');
  assert.deepEqual([takeBacks(session), session.locks], [[], {}]);
});

test('a part that is kept or stays bare is so by its name, in code as on the command line', async () => {
  const { session, ready } = await visored();
  session.lock([0], 'keep');
  session.lock([1], 'exclude');
  await ready();
  assert.match(codeFor(session).command, / --keep Head --exclude Visor /);
  assert.match(codeFor(session).three, / parts: \{ keep: \["Head"\], exclude: \["Visor"\] \} \}/);
});

test('what cannot be left out, or comes too late, changes nothing; what is left out comes with a project at once', async () => {
  const page = await visored();
  const { session } = page;
  page.transferer.failure = refusal();
  session.lock([1], 'out');
  await page.failed();
  assert.deepEqual([page.painted(), session.locks], ['Head 0,Visor 4', {}]);
  page.transferer.gate.hold();
  session.lock([1], 'out');
  await quiet();
  session.cancel();
  page.transferer.gate.open();
  await quiet();
  assert.deepEqual([page.state, page.painted(), session.locks], ['ready', 'Head 0,Visor 4', {}]);
  session.lock([1], 'out');
  await page.ready();
  page.transferer.gate.hold();
  session.lock([1], 'keep');
  await quiet();
  session.cancel();
  page.transferer.gate.open();
  await quiet();
  assert.deepEqual([page.painted(), session.locks[1]], ['Head 4,Visor 0', 'out']);
  session.request({ target: page.loader.load(sceneOf('twin.glb', { Head: 1, Visor: 2 })) }, { 1: 'out' });
  await page.ready();
  assert.equal(page.painted(), 'Head 4,Visor 0');
});

test('pieces that almost touch are joined with a click; choices follow the pieces', async () => {
  const page = await visored();
  const { session } = page;
  const [one, two] = [tetrahedron(1), tetrahedron(1)];
  two.positions.forEach((x, i) => (two.positions[i] = x * (i < 6 ? 1.000001 : 3)));
  const torn = { ...join3d(one, two), groups: new Uint32Array(8) };
  session.request({ target: page.loader.load(copyOf('torn.glb', { mesh: torn } as never)) });
  await page.ready();
  assert.equal(session.shown!.projection.segmentStats.length, 2);
  session.lock([1], 'exclude');
  const join = page.remedy('piecesApart', { numbers: { weldTolerance: 1e-5 } });
  assert.equal(join.title, 'Join pieces');
  session.lock([0], 'keep');
  join.run();
  await page.ready();
  const { segmentStats, weldTolerance } = session.shown!.projection;
  assert.deepEqual([segmentStats.length, weldTolerance, session.locks], [1, 1e-5, { 0: 'keep' }]);
  assert.match(codeFor(session).command, /--set weldTolerance=0\.00001 /);
  session.setRules({ weldTolerance: 0 });
  await page.ready();
  assert.deepEqual(session.locks, { 0: 'keep', 1: 'keep' });
  page.transferer.failure = refusal();
  join.run();
  await page.failed();
  assert.equal(session.rules.weldTolerance, 0);
});

test('what is exported without a part is what is shown without it: locks and masks are for the same spots', async () => {
  await init();
  const { cage, target } = head(1);
  const shell = ball([0, 0, 0], () => 1.11, 12, 20);
  const [first, second] = [0, 0.05].map((up) => ball([0, 0, 1.05 + up], () => 0.02, 4, 6));
  const parts = [shell, target, first!, second!];
  const whole = join3d(...parts);
  // The third part has two segments; the target, which has three groups in its own file, is one here.
  const groups = whole.groups.map((part) => Math.min(part, 2));
  const vertices = [0, 1, 2].map((part) => groups.filter((group) => group === part).length);
  const primitives = vertices.map((vertexCount, p) => ({
    name: `part ${p}`,
    vertexCount,
    firstVertex: groups.indexOf(p),
  }));
  const model = { mesh: { ...whole, groups, primitives, accessories: [2] } } as unknown as Model;
  const chosen: Locks = { 0: 'out', 2: 'keep', 4: 'keep' };
  const scene = { cage: { mesh: { ...cage, primitives: [] } } as unknown as Model, target: model };
  const made = await projectBy(new FakeTransferer(), scene, kFirstRules, () => chosen);
  assert.deepEqual(made.leftOut, [0]);
  const bare = Uint8Array.from({ length: whole.indices.length / 3 }, (_, triangle) => +(triangle % 7 === 0));
  const choices = choicesOf(chosen, [2], made, bare);
  const shown = classify(made, choices);

  const rest = join3d(...parts.slice(1));
  const { parts: numbers, ...others } = choicesWithout(choices, model.mesh, made);
  assert.deepEqual(numbers, { exclude: [2], ignore: [0] });
  const exported = transfer(
    cage,
    { ...rest, groups: groups.subarray(vertices[0]) },
    { ...others, parts: { exclude: numbers!.exclude } },
  );
  assert.deepEqual(shown.zones.subarray(vertices[0]), exported.zones);
  assert.deepEqual(shown.cosmeticTriangles.subarray(shell.indices.length / 3), exported.cosmeticTriangles);
  assert.ok(shown.zones.subarray(0, vertices[0]).every((zone) => zone !== 0));
  assert.ok(exported.zones.includes(0));
  const visible = classify(await projectBy(new FakeTransferer(), scene, kFirstRules, () => ({})), {});
  assert.ok(!visible.zones.subarray(vertices[0], vertices[0]! + vertices[1]!).includes(0), 'the shell hides it');
});
