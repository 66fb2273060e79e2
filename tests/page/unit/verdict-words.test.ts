import assert from 'node:assert/strict';
import { test } from 'node:test';
import { verdictWords } from '../../../web/src/state/verdict-words';

const seen = { region: undefined, bare: ['eyes', 'teeth', 'hair'], findings: 0, isForeign: false };

test('a verdict is one line of plain words, without numbers but those of spots', () => {
  assert.equal(verdictWords('good', seen).stage, 'Painted · eyes, teeth, hair bare');
  assert.equal(verdictWords('', seen).stage, verdictWords('good', seen).stage, 'before it is known, too');
  assert.equal(verdictWords('good', { ...seen, bare: [] }).stage, 'Painted');
  assert.equal(
    verdictWords('good', { ...seen, region: 'the head', bare: ['eyes'] }).stage,
    'Painted: the head · eyes bare',
  );
  assert.equal(
    verdictWords('good', { ...seen, bare: ['a', 'b', 'c', 'd', 'e'] }).stage,
    'Painted · a, b, c, 2 more bare',
  );
  assert.equal(verdictWords('usable', { ...seen, findings: 2 }).stage, 'Looks off? 2 spots');
  assert.equal(verdictWords('usable', { ...seen, findings: 1 }).card, 'looks off? 1 spot');
  for (const verdict of ['', 'good', 'usable', 'unfit'] as const)
    for (const isForeign of [true, false]) {
      const words = verdictWords(verdict, { ...seen, isForeign });
      for (const text of Object.values(words))
        assert.ok(text && !/%|cage|\n|undefined/.test(text) && text.length < 40, text);
    }
});
