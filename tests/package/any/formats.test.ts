// Promises for any file that somebody takes for a model: it is read or refused within its share of time and memory, what is made of
// it is valid, and nothing else changes. A failure prints a seed; CAGECAST_SEED and CAGECAST_RUNS try others, and more of them, and
// `npm run fuzz -- formats` looks for long.
import assert from 'node:assert/strict';
import { after, describe, test } from 'node:test';
import fc from 'fast-check';
import { mutantsOf } from '../../release/fuzz/formats/edits.js';
import { Reader } from '../../release/fuzz/formats/reader.js';
import { found, samples } from '../../release/fuzz/formats/samples.js';
import { runs } from './any.js';

const [{ bytes, filesOf }] = Object.values(samples) as [(typeof samples)[string]];
const reader = new Reader(filesOf(bytes));
after(() => reader.end());

describe('files that broke a promise once', () => {
  for (const [name, files] of Object.entries(found))
    test(name, async () => assert.equal((await reader.check(files)).fault, undefined));
});

describe('any version of a small file', () => {
  for (const [name, { bytes, filesOf }] of Object.entries(samples))
    test(name, async () => {
      const { fault, isRead } = await reader.check(filesOf(bytes));
      assert.deepEqual([fault, isRead], [undefined, true], 'the file itself');
      await fc.assert(
        fc.asyncProperty(mutantsOf(bytes), async (mutant) => {
          assert.equal((await reader.check(filesOf(mutant))).fault, undefined);
        }),
        { ...runs, numRuns: Math.ceil(runs.numRuns / 50) },
      );
    });
});
