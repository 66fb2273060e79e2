import assert from 'node:assert/strict';
import { test } from 'node:test';
import type { Timings } from 'cagecast';
import { beside } from '../../../web/src/state/study/beside';
import { methodsCsv, partsCsv } from '../../../web/src/state/study/csv';
import { readLabels } from '../../../web/src/state/study/labels';
import { isSought, treeOf } from '../../../web/src/state/study/parts';
import { scoreOf, vertexAreas } from '../../../web/src/state/study/score';
import { Study } from '../../../web/src/state/study/study';
import { sumUp } from '../../../web/src/state/study/timed';
import { begin, FakeTransferer, quiet, sceneOf } from './harness';

/** A head with an eye inside it, under a cage. */
async function beginStudy(labels?: string) {
  const page = await begin();
  const transferer = new FakeTransferer();
  const study = new Study(page.session, transferer, async () => labels);
  const open = async (parts: Record<string, number> = { Head: 1, Eye: 0.4 }): Promise<void> => {
    const target = page.loader.load(sceneOf('head.glb', parts));
    page.session.request({ target, cage: page.load('cage.glb', 1.5) });
    await page.ready();
  };
  return { ...page, transferer, study, open };
}

const wait = (isSo: () => unknown): Promise<void> =>
  new Promise((done, fail) => {
    const begun = Date.now();
    const look = (): unknown =>
      isSo() ? done() : Date.now() - begun > 5000 ? fail(new Error(`not so: ${isSo}`)) : setTimeout(look, 10);
    look();
  });

test('nothing is compared until that is wanted; then each way paints at most what the one before it does', async () => {
  const { study, open, transferer, session } = await beginStudy();
  await open();
  await quiet();
  assert.deepEqual([transferer.asked, study.found], [[], []]);
  study.active = true;
  await wait(() => study.decided);
  assert.deepEqual(transferer.asked.slice(0, 1), ['project paper head.glb'], 'the default is what is shown');
  const found = study.found;
  assert.deepEqual(
    found.map(({ method }) => method),
    ['naive', 'occlusion', 'rays', 'paper', 'default', 'result'],
  );
  const [naive = 0, occlusion = 0, rays = 0, paper = 0] = found.map(({ painted }) => painted);
  assert.equal(naive, 8);
  assert.ok(occlusion === 4 && rays <= occlusion && paper <= rays, 'the eye is inside the head');
  const { naive: all } = study.decided!;
  assert.ok(all.cosmeticTriangles.every((one) => one === 1));
  assert.equal(found.at(-1)!.painted, session.classification!.zones.filter((zone) => zone === 0).length);
});

test('another model is compared anew, one that moves when it rests; what is not active does nothing', async () => {
  const { study, open, transferer, session } = await beginStudy();
  const told: boolean[] = [];
  study.on('decided', (decided) => told.push(decided !== undefined));
  study.active = true;
  await open();
  await wait(() => study.decided);
  assert.deepEqual(told, [false, true]);
  for (let frame = 0; frame < 3; frame++) session.showFrame(session.shown!.projection, true);
  assert.equal(study.decided, undefined);
  await wait(() => study.decided);
  const { length } = transferer.asked.filter((asked) => asked.startsWith('project'));
  assert.equal(length, 2, 'once for each');
  study.active = false;
  await open({ Head: 2 });
  await new Promise((done) => setTimeout(done, 400));
  assert.equal(transferer.asked.filter((asked) => asked.startsWith('project')).length, length);
});

test('a preset that is set is the one that is not asked for', async () => {
  const { study, open, transferer, session, ready } = await beginStudy();
  session.setRules({ preset: 'paper' });
  study.active = true;
  await open();
  await ready();
  await wait(() => study.decided);
  assert.deepEqual(transferer.asked.slice(0, 1), ['project default head.glb']);
});

test('the time is the median of runs, as one of them, with the fastest and the slowest', async () => {
  const { study, open, transferer } = await beginStudy();
  const run = (total: number) => ({ total, build: total / 2 }) as Timings;
  transferer.runs = [run(9), run(3), run(100), run(4), run(5)];
  const told: unknown[] = [];
  study.on('timed', (timed) => told.push(timed));
  await open();
  await study.time();
  assert.deepEqual(told.at(-1), { median: run(5), fastest: 3, slowest: 100 });
  assert.deepEqual(transferer.asked, ['time default head.glb']);
  assert.equal(sumUp([run(1), run(2), run(3), run(4)]).median.total, 2, 'the lower of two in the middle');
});

