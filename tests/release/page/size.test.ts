import assert from 'node:assert/strict';
import { readdirSync, readFileSync } from 'node:fs';
import path from 'node:path';
import { test } from 'node:test';
import { gzipSync } from 'node:zlib';
import { inRepository } from '../../support/site';

/** The built page; tests/run.mjs builds it. */
const kPage = process.env.CAGECAST_PAGE ?? inRepository('build/web');

test('the page begins without the cage module', () => {
  const begins = [...readFileSync(path.join(kPage, 'index.html'), 'utf8').matchAll(/assets\/([\w.-]+\.js)/g)];
  const names = begins.map(([, name]) => name!);
  assert.ok(names.some((name) => name.startsWith('cagecast-')) && names.length > 3, names.join(', '));
  assert.ok(!names.some((name) => name.startsWith('cages-')), names.join(', '));
});

test('all scripts of the page are at most 430 KB gzipped, without the cage module, which loads when a cage is asked for', () => {
  const sizes = readdirSync(kPage, { recursive: true, withFileTypes: true })
    .filter(({ name }) => name.endsWith('.js'))
    .map(
      ({ parentPath, name }) =>
        [name, gzipSync(readFileSync(path.join(parentPath, name)), { level: 9 }).length] as const,
    );
  const isCageModule = ([name]: (typeof sizes)[number]) => name.startsWith('cages-');
  // What opens FBX, OBJ, PLY, STL and USD loads when such a file is opened.
  const isOfFormats = ([name]: (typeof sizes)[number]) =>
    /^((FBX|OBJ|MTL|PLY|STL|USD)Loader|formats-thread|fflate)/.test(name);
  const sum = (of: typeof sizes) => of.reduce((sum, [, size]) => sum + size, 0);
  const total = sum(sizes.filter((one) => !isCageModule(one) && !isOfFormats(one)));
  // More than its worker and what calls that would be shared scripts, under its name.
  assert.ok(sum(sizes.filter(isCageModule)) < 16_000, 'nothing else is called like the cage module');
  assert.ok(total > 100_000, 'they were found');
  assert.ok(total <= 430_000, `${total} bytes: ${sizes.map((size) => size.join(' ')).join(', ')}`);
});
