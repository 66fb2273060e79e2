import assert from 'node:assert/strict';
import { readFileSync } from 'node:fs';
import { test } from 'node:test';
import { Dictionary } from '../../../web/src/platform/dictionary';
import { inRepository } from '../../support/site';

const entries = (language: string): Record<string, string> =>
  JSON.parse(readFileSync(inRepository(`web/src/words/${language}.json`), 'utf8'));

test('both dictionaries have the same keys, with the same placeholders in what they say', () => {
  const [de, ja] = [entries('de'), entries('ja')];
  assert.deepEqual(Object.keys(de), Object.keys(ja));
  const slots = (text: string): string[] => [...text.matchAll(/\{n?\d\}/g)].map(String).sort();
  for (const words of [de, ja])
    for (const [key, text] of Object.entries(words)) {
      assert.deepEqual(slots(text), slots(key), key);
      assert.ok(text !== '' || key === ' ', `“${key}” says something`);
    }
});

const german = new Dictionary({
  '{0} % paintable': '{0} % bemalbar',
  'Bare: {0}.': 'Frei: {0}.',
  'Ready.': 'Fertig.',
  eyes: 'Augen',
  teeth: 'Zähne',
  'Leave out “{0}”': '„{0}“ weglassen',
  'the file is empty': 'die Datei ist leer',
  '{0} under a hole': '{0} unter einem Loch',
  '{0} hidden': '{0} verdeckt',
  'The rest: {0}.': 'Der Rest: {0}.',
  Undo: 'Rückgängig',
  'adding {0}': '{0} hinzufügen',
  'Two words here': 'Zwei Wörter hier',
  '{n0} of {n1}': '{n0} von {n1}',
  '1,234.5': '1.234,5',
});

test('a text is found whole, by its placeholders, by sentence, and after a colon', () => {
  for (const [text, expected] of [
    ['Ready. Bare: eyes, teeth, wolf3d.', 'Fertig. Frei: Augen, Zähne, wolf3d.'],
    ['64 % paintable', '64 % bemalbar'],
    ['eyes.glb: the file is empty', 'eyes.glb: die Datei ist leer'],
    ['Undo: adding eyes', 'Rückgängig: Augen hinzufügen'],
    ['The rest: 3 hidden, 4 under a hole.', 'Der Rest: 3 verdeckt, 4 unter einem Loch.'],
    ['\n  Two words\n  here ', '\n  Zwei Wörter hier '],
    ['a.glb: the file is empty\nb.glb: the file is empty', 'a.glb: die Datei ist leer\nb.glb: die Datei ist leer'],
    ['1 of 12', '1 von 12'],
    ['nothing of it', undefined],
    ['Undo: adding wolf.', 'Rückgängig: wolf hinzufügen.'],
    ['1,234', '1.234'],
    ['< 0.01 %', '< 0,01 %'],
  ] as const)
    assert.equal(german.translate(text), expected);
});

test('names stay as they are: those in quotes, and texts that are no words of the page', () => {
  assert.equal(german.translate('Leave out “eyes”'), '„eyes“ weglassen');
  for (const name of ['bust.glb', 'Eyes', 'head', '★', '']) assert.equal(german.translate(name), undefined, name);
});

test('what is left within a text is told', () => {
  const left: string[] = [];
  new Dictionary({ 'Bare: {0}.': 'Frei: {0}.', eyes: 'Augen' }, (words) => void left.push(words)).translate(
    'Bare: eyes, horns.',
  );
  assert.deepEqual(left, ['horns']);
});