test('labels are per vertex or by names of parts; others are refused with what is expected', () => {
  const mesh = {
    positions: new Float32Array(12),
    groups: Uint32Array.of(0, 0, 1, 2),
    names: [['Head'], ['l-eye', 'Eye_L'], ['a.b']],
  };
  const read = (labels: unknown) => readLabels(JSON.stringify(labels), 'labels.json', mesh);
  assert.deepEqual([...read({ ncz: '0101', ignore: [1, 0, 0, 0] }).ncz], [0, 1, 0, 1]);
  assert.deepEqual([...read({ ncz: '0101', ignore: [1, 0, 0, 0] }).ignore], [1, 0, 0, 0]);
  assert.deepEqual([...read({ ncz: ['*EYE*'] }).ncz], [0, 0, 1, 0]);
  assert.deepEqual([...read({ ncz: ['a?b'] }).ncz], [0, 0, 0, 0], 'only * is a pattern');
  assert.deepEqual([...read({ ncz: ['a.b'] }).offCage], [0, 0, 0, 0]);
  for (const [wrong, message] of [
    ['no JSON', /labels\.json: no labels; .*\{"ncz": \["\*eye\*"\]\}/],
    ['null', /no labels/],
    ['{"ncz": "010"}', /labels\.json: ncz: it has 3 values, and the model 4 vertices/],
    ['{"ncz": "0120"}', /names of parts are expected, or a 0 or a 1 for each vertex/],
    ['{"ncz": [0, 0, 2, 0]}', /0 or a 1/],
    ['{"ncz": 7}', /0 or a 1/],
  ] as const)
    assert.throws(() => readLabels(wrong, 'labels.json', mesh), message);
});

test('scores are shares of area: a third of each triangle goes to each corner', () => {
  // Two triangles of area 1/2 that share an edge, and a vertex of none.
  const positions = Float32Array.of(0, 0, 0, 1, 0, 0, 0, 1, 0, 1, 1, 0, 9, 9, 9);
  const areas = vertexAreas({ positions, indices: Uint32Array.of(0, 1, 2, 1, 3, 2) });
  assert.deepEqual(
    [...areas].map((area) => Math.round(60 * area)),
    [10, 20, 20, 10, 0],
  );
  const labels = (ncz: string, ignore = '00000', offCage = '00000') => {
    const of = (text: string) => Uint8Array.from(text, Number);
    return { ncz: of(ncz), ignore: of(ignore), offCage: of(offCage) };
  };
  const score = (ncz: string, zones: string, ignore?: string, offCage?: string) => {
    const { wrong, wrongArea, bareArea } = scoreOf(labels(ncz, ignore, offCage), areas, Uint8Array.from(zones, Number));
    return [wrong, Math.round(300 * wrongArea), Math.round(300 * bareArea)];
  };
  assert.deepEqual(score('11000', '00000'), [2, 300, 0], 'all of it is wrong, nothing is bare');
  assert.deepEqual(score('11000', '03000'), [1, 100, 0], 'the vertex of a sixth of the area, of a half');
  assert.deepEqual(score('11000', '33100'), [0, 0, 200]);
  assert.deepEqual(score('11000', '33100', '00100'), [0, 0, 0], 'what is ignored');
  assert.deepEqual(score('11000', '33100', '00000', '11100'), [0, 0, 0], 'the cage says nothing of it');
  assert.deepEqual(score('00000', '00000'), [0, 0, 0], 'nothing to do wrong');
});

test('labels of a sample are fetched, and the user’s own count more; without any there is no score', async () => {
  const page = await beginStudy('{"ncz": ["eye"]}');
  const { study, session } = page;
  study.active = true;
  await page.open();
  await wait(() => study.decided);
  assert.equal(study.found[0]!.score, undefined, 'a model of one’s own');
  await study.label(new File(['{"ncz": ["eye"]}'], 'labels.json'));
  const [naive, occlusion] = study.found;
  assert.deepEqual(naive!.score, { wrong: 4, wrongArea: 1, bareArea: 0 });
  assert.deepEqual(occlusion!.score, { wrong: 0, wrongArea: 0, bareArea: 0 });
  await assert.rejects(study.label(new File(['{"ncz": "1"}'], 'labels.json')), /8 vertices/);
  assert.equal(study.found[0]!.score!.wrong, 4, 'those that there were stay');

  const sample = { name: 'head', title: 'Head', target: '', cage: '', paints: [] };
  const target = await page.loader.load(sceneOf('sample.glb', { Head: 1, Eye: 0.4 }));
  session.request({ target: Promise.resolve({ ...target, sample }) });
  await page.ready();
  await wait(() => study.found[0]?.score);
  assert.equal(study.found[0]!.score!.wrong, 4);
});

