import assert from 'node:assert/strict';
import { test } from 'node:test';
import type { Finding, Inspection } from 'cagecast';
import { type Spot, spotsOf, whereAre } from '../../../web/src/state/verdict/spots';
import { topicOf, verdictWords, worthSaying } from '../../../web/src/state/verdict/verdict';
import { dictionaryOf, kLanguages } from '../../support/page/words';
import { begin, sceneOf } from './harness';

const kPlace = ['cageElsewhere', 'cageMisplaced', 'cageTooSmall', 'targetPokesOut', 'cageTooFar'];
const kSurface = ['degenerateTriangles', 'doubledTriangles', 'nonManifoldEdges', 'cracks', 'uvsOverlap', 'uvsInPieces'];
const kOthers = ['cageBackward', 'nothingToPaint', 'faceBare', 'eyesUnknown', 'windowsUnknown', 'eyesPainted'];
const kMore = [
  'faceSeam',
  'skinBare',
  'limbsBare',
  'holeUnexplained',
  'muchCulled',
  'muchHidden',
  'piecesApart',
  'uvsUnknown',
];

const finding = (code: string, more: Partial<Finding> = {}): Finding =>
  ({ code, weight: 0.5, sentence: '', advice: '', numbers: {}, ...more }) as Finding;

/** A head with eyes that is shown, and what is found of it. */
async function seen(findings: Finding[] | undefined, maker: object = {}) {
  const page = await begin();
  const { session, loader } = page;
  session.request({ target: loader.load(sceneOf('knight.glb', { Head: 1, Eyes: 2 })), cage: page.load('cage.glb', 4) });
  await page.ready();
  const done: string[] = [];
  const does = (name: string) => () => void done.push(name);
  const spots = spotsOf({
    session,
    maker: { isMade: false, make: does('make'), fitLikely: does('fit'), markBare: does('mark'), ...maker } as never,
    inspection: findings && ({ findings, inward: { share: 0, triangles: [] } } as unknown as Inspection),
    inspect: does('inspect'),
  });
  const help = (spot: Spot) => {
    spot.remedy?.run();
    return [spot.remedy?.title, done.at(-1)];
  };
  return { session, spots, done, help };
}

test('each finding is a line of plain words, in all languages; those of one kind are one line, and the verdict counts lines', async () => {
  const findings = [...kPlace, ...kSurface, ...kOthers, ...kMore].map((code) => finding(code));
  findings.push(finding('faceBare', { weight: 0.1, sentence: 'a remark' }));
  const { spots: all } = await seen(findings);
  const spots = all.filter(({ text }) => !text.endsWith(': bare'));
  assert.equal(spots.length, 2 + kOthers.length + kMore.length, spots.map(({ text }) => text).join('\n'));
  assert.equal(new Set(worthSaying(findings).map(topicOf)).size, spots.length);
  for (const { text, remedy } of spots)
    for (const words of [text, remedy?.title ?? text]) {
      assert.ok(!/cage|%|\.$|undefined/i.test(words) && words.length < 50, words);
      for (const language of kLanguages) assert.ok(dictionaryOf(language).translate(words), `${language}: ${words}`);
    }
  assert.match(verdictWords('usable', { region: undefined, bare: [], findings: 2, isForeign: false }), /2 spots/);
});

test('a line lights the places of its findings, and offers the one thing that helps', async () => {
  const place = (segment: number, part: string) => ({ segment, group: segment, part });
  const findings = [
    finding('cageTooSmall'),
    finding('cageTooFar', { places: [place(0, 'Head')] }),
    finding('eyesUnknown'),
    finding('eyesPainted', { places: [place(1, 'Eyes')], locks: { 1: 'exclude' } }),
    finding('segmentInDoubt', { places: [place(1, 'Eyes')], locks: { 1: 'keep' } }),
    finding('faceSeam', { places: [place(0, 'Head')] }),
  ];
  const { spots, help, session } = await seen(findings);
  const [lies, unknown, painted, doubt, seam] = spots as [Spot, Spot, Spot, Spot, Spot];
  assert.deepEqual(lies.segments, [0]);
  assert.deepEqual(help(lies), ['Try another fit', 'make']);
  assert.ok(unknown.isOfFace);
  assert.deepEqual(help(unknown), ['Mark the eyes', 'mark']);
  assert.equal(doubt.text, 'eyes: bare, but only just');
  assert.equal(doubt.remedy!.title, 'Paint anyway');
  assert.equal(painted.remedy!.title, 'Keep it bare');
  painted.remedy!.run();
  assert.deepEqual(session.locks, { 1: 'exclude' });
  assert.deepEqual(help(seam), ['Try another fit', 'make']);

  const made = await seen([finding('cageTooSmall'), finding('faceSeam')], { isMade: true });
  assert.equal(made.spots[0]!.remedy, undefined, 'what was made here is not made again');
  assert.deepEqual(made.help(made.spots[1]!), ['Try another fit', 'fit']);
});

test('what is good lists what stays bare, to be painted anyway; what was not looked at can be', async () => {
  const { spots, session } = await seen([]);
  assert.deepEqual(
    spots.filter(({ text }) => !/^\S+: bare$/.test(text)),
    [],
  );
  for (const { remedy, segments } of spots) {
    remedy!.run();
    assert.ok(segments.length > 0 && segments.every((segment) => session.locks[segment] === 'always'));
  }
  const late = await seen(undefined);
  assert.equal(late.spots[0]!.text, 'Not looked at closely yet');
  assert.deepEqual(late.help(late.spots[0]!), ['Look closer', 'inspect']);
  const others = await seen(undefined, { isOthers: true });
  assert.deepEqual(others.help(others.spots[0]!), ['Fit it to this one', 'make']);
});

test('a place is seen from where most of it looks, if it does not look to all sides', async () => {
  const { session } = await seen([]);
  const { shown } = session;
  const all = whereAre(shown!, [0])!;
  assert.equal(all.front, undefined, 'a closed surface');
  const flat = {
    target: { mesh: { indices: [0, 1, 2], positions: [1, 0, 0, 1, 0, -1, 1, 1, 0] } },
    projection: { segments: [7, 7, 7] },
  } as never;
  assert.ok(Math.abs(whereAre(flat, [7])!.front! - Math.PI / 2) < 1e-6, 'from its right');
  assert.deepEqual(
    whereAre(flat, [7])!.box.map(({ x, y, z }) => [x, y, z]),
    [
      [1, 0, -1],
      [1, 1, 0],
    ],
  );
  assert.equal(whereAre(flat, [6]), undefined);
});
