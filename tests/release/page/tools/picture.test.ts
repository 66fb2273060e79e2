import assert from 'node:assert/strict';
import { test } from 'node:test';
import { PNG } from 'pngjs';
import { share } from '../../../../web/share';
import { faults } from '../../../support/axe';
import { difference, look, modelArea, watch } from '../../../support/picture';
import { saved } from '../../../support/saved';
import { openSite, settled } from '../../../support/site';

const site = await openSite();

test('light and background change the picture, go into links, and are saved; the turntable turns the model', async () => {
  const { page, complaints } = await site.visit(
    { viewport: { width: 700, height: 560 } },
    undefined,
    '#sample=lizard&view=result',
  );
  const area = await modelArea(page);
  const corner = { x: area.x, y: area.y, width: 20, height: 20 };
  const studio = await look(page, area);
  for (const light of ['soft', 'evening']) {
    await page.getByTestId('light').selectOption(light);
    await watch(page, area, (seen) => difference(seen, studio) > 0.05);
  }
  await page.getByTestId('background').fill('#204060');
  await watch(page, corner, ({ data }) => data[0] === 0x20 && data[1] === 0x40 && data[2] === 0x60);
  assert.ok(await page.getByLabel('Own background').isChecked());
  assert.deepEqual(await faults(page), []);

  const inside = PNG.sync.read((await saved(page, 'save-picture')).bytes);
  assert.equal(inside.width, 2160);
  assert.deepEqual([...inside.data.subarray(0, 4)], [0x20, 0x40, 0x60, 255]);
  const link = new URL((await page.getByTestId('share-link').getAttribute('href'))!, page.url());
  assert.match(link.hash, /&light=evening&background=204060/);

  await page.getByLabel('Own background').uncheck();
  await page.getByTestId('clear-picture').check();
  const clear = PNG.sync.read((await saved(page, 'save-picture')).bytes);
  assert.equal(clear.data[3], 0, 'what is behind the model is transparent');
  assert.ok(clear.data.some((value, i) => i % 4 === 3 && value === 255));

  const still = await look(page, area);
  await page.getByTestId('turntable').check();
  await watch(page, area, (seen) => difference(seen, still) > 0.05);
  await page.getByTestId('turntable').uncheck();
  let last = await look(page, area);
  await watch(page, area, (seen) => {
    const stands = difference(seen, last) === 0;
    last = seen;
    return stands;
  });

  await page.goto('about:blank');
  await page.goto(link.href);
  await settled(page);
  assert.equal(await page.getByTestId('light').inputValue(), 'evening');
  assert.equal(await page.getByTestId('background').inputValue(), '#204060');
  assert.deepEqual(complaints, []);
});

test('a link to the page has a title, a text and a picture for messengers', async () => {
  const html = await (await fetch(site.url)).text();
  const content = (name: string) => new RegExp(`<meta property="og:${name}" content="([^"]+)"`).exec(html)?.[1];
  assert.match(content('title')!, /Cagecast/);
  assert.match(content('description')!, /Draw a texture once/);
  const { page } = await site.visit();
  const size = await page.evaluate(async (file) => {
    const image = await createImageBitmap(await (await fetch(file)).blob());
    return [image.width, image.height];
  }, content('image')!);
  assert.deepEqual(size, [content('image:width'), content('image:height')].map(Number));

  assert.throws(() => share('example.org'), /CAGECAST_URL is “example.org”, not a URL/);
  const { transformIndexHtml: tags } = share('https://example.org/paint/');
  const images = (tags as unknown as (html: string) => { attrs: Record<string, string> }[])(html).map(
    ({ attrs }) => attrs,
  );
  assert.ok(images.some((attrs) => attrs['content'] === 'https://example.org/paint/share.jpg'));
});
