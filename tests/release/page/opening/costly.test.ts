// Files of strangers that would cost gigabytes or minutes: each is refused, or shown, and the page goes on.
import assert from 'node:assert/strict';
import { readFileSync, writeFileSync } from 'node:fs';
import { test } from 'node:test';
import { deflateRawSync } from 'node:zlib';
import { costlyFiles, jpegOf, webpOf } from '../../../support/files/costly';
import { costlyFormats } from '../../../support/files/costly-formats';
import { glbOf, tetrahedron } from '../../../support/glb';
import { glb, openSite, ready, settled, shownError } from '../../../support/site';

/** The most memory that any of them may take, beside what the page has. */
const kMax = 500e6; // bytes

delete process.env['CAGECAST_BROWSER']; // whose memory others take, too
const site = await openSite();
// One page for all of it: it must come through everything.
const visit = await site.visit({ viewport: { width: 700, height: 500 } });

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
    assert.ok(taken < kMax, `${Math.round(taken / 1e6)} MB`);
    await page.getByTestId('target-input').setInputFiles(glb('sound.glb', sound));
    await ready(page);
  });

const soundFile = glb('sound.glb', sound);
const uploadOf = (name: string, bytes: Uint8Array) => ({ name, mimeType: '', buffer: Buffer.from(bytes) });

for (const [title, { name, bytes, beside, refusal }] of Object.entries(costlyFormats))
  if (!beside && refusal)
    test(`${title}, in ${name}`, async () => {
      const { page } = visit;
      const taken = await memoryOf(async () => {
        await page.getByTestId('target-input').setInputFiles(uploadOf(name, bytes()));
        assert.equal(await settled(page), 'error', await shownError(page));
      });
      const said = await shownError(page);
      // What is of no known kind is damaged to the page.
      if (!/neither/.test(refusal.source)) assert.match(said, new RegExp(`^${name}: .*${refusal.source}`));
      assert.ok(taken < kMax, `${Math.round(taken / 1e6)} MB`);
      await page.getByTestId('target-input').setInputFiles(soundFile);
      await ready(page);
    });

test('a model of another format whose reading does not end: Escape and the next model end its worker at once', async () => {
  const { page } = visit;
  // So large that its reader may take a minute.
  const text = Buffer.concat([
    costlyFormats['a line that is matched over and over']!.bytes(),
    Buffer.alloc(30e6, '# \n'),
  ]);
  const readers = () => page.workers().filter((worker) => /formats-thread/.test(worker.url()));
  const begin = async () => {
    const started = page.waitForEvent('worker', (worker) => /formats-thread/.test(worker.url()));
    await page.getByTestId('target-input').setInputFiles(uploadOf('endless.usda', text));
    const worker = await started;
    await page.getByTestId('progress').waitFor();
    return worker;
  };
  const beforeLimit = { timeout: 9000 }; // the page's own is 10 seconds
  const first = await begin();
  const closed = first.waitForEvent('close', beforeLimit);
  await page.keyboard.press('Escape');
  await closed;
  await page.getByTestId('progress').waitFor({ state: 'hidden' });
  assert.equal(await shownError(page), '');
  const second = await begin();
  const replaced = second.waitForEvent('close', beforeLimit);
  await page.getByTestId('target-input').setInputFiles(soundFile);
  await replaced;
  await ready(page);
  assert.equal(readers().length, 0);
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
    assert.ok(taken < kMax, `${Math.round(taken / 1e6)} MB`);
  }
});

test('a link with strokes that claim to be a thousand times as large', async () => {
  const { page } = visit;
  const strokes = `strokes:${deflateRawSync(new Uint8Array(4e6)).toString('base64url')}`;
  const link = `#sample=lizard${`&layer=${strokes},1,ffffff,normal`.repeat(16)}`;
  const taken = await memoryOf(async () => {
    await page.evaluate((fragment) => void (location.hash = fragment), link);
    await page.getByTestId('ask').filter({ hasText: 'The link is cut off or damaged' }).waitFor();
  });
  assert.ok(taken < kMax, `${Math.round(taken / 1e6)} MB`);
  await page.getByTestId('target-input').setInputFiles(glb('sound.glb', sound));
  await ready(page);
});