test('the tree of parts has a branch for each mesh, and finds them by name and state', async () => {
  const { session, open } = await beginStudy();
  await open({ Head: 1, Eye: 0.4, Tail: 0.9 });
  const shown = session.shown!;
  const { branches, listed, all } = treeOf(shown, { 1: 'keep' });
  assert.deepEqual([listed, all], [3, 3]);
  assert.deepEqual(branches.map(({ name }) => name).toSorted(), ['Eye', 'Head', 'Tail']);
  const entries = branches.flatMap(({ entries }) => entries);
  const { segmentStats } = session.classification!;
  const found = (text: string, state: 'all' | 'painted' | 'culled' | 'chosen') =>
    entries
      .filter((entry) => isSought(entry, segmentStats[entry.segments[0]!]!, { text, state }))
      .map(({ name }) => name)
      .toSorted();
  assert.deepEqual(found(' hEA', 'all'), ['Head']);
  assert.deepEqual(found('', 'chosen'), ['Eye']);
  assert.deepEqual([...found('', 'painted'), ...found('', 'culled')].toSorted(), ['Eye', 'Head', 'Tail']);
  assert.deepEqual(found('head', 'chosen'), []);
});

test('tables can be opened by other programs: commas and quotes are kept, and nothing is taken for a formula', async () => {
  const { session, open } = await beginStudy();
  await open({ 'Head, "large"': 1, '=1+1': 0.4 });
  const lines = partsCsv(session.shown!, session.classification!).split('\r\n');
  assert.match(
    lines[0]!,
    /^part,segment,area,exposed,covered,coverage,culled,culledBy,cosmetic,occluded,uncovered,culled$/,
  );
  assert.ok(lines[1]!.startsWith('"Head, ""large""",0,'), lines[1]);
  assert.ok(lines[2]!.startsWith("'=1+1,1,"), lines[2]);
  assert.equal(lines[3], '');
  const score = { wrong: 2, wrongArea: 0.25, bareArea: 0 };
  assert.equal(
    methodsCsv([
      { method: 'naive', painted: 8, score },
      { method: 'paper', painted: 6, score: undefined },
    ]),
    'method,painted,wrong,wrongArea,bareArea\r\nnaive,8,2,0.25,0\r\npaper,6,,,\r\n',
  );
});

const kBox = { width: 300, height: 200 };
const kView = { width: 900, height: 600, top: 60, bottom: 80 };

test('a box is to the right of its spot, else to its left, within the free part of the view', () => {
  assert.deepEqual(beside({ x: 100, y: 300 }, kBox, kView), { x: 116, y: 200 });
  assert.deepEqual(beside({ x: 700, y: 300 }, kBox, kView), { x: 384, y: 200 });
  assert.deepEqual(beside({ x: 100, y: 70 }, kBox, kView), { x: 116, y: 68 });
  assert.deepEqual(beside({ x: 100, y: 590 }, kBox, kView), { x: 116, y: 312 });
});

test('in a narrow view it is above its spot or below it, and never outside', () => {
  const narrow = { ...kView, width: 390 };
  assert.deepEqual(beside({ x: 200, y: 400 }, kBox, narrow), { x: 50, y: 184 });
  assert.deepEqual(beside({ x: 380, y: 200 }, kBox, narrow), { x: 64, y: 100 }, 'but beside it if there is room');
  assert.deepEqual(beside({ x: 90, y: 200 }, kBox, { ...narrow, width: 360 }), { x: 8, y: 216 });
  for (let x = -50; x < 450; x += 50)
    for (let y = -50; y < 650; y += 50) {
      const at = beside({ x, y }, kBox, narrow);
      assert.ok(at.x >= 8 && at.x <= 82 && at.y >= 68 && at.y <= 392, `${x}, ${y}: ${at.x}, ${at.y}`);
    }
});
