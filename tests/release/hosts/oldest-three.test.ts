// What `paint.test.ts` shows holds with the oldest three.js that the package admits, too.
import assert from 'node:assert/strict';
import { readFileSync } from 'node:fs';
import { test } from 'node:test';

process.env['CAGECAST_THREE'] = 'three-oldest';
await import('../../package/three/paint.test.js');

test('this is the oldest three.js that the package admits', () => {
  const { peerDependencies, devDependencies } = JSON.parse(readFileSync('package.json', 'utf8')) as Record<
    'peerDependencies' | 'devDependencies',
    Record<string, string>
  >;
  const oldest = devDependencies['three-oldest']!.replace('npm:three@', '');
  assert.equal(peerDependencies['three'], `>=${oldest.replace(/\.0$/, '')}`);
});
