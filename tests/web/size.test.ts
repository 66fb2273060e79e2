import assert from 'node:assert/strict';
import { readdirSync, readFileSync } from 'node:fs';
import path from 'node:path';
import { test } from 'node:test';
import { gzipSync } from 'node:zlib';
import { inRepository } from '../support/site';

/** The built page; tests/run.mjs builds it. */
const kPage = process.env.CAGECAST_PAGE ?? inRepository('build/web');

test('the page begins without the cage module', () => {
  const begins = [...readFileSync(path.join(kPage, 'index.html'), 'utf8').matchAll(/assets\/([\w.-]+\.js)/g)];
  const names = begins.map(([, name]) => name!);
  assert.ok(names.some((name) => name.startsWith('cagecast-')) && names.length > 3, names.join(', '));
  assert.ok(!names.some((name) => name.startsWith('cages-')), names.join(', '));
});

test('all scripts of the page are at most 420 KB gzipped, without the cage module, which loads when a cage is asked for', () => {
  const scripts = readdirSync(kPage, { recursive: true, withFileTypes: true }).filter(
    ({ name }) => name.endsWith('.js') && !name.startsWith('cages-'),
  );
  const sizes = scripts.map(
    ({ parentPath, name }) => [name, gzipSync(readFileSync(path.join(parentPath, name)), { level: 9 }).length] as const,
  );
  const total = sizes.reduce((sum, [, size]) => sum + size, 0);
  assert.ok(total > 100_000, 'they were found');
  assert.ok(total <= 420_000, `${total} bytes: ${sizes.map((size) => size.join(' ')).join(', ')}`);
});
