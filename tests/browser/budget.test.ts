import assert from 'node:assert/strict';
import { readdirSync, readFileSync } from 'node:fs';
import path from 'node:path';
import { after, before, test } from 'node:test';
import { gzipSync } from 'node:zlib';
import { processorTime, Site } from './site';

let site: Site;
before(async () => void (site = await Site.open()));
after(() => site?.close());

test('all scripts of the page, those that few visits need included, are no more than 400 KB gzipped', () => {
  const scripts = readdirSync(site.folder, { recursive: true, withFileTypes: true }).filter(({ name }) =>
    name.endsWith('.js'),
  );
  const sizes = scripts.map(
    ({ parentPath, name }) => [name, gzipSync(readFileSync(path.join(parentPath, name)), { level: 9 }).length] as const,
  );
  const total = sizes.reduce((sum, [, size]) => sum + size, 0);
  assert.ok(total > 100_000, 'they were found');
  assert.ok(total <= 400_000, `${total} bytes: ${sizes.map((size) => size.join(' ')).join(', ')}`);
});

test('the first picture takes little of the processor, and most of that is not the page’s own', async () => {
  // By processor time, as a busy machine stretches any other; and in proportion, as those on the same cores stretch even that.
  const runs: { page: number; graphics: number; computation: number; picture: number }[] = [];
  for (let run = 0; run < 3; run++) runs.push(await processorTime(site));
  const page = Math.min(...runs.map((run) => run.page / run.computation));
  assert.ok(page < 1.4, `scripts, layout and style take as long as ${page} computations: ${JSON.stringify(runs)}`);
  // Everything is drawn by the processor here, as are the pictures right after. Usually it is 2.3 to 3.5 of these; filtering an
  // environment map once made it 2.9 times as long.
  for (const { picture } of runs) assert.ok(picture > 0.02, `drawing another picture was measured: ${picture} s`);
  const pictures = Math.min(...runs.map(({ graphics, picture }) => graphics / picture));
  assert.ok(pictures < 6, `drawing the first picture takes as long as ${pictures} more: ${JSON.stringify(runs)}`);
});
