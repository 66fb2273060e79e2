// Files of strangers that would cost gigabytes or minutes: each is refused, or shown, and the page goes on.
import assert from 'node:assert/strict';
import { readFileSync, writeFileSync } from 'node:fs';
import { after, before, test } from 'node:test';
import { costlyFiles, jpegOf, webpOf } from '../../../support/files/costly';
import { glbOf, tetrahedron } from '../../../support/glb';
import { glb, Site, settled, shownError, type Visit } from '../../../support/site';

/** The most memory that any of them may take, beside what the page has. */
const kMost = 500e6; // bytes

let site: Site;
// One page for all of it: it must come through everything.
let visit: Visit;
before(async () => {
  site = await Site.open();
  visit = await site.visit({ viewport: { width: 700, height: 500 } });
});
after(() => site?.close());

/** The processes of the browser; none where their memory cannot be read. */
async function processes(): Promise<number[]> {
  if (process.platform !== 'linux') return [];
  const session = await site.browser.newBrowserCDPSession();
  const { processInfo } = await session.send('SystemInfo.getProcessInfo');
  await session.detach();
  return processInfo.map(({ id }) => id);
}

const bytesOf = (pid: number, kind: 'VmRSS' | 'VmHWM'): number =>
  1024 * Number(new RegExp(`${kind}:\\s*(\\d+)`).exec(readFileSync(`/proc/${pid}/status`, 'utf8'))?.[1] ?? 0);

/** Does something. @returns how much more memory the browser had meanwhile, at most. */
async function memoryOf(work: () => Promise<void>): Promise<number> {
  const before = await processes();
  for (const pid of before) writeFileSync(`/proc/${pid}/clear_refs`, '5'); // the peak begins anew
  const had = new Map(before.map((pid) => [pid, bytesOf(pid, 'VmRSS')]));
  await work();
  return (await processes()).reduce((sum, pid) => sum + bytesOf(pid, 'VmHWM') - (had.get(pid) ?? 0), 0);
}

const sound = Buffer.from(glbOf(tetrahedron(0.9), 'ball'));

for (const [name, { bytes, refusal }] of Object.entries(costlyFiles))
  test(name, async () => {
    const { page } = visit;
    const taken = await memoryOf(async () => {
      await page.getByTestId('target-input').setInputFiles(glb('costly.glb', bytes()));
      assert.equal(await settled(page), refusal ? 'error' : 'ready', await shownError(page));
    });
    const said = await shownError(page);
    if (refusal) assert.match(said, new RegExp(`^costly\\.glb: ${refusal.source}`));
    assert.ok(taken < kMost, `${Math.round(taken / 1e6)} MB`);
    await page.getByTestId('target-input').setInputFiles(glb('sound.glb', sound));
    assert.equal(await settled(page), 'ready', await shownError(page));
  });

test('pictures of billions of pixels to paint with', async () => {
  const { page } = visit;
  for (const [name, bytes] of [
    ['huge.jpg', jpegOf(65_500, 65_500)],
    ['huge.webp', webpOf(16_383, 16_383)],
  ] as const) {
    const taken = await memoryOf(async () => {
      await page.getByTestId('texture-input').setInputFiles({ name, mimeType: 'image/jpeg', buffer: bytes });
      await page.locator('#error').filter({ hasText: name }).waitFor();
    });
    assert.match(await shownError(page), /: it has [\d,]+ × [\d,]+ pixels; .* the limit "expansion" is 100/);
    assert.ok(taken < kMost, `${Math.round(taken / 1e6)} MB`);
  }
});
