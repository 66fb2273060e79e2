import assert from 'node:assert/strict';
import { test } from 'node:test';
import { freeName, zip } from '../../../web/src/platform/zip';
import { unzip } from '../../support/zip';

test('names in a ZIP have no folders, nothing that a system refuses, and differ in more than their case', () => {
  const files: { name: string }[] = [];
  const named = (stem: string): string => {
    files.push({ name: freeName(stem, 'glb', files) });
    return files.at(-1)!.name;
  };
  assert.equal(named('naïve 頭 🦎'), 'naïve 頭 🦎-painted.glb');
  assert.equal(named('../../evil'), '-..-evil-painted.glb');
  assert.equal(named('/etc/x'), '-etc-x-painted.glb');
  assert.equal(named('C:\\x?\n'), 'C--x---painted.glb');
  assert.equal(named('..'), 'avatar-painted.glb');
  assert.equal(named('Head'), 'Head-painted.glb');
  assert.equal(named('head'), 'head-2-painted.glb');
  assert.ok(Buffer.byteLength(named('🦎'.repeat(100))) <= 255);
});

test('a ZIP says that its names are in UTF-8 to programs that look at the system it was made by, too', async () => {
  const name = 'naïve 頭 🦎-painted.glb';
  const bytes = Buffer.from(await (await zip([{ name, blob: new Blob(['model']) }])).arrayBuffer());
  assert.deepEqual([...unzip(bytes)], [[name, Buffer.from('model')]]);
  const entry = bytes.indexOf(Buffer.of(0x50, 0x4b, 1, 2));
  assert.equal(bytes[entry + 5], 3, 'Unix');
  assert.equal(bytes.readUInt32LE(entry + 38) >>> 16, 0o100644, 'and a file that may be read');
});
