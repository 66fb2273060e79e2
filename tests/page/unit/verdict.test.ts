import assert from 'node:assert/strict';
import { test } from 'node:test';
import { init, transfer } from 'cagecast';
import { paintableShare, regionOf, verdictWords } from '../../../web/src/state/verdict/verdict';
import { head, within } from '../../package/scenes';

test('an open cage covers a region: its share is that of the region, and names tell which it is', async () => {
  await init();
  const { cage: whole, target } = head(1);
  const cage = within(whole, (_, __, z) => z > 0.6);
  const { segmentStats } = transfer(cage, target);
  assert.ok(segmentStats[0]!.beyondArea > segmentStats[0]!.area / 2);
  assert.ok(paintableShare(segmentStats) > 0.9);
  const named = (names: string[], cageName: string, stats = segmentStats): string | undefined =>
    regionOf(
      {
        target: { mesh: { primitives: names.map((name) => ({ name })) } },
        cage: { name: cageName, files: [new File([], cageName)], mesh: { primitives: [{ name: 'Cage' }] } },
      } as never,
      stats,
    );
  // Most of the skin lies beyond, so its name is not that of the region.
  assert.equal(named(['Legs', 'eye', 'tongue'], 'cage.glb'), 'a part');
  assert.equal(named(['Skin', 'eye', 'tongue'], 'HeadCage.glb'), 'the head');
  assert.equal(named(['Skin', 'eye', 'tongue'], 'surface-handle.glb'), 'a part');
  const mostly = segmentStats.map((stats) => ({ ...stats, beyondArea: stats.area / 4 }));
  assert.equal(named(['Wolf3D_Head', 'eye', 'tongue'], 'cage.glb', mostly), 'the head');
  assert.equal(named(['Head', 'eye', 'tongue'], 'head.glb', transfer(whole, target).segmentStats), undefined);
});

const seen = { region: undefined, bare: ['eyes', 'teeth', 'hair'], findings: 0, isForeign: false };

test('a verdict is one line of plain words, without numbers but those of spots', () => {
  assert.equal(verdictWords('good', seen), 'Painted · eyes, teeth, hair bare');
  assert.equal(verdictWords('', seen), verdictWords('good', seen), 'before it is known, too');
  assert.equal(verdictWords('good', { ...seen, bare: [] }), 'Painted');
  assert.equal(verdictWords('good', { ...seen, region: 'the head', bare: ['eyes'] }), 'Painted: the head · eyes bare');
  assert.equal(verdictWords('good', { ...seen, bare: ['a', 'b', 'c', 'd', 'e'] }), 'Painted · a, b, c, 2 more bare');
  assert.equal(verdictWords('usable', { ...seen, findings: 2 }), 'Looks off? 2 spots');
  assert.equal(verdictWords('usable', { ...seen, findings: 1 }), 'Looks off? 1 spot');
  for (const verdict of ['', 'good', 'usable', 'unfit'] as const)
    for (const isForeign of [true, false]) {
      const words = verdictWords(verdict, { ...seen, isForeign });
      assert.ok(words && !/%|cage|\n|undefined/.test(words) && words.length < 40, words);
    }
});
